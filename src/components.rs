//! Components that are joined and never parted, each known by its root.

/// The root of the component of `node`: the one node that is its own parent. Halves the way there for those who come
/// later.
///
/// # Complexity
/// O(log n) for n nodes in the mean of many calls, however roots are joined.
#[inline]
pub(crate) fn root(parents: &mut [u32], mut node: u32) -> u32 {
    while parents[node as usize] != node {
        let up = parents[parents[node as usize] as usize];
        parents[node as usize] = up;
        node = up;
    }
    node
}
