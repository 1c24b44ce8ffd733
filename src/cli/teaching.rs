//! Words about what is learned to make terrain finer, which `amplify` and `learn --multires` share.

use super::container_text::size_text;
use crate::amplify::PatchModel;
use crate::error::{Error, Result};
use crate::pipeline::amplify::{self, LearnedSummary, Said};
use clap::{Args, ValueEnum};
use serde_json::{Value, json};
use std::time::Duration;

/// How many times finer cells become unless said.
pub(super) const USUAL_FACTOR: usize = 4;
/// The seed unless said.
pub(super) const USUAL_SEED: u64 = 1;

/// Words for [`amplify::Mode`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum Mode {
    /// The best estimate of the true heights.
    Accurate,
    /// One of the terrains that there may be, as rough as true ones.
    Realistic,
    /// Patches of the exemplars in place of the input's.
    Paper,
}

impl Mode {
    pub(super) fn meant(self) -> amplify::Mode {
        match self {
            Self::Accurate => amplify::Mode::Accurate,
            Self::Realistic => amplify::Mode::Realistic,
            Self::Paper => amplify::Mode::Paper,
        }
    }
}

/// What mode paper alone can be told.
#[derive(Args, Clone, Debug, Default)]
#[command(next_help_heading = "Mode paper")]
pub(super) struct PaperOptions {
    /// Side of a patch in cells of the input, 3 to 64: twice the radius R. The larger, the more of the exemplars' shape
    /// and the less of the input's [default: 8].
    #[arg(long, value_name = "CELLS")]
    pub(super) patch: Option<usize>,
    /// From one patch to the next in cells of the input; half a side unless given.
    #[arg(long, value_name = "CELLS")]
    pub(super) step: Option<usize>,
    /// Most atoms of a patch, 1 to 64 [default: 1].
    #[arg(long, value_name = "S")]
    pub(super) sparsity: Option<usize>,
    /// Learn so many patches of the exemplars and take these alone; all unless given.
    #[arg(long, value_name = "N")]
    pub(super) atoms: Option<usize>,
    #[command(flatten)]
    pub(super) pairs: PairOptions,
}

/// What pairs of coarse and fine patches alone can be told.
#[derive(Args, Clone, Debug, Default)]
#[command(next_help_heading = "Mode paper")]
pub(super) struct PairOptions {
    /// Turn no patch of the exemplars upside down.
    #[arg(long)]
    pub(super) unsigned: bool,
    /// Take at most so many patches of the exemplars for each step, 1 to 1048576; 120000 unless given, or 8192 with
    /// --atoms.
    #[arg(long, value_name = "N")]
    pub(super) patches: Option<usize>,
    /// Make the terrain finer by so much at a time; all at once unless given.
    #[arg(long, value_name = "N")]
    pub(super) by: Option<usize>,
}

impl PaperOptions {
    /// The options that were given.
    pub(super) fn said(&self) -> Vec<Said> {
        let number = |option, value: Option<usize>| value.map(|v| Said { option, value: Some(v.to_string()) });
        let PairOptions { unsigned, patches, by } = &self.pairs;
        [
            number("--patch", self.patch),
            number("--step", self.step),
            number("--sparsity", self.sparsity),
            unsigned.then_some(Said { option: "--unsigned", value: None }),
            number("--atoms", self.atoms),
            number("--patches", *patches),
            number("--by", *by),
        ]
        .into_iter()
        .flatten()
        .collect()
    }

    /// Refuses the options where another mode is meant.
    pub(super) fn only_in(&self, mode: Mode) -> Result<()> {
        match self.said().first() {
            Some(said) if mode != Mode::Paper => {
                Err(Error::usage(format!("{}: it is for --mode paper only", said.option)))
            }
            _ => Ok(()),
        }
    }

    /// What the options mean.
    pub(super) fn meant(&self) -> PatchModel {
        let usual = PatchModel::default();
        PatchModel {
            side: self.patch.unwrap_or(usual.side),
            step: self.step,
            sparsity: self.sparsity.unwrap_or(usual.sparsity),
            signed: !self.pairs.unsigned,
            atoms: self.atoms,
            patches: self.pairs.patches,
            by: self.pairs.by,
            seed: usual.seed,
        }
    }
}

/// What was learned, in words, and how long it took.
pub(super) fn learned_text(summary: &LearnedSummary, time: Option<Duration>) -> String {
    let steps: Vec<String> = summary.steps.iter().map(usize::to_string).collect();
    let mut text = format!(
        "mode {}, {} times finer in steps of {}: cells of {}, {}{}\n",
        summary.mode.name(),
        summary.factor,
        steps.join(", "),
        cell_text(summary.cell_m),
        size_text(summary.bytes),
        time.map_or(String::new(), |time| format!(", {:.1} s", time.as_secs_f64())),
    );
    if let Some(seed) = summary.seed {
        text += &format!("seed {seed}\n");
    }
    if summary.borrowed_steps > 0 {
        text +=
            &format!("too coarse for the exemplars: {} of the steps, taken from finer ones\n", summary.borrowed_steps);
    }
    if let Some(model) = &summary.model {
        let atoms: Vec<String> = summary.atoms.iter().map(usize::to_string).collect();
        text += &format!(
            "patches of {} x {} cells of the input, step by step: {}\n",
            model.side,
            model.side,
            atoms.join(", ")
        );
    }
    for exemplar in &summary.exemplars {
        let [rows, cols] = exemplar.size;
        let slope = exemplar
            .median_slope_deg
            .map_or(String::new(), |slope| format!(", half of it steeper than {slope:.1} degrees"));
        text +=
            &format!("exemplar {}: {cols} x {rows} cells of {}{slope}\n", exemplar.name, cell_text(exemplar.cell_m));
    }
    text
}

fn cell_text([across, down]: [f64; 2]) -> String {
    let [across, down] = [across, down].map(|m| (m * 100.0).round() / 100.0);
    format!("{across} x {down} m")
}

/// What was learned, for a JSON document.
pub(super) fn learned_json(summary: &LearnedSummary) -> Value {
    let cell = |[across, down]: [f64; 2]| json!({ "across": across, "down": down });
    let exemplars: Vec<Value> = summary
        .exemplars
        .iter()
        .map(|exemplar| {
            json!({
                "name": exemplar.name,
                "rows": exemplar.size[0],
                "cols": exemplar.size[1],
                "cell_m": cell(exemplar.cell_m),
                "median_slope_deg": exemplar.median_slope_deg,
            })
        })
        .collect();
    let patches = summary.model.as_ref().map(|model| {
        json!({
            "patch": model.side,
            "step": model.spacing().ok(),
            "sparsity": model.sparsity,
            "signed": model.signed,
            "learned": model.atoms,
            "most": model.patches,
            "atoms": summary.atoms,
        })
    });
    json!({
        "mode": summary.mode.name(),
        "factor": summary.factor,
        "steps": summary.steps,
        "borrowed_steps": summary.borrowed_steps,
        "cell_m": cell(summary.cell_m),
        "seed": summary.seed,
        "patches": patches,
        "exemplars": exemplars,
        "bytes": summary.bytes,
    })
}
