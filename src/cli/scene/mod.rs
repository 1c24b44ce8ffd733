//! `orograph scene`: verbs on construction trees.

mod check;
mod eval;
mod mesh;
mod render;

use super::execute;
use super::shared::{CommonOptions, four, list};
use crate::error::{Error, Result};
use crate::pipeline::scene::{CellOptions, DetailOption};
use crate::units::parse_length_m;
use clap::{Args, Subcommand};
use std::path::PathBuf;

/// Terrain as a construction tree: DEMs, rivers, roads, lakes and noise, put together by a scene in JSON.
///
/// A scene names rasters and vector layers by paths relative to itself, and says how they make a terrain: what is
/// blended, replaced, added, moved. format-spec/scene.md describes it.
#[derive(Args, Clone, Debug)]
#[command(after_help = "Examples:\n  orograph scene check fixtures/scenes/valley.json\n  \
                        orograph scene eval fixtures/scenes/valley.json valley.tif --resolution 30m")]
pub(super) struct Scene {
    #[command(subcommand)]
    verb: Verb,
}

#[derive(Clone, Debug, Subcommand)]
enum Verb {
    Check(check::Check),
    Eval(Box<eval::Eval>),
    Mesh(Box<mesh::Mesh>),
    Render(Box<render::Render>),
}

impl Scene {
    /// Runs the verb; returns the exit code.
    pub(super) fn run(&self) -> u8 {
        match &self.verb {
            Verb::Check(verb) => execute("scene check", &verb.common, |reporter| verb.run(reporter)),
            Verb::Eval(verb) => execute("scene eval", &verb.common, |reporter| verb.run(reporter)),
            Verb::Render(verb) => execute("scene render", &verb.common, |reporter| verb.run(reporter)),
            Verb::Mesh(verb) => execute("scene mesh", &verb.common, |reporter| verb.run(reporter)),
        }
    }
}

/// Which cells are wanted.
#[derive(Args, Clone, Debug, Default)]
#[command(next_help_heading = "Cells")]
struct CellArguments {
    /// Side of a cell; that of the scene's finest raster unless given.
    #[arg(long, value_name = "LENGTH")]
    resolution: Option<String>,
    /// The part that is wanted, in the scene's CRS: edges of cells; all of the scene unless given, with edges at whole
    /// multiples of the resolution, or those of the finest raster's cells.
    #[arg(long, value_name = "XMIN,YMIN,XMAX,YMAX", value_delimiter = ',', num_args = 1, allow_hyphen_values = true)]
    bbox: Option<Vec<f64>>,
    /// Take the cells of a raster, which lies in the scene's CRS.
    #[arg(long, value_name = "RASTER", conflicts_with_all = ["resolution", "bbox"])]
    like: Option<PathBuf>,
}

impl CellArguments {
    fn meant(&self) -> Result<CellOptions> {
        let resolution = self.resolution.as_deref().map(parse_length_m).transpose();
        let resolution_m = resolution.map_err(|error| super::wrong_value("--resolution", &error))?;
        Ok(CellOptions { resolution_m, bbox: four("--bbox", self.bbox.as_deref())?, like: self.like.clone() })
    }

    /// The options as words of a command, those that were given.
    fn words(&self) -> Vec<String> {
        let mut words = vec![];
        let mut put = |option: &str, value: Option<String>| {
            if let Some(value) = value {
                words.extend([option.to_string(), value]);
            }
        };
        put("--resolution", self.resolution.clone());
        put("--bbox", self.bbox.as_deref().map(list));
        put("--like", self.like.as_ref().map(|path| path.display().to_string()));
        words
    }
}

/// Where the level of detail comes from.
#[derive(Args, Clone, Debug, Default)]
#[command(next_help_heading = "Level of detail")]
struct DetailArguments {
    /// The same level of detail everywhere, from 0 (coarse) to 1 (all); what the scene says unless given.
    #[arg(long, value_name = "LEVEL", conflicts_with = "detail_around")]
    detail: Option<f64>,
    /// All detail up to so many metres around a point in the scene's CRS, and none beyond so many.
    #[arg(long, value_name = "X,Y,NEAR,FAR", value_delimiter = ',', num_args = 1, allow_hyphen_values = true)]
    detail_around: Option<Vec<f64>>,
}

impl DetailArguments {
    /// The options as words of a command, those that were given.
    fn words(&self) -> Vec<String> {
        let constant = self.detail.map(|level| ["--detail".to_string(), level.to_string()]);
        let around = self.detail_around.as_deref().map(|numbers| ["--detail-around".to_string(), list(numbers)]);
        constant.into_iter().chain(around).flatten().collect()
    }

    fn meant(&self) -> Result<Option<DetailOption>> {
        if let Some(level) = self.detail {
            if !(0.0..=1.0).contains(&level) {
                return Err(Error::usage(format!("--detail {level}: expected a number from 0 to 1")));
            }
            return Ok(Some(DetailOption::Constant(level)));
        }
        let Some(numbers) = &self.detail_around else { return Ok(None) };
        match numbers[..] {
            [x, y, near_m, far_m] if near_m >= 0.0 && far_m > near_m && x.is_finite() && y.is_finite() => {
                Ok(Some(DetailOption::Around { centre: [x, y], near_m, far_m }))
            }
            _ => {
                let given = list(numbers);
                Err(Error::usage(format!("--detail-around {given}: expected X,Y,NEAR,FAR with NEAR less than FAR")))
            }
        }
    }
}
