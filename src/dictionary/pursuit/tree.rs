//! Atoms in a tree by their directions, in which the best for a patch is found without a look at most of them.
//!
//! Of vectors of length 1 the one most in line with another is the one whose end is nearest to the other's. A vector is
//! made shorter by taking a few coordinates of it, and the length of all that they leave out as one more: short vectors
//! are no further from each other than the whole ones. So a box of short vectors that is too far away holds nothing
//! better, and it is left out with all that is in it. What is left is compared as without the tree.

use super::super::shape::PatchShape;
use crate::linalg::dot;
use rayon::prelude::*;

/// Polynomials up to this degree are the coordinates: slopes, curvatures and so on make up most of terrain.
const DEGREE: usize = 4;
/// Coordinates of a short vector: 14 polynomials, the length of the rest, and nothing, for the processor's sake.
const DIMS: usize = 16;
/// Most atoms of a leaf.
const LEAF: usize = 32;
/// Most children of a node.
const WIDE: usize = 16;
/// Coordinates that mostly tell already that a leaf has nothing better.
const FIRST: usize = 8;
/// Nodes that can wait to be looked at: the children of one of each level, of which there are at most eight.
const WAITING: usize = 8 * WIDE;
/// In place of an atom where a leaf has fewer.
const NONE: u32 = u32::MAX;
/// The square of a distance between short vectors may be so much larger than it should be: their coordinates are off by
/// no more than 2⁻²⁴ each, the rest by 10⁻⁶, which makes 10⁻⁵ for distances up to 2; and the sum of 16 squares in single
/// precision by 5 · 10⁻⁶.
const OFF: f64 = 2e-5;

/// A vector made short: a coordinate each.
pub(super) type Short = [f32; DIMS];
/// The least and the largest of each coordinate in each child of a node.
type Boxes = [[[f32; WIDE]; DIMS]; 2];

/// Atoms by their directions.
#[derive(Clone, Debug)]
pub(super) struct Tree {
    /// Whether an atom may be turned upside down: then all are kept with a first coordinate of at least 0.
    is_signed: bool,
    /// What coordinates are multiplied with, one behind the other.
    basis: Vec<f64>,
    size: usize,
    /// Level by level from the root, the boxes of each node's children. Those of node i are nodes 16 i and those after it
    /// of the next level, or leaves.
    levels: Vec<Vec<Boxes>>,
    /// The atoms of each leaf.
    atoms: Vec<[u32; LEAF]>,
    /// Their coordinates.
    points: Vec<[[f32; LEAF]; DIMS]>,
}

impl Tree {
    /// Atoms of a shape, times the roots of weights, with their square lengths; those of no length are left out.
    pub(super) fn new(shape: &PatchShape, atoms: &[f32], squares: &[f64], is_signed: bool) -> Self {
        let size = shape.disc_values();
        let mut tree = Self { is_signed, basis: basis(shape), size, levels: vec![], atoms: vec![], points: vec![] };
        let short = |(atom, square): (&[f32], &f64)| {
            let short = tree.short(atom, square.sqrt());
            if is_signed && short[0] < 0.0 { turned(&short) } else { short }
        };
        let shorts: Vec<Short> = atoms.par_chunks_exact(size).zip(squares).map(short).collect();
        let mut order: Vec<u32> = (0..shorts.len() as u32).filter(|&k| squares[k as usize] > 0.0).collect();
        let leaves = order.len().div_ceil(LEAF).next_power_of_two();
        split(&shorts, &mut order, leaves);
        let mut left = &order[..];
        for leaf in 0..leaves {
            // As `split` has it: of an odd number the first half has one more.
            let count = (order.len() + leaves - 1 - reversed(leaf, leaves)) / leaves;
            let (own, rest) = left.split_at(count);
            left = rest;
            let mut numbers = [NONE; LEAF];
            numbers[..count].copy_from_slice(own);
            let mut points = [[f32::INFINITY; LEAF]; DIMS];
            for (lane, &atom) in own.iter().enumerate() {
                (0..DIMS).for_each(|dim| points[dim][lane] = shorts[atom as usize][dim]);
            }
            tree.atoms.push(numbers);
            tree.points.push(points);
        }
        tree.levels = levels(&tree.points, &tree.atoms);
        tree
    }

    /// The short vector of a vector of some length above 0.
    #[inline(always)]
    pub(super) fn short(&self, vector: &[f32], length: f64) -> Short {
        let mut short = [0.0; DIMS];
        let mut rest = 1.0;
        for (coordinate, axis) in short.iter_mut().zip(self.basis.chunks_exact(self.size)) {
            let part = dot(axis, vector) / length;
            rest -= part * part;
            *coordinate = part as f32;
        }
        short[DIMS - 2] = if rest > 0.0 { rest.sqrt() as f32 } else { 0.0 };
        short
    }

    /// A leaf that is near: those that look for near ones go through much the same memory.
    #[inline(always)]
    pub(super) fn near(&self, short: &Short) -> u32 {
        let short = self.sides(short)[0];
        let mut node = 0;
        for level in &self.levels {
            let squares = to_boxes(&short, &level[node]);
            let mut nearest = 0;
            for child in 1..WIDE {
                nearest = if squares[child] < squares[nearest] { child } else { nearest };
            }
            node = WIDE * node + nearest;
        }
        node as u32
    }

    /// It and its other side up, that one first on whose side atoms lie.
    #[inline(always)]
    fn sides(&self, short: &Short) -> [Short; 2] {
        let other = turned(short);
        if self.is_signed && short[0] < 0.0 { [other, *short] } else { [*short, other] }
    }

    /// Calls `compare` for each atom that could be the best for a short vector, and for some others. It returns the part
    /// of the vector's length that the best atom so far makes up.
    #[inline(always)]
    pub(super) fn search(&self, short: &Short, mut compare: impl FnMut(usize) -> f64) {
        let mut most = limit(0.0);
        let sides = self.sides(short);
        for side in &sides[..if self.is_signed { 2 } else { 1 }] {
            self.search_side(side, &mut most, &mut compare);
        }
    }

    /// Goes through all leaves that are near enough to a short vector.
    #[inline(always)]
    fn search_side(&self, short: &Short, most: &mut f32, compare: &mut impl FnMut(usize) -> f64) {
        // How far each is, its level and its number; the nearest of those with one parent comes last.
        let mut waiting = [(0.0f32, 0u32, 0u32); WAITING];
        let mut count = 1;
        while count > 0 {
            count -= 1;
            let (distance, level, node) = waiting[count];
            if distance > *most {
                continue;
            }
            let Some(nodes) = self.levels.get(level as usize) else {
                self.search_leaf(node as usize, short, most, compare);
                continue;
            };
            let squares = to_boxes(short, &nodes[node as usize]);
            let begin = count;
            for (child, square) in squares.into_iter().enumerate() {
                if square <= *most {
                    let mut at = count;
                    while at > begin && waiting[at - 1].0 < square {
                        waiting[at] = waiting[at - 1];
                        at -= 1;
                    }
                    waiting[at] = (square, level + 1, WIDE as u32 * node + child as u32);
                    count += 1;
                }
            }
        }
    }

    #[inline(always)]
    fn search_leaf(&self, leaf: usize, short: &Short, most: &mut f32, compare: &mut impl FnMut(usize) -> f64) {
        let mut squares = [0.0f32; LEAF];
        for dims in [0..FIRST, FIRST..DIMS] {
            add_squares(&mut squares, short, &self.points[leaf], dims);
            let mut any = false;
            for square in &squares {
                any |= *square <= *most;
            }
            if !any {
                return;
            }
        }
        for (&atom, square) in self.atoms[leaf].iter().zip(squares) {
            if square <= *most && atom != NONE {
                *most = limit(compare(atom as usize));
            }
        }
    }
}

/// The square of the distance between short vectors beyond which no atom makes up such a part of a vector's length.
#[inline(always)]
fn limit(part: f64) -> f32 {
    (2.0 - 2.0 * part + OFF) as f32
}

/// Upside down; what is left out of it is as long.
#[inline(always)]
fn turned(short: &Short) -> Short {
    let mut turned = short.map(|coordinate| -coordinate);
    turned[DIMS - 2] = short[DIMS - 2];
    turned
}

/// The squares of the distances from boxes.
#[inline(always)]
fn to_boxes(short: &Short, [least, most]: &Boxes) -> [f32; WIDE] {
    let mut squares = [0.0f32; WIDE];
    for dim in 0..DIMS {
        for child in 0..WIDE {
            let (below, above) = (least[dim][child] - short[dim], short[dim] - most[dim][child]);
            let out = if below > above { below } else { above };
            let out = if out > 0.0 { out } else { 0.0 };
            squares[child] += out * out;
        }
    }
    squares
}

/// Adds the squares of the distances from points along some axes.
#[inline(always)]
fn add_squares(squares: &mut [f32; LEAF], short: &Short, points: &[[f32; LEAF]; DIMS], dims: std::ops::Range<usize>) {
    for dim in dims {
        for lane in 0..LEAF {
            let off = points[dim][lane] - short[dim];
            squares[lane] += off * off;
        }
    }
}

/// Divides short vectors in halves along the axis on which they lie furthest apart, and so on, for a power of two of
/// leaves.
fn split(shorts: &[Short], order: &mut [u32], leaves: usize) {
    if leaves == 1 {
        return;
    }
    let width = |dim: usize| {
        let values = || order.iter().map(|&atom| shorts[atom as usize][dim]);
        values().fold(f32::MIN, f32::max) - values().fold(f32::MAX, f32::min)
    };
    let widths: Vec<f32> = (0..DIMS).map(width).collect();
    let widest = (0..DIMS).fold(0, |widest, dim| if widths[dim] > widths[widest] { dim } else { widest });
    let middle = order.len().div_ceil(2);
    if middle < order.len() {
        let value = |atom: &u32| shorts[*atom as usize][widest];
        order.select_nth_unstable_by(middle, |a, b| value(a).total_cmp(&value(b)));
    }
    let (first, second) = order.split_at_mut(middle);
    rayon::join(|| split(shorts, first, leaves / 2), || split(shorts, second, leaves / 2));
}

/// The number with its bits, as many as a power of two has below its own, in the other order.
fn reversed(number: usize, power: usize) -> usize {
    match power {
        1 => 0,
        _ => number.reverse_bits() >> (usize::BITS - power.trailing_zeros()),
    }
}

/// The boxes of all levels, from those of the leaves upwards.
fn levels(points: &[[[f32; LEAF]; DIMS]], atoms: &[[u32; LEAF]]) -> Vec<Vec<Boxes>> {
    let none = [[[f32::INFINITY; WIDE]; DIMS], [[f32::NEG_INFINITY; WIDE]; DIMS]];
    let leaf = |(points, atoms): (&[[f32; LEAF]; DIMS], &[u32; LEAF])| {
        let count = atoms.iter().filter(|&&atom| atom != NONE).count();
        let of = |begin: f32, choose: fn(f32, f32) -> f32| {
            points.map(|values| values[..count].iter().copied().fold(begin, choose))
        };
        [of(f32::INFINITY, f32::min), of(f32::NEG_INFINITY, f32::max)]
    };
    let mut below: Vec<[Short; 2]> = points.iter().zip(atoms).map(leaf).collect();
    let mut levels = vec![];
    while levels.is_empty() || below.len() > 1 {
        let mut nodes = vec![none; below.len().div_ceil(WIDE)];
        for (i, own) in below.iter().enumerate() {
            for (side, own) in nodes[i / WIDE].iter_mut().zip(own) {
                side.iter_mut().zip(own).for_each(|(values, &value)| values[i % WIDE] = value);
            }
        }
        let of = |values: &[[f32; WIDE]; DIMS], begin: f32, choose: fn(f32, f32) -> f32| {
            values.map(|values| values.into_iter().fold(begin, choose))
        };
        let node = |node: &Boxes| [of(&node[0], f32::INFINITY, f32::min), of(&node[1], f32::NEG_INFINITY, f32::max)];
        below = nodes.iter().map(node).collect();
        levels.push(nodes);
    }
    levels.reverse();
    levels
}

/// Polynomials of the place in a patch, times the roots of weights: vectors of length 1 at right angles to each other and
/// to what is constant. Small patches have fewer.
fn basis(shape: &PatchShape) -> Vec<f64> {
    let roots: Vec<f64> = shape.roots().iter().map(|&root| f64::from(root)).collect();
    let middle = (shape.side() as f64 - 1.0) / 2.0;
    let place =
        |k: usize| [(k % shape.side()) as f64 - middle, (k / shape.side()) as f64 - middle].map(|at| at / middle);
    let mut found: Vec<Vec<f64>> = vec![];
    for degree in 0..=DEGREE {
        for down in 0..=degree {
            let term = |k: usize| {
                let [x, y] = place(k);
                (0..degree).fold(1.0, |product, i| product * if i < down { y } else { x })
            };
            let mut vector: Vec<f64> = shape.disc().zip(&roots).map(|(k, root)| root * term(k)).collect();
            let whole = dot(&vector, &vector).sqrt();
            // Twice, as the first time leaves what roundings make of it.
            for _ in 0..2 {
                for other in &found {
                    let part = dot(&vector, other);
                    vector.iter_mut().zip(other).for_each(|(v, o)| *v -= part * o);
                }
            }
            let length = dot(&vector, &vector).sqrt();
            if length > 1e-6 * whole {
                vector.iter_mut().for_each(|v| *v /= length);
                found.push(vector);
            }
        }
    }
    found[1..].concat()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axes_are_of_length_1_and_at_right_angles() {
        for side in [3, 4, 5, 8, 21, 64] {
            let shape = PatchShape::new(side).unwrap();
            let basis = basis(&shape);
            let axes: Vec<&[f64]> = basis.chunks_exact(shape.disc_values()).collect();
            assert!(axes.len() <= DIMS - 2 && (side < 6 || axes.len() == DIMS - 2), "side {side}: {}", axes.len());
            for (i, a) in axes.iter().enumerate() {
                assert!(dot(a, shape.roots()).abs() < 1e-12);
                for (j, b) in axes.iter().enumerate() {
                    assert!((dot(a, b) - if i == j { 1.0 } else { 0.0 }).abs() < 1e-12, "side {side}: {i} {j}");
                }
            }
        }
    }

    /// Leaves hold as many atoms as `split` leaves there.
    #[test]
    fn halves_of_halves() {
        fn halves(count: usize, leaves: usize) -> Vec<usize> {
            match leaves {
                1 => vec![count],
                _ => [halves(count.div_ceil(2), leaves / 2), halves(count / 2, leaves / 2)].concat(),
            }
        }
        for count in 0..200 {
            for leaves in [1, 2, 4, 8, 16] {
                let counts = (0..leaves).map(|leaf| (count + leaves - 1 - reversed(leaf, leaves)) / leaves);
                assert_eq!(counts.collect::<Vec<_>>(), halves(count, leaves), "{count} in {leaves}");
            }
        }
    }
}
