//! Files that every reader reads: what is in them.

use crate::case::{Case, SAMPLES, cells, noise};
use crate::parts::Parts;
use crate::sparse_vectors;
use crate::terrain::{heights, is_void};
use orograph::codec::{Bound, Cells};
use orograph::grid::SampleType;
use orograph::oro::{Band, Description};

/// Name, what it is about, and the file.
pub type Vector = (&'static str, &'static str, Vec<u8>);

/// Heights as cells of a type, scaled to use much of its range.
fn terrain(sample: SampleType, heights: &[f64]) -> Cells {
    macro_rules! scaled {
        ($variant:ident, $type:ty, $factor:expr, $offset:expr) => {
            Cells::$variant(heights.iter().map(|z| (z * $factor + $offset) as $type).collect())
        };
    }
    match sample {
        SampleType::U8 => scaled!(U8, u8, 0.1, 0.0),
        SampleType::I8 => scaled!(I8, i8, 0.1, -100.0),
        SampleType::U16 => scaled!(U16, u16, 10.0, 0.0),
        SampleType::I16 => scaled!(I16, i16, 1.0, -300.0),
        SampleType::U32 => scaled!(U32, u32, 1e6, 1e9),
        SampleType::I32 => scaled!(I32, i32, 1000.0, -1e6),
        SampleType::F32 => scaled!(F32, f32, 1.0, -100.0),
        SampleType::F64 => scaled!(F64, f64, 1.0, -100.0),
    }
}

fn case(width: usize, height: usize, tile_side: usize, bands: Vec<(Cells, Option<u64>, Bound)>) -> Case {
    let described = bands.iter().map(|(cells, nodata, bound)| {
        let mut band = Band::new(cells.sample());
        (band.rule.nodata, band.rule.bound) = (*nodata, *bound);
        band
    });
    let description = Description { tile_side, ..Description::new(width, height, described.collect()) };
    Case { description, bands: bands.into_iter().map(|(cells, ..)| cells).collect() }
}

fn file(width: usize, height: usize, tile_side: usize, cells: Cells, nodata: Option<u64>, bound: Bound) -> Vec<u8> {
    case(width, height, tile_side, vec![(cells, nodata, bound)]).write().0
}

fn one(side: (usize, usize), roughness: f64, sample: SampleType, bound: Bound) -> Vec<u8> {
    let (width, height) = side;
    file(width, height, 64, terrain(sample, &heights(width, height, 1, roughness)), None, bound)
}

fn with_voids(width: usize, height: usize, heights: &mut [f64], void: f64) {
    for (index, z) in heights.iter_mut().enumerate() {
        if is_void(width, height, index / width, index % width) {
            *z = void;
        }
    }
}

/// All of them.
pub fn vectors() -> Vec<Vector> {
    [
        types(),
        bounds(),
        voids(),
        patches(),
        copies(),
        shapes(),
        filters(),
        zones(),
        containers(),
        sparse_vectors::accepted(),
    ]
    .concat()
}

/// Heights resampled to the nearest: each is there once or more, next to itself.
pub fn resampled(width: usize, height: usize, seed: u64, by: f64) -> Vec<f64> {
    let source = heights(width, height, seed, 0.6);
    let near = |place: usize| (place as f64 * by) as usize;
    (0..width * height).map(|index| source[near(index / width) * width + near(index % width)] * 0.37).collect()
}

fn types() -> Vec<Vector> {
    let cm = |z: &f64| (z * 100.0).round() / 100.0;
    let z = heights(64, 48, 2, 0.4);
    let lossless = |sample| one((64, 48), 0.4, sample, Bound::Lossless);
    let bits = |sample, width: usize| file(width, 9, 64, cells_without_voids(sample, width * 9), None, Bound::Lossless);
    vec![
        ("u8", "u8, lossless", lossless(SampleType::U8)),
        ("i8", "i8, lossless", lossless(SampleType::I8)),
        ("u16", "u16, lossless", lossless(SampleType::U16)),
        ("i16", "i16, lossless", lossless(SampleType::I16)),
        ("u32", "u32, lossless", one((40, 24), 0.4, SampleType::U32, Bound::Lossless)),
        ("i32", "i32, lossless", lossless(SampleType::I32)),
        ("f32", "f32 on no grid, lossless: bits in order", one((40, 24), 0.4, SampleType::F32, Bound::Lossless)),
        ("f64", "f64 on no grid, lossless: words of 64 bits", one((24, 20), 0.4, SampleType::F64, Bound::Lossless)),
        (
            "f32-decimal",
            "f32 in centimetres, lossless: meaning grid",
            file(64, 48, 64, Cells::F32(z.iter().map(|z| cm(z) as f32).collect()), None, Bound::Lossless),
        ),
        (
            "f64-decimal",
            "f64 in centimetres, lossless: meaning grid",
            file(64, 48, 64, Cells::F64(z.iter().map(cm).collect()), None, Bound::Lossless),
        ),
        (
            "f32-feet",
            "f32 in whole US survey feet turned to metres, lossless: a grid with a numerator",
            file(
                64,
                48,
                64,
                Cells::F32(z.iter().map(|z| (z.round() * 1200.0 / 3937.0) as f32).collect()),
                None,
                Bound::Lossless,
            ),
        ),
        (
            "classes-u8",
            "few values far apart: meaning list",
            file(
                64,
                48,
                64,
                Cells::U8(z.iter().map(|z| [3, 41, 42, 99, 200][*z as usize / 90 % 5]).collect()),
                None,
                Bound::Lossless,
            ),
        ),
        (
            "classes-i16",
            "few values, some below 0: meaning list",
            file(
                64,
                48,
                64,
                Cells::I16(z.iter().map(|z| [-3000, -2999, 7, 4100][*z as usize / 90 % 4]).collect()),
                None,
                Bound::Lossless,
            ),
        ),
        ("tens", "i16 in steps of 10: factor", {
            let tens = z.iter().map(|z| (z / 10.0) as i16 * 10 - 5).collect();
            file(64, 48, 64, Cells::I16(tens), None, Bound::Lossless)
        }),
        ("u32-noise", "any u32: escapes, raw bits, words of 64 bits", bits(SampleType::U32, 20)),
        ("i32-noise", "any i32", bits(SampleType::I32, 20)),
        ("f64-noise", "any finite f64: 64 range bits", bits(SampleType::F64, 12)),
    ]
}

/// Cells of any bits that are numbers.
fn cells_without_voids(sample: SampleType, count: usize) -> Cells {
    match sample {
        SampleType::F64 => {
            Cells::F64(noise(9).map(f64::from_bits).filter(|value| value.is_finite()).take(count).collect())
        }
        _ => cells(sample, count, 9),
    }
}

fn bounds() -> Vec<Vector> {
    let bounded = |sample, error| one((80, 64), 0.6, sample, Bound::MaxError(error));
    let z = heights(80, 64, 4, 0.6);
    vec![
        ("u8-bound", "u8, max error 2", bounded(SampleType::U8, 2.0)),
        ("i8-bound-wide", "i8, max error 300: every tile is one value", bounded(SampleType::I8, 300.0)),
        ("u16-bound", "u16, max error 25", bounded(SampleType::U16, 25.0)),
        ("i16-bound-1", "i16, max error 1: step 3", bounded(SampleType::I16, 1.0)),
        ("i16-bound-10", "i16, max error 10.5: step 21", bounded(SampleType::I16, 10.5)),
        ("u32-bound", "u32, max error 10^7: errors are kept coarse", bounded(SampleType::U32, 1e7)),
        ("i32-bound", "i32, max error 2000", bounded(SampleType::I32, 2000.0)),
        ("f32-bound", "f32, max error 0.5: meaning fixed", bounded(SampleType::F32, 0.5)),
        ("f64-bound", "f64, max error 0.3: meaning fixed", bounded(SampleType::F64, 0.3)),
        ("f64-bound-fine", "f64, max error 10^-9: fixed with words of 64 bits", {
            one((24, 20), 0.4, SampleType::F64, Bound::MaxError(1e-9))
        }),
        ("f32-decimal-bound", "f32 in centimetres, max error 0.155: a grid with a bound", {
            let cells = Cells::F32(z.iter().map(|z| ((z * 100.0).round() / 100.0) as f32).collect());
            file(80, 64, 128, cells, None, Bound::MaxError(0.155))
        }),
        ("u32-noise-bound", "any u32, max error 1000", {
            file(20, 9, 64, cells(SampleType::U32, 180, 5), None, Bound::MaxError(1000.0))
        }),
    ]
}

fn voids() -> Vec<Vector> {
    let mut z = heights(100, 70, 5, 0.4);
    with_voids(100, 70, &mut z, -9999.0);
    let i16s = || Cells::I16(z.iter().map(|&z| z as i16).collect());
    let nan = |z: &f64| if *z < 0.0 { f64::NAN } else { (z * 10.0).round() / 10.0 };
    let nodata = Some(u64::from(-9999_i16 as u16));
    let rocky = heights(64, 64, 5, 0.4);
    let coin: Vec<i16> = noise(3).zip(&rocky).map(|(bits, &z)| if bits >> 63 == 1 { -1 } else { z as i16 }).collect();
    let all = vec![0x8000_u16 as i16; 64 * 64];
    vec![
        ("i16-voids", "voids with a nodata value, lossless, tiles with and without", {
            file(100, 70, 64, i16s(), nodata, Bound::Lossless)
        }),
        ("i16-voids-bound", "voids with a nodata value, max error 4", {
            file(100, 70, 128, i16s(), nodata, Bound::MaxError(4.0))
        }),
        ("f32-nan", "NaN without a nodata value; values in decimetres", {
            file(100, 70, 128, Cells::F32(z.iter().map(|z| nan(z) as f32).collect()), None, Bound::Lossless)
        }),
        ("f64-nan-bound", "NaN without a nodata value, max error 2", {
            file(100, 70, 128, Cells::F64(z.iter().map(nan).collect()), None, Bound::MaxError(2.0))
        }),
        ("f32-nodata", "voids of the nodata value of -9999", {
            let cells = Cells::F32(z.iter().map(|&z| z.round() as f32).collect());
            file(100, 70, 128, cells, Some(u64::from((-9999_f32).to_bits())), Bound::MaxError(1.0))
        }),
        ("f32-nan-beside-nodata", "NaN in a band whose nodata value is another: own void", {
            let cells = Cells::F32(z.iter().map(|z| nan(z) as f32).collect());
            file(100, 70, 128, cells, Some(u64::from((-9999_f32).to_bits())), Bound::MaxError(1.0))
        }),
        ("voids-everywhere", "every second cell or so is a void", {
            file(64, 64, 64, Cells::I16(coin), Some(0xffff), Bound::MaxError(3.0))
        }),
        ("voids-only", "nothing but voids", file(64, 64, 64, Cells::I16(all), Some(0x8000), Bound::Lossless)),
    ]
}

fn patches() -> Vec<Vector> {
    let z = heights(72, 64, 6, 0.4);
    let mut strange: Vec<f32> = z.iter().map(|z| z.round() as f32).collect();
    for (index, bits) in noise(4).take(40).enumerate() {
        let cell = bits as usize % strange.len();
        let values = [-0.0, f32::from_bits(0x7fc0_0123), f32::from_bits(0xff80_0001), f32::INFINITY, 1e-40];
        strange[cell] = values[index % 5];
    }
    strange[0] = -0.0;
    strange[72 * 8 + 4] = f32::NEG_INFINITY;
    let doubles = |strange: &[f32]| -> Vec<f64> {
        let wide = |v: &f32| if v.is_nan() { f64::from_bits(0x7ff8_0000_0000_0077) } else { f64::from(*v) };
        strange.iter().map(wide).collect()
    };
    let nodata = Some(u64::from((-1_i16) as u16));
    let near: Vec<i16> = z.iter().map(|&z| if z as i64 % 13 == 0 { -1 } else { (z as i16 - 400).max(-3) }).collect();
    vec![
        ("f32-patches", "-0.0, NaN of many kinds, infinities, a subnormal among whole numbers", {
            file(72, 64, 64, Cells::F32(strange.clone()), None, Bound::Lossless)
        }),
        ("f64-patches-bound", "the same in f64, max error 0.75", {
            file(72, 64, 128, Cells::F64(doubles(&strange)), None, Bound::MaxError(0.75))
        }),
        ("beside-nodata", "cells a unit from the nodata value, max error 2: none may become it", {
            file(72, 64, 128, Cells::I16(near), nodata, Bound::MaxError(2.0))
        }),
    ]
}

fn copies() -> Vec<Vector> {
    let lossless = |cells, nodata| file(64, 48, 64, cells, nodata, Bound::Lossless);
    let single = |by| resampled(64, 48, 14, by).iter().map(|&z| z as f32).collect::<Vec<_>>();
    let holed = |void: f64| {
        let mut z = resampled(64, 48, 15, 0.6);
        with_voids(64, 48, &mut z, void);
        z
    };
    // Rows that are walks of their own, in which a cell often stays.
    let (mut walk, mut z) = (vec![], 0_i32);
    for (index, bits) in noise(16).take(96 * 96).enumerate() {
        z = if index % 96 == 0 { (bits >> 40) as i32 } else { z + [0, (bits >> 54) as i32 - 512][bits as usize % 2] };
        walk.push(z);
    }
    vec![
        ("f32-resampled", "f32 resampled by 0.7: copies", lossless(Cells::F32(single(0.7)), None)),
        ("f32-doubled", "f32, two by two cells alike: copies, and a segment without residuals", {
            lossless(Cells::F32(single(0.5)), None)
        }),
        ("f32-resampled-voids", "f32 resampled, with NaN: copies beside voids", {
            lossless(Cells::F32(holed(f64::NAN).iter().map(|&z| z as f32).collect()), None)
        }),
        ("f64-resampled", "f64 resampled: copies in words of 64 bits", {
            lossless(Cells::F64(resampled(64, 48, 14, 0.8)), None)
        }),
        ("f64-resampled-voids", "f64 resampled, with a nodata value", {
            lossless(Cells::F64(holed(-9999.0)), Some((-9999_f64).to_bits()))
        }),
        ("i32-resampled-bound", "i32 resampled, max error 0.9, and so a step of 1: copies; with voids", {
            let cells = Cells::I32(holed(-1.0).iter().map(|z| (z * 1000.0) as i32).collect());
            file(64, 48, 64, cells, Some(u64::from(-1000_i32 as u32)), Bound::MaxError(0.9))
        }),
        ("i32-rows", "96 x 96 in rows that are walks and often stay: copies in serial passes", {
            file(96, 96, 128, Cells::I32(walk), None, Bound::Lossless)
        }),
    ]
}

fn shapes() -> Vec<Vector> {
    let line: Vec<i16> = heights(150, 1, 7, 0.5).iter().map(|&z| z as i16).collect();
    let lossless = |width, height, cells| file(width, height, 64, cells, None, Bound::Lossless);
    vec![
        ("one-cell", "1 x 1", lossless(1, 1, Cells::I16(vec![-5]))),
        ("one-void", "1 x 1 of the nodata value", file(1, 1, 64, Cells::U8(vec![9]), Some(9), Bound::Lossless)),
        ("two-by-two", "2 x 2", lossless(2, 2, Cells::U8(vec![10, 12, 11, 15]))),
        ("one-row", "150 x 1", lossless(150, 1, Cells::I16(line.clone()))),
        ("one-column", "1 x 150", lossless(1, 150, Cells::I16(line))),
        ("constant", "one value: no passes", lossless(64, 64, Cells::U16(vec![777; 64 * 64]))),
        ("odd", "61 x 37: planes of different sizes", one((61, 37), 0.4, SampleType::I16, Bound::MaxError(3.0))),
    ]
}

/// Four kinds of ground side by side: gravel, hills, terraced rocks, and waves along the rows.
pub fn patchwork(side: usize) -> Vec<i16> {
    let (smooth, rough) = (heights(side, side, 31, 0.0), heights(side, side, 32, 1.2));
    let ground = |(index, bits): (usize, u64)| {
        let (row, col) = (index / side, index % side);
        match (row / 64 + 2 * (col / 96)) % 4 {
            0 => 900 + (bits >> 60) as i16,
            1 => smooth[index] as i16,
            2 => (rough[index] / 64.0) as i16 * 24,
            _ => 1000 + ((row * 37 + col * 90) % 256) as i16,
        }
    };
    noise(33).take(side * side).enumerate().map(ground).collect()
}

fn zones() -> Vec<Vector> {
    let whole = patchwork(256);
    let mut holed: Vec<f64> = whole[..256 * 250].iter().map(|&z| f64::from(z)).collect();
    with_voids(256, 250, &mut holed, -1.0);
    let holed = Cells::I32(holed.iter().map(|&z| z as i32).collect());
    vec![
        ("zones", "256 x 256 of several kinds of ground: zones", {
            file(256, 256, 256, Cells::I16(whole), None, Bound::Lossless)
        }),
        ("zones-voids-bound", "zones beside voids in a tile that no block divides, max error 2", {
            file(256, 250, 256, holed, Some(0xffff_ffff), Bound::MaxError(2.0))
        }),
    ]
}

fn filters() -> Vec<Vector> {
    let tile = |side: usize, seed, roughness, error| {
        let z = heights(side, side, seed, roughness).iter().map(|&z| (z * 4.0) as i16).collect();
        file(side, side, side.div_ceil(64) * 64, Cells::I16(z), None, Bound::MaxError(error))
    };
    // Marsh on the left, waves on the right: two kinds of ground in one tile.
    let ground = |(index, bits): (usize, u64)| match (index / 128, index % 128) {
        (_, 0..64) => 900 + (bits >> 63) as i16,
        (row, col) => 1000 + ((row * 37 + col * 90) % 256) as i16,
    };
    let marsh = noise(22).take(128 * 128).enumerate().map(ground).collect();
    // Waves along the rows: a cell is best known from its neighbour to the left.
    let waves: Vec<u8> = (0..96 * 96).map(|index| ((index / 96 * 37 + index % 96 * 90) % 256) as u8).collect();
    let (mut walk, mut z) = (vec![], 0_i32);
    for (index, bits) in noise(12).take(96 * 96).enumerate() {
        z = if index % 96 == 0 { 0 } else { z + (bits >> 60) as i32 - 7 };
        walk.push(z);
    }
    vec![
        ("smooth", "128 x 128 of smooth terrain, max error 2", tile(128, 8, 0.0, 2.0)),
        ("rough", "128 x 128 of rough terrain, max error 200", tile(128, 9, 1.2, 200.0)),
        ("marsh-and-waves", "128 x 128, one half nearly flat, one of waves: two classes, lossless", {
            file(128, 128, 128, Cells::I16(marsh), None, Bound::Lossless)
        }),
        ("waves", "96 x 96 of waves that only filters of their own follow", {
            file(96, 96, 128, Cells::U8(waves), None, Bound::Lossless)
        }),
        ("rows", "96 x 96, every row a walk of its own: serial", {
            file(96, 96, 128, Cells::I32(walk), None, Bound::Lossless)
        }),
        ("eight-states", "320 x 320, max error 300: eight states in the last segment", tile(320, 10, 0.3, 300.0)),
    ]
}

fn containers() -> Vec<Vector> {
    let mut overview = case(
        64 * 5 + 6,
        64 * 4 - 20,
        64,
        vec![
            (
                Cells::I16(heights(326, 236, 11, 0.2).iter().map(|&z| z as i16).collect()),
                Some(5),
                Bound::MaxError(25.0),
            ),
            (Cells::U8((0..326 * 236).map(|index| (index / 326 / 64) as u8).collect()), None, Bound::Lossless),
        ],
    );
    overview.description.georeference.transform =
        Some(orograph::grid::GeoTransform([500_000.0, 30.0, 0.0, 5_100_000.0, 0.0, -30.0]));
    let file = overview.write().0;
    let mut damaged = Parts::of(&file);
    damaged.sections[0].1[3] ^= 1;
    let many = SAMPLES.iter().map(|&sample| {
        let bound = if sample == SampleType::F32 { Bound::MaxError(1.0) } else { Bound::Lossless };
        (terrain(sample, &heights(17, 11, 3, 0.3)), None, bound)
    });
    vec![
        ("overview", "20 tiles or more, and so a section OVER; two bands", file),
        ("overview-damaged", "R-022: a damaged section OVER is no reason to reject", damaged.file()),
        ("bands", "a band of each type", case(17, 11, 64, many.collect()).write().0),
        ("texts", "CRS, metadata, units, scale, offset, epoch, a rotated geotransform, points", {
            let mut talkative = Case::talkative();
            let z = heights(70, 3, 3, 0.3);
            talkative.bands = vec![terrain(SampleType::I16, &z), terrain(SampleType::F32, &z)];
            talkative.write().0
        }),
    ]
}
