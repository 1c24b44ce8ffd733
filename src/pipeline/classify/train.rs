//! Training: from ranges of known classes to a classifier, and how good it is.

use super::super::tags::TagLayer;
use super::disks::{DiskRow, Laying};
use super::ranges::{LayerOptions, PeaksInput, Range, ReadLayer};
use super::table::csv;
use crate::classify::{Apart, ClassRecord, Conditions, Confusion, Forest, ForestOptions, Model, Part, Samples, Spot};
use crate::error::{Error, ErrorKind, Result};
use crate::io::output::Output;
use crate::watch::Watch;
use std::path::PathBuf;

/// What to do.
#[derive(Clone, Debug)]
pub struct TrainJob {
    /// The layers of peaks.
    pub peaks: Vec<PeaksInput>,
    /// Name of the layer, where files have several.
    pub layer: Option<String>,
    /// CRS of layers that have none.
    pub crs: Option<String>,
    /// Polygons that are the classes of peaks in layers without a class.
    pub regions: Option<TagLayer>,
    /// Radius of the disks in metres.
    pub disk_radius_m: f64,
    /// Fewest peaks of a disk.
    pub min_peaks: usize,
    /// Least prominence in metres of the peaks that count; the greatest of those that the layers know unless given.
    pub min_prominence_m: Option<f64>,
    /// How the forest is grown.
    pub forest: ForestOptions,
    /// Where to write the classifier.
    pub output: PathBuf,
    /// Where to write the disks as a table.
    pub disks: Option<PathBuf>,
    /// Whether existing outputs may be replaced.
    pub overwrite: bool,
}

/// What was done.
#[derive(Debug)]
pub struct TrainReport {
    /// The classifier.
    pub model: Model,
    /// What was taken for what in the parts that were held out, over all cuts; empty where nothing could be held out.
    pub held_out: Confusion,
    /// Cuts that were made.
    pub cuts: usize,
    /// What was taken for what by the trees that had not seen a disk.
    pub out_of_bag: Confusion,
    /// The files written.
    pub outputs: Vec<PathBuf>,
}

/// One of so many disks is held out in a cut, as in the paper.
const ONE_OF: usize = 5;

/// Runs the job.
///
/// # Errors
/// Anything that is wrong with the inputs, the outputs or the options; a class without disks; fewer than two classes.
pub fn train(job: &TrainJob, watch: &Watch, warn: &mut dyn FnMut(&str)) -> Result<TrainReport> {
    let mut note = |text: String| warn(&text);
    let output = Output::begin(&job.output, job.overwrite)?;
    if job.disks.as_ref() == Some(&job.output) {
        return Err(Error::usage("the output is named twice").at_path(&job.output));
    }
    let disks_output = job.disks.as_ref().map(|path| Output::begin(path, job.overwrite)).transpose()?;
    let (ranges, threshold_m) = ranges(job, watch, &mut note)?;
    let mut classes: Vec<String> = vec![];
    for range in &ranges {
        if !classes.contains(&range.name) {
            classes.push(range.name.clone());
        }
    }
    if classes.len() < 2 {
        let found = classes.first().map_or("none".into(), |name| format!("only '{name}'"));
        return Err(Error::usage(format!(
            "a classifier tells at least two classes apart, and there is {found}: give --peaks NAME=FILE for each, or \
             --regions"
        )));
    }
    watch.begin("laying disks", ranges.len() as u64);
    let laying = Laying { radius_m: job.disk_radius_m, min_peaks: job.min_peaks };
    let mut disks: Vec<(DiskRow, u32)> = vec![];
    for (number, range) in ranges.iter().enumerate() {
        let class = classes.iter().position(|name| *name == range.name).unwrap_or(0);
        #[allow(clippy::cast_possible_truncation, reason = "classes are few")]
        disks.extend(laying.lay(range, number, watch)?.into_iter().map(|disk| (disk, class as u32)));
        watch.advance(1)?;
    }
    let records = records(&classes, &disks, job)?;
    let rows: Vec<(Vec<f64>, u32)> = disks.iter().map(|(disk, class)| (disk.row.clone(), *class)).collect();
    let spots: Vec<Spot> = disks.iter().map(|(disk, _)| disk.spot).collect();
    let apart = Apart { radius_m: job.disk_radius_m, one_of: ONE_OF };
    let parts: Vec<Vec<Part>> = Apart::DIRECTIONS.iter().map(|&direction| apart.parts(&spots, direction)).collect();
    watch.begin("growing trees", (job.forest.trees * (1 + parts.len())) as u64);
    let (held_out, cuts) = hold_out(&rows, &parts, classes.len(), job, watch)?;
    if cuts < parts.len() {
        note(format!(
            "{} of {} cuts leave a class without a disk to learn from or to be tested; give wider ranges, or a smaller \
             --disk-radius, to know more surely how good the classifier is",
            parts.len() - cuts,
            parts.len()
        ));
    }
    let grown = Forest::grow(&Samples::new(&rows, classes.len())?, &job.forest, watch)?;
    let mut out_of_bag = Confusion::new(classes.len());
    for (told, (_, label)) in grown.out_of_bag.iter().zip(&rows) {
        told.iter().for_each(|&told| out_of_bag.add(*label as usize, told));
    }
    let conditions =
        Conditions { disk_radius_m: job.disk_radius_m, min_peaks: job.min_peaks, min_prominence_m: threshold_m };
    let model = Model::new(conditions, records, grown.forest);
    let mut written = vec![(output, model.to_json())];
    written.extend(disks_output.map(|output| (output, csv(&classes, &disks, &parts))));
    for (output, text) in &written {
        std::fs::write(output.path(), text).map_err(|error| {
            Error::new(ErrorKind::Output, format!("it cannot be written: {error}")).at_path(output.target())
        })?;
    }
    watch.check()?;
    let outputs = written.iter().map(|(output, _)| output.target().to_path_buf()).collect();
    written.into_iter().try_for_each(|(output, _)| output.finish())?;
    Ok(TrainReport { model, held_out, cuts, out_of_bag, outputs })
}

/// The ranges of all classes, and the least prominence of their peaks.
fn ranges(job: &TrainJob, watch: &Watch, note: &mut dyn FnMut(String)) -> Result<(Vec<Range>, Option<f64>)> {
    if job.regions.is_some() && job.peaks.iter().all(|input| input.class.is_some()) {
        return Err(Error::usage("--regions: its polygons are the classes, so give --peaks without a name"));
    }
    let mut layers: Vec<(&PeaksInput, ReadLayer)> = vec![];
    for input in &job.peaks {
        let options = LayerOptions {
            layer: job.layer.as_deref(),
            crs: job.crs.as_deref(),
            regions: if input.class.is_none() { job.regions.as_ref() } else { None },
            min_prominence_m: job.min_prominence_m,
        };
        layers.push((input, options.read(input, watch, note)?));
    }
    // Layers are alike only above the greatest of their thresholds.
    let known = layers.iter().filter_map(|(_, layer)| layer.threshold_m);
    let threshold_m = known.reduce(f64::max);
    let mut ranges = vec![];
    for (input, mut layer) in layers {
        layer.peaks.retain(|peak| threshold_m.is_none_or(|least_m| peak.prominence_m >= least_m));
        match &input.class {
            Some(class) => ranges.push(layer.whole(class.clone())),
            None if layer.regions.is_empty() => {
                let message = "its peaks stand in no regions: give it a class as NAME=FILE, or --regions";
                return Err(Error::new(ErrorKind::Input, message).at_path(&input.path));
            }
            None => ranges.extend(layer.by_region()),
        }
    }
    Ok((ranges, threshold_m))
}

/// What is said of each class.
fn records(classes: &[String], disks: &[(DiskRow, u32)], job: &TrainJob) -> Result<Vec<ClassRecord>> {
    let count = |class: usize| disks.iter().filter(|(_, of)| *of as usize == class).count();
    let records: Vec<ClassRecord> =
        classes.iter().enumerate().map(|(i, name)| ClassRecord { name: name.clone(), disks: count(i) }).collect();
    match records.iter().find(|record| record.disks == 0) {
        None => Ok(records),
        Some(record) => Err(Error::new(
            ErrorKind::Input,
            format!(
                "the class '{}' has no disk of {} m with {} peaks: give more peaks, a greater --disk-radius or fewer \
                 --min-peaks",
                record.name, job.disk_radius_m, job.min_peaks
            ),
        )),
    }
}

/// Grows a forest for each cut on what is to be learned from, and tests it on what was held out; also tells how many
/// cuts left every class something of both.
fn hold_out(
    rows: &[(Vec<f64>, u32)],
    parts: &[Vec<Part>],
    classes: usize,
    job: &TrainJob,
    watch: &Watch,
) -> Result<(Confusion, usize)> {
    let mut table = Confusion::new(classes);
    let mut cuts = 0;
    for parts in parts {
        let of = |part: Part| rows.iter().zip(parts).filter(move |(_, p)| **p == part).map(|(row, _)| row);
        let has_all = |part: Part| (0..classes).all(|class| of(part).any(|(_, label)| *label as usize == class));
        if !(has_all(Part::Learn) && has_all(Part::Test)) {
            continue;
        }
        let learned: Vec<(Vec<f64>, u32)> = of(Part::Learn).cloned().collect();
        let forest = Forest::grow(&Samples::new(&learned, classes)?, &job.forest, watch)?.forest;
        of(Part::Test).for_each(|(row, label)| table.add(*label as usize, forest.class(row, classes)));
        cuts += 1;
    }
    Ok((table, cuts))
}
