//! The files of the job: statistics, tables, charts.

use super::job::{DomainComparison, StatsJob};
use crate::error::{Error, ErrorKind, Result};
use crate::figures::{Subject, distributions_chart};
use crate::io::output::Output;
use crate::orometry::distributions::{BinSet, Domain, DomainKind, StatsDocument, csv};
use crate::plot::chart::{Drawing, png, svg};
use crate::watch::Watch;
use std::fmt::Write;
use std::path::{Path, PathBuf};

/// The outputs that will all be there, or none.
pub(super) struct Outputs(Vec<(Kind, Output)>);

/// What an extension stands for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    /// The statistics file.
    Json,
    /// The histograms as a table, or the distances of two inputs.
    Csv,
    /// The chart as vectors.
    Svg,
    /// The chart as pixels.
    Png,
}

/// Pixels of a chart's PNG for each unit of the drawing.
const PNG_SCALE: f64 = 2.0;

/// Most domains that a chart can tell apart.
const MOST_SUBJECTS: usize = 4;

impl Outputs {
    /// Prepares the outputs of a job.
    ///
    /// # Errors
    /// A usage error for extensions that mean nothing here; outputs that exist already or cannot be written.
    pub(super) fn begin(job: &StatsJob) -> Result<Self> {
        let mut outputs: Vec<(Kind, Output)> = Vec::new();
        for path in &job.outputs {
            let kind = kind_of(path)?;
            if kind == Kind::Json && job.inputs.len() > 1 {
                return Err(Error::usage(
                    "a statistics file is of one input: write one for each alone; distances are in the .csv and in --json",
                )
                .at_path(path));
            }
            if outputs.iter().any(|(_, output)| output.target() == path) {
                return Err(Error::usage("the output is named twice").at_path(path));
            }
            outputs.push((kind, Output::begin(path, job.overwrite)?));
        }
        Ok(Self(outputs))
    }

    /// Writes them all.
    ///
    /// # Errors
    /// When one cannot be written, or the job was interrupted; then none is there.
    pub(super) fn write(
        self,
        job: &StatsJob,
        documents: &[StatsDocument],
        comparisons: &[DomainComparison],
        watch: &Watch,
    ) -> Result<Vec<PathBuf>> {
        let is_chart = |kind: &Kind| matches!(kind, Kind::Svg | Kind::Png);
        let drawing = self.0.iter().any(|(kind, _)| is_chart(kind)).then(|| draw(job, documents)).transpose()?;
        for (kind, output) in &self.0 {
            let bytes = match (kind, &drawing, documents) {
                (Kind::Svg, Some(drawing), _) => svg(drawing).into_bytes(),
                (Kind::Png, Some(drawing), _) => png(drawing, PNG_SCALE)?,
                (Kind::Csv, _, [_, _]) => distances(comparisons, job.bins).into_bytes(),
                (Kind::Csv, ..) => csv(&documents[0]).into_bytes(),
                _ => documents[0].to_json().into_bytes(),
            };
            std::fs::write(output.path(), bytes).map_err(|error| {
                Error::new(ErrorKind::Output, format!("it cannot be written: {error}")).at_path(output.target())
            })?;
        }
        watch.check()?;
        let targets = self.0.iter().map(|(_, output)| output.target().to_path_buf()).collect();
        self.0.into_iter().try_for_each(|(_, output)| output.finish())?;
        Ok(targets)
    }
}

fn kind_of(path: &Path) -> Result<Kind> {
    let extension = path.extension().map(|e| e.to_string_lossy().to_ascii_lowercase()).unwrap_or_default();
    match extension.as_str() {
        "json" => Ok(Kind::Json),
        "csv" => Ok(Kind::Csv),
        "svg" => Ok(Kind::Svg),
        "png" => Ok(Kind::Png),
        _ => Err(Error::usage(format!(
            "the extension '{extension}' stands for nothing that is written here: expected .json (statistics), .csv (table), .svg or .png (chart)"
        ))
        .at_path(path)),
    }
}

/// The chart of the job's domains.
fn draw(job: &StatsJob, documents: &[StatsDocument]) -> Result<Drawing> {
    let names: Vec<Option<&str>> = job.domains.iter().map(|name| Some(name.as_str())).collect();
    let chosen: Vec<(&StatsDocument, Option<&str>)> = match (documents, &names[..]) {
        ([only], []) => only.domains.iter().take(MOST_SUBJECTS).map(|d| (only, Some(d.name.as_str()))).collect(),
        ([only], names) => names.iter().map(|name| (only, *name)).collect(),
        (several, []) => several.iter().map(|document| (document, None)).collect(),
        (several, names) => several.iter().zip(names.iter().cycle()).map(|(d, name)| (d, *name)).collect(),
    };
    if chosen.len() > MOST_SUBJECTS {
        return Err(Error::usage(format!("--domain: a chart shows at most {MOST_SUBJECTS} domains")));
    }
    let same_name = matches!(documents, [a, b] if stem(a) == stem(b));
    let called = chosen
        .iter()
        .map(|(document, name)| {
            let input = if same_name { document.input.path.clone() } else { stem(document) };
            Ok(called(&input, document.domain(*name)?, documents.len() > 1))
        })
        .collect::<Result<Vec<String>>>()?;
    let subjects: Vec<Subject<'_>> = chosen
        .iter()
        .zip(&called)
        .map(|((document, domain), name)| Subject { name, document, domain: *domain })
        .collect();
    Ok(distributions_chart("", &subjects, job.bins)?.draw())
}

/// The name of a document's input without folder and extension.
fn stem(document: &StatsDocument) -> String {
    let path = &document.input.path;
    Path::new(path).file_stem().map_or_else(|| path.clone(), |stem| stem.to_string_lossy().into())
}

/// What a legend calls a domain: the input for its whole, the domain's own name otherwise.
fn called(input: &str, domain: &Domain, several: bool) -> String {
    match (domain.kind, several) {
        (DomainKind::Whole, _) => input.to_string(),
        (_, true) => format!("{input}: {}", domain.name),
        (_, false) => domain.name.clone(),
    }
}

/// Distances as CSV: one row for each pair of domains and metric.
fn distances(comparisons: &[DomainComparison], set: BinSet) -> String {
    let quoted = |text: &str| {
        let must = text.contains([',', '"', '\n', '\r']);
        if must { format!("\"{}\"", text.replace('"', "\"\"")) } else { text.to_string() }
    };
    let number = |value: Option<f64>| value.map_or(String::new(), |value| value.to_string());
    let mut text = "domain_1,domain_2,bin_set,metric,emd,emd_unit,largest_bin_difference,total_variation\n".to_string();
    for pair in comparisons {
        for metric in &pair.metrics {
            writeln!(
                text,
                "{},{},{},{},{},{},{},{}",
                quoted(&pair.first),
                quoted(&pair.second),
                set.name(),
                metric.metric,
                number(metric.emd),
                metric.emd_unit,
                number(metric.largest_bin_difference),
                number(metric.total_variation)
            )
            .expect("a String takes all");
        }
    }
    text
}
