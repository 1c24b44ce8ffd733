//! Panels of directions: roses.

use super::axis::{tick_text, ticks_to};
use super::drawing::{Anchor, Drawing, Label, Step, Stroke, arc, circle, on_circle};
use super::figure::{DARK, GREY, HEAD, PALE, PANEL_WIDTH, Paint, Panel, label, paint};

const RADIUS: f64 = 52.0;

/// Draws a panel whose corner is at `(x, y)`.
pub(super) fn draw(drawing: &mut Drawing, panel: &Panel, (x, y): (f64, f64)) {
    let centre = (x + (PANEL_WIDTH - 10.0) / 2.0, y + HEAD + RADIUS + 5.0);
    let ticks = ticks_to(panel.greatest_percent(), 2);
    let top = ticks[ticks.len() - 1];
    // Areas, not radii, are what the eye compares: the radius goes with the root of the share.
    let radius = |percent: f64| RADIUS * (percent / top).max(0.0).sqrt();
    for &tick in &ticks[1..] {
        drawing.stroke(circle(centre, radius(tick)), Stroke::solid(PALE, 0.7));
    }
    for azimuth in [0.0, 90.0, 180.0, 270.0] {
        drawing.line(centre, on_circle(centre, RADIUS, azimuth), Stroke::solid(PALE, 0.7));
    }
    for (i, shares) in panel.filled() {
        match paint(i) {
            Paint::Filled(ink) => {
                for (bin, &share) in shares.iter().enumerate().filter(|(_, share)| **share > 0.0) {
                    let (from, to) = (panel.edges[bin] + 0.5, panel.edges[bin + 1] - 0.5);
                    let rim = on_circle(centre, radius(share * 100.0), from);
                    let mut steps = vec![Step::Move(centre.0, centre.1), Step::Line(rim.0, rim.1)];
                    steps.extend(arc(centre, radius(share * 100.0), from, to));
                    steps.push(Step::Close);
                    drawing.fill(steps, ink);
                }
            }
            Paint::Outlined(stroke) => drawing.stroke(outline(panel, shares, centre, radius), stroke),
        }
    }
    let empty = panel.filled().next().is_none();
    if empty {
        drawing.text(label("no values", (centre.0, centre.1 + 3.0), 10.0, GREY, Anchor::Middle));
    } else {
        // What a rose without any preference would be.
        let even = 100.0 / (panel.edges.len() - 1) as f64;
        drawing.stroke(circle(centre, radius(even)), Stroke { ink: DARK, width: 0.7, dash: Some((2.5, 2.0)) });
        for &tick in &ticks[1..] {
            let at = on_circle(centre, radius(tick), 135.0);
            let percent = format!("{} %", tick_text(tick));
            let ring = label(percent, (at.0 + 1.5, at.1 + 5.0), 8.0, GREY, Anchor::Start);
            drawing.text(Label { halo: true, ..ring });
        }
    }
    for (name, azimuth) in [("N", 0.0), ("E", 90.0), ("S", 180.0), ("W", 270.0)] {
        let at = on_circle(centre, RADIUS + 8.0, azimuth);
        drawing.text(label(name, (at.0, at.1 + 3.3), 9.0, DARK, Anchor::Middle));
    }
    drawing.text(label(&panel.axis, (centre.0, y + HEAD + 134.0), 9.5, DARK, Anchor::Middle));
}

fn outline(panel: &Panel, shares: &[f64], centre: (f64, f64), radius: impl Fn(f64) -> f64) -> Vec<Step> {
    let mut steps = vec![];
    for (bin, &share) in shares.iter().enumerate() {
        let (from, to, r) = (panel.edges[bin], panel.edges[bin + 1], radius(share * 100.0));
        let rim = on_circle(centre, r, from);
        steps.push(if bin == 0 { Step::Move(rim.0, rim.1) } else { Step::Line(rim.0, rim.1) });
        steps.extend(arc(centre, r, from, to));
    }
    steps.push(Step::Close);
    steps
}
