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
    // Noise, so that there is something to write.
    let noise = |index: u32| (index.wrapping_mul(2_654_435_761) ^ (index << 7)).wrapping_mul(2_246_822_519) >> 24;
    let cells = Cells::U8((0..64 * 64).map(|index| noise(index) as u8).collect());
    let mut chunk = encode_chunk(&description, tiling.place(0, 1), &cells).expect("encodes");
    let before = greatest();
    for number in 0..description.chunks() {
        chunk.place = tiling.place(number, 1);
        writer.push(&chunk).expect("is next");
    }
    let (_, summary) = writer.finish().expect("is written");
    let grown = greatest() - before;
    assert!(summary.bytes > 200 << 20, "{} bytes were written", summary.bytes);
    // 65,536 chunks: 1 MiB of lengths (2 while they are moved), their index, and the overview.
    assert!(grown < 8 << 20, "{grown} bytes of memory for {} bytes", summary.bytes);
}
