//! How large cells are on the ground.

use crate::crs::{Crs, CrsKind};
use crate::grid::GeoTransform;

/// Sides that differ by less than this part are as good as equal. A regression learned on cells of one size suits
/// others of about that size, while resampling would wear down the detail that is to be learned.
const ALIKE: f64 = 0.1;
/// How many times finer cells may be made along one axis.
const MOST_FINER: f64 = 2.0;

/// Metres from one column and from one row to the next.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct CellSize {
    pub(super) across_m: f64,
    pub(super) down_m: f64,
}

impl CellSize {
    /// Of a raster's cells; of longitudes and latitudes, in the raster's middle. Coordinates without a CRS are metres.
    pub(super) fn of(transform: &GeoTransform, crs: Option<&Crs>, rows: usize, cols: usize) -> Self {
        let t = &transform.0;
        let [across, down] = [(t[1], t[4]), (t[2], t[5])];
        let length = |(x, y): (f64, f64), x_m: f64, y_m: f64| {
            let (x, y) = (x * x_m, y * y_m);
            (x * x + y * y).sqrt()
        };
        let (x_m, y_m) = match crs.map(|crs| &crs.kind) {
            Some(CrsKind::Geographic { ellipsoid, degrees }) => {
                let middle = transform.centre((rows as f64 - 1.0) / 2.0, (cols as f64 - 1.0) / 2.0);
                let lat = (middle.1 * degrees).clamp(-89.0, 89.0);
                let (south, north) = (ellipsoid.meridian(lat - 0.5), ellipsoid.meridian(lat + 0.5));
                let (x, z) = (north.0 - south.0, north.1 - south.1);
                let along = ellipsoid.meridian(lat).0 * 1f64.to_radians();
                (degrees * along, degrees * (x * x + z * z).sqrt())
            }
            Some(CrsKind::Projected { metres, .. } | CrsKind::Local { metres }) => (*metres, *metres),
            None => (1.0, 1.0),
        };
        Self { across_m: steady(length(across, x_m, y_m)), down_m: steady(length(down, x_m, y_m)) }
    }

    /// Of sides as they are said, in metres.
    pub(super) fn said([across_m, down_m]: [f64; 2]) -> Self {
        Self { across_m: steady(across_m), down_m: steady(down_m) }
    }

    /// What to say on a command line for cells of this size.
    pub(super) fn option(self) -> String {
        let side = |m: f64| format!("{}m", m as f32);
        match self.across_m == self.down_m {
            true => side(self.across_m),
            false => format!("{},{}", side(self.across_m), side(self.down_m)),
        }
    }

    /// Cells so many times smaller.
    pub(super) fn divided(self, factor: usize) -> Self {
        let factor = factor as f64;
        Self { across_m: self.across_m / factor, down_m: self.down_m / factor }
    }

    /// Cells so many times larger.
    pub(super) fn times(self, factor: f64) -> Self {
        Self { across_m: self.across_m * factor, down_m: self.down_m * factor }
    }

    /// Rows as columns.
    pub(super) fn transposed(self) -> Self {
        Self { across_m: self.down_m, down_m: self.across_m }
    }

    /// Whether rows and columns are about as far from each other.
    pub(super) fn is_square(self) -> bool {
        are_alike(self.across_m, self.down_m)
    }

    /// Whether the cells are about as large as others.
    pub(super) fn is_like(self, other: Self) -> bool {
        are_alike(self.across_m, other.across_m) && are_alike(self.down_m, other.down_m)
    }

    /// Whether the cells are clearly larger than others, along one axis at least.
    pub(super) fn exceed(self, other: Self) -> bool {
        (self.across_m / other.across_m).max(self.down_m / other.down_m) > 1.0 + ALIKE
    }

    /// How many times as large as others the cells are: along the axis where that is less, unless it is more than twice
    /// as much along the other.
    pub(super) fn excess(self, other: Self) -> f64 {
        let (across, down) = (self.across_m / other.across_m, self.down_m / other.down_m);
        across.min(down).max(across.max(down) / MOST_FINER)
    }
}

fn are_alike(a: f64, b: f64) -> bool {
    a.max(b) <= a.min(b) * (1.0 + ALIKE)
}

/// The length to about nine digits: sines may differ in their last bits from machine to machine.
fn steady(length_m: f64) -> f64 {
    f64::from(length_m as f32)
}

impl std::fmt::Display for CellSize {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let short = |m: f64| if m >= 100.0 { format!("{m:.0}") } else { format!("{m:.2}") };
        match short(self.across_m) == short(self.down_m) {
            true => write!(f, "{} m", short(self.across_m)),
            false => write!(f, "{} x {} m", short(self.across_m), short(self.down_m)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::crs::Ellipsoid;

    fn crs(kind: CrsKind) -> Crs {
        Crs { wkt: String::new(), name: String::new(), authority: None, kind, projection: None, vertical_unit: None }
    }

    #[test]
    fn longitudes_shrink_towards_the_poles() {
        let geographic = crs(CrsKind::Geographic { ellipsoid: Ellipsoid::WGS84, degrees: 1.0 });
        let size = |lat: f64| {
            let step = 1.0 / 3600.0;
            let transform = GeoTransform([10.0, step, 0.0, lat + 50.0 * step, 0.0, -step]);
            CellSize::of(&transform, Some(&geographic), 100, 100)
        };
        assert!((size(0.0).across_m - 30.922).abs() < 0.001 && (size(0.0).down_m - 30.715).abs() < 0.001);
        assert!((size(60.0).across_m - 15.5).abs() < 0.01 && (size(60.0).down_m - 30.95).abs() < 0.01);
        assert!(size(0.0).is_square() && !size(60.0).is_square());
        assert!(size(90.0).across_m > 0.0);
    }

    #[test]
    fn cells_exceed_others_along_both_axes() {
        let size = |across_m: f64, down_m: f64| CellSize { across_m, down_m };
        assert_eq!(size(30.0, 30.0).excess(size(20.0, 30.0)), 1.0);
        assert_eq!(size(30.0, 60.0).excess(size(10.0, 30.0)), 2.0);
        assert_eq!(size(30.0, 30.0).excess(size(5.0, 30.0)), 3.0, "no more than two times finer");
        assert!(size(30.0, 30.0).exceed(size(20.0, 30.0)) && !size(30.0, 30.0).exceed(size(29.0, 40.0)));
        assert_eq!(size(10.0, 10.0).excess(size(20.0, 40.0)), 0.25);
    }

    #[test]
    fn rotated_and_plane_cells() {
        let turned = GeoTransform([0.0, 3.0, -8.0, 0.0, 4.0, 6.0]);
        let local = crs(CrsKind::Local { metres: 0.3048 });
        assert_eq!(CellSize::of(&turned, None, 5, 5), CellSize { across_m: 5.0, down_m: 10.0 });
        assert!((CellSize::of(&turned, Some(&local), 5, 5).across_m - 1.524).abs() < 1e-6);
    }
}
