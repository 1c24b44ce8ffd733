//! Bytes of a fuzzer <-> tiles.
//!
//! Bytes are read as they come; where they end early, zeros follow. Sizes are small most of the time, so that most
//! runs are fast.

use orograph::codec::{BandRule, Bound, Cells, SEGMENTS, TileShape};
use orograph::grid::SampleType;

const SAMPLES: [SampleType; 8] = crate::ground::SAMPLES;

/// Takes numbers from the front of bytes.
#[derive(Clone, Debug)]
pub struct Bytes<'a>(pub &'a [u8]);

impl<'a> Bytes<'a> {
    /// The next byte.
    pub fn byte(&mut self) -> u8 {
        self.number(1) as u8
    }

    /// The next bytes as a number, little-endian.
    pub fn number(&mut self, size: usize) -> u64 {
        let mut bytes = [0; 8];
        let taken = self.some(size);
        bytes[..taken.len()].copy_from_slice(taken);
        u64::from_le_bytes(bytes)
    }

    /// At most so many bytes.
    pub fn some(&mut self, count: usize) -> &'a [u8] {
        let (taken, rest) = self.0.split_at(count.min(self.0.len()));
        self.0 = rest;
        taken
    }
}

/// A side from a byte: up to 240 as it is, then in larger steps up to 960.
fn side(byte: u8) -> usize {
    let byte = usize::from(byte);
    if byte < 240 { byte + 1 } else { 240 + (byte - 239) * 45 }
}

/// What a decoder is given.
#[derive(Clone, Debug)]
pub struct TileInput {
    /// Type, nodata value and bound.
    pub rule: BandRule,
    /// Size of the tile.
    pub shape: TileShape,
    /// The level to decode.
    pub level: u8,
    /// The segments.
    pub segments: [Vec<u8>; SEGMENTS],
}

/// The rule and the shape at the front of an input, and three bits for the target.
pub fn read_rule(bytes: &mut Bytes<'_>) -> (BandRule, TileShape, u8) {
    let flags = bytes.byte();
    let sample = SAMPLES[usize::from(flags & 7)];
    let shape = TileShape { width: side(bytes.byte()), height: side(bytes.byte()) };
    let nodata = (flags & 64 != 0).then(|| bytes.number(sample.bytes()));
    let bound = match flags & 128 {
        0 => Bound::Lossless,
        _ => Bound::MaxError(f64::from_bits(bytes.number(8))),
    };
    (BandRule { sample, nodata, bound }, shape, flags >> 3 & 7)
}

/// The reverse of [`read_rule`], for shapes of at most 240 cells a side.
pub fn write_rule(rule: &BandRule, shape: TileShape, three_bits: u8) -> Vec<u8> {
    let sample = SAMPLES.iter().position(|&sample| sample == rule.sample).unwrap_or(0) as u8;
    let mut bytes = vec![sample | three_bits << 3, (shape.width - 1) as u8, (shape.height - 1) as u8];
    if let Some(nodata) = rule.nodata {
        bytes[0] |= 64;
        bytes.extend(&nodata.to_le_bytes()[..rule.sample.bytes()]);
    }
    if let Bound::MaxError(bound) = rule.bound {
        bytes[0] |= 128;
        bytes.extend(bound.to_le_bytes());
    }
    bytes
}

impl TileInput {
    /// From the bytes of a fuzzer.
    pub fn read(bytes: &[u8]) -> Self {
        let mut bytes = Bytes(bytes);
        let (rule, shape, level) = read_rule(&mut bytes);
        let lengths: [usize; SEGMENTS - 1] = std::array::from_fn(|_| bytes.number(2) as usize);
        let mut segments: [Vec<u8>; SEGMENTS] = Default::default();
        for (segment, length) in segments.iter_mut().zip(lengths.into_iter().chain([usize::MAX])) {
            *segment = bytes.some(length).to_vec();
        }
        Self { rule, shape, level, segments }
    }

    /// The bytes from which [`TileInput::read`] makes this.
    pub fn write(&self) -> Vec<u8> {
        let mut bytes = write_rule(&self.rule, self.shape, self.level);
        self.segments[..SEGMENTS - 1].iter().for_each(|segment| bytes.extend((segment.len() as u16).to_le_bytes()));
        bytes.extend(self.segments.concat());
        bytes
    }
}

/// Cells from the rest of an input: as they are, or as differences, or both in turns.
pub fn read_cells(bytes: &mut Bytes<'_>, rule: &BandRule, shape: TileShape, mode: u8) -> Cells {
    let (size, width) = (rule.sample.bytes(), shape.width);
    let source = bytes.0;
    let mut raw: Vec<u8> = Vec::with_capacity(shape.cells() * size);
    let at = |k: usize| source.get(k % source.len().max(1)).copied().unwrap_or(0);
    for index in 0..shape.cells() {
        let as_difference = match mode & 3 {
            0 => false,
            1 => true,
            2 => index % width % 2 == 0,
            _ => at(index) > 3,
        };
        if as_difference && index > 0 {
            let before = |index: usize| {
                let mut bytes = [0; 8];
                bytes[..size].copy_from_slice(&raw[index * size..(index + 1) * size]);
                u64::from_le_bytes(bytes)
            };
            let near = if index % width == 0 { before(index - width) } else { before(index - 1) };
            // Of floats the highest mantissa bits change.
            let shift = if size == 8 {
                40
            } else if mode & 4 != 0 {
                size as u32 * 2
            } else {
                0
            };
            let difference = (i64::from(at(index) as i8) >> 2) << shift;
            raw.extend(&near.wrapping_add(difference as u64).to_le_bytes()[..size]);
        } else {
            raw.extend((0..size).map(|k| at(index * size + k)));
        }
    }
    Cells::from_le_bytes(rule.sample, &raw).unwrap_or_else(|| Cells::zeros(rule.sample, shape.cells()))
}
