//! Depressions filled.

use super::basins::Basins;
use super::drainage::downhill;
use super::relief::Relief;
use rayon::prelude::*;

/// The elevations to which depressions fill until they overflow, in metres; elsewhere the elevation itself.
///
/// The same as [`Drainage::levels_m`](super::Drainage::levels_m) for those who do not need the ways of water.
///
/// # Complexity
/// O(n) for n cells, and O(b log b) for the b pairs of neighbours on the borders between depressions.
pub fn fill(relief: &Relief) -> Vec<f32> {
    let basins = Basins::of(relief, &downhill(relief));
    let mut levels_m = vec![f32::NEG_INFINITY; basins.pits.len()];
    for way in &basins.ways {
        levels_m[way.basin as usize] = way.top_m.max(levels_m[way.beyond as usize]);
    }
    // Ground is compared, never a void: that stays one.
    let level = |(&z, &basin): (&f32, &u32)| if levels_m[basin as usize] > z { levels_m[basin as usize] } else { z };
    relief.z_m().par_iter().zip(&basins.of).map(level).collect()
}
