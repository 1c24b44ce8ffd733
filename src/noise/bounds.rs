//! Bounds of sums of noise.

use super::curvature::CURVATURE;
use super::gradient::{SLOPE, gradient_noise};
use super::{NoiseKind, NoiseSum, Octave};
use crate::interval::{Interval, product};

impl NoiseSum {
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

    /// Bounds from those of each octave's noise, value and slope. The slope of a plain sum is the sum of `a_i s_i`
    /// [`SLOPE`] (the
    /// paper, section 7.3.1, divides by `s_i`, which are frequencies). For ridges, with `r_i = offset - |eta_i|`:
    /// `|grad S_i| <= 2 |r_i| W_i s_i SLOPE + r_i² gain |grad S_{i-1}|`.
    fn bounds_of(
        &self,
        (kappa, kappa_slope): (Interval, f64),
        eta: impl Fn(&Octave) -> (Interval, f64),
    ) -> (Interval, f64) {
        let (mut range, mut slope) = (Interval::point(self.base()), 0.0);
        let (mut signal, mut signal_slope) = (Interval::ZERO, 0.0);
        for (i, octave) in self.octaves().iter().enumerate() {
            let (eta, steep) = eta(octave);
            let steep = steep * octave.frequency.abs();
            let (term, term_slope) = match self.kind() {
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
            let (share, share_slope) = match self.filters().get(i) {
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
