//! Words on a map: glyph outlines of a font that ships with the program.

use super::canvas::{Canvas, Ink, Pen};
use tiny_skia::{Path, PathBuilder};
use ttf_parser::{Face, GlyphId, OutlineBuilder};

/// A typeface of the DejaVu family.
pub(super) struct Font {
    face: Face<'static>,
}

/// Where a text stands at its x.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Align {
    /// It starts there.
    Left,
    /// Its middle is there.
    Centre,
    /// It ends there.
    Right,
}

impl Font {
    /// The upright weight.
    pub(super) fn regular() -> Self {
        Self::built_in(dejavu::sans_condensed::regular())
    }

    /// The bold weight.
    pub(super) fn bold() -> Self {
        Self::built_in(dejavu::sans_condensed::bold())
    }

    fn built_in(data: &'static [u8]) -> Self {
        Self { face: Face::parse(data, 0).expect("the font is part of the program") }
    }

    /// Whether the font has every letter of a text and sets it rightly letter by letter.
    ///
    /// Scripts that run to the left or join their letters would come out wrong, so they are refused.
    pub(super) fn can_write(&self, text: &str) -> bool {
        text.chars().all(|c| {
            let joins_or_turns = matches!(u32::from(c), 0x0590..=0x08FF | 0xFB1D..=0xFEFC);
            !joins_or_turns && !c.is_control() && self.face.glyph_index(c).is_some()
        })
    }

    /// Width of a text at a size, both in pixels.
    pub(super) fn width(&self, text: &str, size: f32) -> f32 {
        let mut units = 0.0;
        self.walk(text, |_, _, advance| units += advance);
        units * self.scale(size)
    }

    /// Outlines of a text whose first letter starts at `x` and stands on the line `y`.
    pub(super) fn outline(&self, text: &str, size: f32, (x, y): (f32, f32)) -> Option<Path> {
        let scale = self.scale(size);
        let mut glyphs = Glyphs { path: PathBuilder::new(), x, y, scale };
        self.walk(text, |glyph, kern, advance| {
            glyphs.x += kern * scale;
            // Blanks have no outline, which is no fault.
            let _ = self.face.outline_glyph(glyph, &mut glyphs);
            glyphs.x += (advance - kern) * scale;
        });
        glyphs.path.finish()
    }

    /// Visits the glyphs of a text with their kerning and their advance, kerning included, in the font's units.
    fn walk(&self, text: &str, mut visit: impl FnMut(GlyphId, f32, f32)) {
        let mut last = None;
        for letter in text.chars() {
            let glyph = self.face.glyph_index(letter).unwrap_or_default();
            let kern = last.map_or(0.0, |last| self.kerning(last, glyph));
            visit(glyph, kern, kern + f32::from(self.face.glyph_hor_advance(glyph).unwrap_or(0)));
            last = Some(glyph);
        }
    }

    fn kerning(&self, left: GlyphId, right: GlyphId) -> f32 {
        let Some(table) = self.face.tables().kern else { return 0.0 };
        let kern = table
            .subtables
            .into_iter()
            .filter(|t| t.horizontal && !t.has_cross_stream)
            .find_map(|t| t.glyphs_kerning(left, right));
        f32::from(kern.unwrap_or(0))
    }

    fn scale(&self, size: f32) -> f32 {
        size / f32::from(self.face.units_per_em())
    }
}

/// Collects outlines at their place; fonts count upwards, pictures downwards.
struct Glyphs {
    path: PathBuilder,
    x: f32,
    y: f32,
    scale: f32,
}

impl Glyphs {
    fn at(&self, x: f32, y: f32) -> (f32, f32) {
        (self.x + x * self.scale, self.y - y * self.scale)
    }
}

impl OutlineBuilder for Glyphs {
    fn move_to(&mut self, x: f32, y: f32) {
        let (x, y) = self.at(x, y);
        self.path.move_to(x, y);
    }

    fn line_to(&mut self, x: f32, y: f32) {
        let (x, y) = self.at(x, y);
        self.path.line_to(x, y);
    }

    fn quad_to(&mut self, x1: f32, y1: f32, x: f32, y: f32) {
        let ((x1, y1), (x, y)) = (self.at(x1, y1), self.at(x, y));
        self.path.quad_to(x1, y1, x, y);
    }

    fn curve_to(&mut self, x1: f32, y1: f32, x2: f32, y2: f32, x: f32, y: f32) {
        let ((x1, y1), (x2, y2), (x, y)) = (self.at(x1, y1), self.at(x2, y2), self.at(x, y));
        self.path.cubic_to(x1, y1, x2, y2, x, y);
    }

    fn close(&mut self) {
        self.path.close();
    }
}

/// How a text looks.
pub(super) struct Lettering<'a> {
    pub(super) font: &'a Font,
    pub(super) size: f32,
    pub(super) ink: Ink,
    /// Width and colour of the rim that keeps the text apart from the map.
    pub(super) halo: Option<(f32, Ink)>,
}

impl Lettering<'_> {
    /// Width of a text in pixels.
    pub(super) fn width(&self, text: &str) -> f32 {
        self.font.width(text, self.size)
    }

    /// Writes a text on the line `y`.
    pub(super) fn write(&self, canvas: &mut Canvas, text: &str, (x, y): (f32, f32), align: Align) {
        let x = match align {
            Align::Left => x,
            Align::Centre => x - self.width(text) / 2.0,
            Align::Right => x - self.width(text),
        };
        let Some(path) = self.font.outline(text, self.size, (x, y)) else { return };
        if let Some((width, ink)) = self.halo {
            canvas.stroke(&path, &Pen::solid(ink, 2.0 * width));
        }
        canvas.fill(&path, self.ink);
    }

    /// Writes a text upwards, its middle at the pixel and its foot on the column `x`.
    pub(super) fn write_upwards(&self, canvas: &mut Canvas, text: &str, (x, y): (f32, f32)) {
        let start = (x - self.width(text) / 2.0, y);
        let path = self.font.outline(text, self.size, start);
        let turn = tiny_skia::Transform::from_rotate_at(-90.0, x, y);
        if let Some(path) = path.and_then(|path| path.transform(turn)) {
            canvas.fill(&path, self.ink);
        }
    }

    /// The text, cut with an ellipsis if it is wider than `room`.
    pub(super) fn fitted(&self, text: &str, room: f32) -> String {
        if self.width(text) <= room {
            return text.to_string();
        }
        let mut letters: Vec<char> = text.chars().collect();
        while !letters.is_empty() {
            letters.pop();
            let cut = format!("{}…", letters.iter().collect::<String>().trim_end());
            if self.width(&cut) <= room {
                return cut;
            }
        }
        String::new()
    }
}

/// A whole number with its digits in groups of three, `2 865`, with a true minus sign.
pub(super) fn grouped(value: f64) -> String {
    let digits = format!("{:.0}", value.abs());
    let minus = if value < 0.0 && digits != "0" { "\u{2212}" } else { "" };
    let mut text = String::from(minus);
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            // A narrow space that does not break.
            text.push('\u{202F}');
        }
        text.push(digit);
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn width_is_additive_but_for_kerning() {
        let font = Font::regular();
        let width = |text: &str| font.width(text, 20.0);
        assert!((width("Hn") + width("nH") - width("HnnH")).abs() < 1e-4);
        assert!(width("AV") < width("A") + width("V"), "kerned");
        assert!((font.width("Piz Kesch", 40.0) / width("Piz Kesch") - 2.0).abs() < 1e-5);
        assert_eq!(width(""), 0.0);
    }

    #[test]
    fn outlines_lie_between_their_line_and_their_caps() {
        let font = Font::bold();
        let bounds = font.outline("HEX", 50.0, (100.0, 200.0)).unwrap().bounds();
        assert!((bounds.bottom() - 200.0).abs() < 1.0 && (bounds.height() - 0.729 * 50.0).abs() < 1.0);
        assert!(bounds.left() >= 100.0 && bounds.right() <= 100.0 + font.width("HEX", 50.0));
        assert!(font.outline("   ", 50.0, (0.0, 0.0)).is_none());
    }

    #[test]
    fn scripts_that_would_come_out_wrong_are_refused() {
        let font = Font::regular();
        assert!(font.can_write("Schwarzhorn 3\u{202F}147 é Ž Ø Эльбрус"));
        assert!(!font.can_write("富士山"));
        assert!(!font.can_write("جبل"));
        assert!(!font.can_write("two\nlines"));
    }

    #[test]
    fn digits_in_groups() {
        for (value, text) in [
            (0.0, "0"),
            (-0.3, "0"),
            (865.4, "865"),
            (2865.0, "2\u{202F}865"),
            (-10_911.0, "\u{2212}10\u{202F}911"),
            (1_234_567.0, "1\u{202F}234\u{202F}567"),
        ] {
            assert_eq!(grouped(value), text);
        }
    }

    #[test]
    fn long_texts_are_cut() {
        let font = Font::regular();
        let lettering = Lettering { font: &font, size: 10.0, ink: Ink::WHITE, halo: None };
        let cut = lettering.fitted("a rather long line of source text", 60.0);
        assert!(cut.ends_with('…') && lettering.width(&cut) <= 60.0);
        assert_eq!(lettering.fitted("short", 60.0), "short");
        assert_eq!(lettering.fitted("short", 0.0), "");
    }
}
