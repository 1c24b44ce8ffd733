//! Sums of octaves of noise, with their gradients.

use super::eta::{COLS, Eta, ROWS};
use super::gradient::gradient_noise;
use super::{Filter, Octave, Sample};
use std::cell::Cell;

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

/// A sum of octaves.
#[derive(Clone, Debug, PartialEq)]
pub struct NoiseSum {
    base: f64,
    kind: NoiseKind,
    octaves: Vec<Octave>,
    filters: Vec<Filter>,
}

/// Where rows of results go; all three are as long as there are rows.
#[derive(Debug)]
pub struct Rows<'a> {
    /// Values.
    pub value: &'a mut [[f64; COLS]],
    /// Derivatives by x; left alone when no gradient is asked for.
    pub dx: &'a mut [[f64; COLS]],
    /// Derivatives by y; left alone when no gradient is asked for.
    pub dy: &'a mut [[f64; COLS]],
}

/// Where the points are.
#[derive(Clone, Copy)]
enum Points<'a> {
    /// Where columns and rows cross.
    Crossing(&'a [f64; COLS], &'a [f64]),
    /// Anywhere.
    Scattered(&'a [[f64; COLS]], &'a [[f64; COLS]]),
}

/// Levels of detail of rows of points, with their derivatives.
pub type Levels<'a> = [&'a [[f64; COLS]]; 3];

/// The signal of the octave before and the sum so far, at one point.
#[derive(Clone, Copy, Default)]
struct State {
    sum: Sample,
    signal: Sample,
}

/// Adds one octave at one point: its noise, and the share of it that shows, with derivatives, where it is filtered.
#[inline(always)]
fn step<const GRADIENT: bool>(
    kind: NoiseKind,
    first: bool,
    octave: &Octave,
    share: Option<Sample>,
    n: Sample,
    state: &mut State,
) {
    let (nx, ny) = (n.dx * octave.frequency, n.dy * octave.frequency);
    let sign = if n.value < 0.0 { -1.0 } else { 1.0 };
    let t = match kind {
        NoiseKind::Fractal => Sample { value: n.value, dx: nx, dy: ny },
        NoiseKind::Turbulence => Sample { value: n.value.abs(), dx: sign * nx, dy: sign * ny },
        NoiseKind::Ridged { offset, gain } => {
            let r = offset - n.value.abs();
            let square = r * r;
            state.signal = if first {
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
            state.signal
        }
    };
    let t = match share {
        None => t,
        Some(share) => Sample {
            value: t.value * share.value,
            dx: t.dx * share.value + t.value * share.dx,
            dy: t.dy * share.value + t.value * share.dy,
        },
    };
    state.sum.value += octave.amplitude * t.value;
    if GRADIENT {
        state.sum.dx += octave.amplitude * t.dx;
        state.sum.dy += octave.amplitude * t.dy;
    }
}

impl NoiseSum {
    /// A sum of octaves, coarsest first.
    pub fn new(kind: NoiseKind, octaves: Vec<Octave>) -> Self {
        Self { base: 0.0, kind, octaves, filters: vec![] }
    }

    /// The sum that begins with a number: the elevation around which the noise goes up and down.
    #[must_use]
    pub fn with_base(self, base: f64) -> Self {
        Self { base, ..self }
    }

    /// The number that the sum begins with, 0 unless said otherwise.
    pub fn base(&self) -> f64 {
        self.base
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

    /// The sum at `(x, y)`, with its gradient; `kappa` is the level of detail there, of use to filters alone.
    ///
    /// Where the sum has a crease (turbulence, ridges) the gradient is that of one side.
    pub fn at(&self, x: f64, y: f64, kappa: Sample) -> Sample {
        let mut state = State::default();
        state.sum.value = self.base;
        for (i, octave) in self.octaves.iter().enumerate() {
            let (x, y) = (x * octave.frequency + octave.shift[0], y * octave.frequency + octave.shift[1]);
            let n = gradient_noise::<true>(octave.seed, x, y);
            step::<true>(
                self.kind,
                i == 0,
                octave,
                self.filters.get(i).map(|filter| filter.sample(kappa)),
                n,
                &mut state,
            );
        }
        state.sum
    }

    /// The sum where columns at `xs` cross rows at `ys`, the same to the bit as [`NoiseSum::at`]; `kappa` are levels of
    /// detail where there are filters, otherwise not looked at.
    ///
    /// Inlined, so that it is compiled for the vectors that the caller dispatches to.
    ///
    /// # Panics
    /// When there are not as many rows of results, or of levels where there are filters, as heights.
    #[inline(always)]
    pub fn cross<const GRADIENT: bool>(&self, xs: &[f64; COLS], ys: &[f64], kappa: Levels<'_>, out: Rows<'_>) {
        self.rows::<GRADIENT>(Points::Crossing(xs, ys), ys.len(), kappa, out);
    }

    /// The sum at rows of any points, the same to the bit as [`NoiseSum::at`]; see [`NoiseSum::cross`].
    ///
    /// # Panics
    /// As [`NoiseSum::cross`].
    #[inline(always)]
    pub fn scatter<const GRADIENT: bool>(
        &self,
        xs: &[[f64; COLS]],
        ys: &[[f64; COLS]],
        kappa: Levels<'_>,
        out: Rows<'_>,
    ) {
        assert_eq!(xs.len(), ys.len(), "as many rows of x as of y");
        self.rows::<GRADIENT>(Points::Scattered(xs, ys), xs.len(), kappa, out);
    }

    /// Rows of the sum.
    #[inline(always)]
    fn rows<const GRADIENT: bool>(&self, points: Points<'_>, count: usize, kappa: Levels<'_>, out: Rows<'_>) {
        let Rows { value, dx, dy } = out;
        if self.octaves.is_empty() {
            value.fill([self.base; COLS]);
            dx.fill([0.0; COLS]);
            dy.fill([0.0; COLS]);
            return;
        }
        assert!(value.len() == count && dx.len() == count && dy.len() == count, "one row of results a row");
        let mut room = ROOM.take().unwrap_or_default();
        let Room { eta, signal } = room.as_mut();
        for from in (0..count).step_by(ROWS) {
            let to = count.min(from + ROWS);
            // Once for all octaves.
            let mut heights = [0.0; ROWS];
            if let Points::Crossing(_, ys) = points {
                heights[..to - from].copy_from_slice(&ys[from..to]);
            }
            let mut sums = Sums {
                base: self.base,
                value: &mut value[from..to],
                dx: &mut dx[from..to],
                dy: &mut dy[from..to],
                signal: &mut *signal,
            };
            for (i, octave) in self.octaves.iter().enumerate() {
                match points {
                    Points::Crossing(xs, _) => eta.cross::<GRADIENT>(octave, xs, &heights, to - from),
                    Points::Scattered(xs, ys) => eta.scatter::<GRADIENT>(octave, &xs[from..to], &ys[from..to]),
                }
                // Each kind a loop of its own.
                match (self.kind, self.filters.get(i)) {
                    (NoiseKind::Fractal, None) => {
                        sums.add::<GRADIENT>(NoiseKind::Fractal, i == 0, octave, eta, None);
                    }
                    (NoiseKind::Turbulence, None) => {
                        sums.add::<GRADIENT>(NoiseKind::Turbulence, i == 0, octave, eta, None);
                    }
                    (ridged, None) if i == 0 => sums.add::<GRADIENT>(ridged, true, octave, eta, None),
                    (ridged, None) => sums.add::<GRADIENT>(ridged, false, octave, eta, None),
                    (kind, Some(filter)) => {
                        let [value, dx, dy] = kappa;
                        let kappa = [&value[from..to], &dx[from..to], &dy[from..to]];
                        sums.add::<GRADIENT>(kind, i == 0, octave, eta, Some((filter, kappa)));
                    }
                }
            }
        }
        ROOM.set(Some(room));
    }
}

/// Sums and signals of up to [`ROWS`] rows of points.
struct Sums<'a> {
    base: f64,
    value: &'a mut [[f64; COLS]],
    dx: &'a mut [[f64; COLS]],
    dy: &'a mut [[f64; COLS]],
    signal: &'a mut [[[f64; COLS]; ROWS]; 3],
}

/// Memory of one thread for rows of points, kept because clearing it would take as long as an octave.
struct Room {
    eta: Eta,
    signal: [[[f64; COLS]; ROWS]; 3],
}

impl Default for Room {
    fn default() -> Self {
        Self { eta: Eta::default(), signal: [[[0.0; COLS]; ROWS]; 3] }
    }
}

thread_local! {
    static ROOM: Cell<Option<Box<Room>>> = const { Cell::new(None) };
}

impl Sums<'_> {
    /// Adds one octave. The first sets, whatever was there before.
    #[inline(always)]
    fn add<const GRADIENT: bool>(
        &mut self,
        kind: NoiseKind,
        first: bool,
        octave: &Octave,
        eta: &Eta,
        filter: Option<(&Filter, Levels<'_>)>,
    ) {
        let octave = *octave;
        for r in 0..self.value.len() {
            let sum = &mut self.value[r];
            let [signal, signal_x, signal_y] = &mut *self.signal;
            let (signal, signal_x, signal_y) = (&mut signal[r], &mut signal_x[r], &mut signal_y[r]);
            let (sum_x, sum_y) = (&mut self.dx[r], &mut self.dy[r]);
            let (n, nx, ny) = (&eta.value[r], &eta.dx[r], &eta.dy[r]);
            if first {
                *sum = [self.base; COLS];
                if GRADIENT {
                    (*sum_x, *sum_y) = ([0.0; COLS], [0.0; COLS]);
                }
            }
            for k in 0..COLS {
                let (mut state, mut n) = (State::default(), Sample { value: n[k], dx: 0.0, dy: 0.0 });
                (state.sum.value, state.signal.value) = (sum[k], signal[k]);
                if GRADIENT {
                    (n.dx, n.dy) = (nx[k], ny[k]);
                    (state.sum.dx, state.sum.dy) = (sum_x[k], sum_y[k]);
                    (state.signal.dx, state.signal.dy) = (signal_x[k], signal_y[k]);
                }
                let share = filter.map(
                    #[inline(always)]
                    |(filter, [value, dx, dy])| {
                        filter.sample(Sample { value: value[r][k], dx: dx[r][k], dy: dy[r][k] })
                    },
                );
                step::<GRADIENT>(kind, first, &octave, share, n, &mut state);
                sum[k] = state.sum.value;
                if matches!(kind, NoiseKind::Ridged { .. }) {
                    signal[k] = state.signal.value;
                }
                if GRADIENT {
                    (sum_x[k], sum_y[k]) = (state.sum.dx, state.sum.dy);
                    (signal_x[k], signal_y[k]) = (state.signal.dx, state.signal.dy);
                }
            }
        }
    }
}
