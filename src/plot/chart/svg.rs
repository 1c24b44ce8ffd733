//! Drawings as SVG, text kept as text.

use super::drawing::{Anchor, Drawing, Ink, Item, Label, Step, Stroke};
use std::fmt::Write;

/// Fonts for the text, the one that widths were measured with first.
const FONTS: &str = "DejaVu Sans, Bitstream Vera Sans, Verdana, Helvetica, Arial, sans-serif";

/// Width of the stroke that makes a white rim round letters.
pub(super) const HALO: f64 = 2.5;

/// The drawing as an SVG 1.1 document on white.
pub fn svg(drawing: &Drawing) -> String {
    let (width, height) = (number(drawing.width), number(drawing.height));
    let mut text = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" viewBox=\"0 0 {width} {height}\" \
         font-family=\"{FONTS}\" role=\"img\">\n<title>{}</title>\n<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n",
        escaped(&drawing.title)
    );
    for item in &drawing.items {
        match item {
            Item::Path { steps, fill, stroke } => path(&mut text, steps, *fill, stroke.as_ref()),
            Item::Text(label) => words(&mut text, label),
        }
    }
    text.push_str("</svg>\n");
    text
}

fn path(text: &mut String, steps: &[Step], fill: Option<Ink>, stroke: Option<&Stroke>) {
    text.push_str("<path d=\"");
    for step in steps {
        match step {
            Step::Move(x, y) => push(text, format_args!("M{} {}", number(*x), number(*y))),
            Step::Line(x, y) => push(text, format_args!("L{} {}", number(*x), number(*y))),
            Step::Curve(points) => {
                let points = points.map(|(x, y)| format!("{} {}", number(x), number(y)));
                push(text, format_args!("C{}", points.join(" ")));
            }
            Step::Close => text.push('Z'),
        }
    }
    match fill {
        Some(ink) => push(text, format_args!("\" fill=\"{}\"{}", colour(ink), opacity("fill-opacity", ink))),
        None => text.push_str("\" fill=\"none\""),
    }
    if let Some(stroke) = stroke {
        let (ink, width) = (stroke.ink, number(stroke.width));
        let visible = opacity("stroke-opacity", ink);
        push(text, format_args!(" stroke=\"{}\"{visible} stroke-width=\"{width}\"", colour(ink)));
        if let Some((dash, gap)) = stroke.dash {
            push(text, format_args!(" stroke-dasharray=\"{} {}\"", number(dash), number(gap)));
        }
    }
    text.push_str("/>\n");
}

fn words(text: &mut String, label: &Label) {
    let (x, y) = (number(label.at.0), number(label.at.1));
    push(text, format_args!("<text x=\"{x}\" y=\"{y}\" font-size=\"{}\"", number(label.size)));
    push(text, format_args!(" fill=\"{}\"{}", colour(label.ink), opacity("fill-opacity", label.ink)));
    if label.bold {
        text.push_str(" font-weight=\"bold\"");
    }
    match label.anchor {
        Anchor::Start => {}
        Anchor::Middle => text.push_str(" text-anchor=\"middle\""),
        Anchor::End => text.push_str(" text-anchor=\"end\""),
    }
    if label.upwards {
        push(text, format_args!(" transform=\"rotate(-90 {x} {y})\""));
    }
    if label.halo {
        push(text, format_args!(" stroke=\"#fff\" stroke-width=\"{}\" paint-order=\"stroke\"", number(HALO)));
    }
    push(text, format_args!(">{}</text>\n", escaped(&label.text)));
}

fn push(text: &mut String, arguments: std::fmt::Arguments<'_>) {
    text.write_fmt(arguments).expect("a String takes all");
}

/// Two decimals are a tenth of what a screen can show; trailing zeros go.
fn number(value: f64) -> String {
    let text = format!("{value:.2}");
    let short = text.trim_end_matches('0').trim_end_matches('.');
    if short == "-0" { "0".into() } else { short.into() }
}

fn colour(ink: Ink) -> String {
    let [red, green, blue] = ink.rgb;
    format!("#{red:02x}{green:02x}{blue:02x}")
}

fn opacity(name: &str, ink: Ink) -> String {
    if ink.opacity < 1.0 { format!(" {name}=\"{}\"", number(f64::from(ink.opacity))) } else { String::new() }
}

/// Text for XML; characters that XML cannot hold are left out.
fn escaped(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '\t' | '\n' | '\r' => escaped.push(' '),
            c if c.is_control() || matches!(c, '\u{fffe}' | '\u{ffff}') => {}
            c => escaped.push(c),
        }
    }
    escaped
}

#[cfg(test)]
mod tests {
    use super::super::drawing::rectangle;
    use super::*;

    #[test]
    fn every_kind_of_item() {
        let mut drawing = Drawing { width: 20.0, height: 10.5, title: "a < b & c".into(), items: vec![] };
        drawing.fill(rectangle(0.0, -0.001, 2.0, 3.125), Ink::hex(0x01_02_ff).faint(0.5));
        drawing.line((0.0, 1.0), (2.0, 1.0), Stroke { ink: Ink::hex(0), width: 0.75, dash: Some((2.0, 1.5)) });
        drawing.text(Label {
            text: "x\u{1}\n>".into(),
            at: (1.0, 2.0),
            size: 9.0,
            bold: true,
            ink: Ink::hex(0x33_33_33),
            anchor: Anchor::End,
            upwards: true,
            halo: true,
        });
        let lines: Vec<String> = svg(&drawing).lines().map(String::from).collect();
        assert!(lines[0].contains("viewBox=\"0 0 20 10.5\""), "{}", lines[0]);
        assert_eq!(lines[1], "<title>a &lt; b &amp; c</title>");
        assert_eq!(lines[3], "<path d=\"M0 0L2 0L2 3.12L0 3.12Z\" fill=\"#0102ff\" fill-opacity=\"0.5\"/>");
        assert_eq!(
            lines[4],
            "<path d=\"M0 1L2 1\" fill=\"none\" stroke=\"#000000\" stroke-width=\"0.75\" stroke-dasharray=\"2 1.5\"/>"
        );
        assert_eq!(
            lines[5],
            "<text x=\"1\" y=\"2\" font-size=\"9\" fill=\"#333333\" font-weight=\"bold\" text-anchor=\"end\" \
             transform=\"rotate(-90 1 2)\" stroke=\"#fff\" stroke-width=\"2.5\" paint-order=\"stroke\">x &gt;</text>"
        );
    }
}
