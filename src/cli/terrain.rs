//! `orograph terrain`.

use super::progress::watched;
use super::report::Reporter;
use super::shared::{CommonOptions, MemoryOptions, OutputOptions, four, list};
use super::terrain_shape::{ShapeOptions, resolution_m};
use crate::error::{Error, Result};
use crate::pipeline::terrain::{TerrainJob, TerrainReport, is_raster, run};
use clap::Args;
use serde_json::{Value, json};
use std::path::PathBuf;

/// Raise terrain on a divide tree: a DEM with just its peaks and key saddles.
///
/// The tree is what `orograph peaks` writes into a .gpkg: edit it in QGIS (move, add or delete peaks, saddles and ridge
/// lines), save, and raise it again. Geometry decides: a line leads from the peak nearest to its one end to the peak
/// nearest to its other, over the saddle nearest to it, within two cells. A .txt is read as the divide trees that Argudo
/// et al. (2019) publish. Every peak and every saddle is a cell with its elevation; water runs off everywhere between the
/// ridges. Lengths take a unit (30m, 100ft, 1.5km); a bare number is metres.
#[derive(Args, Clone, Debug)]
#[command(after_help = "Examples:\n  \
    orograph peaks fixtures/jacksboro.tif tree.gpkg --min-prominence 30m\n  \
    orograph terrain tree.gpkg terrain.tif --resolution 90m")]
pub(super) struct Terrain {
    /// Divide tree: a .gpkg with the layers peaks, saddles and divide_tree, or a .txt.
    #[arg(value_name = "TREE")]
    tree: PathBuf,
    /// Output: any raster format that GDAL writes.
    #[arg(value_name = "OUT")]
    output: PathBuf,
    /// Side of the cells.
    #[arg(long, value_name = "LENGTH", default_value = "30m", allow_hyphen_values = true)]
    resolution: String,
    /// The land, in units of the tree's CRS; all that is drawn unless given.
    #[arg(long, value_name = "XMIN,YMIN,XMAX,YMAX", value_delimiter = ',', num_args = 1, allow_hyphen_values = true)]
    bbox: Option<Vec<f64>>,
    /// CRS of a tree that has none: EPSG:2056, WKT, a PROJ string.
    #[arg(long, value_name = "CRS")]
    crs: Option<String>,
    /// Equal seeds make equal detail.
    #[arg(long, value_name = "N", default_value_t = 0)]
    seed: u64,
    #[command(flatten)]
    shape: ShapeOptions,
    #[command(flatten)]
    out: OutputOptions,
    #[command(flatten)]
    memory: MemoryOptions,
    #[command(flatten)]
    pub(super) common: CommonOptions,
}

impl Terrain {
    fn meant(&self) -> Result<TerrainJob> {
        let resolution_m = resolution_m(&self.resolution)?;
        if !is_raster(&self.output) {
            return Err(Error::usage(format!("{} is no raster: give a .tif", self.output.display())));
        }
        Ok(TerrainJob {
            tree: self.tree.clone(),
            output: self.shape.output(&self.output, self.out.overwrite)?,
            crs: self.crs.clone(),
            bbox: four("--bbox", self.bbox.as_deref())?,
            resolution_m,
            shape: self.shape.shape(self.seed)?,
            memory: self.memory.bytes()?,
            command: self.words().join(" "),
        })
    }

    /// The command without what changes no result.
    fn words(&self) -> Vec<String> {
        let mut words: Vec<String> = ["orograph", "terrain"].map(String::from).to_vec();
        let mut put = |option: &str, value: Option<String>| {
            words.extend(value.into_iter().flat_map(|value| [option.to_string(), value]));
        };
        put("--resolution", Some(self.resolution.clone()));
        put("--bbox", self.bbox.as_deref().map(list));
        put("--crs", self.crs.clone());
        put("--seed", Some(self.seed.to_string()));
        words.extend(self.shape.words());
        words
    }

    pub(super) fn run(&self, reporter: &mut Reporter) -> Result<Value> {
        reporter.input(&self.tree);
        let job = self.meant()?;
        let report = watched(reporter, |watch, reporter| run(&job, watch, &mut |text| reporter.warn(text)))?;
        reporter.outputs(&report.outputs);
        let [read, raised, written] = report.times.map(|time| time.as_secs_f64());
        reporter.remark(&format!("read {read:.3} s, raised {raised:.3} s, written {written:.3} s"));
        reporter.say(&text(&report))?;
        Ok(json(&report))
    }
}

fn text(report: &TerrainReport) -> String {
    let [width_m, height_m] = report.cell_m;
    format!(
        "{} peaks and {} saddles on {} x {} cells of {width_m:.2} x {height_m:.2} m, from {:.1} to {:.1} m\n",
        report.peaks, report.saddles, report.size.1, report.size.0, report.range_m.0, report.range_m.1
    )
}

fn json(report: &TerrainReport) -> Value {
    let [read, raised, written] = report.times.map(|time| time.as_secs_f64());
    json!({
        "rows": report.size.0,
        "cols": report.size.1,
        "cell_m": { "across": report.cell_m[0], "down": report.cell_m[1] },
        "peaks": report.peaks,
        "saddles": report.saddles,
        "crossing_ridges": report.crossings,
        "elevation_m": { "least": report.range_m.0, "greatest": report.range_m.1 },
        "crs": report.crs,
        "format": report.format,
        "seconds": { "read": read, "raise": raised, "write": written },
    })
}
