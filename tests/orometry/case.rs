//! Random small grids.

use super::ground::{Ground, ground};
use orograph::grid::{AnyGrid, Elevations, Grid, Key, SampleType};
use orograph::units::LengthUnit;
use proptest::prelude::*;

/// How the elevations of a case are stored.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Storage {
    /// 16-bit integers in metres.
    Metres16,
    /// 16-bit integers in feet.
    Feet16,
    /// 16-bit depths: half metres counted downwards.
    Depths16,
    /// Single precision, with odd fractions.
    Single,
    /// Double precision, with odd fractions.
    Double,
}

/// A grid with everything that is asked of it.
#[derive(Clone, Debug)]
pub struct Case {
    /// Rows of the grid.
    pub rows: usize,
    /// Columns of the grid.
    pub cols: usize,
    /// Whole numbers that are higher where the ground is; `None` for voids.
    pub levels: Vec<Option<i16>>,
    /// Where the grid lies.
    pub ground: Ground,
    /// How the elevations are stored.
    pub storage: Storage,
    /// Threshold in levels.
    pub threshold: f64,
    /// Base in levels.
    pub base: Option<f64>,
    /// Whether voids are known to be low.
    pub nodata_is_sea: bool,
    /// Whether columns wrap although the metric knows nothing of it; isolation is not asked for then.
    pub wraps_anyway: bool,
}

impl Storage {
    /// How keys and metres belong together.
    pub fn elevations(self) -> Elevations {
        match self {
            Self::Metres16 => Elevations::metres(SampleType::I16),
            Self::Feet16 => Elevations {
                unit: LengthUnit { name: "ft".into(), metres: 0.3048 },
                ..Elevations::metres(SampleType::I16)
            },
            Self::Depths16 => Elevations { scale: -0.5, ..Elevations::metres(SampleType::I16) },
            Self::Single => Elevations::metres(SampleType::F32),
            Self::Double => Elevations::metres(SampleType::F64),
        }
    }

    /// Metres in a level.
    pub fn level_m(self) -> f64 {
        match self {
            Self::Metres16 => 1.0,
            Self::Feet16 => 0.3048,
            Self::Depths16 => 0.5,
            Self::Single => f64::from(0.37_f32),
            Self::Double => 0.37,
        }
    }

    /// The grid of levels in the type that this is stored in.
    pub fn grid(self, rows: usize, cols: usize, wraps: bool, levels: &[Option<i16>]) -> AnyGrid {
        let e = self.elevations();
        fn keys<K: Key>(levels: &[Option<i16>], key: impl Fn(i16) -> i64) -> Vec<K> {
            levels.iter().map(|level| level.map_or(K::VOID, |l| K::from_i64(key(l)))).collect()
        }
        match self {
            Self::Metres16 | Self::Feet16 => {
                AnyGrid::Narrow(Grid::new(rows, cols, wraps, keys(levels, |l| e.key_of(l))))
            }
            Self::Depths16 => AnyGrid::Narrow(Grid::new(rows, cols, wraps, keys(levels, |l| e.key_of(-l)))),
            Self::Single => {
                AnyGrid::Middle(Grid::new(rows, cols, wraps, keys(levels, |l| e.key_of(f32::from(l) * 0.37_f32))))
            }
            Self::Double => {
                AnyGrid::Wide(Grid::new(rows, cols, wraps, keys(levels, |l| e.key_of(f64::from(l) * 0.37))))
            }
        }
    }
}

impl Case {
    /// Whether the columns wrap.
    pub fn wraps(&self) -> bool {
        self.wraps_anyway || self.ground.wraps()
    }

    /// The grid in its own storage.
    pub fn grid(&self) -> AnyGrid {
        self.storage.grid(self.rows, self.cols, self.wraps(), &self.levels)
    }

    /// Threshold in metres.
    pub fn min_prominence_m(&self) -> f64 {
        self.threshold * self.storage.level_m()
    }

    /// Base level in metres.
    pub fn base_level_m(&self) -> Option<f64> {
        self.base.map(|base| base * self.storage.level_m())
    }

    /// Whether isolation makes sense.
    pub fn isolation(&self) -> bool {
        !self.wraps_anyway
    }
}

/// Pseudo-random numbers of a seed (splitmix64).
#[derive(Clone)]
pub struct Dice(pub u64);

impl Dice {
    /// The next 64 bits.
    pub fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// A number from 0 to `n - 1`.
    pub fn below(&mut self, n: u64) -> u64 {
        self.next() % n
    }
}

/// Hills on a plain, cut into whole levels: few levels make plateaus and long ties.
fn hills(rows: usize, cols: usize, seed: u64, steps: i16, void_percent: u64) -> Vec<Option<i16>> {
    let mut dice = Dice(seed);
    let count = 1 + dice.below(1 + (rows * cols) as u64 / 12);
    let hills: Vec<(f64, f64, f64, f64)> = (0..count)
        .map(|_| {
            let row = dice.below(rows as u64) as f64;
            let col = dice.below(cols as u64) as f64;
            (row, col, 0.2 + dice.below(100) as f64 / 100.0, 1.0 + dice.below(50) as f64 / 10.0)
        })
        .collect();
    // Voids in rectangles, as in real data, besides single ones.
    let mut voids = vec![false; rows * cols];
    while voids.iter().filter(|&&v| v).count() as u64 * 100 < void_percent * (rows * cols) as u64 {
        let (row, col) = (dice.below(rows as u64) as usize, dice.below(cols as u64) as usize);
        let (high, wide) = (1 + dice.below(3) as usize, 1 + dice.below(3) as usize);
        for r in row..(row + high).min(rows) {
            for c in col..(col + wide).min(cols) {
                voids[r * cols + c] = true;
            }
        }
    }
    (0..rows * cols)
        .map(|i| {
            let (row, col) = ((i / cols) as f64, (i % cols) as f64);
            let mut height = dice.below(100) as f64 / 600.0;
            for &(r, c, tall, wide) in &hills {
                let away = (row - r).hypot(col - c) / wide;
                height += tall * (-away * away).exp();
            }
            (!voids[i]).then(|| (height * f64::from(steps)) as i16 - 1)
        })
        .collect()
}

/// Noise of few or many levels: saddles of many ways, ties everywhere.
fn noise(rows: usize, cols: usize, seed: u64, steps: i16, void_percent: u64) -> Vec<Option<i16>> {
    let mut dice = Dice(seed);
    (0..rows * cols)
        .map(|_| {
            let level = dice.below(steps as u64) as i16 - steps / 4;
            (dice.below(100) >= void_percent).then_some(level)
        })
        .collect()
}

/// Rows and columns, mostly few, with single rows, single columns and single cells among them.
fn small() -> impl Strategy<Value = (usize, usize)> {
    prop_oneof![
        6 => (1_usize..=9, 1_usize..=9),
        3 => (1_usize..=18, 1_usize..=18),
        1 => (Just(1_usize), 1_usize..=70),
        1 => (1_usize..=70, Just(1_usize)),
        1 => (Just(2_usize), 1_usize..=70),
    ]
}

/// Rows and columns around those of a large internal tile.
fn large() -> impl Strategy<Value = (usize, usize)> {
    (60_usize..=70, 60_usize..=70)
}

/// Levels of a grid: drawn cell by cell where it is small, so that failures shrink to a few telling cells.
fn levels(rows: usize, cols: usize) -> BoxedStrategy<Vec<Option<i16>>> {
    let steps = prop_oneof![Just(2_i16), Just(3), Just(5), Just(12), Just(400)];
    let void_percent = prop_oneof![3 => Just(0_u64), 1 => Just(4), 1 => Just(25), 1 => Just(70)];
    let seeded = (any::<u64>(), steps, void_percent, any::<bool>()).prop_map(move |(seed, steps, voids, smooth)| {
        if smooth { hills(rows, cols, seed, steps, voids) } else { noise(rows, cols, seed, steps, voids) }
    });
    if rows * cols > 30 {
        return seeded.boxed();
    }
    let cell = |steps: i16| prop_oneof![5 => (0..steps).prop_map(Some), 1 => Just(None)];
    let drawn = (2_i16..=6).prop_flat_map(move |steps| proptest::collection::vec(cell(steps), rows * cols));
    prop_oneof![drawn, seeded].boxed()
}

/// Small grids of every kind.
pub fn small_case() -> impl Strategy<Value = Case> {
    case(small())
}

/// Large grids of every kind.
pub fn large_case() -> impl Strategy<Value = Case> {
    case(large())
}

/// Grids of a shape.
fn case(shape: impl Strategy<Value = (usize, usize)>) -> impl Strategy<Value = Case> {
    let storage = prop_oneof![
        4 => Just(Storage::Metres16),
        1 => Just(Storage::Feet16),
        1 => Just(Storage::Depths16),
        1 => Just(Storage::Single),
        1 => Just(Storage::Double),
    ];
    // Thresholds between the levels too, and exactly at them.
    let threshold = prop_oneof![3 => Just(0.0), 3 => Just(1.0), 1 => Just(1.5), 2 => Just(3.0), 1 => Just(40.0)];
    // A base level needs a positive threshold: peaks below the base have no prominence to be ordered by.
    let base = prop_oneof![4 => Just(None), 1 => Just(Some(0.5)), 1 => Just(Some(2.0))];
    let flags = (any::<bool>(), prop_oneof![7 => Just(false), 1 => Just(true)]);
    (shape, ground(), storage, threshold, base, flags).prop_flat_map(
        |((rows, cols), ground, storage, threshold, base, (nodata_is_sea, wraps_anyway))| {
            levels(rows, cols).prop_map(move |levels| Case {
                rows,
                cols,
                levels,
                ground,
                storage,
                threshold,
                base: base.filter(|_| threshold > 0.0),
                nodata_is_sea,
                wraps_anyway: wraps_anyway && matches!(ground, Ground::Plane(_)),
            })
        },
    )
}

/// A picture of a grid of levels, for messages.
pub fn picture(cols: usize, levels: &[Option<i16>]) -> String {
    levels
        .chunks(cols)
        .map(|row| {
            let cells: Vec<String> = row.iter().map(|l| l.map_or_else(|| "  X".into(), |l| format!("{l:3}"))).collect();
            cells.join(" ") + "\n"
        })
        .collect()
}
