//! How fast the codec is without files, container and threads: encodes and decodes the tiles of a raw raster, and
//! prints one line of JSON. `tools/bench/speed` runs it next to rivals.

use orograph::codec::{BandRule, Bound, Cells, TileShape, decode_tile, encode_tile};
use orograph::grid::SampleType;
use std::process::ExitCode;
use std::time::Instant;

const USAGE: &str = "usage: orograph-codec-speed RAW TYPE COLS ROWS SIDE ERROR REPS [NODATA]
    RAW     cells, row by row, little-endian
    TYPE    u8 i8 u16 i16 u32 i32 f32 f64
    SIDE    of the tiles, in cells; `orograph info` tells that of an archive
    ERROR   greatest error in stored values; 0: lossless
    REPS    how often all tiles are encoded and decoded; medians are told";

fn main() -> ExitCode {
    match run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("{error}");
            ExitCode::FAILURE
        }
    }
}

fn run() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let (raw, name, cols, rows, side, error, reps, nodata) = match &arguments[..] {
        [raw, name, cols, rows, side, error, reps] => (raw, name, cols, rows, side, error, reps, None),
        [raw, name, cols, rows, side, error, reps, nodata] => (raw, name, cols, rows, side, error, reps, Some(nodata)),
        _ => return Err(USAGE.into()),
    };
    let (cols, rows, side, reps): (usize, usize, usize, usize) =
        (cols.parse()?, rows.parse()?, side.parse()?, reps.parse()?);
    let sample = sample_of(name).ok_or(USAGE)?;
    let bound = match error.parse()? {
        0.0 => Bound::Lossless,
        error => Bound::MaxError(error),
    };
    let nodata = match nodata {
        Some(text) => Some(sample.bits_of(text.parse()?).ok_or("NODATA is no value of the type")?),
        None => None,
    };
    let rule = BandRule { sample, nodata, bound };
    let bytes = std::fs::read(raw)?;
    if bytes.len() != cols * rows * sample.bytes() || bytes.is_empty() || side == 0 || reps == 0 {
        return Err(format!("{raw} does not hold {cols} x {rows} cells, or SIDE or REPS is 0").into());
    }
    let tiles = cut(&bytes, sample, [cols, rows], side)?;
    drop(bytes);

    // The first tile once beforehand, so that nothing is timed that happens only once; in a fresh process its peak
    // of memory is that of encoding a tile.
    let (shape, cells) = &tiles[0];
    let rest = forget_peak().and_then(|()| peak_bytes());
    let encoded = encode_tile(cells, *shape, &rule)?;
    let encoding = peak_bytes().zip(rest).map(|(peak, rest)| peak.saturating_sub(rest));
    decode_tile(&encoded.segments.each_ref().map(Vec::as_slice), *shape, &rule, 0)?;

    let (mut encode_s, mut decode_s, mut size) = (Vec::new(), Vec::new(), 0);
    for _ in 0..reps {
        let begun = Moment::now();
        let encoded =
            tiles.iter().map(|(shape, cells)| encode_tile(cells, *shape, &rule)).collect::<Result<Vec<_>, _>>()?;
        encode_s.push(begun.seconds());
        size = encoded.iter().map(|tile| tile.bytes()).sum();
        let mut decoded_cells = 0;
        let begun = Moment::now();
        for ((shape, _), tile) in tiles.iter().zip(&encoded) {
            let segments = tile.segments.each_ref().map(Vec::as_slice);
            decoded_cells += decode_tile(&segments, *shape, &rule, 0)?.len();
        }
        decode_s.push(begun.seconds());
        if decoded_cells != cols * rows {
            return Err("other cells came back".into());
        }
    }
    let cells = (cols * rows) as f64;
    let memory = encoding.map_or("null".into(), |bytes| format!("{:.1}", bytes as f64 / tiles[0].0.cells() as f64));
    println!(
        "{{\"encode_mcells_per_s\": {:.3}, \"decode_mcells_per_s\": {:.3}, \"bits_per_cell\": {:.5}, \"bytes\": {size}, \
         \"tiles\": {}, \"encode_bytes_of_memory_per_cell\": {memory}}}",
        cells / 1e6 / median(encode_s),
        cells / 1e6 / median(decode_s),
        size as f64 * 8.0 / cells,
        tiles.len(),
    );
    Ok(())
}

fn sample_of(name: &str) -> Option<SampleType> {
    use SampleType::{F32, F64, I8, I16, I32, U8, U16, U32};
    let names =
        [("u8", U8), ("i8", I8), ("u16", U16), ("i16", I16), ("u32", U32), ("i32", I32), ("f32", F32), ("f64", F64)];
    names.into_iter().find(|(known, _)| *known == name).map(|(_, sample)| sample)
}

/// The tiles of a raster, row by row.
fn cut(
    bytes: &[u8],
    sample: SampleType,
    [cols, rows]: [usize; 2],
    side: usize,
) -> Result<Vec<(TileShape, Cells)>, String> {
    let size = sample.bytes();
    let mut tiles = Vec::new();
    for top in (0..rows).step_by(side) {
        for left in (0..cols).step_by(side) {
            let shape = TileShape { width: side.min(cols - left), height: side.min(rows - top) };
            let lines = bytes.chunks_exact(cols * size).skip(top).take(shape.height);
            let part: Vec<u8> =
                lines.flat_map(|line| &line[left * size..(left + shape.width) * size]).copied().collect();
            tiles.push((shape, Cells::from_le_bytes(sample, &part).ok_or("no whole cells")?));
        }
    }
    Ok(tiles)
}

/// A moment by the clock that tells least of what else the machine does.
enum Moment {
    /// Nanoseconds that this thread has had of a processor.
    Processor(u64),
    /// The time of day, where the system does not tell that.
    Clock(Instant),
}

impl Moment {
    fn now() -> Self {
        processor_ns().map_or_else(|| Self::Clock(Instant::now()), Self::Processor)
    }

    fn seconds(&self) -> f64 {
        match self {
            Self::Processor(begun) => (processor_ns().unwrap_or(*begun) - begun) as f64 / 1e9,
            Self::Clock(begun) => begun.elapsed().as_secs_f64(),
        }
    }
}

fn processor_ns() -> Option<u64> {
    // Linux brings its account up to date when a thread yields, otherwise only at its next tick.
    std::thread::yield_now();
    std::fs::read_to_string("/proc/thread-self/schedstat").ok()?.split_whitespace().next()?.parse().ok()
}

/// Lets the greatest memory be counted from now on.
fn forget_peak() -> Option<()> {
    std::fs::write("/proc/self/clear_refs", "5").ok()
}

/// The greatest memory that this process has had, where the system tells it.
fn peak_bytes() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    line.trim().trim_end_matches("kB").trim().parse::<u64>().ok().map(|kib| kib * 1024)
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    let middle = values.len() / 2;
    if values.len() % 2 == 1 { values[middle] } else { (values[middle - 1] + values[middle]) / 2.0 }
}
