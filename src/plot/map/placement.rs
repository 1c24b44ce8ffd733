//! Which peaks, labels and saddles are shown: the most prominent first, as many as a place bears.

use super::canvas::{Canvas, Ink};
use super::classes::Classes;
use super::frame::{Frame, Pixel};
use super::labels::{Area, Room, Side};
use super::overlay::{Overlay, PeakMark};
use super::symbols::{DARK, SADDLE_RADIUS, rank};
use super::text::{Align, Font, Lettering, grouped};
use std::collections::HashMap;

/// Elevations.
const GREY: Ink = Ink::rgb(66, 62, 66);

/// What found room.
pub(super) struct Placed {
    /// Classes and pixels of the peaks, the most prominent first.
    pub(super) peaks: Vec<(usize, Pixel)>,
    pub(super) labels: Vec<Label>,
    pub(super) saddles: Vec<Pixel>,
    /// Number of peaks on the map, shown or not.
    pub(super) peaks_there: usize,
}

/// Finds room for signs and labels, `s` times the usual size.
///
/// A peak takes its label before the next peak takes anything, so that the great ones are named wherever they crowd.
pub(super) fn place(frame: &Frame, overlay: &Overlay, classes: &Classes, font: &Font, s: f32) -> Placed {
    let mut peaks: Vec<(&PeakMark, Pixel)> =
        overlay.peaks.iter().filter_map(|peak| Some((peak, frame.point(peak.x, peak.y)?))).collect();
    // Stable: peaks of the same prominence keep the order they came in.
    peaks.sort_by(|a, b| rank(b.0.prominence_m).total_cmp(&rank(a.0.prominence_m)));
    let (width, height) = (frame.width as f32, frame.height as f32);
    let inset = |by: f32| Area { x: by, y: by, width: width - 2.0 * by, height: height - 2.0 * by };
    // Signs may be cut by the frame, labels may not; each kind keeps clear of both.
    let mut room = Room::new(inset(3.0 * s));
    let mut signs = Room::new(inset(-20.0 * s));
    let mut crowd = Crowd::new(s);
    let mut labels_left = (width * height / (PIXELS_A_LABEL * s * s)).ceil().max(3.0) as usize;
    let mut placed = Placed { peaks: Vec::new(), labels: Vec::new(), saddles: Vec::new(), peaks_there: peaks.len() };
    for (peak, pixel) in peaks {
        let class = classes.of(peak.prominence_m);
        let radius = classes.radius(class) * s;
        let area = Area::around(pixel.0, pixel.1, 1.2 * radius);
        if !signs.is_free(&area) || !crowd.bears(pixel, MOST_PEAKS) {
            continue;
        }
        signs.take(area);
        crowd.take(pixel);
        room.take(Area::around(pixel.0, pixel.1, radius));
        placed.peaks.push((class, pixel));
        // Where the relief was cut, all but the greatest are only slopes.
        if labels_left == 0 || class > 0 && frame.is_on_rim(pixel) {
            continue;
        }
        if let Some(label) = Label::beside(&mut room, peak, pixel, class, radius, font, s) {
            signs.take(label.area);
            placed.labels.push(label);
            labels_left -= 1;
        }
    }
    // Saddles are the lightest signs: they give way to peaks, labels and saddles named before them.
    for pixel in overlay.saddles.iter().filter_map(|&(x, y)| frame.point(x, y)) {
        let area = Area::around(pixel.0, pixel.1, SADDLE_RADIUS * s);
        if room.is_free(&area) && crowd.bears(pixel, MOST_SIGNS) && !frame.is_on_rim(pixel) {
            room.take(area);
            crowd.take(pixel);
            placed.saddles.push(pixel);
        }
    }
    placed
}

/// Area in pixels that the map has for each label.
const PIXELS_A_LABEL: f32 = 105.0 * 105.0;
/// Radius in pixels of the neighbourhood that bears a number of signs.
const NEIGHBOURHOOD: f32 = 64.0;
/// Peaks that a neighbourhood bears.
const MOST_PEAKS: usize = 10;
/// Peaks and saddles that a neighbourhood bears.
const MOST_SIGNS: usize = 12;

/// Signs by squares of a neighbourhood's radius.
struct Crowd {
    radius: f32,
    signs: HashMap<(i32, i32), Vec<Pixel>>,
}

impl Crowd {
    fn new(s: f32) -> Self {
        Self { radius: NEIGHBOURHOOD * s, signs: HashMap::new() }
    }

    fn square(&self, (x, y): Pixel) -> (i32, i32) {
        ((x / self.radius).floor() as i32, (y / self.radius).floor() as i32)
    }

    /// Whether there are fewer than `most` signs round a pixel.
    fn bears(&self, pixel: Pixel, most: usize) -> bool {
        let (col, row) = self.square(pixel);
        let around = (row - 1..=row + 1).flat_map(|row| (col - 1..=col + 1).map(move |col| (col, row)));
        let near = |sign: &&Pixel| (sign.0 - pixel.0).hypot(sign.1 - pixel.1) < self.radius;
        around.filter_map(|square| self.signs.get(&square)).flatten().filter(near).count() < most
    }

    fn take(&mut self, pixel: Pixel) {
        self.signs.entry(self.square(pixel)).or_default().push(pixel);
    }
}

/// A label with its room.
pub(super) struct Label {
    name: Option<String>,
    elevation: Option<String>,
    name_size: f32,
    elevation_size: f32,
    area: Area,
    side: Side,
}

impl Label {
    /// The label of a peak, if there is anything to say and room for it.
    fn beside(
        room: &mut Room,
        peak: &PeakMark,
        pixel: Pixel,
        class: usize,
        radius: f32,
        font: &Font,
        s: f32,
    ) -> Option<Self> {
        let name = peak.name.as_deref().map(str::trim).filter(|n| !n.is_empty() && font.can_write(n));
        let elevation = peak.elevation_m.is_finite().then(|| grouped(peak.elevation_m));
        let name_size = [14.5, 13.5, 12.5, 11.5, 11.0][class.min(4)] * s;
        let elevation_size = if name.is_some() { 0.84 * name_size } else { 0.9 * name_size };
        let width = |text: Option<&str>, size: f32| text.map_or(0.0, |text| font.width(text, size));
        let wide = width(name, name_size).max(width(elevation.as_deref(), elevation_size));
        let high = name.map_or(0.0, |_| name_size) + elevation.as_ref().map_or(0.0, |_| elevation_size);
        if wide == 0.0 {
            return None;
        }
        // Room for the halo, and a little air.
        let size = (wide + 4.0 * s, high + 2.0 * s);
        let spot = room.beside(pixel, radius / 0.8 + 1.5 * s, size)?;
        let name = name.map(str::to_string);
        Some(Self { name, elevation, name_size, elevation_size, area: spot.area, side: spot.side })
    }

    /// Writes the label.
    pub(super) fn write(&self, canvas: &mut Canvas, font: &Font, s: f32) {
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
    fn a_place_bears_only_so_many_signs_and_the_greatest_is_labelled() {
        let relief = Relief::new(100, 100, vec![0.0; 10_000], GeoTransform::PIXELS, None).unwrap();
        let frame = Frame::new(&relief, 400, 400);
        let peak = |x: f64, y: f64, prominence_m: f64| PeakMark { x, y, prominence_m, elevation_m: 1.0, name: None };
        let mut peaks: Vec<PeakMark> =
            (0..400).map(|i| peak(1.0 + f64::from(i % 20) * 4.9, -1.0 - f64::from(i / 20) * 4.9, 5.0)).collect();
        peaks.push(peak(50.0, -50.0, 900.0));
        let saddles = peaks.iter().map(|peak| (peak.x + 2.0, peak.y)).collect();
        let overlay = Overlay { peaks, saddles, ..Overlay::default() };
        let classes = Classes::fit(overlay.peaks.iter().map(|p| p.prominence_m));
        let placed = place(&frame, &overlay, &classes, &Font::regular(), 1.0);
        assert_eq!((placed.peaks_there, placed.peaks[0].1), (401, (200.0, 200.0)));
        assert!((80..350).contains(&placed.peaks.len()), "{}", placed.peaks.len());
        assert!(placed.saddles.len() < placed.peaks.len(), "{}", placed.saddles.len());
        let near = |label: &Label| (label.area.x - 200.0).abs() < 40.0 && (label.area.y - 200.0).abs() < 40.0;
        assert!(near(&placed.labels[0]), "the greatest first");
        for (i, (_, p)) in placed.peaks.iter().enumerate() {
            let around = placed.peaks[..i].iter().filter(|(_, q)| (p.0 - q.0).hypot(p.1 - q.1) < NEIGHBOURHOOD);
            assert!(around.count() < MOST_PEAKS);
        }
    }
}
