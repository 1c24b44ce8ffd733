//! Places that erosion leaves as they are.

use super::relief::Relief;

/// Places on a raster around which what erosion took is given back: peaks and saddles.
///
/// Argudo, Galin, Peytavie, Paris and Guérin, "Orometry-based terrain analysis and synthesis", ACM Transactions on
/// Graphics 38(6), 2019, section 6.3: the elevation after a step is E + g(d/R) (H - E), where H was it before and E is
/// it after erosion, d the distance to the nearest place, R the radius of influence and g(r) = (1 - r²)³. (The paper
/// prints ΔH = E - H, which would take the same away again.)
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Anchors {
    /// Cells with influence in rising order, and how much.
    kept: Vec<(u32, f32)>,
}

impl Anchors {
    /// Anchors at rows and columns of cells, with a radius in metres.
    ///
    /// # Complexity
    /// O(cells within the radius of any anchor).
    pub fn new(relief: &Relief, places: &[[usize; 2]], radius_m: f64) -> Self {
        let [width_m, height_m] = relief.cell_m().map(f64::from);
        let reach = |cell_m: f64| (radius_m / cell_m).floor().clamp(0.0, 1e9) as usize;
        let (down, across) = (reach(height_m), reach(width_m));
        let mut kept = vec![];
        for &[row, col] in places.iter().filter(|[row, col]| *row < relief.rows() && *col < relief.cols()) {
            for near_row in row.saturating_sub(down)..=(row + down).min(relief.rows() - 1) {
                for near_col in col.saturating_sub(across)..=(col + across).min(relief.cols() - 1) {
                    let dy = near_row.abs_diff(row) as f64 * height_m;
                    let dx = near_col.abs_diff(col) as f64 * width_m;
                    let rest = 1.0 - (dx * dx + dy * dy) / (radius_m * radius_m);
                    let weight = if dx == 0.0 && dy == 0.0 { 1.0 } else { rest.max(0.0) };
                    if weight > 0.0 {
                        kept.push(((near_row * relief.cols() + near_col) as u32, (weight * weight * weight) as f32));
                    }
                }
            }
        }
        // The nearest anchor counts: the greatest of the weights.
        kept.sort_unstable_by(|a, b| a.0.cmp(&b.0).then(b.1.total_cmp(&a.1)));
        kept.dedup_by_key(|(cell, _)| *cell);
        Self { kept }
    }

    /// Takes note of the elevations around the places before a step of erosion.
    pub fn before(&self, relief: &Relief) -> Vec<f32> {
        self.kept.iter().map(|&(cell, _)| relief.z_m()[cell as usize]).collect()
    }

    /// Gives back what a step took around the places.
    ///
    /// # Panics
    /// When `before` is not what [`Anchors::before`] returned.
    pub fn give_back(&self, relief: &mut Relief, before: &[f32]) {
        assert_eq!(before.len(), self.kept.len(), "elevations of these anchors");
        let z = relief.z_m_mut();
        for (&(cell, weight), &before) in self.kept.iter().zip(before) {
            let z = &mut z[cell as usize];
            // At the place itself the elevation is what it was, to the bit.
            *z = if weight == 1.0 { before } else { *z + weight * (before - *z) };
        }
    }
}
