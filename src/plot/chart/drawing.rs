//! A drawing made of paths and text, from which SVG and PNG are written.

/// A colour with its opacity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ink {
    /// Red, green and blue.
    pub rgb: [u8; 3],
    /// Opacity from 0 to 1.
    pub opacity: f32,
}

impl Ink {
    /// An opaque colour written as `0xRRGGBB`.
    pub const fn hex(rgb: u32) -> Self {
        let [_, red, green, blue] = rgb.to_be_bytes();
        Self { rgb: [red, green, blue], opacity: 1.0 }
    }

    /// The same colour with another opacity.
    #[must_use]
    pub const fn faint(self, opacity: f32) -> Self {
        Self { rgb: self.rgb, opacity }
    }
}

/// How a path is stroked.
#[derive(Clone, Debug, PartialEq)]
pub struct Stroke {
    /// Colour.
    pub ink: Ink,
    /// Width in the units of the drawing.
    pub width: f64,
    /// Lengths of dash and gap; none for a solid line.
    pub dash: Option<(f64, f64)>,
}

impl Stroke {
    /// A solid line.
    pub const fn solid(ink: Ink, width: f64) -> Self {
        Self { ink, width, dash: None }
    }
}

/// One step of a path, in absolute coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Step {
    /// Begins a new part.
    Move(f64, f64),
    /// A straight line.
    Line(f64, f64),
    /// A cubic Bézier curve with its two control points.
    Curve([(f64, f64); 3]),
    /// Back to the beginning of the part.
    Close,
}

/// Where the given point of a text is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Anchor {
    /// At its left end.
    Start,
    /// In its middle.
    Middle,
    /// At its right end.
    End,
}

/// A line of text.
#[derive(Clone, Debug, PartialEq)]
pub struct Label {
    /// The words.
    pub text: String,
    /// Position of the baseline.
    pub at: (f64, f64),
    /// Size of the font.
    pub size: f64,
    /// Whether it is bold.
    pub bold: bool,
    /// Colour.
    pub ink: Ink,
    /// Which point of the text `at` is.
    pub anchor: Anchor,
    /// Whether it runs upwards.
    pub upwards: bool,
    /// Whether a white rim sets it off from what is below.
    pub halo: bool,
}

/// A thing on a drawing.
#[derive(Clone, Debug, PartialEq)]
pub enum Item {
    /// A path, filled (non-zero rule), stroked, or both.
    Path {
        /// Its steps.
        steps: Vec<Step>,
        /// Colour of the inside.
        fill: Option<Ink>,
        /// Outline.
        stroke: Option<Stroke>,
    },
    /// A line of text.
    Text(Label),
}

/// A drawing: `y` grows downwards, one unit is a pixel at 96 dpi.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Drawing {
    /// Width.
    pub width: f64,
    /// Height.
    pub height: f64,
    /// What it shows, for those who cannot see it.
    pub title: String,
    /// The things in the order in which they are painted.
    pub items: Vec<Item>,
}

impl Drawing {
    /// Adds a filled path.
    pub fn fill(&mut self, steps: Vec<Step>, ink: Ink) {
        self.items.push(Item::Path { steps, fill: Some(ink), stroke: None });
    }

    /// Adds a stroked path.
    pub fn stroke(&mut self, steps: Vec<Step>, stroke: Stroke) {
        self.items.push(Item::Path { steps, fill: None, stroke: Some(stroke) });
    }

    /// Adds a straight line.
    pub fn line(&mut self, from: (f64, f64), to: (f64, f64), stroke: Stroke) {
        self.stroke(vec![Step::Move(from.0, from.1), Step::Line(to.0, to.1)], stroke);
    }

    /// Adds a line of text.
    pub fn text(&mut self, label: Label) {
        self.items.push(Item::Text(label));
    }
}

/// A closed rectangle.
pub fn rectangle(x: f64, y: f64, width: f64, height: f64) -> Vec<Step> {
    use Step::{Close, Line, Move};
    vec![Move(x, y), Line(x + width, y), Line(x + width, y + height), Line(x, y + height), Close]
}

/// The steps along an arc of a circle from one azimuth to a later one, in degrees clockwise from the top; the pen is
/// at its beginning.
pub fn arc(centre: (f64, f64), radius: f64, from: f64, to: f64) -> Vec<Step> {
    // A cubic leaves the circle by less than 1e-5 of the radius over 30 degrees.
    let pieces = ((to - from).abs() / 30.0).ceil().max(1.0) as u32;
    let turn = (to - from).to_radians() / f64::from(pieces);
    let pull = 4.0 / 3.0 * (turn / 4.0).tan() * radius;
    let at = |angle: f64| on_circle(centre, radius, angle.to_degrees());
    (0..pieces)
        .map(|i| {
            let a = from.to_radians() + f64::from(i) * turn;
            let b = a + turn;
            let ((ax, ay), (bx, by)) = (at(a), at(b));
            let (along_a, along_b) = ((a.cos(), a.sin()), (b.cos(), b.sin()));
            Step::Curve([
                (ax + pull * along_a.0, ay + pull * along_a.1),
                (bx - pull * along_b.0, by - pull * along_b.1),
                (bx, by),
            ])
        })
        .collect()
}

/// The point of a circle at an azimuth in degrees clockwise from the top.
pub fn on_circle(centre: (f64, f64), radius: f64, azimuth: f64) -> (f64, f64) {
    let (sin, cos) = azimuth.to_radians().sin_cos();
    (centre.0 + radius * sin, centre.1 - radius * cos)
}

/// A whole circle.
pub fn circle(centre: (f64, f64), radius: f64) -> Vec<Step> {
    let mut steps = vec![Step::Move(centre.0, centre.1 - radius)];
    steps.extend(arc(centre, radius, 0.0, 360.0));
    steps.push(Step::Close);
    steps
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn arcs_stay_on_their_circle() {
        let mut pen = on_circle((10.0, 20.0), 50.0, 15.0);
        for step in arc((10.0, 20.0), 50.0, 15.0, 300.0) {
            let Step::Curve([a, b, end]) = step else { panic!("{step:?}") };
            for t in [0.25, 0.5, 0.75, 1.0_f64] {
                let w = [(1.0 - t).powi(3), 3.0 * t * (1.0 - t).powi(2), 3.0 * t * t * (1.0 - t), t.powi(3)];
                let x = w[0] * pen.0 + w[1] * a.0 + w[2] * b.0 + w[3] * end.0 - 10.0;
                let y = w[0] * pen.1 + w[1] * a.1 + w[2] * b.1 + w[3] * end.1 - 20.0;
                assert!((x.hypot(y) - 50.0).abs() < 1e-3, "{x} {y}");
            }
            pen = end;
        }
        let end = on_circle((10.0, 20.0), 50.0, 300.0);
        assert!((pen.0 - end.0).hypot(pen.1 - end.1) < 1e-9);
        assert_eq!(on_circle((0.0, 0.0), 1.0, 0.0), (0.0, -1.0), "north is up");
    }
}
