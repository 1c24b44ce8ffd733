//! The widest vectors of the processor at hand.

/// Runs `work`, compiled once for each kind of processor.
///
/// Additions and products are never fused nor put into another order, so the result is the same on all of them.
#[inline(always)]
pub(crate) fn vectorised<R>(work: impl FnOnce() -> R) -> R {
    pulp::Arch::new().dispatch(work)
}
