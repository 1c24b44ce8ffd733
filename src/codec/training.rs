//! What a trainer of tables needs of the encoder: `tools/train` is its only user.

use super::Cells;
use super::context::{TileRule, greatest_coarseness};
use super::encode::{Pyramid, TileEncoder};
use super::encode_tile::coarseness_of;
use super::level::levels;
use super::mask::void_levels;
use super::tile::{BandRule, TileShape};
use super::values::{Mapped, find_voids, map_cells};
use crate::error::Result;

/// Parameters of a pass, for training.
#[derive(Clone, Debug)]
pub struct Fitted {
    /// The pass: 0 C, 1 H, 2 V.
    pub pass: usize,
    /// Whether the pass is serial.
    pub serial: bool,
    /// The quantiser's step.
    pub step: i64,
    /// Cells of the pass.
    pub cells: usize,
    /// The filter of the steep class.
    pub filter: Vec<i32>,
    /// Codes of the weights of errors.
    pub codes: Vec<u8>,
}

/// Residuals and parameters of one tile.
pub struct Observed {
    /// For each pass its residuals: number of the plain table, symbol.
    pub residuals: Vec<Vec<(u16, u8)>>,
    /// For each pass its parameters.
    pub passes: Vec<Fitted>,
}

/// Encodes a tile, with serial passes or without, and tells what was coded; nothing for tiles of one value.
///
/// # Errors
/// As [`super::encode_tile`].
pub fn observe(cells: &Cells, shape: TileShape, rule: &BandRule, serial: bool) -> Result<Observed> {
    let voids = find_voids(cells, rule);
    let Mapped { mapping, xs } = map_cells(cells, &voids, rule, false);
    if mapping.range_bits == 0 || mapping.range_bits > 31 {
        return Ok(Observed { residuals: Vec::new(), passes: Vec::new() });
    }
    let levels = levels(shape);
    let holes = if voids.is_empty() { Vec::new() } else { void_levels(&voids, shape, levels) };
    let pyramid = Pyramid::<i32>::new(&xs, shape, levels, &holes);
    let coarseness = coarseness_of(&xs, &voids, shape.width, mapping.step).min(greatest_coarseness(mapping.range_bits));
    let rule = TileRule { step: mapping.step, coarseness };
    let mut coded = TileEncoder::new(&pyramid, rule);
    coded.serial = Some(serial);
    coded.observed = Some(Default::default());
    for level in (0..levels).rev() {
        coded.code_level(level)?;
    }
    let observed = coded.observed.unwrap_or_default();
    Ok(Observed { residuals: observed.spread, passes: observed.fitted })
}
