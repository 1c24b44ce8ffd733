//! How a ray passes over quads to the next one whose top it is not above.

use super::line::Line;
use super::quads::{Parts, Plans, Quad, Quads};
use crate::construction::evaluate::Scattered;

/// A place where a ray needs to know the terrain.
pub(super) struct Place<'q, 't> {
    pub(super) t_m: f64,
    /// Where the ray leaves the quad.
    pub(super) exit_m: f64,
    pub(super) quad: &'q Quad<'t>,
    pub(super) home: Home<'q, 't>,
}

/// The smallest quad around a place that has plans of its own.
#[derive(Clone, Copy)]
pub(super) struct Home<'q, 't> {
    quad: &'q Quad<'t>,
    pub(super) plans: &'q Plans<'t>,
    /// Where the ray leaves it.
    exit_m: f64,
}

/// A ray with what is needed to cut it.
struct Cutter<'l> {
    line: &'l Line,
    /// Metres of way per metre along x, along y and up.
    inverse: [f64; 3],
}

/// Ends of at most three pieces of a way, and how many there are.
type Pieces = ([f64; 3], usize);

impl Cutter<'_> {
    /// Cuts the way from `a` to `b` where x or y is that of `middle`.
    #[inline(always)]
    fn pieces(&self, middle: [f64; 2], a: f64, b: f64) -> Pieces {
        let origin = self.line.ray.origin;
        let mut found = ([b; 3], 1);
        let (mut first, mut second) =
            ((middle[0] - origin[0]) * self.inverse[0], (middle[1] - origin[1]) * self.inverse[1]);
        if first > second {
            std::mem::swap(&mut first, &mut second);
        }
        // Not a number or infinite where the ray runs along the cut.
        if first > a && first < b {
            found.0[0] = first;
            found.1 = 2;
        }
        if second > a && second < b && second > first {
            found.0[found.1 - 1] = second;
            found.1 += 1;
        }
        found
    }

    /// Which of four parts around `middle` the way from `a` to `b` lies in.
    #[inline(always)]
    fn part(&self, middle: [f64; 2], a: f64, b: f64) -> usize {
        let [x, y] = self.line.ray.at(0.5 * (a + b));
        usize::from(x >= middle[0]) + 2 * usize::from(y >= middle[1])
    }

    /// The least elevation on the way from `a` to `b`.
    #[inline(always)]
    fn low(&self, a: f64, b: f64) -> f64 {
        self.line.ray.elevation_m(a).min(self.line.ray.elevation_m(b))
    }

    /// Where on the way from `a` to `b` the ray first is no higher than `top`, if it is anywhere.
    #[inline(always)]
    fn sinks(&self, top: f64, a: f64, b: f64) -> Option<f64> {
        if self.line.ray.elevation_m(a) <= top {
            return Some(a);
        }
        if self.line.ray.elevation_m(b) > top {
            return None;
        }
        Some(((top - self.line.ray.origin[2]) * self.inverse[2]).clamp(a, b))
    }
}

impl<'t> Quads<'t> {
    /// A place whose terrain is wanted whatever quads say.
    pub(super) fn anywhere<'q>(&'q self, line: &Line, t_m: f64) -> Option<Place<'q, 't>> {
        let root = self.root();
        let home = Home { quad: root, plans: root.plans.as_deref()?, exit_m: line.to_m };
        Some(Place { t_m, exit_m: t_m, quad: root, home })
    }

    /// The first place on the line after `from_m` whose elevation the quads cannot tell to be above the ground. The
    /// place before, if there was one, is only a shorter way to the quads.
    pub(super) fn seek<'q>(
        &'q self,
        line: &Line,
        from_m: f64,
        before: Option<&Place<'q, 't>>,
        work: &mut Scattered,
    ) -> Option<Place<'q, 't>> {
        let root = self.root();
        let cutter = Cutter { line, inverse: line.ray.direction.map(|speed| 1.0 / speed) };
        let mut from_m = from_m;
        if let Some(place) = before {
            let quads = [(place.quad, place.exit_m), (place.home.quad, place.home.exit_m)];
            for (quad, exit_m) in quads {
                if from_m < exit_m {
                    let found = self.visit(quad, place.home, &cutter, from_m, exit_m, work);
                    if found.is_some() {
                        return found;
                    }
                    from_m = exit_m;
                }
            }
            if from_m >= line.to_m {
                return None;
            }
        }
        let home = Home { quad: root, plans: root.plans.as_deref()?, exit_m: line.to_m };
        self.visit(root, home, &cutter, from_m, line.to_m, work)
    }

    fn visit<'q>(
        &'q self,
        quad: &'q Quad<'t>,
        home: Home<'q, 't>,
        cutter: &Cutter<'_>,
        from_m: f64,
        to_m: f64,
        work: &mut Scattered,
    ) -> Option<Place<'q, 't>> {
        if cutter.low(from_m, to_m) > quad.top {
            return None;
        }
        let home = quad.plans.as_deref().map_or(home, |plans| Home { quad, plans, exit_m: to_m });
        match &quad.parts {
            Parts::Quads(tops, _) => {
                let (ends, count) = cutter.pieces(quad.middle, from_m, to_m);
                let mut a = from_m;
                for &b in &ends[..count] {
                    let part = cutter.part(quad.middle, a, b);
                    if cutter.low(a, b) <= tops[part] {
                        let child = self.child(quad, part, work)?;
                        let found = self.visit(child, home, cutter, a, b, work);
                        if found.is_some() {
                            return found;
                        }
                    }
                    a = b;
                }
                None
            }
            Parts::Cells(cells) => {
                let (x, y) = (quad.area.x, quad.area.y);
                let at = quad.middle;
                let size = [x.width(), y.width()];
                let (four, sixteen, all) = &cells.tops;
                let found = cells_of(cutter, four, sixteen, all, at, size, from_m, to_m);
                found.map(|t_m| Place { t_m, exit_m: to_m, quad, home })
            }
            Parts::Whole => cutter.sinks(quad.top, from_m, to_m).map(|t_m| Place { t_m, exit_m: to_m, quad, home }),
        }
    }
}

/// The first place that is not above the cells of a quad around `middle`.
#[expect(clippy::too_many_arguments, reason = "three levels of tops, a square and a way")]
#[inline(always)]
fn cells_of(
    cutter: &Cutter<'_>,
    four: &[f64; 4],
    sixteen: &[f64; 16],
    all: &[f64; 64],
    middle: [f64; 2],
    size: [f64; 2],
    from_m: f64,
    to_m: f64,
) -> Option<f64> {
    let around = |middle: [f64; 2], part: usize, share: f64| -> [f64; 2] {
        let side = |second: bool| if second { share } else { -share };
        [middle[0] + size[0] * side(part % 2 == 1), middle[1] + size[1] * side(part / 2 == 1)]
    };
    let (ends, count) = cutter.pieces(middle, from_m, to_m);
    let mut a = from_m;
    for &b in &ends[..count] {
        let p = cutter.part(middle, a, b);
        if cutter.low(a, b) <= four[p] {
            let quarter = around(middle, p, 0.25);
            let (ends, count) = cutter.pieces(quarter, a, b);
            let mut a = a;
            for &b in &ends[..count] {
                let q = cutter.part(quarter, a, b);
                let (col, row) = (p % 2 * 2 + q % 2, p / 2 * 2 + q / 2);
                if cutter.low(a, b) <= sixteen[row * 4 + col] {
                    let eighth = around(quarter, q, 0.125);
                    let (ends, count) = cutter.pieces(eighth, a, b);
                    let mut a = a;
                    for &b in &ends[..count] {
                        let r = cutter.part(eighth, a, b);
                        let (col, row) = (col * 2 + r % 2, row * 2 + r / 2);
                        if let Some(t_m) = cutter.sinks(all[row * 8 + col], a, b) {
                            return Some(t_m);
                        }
                        a = b;
                    }
                }
                a = b;
            }
        }
        a = b;
    }
    None
}
