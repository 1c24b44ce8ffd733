//! Which cells are voids: level by level in the order of the passes, so that a coarse level knows its own.
//!
//! Where all four nearest cells agree, runs of [`RUN`] cells of a row share one bit as long as they do what their
//! neighbours do.

use super::binary::{Adaptive, BinaryDecoder, BinaryEncoder};
use super::level::plane_shape;
use super::plane::Plane;
use super::taps::{Known, PASSES, Pass};
use super::tile::TileShape;
use crate::error::{Error, ErrorKind, Result};

/// Cells that share a bit.
const RUN: usize = 32;

/// Reads or writes bits with contexts.
pub(super) trait Bits {
    /// Writes a bit, or reads one whatever is given.
    fn bit(&mut self, bit: bool, context: &mut Adaptive) -> bool;
}

impl Bits for BinaryEncoder {
    fn bit(&mut self, bit: bool, context: &mut Adaptive) -> bool {
        self.put(bit, context.probability());
        context.learn(bit);
        bit
    }
}

impl Bits for BinaryDecoder<'_> {
    fn bit(&mut self, _: bool, context: &mut Adaptive) -> bool {
        let bit = self.get(context.probability());
        context.learn(bit);
        bit
    }
}

/// Contexts of one segment.
struct Contexts {
    /// Whether a run does as its neighbours, by the void or the cells around it.
    run: [[Adaptive; 2]; 3],
    /// A cell, by how many of the nearest are voids and by the cells above and to the left.
    cell: [[Adaptive; 20]; 3],
}

impl Contexts {
    fn new() -> Self {
        Self { run: [[Adaptive::new(); 2]; 3], cell: [[Adaptive::new(); 20]; 3] }
    }
}

/// Codes the voids of a pass; `truth` is what to write, or anything when reading.
fn code_pass<B: Bits>(
    bits: &mut B,
    contexts: &mut Contexts,
    pass: Pass,
    known: Known<'_, u8>,
    (width, height): (usize, usize),
    truth: Option<&Plane<u8>>,
) -> Plane<u8> {
    let mut own = Plane::<u8>::new(width, height);
    if own.is_empty() {
        return own;
    }
    let taps = pass.taps();
    let kind = pass as usize;
    for row in 0..height {
        let near: [Vec<u8>; 4] = std::array::from_fn(|k| known.run(&own, taps[k], row, width).to_vec());
        let above: Vec<u8> = match row {
            0 => known.a.run(0, 0, width).to_vec(),
            _ => own.row(row - 1).to_vec(),
        };
        let truth = truth.map(|truth| truth.row(row));
        let line = own.row_mut(row);
        let sum = |col: usize| near.iter().map(|near| usize::from(near[col])).sum::<usize>();
        let mut col = 0;
        while col < width {
            let end = (col + RUN).min(width);
            let first = sum(col);
            if first % 4 == 0 && (col..end).all(|col| sum(col) == first) {
                let value = u8::from(first == 4);
                let follows = truth.is_some_and(|truth| truth[col..end].iter().all(|&void| void == value));
                if bits.bit(follows, &mut contexts.run[kind][usize::from(value)]) {
                    line[col..end].fill(value);
                    col = end;
                    continue;
                }
            }
            while col < end {
                let left = if col > 0 { line[col - 1] } else { near[0][0] };
                let context = sum(col) * 4 + usize::from(above[col]) * 2 + usize::from(left);
                let void = truth.is_some_and(|truth| truth[col] != 0);
                line[col] = u8::from(bits.bit(void, &mut contexts.cell[kind][context]));
                col += 1;
            }
        }
    }
    own.close();
    own
}

/// The voids of a level, and of its planes.
#[derive(Clone, Debug)]
pub(super) struct VoidLevel {
    /// All cells of the level.
    pub(super) cells: Plane<u8>,
    /// Its planes C, H and V.
    pub(super) planes: [Plane<u8>; 3],
}

fn code_level<B: Bits>(
    bits: &mut B,
    contexts: &mut Contexts,
    coarser: &Plane<u8>,
    shape: TileShape,
    truth: Option<&[Plane<u8>; 3]>,
) -> VoidLevel {
    let mut planes: [Plane<u8>; 3] = Default::default();
    for (index, pass) in PASSES.into_iter().enumerate() {
        let [c, h, _] = &planes;
        let known = Known { a: coarser, c, h };
        let size = plane_shape(pass, shape);
        let made = code_pass(bits, contexts, pass, known, size, truth.map(|truth| &truth[index]));
        planes[index] = made;
    }
    VoidLevel { cells: Plane::woven([coarser, &planes[0], &planes[1], &planes[2]]), planes }
}

/// The voids of all levels of a tile, finest first, from those of its cells.
pub(super) fn void_levels(voids: &[u8], shape: TileShape, levels: u8) -> Vec<VoidLevel> {
    let mut found = Vec::with_capacity(usize::from(levels));
    let mut cells = voids.to_vec();
    let mut width = shape.width;
    for _ in 0..levels {
        let planes = PASSES.map(|pass| {
            let (row, col) = pass.origin();
            let mut plane = Plane::quarter(&cells, width, row, col);
            plane.close();
            plane
        });
        let a = Plane::quarter(&cells, width, 0, 0);
        found.push(VoidLevel { cells: Plane::framed(&cells, width), planes });
        cells = (0..a.height).flat_map(|row| a.row(row).to_vec()).collect();
        width = a.width;
    }
    found
}

/// Writes the voids of the levels of a segment; `finer` are those of all levels, finest first.
pub(super) fn encode_voids(finer: &[VoidLevel], top: u8, shape: TileShape, span: std::ops::Range<u8>) -> Vec<u8> {
    let mut bits = BinaryEncoder::new();
    let mut contexts = Contexts::new();
    let top = Plane::framed(&[top], 1);
    for level in span.rev() {
        let coarser = finer.get(usize::from(level) + 1).map_or(&top, |level| &level.cells);
        code_level(&mut bits, &mut contexts, coarser, shape.at_level(level), Some(&finer[usize::from(level)].planes));
    }
    bits.finish()
}

/// Reads the voids of the levels of a segment, coarse to fine, down to `finest`; `coarser` are those of the level
/// above.
pub(super) fn decode_voids(
    bytes: &[u8],
    coarser: &Plane<u8>,
    shape: TileShape,
    span: std::ops::Range<u8>,
) -> Result<Vec<VoidLevel>> {
    let mut bits = BinaryDecoder::new(bytes);
    let mut contexts = Contexts::new();
    let mut found: Vec<VoidLevel> = Vec::new();
    for level in span.rev() {
        let coarser = found.last().map_or(coarser, |level| &level.cells);
        let made = code_level(&mut bits, &mut contexts, coarser, shape.at_level(level), None);
        found.push(made);
        if bits.is_beyond() {
            return Err(Error::new(ErrorKind::Corrupt, "the tile's mask ends early"));
        }
    }
    match bits.is_done() {
        true => Ok(found),
        false => Err(Error::new(ErrorKind::Corrupt, "the tile's mask does not end where it should")),
    }
}
