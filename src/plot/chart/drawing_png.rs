//! Drawings as PNG.

use super::drawing::{Anchor, Drawing, Ink, Item, Label, Step, Stroke};
use super::glyphs::Glyphs;
use super::svg::HALO;
use crate::error::{Error, ErrorKind, Result};
use tiny_skia::{Color, FillRule, Paint, Path, PathBuilder, Pixmap, StrokeDash, Transform};

/// The drawing as the bytes of a PNG on white, with `scale` pixels a unit.
///
/// # Errors
/// `Unsupported` when the picture would have no pixels, or more than fit.
pub fn png(drawing: &Drawing, scale: f64) -> Result<Vec<u8>> {
    let side = |length: f64| (length * scale).round() as u32;
    let (width, height) = (side(drawing.width), side(drawing.height));
    let unsupported =
        |what: &str| Error::new(ErrorKind::Unsupported, format!("a picture of {width} x {height} {what}"));
    let mut pixmap = Pixmap::new(width, height).ok_or_else(|| unsupported("pixels cannot be made"))?;
    pixmap.fill(Color::WHITE);
    let (glyphs, zoom) = (Glyphs::new(), Transform::from_scale(scale as f32, scale as f32));
    for item in &drawing.items {
        match item {
            Item::Path { steps, fill, stroke } => {
                let Some(path) = outline(steps) else { continue };
                if let Some(ink) = fill {
                    pixmap.fill_path(&path, &paint(*ink), FillRule::Winding, zoom, None);
                }
                if let Some(stroke) = stroke {
                    pixmap.stroke_path(&path, &paint(stroke.ink), &pen(stroke), zoom, None);
                }
            }
            Item::Text(label) => {
                if let Some(path) = outline(&glyphs.outline(&label.text, label.size, label.bold)) {
                    let placed = zoom.pre_concat(placing(label, &glyphs));
                    if label.halo {
                        let rim = pen(&Stroke::solid(Ink::hex(0xff_ff_ff), HALO));
                        pixmap.stroke_path(&path, &paint(Ink::hex(0xff_ff_ff)), &rim, placed, None);
                    }
                    pixmap.fill_path(&path, &paint(label.ink), FillRule::Winding, placed, None);
                }
            }
        }
    }
    pixmap.encode_png().map_err(|e| unsupported(&format!("pixels cannot be written: {e}")))
}

/// From the beginning of a text's baseline at the origin to its place.
fn placing(label: &Label, glyphs: &Glyphs) -> Transform {
    let width = glyphs.width(&label.text, label.size, label.bold);
    let back = match label.anchor {
        Anchor::Start => 0.0,
        Anchor::Middle => width / 2.0,
        Anchor::End => width,
    };
    let turned = if label.upwards { Transform::from_rotate(-90.0) } else { Transform::identity() };
    Transform::from_translate(label.at.0 as f32, label.at.1 as f32).pre_concat(turned).pre_translate(-back as f32, 0.0)
}

fn outline(steps: &[Step]) -> Option<Path> {
    let mut path = PathBuilder::new();
    for step in steps {
        match *step {
            Step::Move(x, y) => path.move_to(x as f32, y as f32),
            Step::Line(x, y) => path.line_to(x as f32, y as f32),
            Step::Curve([a, b, end]) => {
                path.cubic_to(a.0 as f32, a.1 as f32, b.0 as f32, b.1 as f32, end.0 as f32, end.1 as f32);
            }
            Step::Close => path.close(),
        }
    }
    path.finish()
}

fn paint(ink: Ink) -> Paint<'static> {
    let [red, green, blue] = ink.rgb;
    let mut paint = Paint { anti_alias: true, ..Paint::default() };
    paint.set_color_rgba8(red, green, blue, (ink.opacity * 255.0).round() as u8);
    paint
}

fn pen(stroke: &Stroke) -> tiny_skia::Stroke {
    tiny_skia::Stroke {
        width: stroke.width as f32,
        dash: stroke.dash.and_then(|(dash, gap)| StrokeDash::new(vec![dash as f32, gap as f32], 0.0)),
        ..tiny_skia::Stroke::default()
    }
}

#[cfg(test)]
mod tests {
    use super::super::drawing::rectangle;
    use super::*;

    #[test]
    fn paths_and_text_leave_marks() {
        let mut drawing = Drawing { width: 40.0, height: 20.0, ..Drawing::default() };
        drawing.fill(rectangle(0.0, 0.0, 4.0, 20.0), Ink::hex(0xff_00_00));
        drawing.text(Label {
            text: "MMM".into(),
            at: (39.0, 15.0),
            size: 12.0,
            bold: true,
            ink: Ink::hex(0),
            anchor: Anchor::End,
            upwards: false,
            halo: false,
        });
        let picture = Pixmap::decode_png(&png(&drawing, 2.0).unwrap()).unwrap();
        assert_eq!((picture.width(), picture.height()), (80, 40));
        let red = picture.pixel(3, 20).unwrap();
        assert_eq!((red.red(), red.green()), (255, 0));
        let dark = picture.pixels()[..].iter().filter(|p| p.red() < 60).count();
        assert!(dark > 100, "{dark} dark pixels");
        assert!(png(&Drawing::default(), 1.0).is_err());
    }
}
