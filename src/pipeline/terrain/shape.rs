//! How terrain is shaped, as far as a job says so.

use super::super::land::Land;
use super::super::memory;
use super::ground::read_ground;
use crate::error::Result;
use crate::synthesis::terrain::{Form, FormMap, Free, Likeness, Skeleton, TerrainOptions, fit};
use crate::watch::Watch;
use std::path::PathBuf;

/// How terrain is shaped; what is not given is usual, or like a range.
#[derive(Clone, Debug, Default)]
pub struct TerrainShape {
    /// A raster of how high the land is in the mean.
    pub ground_map: Option<PathBuf>,
    /// Elevation of plains in metres where no ground is known; the lowest saddle's unless given.
    pub floor_m: Option<f64>,
    /// Slope of the ground, rise over run.
    pub slope: Option<f64>,
    /// Slope of the detail of each wavelength, rise over run, in the mean.
    pub roughness: Option<f64>,
    /// How much the slope of the ground between ridges and valleys changes per metre.
    pub curvature: Option<f64>,
    /// How much rivers wear the ground down; not at all unless given.
    pub erosion: Option<f64>,
    /// Equal seeds give equal detail.
    pub seed: u64,
}

/// What terrain is like.
pub(in super::super) struct TerrainLike<'a> {
    /// How steep the ranges are, where that is known.
    pub(in super::super) likes: Vec<Option<&'a Likeness>>,
    /// For each peak of the skeleton the position of its range.
    pub(in super::super) kinds: &'a [usize],
}

impl TerrainShape {
    /// The options for the terrain of a skeleton on some land, chosen like ranges where such are given; work that does not
    /// fit into memory is refused.
    ///
    /// # Errors
    /// A ground map that is wrong, or land with too many cells.
    pub(in super::super) fn options(
        &self,
        skeleton: &Skeleton,
        land: &Land,
        like: Option<&TerrainLike<'_>>,
        memory: Option<u64>,
        watch: &Watch,
    ) -> Result<TerrainOptions> {
        memory::admit_or(
            memory::terrain_bytes(land.rows as u64 * land.cols as u64),
            memory.unwrap_or_else(memory::free_bytes),
            "give a smaller --bbox or a coarser --resolution",
        )?;
        let ground = self.ground_map.as_ref();
        let ground = ground.map(|path| read_ground(path, land, skeleton.cell_m, memory, watch)).transpose()?;
        let lowest_m = skeleton.saddles.iter().chain(&skeleton.peaks).map(|spot| spot.elevation_m).reduce(f64::min);
        let usual = TerrainOptions::default();
        let usual_form = Form::default();
        let form = Form {
            slope: self.slope.unwrap_or(usual_form.slope),
            roughness: self.roughness.unwrap_or(usual_form.roughness),
            curvature: self.curvature.unwrap_or(usual_form.curvature),
            ..usual_form
        };
        let several = like.filter(|like| like.likes.len() > 1);
        let options = TerrainOptions {
            forms: vec![form; like.map_or(1, |like| like.likes.len())],
            form_map: several.map(|like| FormMap::of_peaks(skeleton, like.kinds)),
            ground,
            floor_m: self.floor_m.or(lowest_m).unwrap_or(0.0),
            erosion: self.erosion.unwrap_or(usual.erosion),
            seed: self.seed,
        };
        let free = Free {
            slope: self.slope.is_none(),
            roughness: self.roughness.is_none(),
            curvature: self.curvature.is_none(),
        };
        like.map_or_else(|| Ok(options.clone()), |like| fit(skeleton, &options, free, &like.likes, watch))
    }
}
