//! How high land is in the mean, from a raster.

use super::super::land::Land;
use super::super::land_map::LandMap;
use crate::error::{Error, ErrorKind, Result};
use crate::synthesis::terrain::Ground;
use crate::watch::Watch;
use std::path::Path;

/// Side in metres of the blocks of which the mean is taken.
const BLOCK_M: f64 = 1000.0;
/// Most rows and columns of blocks.
const MOST: usize = 1000;
/// Places at which the map is looked at along a side of a block.
const LOOKS: usize = 8;

/// The means of blocks of land, from a raster of elevations.
///
/// # Errors
/// A raster that cannot be read, is in another CRS, does not cover the land, or has a void as large as a block.
pub(super) fn read_ground(
    path: &Path,
    land: &Land,
    cell_m: [f64; 2],
    memory: Option<u64>,
    watch: &Watch,
) -> Result<Ground> {
    let map = LandMap::read(path, land, memory, watch)?;
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a number of blocks")]
    let blocks = |cells: usize, cell_m: f64| ((cells as f64 * cell_m / BLOCK_M).round() as usize).clamp(1, MOST);
    let size = [blocks(land.rows, cell_m[1]), blocks(land.cols, cell_m[0])];
    let mut z_m = Vec::with_capacity(size[0] * size[1]);
    for row in 0..size[0] {
        for col in 0..size[1] {
            let (mut sum, mut count) = (0.0, 0_u32);
            for look in 0..LOOKS * LOOKS {
                let at = |block: usize, look: usize, blocks: usize, cells: usize| {
                    (block as f64 + (look as f64 + 0.5) / LOOKS as f64) * cells as f64 / blocks as f64 - 0.5
                };
                let (x, y) = land
                    .transform
                    .centre(at(row, look / LOOKS, size[0], land.rows), at(col, look % LOOKS, size[1], land.cols));
                let elevation_m = map.elevation_m(map.cell(x, y)?);
                if !elevation_m.is_nan() {
                    (sum, count) = (sum + elevation_m, count + 1);
                }
            }
            z_m.push(if count > 0 { (sum / f64::from(count)) as f32 } else { f32::NAN });
        }
    }
    // Voids are as high as the mean of what is known beside them, from near to far.
    while z_m.iter().any(|z| z.is_nan()) {
        let before = z_m.clone();
        for (block, z) in z_m.iter_mut().enumerate().filter(|(_, z)| z.is_nan()) {
            let (row, col) = (block / size[1], block % size[1]);
            let rows = row.saturating_sub(1)..(row + 2).min(size[0]);
            let near = rows.flat_map(|row| &before[row * size[1]..][col.saturating_sub(1)..(col + 2).min(size[1])]);
            let (mut sum, mut count) = (0.0, 0.0);
            near.filter(|z| !z.is_nan()).for_each(|z| (sum, count) = (sum + z, count + 1.0));
            if count > 0.0 {
                *z = sum / count;
            }
        }
        if before.iter().all(|z| z.is_nan()) {
            return Err(Error::new(ErrorKind::Input, "the map has no data on the land").at_path(path));
        }
    }
    Ok(Ground { size, z_m })
}
