//! Rivers cut into the ground.

use super::drainage::Drainage;
use super::relief::Relief;

/// A step in time of the stream power law, ∂h/∂t = -K A^½ ∂h/∂x, at all cells but those where water leaves.
///
/// `strength` is K times the step in time, per metre of the square root of the drained area. The step is implicit
/// (Braun and Willett, "A very efficient O(n), implicit and parallel method to solve the stream power equation",
/// Geomorphology 180, 2013, equation 22 with n = 1 and m = 1/2): each cell comes to lie between itself and its
/// receiver's new elevation, however long the step is. A cell that is not above its receiver lies in a depression:
/// there is a lake, and nothing changes.
///
/// # Panics
/// When the relief, the drainage and the areas differ in their number of cells.
///
/// # Complexity
/// O(n).
pub fn incise(relief: &mut Relief, drainage: &Drainage, areas_cells: &[u32], strength: f64) {
    let [width_m, height_m] = relief.cell_m();
    let per_m = relief.distances_m().map(|distance| strength as f32 * (width_m * height_m).sqrt() / distance);
    let z = relief.z_m_mut();
    for &cell in drainage.order() {
        let cell = cell as usize;
        let Some((receiver, direction)) = drainage.receiver(cell).zip(drainage.direction(cell)) else { continue };
        if z[receiver] < z[cell] {
            let pull = per_m[direction] * (areas_cells[cell] as f32).sqrt();
            // Never below the receiver, whatever is rounded.
            z[cell] = ((z[cell] + pull * z[receiver]) / (1.0 + pull)).max(z[receiver]);
        }
    }
}
