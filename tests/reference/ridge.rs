//! The drawn lines of the divide tree, cell by cell.

use super::sweep::{Join, Raster};
use super::tree::Tree;
use orograph::grid::Cell;

/// The cells over one saddle, from the peak on one side to that on the other.
fn over(raster: &Raster, join: &Join, from: Cell) -> Vec<Cell> {
    let (near, far) = if from == join.a { (join.n0, join.ni) } else { (join.ni, join.n0) };
    let mut cells = raster.climb(near);
    cells.reverse();
    assert_eq!(cells[0], from, "the climb ends at the peak");
    cells.push(join.saddle);
    cells.extend(raster.climb(far));
    cells
}

/// The cells of an edge of the pruned tree, from its peak `a` to its peak `b`: the contracted edges from the peak
/// that names `a`'s group, the edge itself, the contracted edges to the peak that names `b`'s.
pub fn path(raster: &Raster, tree: &Tree, join: &Join) -> Vec<Cell> {
    let (first, last) = (tree.group(join.a), tree.group(join.b));
    let mut steps = tree.way_inside(first, join.a);
    steps.push((join.b, join));
    steps.extend(tree.way_inside(join.b, last));
    let mut cells = vec![first];
    for (to, step) in steps {
        let from = cells[cells.len() - 1];
        let walked = over(raster, step, from);
        assert_eq!(walked.last(), Some(&to), "the step leads to the next peak");
        cells.extend(&walked[1..]);
    }
    cells
}
