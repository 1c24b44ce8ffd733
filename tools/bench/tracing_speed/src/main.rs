//! Traces pictures of 1920 x 1080 pixels of construction trees: evaluations and milliseconds by strategy.
//!
//! `cargo run --release -- DEM.tif [TURNS] [STRATEGY] [FOLDER]` prints a line of CSV for each scene and strategy, or for
//! one strategy: evaluations for rays (of the ground with its gradient, too), how many of them a block held, samples
//! that rays share, regions bounded, rays to the sun, each per ray; rays that gave up, and the median of the turns in
//! milliseconds. The strategies of the papers follow the rays of every 12th row and column only, with the tolerance of
//! the whole picture, and their time is multiplied by 144. With a folder the pictures are written there.

use orograph::construction::primitive::{
    Curve, Disc, FallOff, Image, Interpolation, Mapping, Profile, Samples, Skeleton,
};
use orograph::construction::trace::{Camera, Counts, Strategy, TraceOptions};
use orograph::construction::{Area, Builder, Detail, NodeId, Tree, WeightRule};
use orograph::error::Result;
use orograph::grid::{HeightRows, Key};
use orograph::io::raster::{RasterOptions, RasterSource};
use orograph::noise::{NoiseKind, NoiseSum, Spectrum};
use orograph::pipeline::view::{Layer, RenderOptions, render, sights};
use orograph::rng::Rng;
use orograph::watch::Watch;
use std::path::Path;
use std::time::Instant;

/// The papers' ways are followed for every so manieth row and column.
const THIN: usize = 12;

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

/// A raster of geographic cells as one image node, laid out in metres at its middle latitude.
fn image(path: &Path) -> Result<(Tree, [f64; 2], f64)> {
    let watch = Watch::default();
    let dem = RasterSource::open(path, &RasterOptions::default())?.read(&watch)?;
    let (rows, cols) = orograph::with_grid!(&dem.grid, grid => (grid.rows(), grid.cols()));
    let heights_m: Vec<f64> = orograph::with_grid!(&dem.grid, grid => {
        (0..rows * cols).map(|i| dem.elevations.elevation_m(grid.cells()[i].to_i64())).collect()
    });
    let highest = heights_m.iter().copied().fold(0.0, f64::max);
    // 3 arc seconds at 36.5 degrees north.
    let (dx, dy) = (74.6, 92.5);
    let side = [(cols - 1) as f64 * dx, (rows - 1) as f64 * dy];
    let samples = Samples::read(&HeightRows::new(cols, heights_m, None), None)?;
    let mapping = Mapping::on_box(Area::of(&[[0.0, 0.0], side]))?;
    let mut builder = Builder::new();
    let root = builder.leaf(Image::new(samples, mapping, Interpolation::Bicubic, 0.0, (1.0, 0.0))?)?;
    Ok((builder.finish(root, Detail::default())?, side, highest))
}

fn main() -> Result<()> {
    let mut args = std::env::args().skip(1);
    let dem = args.next().unwrap_or_else(|| "../../../fixtures/jacksboro.tif".into());
    let turns: usize = args.next().and_then(|n| n.parse().ok()).unwrap_or(3);
    let only = args.next().filter(|name| name != "all");
    let folder = args.next();
    let (real, [wide, high], top) = image(Path::new(&dem))?;
    let scenes = [
        ("2 km", scene(2000.0, 70, 4, 0)?, Camera::towards([1000.0, -600.0, 500.0], [1000.0, 1000.0, 0.0], 45.0)),
        (
            "2 km with a road",
            scene(2000.0, 77, 4, 20)?,
            Camera::towards([-200.0, -200.0, 400.0], [1000.0, 1000.0, 0.0], 45.0),
        ),
        (
            "200 km",
            scene(200_000.0, 15, 6, 0)?,
            Camera::towards([100_000.0, -60_000.0, 60_000.0], [100_000.0, 100_000.0, 0.0], 45.0),
        ),
        (
            "DEM",
            real,
            Camera::towards([wide * 0.5, -0.1 * high, top + 2000.0], [wide * 0.5, high * 0.4, 0.0], 45.0)
                .exaggerated(2.0),
        ),
    ];
    println!("scene,strategy,shadows,evaluations,points_per_block,samples,bounds,sun_rays,gave_up,ms");
    for (name, tree, camera) in &scenes {
        let layers = [Layer { tree, colour: None }];
        for (label, strategy, shadows) in [
            ("quads", Strategy::Quads, false),
            ("quads", Strategy::Quads, true),
            ("segment", Strategy::Segment, false),
            ("accelerated", Strategy::Accelerated, false),
            ("sphere", Strategy::Sphere, false),
        ] {
            if only.as_deref().is_some_and(|name| name != label) {
                continue;
            }
            let thin = if strategy == Strategy::Quads { 1 } else { THIN };
            let usual = TraceOptions::default();
            let tolerance = usual.tolerance / thin as f64;
            let trace = TraceOptions { strategy, tolerance, max_steps: 200_000, ..usual };
            let options = RenderOptions {
                width: 1920 / thin,
                height: 1080 / thin,
                shadows,
                haze_m: None,
                trace,
                ..RenderOptions::new(*camera)
            };
            let mut times = vec![];
            let mut counts = Counts::default();
            for _ in 0..if thin == 1 { turns } else { 1 } {
                let start = Instant::now();
                counts = sights(&layers, &options, &Watch::default())?.1;
                times.push(start.elapsed().as_secs_f64() * 1e3);
            }
            times.sort_by(f64::total_cmp);
            let ms = times[times.len() / 2] * (thin * thin) as f64;
            let per_ray = |count: u64| count as f64 / counts.rays as f64;
            println!(
                "{name},{label},{shadows},{:.2},{:.1},{:.2},{:.3},{:.2},{},{ms:.0}",
                per_ray(counts.evaluations),
                counts.evaluations as f64 / counts.blocks.max(1) as f64,
                per_ray(counts.samples),
                per_ray(counts.bounds),
                per_ray(counts.shadow_rays),
                counts.exhausted
            );
            if let (Some(folder), true) = (&folder, shadows) {
                let picture = render(&layers, &options, &Watch::default())?;
                let path = Path::new(folder).join(format!("{}.png", name.replace(' ', "_")));
                std::fs::write(&path, picture.png).map_err(|e| {
                    orograph::error::Error::new(orograph::error::ErrorKind::Output, e.to_string()).at_path(&path)
                })?;
            }
        }
    }
    Ok(())
}
