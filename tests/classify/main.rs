//! Forests against a slow and obvious reference, for any threads, in files.

#![cfg(feature = "program")]

mod agreement;
mod files;
mod reference;
#[path = "../schema/mod.rs"]
mod schema;

use orograph::classify::Samples;
use orograph::rng::Rng;

/// Samples whose first features tell something of their class, with many equal values.
fn samples(count: usize, features: usize, classes: u32, seed: u64) -> Samples {
    let mut rng = Rng::new(seed);
    let rows: Vec<(Vec<f64>, u32)> = (0..count)
        .map(|_| {
            let class = rng.below(u64::from(classes)) as u32;
            let value = |feature: usize, rng: &mut Rng| match feature {
                0 => (f64::from(class) + 2.0 * rng.unit()).floor() / 8.0,
                1 => f64::from(class) / 4.0 + rng.unit(),
                2 => 0.5,
                _ => rng.below(5) as f64 / 5.0,
            };
            ((0..features).map(|feature| value(feature, &mut rng)).collect(), class)
        })
        .collect();
    Samples::new(&rows, classes as usize).expect("sound samples")
}
