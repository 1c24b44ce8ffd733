//! A packet of rays: followed to the ground, which is then evaluated with its gradient, and from there to the sun.

use super::beam::Beam;
use super::camera::Lens;
use super::line::{Hit, Line};
use super::picture::{Counts, Seen, TraceOptions};
use super::ray::Ray;
use super::sweep::Goal;
use super::tracer::{Memory, Tally, Tracer};
use crate::construction::area::Area;
use crate::construction::bounds::THRESHOLD;
use crate::construction::point::{Point, WIDTH};

/// How far above the ground rays to the sun begin, in pixels.
const LIFT_PX: f64 = 1.0;
/// Their tolerance as a share of that of the camera's rays.
const SHADOW_TOLERANCE: f64 = 0.25;

/// What all packets share.
pub(super) struct Scene<'s, 't> {
    pub(super) tracers: &'s [Tracer<'t>],
    pub(super) lens: &'s Lens,
    pub(super) samples: usize,
    pub(super) options: &'s TraceOptions,
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
    pub(super) fn packet(
        &self,
        [col, row]: [usize; 2],
        [wide, high]: [usize; 2],
        memory: &mut Memory,
    ) -> (Vec<Seen>, Counts) {
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
            let line = |i: usize| {
                let mut line = Line::through(rays[i], &tracer.domain, self.tolerance())?;
                let (x, y) = ((col + i % wide) as f64, (row + i / wide) as f64);
                line.from_m = line.from_m.max(free * self.lens.stretch((x + 0.5) * per, (y + 0.5) * per));
                line.to_m = nearest[i].map_or(line.to_m, |(_, hit)| line.to_m.min(hit.t_m));
                (line.from_m <= line.to_m).then_some(line)
            };
            let lines: Vec<Option<Line>> = (0..rays.len()).map(line).collect();
            tracer.follow(&lines, Goal::Ground, &mut hits, memory, &mut tally);
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
                    ground: hit.ground.unwrap_or(Point::NOTHING),
                })
            };
            let mut own: Vec<Found> = nearest.iter().enumerate().filter_map(of_tree).collect();
            let mut unknown: Vec<&mut Found> = own.iter_mut().filter(|found| found.hit.ground.is_none()).collect();
            self.evaluate(tree, rays, &mut unknown, memory, tally);
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
            tracer.follow(&lines, Goal::Shade, &mut hits, memory, tally);
            for (k, hit) in hits.iter().enumerate() {
                if hit.is_some() {
                    (dark[k], to_sun[k]) = (true, None);
                }
            }
        }
        (dark, count)
    }
}
