//! A writer keeps little, however much it writes. Alone in its program: the greatest memory of the process counts.

#![cfg(target_os = "linux")]

use orograph::codec::Cells;
use orograph::grid::SampleType;
use orograph::oro::{Band, Description, Writer, encode_chunk};

/// The greatest memory that this process has had, in bytes.
fn greatest() -> usize {
    let status = std::fs::read_to_string("/proc/self/status").expect("linux");
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:")).expect("the kernel says it");
    line.trim().trim_end_matches("kB").trim().parse::<usize>().expect("a number") * 1024
}

#[test]
fn memory_does_not_grow_with_the_file() {
    let mut description = Description::new(64 * 256, 64 * 256, vec![Band::new(SampleType::U8)]);
    description.tile_side = 64;
    let tiling = description.tiling();
    let mut writer = Writer::new(std::io::sink(), description.clone()).expect("begins");
    let mut chunk = encode_chunk(&description, tiling.place(0, 1), &Cells::U8(vec![7; 64 * 64])).expect("encodes");
    let before = greatest();
    for number in 0..description.chunks() {
        chunk.place = tiling.place(number, 1);
        writer.push(&chunk).expect("is next");
    }
    let (_, summary) = writer.finish().expect("is written");
    let grown = greatest() - before;
    assert!(summary.bytes > 300 << 20, "{} bytes were written", summary.bytes);
    // 65,536 chunks: 1 MiB of lengths (2 while they are moved), their index, and the overview.
    assert!(grown < 8 << 20, "{grown} bytes of memory for {} bytes", summary.bytes);
}
