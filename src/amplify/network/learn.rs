//! Learns a network: squares of terrain are drawn, and weights follow the slopes of the errors (Adam: Kingma and Ba 2015,
//! arXiv:1412.6980).

use super::super::learn::Lessons;
use super::super::orientation::{WAYS, Way};
use super::Network;
use super::ground::{Ground, SQUARE, Square};
use crate::error::Result;
use crate::rng::Rng;
use crate::watch::Watch;
use rayon::prelude::*;

/// Coarse cells around which all is known that are too few to learn from.
const TOO_FEW: usize = 500;
/// Squares of a turn.
const BATCH: usize = 8;
/// How often each place is looked at, and cells that are looked at, at most. Unit tests ask what holds of any network.
const LOOKS: usize = if cfg!(test) { 2 } else { 32 };
const MOST_CELLS: usize = 1 << 23;
/// The least turns.
const LEAST_TURNS: usize = if cfg!(test) { 20 } else { 100 };
/// Turns in which the weights' steps grow to their full length, as a part of all; afterwards they become shorter.
const WARM: f64 = 0.1;
/// The length of a weight's step.
const STEP: f64 = 5e-3;
/// How much of the mean of the slopes and of their squares stays in each turn.
const MEAN_STAYS: f64 = 0.9;
const SQUARE_STAYS: f64 = 0.999;
/// Detail without more power than this, in metres squared, teaches nothing.
const FLAT_M2: f64 = 1e-8;
/// What is added to a square's power, in parts of that of all terrain.
const CALM: f64 = 1e-4;

impl Network {
    /// Learns from lessons; nothing where there is too little known ground, or none with any relief. Equal seeds give
    /// equal networks, with any number of threads.
    ///
    /// # Errors
    /// When the job is cancelled.
    pub(in super::super) fn learn(
        lessons: &Lessons<'_>,
        factor: usize,
        is_square: bool,
        seed: u64,
        watch: &Watch,
    ) -> Result<Option<Self>> {
        let grounds: Vec<Ground> =
            (0..lessons.count).filter_map(|lesson| Ground::of(&(lessons.make)(lesson), factor)).collect();
        let places: usize = grounds.iter().map(|ground| ground.places.len()).sum();
        let power = grounds.iter().map(Ground::power).fold((0.0, 0), |(a, n), (b, m)| (a + b, n + m));
        let power_m2 = power.0 / power.1.max(1) as f64;
        if places < TOO_FEW || power_m2 < FLAT_M2 {
            return Ok(None);
        }
        let unit_m = power_m2.sqrt() as f32;
        let ways = if is_square { WAYS } else { WAYS / 2 };
        let turns = (places * LOOKS).min(MOST_CELLS) / (BATCH * SQUARE * SQUARE);
        let turns = turns.max(LEAST_TURNS);
        let mut rng = Rng::new(seed);
        let mut network = Self::drawn(factor, is_square, &mut rng);
        let mut descent = Descent::new(network.len());
        watch.begin("learning", turns as u64);
        for turn in 0..turns {
            let squares: Vec<Draw> = (0..BATCH)
                .map(|_| Draw {
                    place: rng.below(places as u64) as usize,
                    way: Way::number(rng.below(ways as u64) as usize),
                })
                .collect();
            let slopes: Vec<Vec<f32>> =
                squares.par_iter().map(|draw| network.slopes(&draw.square(&grounds, unit_m))).collect();
            let part = turn as f64 / turns as f64;
            descent.step(&mut network, &slopes, STEP * (part / WARM).min(1.0) * (1.0 - part));
            watch.advance(1)?;
        }
        Ok(Some(network))
    }

    /// Weights that are small and random.
    fn drawn(factor: usize, is_square: bool, rng: &mut Rng) -> Self {
        let mut network = Self::new(factor, is_square);
        for layer in &mut network.layers {
            // As far as this keeps numbers about as large from layer to layer.
            let most = 1.0 / ((9 * layer.inputs) as f64).sqrt();
            let (outputs, depth) = (layer.outputs, layer.depth());
            for parts in layer.weights.chunks_exact_mut(depth) {
                parts[..outputs].iter_mut().for_each(|part| *part = rng.between(-most, most) as f32);
            }
        }
        network
    }

    /// The derivatives by the weights of the mean square error of a square, divided by the root of how much there is to
    /// say of it: between errors that count by relief, which the steepest would rule, and ones that are blind to it.
    fn slopes(&self, square: &Square) -> Vec<f32> {
        let (mut slopes, before) = self.traced(square.rises.clone());
        let depth = slopes.depth;
        let cells = || square.detail.values.chunks_exact(depth).zip(&square.counts);
        let power: f64 = cells()
            .filter(|(_, count)| **count > 0.0)
            .map(|(cell, _)| cell.iter().map(|&v| f64::from(v) * f64::from(v)).sum::<f64>())
            .sum();
        let values = (square.counts.len() * self.factor * self.factor) as f64;
        let times = (2.0 / ((power / values + CALM).sqrt() * values)) as f32;
        for (slopes, (truth, count)) in slopes.values.chunks_exact_mut(depth).zip(cells()) {
            slopes.iter_mut().zip(truth).for_each(|(slope, truth)| *slope = (*slope - truth) * times * count);
        }
        self.weight_slopes(&before, slopes)
    }
}

/// Which square is looked at.
struct Draw {
    place: usize,
    way: Way,
}

impl Draw {
    fn square(&self, grounds: &[Ground], unit_m: f32) -> Square {
        let mut place = self.place;
        for ground in grounds {
            match ground.places.get(place) {
                Some(&place) => return ground.square(place, self.way, unit_m),
                None => place -= ground.places.len(),
            }
        }
        unreachable!("places are drawn from those that there are")
    }
}

/// The way down.
struct Descent {
    means: Vec<f32>,
    squares: Vec<f32>,
    /// What is left of the first turn in them.
    stays: [f64; 2],
}

impl Descent {
    fn new(len: usize) -> Self {
        Self { means: vec![0.0; len], squares: vec![0.0; len], stays: [1.0; 2] }
    }

    /// Moves the weights by about `length` against the slopes that were found on each of some squares.
    fn step(&mut self, network: &mut Network, slopes: &[Vec<f32>], length: f64) {
        self.stays[0] *= MEAN_STAYS;
        self.stays[1] *= SQUARE_STAYS;
        let times = (length / (1.0 - self.stays[0])) as f32;
        let part = (1.0 / (1.0 - self.stays[1])) as f32;
        let [mean_stays, square_stays] = [MEAN_STAYS as f32, SQUARE_STAYS as f32];
        let state = self.means.iter_mut().zip(&mut self.squares);
        for (i, (weight, (mean, square))) in network.weights_mut().zip(state).enumerate() {
            let slope = slopes.iter().map(|slopes| slopes[i]).sum::<f32>() / slopes.len() as f32;
            *mean = mean_stays * *mean + (1.0 - mean_stays) * slope;
            *square = square_stays * *square + (1.0 - square_stays) * (slope * slope);
            *weight -= times * *mean / ((*square * part).sqrt() + 1e-8);
        }
    }
}
