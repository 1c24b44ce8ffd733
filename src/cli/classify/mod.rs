//! `orograph classify`: verbs that tell ranges apart.

mod predict;
mod train;

use super::execute;
use clap::{Args, Subcommand};

/// Tell which range peaks are in: learn from ranges of known classes, then ask of others (Argudo et al. 2019,
/// section 4.2).
///
/// A random forest looks at the histograms of the paper's table 1 in disks: dominances, prominences, isolations and
/// key saddles with their directions, relative elevations. No plain elevation is among them, and no number of peaks.
#[derive(Args, Clone, Debug)]
#[command(after_help = "Examples:\n  \
    orograph peaks fixtures/jacksboro.tif real.gpkg\n  \
    orograph synthesize made.gpkg --tree-only --like real.gpkg\n  \
    orograph classify train model.json --peaks real=real.gpkg --peaks made=made.gpkg --disk-radius 5km\n  \
    orograph classify predict model.json made.gpkg")]
pub(super) struct Classify {
    #[command(subcommand)]
    verb: Verb,
}

#[derive(Clone, Debug, Subcommand)]
enum Verb {
    Predict(Box<predict::Predict>),
    Train(Box<train::Train>),
}

impl Classify {
    /// Runs the verb; returns the exit code.
    pub(super) fn run(&self) -> u8 {
        match &self.verb {
            Verb::Predict(verb) => execute("classify predict", &verb.common, |reporter| verb.run(reporter)),
            Verb::Train(verb) => execute("classify train", &verb.common, |reporter| verb.run(reporter)),
        }
    }
}

/// Names as wide as the widest of them, at least as wide as `least`.
fn width<'a>(names: impl Iterator<Item = &'a str>, least: usize) -> usize {
    names.map(|name| name.chars().count()).fold(least, usize::max)
}
