//! Signs of the map: triangles for peaks, rings for saddles, lines for divides and isolation.

use super::canvas::{Canvas, Ink, Pen};
use super::classes::Classes;
use super::frame::{Frame, Pixel, smoothed};
use super::overlay::{Overlay, Ridge};
use super::placement::place;
use super::text::Font;

/// Peaks and names.
pub(super) const DARK: Ink = Ink::rgb(30, 28, 32);
/// Divides and saddles.
const BROWN: Ink = Ink::rgb(112, 44, 22);
/// Lines of isolation.
const BLUE: Ink = Ink::rgb(28, 84, 138);

/// The pen of a divide, by its weight among the classes.
pub(super) fn ridge_pen(weight: f32, s: f32) -> Pen {
    Pen::solid(BROWN.opacity(0.7 + 0.25 * weight), (0.9 + 2.1 * weight * weight) * s)
}

/// The pen of a line of isolation.
pub(super) fn isolation_pen(s: f32) -> Pen {
    Pen { ink: BLUE.opacity(0.8), width: 1.1 * s, dash: Some((6.0 * s, 4.0 * s)) }
}

/// Draws the triangle of a peak; `radius` is that of the circle round it.
pub(super) fn triangle(canvas: &mut Canvas, (x, y): Pixel, radius: f32, s: f32) {
    let (half, foot) = (0.866 * radius, 0.5 * radius);
    // Its centre of gravity lies on the summit.
    let corners = [(x, y - radius), (x + half, y + foot), (x - half, y + foot)];
    canvas.polygon(&corners, DARK, Some(Pen::solid(Ink::WHITE.opacity(0.9), 0.9 * s)));
}

/// Radius of a saddle's ring.
pub(super) const SADDLE_RADIUS: f32 = 2.1;

/// Draws the ring of a saddle.
pub(super) fn ring(canvas: &mut Canvas, (x, y): Pixel, s: f32) {
    canvas.circle(x, y, (SADDLE_RADIUS - 0.9) * s, Ink::WHITE, Some(Pen::solid(BROWN, 1.0 * s)));
}

/// What found room on the map.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct Drawn {
    /// Peaks drawn of each class.
    pub(super) peaks: [usize; 5],
    /// Peaks that lie on the map.
    pub(super) peaks_there: usize,
    /// Whether there is a divide on the map.
    pub(super) ridges: bool,
    /// Whether there is a saddle on the map.
    pub(super) saddles: bool,
    /// Whether there is a line of isolation on the map.
    pub(super) isolation: bool,
}

/// Draws an overlay on the map's own canvas, `s` times the usual size.
pub(super) fn draw_overlay(
    canvas: &mut Canvas,
    frame: &Frame,
    overlay: &Overlay,
    classes: &Classes,
    regular: &Font,
    s: f32,
) -> Drawn {
    let mut drawn =
        Drawn { ridges: false, isolation: draw_isolation(canvas, frame, &overlay.isolation, s), ..Drawn::default() };
    drawn.ridges = draw_ridges(canvas, frame, &overlay.ridges, classes, s);

    let placed = place(frame, overlay, classes, regular, s);
    drawn.peaks_there = placed.peaks_there;
    drawn.saddles = !placed.saddles.is_empty();
    for &saddle in &placed.saddles {
        ring(canvas, saddle, s);
    }
    for &(class, pixel) in placed.peaks.iter().rev() {
        drawn.peaks[class.min(4)] += 1;
        triangle(canvas, pixel, classes.radius(class) * s, s);
    }
    for label in &placed.labels {
        label.write(canvas, regular, s);
    }
    drawn
}

/// What a prominence counts for; the unknown counts least.
pub(super) fn rank(prominence_m: f64) -> f64 {
    if prominence_m.is_nan() { f64::NEG_INFINITY } else { prominence_m }
}

fn draw_isolation(canvas: &mut Canvas, frame: &Frame, lines: &[Vec<(f64, f64)>], s: f32) -> bool {
    let pen = isolation_pen(s);
    let mut any = false;
    let mut ink_left = ink_budget(frame, s) / 2.0;
    for part in lines.iter().flat_map(|line| frame.line(line)) {
        if ink_left < 0.0 {
            break;
        }
        ink_left -= length(&part);
        any = true;
        canvas.polyline(&part, &pen);
    }
    any
}

/// Pixels of line that a map bears before it is only lines.
fn ink_budget(frame: &Frame, s: f32) -> f32 {
    frame.width as f32 * frame.height as f32 / (20.0 * s)
}

fn length(line: &[Pixel]) -> f32 {
    line.windows(2).map(|w| (w[1].0 - w[0].0).hypot(w[1].1 - w[0].1)).sum()
}

fn draw_ridges(canvas: &mut Canvas, frame: &Frame, ridges: &[Ridge], classes: &Classes, s: f32) -> bool {
    let mut order: Vec<&Ridge> = ridges.iter().collect();
    order.sort_by(|a, b| rank(b.carried_m).total_cmp(&rank(a.carried_m)));
    let mut ink_left = ink_budget(frame, s);
    let mut lines = Vec::new();
    for ridge in order {
        // A crest that dips deeply is less of a ridge.
        let weight = classes.weight(ridge.carried_m) - 0.35 * classes.weight(ridge.prominence_m);
        for part in frame.line_within(&ridge.path) {
            let part = smoothed(&part, 1.6 * s);
            ink_left -= length(&part);
            lines.push((weight.max(0.0), part));
        }
        if ink_left < 0.0 {
            break;
        }
    }
    // A pale rim under the strong ones lifts them off the shadows; then the weakest first, so that strong ones lie on top.
    for (weight, line) in lines.iter().rev().filter(|(weight, _)| *weight > 0.25) {
        let pen = ridge_pen(*weight, s);
        canvas.polyline(line, &Pen::solid(Ink::WHITE.opacity(0.35), pen.width + 1.8 * s));
    }
    for (weight, line) in lines.iter().rev() {
        canvas.polyline(line, &ridge_pen(*weight, s));
    }
    !lines.is_empty()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::GeoTransform;
    use crate::plot::map::{PeakMark, Relief};

    #[test]
    fn where_peaks_crowd_the_most_prominent_are_drawn() {
        let relief = Relief::new(100, 100, vec![0.0; 10_000], GeoTransform::PIXELS, None).unwrap();
        let frame = Frame::new(&relief, 300, 300);
        let peak = |x: f64, y: f64, prominence_m: f64| PeakMark { x, y, prominence_m, elevation_m: 1.0, name: None };
        let overlay = Overlay {
            peaks: vec![
                peak(50.0, -50.0, 4.0),
                peak(50.5, -50.0, 900.0),
                peak(10.0, -10.0, 4.0),
                peak(500.0, 0.0, 9.0),
            ],
            saddles: vec![(30.0, -30.0), (50.0, -50.0)],
            ..Overlay::default()
        };
        let classes = Classes::fit(overlay.peaks.iter().map(|p| p.prominence_m));
        let mut canvas = Canvas::new(300, 300, Ink::WHITE).unwrap();
        let drawn = draw_overlay(&mut canvas, &frame, &overlay, &classes, &Font::regular(), 1.0);
        assert_eq!(drawn.peaks_there, 3, "one lies off the map");
        assert_eq!(drawn.peaks.iter().sum::<usize>(), 2, "one hides behind a greater one");
        assert_eq!(drawn.peaks[classes.of(900.0)], 1);
        assert!(drawn.saddles && !drawn.ridges && !drawn.isolation);
    }
}
