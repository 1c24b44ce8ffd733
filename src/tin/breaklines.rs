//! Lines that are edges of a triangulation: ridges, rivers, roads.

use super::crossings::taken_apart;
use super::heights::Heights;

/// Lines between cells of a raster, ready to be edges.
///
/// Points are taken to the nearest cell; what lies outside of the raster is cut off. Lines that cross do so in the cell
/// around their crossing, through which both are led (snap rounding). Beside voids a line goes from cell to neighbouring
/// cell, and only where there is ground.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Breaklines {
    /// Pairs of cells, the lesser first; sorted.
    edges: Vec<[u32; 2]>,
}

impl Breaklines {
    /// The breaklines along `lines`, whose points are columns and rows, whole numbers at the centres of the cells.
    ///
    /// Points that are not finite part a line.
    pub fn new(lines: &[Vec<[f64; 2]>], heights: &Heights) -> Self {
        let mut steps = Vec::new();
        for line in lines {
            for pair in line.windows(2) {
                let Some(ends) = clipped(pair[0], pair[1], heights) else { continue };
                let [a, b] = ends.map(|end| end.map(|v| (v + 0.5).floor() as i64));
                append(a, b, heights, &mut steps);
            }
        }
        let parts = taken_apart(&steps);
        let mut edges: Vec<[u32; 2]> = parts.into_iter().map(|part| part.map(|place| heights.cell(place))).collect();
        edges.iter_mut().for_each(|edge| edge.sort_unstable());
        edges.sort_unstable();
        Self { edges }
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.edges.is_empty()
    }

    /// The edges: pairs of cells, `row * columns + column`.
    pub fn edges(&self) -> &[[u32; 2]] {
        &self.edges
    }
}

/// The part of a line between the raster's outermost cell centres (Liang and Barsky 1984), if there is one.
fn clipped(a: [f64; 2], b: [f64; 2], heights: &Heights) -> Option<[[f64; 2]; 2]> {
    if !a.iter().chain(&b).all(|v| v.is_finite()) {
        return None;
    }
    let most = [heights.cols() as f64 - 1.0, heights.rows() as f64 - 1.0];
    let (mut from, mut to) = (0.0_f64, 1.0_f64);
    for i in 0..2 {
        let d = b[i] - a[i];
        // Half a cell more: the outermost cells reach so far.
        let (low, high) = (-0.5 - a[i], most[i] + 0.5 - a[i]);
        if d == 0.0 {
            if low > 0.0 || high < 0.0 {
                return None;
            }
            continue;
        }
        let (p, q) = (low / d, high / d);
        from = from.max(p.min(q));
        to = to.min(p.max(q));
    }
    let at = |t: f64| std::array::from_fn(|i| (a[i] + t * (b[i] - a[i])).clamp(0.0, most[i]));
    (from <= to).then(|| [at(from), at(to)])
}

/// Appends the line from a cell to another, or the steps of it that stay on the ground if there are voids beside it.
fn append(a: [i64; 2], b: [i64; 2], heights: &Heights, steps: &mut Vec<[[i64; 2]; 2]>) {
    if a == b {
        return;
    }
    let path = path(a, b);
    let is_safe = !heights.has_voids() || path.iter().all(|&p| heights.has(p) && !heights.is_beside_void(p));
    if is_safe {
        steps.push([a, b]);
    } else {
        let pairs = path.windows(2).map(|pair| [pair[0], pair[1]]);
        steps.extend(pairs.filter(|&[p, q]| heights.is_ground_step(p, q)));
    }
}

/// The cells from one to another, each a neighbour of the next, the nearest to the straight line.
fn path(a: [i64; 2], b: [i64; 2]) -> Vec<[i64; 2]> {
    let [dx, dy] = [b[0] - a[0], b[1] - a[1]];
    let n = dx.abs().max(dy.abs());
    (0..=n).map(|i| [dx, dy].map(|d| (2 * d * i + n).div_euclid(2 * n))).map(|[x, y]| [a[0] + x, a[1] + y]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn flat(rows: usize, cols: usize, voids: &[[usize; 2]]) -> Heights {
        let mut z = vec![0.0; rows * cols];
        voids.iter().for_each(|&[x, y]| z[y * cols + x] = f64::NAN);
        Heights::new(rows, cols, z).unwrap()
    }

    #[test]
    fn lines_end_at_the_border() {
        let heights = flat(5, 10, &[]);
        let lines = Breaklines::new(&[vec![[-10.0, 2.2], [20.0, 2.2]], vec![[50.0, 0.0], [50.0, 9.0]]], &heights);
        assert_eq!(lines.edges(), [[20, 29]]);
        let apart = Breaklines::new(&[vec![[0.0, 0.0], [f64::NAN, 0.0], [3.0, 0.0], [5.0, 0.0]]], &heights);
        assert_eq!(apart.edges(), [[3, 5]]);
        assert!(Breaklines::new(&[vec![[1.2, 1.0], [0.8, 1.3]]], &heights).is_empty(), "within one cell");
    }

    #[test]
    fn lines_leave_voids_out() {
        let heights = flat(4, 7, &[[3, 1], [3, 2]]);
        let lines = Breaklines::new(&[vec![[0.0, 1.0], [6.0, 1.0]], vec![[0.0, 3.0], [6.0, 3.0]]], &heights);
        let along = [[21, 22], [22, 23], [23, 24], [24, 25], [25, 26], [26, 27]];
        assert_eq!(lines.edges(), [&[[7, 8], [8, 9], [11, 12], [12, 13]][..], &along].concat());
    }
}
