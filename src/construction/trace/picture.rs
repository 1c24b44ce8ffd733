//! What is seen at each place of a picture.

use super::beam::Beam;
use super::camera::Lens;
use super::line::{Hit, Line};
use super::ray::Ray;
use super::tracer::{Memory, Tally, Tracer};
use crate::construction::area::Area;
use crate::construction::bounds::THRESHOLD;
use crate::construction::point::{Point, WIDTH};
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
    /// Bounds over quads of the plane that all rays share, down to a few pixels.
    #[default]
    Quads,
}

/// How to trace.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TraceOptions {
    /// How rays find the ground.
    pub strategy: Strategy,
    /// A ray has met the ground when it is no higher above it than this share of a pixel's width there.
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
    /// Blocks of up to 64 points in which that was done.
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
/// How far above the ground rays to the sun begin, in pixels.
const LIFT_PX: f64 = 1.0;
/// Their tolerance as a share of that of the camera's rays.
const SHADOW_TOLERANCE: f64 = 0.25;

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

/// What all packets share.
struct Scene<'s, 't> {
    tracers: &'s [Tracer<'t>],
    lens: &'s Lens,
    samples: usize,
    options: &'s TraceOptions,
}

/// Ground that a ray has met.
#[derive(Clone, Copy)]
struct Found {
    /// Index of the ray in its packet.
    index: usize,
    tree: usize,
    hit: Hit,
    ground: Point,
}

impl Scene<'_, '_> {
    /// The tolerance in heights of the terrain, which are smaller than those of the picture.
    fn tolerance(&self) -> f64 {
        self.options.tolerance / self.lens.exaggeration()
    }

    /// What rays of a packet see, row by row.
    fn packet(&self, [col, row]: [usize; 2], [wide, high]: [usize; 2], memory: &mut Memory) -> (Vec<Seen>, Counts) {
        let per = 1.0 / self.samples as f64;
        let rays: Vec<Ray> = (0..wide * high)
            .map(|i| {
                let (x, y) = ((col + i % wide) as f64, (row + i / wide) as f64);
                self.lens.ray((x + 0.5) * per, (y + 0.5) * per)
            })
            .collect();
        let mut tally = Tally::default();
        let mut nearest: Vec<Option<(usize, Hit)>> = vec![None; rays.len()];
        let mut hits = vec![None; rays.len()];
        let (cols, rows) = ([col, col + wide], [row, row + high]);
        let corner = |i: usize| self.lens.way(cols[i % 2] as f64 * per, rows[i / 2] as f64 * per);
        let beam = Beam { corners: std::array::from_fn(corner), pixel_m: self.lens.pixel(), from: rays[0].from_m };
        for (tree, tracer) in self.tracers.iter().enumerate() {
            // Rounding must not push a ray into the ground.
            let free = tracer.free(&beam, memory);
            let free = free - free.abs() * 1e-9;
            let line = |(i, (ray, nearest)): (usize, (&Ray, &Option<(usize, Hit)>))| {
                let mut line = Line::through(*ray, &tracer.domain, self.tolerance())?;
                let (x, y) = ((col + i % wide) as f64, (row + i / wide) as f64);
                line.from_m = line.from_m.max(free * self.lens.stretch((x + 0.5) * per, (y + 0.5) * per));
                let to_m = nearest.map_or(line.to_m, |(_, hit)| line.to_m.min(hit.t_m));
                (line.from_m <= to_m).then_some(Line { to_m, ..line })
            };
            let lines: Vec<Option<Line>> = rays.iter().zip(&nearest).enumerate().map(line).collect();
            tracer.follow(&lines, &mut hits, memory, &mut tally);
            for (nearest, hit) in nearest.iter_mut().zip(&hits) {
                if let Some(hit) = hit {
                    *nearest = Some((tree, *hit));
                }
            }
        }
        let mut found = self.ground(&rays, &nearest, memory, &mut tally);
        let (dark, shadow_rays) = self.shadows(&rays, &mut found, memory, &mut tally);
        let mut seen: Vec<Seen> =
            rays.iter().map(|ray| Seen::Sky(ray.direction[2] * self.lens.exaggeration())).collect();
        for (found, dark) in found.iter().zip(&dark) {
            let Found { tree, hit, ground, .. } = *found;
            let slope = if hit.wall { [0.0; 2] } else { [ground.elevation.dx, ground.elevation.dy] };
            let ray = &rays[found.index];
            let elevation_m = if hit.wall { ray.elevation_m(hit.t_m) } else { ground.elevation.value };
            seen[found.index] =
                Seen::Ground { tree, elevation_m, slope, distance_m: hit.t_m, sunlit: !dark, wall: hit.wall };
        }
        let Tally { evaluations, blocks, bounds, exhausted } = tally;
        let counts =
            Counts { rays: rays.len() as u64, shadow_rays, evaluations, blocks, samples: 0, bounds, exhausted };
        (seen, counts)
    }

    /// Evaluates the ground that rays have met, with its gradient.
    fn ground(
        &self,
        rays: &[Ray],
        nearest: &[Option<(usize, Hit)>],
        memory: &mut Memory,
        tally: &mut Tally,
    ) -> Vec<Found> {
        let mut found: Vec<Found> = vec![];
        for tree in 0..self.tracers.len() {
            let of_tree = |(index, nearest): (usize, &Option<(usize, Hit)>)| {
                nearest.filter(|(which, _)| *which == tree).map(|(tree, hit)| Found {
                    index,
                    tree,
                    hit,
                    ground: Point::NOTHING,
                })
            };
            let mut own: Vec<Found> = nearest.iter().enumerate().filter_map(of_tree).collect();
            self.evaluate(tree, rays, &mut own.iter_mut().collect::<Vec<_>>(), memory, tally);
            // A chord may lead away from the ground: then the place that was proved is taken.
            let mut astray: Vec<&mut Found> = own
                .iter_mut()
                .filter(|found| {
                    let (ray, hit) = (&rays[found.index], &found.hit);
                    let off = (ray.elevation_m(hit.t_m) - found.ground.elevation.value).abs();
                    let near = self.tolerance() * ray.pixel_m(hit.t_m);
                    hit.t_m != hit.proved_m && (off > near || found.ground.weight.value < THRESHOLD)
                })
                .collect();
            astray.iter_mut().for_each(|found| found.hit.t_m = found.hit.proved_m);
            self.evaluate(tree, rays, &mut astray, memory, tally);
            found.extend(own);
        }
        found
    }

    fn evaluate(&self, tree: usize, rays: &[Ray], found: &mut [&mut Found], memory: &mut Memory, tally: &mut Tally) {
        let Memory { scattered, places, points } = memory;
        for chunk in found.chunks_mut(WIDTH) {
            places.clear();
            places.extend(chunk.iter().map(|found| rays[found.index].at(found.hit.t_m)));
            let Some(plan) = self.tracers[tree].gradient(&Area::of(places)) else { continue };
            scattered.run(plan, places, points);
            tally.evaluations += chunk.len() as u64;
            tally.blocks += 1;
            chunk.iter_mut().zip(points.iter()).for_each(|(found, point)| found.ground = *point);
        }
    }

    /// Which of the places do not see the sun, and how many rays went there.
    fn shadows(&self, rays: &[Ray], found: &mut [Found], memory: &mut Memory, tally: &mut Tally) -> (Vec<bool>, u64) {
        let mut dark = vec![false; found.len()];
        let Some(sun) = self.options.sun else { return (dark, 0) };
        let factor = self.lens.exaggeration();
        let mut to_sun: Vec<Option<Ray>> = vec![None; found.len()];
        let mut count = 0;
        for (k, Found { index, hit, ground, .. }) in found.iter().enumerate() {
            let slope = &ground.elevation;
            let facing = sun[2] - factor * (slope.dx * sun[0] + slope.dy * sun[1]);
            if hit.wall || facing <= 0.0 {
                dark[k] = true;
                continue;
            }
            let [x, y] = rays[*index].at(hit.t_m);
            let pixel = rays[*index].pixel_m(hit.t_m);
            to_sun[k] = Some(Ray {
                origin: [x, y, slope.value + LIFT_PX * pixel],
                direction: [sun[0], sun[1], sun[2] / factor],
                footprint_m: pixel,
                growth: 0.0,
                from_m: 0.0,
            });
            count += 1;
        }
        let tolerance = self.tolerance() * SHADOW_TOLERANCE;
        let mut hits = vec![None; found.len()];
        for tracer in self.tracers {
            let line = |ray: &Option<Ray>| ray.and_then(|ray| Line::through(ray, &tracer.domain, tolerance));
            let lines: Vec<Option<Line>> = to_sun.iter().map(line).collect();
            tracer.follow(&lines, &mut hits, memory, tally);
            for (k, hit) in hits.iter().enumerate() {
                if hit.is_some() {
                    (dark[k], to_sun[k]) = (true, None);
                }
            }
        }
        (dark, count)
    }
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
