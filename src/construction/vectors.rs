//! Runs code with the widest vectors of the processor at hand; sums and products come out the same with all of them.

/// Runs `work`, and all that is inlined into it, compiled for the best instructions that the processor has.
#[inline(always)]
pub(super) fn widest<T>(work: impl FnOnce() -> T) -> T {
    pulp::Arch::new().dispatch(work)
}
