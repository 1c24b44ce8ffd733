//! Light and shadow on a relief.
//!
//! Half of the light comes from the north-west, as cartographers have it; the other half from four sides, each
//! weighted by how much the slope faces across it, so that ridges which run with the main light stand out as well
//! (Mark 1992, Multidirectional, oblique-weighted, shaded-relief image, USGS Open-File Report 92-422).

use super::raster::Averaged;
use rayon::prelude::*;

/// Altitude of every light above the horizon, in degrees.
const ALTITUDE: f32 = 45.0;
/// Cosine and sine of 45 degrees, which is the altitude of the lights and the step of their azimuths.
const HALF_ROOT: f32 = std::f32::consts::FRAC_1_SQRT_2;
/// East and north of the main light, azimuth 315 degrees.
const MAIN: (f32, f32) = (-HALF_ROOT, HALF_ROOT);
/// East and north of the lights at azimuths 225, 270, 315 and 360 degrees.
const SIDES: [(f32, f32); 4] = [(-HALF_ROOT, -HALF_ROOT), (-1.0, 0.0), (-HALF_ROOT, HALF_ROOT), (0.0, 1.0)];
/// Part of the light that is the main one's.
const MAIN_SHARE: f32 = 0.55;

/// Brightness of level ground.
pub(super) const LEVEL: f32 = HALF_ROOT;

/// Brightness, 0 to 1, of a slope that rises `east` metres a metre eastwards and `north` northwards.
pub(super) fn brightness(east: f32, north: f32) -> f32 {
    debug_assert!((ALTITUDE.to_radians().sin() - HALF_ROOT).abs() < 1e-6, "one constant for both");
    let steep2 = east * east + north * north;
    let length = (1.0 + steep2).sqrt();
    let lit = |light: (f32, f32)| ((HALF_ROOT - HALF_ROOT * (east * light.0 + north * light.1)) / length).max(0.0);
    if steep2 < 1e-12 {
        return LEVEL;
    }
    // The squared sine between the slope's aspect and each light; the four sum to 2.
    let sides: f32 = SIDES
        .iter()
        .map(|&light| {
            let along = east * light.0 + north * light.1;
            lit(light) * (1.0 - along * along / steep2)
        })
        .sum();
    MAIN_SHARE * lit(MAIN) + (1.0 - MAIN_SHARE) * sides / 2.0
}

/// Rises eastwards and northwards, in metres a metre, at every cell (Horn 1981); NaN at voids.
///
/// Where a neighbour is missing the slope goes on as it does on the other side, so that a plane has the same slope
/// up to its edges.
pub(super) fn slopes(relief: &Averaged) -> Vec<(f32, f32)> {
    let (rows, cols) = (relief.rows, relief.cols);
    let mut out = vec![(f32::NAN, f32::NAN); rows * cols];
    out.par_chunks_mut(cols).enumerate().for_each(|(row, line)| {
        let (dx, dy) = (8.0 * relief.cell_x_m[row] as f32, 8.0 * relief.cell_y_m as f32);
        for (col, cell) in line.iter_mut().enumerate() {
            let here = relief.elevation_m[row * cols + col];
            if here.is_nan() {
                continue;
            }
            let known = |dr: isize, dc: isize| {
                let (r, c) = (row.checked_add_signed(dr)?, col.checked_add_signed(dc)?);
                let value = if r < rows && c < cols { relief.elevation_m[r * cols + c] } else { f32::NAN };
                value.is_finite().then_some(value)
            };
            let side = |dr: isize, dc: isize| {
                known(dr, dc).unwrap_or_else(|| known(-dr, -dc).map_or(here, |other| 2.0 * here - other))
            };
            let (n, e, s, w) = (side(-1, 0), side(0, 1), side(1, 0), side(0, -1));
            let corner = |dr: isize, dc: isize, plane: f32| known(dr, dc).unwrap_or(plane);
            let (nw, ne) = (corner(-1, -1, n + w - here), corner(-1, 1, n + e - here));
            let (sw, se) = (corner(1, -1, s + w - here), corner(1, 1, s + e - here));
            let east = ((ne + 2.0 * e + se) - (nw + 2.0 * w + sw)) / dx;
            let north = ((nw + 2.0 * n + ne) - (sw + 2.0 * s + se)) / dy;
            *cell = (east, north);
        }
    });
    out
}

/// By how much heights are exaggerated so that the steep parts of a relief look steep.
///
/// At small scales slopes are averaged away; the steepest tenth is brought to about 35 degrees, never below nature.
pub(super) fn exaggeration(slopes: &[(f32, f32)]) -> f32 {
    // A sample is enough, and a regular one is the same on every run.
    let stride = (slopes.len() / 50_000).max(1);
    let mut steep: Vec<f32> =
        slopes.iter().step_by(stride).map(|s| s.0.hypot(s.1)).filter(|s| *s > 1e-6 && s.is_finite()).collect();
    if steep.is_empty() {
        return 1.0;
    }
    let rank = (steep.len() * 9 / 10).min(steep.len() - 1);
    let (_, &mut steepest, _) = steep.select_nth_unstable_by(rank, f32::total_cmp);
    (WANTED_RISE / steepest).clamp(1.0, MOST_EXAGGERATION)
}

/// Tangent of the slope that the steepest tenth of the relief is brought to.
const WANTED_RISE: f32 = 0.7;
/// More would show the steps of whole metres on plains instead of the land.
const MOST_EXAGGERATION: f32 = 60.0;

/// Brightness of every cell, 0 to 1, with heights `exaggeration` times nature; NaN at voids.
pub(super) fn hillshade(slopes: &[(f32, f32)], exaggeration: f32) -> Vec<f32> {
    slopes
        .par_iter()
        .map(
            |&(east, north)| {
                if east.is_nan() { f32::NAN } else { brightness(east * exaggeration, north * exaggeration) }
            },
        )
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::GeoTransform;
    use crate::plot::map::Relief;

    /// The definition by angles, in double precision.
    fn analytic(east: f64, north: f64) -> f64 {
        let slope = east.hypot(north).atan();
        // Azimuth that the slope looks to: downhill.
        let aspect = (-east).atan2(-north);
        let altitude = f64::from(ALTITUDE).to_radians();
        let lit = |azimuth: f64| {
            let lambert =
                altitude.sin() * slope.cos() + altitude.cos() * slope.sin() * (azimuth.to_radians() - aspect).cos();
            lambert.max(0.0)
        };
        let sides: f64 = [225.0_f64, 270.0, 315.0, 360.0]
            .iter()
            .map(|&azimuth| (aspect - azimuth.to_radians()).sin().powi(2) * lit(azimuth))
            .sum();
        f64::from(MAIN_SHARE) * lit(315.0) + (1.0 - f64::from(MAIN_SHARE)) * sides / 2.0
    }

    #[test]
    fn a_plane_has_its_analytic_brightness_up_to_the_edges() {
        for (east, north) in [(0.3, 0.1), (-0.7, 0.4), (0.0, -1.2), (2.0, -2.0), (-0.05, 0.0)] {
            let (rows, cols) = (5, 6);
            let elevation_m = (0..rows)
                .flat_map(|r| {
                    (0..cols).map(move |c| (1000.0 + 10.0 * east * c as f64 - 20.0 * north * r as f64) as f32)
                })
                .collect();
            let t = GeoTransform([0.0, 10.0, 0.0, 0.0, 0.0, -20.0]);
            let relief = Relief::new(rows, cols, elevation_m, t, None).unwrap().averaged(rows, cols, None);
            for shade in hillshade(&slopes(&relief), 1.0) {
                assert!((f64::from(shade) - analytic(east, north)).abs() < 1e-4, "{east} {north}: {shade}");
            }
        }
    }

    #[test]
    fn level_ground_is_as_bright_as_the_lights_are_high() {
        assert!((f64::from(brightness(0.0, 0.0)) - 45.0_f64.to_radians().sin()).abs() < 1e-7);
        assert!((brightness(1e-5, 0.0) - LEVEL).abs() < 1e-4, "no step beside level ground");
    }

    #[test]
    fn slopes_to_the_north_west_are_bright() {
        let (bright, dark) = (brightness(0.5, -0.5), brightness(-0.5, 0.5));
        assert!(bright > LEVEL && dark < LEVEL, "{bright} {dark}");
    }

    #[test]
    fn voids_stay_voids_and_cast_no_cliffs() {
        let mut elevation_m = vec![500.0_f32; 25];
        elevation_m[12] = f32::NAN;
        let relief = Relief::new(5, 5, elevation_m, GeoTransform::PIXELS, None).unwrap().averaged(5, 5, None);
        let shade = hillshade(&slopes(&relief), 1.0);
        assert!(shade[12].is_nan());
        assert!(shade.iter().enumerate().all(|(i, &s)| i == 12 || s == LEVEL));
    }

    #[test]
    fn gentle_relief_is_exaggerated_and_steep_relief_is_not() {
        assert_eq!(exaggeration(&[(2.0, 0.0); 10]), 1.0);
        assert!((exaggeration(&[(0.07, 0.0); 10]) - 10.0).abs() < 1e-3);
        assert_eq!(exaggeration(&[(0.0, 0.0), (f32::NAN, f32::NAN)]), 1.0);
    }
}
