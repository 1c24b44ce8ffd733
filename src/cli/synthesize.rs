//! `orograph synthesize`.

use super::progress::watched;
use super::report::Reporter;
use super::shared::{CommonOptions, MemoryOptions, OutputOptions, four, list};
use super::terrain_shape::{ShapeOptions, resolution_m};
use super::wrong_value;
use crate::error::{Error, Result};
use crate::orometry::distributions::Comparison;
use crate::pipeline::synthesize::{KeepPart, SynthesizeJob, SynthesizeReport, TerrainPart, run};
use crate::pipeline::terrain::is_raster;
use crate::synthesis::SynthesisOptions;
use crate::units::parse_length_m;
use clap::Args;
use serde_json::{Value, json};
use std::path::PathBuf;

/// Make mountains like those of a real range: peaks, key saddles and a divide tree with its statistics, and terrain.
///
/// A range is a DEM, which is measured first, a layer of peaks that `orograph peaks` wrote, or statistics that
/// `orograph stats` wrote and anybody may edit. Its elevations, prominences, dominances and isolations are repeated, bin
/// by bin, on any land, by other peaks in other places. Isolations are those to the nearest higher peak; a statistics
/// file has those to higher ground, which are somewhat shorter. The terrain has the peaks and key saddles of the tree;
/// where the range is a DEM it is about as steep, and with --ground-map as high in the mean as that says. --tree writes
/// the layers that `orograph peaks` writes, styled for QGIS. --keep leaves the peaks and ridges of a real tree, or of a few
/// that somebody drew, as they are and makes the rest up around them; the statistics told are then those of the new peaks.
/// Lengths take a unit (30m, 100ft, 1.5km); a bare number is metres.
#[derive(Args, Clone, Debug)]
#[command(after_help = "Examples:\n  \
    orograph synthesize new.tif --tree new.gpkg --like fixtures/jacksboro.tif --resolution 100m\n  \
    orograph synthesize tree.gpkg --tree-only --like fixtures/jacksboro.tif --seed 1\n  \
    orograph peaks fixtures/jacksboro.tif real.gpkg\n  \
    orograph synthesize around.tif --like fixtures/jacksboro.tif --keep real.gpkg --resolution 90m\n  \
    orograph synthesize more.gpkg --tree-only --like tree.gpkg --peaks 300 --seed 2")]
pub(super) struct Synthesize {
    /// Output: terrain in any raster format that GDAL writes; with --tree-only .gpkg, .csv, .geojson or .fgb.
    #[arg(value_name = "OUT")]
    output: PathBuf,
    /// The range to be like: DEM, layer of peaks or statistics file; several with --type-map.
    #[arg(long, value_name = "RANGE", required = true)]
    like: Vec<PathBuf>,
    /// Make the divide tree alone.
    #[arg(long, conflicts_with = "tree")]
    tree_only: bool,
    /// Write the divide tree, too: .gpkg, .csv, .geojson or .fgb.
    #[arg(long, value_name = "TREE")]
    tree: Option<PathBuf>,
    /// The land to fill, in units of --crs; that of the first range unless given.
    #[arg(long, value_name = "XMIN,YMIN,XMAX,YMAX", value_delimiter = ',', num_args = 1, allow_hyphen_values = true)]
    bbox: Option<Vec<f64>>,
    /// CRS of the land: EPSG:2056, WKT, a PROJ string; that of the first range unless given.
    #[arg(long, value_name = "CRS")]
    crs: Option<String>,
    /// Side of the land's cells, on which peaks and saddles stand.
    #[arg(long, value_name = "LENGTH", default_value = "30m", allow_hyphen_values = true)]
    resolution: String,
    /// Number of peaks, kept ones among them; by the density of the range unless given.
    #[arg(long, value_name = "N")]
    peaks: Option<usize>,
    /// Equal seeds make equal mountains.
    #[arg(long, value_name = "N", default_value_t = 0)]
    seed: u64,
    /// Raster of how many peaks there are beside other places, over all of the land; none where it is 0 or void.
    #[arg(long, value_name = "RASTER")]
    density_map: Option<PathBuf>,
    /// Raster of how high the land is beside other places, over all of the land, in any unit.
    #[arg(long, value_name = "RASTER")]
    elevation_map: Option<PathBuf>,
    /// Raster of which range the land is like, over all of it: 1 for the first --like, 2 for the second ...
    #[arg(long, value_name = "RASTER")]
    type_map: Option<PathBuf>,
    /// Peaks and ridges that stay as they are: layers of `orograph peaks`, edited or not, or the text of a divide tree.
    #[arg(long, value_name = "TREE")]
    keep: Option<PathBuf>,
    /// Keep the part of the tree in these polygons, where no new peaks stand: any vector layer that GDAL reads.
    #[arg(long, value_name = "POLYGONS", requires = "keep")]
    keep_within: Option<PathBuf>,
    /// How much more a ridge between high peaks is liked than a short one (rho of the paper's equation 1).
    #[arg(long, value_name = "0|1|2", value_parser = clap::value_parser!(u8).range(0..=2), default_value_t = 1)]
    ridge_exponent: u8,
    /// Least prominence of the range's peaks: 30m for a DEM unless given, for a layer that of its peaks.
    #[arg(long, value_name = "LENGTH", allow_hyphen_values = true)]
    min_prominence: Option<String>,
    /// Layer of the range's peaks, where a file has several.
    #[arg(long, value_name = "LAYER")]
    layer: Option<String>,
    /// Region or disk of a statistics file; its first domain unless given.
    #[arg(long, value_name = "NAME")]
    domain: Option<String>,
    #[command(flatten)]
    shape: ShapeOptions,
    #[command(flatten)]
    out: OutputOptions,
    #[command(flatten)]
    memory: MemoryOptions,
    #[command(flatten)]
    pub(super) common: CommonOptions,
}

impl Synthesize {
    fn meant(&self) -> Result<SynthesizeJob> {
        if self.tree_only && self.shape.is_given() {
            return Err(Error::usage("--tree-only makes no terrain: leave out the options of terrain"));
        }
        if !self.tree_only && !is_raster(&self.output) {
            return Err(Error::usage(format!(
                "{} is no raster: give a .tif for terrain, or --tree-only for the divide tree alone",
                self.output.display()
            )));
        }
        let resolution_m = resolution_m(&self.resolution)?;
        let prominence_m = |text| parse_length_m(text).map_err(|error| wrong_value("--min-prominence", &error));
        let min_prominence_m = self.min_prominence.as_deref().map(prominence_m).transpose()?;
        if min_prominence_m.is_some_and(|m| m < 0.0) {
            return Err(Error::usage("--min-prominence: expected 0 or more"));
        }
        Ok(SynthesizeJob {
            like: self.like.clone(),
            layer: self.layer.clone(),
            domain: self.domain.clone(),
            min_prominence_m,
            tree: if self.tree_only { Some(self.output.clone()) } else { self.tree.clone() },
            overwrite: self.out.overwrite,
            terrain: if self.tree_only { None } else { Some(self.terrain()?) },
            bbox: four("--bbox", self.bbox.as_deref())?,
            crs: self.crs.clone(),
            resolution_m,
            peaks: self.peaks,
            density_map: self.density_map.clone(),
            elevation_map: self.elevation_map.clone(),
            type_map: self.type_map.clone(),
            keep: self.keep.clone().map(|tree| KeepPart { tree, within: self.keep_within.clone() }),
            options: SynthesisOptions { seed: self.seed, ridge_exponent: self.ridge_exponent },
            memory: self.memory.bytes()?,
            command: self.words().join(" "),
        })
    }

    fn terrain(&self) -> Result<TerrainPart> {
        Ok(TerrainPart {
            output: self.shape.output(&self.output, self.out.overwrite)?,
            shape: self.shape.shape(self.seed)?,
        })
    }

    /// The command without what changes no result.
    fn words(&self) -> Vec<String> {
        let mut words = vec!["orograph".into(), "synthesize".into()];
        if self.tree_only {
            words.push("--tree-only".into());
        }
        let mut put = |option: &str, value: Option<String>| {
            words.extend(value.into_iter().flat_map(|value| [option.to_string(), value]));
        };
        let path = |path: &Option<PathBuf>| path.as_ref().map(|path| path.display().to_string());
        self.like.iter().for_each(|like| put("--like", Some(like.display().to_string())));
        put("--layer", self.layer.clone());
        put("--domain", self.domain.clone());
        put("--min-prominence", self.min_prominence.clone());
        put("--bbox", self.bbox.as_deref().map(list));
        put("--crs", self.crs.clone());
        put("--resolution", Some(self.resolution.clone()));
        put("--peaks", self.peaks.map(|peaks| peaks.to_string()));
        put("--density-map", path(&self.density_map));
        put("--elevation-map", path(&self.elevation_map));
        put("--type-map", path(&self.type_map));
        put("--keep", path(&self.keep));
        put("--keep-within", path(&self.keep_within));
        put("--ridge-exponent", Some(self.ridge_exponent.to_string()));
        put("--seed", Some(self.seed.to_string()));
        if !self.tree_only {
            words.extend(self.shape.words());
        }
        words
    }

    pub(super) fn run(&self, reporter: &mut Reporter) -> Result<Value> {
        self.like.iter().chain(&self.keep).chain(&self.keep_within).for_each(|input| reporter.input(input));
        let job = self.meant()?;
        let report = watched(reporter, |watch, reporter| run(&job, watch, &mut |text| reporter.warn(text)))?;
        reporter.outputs(&report.outputs);
        let [measured, tree, terrain, written] = report.times.map(|time| time.as_secs_f64());
        reporter.remark(&format!(
            "measured {measured:.3} s, tree {tree:.3} s, terrain {terrain:.3} s, written {written:.3} s"
        ));
        if !reporter.is_json() {
            reporter.say(&text(&report))?;
        }
        Ok(json(&report))
    }
}

/// The metrics that are repeated on purpose, with the names that people know them by.
const REPEATED: [(&str, &str); 5] = [
    ("prominence", "prominence"),
    ("dominance", "dominance"),
    ("elevation", "elevation"),
    ("isolation_distance", "isolation"),
    ("isolation_direction", "direction"),
];

fn text(report: &SynthesizeReport) -> String {
    use std::fmt::Write;
    let mut text = String::new();
    // Writing to a String cannot fail.
    let _ = writeln!(
        text,
        "{} peaks and {} saddles on {:.0} km² ({} x {} cells)",
        report.survey.peaks.len(),
        report.survey.edges.len(),
        report.area_km2,
        report.size.1,
        report.size.0
    );
    if report.kept_peaks > 0 {
        let altered = match report.altered {
            0 => String::new(),
            1 => "; one of the peaks has another prominence among the new ones".into(),
            count => format!("; {count} of the peaks have another prominence among the new ones"),
        };
        let _ =
            writeln!(text, "of these {} peaks and {} ridges are kept{altered}", report.kept_peaks, report.kept_ridges);
    }
    for range in &report.ranges {
        let _ = writeln!(
            text,
            "like {}: {} {}peaks for its {}; largest difference of a bin, and total variation:",
            range.path.display(),
            range.peaks,
            if report.kept_peaks > 0 { "new " } else { "" },
            range.like_peaks
        );
        for (metric, name) in REPEATED {
            let found = range.comparisons.iter().find(|comparison| comparison.metric == metric);
            let percent = |value: Option<f64>| value.map_or("-".into(), |value| format!("{:.2} %", value * 100.0));
            let of = |value: fn(&Comparison) -> Option<f64>| percent(found.and_then(value));
            let _ = writeln!(
                text,
                "  {name:<12} {:>8} {:>8}",
                of(|comparison| comparison.largest_bin_difference),
                of(|comparison| comparison.total_variation)
            );
        }
    }
    text
}

fn json(report: &SynthesizeReport) -> Value {
    let [measured, tree, terrain, written] = report.times.map(|time| time.as_secs_f64());
    let forms = report.raised.as_ref().map_or(&[][..], |options| &options.forms);
    let first = forms.first();
    // Several ranges have a form each, or one of all.
    let own = |number: usize| forms.get(number).or(first);
    let ranges: Vec<Value> = report
        .ranges
        .iter()
        .enumerate()
        .map(|(number, range)| {
            json!({
                "like": range.path.display().to_string(),
                "terrain": own(number).map(|form| json!({
                    "slope": form.slope,
                    "plains_depth": form.depth,
                    "roughness": form.roughness,
                    "curvature_per_m": form.curvature,
                })),
                "like_peaks": range.like_peaks,
                "peaks": range.peaks,
                "metrics": range.comparisons,
                "statistics": range.domain,
            })
        })
        .collect();
    json!({
        "rows": report.size.0,
        "cols": report.size.1,
        "area_km2": report.area_km2,
        "peaks": report.survey.peaks.len(),
        "edges": report.survey.edges.len(),
        "kept_peaks": report.kept_peaks,
        "kept_ridges": report.kept_ridges,
        "kept_peaks_with_another_prominence": report.altered,
        "peaks_without_room_at_their_isolation": report.misplaced,
        "peaks_without_a_drawn_prominence": report.misjudged,
        "ranges": ranges,
        "slope": first.map(|form| form.slope),
        "plains_depth": first.map(|form| form.depth),
        "roughness": first.map(|form| form.roughness),
        "curvature_per_m": first.map(|form| form.curvature),
        "seconds": { "measure": measured, "synthesize": tree, "terrain": terrain, "write": written },
    })
}
