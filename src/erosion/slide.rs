//! Slopes that are too steep come down.

use super::drainage::Drainage;
use super::relief::Relief;

/// Lowers every cell that stands steeper above the one it drains to than `slope`, a rise over a run, until none does.
///
/// # Panics
/// When the relief and the drainage differ in their number of cells.
///
/// # Complexity
/// O(n).
pub fn slide(relief: &mut Relief, drainage: &Drainage, slope: f64) {
    let rises_m = relief.distances_m().map(|distance| slope as f32 * distance);
    let z = relief.z_m_mut();
    for &cell in drainage.order() {
        let cell = cell as usize;
        if let Some((receiver, direction)) = drainage.receiver(cell).zip(drainage.direction(cell)) {
            z[cell] = z[cell].min(z[receiver] + rises_m[direction]);
        }
    }
}
