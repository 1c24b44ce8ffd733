//! The sheet of pixels that everything is drawn on.

use super::super::png;
use crate::error::{Error, ErrorKind, Result};
use tiny_skia::{
    Color, FillRule, LineCap, LineJoin, Paint, Path, PathBuilder, Pixmap, PixmapPaint, Rect, Stroke, StrokeDash,
    Transform,
};

/// A colour: red, green, blue and opacity, 0 to 255.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Ink(pub(super) [u8; 4]);

impl Ink {
    pub(super) const WHITE: Self = Self::rgb(255, 255, 255);

    pub(super) const fn rgb(r: u8, g: u8, b: u8) -> Self {
        Self([r, g, b, 255])
    }

    /// The colour with an opacity of 0 to 1.
    pub(super) fn opacity(self, opacity: f32) -> Self {
        let [r, g, b, _] = self.0;
        Self([r, g, b, (opacity * 255.0).round().clamp(0.0, 255.0) as u8])
    }

    fn paint(self) -> Paint<'static> {
        let [r, g, b, a] = self.0;
        let mut paint = Paint { anti_alias: true, ..Paint::default() };
        paint.set_color_rgba8(r, g, b, a);
        paint
    }
}

/// How a line is drawn.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pen {
    pub(super) ink: Ink,
    pub(super) width: f32,
    /// Lengths of dash and gap, if it is dashed.
    pub(super) dash: Option<(f32, f32)>,
}

impl Pen {
    pub(super) fn solid(ink: Ink, width: f32) -> Self {
        Self { ink, width, dash: None }
    }

    fn stroke(&self) -> Stroke {
        Stroke {
            width: self.width,
            line_cap: if self.dash.is_some() { LineCap::Butt } else { LineCap::Round },
            line_join: LineJoin::Round,
            dash: self.dash.and_then(|(on, off)| StrokeDash::new(vec![on, off], 0.0)),
            ..Stroke::default()
        }
    }
}

/// Pixels to draw on; x runs to the right, y downwards, whole numbers are the corners of pixels.
pub(super) struct Canvas {
    pixmap: Pixmap,
}

impl Canvas {
    /// A sheet of one colour.
    pub(super) fn new(width: u32, height: u32, background: Ink) -> Result<Self> {
        let mut pixmap = Pixmap::new(width, height).ok_or_else(|| {
            Error::new(
                ErrorKind::Unsupported,
                format!("a picture of {width} x {height} pixels is too large; ask for a narrower one"),
            )
        })?;
        let [r, g, b, a] = background.0;
        pixmap.fill(Color::from_rgba8(r, g, b, a));
        Ok(Self { pixmap })
    }

    /// Width and height.
    pub(super) fn size(&self) -> (u32, u32) {
        (self.pixmap.width(), self.pixmap.height())
    }

    /// A sheet from opaque pixels, row by row.
    pub(super) fn from_pixels(width: u32, height: u32, pixels: &[[u8; 3]]) -> Result<Self> {
        let mut canvas = Self::new(width, height, Ink::WHITE)?;
        for (target, [r, g, b]) in canvas.pixmap.data_mut().chunks_exact_mut(4).zip(pixels) {
            target.copy_from_slice(&[*r, *g, *b, 255]);
        }
        Ok(canvas)
    }

    /// Puts another sheet on this one, its upper left corner at `x`, `y`.
    pub(super) fn place(&mut self, sheet: &Self, x: i32, y: i32) {
        self.pixmap.draw_pixmap(x, y, sheet.pixmap.as_ref(), &PixmapPaint::default(), Transform::identity(), None);
    }

    /// Draws a line through points.
    pub(super) fn polyline(&mut self, points: &[(f32, f32)], pen: &Pen) {
        if let Some(path) = outline(points, false) {
            self.stroke(&path, pen);
        }
    }

    /// Fills a polygon and draws its outline.
    pub(super) fn polygon(&mut self, corners: &[(f32, f32)], fill: Ink, edge: Option<Pen>) {
        if let Some(path) = outline(corners, true) {
            self.shape(&path, fill, edge);
        }
    }

    /// Fills a circle and draws its outline.
    pub(super) fn circle(&mut self, x: f32, y: f32, radius: f32, fill: Ink, edge: Option<Pen>) {
        if let Some(path) = PathBuilder::from_circle(x, y, radius) {
            self.shape(&path, fill, edge);
        }
    }

    /// Fills a rectangle without smoothing, so that it ends at pixels.
    pub(super) fn rectangle(&mut self, x: f32, y: f32, width: f32, height: f32, fill: Ink) {
        if let Some(rect) = Rect::from_xywh(x, y, width, height) {
            let paint = Paint { anti_alias: false, ..fill.paint() };
            self.pixmap.fill_rect(rect, &paint, Transform::identity(), None);
        }
    }

    /// Fills any path; the even-odd rule does not apply.
    pub(super) fn fill(&mut self, path: &Path, ink: Ink) {
        self.pixmap.fill_path(path, &ink.paint(), FillRule::Winding, Transform::identity(), None);
    }

    /// Draws any path as a line.
    pub(super) fn stroke(&mut self, path: &Path, pen: &Pen) {
        self.pixmap.stroke_path(path, &pen.ink.paint(), &pen.stroke(), Transform::identity(), None);
    }

    fn shape(&mut self, path: &Path, fill: Ink, edge: Option<Pen>) {
        if let Some(pen) = edge {
            // The edge first and twice as wide: its inner half is covered, and the shape keeps its size.
            self.stroke(path, &Pen { width: 2.0 * pen.width, ..pen });
        }
        self.fill(path, fill);
    }

    /// The picture as a PNG file, without its opacity: what was drawn on is opaque.
    pub(super) fn png(&self) -> Result<Vec<u8>> {
        let pixels: Vec<u8> = self.pixmap.data().chunks_exact(4).flat_map(|p| [p[0], p[1], p[2]]).collect();
        png::encode(self.pixmap.width(), self.pixmap.height(), &pixels)
    }
}

fn outline(points: &[(f32, f32)], close: bool) -> Option<Path> {
    let mut builder = PathBuilder::with_capacity(points.len() + 1, points.len());
    let mut points = points.iter();
    let &(x, y) = points.next()?;
    builder.move_to(x, y);
    for &(x, y) in points {
        builder.line_to(x, y);
    }
    if close {
        builder.close();
    }
    builder.finish()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pixel(canvas: &Canvas, x: u32, y: u32) -> [u8; 3] {
        let p = canvas.pixmap.pixel(x, y).unwrap();
        [p.red(), p.green(), p.blue()]
    }

    #[test]
    fn png_decodes_to_what_was_drawn() {
        let mut canvas = Canvas::new(40, 30, Ink::WHITE).unwrap();
        canvas.rectangle(10.0, 10.0, 5.0, 5.0, Ink::rgb(10, 20, 30));
        let back = Pixmap::decode_png(&canvas.png().unwrap()).unwrap();
        assert_eq!((back.width(), back.height()), (40, 30));
        assert_eq!(back.data(), canvas.pixmap.data());
        assert_eq!(pixel(&canvas, 12, 12), [10, 20, 30]);
        assert_eq!(pixel(&canvas, 15, 12), [255, 255, 255]);
    }

    #[test]
    fn shapes_cover_what_they_should() {
        let mut canvas = Canvas::new(40, 40, Ink::WHITE).unwrap();
        canvas.circle(20.0, 20.0, 8.0, Ink::rgb(0, 0, 0), Some(Pen::solid(Ink::rgb(255, 0, 0), 3.0)));
        assert_eq!(pixel(&canvas, 20, 20), [0, 0, 0]);
        assert_eq!(pixel(&canvas, 20, 10), [255, 0, 0]);
        assert_eq!(pixel(&canvas, 20, 6), [255, 255, 255]);
        canvas.polyline(&[(0.0, 35.0), (40.0, 35.0)], &Pen::solid(Ink::rgb(0, 0, 255), 4.0));
        assert_eq!(pixel(&canvas, 5, 35), [0, 0, 255]);
    }

    #[test]
    fn nothing_to_draw_is_no_trouble() {
        let mut canvas = Canvas::new(4, 4, Ink::WHITE).unwrap();
        canvas.polyline(&[], &Pen::solid(Ink::WHITE, 1.0));
        canvas.polygon(&[(1.0, 1.0)], Ink::rgb(0, 0, 0), None);
        canvas.polyline(&[(f32::NAN, 1.0), (2.0, 2.0)], &Pen::solid(Ink::WHITE, 1.0));
        assert!(Canvas::new(0, 4, Ink::WHITE).is_err());
    }
}
