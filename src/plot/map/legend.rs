//! The strip below the map: what the signs mean, how high the colours are, and the scale.

use super::canvas::{Canvas, Ink, Pen};
use super::classes::Classes;
use super::scale_bar::ScaleBar;
use super::symbols::{Drawn, isolation_pen, ridge_pen, ring, triangle};
use super::text::{Align, Font, Lettering, grouped};
use super::tint::{Ramp, VOID, at_position};

/// Words of the frame.
pub(super) const TEXT: Ink = Ink::rgb(58, 56, 60);
/// Words that may be overlooked.
pub(super) const QUIET: Ink = Ink::rgb(128, 126, 130);

/// What the legend explains.
pub(super) struct Legend<'a> {
    pub(super) classes: &'a Classes,
    pub(super) drawn: &'a Drawn,
    /// The tints, if anything has one.
    pub(super) ramp: Option<Ramp>,
    /// Whether there are voids.
    pub(super) voids: bool,
    pub(super) bar: Option<ScaleBar>,
    /// A remark on the scale.
    pub(super) bar_note: Option<&'a str>,
    pub(super) font: &'a Font,
    /// Size of everything.
    pub(super) s: f32,
}

/// Draws signs from a point rightwards, their middle at its height.
type Sign<'a> = Box<dyn Fn(&mut Canvas, f32, f32) + 'a>;

/// One thing explained: a heading with signs below it.
struct Block<'a> {
    heading: String,
    width: f32,
    sign: Sign<'a>,
}

/// Heights of a row of blocks, of the line of its headings and of the middle of its signs.
const ROW: f32 = 44.0;
const HEADING: f32 = 9.0;
const SIGNS: f32 = 25.0;
const GAP: f32 = 34.0;

impl Legend<'_> {
    /// Height of the legend when it has this width.
    pub(super) fn height(&self, width: f32) -> f32 {
        let places = self.places(&self.blocks(), width);
        places.iter().map(|p| p.1 + ROW * self.s).fold(0.0, f32::max)
    }

    /// Draws the legend with its upper left corner at `x`, `y`.
    pub(super) fn draw(&self, canvas: &mut Canvas, (x, y): (f32, f32), width: f32) {
        let blocks = self.blocks();
        for (block, (dx, dy)) in blocks.iter().zip(self.places(&blocks, width)) {
            let (x, y) = (x + dx, y + dy);
            let heading = Lettering { font: self.font, size: 10.5 * self.s, ink: QUIET, halo: None };
            heading.write(canvas, &block.heading, (x, y + HEADING * self.s), Align::Left);
            (block.sign)(canvas, x, y + SIGNS * self.s);
        }
    }

    fn lettering(&self) -> Lettering<'_> {
        Lettering { font: self.font, size: 12.0 * self.s, ink: TEXT, halo: None }
    }

    /// Offsets of the blocks: from left to right, in as many rows as it takes, the last one at the right edge.
    fn places(&self, blocks: &[Block<'_>], width: f32) -> Vec<(f32, f32)> {
        let (mut x, mut y) = (0.0, 0.0);
        let last = blocks.len().saturating_sub(1);
        blocks
            .iter()
            .enumerate()
            .map(|(i, block)| {
                if x > 0.0 && x + block.width > width {
                    (x, y) = (0.0, y + ROW * self.s);
                }
                let place = if i == last && self.bar.is_some() { ((width - block.width).max(x), y) } else { (x, y) };
                x += block.width + GAP * self.s;
                place
            })
            .collect()
    }

    fn blocks(&self) -> Vec<Block<'_>> {
        let mut blocks = Vec::new();
        blocks.extend(self.peaks());
        let s = self.s;
        if self.drawn.ridges {
            blocks.push(self.block("Divide tree", 64.0, move |canvas, x, y| {
                for i in 0..4 {
                    let at = |k: f32| x + 16.0 * k * s;
                    let pen = ridge_pen((i as f32 + 0.5) / 4.0, s);
                    canvas.polyline(&[(at(i as f32), y), (at(i as f32 + 1.0), y)], &pen);
                }
            }));
        }
        if self.drawn.saddles {
            blocks.push(self.block("Key saddle", 10.0, move |canvas, x, y| ring(canvas, (x + 5.0 * s, y), s)));
        }
        if self.drawn.isolation {
            blocks.push(self.block("To higher ground", 44.0, move |canvas, x, y| {
                canvas.polyline(&[(x, y), (x + 44.0 * s, y)], &isolation_pen(s));
            }));
        }
        blocks.extend(self.ramp.map(|ramp| self.heights(ramp)));
        if self.voids {
            blocks.push(self.block("No data", 24.0, move |canvas, x, y| {
                swatch_rim(canvas, x, y, 24.0 * s, s);
                canvas.rectangle(x, y - 5.0 * s, 24.0 * s, 10.0 * s, VOID);
            }));
        }
        blocks.extend(self.bar.as_ref().map(|bar| self.scale(bar)));
        blocks
    }

    /// A block whose signs are `width` times the usual size wide.
    fn block<'b>(&self, heading: &str, width: f32, sign: impl Fn(&mut Canvas, f32, f32) + 'b) -> Block<'b> {
        let heading_width = self.font.width(heading, 10.5 * self.s);
        Block { heading: heading.into(), width: heading_width.max(width * self.s), sign: Box::new(sign) }
    }

    fn peaks(&self) -> Option<Block<'_>> {
        let s = self.s;
        let floors = &self.classes.floors_m;
        let mut signs = Vec::new();
        for (class, _) in self.drawn.peaks.iter().enumerate().filter(|(_, count)| **count > 0) {
            let label = match (floors.get(class), floors.last()) {
                (Some(&floor), _) => format!("≥ {}", metres(floor)),
                (None, Some(&last)) => format!("< {}", metres(last)),
                (None, None) => "unknown".to_string(),
            };
            signs.push((self.classes.radius(class) * s, label));
        }
        let lettering = self.lettering();
        let step = |radius: f32, label: &str| 2.0 * radius + 4.0 * s + lettering.width(label) + 13.0 * s;
        let width: f32 = signs.iter().map(|(radius, label)| step(*radius, label)).sum::<f32>() - 13.0 * s;
        (!signs.is_empty()).then(|| {
            self.block("Peaks, by prominence", width / s, move |canvas, mut x, y| {
                let lettering = self.lettering();
                for (radius, label) in &signs {
                    triangle(canvas, (x + radius, y + 0.25 * radius), *radius, s);
                    lettering.write(canvas, label, (x + 2.0 * radius + 4.0 * s, y + 4.4 * s), Align::Left);
                    x += 2.0 * radius + 4.0 * s + lettering.width(label) + 13.0 * s;
                }
            })
        })
    }

    fn heights(&self, ramp: Ramp) -> Block<'_> {
        let s = self.s;
        let bar = (110.0 * s).round();
        let (low, high) = (grouped(f64::from(ramp.low_m)), metres(f64::from(ramp.high_m)));
        let lettering = self.lettering();
        let start = lettering.width(&low) + 6.0 * s;
        let width = start + bar + 6.0 * s + lettering.width(&high);
        self.block("Elevation", width / s, move |canvas, x, y| {
            let lettering = self.lettering();
            lettering.write(canvas, &low, (x, y + 4.4 * s), Align::Left);
            let left = (x + start).round();
            swatch_rim(canvas, left, y, bar, s);
            for i in 0..bar as usize {
                let colour = at_position((i as f32 + 0.5) / bar).map(|c| c.round() as u8);
                let ink = Ink::rgb(colour[0], colour[1], colour[2]);
                canvas.rectangle(left + i as f32, y - 5.0 * s, 1.0, 10.0 * s, ink);
            }
            lettering.write(canvas, &high, (left + bar + 6.0 * s, y + 4.4 * s), Align::Left);
        })
    }

    fn scale<'b>(&'b self, bar: &'b ScaleBar) -> Block<'b> {
        let s = self.s;
        let width = bar.width_px as f32;
        let label_width = self.lettering().width(&bar.label());
        let heading = self.bar_note.map_or_else(|| "Scale".to_string(), |note| format!("Scale {note}"));
        self.block(&heading, (width + 8.0 * s + label_width) / s, move |canvas, x, y| {
            let (top, height) = ((y - 3.0 * s).round(), (6.0 * s).round().max(2.0));
            let edge = Pen::solid(TEXT, 0.9 * s);
            let corners = [(x, top), (x + width, top), (x + width, top + height), (x, top + height)];
            canvas.polygon(&corners, Ink::WHITE, Some(edge));
            let field = width / bar.fields as f32;
            for i in (0..bar.fields).step_by(2) {
                let (left, right) = (x + field * i as f32, x + field * (i + 1) as f32);
                let corners = [(left, top), (right, top), (right, top + height), (left, top + height)];
                canvas.polygon(&corners, TEXT, None);
            }
            self.lettering().write(canvas, &bar.label(), (x + width + 7.0 * s, y + 4.4 * s), Align::Left);
        })
    }
}

fn swatch_rim(canvas: &mut Canvas, x: f32, y: f32, width: f32, s: f32) {
    let rim = s.max(1.0);
    canvas.rectangle(x - rim, y - 5.0 * s - rim, width + 2.0 * rim, 10.0 * s + 2.0 * rim, QUIET.opacity(0.5));
}

/// A length in metres with its unit.
fn metres(value: f64) -> String {
    if value.abs() >= 1.0 || value == 0.0 { format!("{} m", grouped(value)) } else { format!("{value} m") }
}
