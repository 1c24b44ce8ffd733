//! Options that verbs share.

use super::wrong_value;
use crate::error::{Error, Result};
use crate::io::raster::RasterOptions;
use crate::units::{LengthUnit, parse_memory};
use clap::Args;
use std::path::Path;

/// Options of every verb.
#[derive(Args, Clone, Debug, Default)]
#[command(next_help_heading = "Common options")]
pub(super) struct CommonOptions {
    /// Print one JSON document instead of text.
    #[arg(long)]
    pub(super) json: bool,
    /// No progress, no warnings.
    #[arg(short, long)]
    pub(super) quiet: bool,
    /// Say more: how long each step took.
    #[arg(short, long)]
    pub(super) verbose: bool,
    /// Threads to use; all processors unless given. Results do not depend on it.
    #[arg(short = 'j', long, value_name = "N")]
    pub(super) threads: Option<usize>,
}

impl CommonOptions {
    /// Starts the pool of threads.
    pub(super) fn start_threads(&self) -> Result<()> {
        let threads = match self.threads {
            Some(0) => return Err(Error::usage("--threads 0: expected at least 1")),
            Some(threads) => threads,
            None => 0,
        };
        rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build_global()
            .map_err(|error| Error::usage(format!("--threads {threads}: {error}")))
    }
}

/// Which part of a raster is read.
#[derive(Args, Clone, Debug, Default)]
#[command(next_help_heading = "Input")]
pub(super) struct PartOptions {
    /// Read a part: first column, first row, columns, rows.
    #[arg(long, value_name = "COL,ROW,WIDTH,HEIGHT", value_delimiter = ',', num_args = 1)]
    window: Option<Vec<usize>>,
    /// Read the cells inside a box, in the input's CRS.
    #[arg(long, value_name = "XMIN,YMIN,XMAX,YMAX", value_delimiter = ',', num_args = 1, allow_hyphen_values = true)]
    bbox: Option<Vec<f64>>,
}

impl PartOptions {
    /// What the options mean: a window, a box, or neither.
    pub(super) fn meant(&self) -> Result<Part> {
        part_of(self.window.as_deref(), self.bbox.as_deref())
    }

    /// The first of the options that was given.
    pub(super) fn first_said(&self) -> Option<&'static str> {
        let said = [("--window", self.window.is_some()), ("--bbox", self.bbox.is_some())];
        said.iter().find(|(_, said)| *said).map(|(option, _)| *option)
    }
}

/// Options of verbs that read a raster.
#[derive(Args, Clone, Debug, Default)]
#[command(next_help_heading = "Input")]
pub(super) struct InputOptions {
    /// Band to read, from 1.
    #[arg(long, value_name = "N")]
    band: Option<usize>,
    /// Value of cells without data; replaces a declared one.
    #[arg(long, value_name = "VALUE", allow_negative_numbers = true)]
    nodata: Option<f64>,
    /// CRS of an input that has none: EPSG:2056, WKT, a PROJ string.
    #[arg(long, value_name = "CRS")]
    crs: Option<String>,
    /// Unit of the elevations: m, ft, us-ft, dm, cm, ...; replaces a declared one.
    #[arg(long, value_name = "UNIT")]
    vertical_unit: Option<String>,
    #[command(flatten)]
    part: PartOptions,
}

impl InputOptions {
    /// What the options mean.
    pub(super) fn meant(&self) -> Result<RasterOptions> {
        let (window, bbox) = self.part.meant()?;
        Ok(RasterOptions {
            band: self.band,
            nodata: self.nodata,
            crs: self.crs.clone(),
            vertical_unit: unit_of(self.vertical_unit.as_deref())?,
            window,
            bbox,
        })
    }

    /// The options as words of a command, those that were given.
    pub(super) fn words(&self) -> Vec<String> {
        let mut words = Vec::new();
        let mut put = |option: &str, value: Option<String>| {
            if let Some(value) = value {
                words.extend([option.to_string(), value]);
            }
        };
        put("--band", self.band.map(|v| v.to_string()));
        put("--nodata", self.nodata.map(|v| v.to_string()));
        put("--crs", self.crs.clone());
        put("--vertical-unit", self.vertical_unit.clone());
        put("--window", self.part.window.as_deref().map(list));
        put("--bbox", self.part.bbox.as_deref().map(list));
        words
    }
}

/// The unit that an option names.
pub(super) fn unit_of(name: Option<&str>) -> Result<Option<LengthUnit>> {
    let unit = |name: &str| {
        LengthUnit::from_name(name).ok_or_else(|| {
            Error::usage(format!("--vertical-unit '{name}' is not a known unit: expected m, ft, us-ft, ..."))
        })
    };
    name.map(unit).transpose()
}

/// What --window and --bbox give.
type Part = (Option<[usize; 4]>, Option<[f64; 4]>);

/// What --window and --bbox mean.
pub(super) fn part_of(window: Option<&[usize]>, bbox: Option<&[f64]>) -> Result<Part> {
    Ok((four("--window", window)?, four("--bbox", bbox)?))
}

/// The four numbers of an option, if it is given.
pub(super) fn four<T: Copy>(option: &str, numbers: Option<&[T]>) -> Result<Option<[T; 4]>> {
    let found = numbers.map(|numbers| {
        <[T; 4]>::try_from(numbers).map_err(|_| {
            let n = numbers.len();
            Error::usage(format!("{option}: expected four numbers with commas between them, found {n}"))
        })
    });
    found.transpose()
}

/// What a --co means.
pub(super) fn creation_option(text: &String) -> Result<(String, String)> {
    match text.split_once('=') {
        Some((key, value)) if !key.is_empty() => Ok((key.to_string(), value.to_string())),
        _ => Err(Error::usage(format!("--co {text}: expected KEY=VALUE"))),
    }
}

/// Numbers as an option takes them.
pub(super) fn list<T: ToString>(values: &[T]) -> String {
    values.iter().map(ToString::to_string).collect::<Vec<_>>().join(",")
}

/// Options of verbs that write.
#[derive(Args, Clone, Debug, Default)]
#[command(next_help_heading = "Output")]
pub(super) struct OutputOptions {
    /// Replace outputs that exist already.
    #[arg(long)]
    pub(super) overwrite: bool,
}

/// Refuses an output that is to be an .oro file and is not named so.
pub(super) fn named_oro(output: &Path) -> Result<()> {
    match output.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("oro")) {
        true => Ok(()),
        false => Err(Error::usage("the output is an .oro file: name it so").at_path(output)),
    }
}

/// Looks whether what was learned for `amplify` is named so.
pub(super) fn named_learned(output: &Path) -> Result<()> {
    match output.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("learned")) {
        true => Ok(()),
        false => Err(Error::usage("with --multires the output is a .learned file: name it so").at_path(output)),
    }
}

/// Options of verbs that keep much in memory.
#[derive(Args, Clone, Debug, Default)]
#[command(next_help_heading = "Resources")]
pub(super) struct MemoryOptions {
    /// Memory that may be used, such as 2G; what the machine has free unless given.
    #[arg(long, value_name = "SIZE")]
    memory: Option<String>,
}

impl MemoryOptions {
    /// Bytes that may be used, if given.
    pub(super) fn bytes(&self) -> Result<Option<u64>> {
        self.memory
            .as_deref()
            .map(|text| parse_memory(text).map_err(|error| wrong_value("--memory", &error)))
            .transpose()
    }
}
