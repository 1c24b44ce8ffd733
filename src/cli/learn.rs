//! `orograph learn`.

use super::container_text::size_text;
use super::progress::watched;
use super::report::Reporter;
use super::shared::{CommonOptions, MemoryOptions, OutputOptions, named_oro, unit_of};
use super::sparse::{PatchOptions, StoredInput};
use crate::error::{Error, Result};
use crate::pipeline::archive::Target;
use crate::pipeline::sparse::learn::{LearnJob, LearnReport, run};
use clap::Args;
use serde_json::{Value, json};
use std::path::PathBuf;

/// Learn a dictionary: landforms of which terrains are made, for encode --sparse --dictionary.
///
/// Patches of the exemplars are the examples; K-SVD finds atoms of which a few make up each of them. The file is an
/// .oro file as others, whose raster shows the atoms side by side.
#[derive(Args, Clone, Debug)]
#[command(after_help = "Example:\n  orograph learn fixtures/jacksboro.tif hills.oro --atoms 64")]
pub(super) struct Learn {
    /// Rasters to learn from, then the output: an .oro file.
    #[arg(value_name = "EXEMPLAR... OUT.oro", required = true, num_args = 2..)]
    files: Vec<PathBuf>,
    #[command(flatten)]
    patches: PatchOptions,
    /// Take atoms as they are found in the exemplars, instead of combinations of them.
    #[arg(long, help_heading = "Patches")]
    constrained: bool,
    #[command(flatten)]
    raster: StoredInput,
    #[command(flatten)]
    out: OutputOptions,
    #[command(flatten)]
    memory: MemoryOptions,
    #[command(flatten)]
    pub(super) common: CommonOptions,
}

impl Learn {
    pub(super) fn run(&self, reporter: &mut Reporter) -> Result<Value> {
        let Some((output, exemplars)) = self.files.split_last() else {
            return Err(Error::usage("rasters to learn from and an output are needed"));
        };
        exemplars.iter().for_each(|path| reporter.input(path));
        named_oro(output)?;
        let job = LearnJob {
            exemplars: exemplars.to_vec(),
            raster: self.raster.meant()?,
            unit: unit_of(self.raster.vertical_unit.as_deref())?,
            model: self.patches.meant(),
            constrained: self.constrained,
            memory: self.memory.bytes()?,
        };
        let report = watched(reporter, |watch, reporter| {
            let target = Target::File { path: output.clone(), overwrite: self.out.overwrite };
            run(&job, target, watch, &mut |text| reporter.warn(text))
        })?;
        reporter.outputs(std::slice::from_ref(output));
        reporter.say(&text(&report))?;
        Ok(json(&report))
    }
}

fn text(report: &LearnReport) -> String {
    format!(
        "{} atoms of {} x {} cells from {} patches: {:.2} % of their relief unexplained, {}, {:.1} s\n",
        report.atoms,
        report.side,
        report.side,
        report.patches,
        100.0 * report.unexplained.last().copied().unwrap_or(1.0),
        size_text(report.summary.bytes),
        report.time.as_secs_f64(),
    )
}

fn json(report: &LearnReport) -> Value {
    json!({
        "atoms": report.atoms,
        "patch": report.side,
        "patches": report.patches,
        "unexplained": report.unexplained,
        "bytes": report.summary.bytes,
        "seconds": report.time.as_secs_f64(),
    })
}
