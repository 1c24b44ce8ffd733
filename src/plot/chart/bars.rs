//! Panels of bars.

use super::axis::{tick_text, ticks_to};
use super::drawing::{Anchor, Drawing, Ink, Label, Step, Stroke, rectangle};
use super::figure::{DARK, GREY, HEAD, PALE, PANEL_WIDTH, Paint, Panel, PanelKind, label, paint};

/// Room left of the plot for the ticks, and right of it.
const LEFT: f64 = 34.0;
const RIGHT: f64 = 14.0;
const HEIGHT: f64 = 108.0;

/// Where the bins and shares of a panel are on the paper.
struct Frame<'a> {
    panel: &'a Panel,
    left: f64,
    width: f64,
    bottom: f64,
    top_percent: f64,
}

impl Frame<'_> {
    /// Horizontal position of edge number `i`.
    fn edge(&self, i: usize) -> f64 {
        match self.panel.kind {
            PanelKind::Groups => self.left + self.width * i as f64 / (self.panel.edges.len() - 1) as f64,
            _ => self.value(self.panel.edges[i]),
        }
    }

    /// Horizontal position of a value on a linear axis.
    fn value(&self, value: f64) -> f64 {
        let edges = &self.panel.edges;
        let (first, last) = (edges[0], edges[edges.len() - 1]);
        self.left + self.width * (value - first) / (last - first)
    }

    fn height(&self, percent: f64) -> f64 {
        self.bottom - HEIGHT * percent / self.top_percent
    }
}

/// Draws a panel whose corner is at `(x, y)`.
pub(super) fn draw(drawing: &mut Drawing, panel: &Panel, shares_of: Option<&String>, (x, y): (f64, f64)) {
    let ticks = ticks_to(panel.greatest_percent(), 4);
    let frame = Frame {
        panel,
        left: x + LEFT,
        width: PANEL_WIDTH - LEFT - RIGHT,
        bottom: y + HEAD + HEIGHT,
        top_percent: ticks[ticks.len() - 1],
    };
    let empty = panel.filled().next().is_none();
    if empty {
        let middle = (frame.left + frame.width / 2.0, frame.bottom - HEIGHT / 2.0);
        drawing.text(label("no values", middle, 10.0, GREY, Anchor::Middle));
    } else {
        for &tick in &ticks {
            let level = frame.height(tick);
            if tick > 0.0 {
                drawing.line((frame.left, level), (frame.left + frame.width, level), Stroke::solid(PALE, 0.7));
            }
            drawing.text(label(tick_text(tick), (frame.left - 5.0, level + 3.2), 9.0, DARK, Anchor::End));
        }
        if let Some(shares_of) = shares_of {
            let at = (x + 8.0, frame.bottom - HEIGHT / 2.0);
            let side = label(format!("share of {shares_of} (%)"), at, 9.0, DARK, Anchor::Middle);
            drawing.text(Label { upwards: true, ..side });
        }
    }
    for (i, shares) in panel.filled() {
        match paint(i) {
            Paint::Filled(ink) => fill(drawing, &frame, shares, ink),
            Paint::Outlined(stroke) => drawing.stroke(outline(&frame, shares), stroke),
        }
    }
    axis(drawing, &frame);
}

fn fill(drawing: &mut Drawing, frame: &Frame<'_>, shares: &[f64], ink: Ink) {
    // A hair of white between bars, unless they are hairs themselves.
    let gap = if frame.width / shares.len() as f64 > 4.0 { 0.8 } else { 0.0 };
    for (i, &share) in shares.iter().enumerate().filter(|(_, share)| **share > 0.0) {
        let (from, to, top) = (frame.edge(i), frame.edge(i + 1), frame.height(share * 100.0));
        drawing.fill(rectangle(from + gap / 2.0, top, to - from - gap, frame.bottom - top), ink);
    }
}

fn outline(frame: &Frame<'_>, shares: &[f64]) -> Vec<Step> {
    let mut steps = vec![Step::Move(frame.edge(0), frame.bottom)];
    for (i, &share) in shares.iter().enumerate() {
        let level = frame.height(share * 100.0);
        steps.extend([Step::Line(frame.edge(i), level), Step::Line(frame.edge(i + 1), level)]);
    }
    steps.push(Step::Line(frame.edge(shares.len()), frame.bottom));
    steps
}

fn axis(drawing: &mut Drawing, frame: &Frame<'_>) {
    let (left, right, bottom) = (frame.left, frame.left + frame.width, frame.bottom);
    let stroke = || Stroke::solid(DARK, 0.8);
    drawing.line((left, bottom), (right, bottom), stroke());
    let edges = &frame.panel.edges;
    let last = edges[edges.len() - 1];
    let open = |value: f64| if frame.panel.open_end && value == last { "+" } else { "" };
    let mut tick = |at: f64, text: Option<String>| {
        drawing.line((at, bottom), (at, bottom + if text.is_some() { 3.5 } else { 2.0 }), stroke());
        if let Some(text) = text {
            drawing.text(label(text, (at, bottom + 13.0), 9.0, DARK, Anchor::Middle));
        }
    };
    if frame.panel.kind == PanelKind::Groups {
        for (i, &edge) in edges.iter().enumerate() {
            // Every other edge has room for its number, which then goes without its zero.
            let text = tick_text(edge);
            let short = text.strip_prefix('0').filter(|rest| !rest.is_empty()).unwrap_or(&text);
            tick(frame.edge(i), i.is_multiple_of(2).then(|| format!("{short}{}", open(edge))));
        }
    } else {
        let round = ticks_to(last - edges[0], 5);
        let step = round[1] - round[0];
        // Adding 0 turns a negative zero into a plain one.
        let mut k = (edges[0] / step - 1e-9).ceil() + 0.0;
        while k * step <= last + 1e-9 * step {
            let value = if (k * step - last).abs() < 1e-9 * step { last } else { k * step };
            tick(frame.value(value), Some(format!("{}{}", tick_text(value), open(value))));
            k += 1.0;
        }
    }
    let middle = (left + frame.width / 2.0, bottom + 26.0);
    drawing.text(label(&frame.panel.axis, middle, 9.5, DARK, Anchor::Middle));
}
