//! Amplification as a page that can be mailed: one HTML file, pictures and charts in it.

use crate::plot::chart::{Anchor, Chart, Drawing, Ink, Label, Panel, PanelKind, Series, Step, Stroke, rectangle, svg};
use std::fmt::Write;

/// What a page shows.
#[derive(Clone, Debug)]
pub struct AmplifiedPage<'a> {
    /// What was made of what.
    pub title: &'a str,
    /// What is told of it, name and words.
    pub facts: &'a [(String, String)],
    /// Pictures of the input and of the output as PNG, and what they show.
    pub pictures: [(&'a str, &'a [u8]); 2],
    /// How steep cells of the input and of the output are: shares in bins of a degree.
    pub slopes: [Option<Vec<f64>>; 2],
    /// Power spectra of both: wavelengths in metres, and power times wavelength, as it were per octave, in m².
    pub spectra: [&'a [[f64; 2]]; 2],
    /// How far means are off, in m, in each of the blocks of the raster, row by row; NaN where there is no data.
    pub worst_m: &'a [f64],
    /// Columns of blocks.
    pub columns: usize,
}

/// Colours of the input and the output: those that bars have.
const COLOURS: [u32; 2] = [0x4f_81_b5, 0xd5_4a_00];
/// Names of both.
const NAMES: [&str; 2] = ["input", "output"];
const DARK: Ink = Ink::hex(0x33_33_33);
const PALE: Ink = Ink::hex(0xdd_dd_dd);
/// Classes of the map of consistency: up to so many metres, and their colours; the last has no end.
const CLASSES: [(f64, u32); 6] = [
    (0.001, 0xe8_f1_f8),
    (0.01, 0xb5_d3_ea),
    (0.1, 0x75_ab_d6),
    (1.0, 0xf4_c9_6b),
    (10.0, 0xe0_85_3a),
    (f64::INFINITY, 0xa8_2b_2b),
];

impl AmplifiedPage<'_> {
    /// The page as HTML that is well-formed XML too, and needs no other file.
    pub fn html(&self) -> String {
        let title = escaped(self.title);
        let mut page = format!(
            "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\"/>\n<title>{title}</title>\n<style>\nbody \
             {{ font-family: sans-serif; color: #333; max-width: 72em; margin: 1em auto; padding: 0 1em; }}\nfigure {{ \
             display: inline-block; vertical-align: top; margin: 0 1em 1em 0; }}\nimg, svg {{ max-width: 100%; }}\nth {{ \
             text-align: left; font-weight: normal; color: #666; padding-right: 2em; }}\n</style>\n</head>\n<body>\n\
             <h1>{title}</h1>\n<table>\n"
        );
        let mut push = |text: String| page.push_str(&text);
        for (name, words) in self.facts {
            push(format!("<tr><th>{}</th><td>{}</td></tr>\n", escaped(name), escaped(words)));
        }
        push("</table>\n".into());
        for (words, png) in self.pictures {
            let words = escaped(words);
            push(format!(
                "<figure>\n<img src=\"data:image/png;base64,{}\" alt=\"{words}\"/>\n<figcaption>{words}</figcaption>\n\
                 </figure>\n",
                base64(png)
            ));
        }
        let mut figure = |drawing: Drawing, words: &str| {
            push(format!("<figure>\n{}<figcaption>{}</figcaption>\n</figure>\n", svg(&drawing), escaped(words)));
        };
        if let Some(chart) = self.slope_chart() {
            figure(chart.draw(), "how steep cells are, each raster at its own cells");
        }
        if let Some(drawing) = self.spectrum() {
            figure(drawing, "relief by wavelength, along rows: the output has more than the input has cells for");
        }
        figure(self.consistency(), "how far the means of the output's cells are from the input's, at most");
        push("</body>\n</html>\n".into());
        page
    }

    fn slope_chart(&self) -> Option<Chart> {
        let used = |shares: &Vec<f64>| shares.iter().rposition(|&share| share > 0.001).map_or(1, |last| last + 1);
        let bins = self.slopes.iter().flatten().map(used).max()?;
        let shares = self.slopes.iter().map(|shares| {
            let (own, beyond) = shares.as_ref()?.split_at(bins);
            let mut own = own.to_vec();
            own[bins - 1] += beyond.iter().sum::<f64>();
            Some(own)
        });
        Some(Chart {
            title: "Slopes".into(),
            series: NAMES.map(|name| Series { name: name.into(), detail: String::new() }).to_vec(),
            columns: 1,
            panels: vec![Panel {
                title: "Slope".into(),
                note: String::new(),
                axis: "degrees".into(),
                kind: PanelKind::Bars,
                edges: (0..=bins).map(|degree| degree as f64).collect(),
                shares: shares.collect(),
                open_end: true,
            }],
            shares_of: "cells".into(),
            footnotes: vec![],
        })
    }

    /// Both spectra, wavelengths falling to the right by octaves, power in decibels.
    fn spectrum(&self) -> Option<Drawing> {
        let points = || self.spectra.iter().flat_map(|spectrum| spectrum.iter());
        let range = |axis: usize| {
            let values = points().map(move |point| point[axis]).filter(|value| *value > 0.0);
            let (least, most) = values.fold((f64::INFINITY, 0.0), |(a, b): (f64, f64), v| (a.min(v), b.max(v)));
            (most > 0.0).then_some((least, most))
        };
        let ((shortest, longest), (weakest, strongest)) = (range(0)?, range(1)?);
        let octaves = (longest / shortest).log2().max(1.0);
        let decibels = |power: f64| 10.0 * power.log10();
        let (low, high) = ((decibels(weakest) / 10.0).floor() * 10.0, (decibels(strongest) / 10.0).ceil() * 10.0);
        let high = high.max(low + 10.0);
        let (left, top, width, height) = (54.0, 34.0, 400.0, 220.0);
        let x = |wavelength: f64| left + (longest / wavelength).log2() / octaves * width;
        let y = |level: f64| top + (high - level) / (high - low) * height;
        let mut drawing = Drawing { width: 480.0, height: 300.0, title: "Spectra".into(), items: vec![] };
        let text = |text: String, at, anchor| Label {
            text,
            at,
            size: 9.0,
            bold: false,
            ink: DARK,
            anchor,
            upwards: false,
            halo: false,
        };
        drawing.text(Label { size: 12.0, bold: true, ..text("Spectra".into(), (left, 16.0), Anchor::Start) });
        let mut level = low;
        while level <= high {
            drawing.line((left, y(level)), (left + width, y(level)), Stroke::solid(PALE, 0.7));
            drawing.text(text(format!("{level:.0}"), (left - 5.0, y(level) + 3.0), Anchor::End));
            level += 10.0;
        }
        for octave in 0..=octaves as u32 {
            let wavelength = longest / f64::from(1 << octave.min(30));
            drawing.line((x(wavelength), top + height), (x(wavelength), top + height + 3.5), Stroke::solid(DARK, 0.8));
            let words = if wavelength >= 10.0 { format!("{wavelength:.0}") } else { format!("{wavelength:.2}") };
            drawing.text(text(words, (x(wavelength), top + height + 14.0), Anchor::Middle));
        }
        let below = (left + width / 2.0, top + height + 30.0);
        drawing.text(text("wavelength (m)".into(), below, Anchor::Middle));
        let side = text("power per octave (dB of 1 m²)".into(), (14.0, top + height / 2.0), Anchor::Middle);
        drawing.text(Label { upwards: true, ..side });
        for ((spectrum, colour), (name, at)) in self.spectra.iter().zip(COLOURS).zip(NAMES.iter().zip([0.0, 60.0])) {
            let seen = spectrum.iter().filter(|point| point[1] > 0.0);
            let steps: Vec<Step> = seen
                .enumerate()
                .map(|(i, &[wavelength, power])| {
                    let (x, y) = (x(wavelength), y(decibels(power)));
                    if i == 0 { Step::Move(x, y) } else { Step::Line(x, y) }
                })
                .collect();
            let ink = Ink::hex(colour);
            if !steps.is_empty() {
                drawing.stroke(steps, Stroke::solid(ink, 1.6));
            }
            drawing.fill(rectangle(left + 200.0 + at, 8.0, 8.0, 8.0), ink);
            drawing.text(text((*name).to_string(), (left + 211.0 + at, 16.0), Anchor::Start));
        }
        Some(drawing)
    }

    /// The greatest deviation in each block of the raster.
    fn consistency(&self) -> Drawing {
        let columns = self.columns.max(1);
        let rows = self.worst_m.len().div_ceil(columns);
        let side = (400.0 / columns.max(rows).max(1) as f64).min(40.0);
        let (wide, high) = (columns as f64 * side, rows as f64 * side);
        let title = "Consistency".to_string();
        let mut drawing = Drawing { width: wide.max(460.0) + 20.0, height: high + 66.0, title, items: vec![] };
        let text = |text: String, at, bold| Label {
            text,
            at,
            size: if bold { 12.0 } else { 9.0 },
            bold,
            ink: DARK,
            anchor: Anchor::Start,
            upwards: false,
            halo: false,
        };
        drawing.text(text("Consistency".into(), (10.0, 16.0), true));
        for (i, (most, colour)) in CLASSES.into_iter().enumerate() {
            let least = if i == 0 { -1.0 } else { CLASSES[i - 1].0 };
            let mut steps = vec![];
            for (block, &worst) in self.worst_m.iter().enumerate() {
                if worst > least && worst <= most {
                    let (x, y) = ((block % columns) as f64 * side, (block / columns) as f64 * side);
                    steps.extend(rectangle(10.0 + x, 26.0 + y, side, side));
                }
            }
            if !steps.is_empty() {
                drawing.fill(steps, Ink::hex(colour));
            }
            let at = 10.0 + i as f64 * 78.0;
            drawing.fill(rectangle(at, high + 40.0, 8.0, 8.0), Ink::hex(colour));
            let words = if most.is_finite() { format!("up to {most} m") } else { "more".into() };
            drawing.text(text(words, (at + 11.0, high + 48.0), false));
        }
        drawing.stroke(rectangle(10.0, 26.0, wide, high), Stroke::solid(DARK, 0.6));
        drawing
    }
}

/// Bytes as text (RFC 4648).
fn base64(bytes: &[u8]) -> String {
    const LETTERS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::with_capacity(bytes.len().div_ceil(3) * 4);
    for three in bytes.chunks(3) {
        let word = three.iter().fold(0u32, |word, &byte| word << 8 | u32::from(byte)) << (8 * (3 - three.len()));
        for i in 0..4 {
            let letter = LETTERS[(word >> (18 - 6 * i) & 63) as usize];
            text.push(if i <= three.len() { char::from(letter) } else { '=' });
        }
    }
    text
}

/// Text for HTML; what XML cannot hold is left out.
fn escaped(text: &str) -> String {
    text.chars().filter(|c| !c.is_control()).fold(String::new(), |mut out, c| {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            c => out.write_char(c).expect("a String takes all"),
        }
        out
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_as_text() {
        // The examples of RFC 4648, section 10.
        for (bytes, text) in [("", ""), ("f", "Zg=="), ("fo", "Zm8="), ("foo", "Zm9v"), ("foobar", "Zm9vYmFy")] {
            assert_eq!(base64(bytes.as_bytes()), text);
        }
        assert_eq!(base64(&[0xfb, 0xff]), "+/8=");
    }

    #[test]
    fn pages_without_slopes_or_spectra() {
        let page = AmplifiedPage {
            title: "a < b & \"c\"",
            facts: &[],
            pictures: [("before", b"x"), ("after", b"y")],
            slopes: [None, None],
            spectra: [&[], &[]],
            worst_m: &[f64::NAN, 0.0, 0.5],
            columns: 2,
        };
        let html = page.html();
        assert!(html.contains("<h1>a &lt; b &amp; &quot;c&quot;</h1>"));
        assert_eq!(html.matches("<svg").count(), 1, "the map of consistency alone");
        let of = |colour: u32| html.matches(&format!("fill=\"#{colour:06x}\"")).count();
        assert_eq!((of(CLASSES[0].1), of(CLASSES[1].1), of(CLASSES[3].1)), (2, 1, 2), "a block and its key");
    }
}
