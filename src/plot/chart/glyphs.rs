//! Widths and outlines of letters, from the font that ships with the program.

use super::drawing::Step;
use ttf_parser::{Face, OutlineBuilder};

/// The font's two weights.
pub(super) struct Glyphs {
    regular: Face<'static>,
    bold: Face<'static>,
}

impl Glyphs {
    pub(super) fn new() -> Self {
        let face = |data| Face::parse(data, 0).expect("the font that ships with the program is sound");
        Self { regular: face(dejavu::sans::regular()), bold: face(dejavu::sans::bold()) }
    }

    fn face(&self, bold: bool) -> &Face<'static> {
        if bold { &self.bold } else { &self.regular }
    }

    /// Width of a text.
    pub(super) fn width(&self, text: &str, size: f64, bold: bool) -> f64 {
        let face = self.face(bold);
        let units: u32 = text.chars().map(|c| u32::from(advance(face, c))).sum();
        f64::from(units) * size / f64::from(face.units_per_em())
    }

    /// Outline of a text whose baseline begins at the origin, `y` downwards.
    pub(super) fn outline(&self, text: &str, size: f64, bold: bool) -> Vec<Step> {
        let face = self.face(bold);
        let scale = size / f64::from(face.units_per_em());
        let mut pen = Pen { steps: vec![], x: 0.0, scale, last: (0.0, 0.0) };
        for c in text.chars() {
            face.outline_glyph(face.glyph_index(c).unwrap_or_default(), &mut pen);
            pen.x += f64::from(advance(face, c)) * scale;
        }
        pen.steps
    }
}

fn advance(face: &Face<'_>, c: char) -> u16 {
    face.glyph_hor_advance(face.glyph_index(c).unwrap_or_default()).unwrap_or(0)
}

struct Pen {
    steps: Vec<Step>,
    x: f64,
    scale: f64,
    last: (f64, f64),
}

impl Pen {
    fn to(&mut self, x: f32, y: f32) -> (f64, f64) {
        (self.x + f64::from(x) * self.scale, -f64::from(y) * self.scale)
    }
}

impl OutlineBuilder for Pen {
    fn move_to(&mut self, x: f32, y: f32) {
        self.last = self.to(x, y);
        self.steps.push(Step::Move(self.last.0, self.last.1));
    }

    fn line_to(&mut self, x: f32, y: f32) {
        self.last = self.to(x, y);
        self.steps.push(Step::Line(self.last.0, self.last.1));
    }

    fn quad_to(&mut self, x1: f32, y1: f32, x: f32, y: f32) {
        let (from, control, end) = (self.last, self.to(x1, y1), self.to(x, y));
        let mix = |p: (f64, f64)| (p.0 + 2.0 / 3.0 * (control.0 - p.0), p.1 + 2.0 / 3.0 * (control.1 - p.1));
        self.steps.push(Step::Curve([mix(from), mix(end), end]));
        self.last = end;
    }

    fn curve_to(&mut self, x1: f32, y1: f32, x2: f32, y2: f32, x: f32, y: f32) {
        let (a, b, end) = (self.to(x1, y1), self.to(x2, y2), self.to(x, y));
        self.steps.push(Step::Curve([a, b, end]));
        self.last = end;
    }

    fn close(&mut self) {
        self.steps.push(Step::Close);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn widths_add_up_and_outlines_lie_within() {
        let glyphs = Glyphs::new();
        let (one, two) = (glyphs.width("≥ 30", 10.0, false), glyphs.width("≥ 30≥ 30", 10.0, false));
        assert!(one > 15.0 && (two - 2.0 * one).abs() < 1e-9);
        assert!(glyphs.width("m", 10.0, true) > glyphs.width("m", 10.0, false));
        let steps = glyphs.outline("H", 10.0, false);
        for step in &steps {
            if let Step::Move(x, y) | Step::Line(x, y) = *step {
                assert!((0.0..8.0).contains(&x) && (-8.0..=0.0).contains(&y), "{x} {y}: above the baseline");
            }
        }
    }
}
