//! Cells for the tests: ground of many kinds, in every type, with and without voids.

use orograph::codec::{Cells, TileShape};
use orograph::grid::SampleType;

/// All types of cells.
pub const SAMPLES: [SampleType; 8] = [
    SampleType::U8,
    SampleType::I8,
    SampleType::U16,
    SampleType::I16,
    SampleType::U32,
    SampleType::I32,
    SampleType::F32,
    SampleType::F64,
];

/// What the ground looks like.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ground {
    /// Any bits: NaN and infinities too.
    Bits,
    /// Small heights without any order.
    Noise,
    /// Hills.
    Smooth,
    /// Hills with small noise on them.
    Rough,
    /// Hills in steps of ten.
    Terraces,
    /// One height.
    Constant,
    /// Two heights, in turns.
    Checkerboard,
    /// The least and the greatest number of the type, in turns.
    Extremes,
    /// The least and the greatest number, their neighbours, 0 and its neighbours, without any order.
    FullRange,
    /// A plane that leans from the least number to the greatest.
    Ramp,
    /// Few numbers far from each other.
    Few,
    /// Hills in tenths, hundredths or feet (whole ones in integers).
    Grid,
    /// Hills with what floats have beside numbers: NaN with payloads, infinities, -0.0, denormals.
    Specials,
    /// Hills of a millionth (of 1e-300 in doubles) and hills of a million (1e300).
    Scales,
    /// Hills in millionths, resampled to the nearest: cells that repeat their neighbours to the last bit.
    Resampled,
}

/// All kinds of ground.
pub const GROUNDS: [Ground; 15] = [
    Ground::Bits,
    Ground::Noise,
    Ground::Smooth,
    Ground::Rough,
    Ground::Terraces,
    Ground::Constant,
    Ground::Checkerboard,
    Ground::Extremes,
    Ground::FullRange,
    Ground::Ramp,
    Ground::Few,
    Ground::Grid,
    Ground::Specials,
    Ground::Scales,
    Ground::Resampled,
];

/// Numbers that look random and are the same each time.
pub fn noise(seed: u64) -> impl Iterator<Item = u64> {
    let mut state = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1;
    std::iter::repeat_with(move || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        state.wrapping_mul(0x2545_f491_4f6c_dd1d)
    })
}

/// A number from 0 to 1.
fn share(random: u64) -> f64 {
    (random >> 11) as f64 / (1u64 << 53) as f64
}

/// Hills of about a hundred units; only sums and products, so that every machine has the same ones.
fn hills(col: usize, row: usize, seed: u64) -> f64 {
    let mut height = 0.0;
    for (octave, random) in noise(seed).take(5).enumerate() {
        let period = (60 >> octave) as f64;
        // A wave of parabolas.
        let wave = |place: f64| {
            let x = (place / period).fract() * 2.0 - 1.0;
            4.0 * x * (1.0 - x.abs())
        };
        let (x, y) = (col as f64 + share(random) * 60.0, row as f64 + share(random.rotate_left(20)) * 60.0);
        height += 50.0 / f64::from(1 << octave) * wave(x + 0.3 * y) * wave(y + 100.0 - 0.2 * x);
    }
    height
}

impl Ground {
    /// Cells of a type in a shape.
    pub fn cells(self, sample: SampleType, shape: TileShape, seed: u64) -> Cells {
        let count = shape.cells();
        let mut random = noise(seed);
        if self == Self::Bits {
            let bytes: Vec<u8> = random.flat_map(u64::to_le_bytes).take(count * sample.bytes()).collect();
            return Cells::from_le_bytes(sample, &bytes).expect("a whole number of cells");
        }
        let constant = share(noise(seed + 1).next().unwrap_or(0)) * 200.0 - 100.0;
        let grid = [0.1, 0.01, 0.3048, 1.0 / 128.0][seed as usize % 4];
        let mut cell = |index: usize, least: f64, most: f64| {
            let (col, row) = (index % shape.width, index / shape.width);
            let random = random.next().unwrap_or(0);
            let is_float = matches!(sample, SampleType::F32 | SampleType::F64);
            let hills_at = |col, row| hills(col, row, seed);
            let hills = hills_at(col, row);
            match self {
                Self::Bits | Self::Noise => share(random) * 60.0 - 20.0,
                Self::Smooth => hills,
                Self::Rough => hills + share(random) * 5.0,
                Self::Terraces => (hills / 10.0).round() * 10.0,
                Self::Constant => constant,
                Self::Checkerboard => constant + if (col + row) % 2 == 0 { 0.0 } else { 13.0 },
                Self::Extremes => {
                    if (col + row) % 2 == 0 {
                        least
                    } else {
                        most
                    }
                }
                Self::FullRange => {
                    [least, most, least + 1.0, most - 1.0, 0.0, 1.0, -1.0, least / 2.0][(random >> 61) as usize]
                }
                Self::Ramp => {
                    let place = (col + row) as f64 / (shape.width + shape.height) as f64;
                    least * (1.0 - place) + most * place
                }
                Self::Few => [0.0, 3.0, 77.0, -100.0, 1000.0][random as usize % 5],
                Self::Grid => (hills / grid).round() * if is_float { grid } else { 1.0 },
                Self::Specials => match random % 24 {
                    0 => f64::NAN,
                    1 => f64::INFINITY,
                    2 => f64::NEG_INFINITY,
                    3 => -0.0,
                    4 => 0.0,
                    5 if sample == SampleType::F64 => 5e-324,
                    5 => 1e-45,
                    _ => hills,
                },
                Self::Scales if sample == SampleType::F64 => hills * if col > row { 1e-300 } else { 1e300 },
                Self::Resampled => {
                    let near = |place: usize| place * 5 / 8 + seed as usize % 7;
                    let hills = hills_at(near(col), near(row));
                    // Every eighth row has cells of its own.
                    let own = if row % 8 == 5 { share(random) } else { 0.0 };
                    (hills + own) * if is_float { 1.0 } else { 1e6 }
                }
                Self::Scales => hills * if col > row { 1e-6 } else { 1e6 },
            }
        };
        macro_rules! cells {
            ($variant:ident, $type:ty) => {
                Cells::$variant(
                    (0..count).map(|index| cell(index, <$type>::MIN as f64, <$type>::MAX as f64) as $type).collect(),
                )
            };
        }
        let mut cells = match sample {
            SampleType::U8 => cells!(U8, u8),
            SampleType::I8 => cells!(I8, i8),
            SampleType::U16 => cells!(U16, u16),
            SampleType::I16 => cells!(I16, i16),
            SampleType::U32 => cells!(U32, u32),
            SampleType::I32 => cells!(I32, i32),
            SampleType::F32 => cells!(F32, f32),
            SampleType::F64 => cells!(F64, f64),
        };
        // Not through a cast, which may make a payload another.
        match &mut cells {
            Cells::F32(values) => {
                let nans = values.iter_mut().filter(|value| value.is_nan()).enumerate();
                nans.for_each(|(k, value)| *value = f32::from_bits(0xff80_0001 + k as u32 % 3 * 0x1234));
            }
            Cells::F64(values) => {
                let nans = values.iter_mut().filter(|value| value.is_nan()).enumerate();
                nans.for_each(|(k, value)| *value = f64::from_bits(0x7ff0_0000_0000_0001 + k as u64 % 3 * 0x1234_5678));
            }
            _ => {}
        }
        cells
    }
}

/// The bits of a cell, zero-extended.
pub fn bits(cells: &Cells, index: usize) -> u64 {
    let size = cells.sample().bytes();
    let mut bytes = [0; 8];
    bytes[..size].copy_from_slice(&cells.to_le_bytes()[index * size..(index + 1) * size]);
    u64::from_le_bytes(bytes)
}

/// The cells with these bits where `holes` says so.
pub fn with_voids(cells: &Cells, bits: u64, mut holes: impl FnMut(usize) -> bool) -> Cells {
    let size = cells.sample().bytes();
    let mut bytes = cells.to_le_bytes();
    for (index, cell) in bytes.chunks_mut(size).enumerate() {
        if holes(index) {
            cell.copy_from_slice(&bits.to_le_bytes()[..size]);
        }
    }
    Cells::from_le_bytes(cells.sample(), &bytes).expect("a whole number of cells")
}
