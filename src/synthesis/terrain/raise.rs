//! Terrain over a divide tree.

use super::ceiling::Ceiling;
use super::crest::Crest;
use super::detail::detail;
use super::envelope::distance;
use super::erode::erode;
use super::form::{Form, FormMap, Graded};
use super::ground::Ground;
use super::hills::{hilly, shaved};
use super::membrane::stretch;
use super::skeleton::Skeleton;
use super::surface::surface;
use super::valleys::{ValleyOptions, carve};
use super::water::{drained, feet, ways};
use crate::erosion::Relief;
use crate::error::Result;
use crate::watch::Watch;
use rayon::prelude::*;

/// How terrain is raised.
#[derive(Clone, Debug, PartialEq)]
pub struct TerrainOptions {
    /// How the ground is formed: at least one way.
    pub forms: Vec<Form>,
    /// Which form it has where; the first everywhere unless given.
    pub form_map: Option<FormMap>,
    /// How much rivers wear the ground down once it is raised: the stream power law's factor times its time, for all
    /// steps, per metre of the square root of the drained area; 0 for nothing.
    pub erosion: f64,
    /// How high the land is in the mean, if that is known.
    pub ground: Option<Ground>,
    /// Elevation of plains in metres where no ground is known.
    pub floor_m: f64,
    /// Equal seeds give equal detail.
    pub seed: u64,
}

impl Default for TerrainOptions {
    fn default() -> Self {
        Self { forms: vec![Form::default()], form_map: None, erosion: 0.0, ground: None, floor_m: 0.0, seed: 0 }
    }
}

impl TerrainOptions {
    /// A number of the forms, as it changes from place to place.
    pub(super) fn graded(&self, number: impl Fn(&Form) -> f64) -> Graded {
        Graded::of(&self.forms, self.form_map.as_ref(), number)
    }
}

/// Terrain that was raised.
#[derive(Clone, Debug)]
pub struct Raised {
    /// The terrain.
    pub relief: Relief,
    /// Positions of pairs of ridges that meet higher than the tree has it, since their lines cross.
    pub crossings: Vec<[u32; 2]>,
}

/// Square metres that drain to where a valley begins.
const VALLEY_M2: f64 = 2e5;
/// Slope of a valley's beginning, as a share of that of the ground.
const HEAD: f64 = 0.6;
/// Steps in which terrain is raised once.
const STEPS: u64 = 7;
/// How many times what is lacking is given to the plains, which are a part of the ground only.
const CORRECTION: f32 = 1.5;

/// Raises terrain that has the peaks and key saddles of a divide tree.
///
/// Where the ground is known, terrain is raised twice: what came out too low or too high in the mean of some blocks the
/// first time has higher or lower plains the second time.
///
/// # Errors
/// A skeleton with a fault, a raster of more than 2^32 cells, or a cancelled job.
///
/// # Panics
/// Without a form, or with a map of more forms than there are.
///
/// # Complexity
/// O(n) for n cells, and O(b log b) for the b pairs of neighbours on the borders between depressions.
pub fn raise(skeleton: &Skeleton, options: &TerrainOptions, watch: &Watch) -> Result<Raised> {
    skeleton.check()?;
    let last = options.form_map.as_ref().map_or(0, FormMap::last);
    assert!(last < options.forms.len(), "form {last} of {}", options.forms.len());
    let frame = Frame::of(skeleton);
    watch.begin("raising terrain", if options.ground.is_some() { 2 * STEPS } else { STEPS });
    Ok(Raised { relief: raise_on(&frame, options, &|| watch.advance(1))?, crossings: frame.crest.crossings })
}

/// What all terrain of a skeleton has in common.
pub(super) struct Frame<'a> {
    skeleton: &'a Skeleton,
    crest: Crest,
    ceiling: Ceiling,
    foot_m: Vec<f32>,
}

impl<'a> Frame<'a> {
    /// The frame of a skeleton that was checked.
    pub(super) fn of(skeleton: &'a Skeleton) -> Self {
        let crest = Crest::of(skeleton);
        let (ceiling, foot_m) = rayon::join(|| Ceiling::of(&crest, skeleton), || feet(&crest, skeleton));
        Self { skeleton, crest, ceiling, foot_m }
    }
}

/// Raises terrain in a frame; see [`raise`]. Calls `done` after each step, and ends where that fails.
pub(super) fn raise_on(frame: &Frame<'_>, options: &TerrainOptions, done: &dyn Fn() -> Result<()>) -> Result<Relief> {
    let Some(ground) = &options.ground else { return raise_once(frame, options, done) };
    let first = raise_once(frame, options, done)?;
    let own = Ground::of(first.z_m(), frame.skeleton.size, ground.size);
    drop(first);
    let ground = Some(ground.corrected(&own, CORRECTION));
    raise_once(frame, &TerrainOptions { ground, ..options.clone() }, done)
}

fn raise_once(frame: &Frame<'_>, options: &TerrainOptions, done: &dyn Fn() -> Result<()>) -> Result<Relief> {
    let Frame { skeleton, crest, ceiling, foot_m } = frame;
    let (size, cell_m) = (skeleton.size, skeleton.cell_m);
    let [slope, roughness, curvature] =
        [|form: &Form| form.slope, |form: &Form| form.roughness, |form: &Form| form.curvature]
            .map(|number| options.graded(number));
    let (mut rough_m, detail_m) =
        rayon::join(|| surface(skeleton, crest, ceiling, options), || detail(size, cell_m, &roughness, options.seed));
    done()?;
    rough_m.par_iter_mut().zip(&detail_m).for_each(|(z, detail)| *z += detail);
    let drainage = ways(&rough_m, foot_m, crest, skeleton)?;
    done()?;
    let rise_m = (HEAD * cell_m[0].max(cell_m[1])) as f32;
    let valleys = ValleyOptions { least_m2: VALLEY_M2, slope: &slope, rise_m };
    let mut fast = carve(skeleton, crest, rough_m, &drainage, valleys);
    drop(drainage);
    done()?;
    let ((), clear_m) = rayon::join(
        || stretch(&mut fast.z_m, &fast.is_fast, size, cell_m, &curvature),
        || distance(&fast.is_fast, size, cell_m),
    );
    done()?;
    let mut z_m = fast.z_m;
    hilly(&mut z_m, &clear_m, &detail_m, ceiling, size, &slope);
    drop(detail_m);
    if options.erosion > 0.0 {
        erode(&mut z_m, &clear_m, size, cell_m, options.erosion)?;
    }
    drop(clear_m);
    done()?;
    let z_m = shaved(z_m, crest, skeleton)?;
    done()?;
    let z_m = drained(z_m, crest, skeleton)?;
    done()?;
    Relief::new(size[0], size[1], cell_m, z_m)
}
