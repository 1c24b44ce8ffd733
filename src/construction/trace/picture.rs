//! What is seen at each place of a picture.

use super::camera::Lens;
use super::packet::Scene;
use super::tracer::{Memory, Tracer};
use crate::construction::tree::Tree;
use crate::error::{Error, Result};
use crate::watch::Watch;
use rayon::prelude::*;

/// How rays find the ground. All find the same ground.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Strategy {
    /// Sphere tracing with one Lipschitz constant for all of the terrain (Génevaux et al. 2015, section 7.1).
    Sphere,
    /// Steps from Lipschitz constants of the neighbourhood (Génevaux et al. 2015, section 7.2).
    Accelerated,
    /// Steps from bounds over the segment ahead (Galin et al. 2020, "Segment tracing using local Lipschitz bounds",
    /// doi:10.1111/cgf.13951).
    Segment,
    /// Bounds over quads of the plane that all rays share, down to a few pixels, and samples of the ground in the finest.
    #[default]
    Quads,
}

/// How to trace.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TraceOptions {
    /// How rays find the ground.
    pub strategy: Strategy,
    /// A ray has met the ground when it is no higher above it than this share of a pixel's width there. Before that it
    /// is nowhere further below the ground than twice as much, and a ray that meets none is nowhere below it.
    pub tolerance: f64,
    /// Evaluations after which a ray gives up, and shows the ground that it is above.
    pub max_steps: u32,
    /// How far from the eye the terrain is looked at, in metres; all of it where it has an end, else 1000 km.
    pub reach_m: Option<f64>,
    /// The direction towards the sun (east, north, up; of length 1, in the picture's heights), to find shadows.
    pub sun: Option<[f64; 3]>,
}

impl Default for TraceOptions {
    fn default() -> Self {
        Self { strategy: Strategy::default(), tolerance: 0.5, max_steps: 4096, reach_m: None, sun: None }
    }
}

/// What one ray meets.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Seen {
    /// Nothing; the sine of the ray's angle above the horizon.
    Sky(f64),
    /// The ground.
    Ground {
        /// Index of the tree.
        tree: usize,
        /// Elevation in metres.
        elevation_m: f64,
        /// Rise eastwards and northwards, metres per metre, not exaggerated.
        slope: [f64; 2],
        /// Way of the ray in metres; from its place next to the middle of the picture where rays are parallel.
        distance_m: f64,
        /// Whether the sun reaches it; true where no sun was asked for.
        sunlit: bool,
        /// Whether it is the side of the terrain's edge, not its surface.
        wall: bool,
    },
}

/// What a picture took.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Rays from the camera.
    pub rays: u64,
    /// Rays to the sun.
    pub shadow_rays: u64,
    /// Points at which a tree was evaluated for a ray.
    pub evaluations: u64,
    /// Blocks of points in which that was done.
    pub blocks: u64,
    /// Points at which a tree was evaluated for quads that rays share.
    pub samples: u64,
    /// Regions whose bounds were found.
    pub bounds: u64,
    /// Rays that gave up.
    pub exhausted: u64,
}

/// A picture's rays and what they took.
#[derive(Clone, Debug, PartialEq)]
pub struct Traced {
    /// What is seen, row by row from the upper left, `samples` x `samples` for each pixel.
    pub seen: Vec<Seen>,
    /// What it took.
    pub counts: Counts,
}

/// Rays each way of a packet; packets are what threads share out.
const PACKET: usize = 32;
/// What a camera sees of several trees at once (ground, water, sand): for each ray the first that it meets.
///
/// `samples` rays each way go through every pixel. The same for any number of threads.
///
/// # Errors
/// A usage error for options out of range or an eye below the ground; or when the watch's job is cancelled. It begins
/// a stage "tracing", whose steps are packets of rays.
pub fn trace(trees: &[&Tree], lens: &Lens, samples: usize, options: &TraceOptions, watch: &Watch) -> Result<Traced> {
    check(trees, lens, samples, options)?;
    let (width, height) = lens.size();
    let (wide, high) = (width * samples, height * samples);
    let packets = (wide.div_ceil(PACKET), high.div_ceil(PACKET));
    watch.begin("tracing", (packets.0 * packets.1) as u64);
    let mut memory = Memory::default();
    let tracers: Vec<Tracer<'_>> = trees.iter().map(|tree| Tracer::new(tree, lens, options, &mut memory)).collect();
    let scene = Scene { tracers: &tracers, lens, samples, options };
    let made: Vec<(Vec<Seen>, Counts)> = (0..packets.0 * packets.1)
        .into_par_iter()
        .map_init(Memory::default, |memory, packet| {
            watch.advance(1)?;
            let (col, row) = (packet % packets.0 * PACKET, packet / packets.0 * PACKET);
            Ok(scene.packet([col, row], [PACKET.min(wide - col), PACKET.min(high - row)], memory))
        })
        .collect::<Result<_>>()?;
    let mut seen = vec![Seen::Sky(0.0); wide * high];
    let mut counts = Counts::default();
    for (packet, (part, own)) in made.iter().enumerate() {
        let (col, row) = (packet % packets.0 * PACKET, packet / packets.0 * PACKET);
        let across = PACKET.min(wide - col);
        for (line, values) in part.chunks(across).enumerate() {
            let at = (row + line) * wide + col;
            seen[at..at + across].copy_from_slice(values);
        }
        counts.add(own);
    }
    tracers.iter().for_each(|tracer| tracer.count(&mut counts));
    Ok(Traced { seen, counts })
}

fn check(trees: &[&Tree], lens: &Lens, samples: usize, options: &TraceOptions) -> Result<()> {
    if samples == 0 {
        return Err(Error::usage("a pixel has at least one sample"));
    }
    let TraceOptions { tolerance, reach_m, .. } = *options;
    if !(tolerance > 0.0 && tolerance <= 1.0) {
        return Err(Error::usage(format!(
            "the ground is met within a share of a pixel above 0 and at most 1, not {tolerance}"
        )));
    }
    if reach_m.is_some_and(|reach| !(reach > 0.0 && reach.is_finite())) {
        return Err(Error::usage("terrain is looked at up to a distance above 0 m"));
    }
    let Some(eye) = lens.eye() else { return Ok(()) };
    for tree in trees {
        if let Some(ground) = tree.elevation_m([eye[0], eye[1]]).filter(|ground| *ground > eye[2]) {
            return Err(Error::usage(format!(
                "the eye, at an elevation of {:.1} m, is below the ground, which is at {ground:.1} m there",
                eye[2]
            )));
        }
    }
    Ok(())
}

impl Counts {
    /// Adds what another part of a picture took.
    fn add(&mut self, other: &Self) {
        self.rays += other.rays;
        self.shadow_rays += other.shadow_rays;
        self.evaluations += other.evaluations;
        self.blocks += other.blocks;
        self.samples += other.samples;
        self.bounds += other.bounds;
        self.exhausted += other.exhausted;
    }
}
