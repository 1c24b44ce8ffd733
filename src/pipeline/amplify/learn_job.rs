//! The job behind `orograph learn --multires`.

use super::cell_size::CellSize;
use super::exemplar::cell_of;
use super::learned::LearnedSummary;
use super::teach::{Aim, Teaching};
use crate::error::{Error, Result};
use crate::io::output::Output;
use crate::watch::Watch;
use std::path::PathBuf;
use std::time::{Duration, Instant};

/// What to do.
#[derive(Clone, Debug)]
pub struct LearnJob {
    /// What is to be learned, and of what.
    pub teaching: Teaching,
    /// Metres from one column and from one row to the next of the cells that are to be made; those of the exemplar with
    /// the smallest unless given.
    pub cell_m: Option<[f64; 2]>,
    /// Where to write.
    pub output: PathBuf,
    /// Whether an existing output may be replaced.
    pub overwrite: bool,
    /// Bytes of memory that may be used; what is free unless given.
    pub memory: Option<u64>,
}

/// What was done.
#[derive(Clone, Debug)]
pub struct LearnReport {
    /// What is in the file.
    pub summary: LearnedSummary,
    /// How long it took.
    pub time: Duration,
}

/// Runs the job.
///
/// # Errors
/// Anything that is wrong with the exemplars, the output or the options; then no file has changed.
pub fn learn(job: &LearnJob, watch: &Watch, warn: &mut dyn FnMut(&str)) -> Result<LearnReport> {
    let begun = Instant::now();
    let teaching = &job.teaching;
    teaching.check()?;
    let output = Output::begin(&job.output, job.overwrite)?;
    let made = match job.cell_m {
        Some(cell_m) => CellSize::said(cell_m),
        None => finest(job, watch)?,
    };
    let aim = Aim { input: made.times(teaching.factor as f64), made, slope: None, memory: job.memory };
    let learned = teaching.learn(&aim, watch, warn)?;
    let bytes = learned.write(output)?;
    Ok(LearnReport { summary: learned.summary(bytes), time: begun.elapsed() })
}

/// The cells of the exemplar that has the smallest, the first of equals.
fn finest(job: &LearnJob, watch: &Watch) -> Result<CellSize> {
    let mut finest: Option<CellSize> = None;
    for path in &job.teaching.exemplars {
        let cell = cell_of(path, job.memory, watch)?;
        let area = |cell: CellSize| cell.across_m * cell.down_m;
        if finest.is_none_or(|finest| area(cell) < area(finest)) {
            finest = Some(cell);
        }
    }
    finest.ok_or_else(|| Error::usage("there is nothing to learn from"))
}
