//! What the codec takes of memory, held against the estimate that jobs count with.
//!
//! Each case runs in a process of its own, whose greatest memory counts. To see the figures:
//! `cargo test --release --test codec_memory -- --nocapture`

#![cfg(all(target_os = "linux", feature = "program"))]
#![allow(clippy::print_stdout, reason = "the figures are for people, and for the process that asked for them")]

use orograph::codec::{BandRule, Bound, Cells};
use orograph::grid::SampleType;
use orograph::oro::{Band, Description, Place, encode_chunk};
use orograph::pipeline::memory::CODEC_BYTES_PER_CELL;
use std::process::Command;

const SIDE: usize = 1024;
/// Tells the process of a case which it is.
const CASE: &str = "OROGRAPH_MEMORY_CASE";

/// Name, cells by column and row, and bound.
type Case = (&'static str, fn(usize, usize) -> f64, SampleType, Bound);

const CASES: [Case; 11] = [
    ("i16, lossless", |x, y| (ground(x, y) * 2000.0).round(), SampleType::I16, Bound::Lossless),
    ("i16, 2", |x, y| (ground(x, y) * 2000.0).round(), SampleType::I16, Bound::MaxError(2.0)),
    (
        "i16 with voids",
        |x, y| if voids(x, y) { -1.0 } else { (ground(x, y) * 2000.0).round() },
        SampleType::I16,
        Bound::Lossless,
    ),
    (
        "i32 of full range",
        |x, y| noise(x, y).mul_add(4_294_967_295.0, -2_147_483_648.0).round(),
        SampleType::I32,
        Bound::Lossless,
    ),
    ("f32 on a grid", |x, y| (ground(x, y) * 200_000.0).round() / 100.0, SampleType::F32, Bound::Lossless),
    ("f32 on a grid, 0.05", |x, y| (ground(x, y) * 200_000.0).round() / 100.0, SampleType::F32, Bound::MaxError(0.05)),
    ("f32 of any value", |x, y| ground(x, y) * 2000.0, SampleType::F32, Bound::Lossless),
    ("f32 of any value, 0.05", |x, y| ground(x, y) * 2000.0, SampleType::F32, Bound::MaxError(0.05)),
    ("f64 of any value", |x, y| ground(x, y) * 2000.0, SampleType::F64, Bound::Lossless),
    ("f64 of any value, 1e-9", |x, y| ground(x, y) * 2000.0, SampleType::F64, Bound::MaxError(1e-9)),
    // Cells that break every promise of a grid are written out, which is tried, and then bit by bit.
    (
        "f64 of all sizes",
        |x, y| 10_f64.powf(noise(x, y).mul_add(600.0, -300.0)),
        SampleType::F64,
        Bound::MaxError(1e-3),
    ),
];

/// A number from 0 to 1 that looks like chance.
fn noise(x: usize, y: usize) -> f64 {
    let mut bits = (x as u64) << 32 | y as u64;
    for _ in 0..3 {
        bits = (bits ^ bits >> 29).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    }
    (bits >> 11) as f64 / (1_u64 << 53) as f64
}

/// Rough ground from 0 to 1.
fn ground(x: usize, y: usize) -> f64 {
    let (u, v) = (x as f64 / 90.0, y as f64 / 70.0);
    0.5 + 0.2 * (u.sin() + (0.7 * v).cos()) * (0.3 * u * v).sin() + 0.01 * noise(x, y)
}

fn voids(x: usize, y: usize) -> bool {
    noise(x / 40, y / 40) < 0.3
}

/// The greatest memory that this process has had, in bytes.
fn greatest() -> usize {
    let status = std::fs::read_to_string("/proc/self/status").expect("linux");
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:")).expect("the kernel says it");
    line.trim().trim_end_matches("kB").trim().parse::<usize>().expect("a number") * 1024
}

fn cells_of(value: fn(usize, usize) -> f64, sample: SampleType) -> Cells {
    // Nothing but the cells themselves, so that all that is added is the codec's.
    let mut cells = Cells::zeros(sample, SIDE * SIDE);
    macro_rules! fill {
        ($($variant:ident: $type:ty),*) => {
            match &mut cells {
                $(Cells::$variant(values) => {
                    for (index, cell) in values.iter_mut().enumerate() {
                        *cell = value(index % SIDE, index / SIDE) as $type;
                    }
                })*
                _ => unreachable!("no case has {sample:?}"),
            }
        };
    }
    fill!(I16: i16, I32: i32, F32: f32, F64: f64);
    cells
}

/// Runs a case, where this is the process of one; tells how many bytes a cell it took.
#[test]
fn one_case() {
    let Ok(wanted) = std::env::var(CASE) else { return };
    let (name, value, sample, bound) = CASES.into_iter().find(|(name, ..)| *name == wanted).expect("a case");
    let cells = cells_of(value, sample);
    let nodata = name.contains("voids").then(|| sample.bits_of(-1.0).expect("a value"));
    let band = Band { rule: BandRule { sample, nodata, bound }, ..Band::new(sample) };
    let description = Description { tile_side: SIDE, ..Description::new(SIDE, SIDE, vec![band]) };
    let before = greatest();
    let chunk = encode_chunk(&description, Place::default(), &cells).expect("encodes");
    let taken = (greatest() - before) as f64 / (SIDE * SIDE) as f64;
    println!("taken: {taken:.1} of {} bytes", chunk.bytes.len());
}

#[test]
fn estimate_is_kept() {
    let mut most = 0.0_f64;
    for (name, ..) in CASES {
        let program = std::env::current_exe().expect("this program");
        let output = Command::new(program).args(["one_case", "--exact", "--nocapture"]).env(CASE, name).output();
        let said = String::from_utf8(output.expect("starts").stdout).expect("text");
        let taken = said.split("taken: ").nth(1).and_then(|rest| rest.split(' ').next()?.parse::<f64>().ok());
        let taken = taken.unwrap_or_else(|| panic!("{name}: {said}"));
        println!("{name}: {taken:.1} bytes a cell");
        most = most.max(taken);
    }
    let estimate = CODEC_BYTES_PER_CELL as f64;
    assert!(most <= estimate, "encoding a tile takes {most:.1} bytes a cell, and jobs count with {estimate}");
    assert!(estimate < 2.0 * most, "jobs count with {estimate} bytes a cell, and encoding takes only {most:.1}");
}
