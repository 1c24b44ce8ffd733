//! Prediction: which class the peaks of a disk, a region or a whole layer are like.

use super::super::stats::DiskWords;
use super::super::tags::TagLayer;
use super::disks::Laying;
use super::ranges::{LayerOptions, PeaksInput, Range};
use crate::classify::Model;
use crate::error::{Error, ErrorKind, Result};
use crate::io::text::read_text;
use crate::orometry::distributions::Selection;
use crate::watch::Watch;
use std::path::PathBuf;

/// What to do.
#[derive(Clone, Debug)]
pub struct PredictJob {
    /// The classifier.
    pub model: PathBuf,
    /// The layer of peaks.
    pub peaks: PathBuf,
    /// Name of the layer, where the file has several.
    pub layer: Option<String>,
    /// CRS of a layer that has none.
    pub crs: Option<String>,
    /// Polygons that are classified each by itself.
    pub regions: Option<TagLayer>,
    /// Centres of disks with the texts that they are called by.
    pub disks: Vec<(String, f64, f64)>,
}

/// What was found.
#[derive(Debug)]
pub struct PredictReport {
    /// The classifier.
    pub model: Model,
    /// One answer for each disk, each region, or the whole.
    pub answers: Vec<Answer>,
}

/// What one place is like.
#[derive(Clone, Debug, PartialEq)]
pub struct Answer {
    /// Name of the disk or region; `whole` for the whole layer.
    pub name: String,
    /// Number of disks that were looked at; none where no disk has enough peaks.
    pub disks: usize,
    /// Number of disks that are like each class.
    pub votes: Vec<usize>,
    /// The most probable class; `None` without a disk.
    pub class: Option<usize>,
    /// The probability of each class, the mean over the disks; empty without a disk.
    pub probabilities: Vec<f64>,
}

impl Answer {
    /// The answer of some disks, each a row of features.
    fn of(name: String, model: &Model, rows: &[Vec<f64>]) -> Self {
        let classes = model.classes.len();
        let (mut votes, mut sum) = (vec![0; classes], vec![0.0; classes]);
        for row in rows {
            let (class, probabilities) = model.tell(row);
            votes[class] += 1;
            sum.iter_mut().zip(probabilities).for_each(|(sum, probability)| *sum += probability);
        }
        if rows.is_empty() {
            return Self { name, disks: 0, votes, class: None, probabilities: vec![] };
        }
        let probabilities: Vec<f64> = sum.into_iter().map(|sum| sum / rows.len() as f64).collect();
        let class = (0..classes).fold(0, |best, i| if probabilities[i] > probabilities[best] { i } else { best });
        Self { name, disks: rows.len(), votes, class: Some(class), probabilities }
    }
}

/// Runs the job.
///
/// A region, and a whole layer, is looked at disk by disk, as the classifier was trained.
///
/// # Errors
/// Anything that is wrong with the classifier, the peaks or the options.
pub fn predict(job: &PredictJob, watch: &Watch, warn: &mut dyn FnMut(&str)) -> Result<PredictReport> {
    let mut note = |text: String| warn(&text);
    let text = read_text(&job.model)?;
    let model = Model::from_json(&text).map_err(|error| error.at_path(&job.model))?;
    let conditions = model.conditions;
    let options = LayerOptions {
        layer: job.layer.as_deref(),
        crs: job.crs.as_deref(),
        regions: job.regions.as_ref(),
        min_prominence_m: conditions.min_prominence_m,
    };
    let input = PeaksInput { class: None, path: job.peaks.clone() };
    let layer = options.read(&input, watch, &mut note)?;
    if layer.peaks.is_empty() {
        return Err(Error::new(ErrorKind::Input, "the layer holds no peaks").at_path(&job.peaks));
    }
    let laying = Laying { radius_m: conditions.disk_radius_m, min_peaks: conditions.min_peaks };
    let mut answers = vec![];
    for (name, x, y) in &job.disks {
        let words = DiskWords { name: name.clone(), x: *x, y: *y, radius_m: conditions.disk_radius_m };
        let disk: Selection = words.meant(layer.crs.as_ref())?;
        let rows: Vec<Vec<f64>> = laying.measure(&disk, &layer.peaks)?.map(|(_, row)| row).into_iter().collect();
        answers.push(Answer::of(name.clone(), &model, &rows));
    }
    let ranges: Vec<Range> = match (&job.regions, job.disks.is_empty()) {
        (Some(_), _) => layer.by_region(),
        (None, true) => vec![layer.whole("whole".into())],
        (None, false) => vec![],
    };
    watch.begin("laying disks", ranges.len() as u64);
    for range in &ranges {
        let rows: Vec<Vec<f64>> = laying.lay(range, 0, watch)?.into_iter().map(|disk| disk.row).collect();
        answers.push(Answer::of(range.name.clone(), &model, &rows));
        watch.advance(1)?;
    }
    let empty: Vec<&str> = answers.iter().filter(|answer| answer.disks == 0).map(|a| a.name.as_str()).collect();
    if !empty.is_empty() {
        note(format!(
            "without an answer, as no disk of {} m there has {} peaks: {}",
            conditions.disk_radius_m,
            conditions.min_peaks,
            empty.join(", ")
        ));
    }
    Ok(PredictReport { model, answers })
}
