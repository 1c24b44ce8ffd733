//! Times construction trees like those of table 1 of Génevaux et al. 2015: milliseconds for a regular mesh.
//!
//! `cargo run --release -- [TURNS]` prints a line of CSV for each scene: primitives, operators, kB, points, the median of
//! the turns in milliseconds, nanoseconds a point, and the share of points where the terrain is defined.

use orograph::construction::primitive::{Curve, Disc, FallOff, Profile, Skeleton};
use orograph::construction::{Builder, Detail, Lattice, NodeId, Tree, WeightRule};
use orograph::error::Result;
use orograph::noise::{NoiseKind, NoiseSum, Spectrum};
use orograph::rng::Rng;
use orograph::watch::Watch;
use std::time::Instant;

/// Discs of noise on a jittered grid that covers a square of `side_m`.
fn discs(builder: &mut Builder, rng: &mut Rng, side_m: f64, count: usize, octaves: usize) -> Result<Vec<NodeId>> {
    let across = (count as f64).sqrt().ceil();
    let step = side_m / across;
    let mut found = vec![];
    for i in 0..count {
        let (row, col) = ((i as f64 / across).floor(), i as f64 % across);
        let centre = [(col + rng.unit()) * step, (row + rng.unit()) * step];
        let kind = match i % 3 {
            0 => NoiseKind::Fractal,
            1 => NoiseKind::Turbulence,
            _ => NoiseKind::Ridged { offset: 1.0, gain: 2.0 },
        };
        let spectrum = Spectrum {
            octaves,
            amplitude: step / 8.0,
            wavelength: step,
            persistence: 0.5,
            lacunarity: 2.0,
            seed: rng.next_u64(),
        };
        let fall_off = FallOff::new(0.0, 1.5 * step)?;
        found.push(builder.leaf(Disc::new(
            centre,
            0.0,
            Some(NoiseSum::new(kind, spectrum.terms())),
            Some(fall_off),
        )?)?);
    }
    Ok(found)
}

/// A square of blended discs, with a road of so many pieces levelled into it.
fn scene(side_m: f64, count: usize, octaves: usize, road: usize) -> Result<Tree> {
    let mut builder = Builder::new();
    let mut rng = Rng::new(1);
    let hills = discs(&mut builder, &mut rng, side_m, count, octaves)?;
    let mut root = builder.blend(&hills)?;
    if road > 0 {
        let points: Vec<[f64; 3]> = (0..=road)
            .map(|i| {
                let along = i as f64 / road as f64;
                [along * side_m, side_m * (0.4 + 0.2 * rng.unit()), 0.0]
            })
            .collect();
        let profile = Profile::new(&[(0.0, 0.0)])?;
        let fall_off = FallOff::new(side_m / 200.0, side_m / 50.0)?;
        let curve = builder.leaf(Curve::new(Skeleton::through(&points, true)?, vec![(0.0, profile)], fall_off)?)?;
        root = builder.replace(root, curve, WeightRule::Keep)?;
    }
    builder.finish(root, Detail::default())
}

fn main() -> Result<()> {
    let turns: usize = std::env::args().nth(1).and_then(|n| n.parse().ok()).unwrap_or(5);
    println!("scene,primitives,operators,kB,points,ms,ns_per_point,defined");
    for (name, side_m, count, octaves, road, points) in [
        ("2 km", 2000.0, 70, 4, 0, 5e6_f64),
        ("2 km with a road", 2000.0, 77, 4, 20, 20e6),
        ("200 km", 200_000.0, 15, 6, 0, 20e6),
        ("0.6 km with a road", 600.0, 147, 3, 20, 80e6),
    ] {
        let tree = scene(side_m, count, octaves, road)?;
        let side = points.sqrt().round() as usize;
        let step = side_m / side as f64;
        let lattice = Lattice { x0: 0.0, y0: side_m, dx: step, dy: -step, cols: side, rows: side };
        let mut times = vec![];
        let mut defined = 0;
        for _ in 0..turns.max(1) {
            let start = Instant::now();
            let tiling = orograph::construction::Tiling::default();
            let values = tree.evaluate(&lattice, tiling, false, &Watch::default(), |point| {
                if point.weight.value >= 0.5 { point.elevation.value as f32 } else { f32::NAN }
            })?;
            times.push(start.elapsed().as_secs_f64() * 1e3);
            defined = values.iter().filter(|v| !v.is_nan()).count();
        }
        times.sort_by(f64::total_cmp);
        let (ms, cells) = (times[times.len() / 2], side * side);
        let (primitives, operators) = tree.counts();
        println!(
            "{name},{primitives},{operators},{:.1},{cells},{ms:.0},{:.1},{:.2}",
            tree.bytes() as f64 / 1024.0,
            ms * 1e6 / cells as f64,
            defined as f64 / cells as f64
        );
    }
    Ok(())
}
