//! `orograph learn`.

use super::container_text::size_text;
use super::progress::watched;
use super::report::Reporter;
use super::shared::{CommonOptions, MemoryOptions, OutputOptions, named_learned, named_oro, unit_of};
use super::sparse::{PatchOptions, StoredInput};
use super::teaching::{Mode, PairOptions, PaperOptions, USUAL_FACTOR, USUAL_SEED, learned_json, learned_text};
use super::wrong_value;
use crate::error::{Error, Result};
use crate::pipeline::amplify::{self, Teaching};
use crate::pipeline::archive::Target;
use crate::pipeline::sparse::learn::{LearnJob, LearnReport, run};
use crate::units::parse_length_m;
use clap::Args;
use serde_json::{Value, json};
use std::path::{Path, PathBuf};

/// Learn a dictionary for encode --sparse, or with --multires what amplify learns.
///
/// A dictionary holds landforms of which terrains are made. Patches of the exemplars are the examples; K-SVD finds atoms of
/// which a few make up each of them. The file is an .oro file as others, whose raster shows the atoms side by side.
///
/// With --multires the exemplars are seen with cells of two sizes, and what is learned is what small forms are like above
/// large ones: amplify --learned makes terrain finer with it, again and again, and gives the same as with --exemplar and
/// the same options.
#[derive(Args, Clone, Debug)]
#[command(after_help = "Examples:\n  orograph learn fixtures/jacksboro.tif hills.oro --atoms 64\n  \
                        orograph learn --multires fixtures/jacksboro.tif hills.learned --factor 2\n  \
                        orograph learn --multires fixtures/jacksboro.tif some.learned --mode paper --cell 75m,93m")]
pub(super) struct Learn {
    /// Rasters to learn from, then the output: an .oro file, or with --multires a .learned file.
    #[arg(value_name = "EXEMPLAR... OUT", required = true, num_args = 2..)]
    files: Vec<PathBuf>,
    #[command(flatten)]
    patches: PatchOptions,
    /// Take atoms as they are found in the exemplars, instead of combinations of them.
    #[arg(long, help_heading = "Patches")]
    constrained: bool,
    #[command(flatten)]
    multires: MultiresOptions,
    #[command(flatten)]
    raster: StoredInput,
    #[command(flatten)]
    out: OutputOptions,
    #[command(flatten)]
    memory: MemoryOptions,
    #[command(flatten)]
    pub(super) common: CommonOptions,
}

/// What learning for `amplify` can be told.
#[derive(Args, Clone, Debug)]
#[command(next_help_heading = "Finer terrain")]
struct MultiresOptions {
    /// Learn what amplify --learned takes. Of the options of patches --atoms, --sparsity, --patch and --step are then for
    /// --mode paper, with what amplify takes unless given.
    #[arg(long)]
    multires: bool,
    /// How many times finer the cells of an input become: 2 to 256, a product of 2, 3, 5 and 7 unless in mode paper
    /// [default: 4].
    #[arg(long, value_name = "N", requires = "multires")]
    factor: Option<usize>,
    /// What the result is to be [default: accurate].
    #[arg(long, value_enum, requires = "multires")]
    mode: Option<Mode>,
    /// Size of the cells that are to be made, or their width and height: 10m, or 7.1m,10.2m. That of the exemplars' cells,
    /// the finest of them, unless given.
    #[arg(long, value_name = "LENGTH[,LENGTH]", requires = "multires")]
    cell: Option<String>,
    #[command(flatten)]
    pairs: PairOptions,
}

impl MultiresOptions {
    /// Metres from one column and one row to the next.
    fn cell_m(&self) -> Result<Option<[f64; 2]>> {
        let Some(text) = &self.cell else { return Ok(None) };
        let (across, down) = text.split_once(',').unwrap_or((text, text));
        let side = |text: &str| match parse_length_m(text).map_err(|error| wrong_value("--cell", &error))? {
            side if (side as f32).is_normal() && side > 0.0 => Ok(side),
            _ => Err(Error::usage(format!("--cell {text}: expected a length above 0"))),
        };
        Ok(Some([side(across)?, side(down)?]))
    }
}

impl Learn {
    pub(super) fn run(&self, reporter: &mut Reporter) -> Result<Value> {
        let Some((output, exemplars)) = self.files.split_last() else {
            return Err(Error::usage("rasters to learn from and an output are needed"));
        };
        exemplars.iter().for_each(|path| reporter.input(path));
        match self.multires.multires {
            true => self.learn_pairs(exemplars, output, reporter),
            false => self.learn_dictionary(exemplars, output, reporter),
        }
    }

    fn learn_dictionary(&self, exemplars: &[PathBuf], output: &Path, reporter: &mut Reporter) -> Result<Value> {
        named_oro(output)?;
        let paper = PaperOptions { pairs: self.multires.pairs.clone(), ..PaperOptions::default() };
        if let Some(said) = paper.said().first() {
            return Err(Error::usage(format!("{}: it is for --multires --mode paper only", said.option)));
        }
        let job = LearnJob {
            exemplars: exemplars.to_vec(),
            raster: self.raster.meant()?,
            unit: unit_of(self.raster.vertical_unit.as_deref())?,
            model: self.patches.meant(),
            constrained: self.constrained,
            memory: self.memory.bytes()?,
        };
        let report = watched(reporter, |watch, reporter| {
            let target = Target::File { path: output.to_path_buf(), overwrite: self.out.overwrite };
            run(&job, target, watch, &mut |text| reporter.warn(text))
        })?;
        reporter.outputs(&[output.to_path_buf()]);
        reporter.say(&text(&report))?;
        Ok(json(&report))
    }

    fn learn_pairs(&self, exemplars: &[PathBuf], output: &Path, reporter: &mut Reporter) -> Result<Value> {
        named_learned(output)?;
        let job = amplify::LearnJob {
            teaching: self.teaching(exemplars)?,
            cell_m: self.multires.cell_m()?,
            output: output.to_path_buf(),
            overwrite: self.out.overwrite,
            memory: self.memory.bytes()?,
        };
        let report = watched(reporter, |watch, reporter| amplify::learn(&job, watch, &mut |text| reporter.warn(text)))?;
        reporter.outputs(&[output.to_path_buf()]);
        reporter.say(&learned_text(&report.summary, Some(report.time)))?;
        let mut result = learned_json(&report.summary);
        result["seconds"] = json!(report.time.as_secs_f64());
        Ok(result)
    }

    /// What is to be learned for `amplify`; options of dictionaries are refused.
    fn teaching(&self, exemplars: &[PathBuf]) -> Result<Teaching> {
        let other = [("--iterations", self.patches.iterations.is_some()), ("--constrained", self.constrained)];
        let other = other.iter().find(|(_, said)| *said).map(|(option, _)| *option);
        if let Some(option) = other.or_else(|| self.raster.first_said()) {
            return Err(Error::usage(format!("{option}: it is for dictionaries, and --multires learns none")));
        }
        let mode = self.multires.mode.unwrap_or(Mode::Accurate);
        let PatchOptions { atoms, sparsity, patch, step, iterations: _, seed } = self.patches;
        let pairs = self.multires.pairs.clone();
        let paper = PaperOptions { patch, step, sparsity: sparsity.map(usize::from), atoms, pairs };
        paper.only_in(mode)?;
        if mode == Mode::Realistic && seed.is_some() {
            let message = "--seed: nothing is drawn while --mode realistic learns; give it to amplify";
            return Err(Error::usage(message));
        }
        Ok(Teaching {
            exemplars: exemplars.to_vec(),
            factor: self.multires.factor.unwrap_or(USUAL_FACTOR),
            mode: mode.meant(),
            model: paper.meant(),
            seed: seed.unwrap_or(USUAL_SEED),
        })
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
