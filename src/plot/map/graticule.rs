//! Ticks round the map with the coordinates of the relief's CRS.

use super::canvas::{Canvas, Pen};
use super::frame::Frame;
use super::legend::QUIET;
use super::text::{Align, Font, Lettering, grouped};
use super::tint::round_step;

/// Steps between ticks on maps of longitudes and latitudes, in seconds of arc.
const SECONDS: [u32; 20] =
    [1, 2, 5, 10, 20, 30, 60, 120, 300, 600, 1200, 1800, 3600, 7200, 18_000, 36_000, 72_000, 108_000, 162_000, 216_000];
/// Least distance of two ticks in pixels.
const APART: f64 = 120.0;

/// Writes a coordinate, given the letters of the positive and the negative side.
type Labels = Box<dyn Fn(f64, [&str; 2]) -> String>;

/// Draws ticks round the frame whose upper left corner lies at `left`, `top`.
pub(super) fn draw_ticks(
    canvas: &mut Canvas,
    frame: &Frame,
    degrees: Option<f64>,
    (left, top): (f32, f32),
    font: &Font,
    s: f32,
) {
    let wanted = frame.units(APART * f64::from(s));
    let (step, labels): (f64, Labels) = match degrees {
        Some(degrees) => {
            let Some(seconds) = SECONDS.into_iter().find(|&step| f64::from(step) >= wanted * degrees * 3600.0) else {
                return;
            };
            let step = f64::from(seconds) / 3600.0 / degrees;
            (step, Box::new(move |value, signs| angle(value * degrees, seconds, signs)))
        }
        // Less than a unit apart they would need decimals, which nobody reads from a map's edge.
        None if wanted < 0.5 => return,
        None => (round_step(wanted), Box::new(|value, _| grouped(value))),
    };
    let lettering = Lettering { font, size: 9.5 * s, ink: QUIET, halo: None };
    let pen = Pen::solid(QUIET, 0.9 * s);
    let (right, bottom) = (left + frame.width as f32, top + frame.height as f32);
    let tick = 5.0 * s;
    let [meridians, parallels] = frame.multiples(step);
    for (value, along) in meridians {
        let x = left + along;
        canvas.polyline(&[(x, bottom), (x, bottom + tick)], &pen);
        canvas.polyline(&[(x, top), (x, top - tick)], &pen);
        let label = labels(value, ["E", "W"]);
        let half = lettering.width(&label) / 2.0;
        if x - half >= left && x + half <= right {
            lettering.write(canvas, &label, (x, bottom + tick + 8.5 * s), Align::Centre);
        }
    }
    for (value, along) in parallels {
        let y = top + along;
        canvas.polyline(&[(left, y), (left - tick, y)], &pen);
        canvas.polyline(&[(right, y), (right + tick, y)], &pen);
        let label = labels(value, ["N", "S"]);
        let half = lettering.width(&label) / 2.0;
        if y - half >= top && y + half <= bottom {
            lettering.write_upwards(canvas, &label, (left - tick - 1.5 * s, y));
        }
    }
}

/// An angle in degrees, minutes and seconds, as far as a step in seconds needs them.
fn angle(degrees: f64, step_seconds: u32, [positive, negative]: [&str; 2]) -> String {
    let mut seconds = (degrees * 3600.0).round();
    // Longitudes may run on to 360 degrees or beyond -180; latitudes never do.
    if seconds.abs() > 648_000.0 {
        seconds -= 1_296_000.0 * (seconds / 1_296_000.0).round();
    }
    let sign = match seconds.abs() {
        whole if whole == 0.0 || whole == 648_000.0 => "",
        _ if seconds > 0.0 => positive,
        _ => negative,
    };
    let whole = seconds.abs() as u64;
    let (d, m, sec) = (whole / 3600, whole / 60 % 60, whole % 60);
    if step_seconds.is_multiple_of(3600) {
        format!("{d}°{sign}")
    } else if step_seconds.is_multiple_of(60) {
        format!("{d}°{m:02}′{sign}")
    } else {
        format!("{d}°{m:02}′{sec:02}″{sign}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn angles_with_as_many_parts_as_they_need() {
        let longitude = |degrees: f64, step: u32| angle(degrees, step, ["E", "W"]);
        assert_eq!(longitude(9.0, 3600), "9°E");
        assert_eq!(longitude(9.0 + 1.0 / 6.0, 600), "9°10′E");
        assert_eq!(longitude(-9.5, 30), "9°30′00″W");
        assert_eq!(longitude(0.0, 3600), "0°");
        assert_eq!(longitude(180.0, 3600), "180°");
        assert_eq!(longitude(-180.0, 3600), "180°");
        assert_eq!(longitude(200.0, 3600), "160°W");
        assert_eq!(longitude(359.999_999_999, 3600), "0°");
        assert_eq!(angle(-46.5, 1800, ["N", "S"]), "46°30′S");
    }

    #[test]
    fn every_scale_has_a_step() {
        assert!(SECONDS.windows(2).all(|w| w[0] < w[1]));
        assert!(SECONDS.iter().all(|s| 1_296_000 % s == 0), "whole turns");
    }
}
