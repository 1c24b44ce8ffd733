//! Charts of histograms: small multiples with a legend, fit for a paper.

use super::drawing::{Anchor, Drawing, Ink, Label, Step, Stroke, rectangle};
use super::glyphs::Glyphs;
use super::{bars, rose};

/// A figure of small panels, each a histogram of the same series.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Chart {
    /// Title above everything; empty for none.
    pub title: String,
    /// What is overlaid in every panel; the first is filled, the others are outlined.
    pub series: Vec<Series>,
    /// Panels beside each other in a row.
    pub columns: usize,
    /// The panels, row by row.
    pub panels: Vec<Panel>,
    /// What the shares are shares of, for the axis: `peaks`.
    pub shares_of: String,
    /// Lines below everything.
    pub footnotes: Vec<String>,
}

/// One of the things that are compared.
#[derive(Clone, Debug, PartialEq)]
pub struct Series {
    /// Its name.
    pub name: String,
    /// What else to say of it in the legend.
    pub detail: String,
}

/// How a panel shows its bins.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PanelKind {
    /// As bars along a linear axis.
    Bars,
    /// As bars of the same width, whatever the bins span.
    Groups,
    /// As wedges round a circle, clockwise from north at the top; areas are proportional to shares.
    Rose,
}

/// One histogram.
#[derive(Clone, Debug, PartialEq)]
pub struct Panel {
    /// Title.
    pub title: String,
    /// A short line below the title: sizes, distances.
    pub note: String,
    /// Title of the axis, with its unit.
    pub axis: String,
    /// How the bins are shown.
    pub kind: PanelKind,
    /// Edges of the bins in the unit of the axis.
    pub edges: Vec<f64>,
    /// For each series the share of each bin; none for a series without values.
    pub shares: Vec<Option<Vec<f64>>>,
    /// Whether the last bin also holds what lies beyond it.
    pub open_end: bool,
}

pub(super) const DARK: Ink = Ink::hex(0x22_22_22);
pub(super) const GREY: Ink = Ink::hex(0x6a_6a_6a);
pub(super) const PALE: Ink = Ink::hex(0xdf_df_df);
/// Colours of the series, apart for all kinds of sight (after Okabe and Ito).
const SERIES: [Ink; 4] = [Ink::hex(0x4f_81_b5), Ink::hex(0xd5_4a_00), Ink::hex(0x00_8a_63), Ink::hex(0xa8_4b_85)];

pub(super) const PANEL_WIDTH: f64 = 214.0;
const PANEL_HEIGHT: f64 = 190.0;
/// Room above a panel's plot for its title and note.
pub(super) const HEAD: f64 = 40.0;
const MARGIN: f64 = 20.0;

/// How a series is painted.
pub(super) enum Paint {
    Filled(Ink),
    Outlined(Stroke),
}

/// The look of series number `i`.
pub(super) fn paint(i: usize) -> Paint {
    let ink = SERIES[i % SERIES.len()];
    if i == 0 { Paint::Filled(ink.faint(0.85)) } else { Paint::Outlined(Stroke::solid(ink, 1.6)) }
}

/// A label in the regular weight.
pub(super) fn label(text: impl Into<String>, at: (f64, f64), size: f64, ink: Ink, anchor: Anchor) -> Label {
    Label { text: text.into(), at, size, bold: false, ink, anchor, upwards: false, halo: false }
}

impl Chart {
    /// Lays the chart out.
    pub fn draw(&self) -> Drawing {
        let columns = self.columns.max(1);
        let rows = self.panels.len().div_ceil(columns);
        let mut drawing = Drawing {
            width: 2.0 * MARGIN + columns as f64 * PANEL_WIDTH,
            title: self.described(),
            ..Drawing::default()
        };
        let top = self.header(&mut drawing);
        for (i, panel) in self.panels.iter().enumerate() {
            let corner = (MARGIN + (i % columns) as f64 * PANEL_WIDTH, top + (i / columns) as f64 * PANEL_HEIGHT);
            self.panel(&mut drawing, panel, i, corner);
        }
        let mut y = top + rows as f64 * PANEL_HEIGHT + 8.0;
        for line in &self.footnotes {
            drawing.text(label(line, (MARGIN, y), 9.0, GREY, Anchor::Start));
            y += 13.0;
        }
        drawing.height = y + 4.0;
        drawing
    }

    /// Title and legend; returns where the panels begin.
    fn header(&self, drawing: &mut Drawing) -> f64 {
        let glyphs = Glyphs::new();
        let mut y = 14.0;
        if !self.title.is_empty() {
            y += 14.0;
            let title = label(&self.title, (MARGIN, y), 15.0, DARK, Anchor::Start);
            drawing.text(Label { bold: true, ..title });
        }
        for (i, series) in self.series.iter().enumerate() {
            y += 18.0;
            match paint(i) {
                Paint::Filled(ink) => drawing.fill(rectangle(MARGIN, y - 8.5, 18.0, 9.0), ink),
                Paint::Outlined(stroke) => {
                    let (x, y) = (MARGIN, y - 4.0);
                    let steps = [(0.0, 4.5), (5.0, 4.5), (5.0, -3.5), (12.0, -3.5), (12.0, 0.5), (18.0, 0.5)];
                    let line = steps.iter().enumerate().map(|(i, (dx, dy))| {
                        if i == 0 { Step::Move(x + dx, y + dy) } else { Step::Line(x + dx, y + dy) }
                    });
                    drawing.stroke(line.collect(), stroke);
                }
            }
            let at = (MARGIN + 25.0, y);
            drawing.text(Label { bold: true, ..label(&series.name, at, 11.0, DARK, Anchor::Start) });
            let after = at.0 + glyphs.width(&series.name, 11.0, true) + 9.0;
            drawing.text(label(&series.detail, (after, y), 10.0, GREY, Anchor::Start));
        }
        y + 22.0
    }

    fn panel(&self, drawing: &mut Drawing, panel: &Panel, number: usize, (x, y): (f64, f64)) {
        let letter = u8::try_from(number).ok().filter(|n| *n < 26).map(|n| char::from(b'a' + n));
        let mut after = x;
        if let Some(letter) = letter {
            drawing.text(Label { bold: true, ..label(letter, (x, y + 11.0), 11.0, GREY, Anchor::Start) });
            after += 14.0;
        }
        drawing.text(Label { bold: true, ..label(&panel.title, (after, y + 11.0), 11.0, DARK, Anchor::Start) });
        drawing.text(label(&panel.note, (x, y + 25.0), 9.0, GREY, Anchor::Start));
        match panel.kind {
            PanelKind::Rose => rose::draw(drawing, panel, (x, y)),
            PanelKind::Bars | PanelKind::Groups => {
                // Once a row is enough.
                let first = number.is_multiple_of(self.columns.max(1));
                bars::draw(drawing, panel, first.then_some(&self.shares_of), (x, y));
            }
        }
    }

    /// The chart in words.
    fn described(&self) -> String {
        let names: Vec<&str> = self.series.iter().map(|s| s.name.as_str()).collect();
        let panels: Vec<&str> = self.panels.iter().map(|p| p.title.as_str()).collect();
        let title = if self.title.is_empty() { "Histograms" } else { &self.title };
        format!("{title}: {}; {}", names.join(", "), panels.join(", "))
    }
}

impl Panel {
    /// The series that have values, with their numbers.
    pub(super) fn filled(&self) -> impl Iterator<Item = (usize, &Vec<f64>)> {
        self.shares.iter().enumerate().filter_map(|(i, shares)| shares.as_ref().map(|shares| (i, shares)))
    }

    /// The greatest share of any bin in percent.
    pub(super) fn greatest_percent(&self) -> f64 {
        self.filled().flat_map(|(_, shares)| shares.iter()).fold(0.0, |a: f64, b| a.max(*b)) * 100.0
    }
}

#[cfg(test)]
mod tests {
    use super::super::drawing::Item;
    use super::super::{png, svg};
    use super::*;

    fn chart(series: usize) -> Chart {
        let panel = |kind, edges: Vec<f64>, open_end| {
            let bins = edges.len() - 1;
            let shares = (0..series)
                .map(|s| Some((0..bins).map(|i| if i == s { 0.5 } else { 0.5 / (bins - 1) as f64 }).collect()));
            let title = format!("{kind:?}");
            Panel {
                title,
                note: "n = 5".into(),
                axis: "axis (m)".into(),
                kind,
                edges,
                shares: shares.collect(),
                open_end,
            }
        };
        let even = |bins: u32, end: f64| (0..=bins).map(|i| f64::from(i) * end / f64::from(bins)).collect::<Vec<_>>();
        let mut empty = panel(PanelKind::Bars, even(4, 1.0), false);
        empty.shares.fill(None);
        Chart {
            title: "A & B".into(),
            series: (0..series).map(|i| Series { name: format!("Range {i}"), detail: "5 peaks".into() }).collect(),
            columns: 2,
            panels: vec![
                panel(PanelKind::Bars, even(20, 2000.0), true),
                panel(PanelKind::Groups, vec![0.0, 0.0035, 0.49, 1.0], false),
                panel(PanelKind::Rose, even(12, 360.0), false),
                empty,
            ],
            shares_of: "peaks".into(),
            footnotes: vec!["R = 30 km".into()],
        }
    }

    #[test]
    fn everything_lies_on_the_paper() {
        for series in [1, 2, 4] {
            let drawing = chart(series).draw();
            let glyphs = Glyphs::new();
            let inside = |(x, y): (f64, f64)| {
                assert!((0.0..=drawing.width).contains(&x) && (0.0..=drawing.height).contains(&y), "{x} {y}");
            };
            for item in &drawing.items {
                match item {
                    Item::Path { steps, .. } => steps.iter().for_each(|step| match *step {
                        Step::Move(x, y) | Step::Line(x, y) => inside((x, y)),
                        Step::Curve(points) => points.into_iter().for_each(inside),
                        Step::Close => {}
                    }),
                    Item::Text(label) => {
                        let width = glyphs.width(&label.text, label.size, label.bold);
                        inside(label.at);
                        if !label.upwards && label.anchor == Anchor::Start {
                            inside((label.at.0 + width, label.at.1));
                        }
                    }
                }
            }
            let text = svg(&drawing);
            for words in ["A &amp; B", ">Bars<", "2000+", "no values", ">N<", "share of peaks (%)", "R = 30 km"] {
                assert!(text.contains(words), "{words}");
            }
            assert_eq!(png(&drawing, 1.0).unwrap()[1..4], *b"PNG");
        }
    }
}
