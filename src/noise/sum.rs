//! Sums of octaves of noise, with their gradients and bounds.

use super::curvature::CURVATURE;
use super::gradient::{SLOPE, gradient_noise};
use super::{Octave, Sample};
use crate::interval::{Interval, product};

/// Points that go through one octave together.
const CHUNK: usize = 64;

/// How octaves are added.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum NoiseKind {
    /// Plain sum: hills (Génevaux et al. 2015, section 4.1).
    Fractal,
    /// Sum of absolute values: creases in the valleys (Perlin 1985).
    Turbulence,
    /// Ridged multifractal (Musgrave, in Ebert et al., "Texturing and modeling", chapter 16). With the signal
    /// `S_i = (offset - |eta_i|)² W_i`, `W_0 = 1` and `W_i = clamp(gain S_{i-1}, 0, 1)`, it is the sum of
    /// `amplitude_i S_i`: fine octaves live on the ridges of coarse ones.
    Ridged {
        /// Height from which ridges are folded; 1 is usual.
        offset: f64,
        /// How fast detail sets in; 2 is usual.
        gain: f64,
    },
}

/// When an octave sets in with growing level of detail kappa of `[0, 1]`: 0 up to `from`, 1 beyond `to`.
///
/// Between, `(1 - (1 - t)²)³` with `t = (kappa - from) / (to - from)`. The printed filter of Génevaux et al. 2015,
/// section 6, `(1 - t²)³`, falls from 1 to 0 and jumps at both ends; this is its mirror image, which rises from 0
/// to 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Filter {
    /// Level of detail at which the octave begins to show.
    pub from: f64,
    /// Level of detail at which it is whole; more than `from`.
    pub to: f64,
}

/// A sum of octaves.
#[derive(Clone, Debug, PartialEq)]
pub struct NoiseSum {
    kind: NoiseKind,
    octaves: Vec<Octave>,
    filters: Vec<Filter>,
}

/// Where a row of results goes; all three are as long as the row.
#[derive(Debug)]
pub struct Rows<'a> {
    /// Values.
    pub value: &'a mut [f64],
    /// Derivatives by x; left alone when no gradient is asked for.
    pub dx: &'a mut [f64],
    /// Derivatives by y; left alone when no gradient is asked for.
    pub dy: &'a mut [f64],
}

/// The signal of the octave before and the sum so far, at one point.
#[derive(Clone, Copy, Default)]
struct State {
    sum: Sample,
    signal: Sample,
}

impl Filter {
    /// Share of the octave at a level of detail, and its derivative.
    #[inline(always)]
    pub fn share(&self, kappa: f64) -> (f64, f64) {
        let width = self.to - self.from;
        let t = ((kappa - self.from) / width).clamp(0.0, 1.0);
        let (back, s) = (1.0 - t, t * (2.0 - t));
        (s * s * s, 6.0 * back * (s * s) / width)
    }

    /// Bound of the derivative of [`Filter::share`]: 96 sqrt(5) / 125 over the width.
    pub fn slope(&self) -> f64 {
        1.717_301_6 / (self.to - self.from)
    }
}

/// Adds one octave at one point.
#[inline(always)]
fn step<const GRADIENT: bool>(
    kind: NoiseKind,
    first: bool,
    octave: &Octave,
    (share, share_x, share_y): (f64, f64, f64),
    (x, y): (f64, f64),
    state: &mut State,
) {
    let n = gradient_noise::<GRADIENT>(
        octave.seed,
        x * octave.frequency + octave.shift[0],
        y * octave.frequency + octave.shift[1],
    );
    let (nx, ny) = (n.dx * octave.frequency, n.dy * octave.frequency);
    let sign = if n.value < 0.0 { -1.0 } else { 1.0 };
    let (t, tx, ty) = match kind {
        NoiseKind::Fractal => (n.value, nx, ny),
        NoiseKind::Turbulence => (n.value.abs(), sign * nx, sign * ny),
        NoiseKind::Ridged { offset, gain } => {
            let r = offset - n.value.abs();
            let square = r * r;
            let s = if first {
                Sample { value: square, dx: -2.0 * r * (sign * nx), dy: -2.0 * r * (sign * ny) }
            } else {
                let raw = gain * state.signal.value;
                let weight = raw.clamp(0.0, 1.0);
                // Where the weight is clamped it does not change.
                let slope = if raw > 0.0 && raw < 1.0 { gain * square } else { 0.0 };
                let fold = -2.0 * r * weight * sign;
                Sample {
                    value: square * weight,
                    dx: fold * nx + slope * state.signal.dx,
                    dy: fold * ny + slope * state.signal.dy,
                }
            };
            state.signal = s;
            (s.value, s.dx, s.dy)
        }
    };
    let a = octave.amplitude;
    state.sum.value += a * (t * share);
    if GRADIENT {
        state.sum.dx += a * (tx * share + t * share_x);
        state.sum.dy += a * (ty * share + t * share_y);
    }
}

impl NoiseSum {
    /// A sum of octaves, coarsest first.
    pub fn new(kind: NoiseKind, octaves: Vec<Octave>) -> Self {
        Self { kind, octaves, filters: vec![] }
    }

    /// The sum whose octaves set in with the level of detail, one filter an octave.
    ///
    /// # Panics
    /// When there is not one filter for each octave.
    #[must_use]
    pub fn with_filters(mut self, filters: Vec<Filter>) -> Self {
        assert_eq!(filters.len(), self.octaves.len(), "one filter an octave");
        self.filters = filters;
        self
    }

    /// How octaves are added.
    pub fn kind(&self) -> NoiseKind {
        self.kind
    }

    /// The octaves, coarsest first.
    pub fn octaves(&self) -> &[Octave] {
        &self.octaves
    }

    /// The filters: one an octave, or none.
    pub fn filters(&self) -> &[Filter] {
        &self.filters
    }

    /// What share of octave `i` shows at a level of detail, with derivatives.
    #[inline(always)]
    fn share(&self, i: usize, kappa: Sample) -> (f64, f64, f64) {
        match self.filters.get(i) {
            None => (1.0, 0.0, 0.0),
            Some(filter) => {
                let (share, slope) = filter.share(kappa.value);
                (share, slope * kappa.dx, slope * kappa.dy)
            }
        }
    }

    /// The sum at `(x, y)`, with its gradient; `kappa` is the level of detail there, of use to filters alone.
    ///
    /// Where the sum has a crease (turbulence, ridges) the gradient is that of one side.
    pub fn at(&self, x: f64, y: f64, kappa: Sample) -> Sample {
        let mut state = State::default();
        for (i, octave) in self.octaves.iter().enumerate() {
            step::<true>(self.kind, i == 0, octave, self.share(i, kappa), (x, y), &mut state);
        }
        state.sum
    }

    /// The sum at a row of points, the same to the bit as [`NoiseSum::at`]; `kappa` are levels of detail with their
    /// derivatives, where there are filters.
    ///
    /// Inlined, so that it is compiled for the vectors that the caller dispatches to.
    ///
    /// # Panics
    /// When slices differ in length.
    #[inline(always)]
    pub fn row<const GRADIENT: bool>(&self, xs: &[f64], ys: &[f64], kappa: Option<[&[f64]; 3]>, out: Rows<'_>) {
        match (self.kind, kappa) {
            (NoiseKind::Fractal, None) => self.row_of::<GRADIENT, _>(NoiseKind::Fractal, xs, ys, |_, _| ONE, out),
            (NoiseKind::Turbulence, None) => self.row_of::<GRADIENT, _>(NoiseKind::Turbulence, xs, ys, |_, _| ONE, out),
            (ridged, None) => self.row_of::<GRADIENT, _>(ridged, xs, ys, |_, _| ONE, out),
            (kind, Some([value, dx, dy])) => {
                let share = |i, at| self.share(i, Sample { value: value[at], dx: dx[at], dy: dy[at] });
                self.row_of::<GRADIENT, _>(kind, xs, ys, share, out);
            }
        }
    }

    /// [`NoiseSum::row`] for a kind that the compiler may know.
    #[inline(always)]
    fn row_of<const GRADIENT: bool, S: Fn(usize, usize) -> (f64, f64, f64)>(
        &self,
        kind: NoiseKind,
        xs: &[f64],
        ys: &[f64],
        share: S,
        out: Rows<'_>,
    ) {
        let count = xs.len();
        assert!(ys.len() == count && out.value.len() == count, "one result a point");
        assert!(out.dx.len() == count && out.dy.len() == count, "one result a point");
        let mut from = 0;
        while from < count {
            let n = CHUNK.min(count - from);
            // Always whole chunks: loops of a known length become vectors.
            let (mut px, mut py) = ([0.0; CHUNK], [0.0; CHUNK]);
            px[..n].copy_from_slice(&xs[from..from + n]);
            py[..n].copy_from_slice(&ys[from..from + n]);
            let (mut sum, mut sum_x, mut sum_y) = ([0.0; CHUNK], [0.0; CHUNK], [0.0; CHUNK]);
            let (mut signal, mut signal_x, mut signal_y) = ([0.0; CHUNK], [0.0; CHUNK], [0.0; CHUNK]);
            for (i, octave) in self.octaves.iter().enumerate() {
                let (octave, first) = (*octave, i == 0);
                for k in 0..CHUNK {
                    let mut state = State {
                        sum: Sample { value: sum[k], dx: sum_x[k], dy: sum_y[k] },
                        signal: Sample { value: signal[k], dx: signal_x[k], dy: signal_y[k] },
                    };
                    step::<GRADIENT>(
                        kind,
                        first,
                        &octave,
                        share(i, (from + k).min(count - 1)),
                        (px[k], py[k]),
                        &mut state,
                    );
                    (sum[k], signal[k]) = (state.sum.value, state.signal.value);
                    if GRADIENT {
                        (sum_x[k], sum_y[k]) = (state.sum.dx, state.sum.dy);
                        (signal_x[k], signal_y[k]) = (state.signal.dx, state.signal.dy);
                    }
                }
            }
            out.value[from..from + n].copy_from_slice(&sum[..n]);
            if GRADIENT {
                out.dx[from..from + n].copy_from_slice(&sum_x[..n]);
                out.dy[from..from + n].copy_from_slice(&sum_y[..n]);
            }
            from += n;
        }
    }

    /// Range and slope over the whole plane; `kappa` is the range of the level of detail and a bound of its slope.
    pub fn bounds(&self, kappa: (Interval, f64)) -> (Interval, f64) {
        self.bounds_of(kappa, |_| (Interval::new(-1.0, 1.0), SLOPE))
    }

    /// Range and slope over the disc of a radius around `(x, y)`.
    ///
    /// In a disc that is small next to an octave's bumps that octave's slope is not far from that at the centre, nor is
    /// its value.
    pub fn bounds_near(&self, x: f64, y: f64, radius: f64, kappa: (Interval, f64)) -> (Interval, f64) {
        self.bounds_of(kappa, |octave| {
            let whole = Interval::new(-1.0, 1.0);
            let radius = octave.frequency.abs() * radius;
            if SLOPE * radius >= 1.0 {
                return (whole, SLOPE);
            }
            let (x, y) = (x * octave.frequency + octave.shift[0], y * octave.frequency + octave.shift[1]);
            let n = gradient_noise::<true>(octave.seed, x, y);
            // Slopes beyond CURVATURE times the radius of the centre's are not there; the value changes by the mean.
            let slope = (n.dx * n.dx + n.dy * n.dy).sqrt() * (1.0 + 1e-12) + 1e-12;
            let (steep, mean) = (slope + CURVATURE * radius, slope + 0.5 * CURVATURE * radius);
            (whole.meet(Interval::around(n.value, SLOPE.min(mean) * radius)), SLOPE.min(steep))
        })
    }

    /// Bounds from those of each octave's noise, value and slope. The slope of a plain sum is the sum of `a_i s_i` [`SLOPE`] (the
    /// paper, section 7.3.1, divides by `s_i`, which are frequencies). For ridges, with `r_i = offset - |eta_i|`:
    /// `|grad S_i| <= 2 |r_i| W_i s_i SLOPE + r_i² gain |grad S_{i-1}|`.
    fn bounds_of(
        &self,
        (kappa, kappa_slope): (Interval, f64),
        eta: impl Fn(&Octave) -> (Interval, f64),
    ) -> (Interval, f64) {
        let (mut range, mut slope) = (Interval::ZERO, 0.0);
        let (mut signal, mut signal_slope) = (Interval::ZERO, 0.0);
        for (i, octave) in self.octaves.iter().enumerate() {
            let (eta, steep) = eta(octave);
            let steep = steep * octave.frequency.abs();
            let (term, term_slope) = match self.kind {
                NoiseKind::Fractal => (eta, steep),
                NoiseKind::Turbulence => (eta.abs(), steep),
                NoiseKind::Ridged { offset, gain } => {
                    let r = Interval::point(offset).minus(eta.abs());
                    let (weight, weight_slope) = if i == 0 {
                        (Interval::ONE, 0.0)
                    } else {
                        let raw = signal.scaled(gain);
                        let moves = raw.min < 1.0 && raw.max > 0.0;
                        (raw.clamped(0.0, 1.0), if moves { gain.abs() * signal_slope } else { 0.0 })
                    };
                    signal = r.square().times(weight);
                    signal_slope = 2.0 * r.size() * weight.max * steep + r.square().max * weight_slope;
                    (signal, signal_slope)
                }
            };
            let (share, share_slope) = match self.filters.get(i) {
                None => (Interval::ONE, 0.0),
                Some(filter) => {
                    let share = Interval::new(filter.share(kappa.min).0, filter.share(kappa.max).0);
                    let moves = kappa.min < filter.to && kappa.max > filter.from;
                    (share, if moves { product(filter.slope(), kappa_slope) } else { 0.0 })
                }
            };
            range = range.plus(term.times(share).scaled(octave.amplitude));
            slope += octave.amplitude.abs() * (term_slope * share.max + product(term.size(), share_slope));
        }
        (range.widened(), slope * (1.0 + 1e-12))
    }
}

/// The share of an octave that nothing filters.
const ONE: (f64, f64, f64) = (1.0, 0.0, 0.0);
