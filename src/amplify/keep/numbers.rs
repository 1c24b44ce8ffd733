//! Tables of single precision in tiles, each as it is or by the container's codec, whichever takes fewer bytes: every bit
//! comes back. Heights become a few times smaller so; weights of regressions, most of whose bits are noise, do not.

use super::bytes::{Cursor, corrupt, put_u8, put_u32};
use crate::codec::{BandRule, Bound, Cells, SEGMENTS, TileShape, decode_tile, encode_tile};
use crate::error::{ErrorKind, Result};
use crate::grid::SampleType;
use rayon::prelude::*;

/// Rows and columns of a tile.
const SIDE: usize = 512;
/// Bytes of memory that a value takes: as it is decoded, and in its place.
const BYTES_PER_VALUE: u64 = 8;

/// What tells how a tile is kept.
const PLAIN: u8 = 0;
const CODED: u8 = 1;

const RULE: BandRule = BandRule { sample: SampleType::F32, nodata: None, bound: Bound::Lossless };

/// First row, first column, rows and columns of the tiles of a table, row by row.
fn tiles(rows: usize, cols: usize) -> impl Iterator<Item = [usize; 4]> {
    let part = |first: usize, all: usize| SIDE.min(all - first);
    (0..rows)
        .step_by(SIDE)
        .flat_map(move |row| (0..cols).step_by(SIDE).map(move |col| [row, col, part(row, rows), part(col, cols)]))
}

/// Appends a table with so many columns.
///
/// # Errors
/// When the codec has no room for a tile.
pub(super) fn put(out: &mut Vec<u8>, cols: usize, values: &[f32]) -> Result<()> {
    let tiles: Vec<[usize; 4]> = tiles(values.len() / cols.max(1), cols).collect();
    let encode = |&[row, col, height, width]: &[usize; 4]| {
        let lines = (row..row + height).flat_map(|row| &values[row * cols + col..][..width]);
        let own: Vec<f32> = lines.copied().collect();
        let plain: Vec<u8> = own.iter().flat_map(|value| value.to_le_bytes()).collect();
        let coded = encode_tile(&Cells::F32(own), TileShape { width, height }, &RULE)?;
        let mut bytes = vec![];
        if coded.bytes() + SEGMENTS * size_of::<u32>() < plain.len() {
            put_u8(&mut bytes, CODED);
            coded.segments.iter().for_each(|segment| put_u32(&mut bytes, segment.len() as u32));
            coded.segments.iter().for_each(|segment| bytes.extend(segment));
        } else {
            put_u8(&mut bytes, PLAIN);
            bytes.extend(plain);
        }
        Ok(bytes)
    };
    let encoded: Vec<Result<Vec<u8>>> = tiles.par_iter().map(encode).collect();
    for tile in encoded {
        out.extend(tile?);
    }
    Ok(())
}

/// The bytes of a tile.
enum Tile<'a> {
    Plain(&'a [u8]),
    Coded([&'a [u8]; SEGMENTS]),
}

impl<'a> Tile<'a> {
    /// Takes those of a tile of so many values.
    fn take(cursor: &mut Cursor<'a>, values: usize, what: &str) -> Result<Self> {
        if !cursor.flag(what)? {
            return cursor.bytes(values * size_of::<f32>(), what).map(Self::Plain);
        }
        let mut lengths = [0; SEGMENTS];
        for length in &mut lengths {
            *length = cursor.u32(what)? as usize;
        }
        let mut segments: [&[u8]; SEGMENTS] = [&[]; SEGMENTS];
        for (segment, length) in segments.iter_mut().zip(lengths) {
            *segment = cursor.bytes(length, what)?;
        }
        Ok(Self::Coded(segments))
    }

    fn values(&self, shape: TileShape, what: &str) -> Result<Vec<f32>> {
        let segments = match self {
            Self::Plain(bytes) => {
                return Ok(bytes.as_chunks().0.iter().map(|bytes| f32::from_le_bytes(*bytes)).collect());
            }
            Self::Coded(segments) => segments,
        };
        match decode_tile(segments, shape, &RULE, 0) {
            Ok(Cells::F32(values)) => Ok(values),
            Ok(_) => Err(corrupt(format!("{what} is not of single precision"))),
            Err(error) if error.kind() == ErrorKind::Corrupt => Err(corrupt(format!("{what}: {}", error.message()))),
            Err(error) => Err(error),
        }
    }
}

/// Takes a table of so many rows and columns.
///
/// # Errors
/// When the bytes are none, or there is no room for the values.
pub(super) fn take(cursor: &mut Cursor<'_>, [rows, cols]: [usize; 2], what: &str) -> Result<Vec<f32>> {
    let count = rows.checked_mul(cols).ok_or_else(|| corrupt(format!("{what}: {cols} x {rows} values")))?;
    cursor.reserve((count as u64).saturating_mul(BYTES_PER_VALUE))?;
    let mut found: Vec<([usize; 4], Tile<'_>)> = vec![];
    for place in tiles(rows, cols) {
        found.push((place, Tile::take(cursor, place[2] * place[3], what)?));
    }
    let decode =
        |(place, tile): &([usize; 4], Tile<'_>)| tile.values(TileShape { width: place[3], height: place[2] }, what);
    let decoded: Vec<Result<Vec<f32>>> = found.par_iter().map(decode).collect();
    let mut values = vec![0.0; count];
    for (([row, col, _, width], _), cells) in found.into_iter().zip(decoded) {
        for (line, own) in cells?.chunks_exact(width).enumerate() {
            values[(row + line) * cols + col..][..width].copy_from_slice(own);
        }
    }
    Ok(values)
}

/// As [`take`], of finite values only.
///
/// # Errors
/// As [`take`], and when a value is not finite.
pub(super) fn take_finite(cursor: &mut Cursor<'_>, size: [usize; 2], what: &str) -> Result<Vec<f32>> {
    let values = take(cursor, size, what)?;
    match values.iter().position(|value| !value.is_finite()) {
        None => Ok(values),
        Some(at) => Err(corrupt(format!("{what}: value {at} is {}", values[at]))),
    }
}
