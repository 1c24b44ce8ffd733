//! Times construction trees like those of table 1 of Génevaux et al. 2015: milliseconds for a regular mesh.
//!
//! `cargo run --release -- [TURNS [FIGURE]]` prints a line of CSV for each scene, once with few octaves and once with as
//! many as the mesh can show (`scenes.rs` says what was assumed): primitives, operators, kB and the paper's kB, points,
//! octaves of noise in reach of a point, threads, the least and the median time of the turns by the clock, the least
//! time of all processors together (on a machine that does nothing else the clock shows that over the number of
//! threads), the goal, the paper's time on its graphics card; then nanoseconds of processors a point, what `Tree::at`
//! takes for such points one by one in the same run, how many times that is more, and picoseconds an octave a point.
//!
//! The last column is a limit: the share of the time in which a processor could have done the fewest multiplications and
//! additions that this noise and its blend need ([`OCTAVE`], [`POINT`]), at the rate measured in the same run on numbers
//! in registers. 1 cannot be exceeded.

mod scenes;

use orograph::construction::{Lattice, Tiling};
use orograph::error::Result;
use orograph::watch::Watch;
use pulp::{Simd, WithSimd};
use scenes::{Built, ROWS, Row};
use std::hint::black_box;
use std::time::Instant;

/// Fewest multiplications and additions for an octave at a point: three each for A + q M, one each to add it.
const OCTAVE: f64 = 8.0;
/// The same for what else a point takes of about five discs: 1 for the distance, 4 for the weight, 3 to blend.
const POINT: f64 = 40.0;

/// So many rounds of multiplications and additions of numbers in registers.
struct Rounds(u32);

impl WithSimd for Rounds {
    type Output = f64;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> f64 {
        let factor = simd.splat_f64s(black_box(0.999_999_9));
        let term = simd.splat_f64s(black_box(1e-9));
        let numbers = black_box([1.0, 1.1, 1.2, 1.3, 1.4, 1.5]);
        let (mut f, mut t) = ([factor; 6], [term; 6]);
        for i in 0..6 {
            (f[i], t[i]) = (simd.splat_f64s(numbers[i]), simd.splat_f64s(numbers[i]));
        }
        for _ in 0..self.0 {
            for i in 0..6 {
                f[i] = simd.mul_f64s(f[i], factor);
                t[i] = simd.add_f64s(t[i], term);
            }
        }
        let sum = (0..6).fold(term, |sum, i| simd.add_f64s(sum, simd.add_f64s(f[i], t[i])));
        black_box(simd.reduce_sum_f64s(sum));
        f64::from(self.0) * 12.0 * (size_of::<S::f64s>() / size_of::<f64>()) as f64
    }
}

/// Multiplications and additions a second that one processor does with the widest vectors, on numbers in registers.
fn flops() -> f64 {
    let mut best = 0.0_f64;
    for _ in 0..5 {
        let start = processor_s();
        let count = pulp::Arch::new().dispatch(Rounds(40_000_000));
        best = best.max(count / (processor_s() - start));
    }
    best
}

/// Seconds of processors that all threads of this program have taken.
fn processor_s() -> f64 {
    let tasks = std::fs::read_dir("/proc/self/task").into_iter().flatten().flatten();
    let nanoseconds = |task: std::fs::DirEntry| -> Option<f64> {
        let text = std::fs::read_to_string(task.path().join("schedstat")).ok()?;
        text.split_whitespace().next()?.parse().ok()
    };
    tasks.filter_map(nanoseconds).sum::<f64>() / 1e9
}

/// A scene with its mesh, and the times of its turns: by the clock, and of processors.
type Timed<'r> = (&'r Row, Built, Lattice, Vec<(f64, f64)>);

/// Seconds for all points of a lattice: by the clock, and of processors.
fn time(built: &Built, lattice: &Lattice) -> Result<(f64, f64)> {
    let (start, before) = (Instant::now(), processor_s());
    let values = built.tree.evaluate(lattice, Tiling::default(), false, &Watch::default(), |point| {
        if point.weight.value >= 0.5 { point.elevation.value as f32 } else { f32::NAN }
    })?;
    let took = (start.elapsed().as_secs_f64(), processor_s() - before);
    black_box(values);
    Ok(took)
}

/// Seconds a point, one by one, and octaves a point, over every so many of a lattice's points.
fn plain(built: &Built, lattice: &Lattice) -> (f64, f64) {
    let step = (lattice.cols / 150).max(1);
    let places: Vec<[f64; 2]> = (0..lattice.rows)
        .step_by(step)
        .flat_map(|row| (0..lattice.cols).step_by(step).map(move |col| lattice.at(row, col)))
        .collect();
    let mut best = f64::INFINITY;
    for _ in 0..3 {
        let start = processor_s();
        let sum: f64 = places.iter().map(|&at| built.tree.at(at).elevation.value).sum();
        black_box(sum);
        best = best.min(processor_s() - start);
    }
    let octaves: usize = places.iter().map(|&at| built.octaves_at(at)).sum();
    (best / places.len() as f64, octaves as f64 / places.len() as f64)
}

fn main() -> Result<()> {
    let mut words = std::env::args().skip(1);
    let turns: usize = words.next().and_then(|n| n.parse().ok()).unwrap_or(5);
    let only = words.next();
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    let threads = std::env::var("RAYON_NUM_THREADS").ok().and_then(|n| n.parse().ok()).unwrap_or(threads);
    let flops = flops();
    eprintln!("{:.1} thousand million multiplications and additions a second and processor", flops / 1e9);
    println!(
        "figure,side_m,primitives,operators,kB,paper_kB,points,octaves,threads,least_ms,median_ms,processor_ms,goal_ms,paper_gpu_ms,\
         ns_per_point,one_by_one_ns,times_faster,ps_per_octave,limit_share"
    );
    let mut rows: Vec<Timed<'_>> = vec![];
    for row in ROWS.iter().filter(|row| only.as_deref().is_none_or(|figure| figure == row.figure)) {
        for fine in [false, true] {
            let side = row.points.sqrt().round() as usize;
            let step = row.side_m / side as f64;
            let lattice = Lattice { x0: 0.0, y0: row.side_m, dx: step, dy: -step, cols: side, rows: side };
            rows.push((row, row.scene(fine)?, lattice, vec![]));
        }
    }
    // In turns, so that what else the machine does hits all of them.
    for _ in 0..turns.max(1) {
        for (_, built, lattice, times) in &mut rows {
            times.push(time(built, lattice)?);
        }
    }
    for (row, built, lattice, times) in &mut rows {
        let sorted = |pick: fn(&(f64, f64)) -> f64| {
            let mut found: Vec<f64> = times.iter().map(pick).collect();
            found.sort_by(f64::total_cmp);
            found
        };
        let (wall, processor) = (sorted(|time| time.0), sorted(|time| time.1));
        let (least, median, processor_s) = (wall[0], wall[wall.len() / 2], processor[0]);
        let points = (lattice.cols * lattice.rows) as f64;
        let (single, octaves) = plain(built, lattice);
        let (primitives, operators) = built.tree.counts();
        println!(
            "{},{},{primitives},{operators},{:.1},{},{points},{octaves:.1},{threads},{:.0},{:.0},{:.0},{},{},{:.2},{:.0},{:.0},{:.0},{:.2}",
            row.figure,
            row.side_m,
            built.tree.bytes() as f64 / 1024.0,
            row.paper.1,
            least * 1e3,
            median * 1e3,
            processor_s * 1e3,
            row.goal_ms,
            row.paper.0,
            processor_s * 1e9 / points,
            single * 1e9,
            single * points / processor_s,
            processor_s * 1e12 / points / octaves,
            points * (octaves * OCTAVE + POINT) / flops / processor_s,
        );
    }
    Ok(())
}
