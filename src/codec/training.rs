//! What a trainer of tables needs of the encoder: `tools/train` is its only user.

use super::Cells;
use super::encode::{Fitted, Pyramid, TileEncoder};
use super::level::levels;
use super::mask::void_levels;
use super::pass::TileRule;
use super::tile::{BandRule, TileShape};
use super::values::{Mapped, find_voids, map_cells};
use crate::error::Result;

/// Residuals and parameters of one tile.
pub struct Observed {
    /// For each pass its residuals: number of the plain table, symbol.
    pub residuals: Vec<Vec<(u16, u8)>>,
    /// For each pass its parameters.
    pub passes: Vec<(usize, bool, i64, usize, Vec<i32>, Vec<u8>)>,
}

/// Encodes a tile and tells what was coded; nothing for tiles of one value.
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
    let mut coded = TileEncoder::new(&pyramid, TileRule::new(mapping.step, mapping.range_bits, serial));
    coded.observed = Some(Default::default());
    for level in (0..levels).rev() {
        coded.code_level(level)?;
    }
    let observed = coded.observed.unwrap_or_default();
    let tell = |f: Fitted| (f.pass, f.serial, f.step, f.cells, f.filter, f.codes);
    Ok(Observed { residuals: observed.spread, passes: observed.fitted.into_iter().map(tell).collect() })
}
