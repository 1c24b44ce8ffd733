//! Signs of the map: triangles for peaks, rings for saddles, lines for divides and isolation, and their labels.

use super::canvas::{Canvas, Ink, Pen};
use super::classes::Classes;
use super::frame::{Frame, Pixel, smoothed};
use super::labels::{Area, Room, Side};
use super::overlay::{Overlay, PeakMark, Ridge};
use super::text::{Align, Font, Lettering, grouped};

/// Peaks and names.
const DARK: Ink = Ink::rgb(30, 28, 32);
/// Divides and saddles.
const BROWN: Ink = Ink::rgb(112, 44, 22);
/// Lines of isolation.
const BLUE: Ink = Ink::rgb(28, 84, 138);
/// Elevations.
const GREY: Ink = Ink::rgb(66, 62, 66);

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

    let bounds = Area { x: 0.0, y: 0.0, width: frame.width as f32, height: frame.height as f32 };
    let mut room = Room::new(inset(bounds, 3.0 * s));
    let mut peaks: Vec<(&PeakMark, Pixel)> =
        overlay.peaks.iter().filter_map(|peak| Some((peak, frame.point(peak.x, peak.y)?))).collect();
    drawn.peaks_there = peaks.len();
    // Stable: peaks of the same prominence keep the order they came in.
    peaks.sort_by(|a, b| rank(b.0.prominence_m).total_cmp(&rank(a.0.prominence_m)));
    let mut spaced = Room::new(inset(bounds, -20.0 * s));
    peaks.retain(|(peak, (x, y))| {
        let radius = classes.radius(classes.of(peak.prominence_m)) * s;
        let area = Area::around(*x, *y, 1.2 * radius);
        let fits = spaced.is_free(&area);
        if fits {
            spaced.take(area);
        }
        fits
    });
    for (peak, (x, y)) in &peaks {
        let class = classes.of(peak.prominence_m);
        drawn.peaks[class.min(4)] += 1;
        room.take(Area::around(*x, *y, classes.radius(class) * s));
    }
    let labels = place_labels(&mut room, &peaks, classes, regular, s);
    // Saddles are the lightest signs: they give way to peaks, labels and saddles named before them.
    for &(x, y) in &overlay.saddles {
        let Some(pixel) = frame.point(x, y) else { continue };
        drawn.saddles = true;
        let area = Area::around(pixel.0, pixel.1, SADDLE_RADIUS * s);
        if room.is_free(&area) {
            room.take(area);
            ring(canvas, pixel, s);
        }
    }
    for (peak, pixel) in peaks.iter().rev() {
        triangle(canvas, *pixel, classes.radius(classes.of(peak.prominence_m)) * s, s);
    }
    for label in &labels {
        label.write(canvas, regular, s);
    }
    drawn
}

fn rank(prominence_m: f64) -> f64 {
    if prominence_m.is_nan() { f64::NEG_INFINITY } else { prominence_m }
}

fn inset(area: Area, by: f32) -> Area {
    Area { x: area.x + by, y: area.y + by, width: area.width - 2.0 * by, height: area.height - 2.0 * by }
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
    frame.width as f32 * frame.height as f32 / (9.0 * s)
}

fn length(line: &[Pixel]) -> f32 {
    line.windows(2).map(|w| (w[1].0 - w[0].0).hypot(w[1].1 - w[0].1)).sum()
}

fn draw_ridges(canvas: &mut Canvas, frame: &Frame, ridges: &[Ridge], classes: &Classes, s: f32) -> bool {
    let mut order: Vec<&Ridge> = ridges.iter().collect();
    order.sort_by(|a, b| rank(b.prominence_m).total_cmp(&rank(a.prominence_m)));
    let mut ink_left = ink_budget(frame, s);
    let mut lines = Vec::new();
    for ridge in order {
        for part in frame.line(&ridge.path) {
            let part = smoothed(&part, 1.6 * s);
            ink_left -= length(&part);
            lines.push((classes.weight(ridge.prominence_m), part));
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

/// A label with its room.
struct Label {
    name: Option<String>,
    elevation: Option<String>,
    name_size: f32,
    elevation_size: f32,
    area: Area,
    side: Side,
}

/// Area in pixels that the map has for each label.
const PIXELS_A_LABEL: f32 = 105.0 * 105.0;

fn place_labels(room: &mut Room, peaks: &[(&PeakMark, Pixel)], classes: &Classes, font: &Font, s: f32) -> Vec<Label> {
    let map = room.bounds();
    let most = (map.width * map.height / (PIXELS_A_LABEL * s * s)).ceil().max(3.0) as usize;
    let mut labels = Vec::new();
    for (peak, pixel) in peaks {
        if labels.len() >= most {
            break;
        }
        let class = classes.of(peak.prominence_m);
        let name = peak.name.as_deref().map(str::trim).filter(|n| !n.is_empty() && font.can_write(n));
        let elevation = peak.elevation_m.is_finite().then(|| grouped(peak.elevation_m));
        let name_size = [14.5, 13.5, 12.5, 11.5, 11.0][class.min(4)] * s;
        let elevation_size = if name.is_some() { 0.84 * name_size } else { 0.9 * name_size };
        let width = |text: Option<&str>, size: f32| text.map_or(0.0, |text| font.width(text, size));
        let wide = width(name, name_size).max(width(elevation.as_deref(), elevation_size));
        let high = name.map_or(0.0, |_| name_size) + elevation.as_ref().map_or(0.0, |_| elevation_size);
        if wide == 0.0 {
            continue;
        }
        // Room for the halo, and a little air.
        let size = (wide + 4.0 * s, high + 2.0 * s);
        let away = classes.radius(class) * s / 0.8 + 1.5 * s;
        if let Some(spot) = room.beside(*pixel, away, size) {
            let name = name.map(str::to_string);
            labels.push(Label { name, elevation, name_size, elevation_size, area: spot.area, side: spot.side });
        }
    }
    labels
}

impl Label {
    fn write(&self, canvas: &mut Canvas, font: &Font, s: f32) {
        let halo = Some((1.7 * s, Ink::WHITE.opacity(0.85)));
        let (x, align) = match self.side {
            Side::Right => (self.area.x + 2.0 * s, Align::Left),
            Side::Left => (self.area.x + self.area.width - 2.0 * s, Align::Right),
            Side::Middle => (self.area.x + self.area.width / 2.0, Align::Centre),
        };
        let mut y = self.area.y + s;
        let lines = [(&self.name, self.name_size, DARK), (&self.elevation, self.elevation_size, GREY)];
        for (text, size, ink) in lines {
            if let Some(text) = text {
                // The baseline leaves room for the letters' tails below.
                let lettering = Lettering { font, size, ink, halo };
                lettering.write(canvas, text, (x, y + 0.8 * size), align);
                y += size;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::GeoTransform;
    use crate::plot::map::Relief;

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
