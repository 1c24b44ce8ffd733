//! A first pass for a whole packet of rays: how far all of them are free of ground.

use super::line::Domain;
use super::quads::{Parts, Quad, Quads};
use super::ray::NEAREST_M;
use crate::construction::area::Area;
use crate::construction::evaluate::Scattered;
use crate::interval::Interval;

/// The packet ends where its free way cannot be made longer by so many pixels.
const FINEST_PX: f64 = 16.0;
/// Steps of a beam, at most: each doubles or halves what the next one tries.
const STEPS: u32 = 100;

/// Rays between four corners. At depth `s` they all lie within the hull of `origin + s way` of the corners: the ways of
/// a perspective all end on one plane, those of a parallel view all begin on one.
#[derive(Clone, Copy, Debug)]
pub(super) struct Beam {
    /// Where each corner begins, and what it moves per unit of depth.
    pub(super) corners: [([f64; 3], [f64; 3]); 4],
    /// A pixel's width at depth 0, and its growth.
    pub(super) pixel_m: [f64; 2],
    /// Where rays begin.
    pub(super) from: f64,
}

impl Beam {
    /// The box of the beam between two depths, and its lowest elevation.
    fn hull(&self, from: f64, to: f64) -> (Area, f64) {
        let (mut area, mut low) = (Area::EMPTY, f64::INFINITY);
        for (origin, way) in &self.corners {
            for s in [from, to] {
                let [x, y, z]: [f64; 3] = std::array::from_fn(|i| origin[i] + s * way[i]);
                area = area.hull(&Area { x: Interval::point(x), y: Interval::point(y) });
                low = low.min(z);
            }
        }
        (area.widened(), low)
    }

    /// The depth up to which all rays of the beam are free of ground; they may be for longer.
    pub(super) fn free(&self, quads: &Quads<'_>, domain: &Domain, work: &mut Scattered) -> f64 {
        let mut s = self.from;
        if s == f64::NEG_INFINITY {
            // Where the first corner comes down to the highest ground; parallel rays all fall alike.
            let falls = |(origin, way): &([f64; 3], [f64; 3])| (domain.elevation.max - origin[2]) / way[2];
            s = self.corners.iter().map(falls).fold(f64::INFINITY, f64::min);
            if !(self.corners[0].1[2] < 0.0 && s.is_finite()) {
                return f64::NEG_INFINITY;
            }
        }
        let finest = |s: f64| FINEST_PX * (self.pixel_m[0] + self.pixel_m[1] * s.max(NEAREST_M));
        let mut step = finest(s);
        for _ in 0..STEPS {
            let (area, low) = self.hull(s, s + step);
            if quads.top(&area, low, work) {
                step /= 2.0;
                if step < finest(s) {
                    return s;
                }
            } else {
                s += step;
                step *= 2.0;
            }
        }
        s
    }
}

impl<'t> Quads<'t> {
    /// Whether ground may rise above `low` in a box. Quads that are small next to the box are not divided.
    fn top(&self, area: &Area, low: f64, work: &mut Scattered) -> bool {
        self.rises(self.root(), area, low, area.x.width().max(area.y.width()), work)
    }

    fn rises(&self, quad: &Quad<'t>, area: &Area, low: f64, size: f64, work: &mut Scattered) -> bool {
        if quad.top < low || !quad.area.meets(area) {
            return false;
        }
        let Parts::Quads(tops, _) = &quad.parts else { return true };
        if quad.area.x.width() <= size / 4.0 {
            return true;
        }
        let halves = |range: Interval, at: f64| [Interval { max: at, ..range }, Interval { min: at, ..range }];
        let (xs, ys) = (halves(quad.area.x, quad.middle[0]), halves(quad.area.y, quad.middle[1]));
        (0..4).any(|part| {
            let own = Area { x: xs[part % 2], y: ys[part / 2] };
            tops[part] >= low
                && own.meets(area)
                && self.child(quad, part, work).is_some_and(|child| self.rises(child, area, low, size, work))
        })
    }
}
