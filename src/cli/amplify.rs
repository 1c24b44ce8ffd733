//! `orograph amplify`.

use super::progress::watched;
use super::report::Reporter;
use super::shared::{CommonOptions, MemoryOptions, OutputOptions, creation_option, unit_of};
use super::sparse::StoredInput;
use super::teaching::{Mode, PaperOptions, USUAL_FACTOR, USUAL_SEED};
use super::wrong_value;
use crate::error::{Error, Result};
use crate::pipeline::amplify::{AmplifyJob, AmplifyReport, Figures, Said, Source, Teaching, run};
use crate::units::parse_length_m;
use clap::Args;
use serde_json::{Value, json};
use std::path::PathBuf;

/// Make a DEM finer, with the detail that terrain like it has.
///
/// Exemplars are finer DEMs of other places: what their small forms are like above their large ones is learned, and
/// added to the input's. The output has so many times the input's rows and columns, on a grid aligned with it, and the
/// same CRS, unit and voids; the mean of the cells that lie in one of the input's is that cell's elevation. Mode
/// accurate gives the best estimate of the true heights, which is smoother than terrain. Mode realistic gives one of
/// the terrains that there may be, as rough as true ones and with no more pits; another for each seed. Water, cells
/// exactly as high as those around them, stays level in it. Mode paper puts patches of the exemplars in place of the
/// input's that are most like them, as Guérin et al. (2016) have it; it keeps the look of the exemplars, but not the
/// means. With --sketch terrain is made of a drawn map. Exemplars may have any unit, CRS and cells; those with cells of
/// about the size that is to be made teach most. Whoever makes many inputs finer learns once, with learn --multires, and
/// gives --learned in place of --exemplar: the result is the same.
#[derive(Args, Clone, Debug)]
#[command(after_help = "Examples:\n  \
                        orograph amplify fixtures/jacksboro.tif fine.tif --exemplar fixtures/jacksboro.tif --factor 2\n  \
                        orograph amplify fixtures/void.tif fine.oro --exemplar fixtures/jacksboro.tif --factor 3\n  \
                        orograph amplify fixtures/void.tif new.tif --exemplar fixtures/jacksboro.tif --mode realistic\n  \
                        orograph amplify fixtures/void.tif x.tif --exemplar fixtures/jacksboro.tif --report x.html\n  \
                        orograph amplify fixtures/void.tif old.tif --exemplar fixtures/jacksboro.tif --mode paper\n  \
                        orograph learn --multires --mode paper fixtures/jacksboro.tif hills.learned\n  \
                        orograph amplify fixtures/void.tif hills.tif --learned hills.learned")]
pub(super) struct Amplify {
    /// Elevation model: any raster that GDAL reads, or an .oro file.
    #[arg(value_name = "IN")]
    input: PathBuf,
    /// Output: any raster format that GDAL writes, or an .oro file that keeps every bit.
    #[arg(value_name = "OUT")]
    output: PathBuf,
    /// Elevation models to learn from.
    #[arg(long = "exemplar", value_name = "DEM", required_unless_present = "learned", num_args = 1..)]
    exemplars: Vec<PathBuf>,
    /// What was learned before, by learn --multires, in place of exemplars. It has the factor, the mode and all that goes
    /// with them.
    #[arg(long, value_name = "FILE", conflicts_with = "exemplars")]
    learned: Option<PathBuf>,
    /// How many times finer the cells become: 2 to 256, a product of 2, 3, 5 and 7 unless in mode paper [default: 4].
    #[arg(long, value_name = "N")]
    factor: Option<usize>,
    /// The input is a hand-drawn map: greys of 8 or 16 bits, a palette of greys, or red, green and blue that are equal,
    /// which stand for --heights. Where it does not say where it lies, --bbox and --crs do.
    #[arg(long, requires = "heights")]
    sketch: bool,
    /// What black and white stand for in a sketch, such as 200m,3000m.
    #[arg(long, value_name = "LOW,HIGH", requires = "sketch", allow_hyphen_values = true)]
    heights: Option<String>,
    /// What the result is to be [default: accurate].
    #[arg(long, value_enum)]
    mode: Option<Mode>,
    /// Seed of what is drawn: in mode accurate the parts of large exemplars that are learned from, in mode realistic the
    /// terrain, in mode paper the atoms that learning begins with [default: 1].
    #[arg(long, value_name = "N")]
    seed: Option<u64>,
    /// How many terrains to make in mode realistic, with the seed and those that follow it. Several are written to
    /// OUT-1.tif, OUT-2.tif and so on where OUT.tif is the output.
    #[arg(long, value_name = "K", default_value_t = 1)]
    count: usize,
    #[command(flatten)]
    paper: PaperOptions,
    #[command(flatten)]
    raster: StoredInput,
    /// GDAL's name of the output's format; after the extension unless given.
    #[arg(long = "of", value_name = "FORMAT", help_heading = "Output")]
    format: Option<String>,
    /// Option of the output's format; may be given several times.
    #[arg(long = "co", value_name = "KEY=VALUE", help_heading = "Output")]
    options: Vec<String>,
    /// Also write a page that can be mailed: the middle of the raster before and after, slopes, spectra, and where means
    /// are off; one HTML file.
    #[arg(long, value_name = "PAGE.html", help_heading = "Output")]
    report: Option<PathBuf>,
    #[command(flatten)]
    out: OutputOptions,
    #[command(flatten)]
    memory: MemoryOptions,
    #[command(flatten)]
    pub(super) common: CommonOptions,
}

impl Amplify {
    fn meant(&self) -> Result<AmplifyJob> {
        Ok(AmplifyJob {
            input: self.input.clone(),
            raster: self.raster.meant()?,
            unit: unit_of(self.raster.vertical_unit.as_deref())?,
            sketch_m: self.sketch_m()?,
            source: self.source()?,
            seed: self.seed.unwrap_or(USUAL_SEED),
            count: self.count,
            output: self.output.clone(),
            page: self.report.clone(),
            overwrite: self.out.overwrite,
            format: self.format.clone(),
            options: self.options.iter().map(creation_option).collect::<Result<_>>()?,
            memory: self.memory.bytes()?,
        })
    }

    /// Where what is learned comes from.
    fn source(&self) -> Result<Source> {
        let Some(path) = &self.learned else {
            let mode = self.mode.unwrap_or(Mode::Accurate);
            self.paper.only_in(mode)?;
            return Ok(Source::Teaching(Teaching {
                exemplars: self.exemplars.clone(),
                factor: self.factor.unwrap_or(USUAL_FACTOR),
                mode: mode.meant(),
                model: self.paper.meant(),
                seed: self.seed.unwrap_or(USUAL_SEED),
            }));
        };
        let number = |option, value: Option<String>| value.map(|value| Said { option, value: Some(value) });
        let mut said: Vec<Said> = [
            number("--mode", self.mode.map(|mode| mode.meant().name().to_string())),
            number("--factor", self.factor.map(|factor| factor.to_string())),
            number("--seed", self.seed.map(|seed| seed.to_string())),
        ]
        .into_iter()
        .flatten()
        .collect();
        said.extend(self.paper.said());
        Ok(Source::Learned { path: path.clone(), said })
    }

    /// The heights of a sketch.
    fn sketch_m(&self) -> Result<Option<[f64; 2]>> {
        let Some(text) = &self.heights else { return Ok(None) };
        if self.raster.vertical_unit.is_some() {
            return Err(Error::usage("--vertical-unit: the elevations of a sketch are those of --heights"));
        }
        let wrong = || Error::usage(format!("--heights {text}: expected LOW,HIGH, such as 200m,3000m"));
        let (low, high) = text.split_once(',').ok_or_else(wrong)?;
        let length = |text: &str| parse_length_m(text).map_err(|error| wrong_value("--heights", &error));
        let heights_m = [length(low)?, length(high)?];
        if heights_m[0] >= heights_m[1] {
            return Err(wrong());
        }
        Ok(Some(heights_m))
    }

    pub(super) fn run(&self, reporter: &mut Reporter) -> Result<Value> {
        reporter.input(&self.input);
        self.exemplars.iter().chain(&self.learned).for_each(|path| reporter.input(path));
        let job = self.meant()?;
        let report = watched(reporter, |watch, reporter| run(&job, watch, &mut |text| reporter.warn(text)))?;
        reporter.outputs(&report.outputs);
        let [learned, made] = report.times.map(|time| time.as_secs_f64());
        reporter.remark(&format!("learned {learned:.3} s, made and written {made:.3} s"));
        reporter.say(&text(&report))?;
        Ok(json(&report))
    }
}

fn figures(figures: &Figures) -> Value {
    let side = |i: usize| {
        json!({
            "median_slope_deg": figures.median_slope_deg[i],
            "steep_slope_deg": figures.steep_slope_deg[i],
            "power_m2_by_wavelength_m": figures.spectra[i],
        })
    };
    json!({ "part": figures.part, "input": side(0), "output": side(1) })
}

fn text(report: &AmplifyReport) -> String {
    let [rows, cols] = report.size;
    let [across, down] = report.cell_m.map(|m| (m * 100.0).round() / 100.0);
    let seconds: f64 = report.times.iter().map(|time| time.as_secs_f64()).sum();
    let mut text = format!("{cols} x {rows} cells of {across} x {down} m as {}, {seconds:.1} s\n", report.format);
    if !report.atoms.is_empty() {
        let atoms: Vec<String> = report.atoms.iter().map(usize::to_string).collect();
        text += &format!("patches of the exemplars, step by step: {}\n", atoms.join(", "));
    }
    text += &format!("means of cells are the input's within {:.4} m\n", report.deviation_m);
    text
}

fn json(report: &AmplifyReport) -> Value {
    let [learned, made] = report.times.map(|time| time.as_secs_f64());
    json!({
        "rows": report.size[0],
        "cols": report.size[1],
        "cell_m": { "across": report.cell_m[0], "down": report.cell_m[1] },
        "cells_with_data": report.cells,
        "atoms": report.atoms,
        "deviation_m": report.deviation_m,
        "format": report.format,
        "report": report.figures.as_ref().map(figures),
        "seeds": report.seeds,
        "seconds": { "learn": learned, "make": made },
    })
}
