//! `orograph map`.

use super::progress::watched;
use super::report::Reporter;
use super::shared::{CommonOptions, InputOptions, MemoryOptions, OutputOptions};
use super::wrong_value;
use crate::error::{Error, Result};
use crate::pipeline::layers::NAMES;
use crate::pipeline::map::{MapJob, MapReport, Sea, run};
use crate::units::parse_length_m;
use clap::Args;
use serde_json::{Value, json};
use std::path::PathBuf;

/// Draw a map of a DEM: hillshade and tints, with peaks, saddles and divides if their layers are given.
///
/// The layers are those that `orograph peaks` writes, in any CRS. Where peaks and labels crowd, the most prominent
/// are shown. A DEM much larger than the picture is averaged down while it is read, from overviews if it has them, or
/// from a level of an .oro file with at least 4 x 4 samples a pixel.
#[derive(Args, Clone, Debug)]
#[command(
    allow_missing_positional = true,
    override_usage = "orograph map [OPTIONS] <DEM> [LAYERS.gpkg] <OUT.png>",
    after_help = "Example:\n  orograph map fixtures/jacksboro.tif jacksboro.png --title Jacksboro"
)]
pub(super) struct Map {
    /// Elevation model: any raster that GDAL reads, or an .oro file.
    #[arg(value_name = "DEM", required = true)]
    input: PathBuf,
    /// Layers to draw on it: what orograph peaks made of the DEM.
    #[arg(value_name = "LAYERS.gpkg")]
    layers_file: Option<PathBuf>,
    /// Output: a .png file.
    #[arg(value_name = "OUT.png", required = true)]
    output: PathBuf,
    /// Width of the picture in pixels, 160 to 16384; its height follows from the DEM.
    #[arg(long, value_name = "PX", default_value_t = 1600)]
    width: u32,
    /// Title above the map.
    #[arg(long, value_name = "TEXT")]
    title: Option<String>,
    /// Where the data is from, in small print below the map; the DEM's file name unless given.
    #[arg(long, value_name = "TEXT")]
    source: Option<String>,
    /// Layers to draw, with commas between them: peaks, saddles, divide_tree, isolation.
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    layers: Option<Vec<String>>,
    /// Do not draw saddles.
    #[arg(long, conflicts_with = "layers")]
    no_saddles: bool,
    /// Draw the lines from peaks to the nearest higher ground too.
    #[arg(long, conflicts_with = "layers")]
    isolation: bool,
    /// Elevation up to which there is sea; 0 on Earth, none elsewhere unless given.
    #[arg(long, value_name = "LENGTH", allow_hyphen_values = true, conflicts_with = "no_sea")]
    sea_level: Option<String>,
    /// There is no sea: low ground is land.
    #[arg(long)]
    no_sea: bool,
    /// Cells without data are sea.
    #[arg(long)]
    nodata_is_sea: bool,
    /// How many times heights are exaggerated in the shading; to suit the relief unless given.
    #[arg(long, value_name = "TIMES", allow_negative_numbers = true)]
    exaggeration: Option<f64>,
    #[command(flatten)]
    raster: InputOptions,
    #[command(flatten)]
    out: OutputOptions,
    #[command(flatten)]
    memory: MemoryOptions,
    #[command(flatten)]
    pub(super) common: CommonOptions,
}

impl Map {
    fn meant(&self) -> Result<MapJob> {
        let sea = match &self.sea_level {
            _ if self.no_sea => Sea::None,
            Some(text) => Sea::UpTo(parse_length_m(text).map_err(|error| wrong_value("--sea-level", &error))?),
            None => Sea::OnEarth,
        };
        Ok(MapJob {
            input: self.input.clone(),
            raster: self.raster.meant()?,
            layers: self.layers_file.clone(),
            shown: self.shown()?,
            required: match &self.layers {
                Some(layers) => layers.clone(),
                None => self.isolation.then(|| "isolation".to_string()).into_iter().collect(),
            },
            output: self.output.clone(),
            overwrite: self.out.overwrite,
            width_px: self.width,
            title: self.title.clone(),
            source: self.source.clone(),
            sea,
            nodata_is_sea: self.nodata_is_sea,
            exaggeration: self.exaggeration,
            memory: self.memory.bytes()?,
        })
    }

    /// Names of the layers to draw.
    fn shown(&self) -> Result<Vec<String>> {
        if self.layers_file.is_none() && (self.layers.is_some() || self.isolation || self.no_saddles) {
            return Err(Error::usage(
                "there are no layers to choose from: name their file between the DEM and the picture (orograph peaks makes one)",
            ));
        }
        let Some(layers) = &self.layers else {
            let wanted = |name: &&str| match *name {
                "saddles" => !self.no_saddles,
                "isolation" => self.isolation,
                _ => true,
            };
            return Ok(NAMES.iter().filter(|name| wanted(name)).map(ToString::to_string).collect());
        };
        if let Some(unknown) = layers.iter().find(|layer| !NAMES.contains(&layer.as_str())) {
            return Err(Error::usage(format!(
                "--layers: there is no layer '{unknown}'; there are {}",
                NAMES.join(", ")
            )));
        }
        Ok(layers.clone())
    }

    pub(super) fn run(&self, reporter: &mut Reporter) -> Result<Value> {
        reporter.input(&self.input);
        if let Some(layers) = &self.layers_file {
            reporter.input(layers);
        }
        let job = self.meant()?;
        let report = watched(reporter, |watch, reporter| run(&job, watch, &mut |text| reporter.warn(text)))?;
        reporter.outputs(std::slice::from_ref(&job.output));
        let [read, drawn, written] = report.times.map(|time| time.as_secs_f64());
        reporter.remark(&format!("read {read:.3} s, drawn {drawn:.3} s, written {written:.3} s"));
        reporter.say(&text(&report))?;
        Ok(json(&report))
    }
}

fn text(report: &MapReport) -> String {
    let ((rows, cols), (width, height)) = (report.size, report.picture);
    let mut text = format!("{cols} x {rows} cells on {width} x {height} pixels");
    let (there, shown) = report.peaks;
    if there > 0 {
        text += &format!(", {shown} of {there} peaks");
    }
    text + "\n"
}

fn json(report: &MapReport) -> Value {
    let [read, drawn, written] = report.times.map(|time| time.as_secs_f64());
    json!({
        "rows": report.size.0,
        "cols": report.size.1,
        "rows_drawn": report.drawn.0,
        "cols_drawn": report.drawn.1,
        "width_px": report.picture.0,
        "height_px": report.picture.1,
        "sea_level_m": report.sea_level_m,
        "peaks_on_map": report.peaks.0,
        "peaks_drawn": report.peaks.1,
        "seconds": { "read": read, "draw": drawn, "write": written },
    })
}
