//! Trains the codec's table set: `orograph-train OLD.bin NEW.bin DEM.oro...`, of lossless containers.
//!
//! The residuals of each pass belong to one of two families of distributions, whichever makes them cheaper with the
//! best shift; each family's distributions are what its passes had. A few rounds of that, then filters by clustering
//! of those that were fitted, and weights of errors by their medians.

use orograph::codec::training::{Fitted, observe};
use orograph::codec::{BandRule, Bound, Cells, TileShape};
use orograph::oro::{Place, Reader};
use std::collections::BTreeMap;

const SYMBOLS: usize = 64;
const ESCAPE: usize = 63;
const CENTRE: usize = 31;
const TOTAL: f64 = 16_384.0;
const BINS: usize = 36;
const KINDS: usize = 8;
const PLAIN: usize = KINDS * BINS;
const SHAPES: usize = 2;
const TAPS: usize = 26;
const VARIANTS: usize = 4;
const ROUNDS: usize = 8;

type Distribution = Vec<f64>;
/// Frequencies by family, table and symbol.
type Set = Vec<Vec<Distribution>>;

/// Residuals of one pass: how often each symbol of each plain table occurred.
struct Spread {
    counts: Vec<(usize, Distribution)>,
    /// Large passes count for more, but not as much more as they are larger.
    weight: f64,
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let usage = "orograph-train OLD.bin NEW.bin DEM.oro...";
    let (old, new) = (arguments.next().ok_or(usage)?, arguments.next().ok_or(usage)?);
    let (mut spreads, mut fitted) = (Vec::new(), Vec::new());
    for path in arguments {
        watch(&path, &mut spreads, &mut fitted)?;
    }
    let mut set = read_set(&std::fs::read(old)?);
    for round in 0..ROUNDS {
        let chosen = assign(&set, &spreads, round == 0);
        set = estimate(&set, &spreads, &chosen);
    }
    let mut bytes: Vec<u8> = set.iter().flatten().flatten().flat_map(|&freq| (freq as u16).to_le_bytes()).collect();
    for serial in [false, true] {
        for pass in 0..3 {
            let filters = cluster(&fitted, pass, serial);
            for (variant, filter) in filters.iter().enumerate() {
                bytes.extend(filter.iter().flat_map(|weight| (weight.round() as i16).to_le_bytes()));
                bytes.extend(median_codes(&fitted, pass, serial, variant));
            }
        }
    }
    std::fs::write(new, bytes)?;
    Ok(())
}

/// Codes the first tiles of a DEM with several bounds, both ways.
fn watch(path: &str, spreads: &mut Vec<Spread>, fitted: &mut Vec<Fitted>) -> Result<(), Box<dyn std::error::Error>> {
    let reader = Reader::open(std::fs::read(path)?)?;
    let description = reader.description().clone();
    let tiling = description.tiling();
    let rule = description.bands[0].rule;
    let mut tiles = 0;
    for row in 0..tiling.down() {
        for col in 0..tiling.across() {
            let shape = tiling.shape(col, row);
            if shape.cells() < 100_000 || tiles == 3 {
                continue;
            }
            tiles += 1;
            let cells = reader.tile(Place { col, row, band: 0 }, 0)?;
            let bounds: &[f64] = match cells {
                Cells::F32(_) | Cells::F64(_) => &[0.0, 0.01, 0.05, 0.2, 0.5, 2.0, 8.0, 30.0],
                _ => &[0.0, 1.0, 2.0, 5.0, 10.0, 25.0, 80.0],
            };
            for &bound in bounds {
                for serial in [false, true] {
                    tell(&cells, shape, &rule, bound, serial, spreads, fitted)?;
                }
            }
        }
    }
    eprintln!("{path}: {} passes so far", spreads.len());
    Ok(())
}

fn tell(
    cells: &Cells,
    shape: TileShape,
    rule: &BandRule,
    bound: f64,
    serial: bool,
    spreads: &mut Vec<Spread>,
    fitted: &mut Vec<Fitted>,
) -> Result<(), Box<dyn std::error::Error>> {
    let bound = if bound == 0.0 { Bound::Lossless } else { Bound::MaxError(bound) };
    let observed = observe(cells, shape, &BandRule { bound, ..*rule }, serial)?;
    fitted.extend(observed.passes);
    for residuals in observed.residuals.iter().filter(|residuals| !residuals.is_empty()) {
        let mut counts: BTreeMap<u16, Distribution> = BTreeMap::new();
        for &(table, symbol) in residuals {
            counts.entry(table).or_insert_with(|| vec![0.0; SYMBOLS])[usize::from(symbol)] += 1.0;
        }
        let counts = counts.into_iter().map(|(table, counts)| (usize::from(table), counts)).collect();
        spreads.push(Spread { counts, weight: (residuals.len() as f64).powf(-0.3) });
    }
    Ok(())
}

fn read_set(bytes: &[u8]) -> Set {
    let freq = |shape: usize, table: usize, symbol: usize| {
        let at = ((shape * PLAIN + table) * SYMBOLS + symbol) * 2;
        f64::from(u16::from_le_bytes([bytes[at], bytes[at + 1]]))
    };
    let table = |shape, table| (0..SYMBOLS).map(|symbol| freq(shape, table, symbol)).collect();
    (0..SHAPES).map(|shape| (0..PLAIN).map(|plain| table(shape, plain)).collect()).collect()
}

fn shifted(table: usize, shift: i32) -> usize {
    table / BINS * BINS + ((table % BINS) as i32 + shift).clamp(0, BINS as i32 - 1) as usize
}

/// Bits that symbols cost with a table.
fn cost(freq: &Distribution, counts: &Distribution) -> f64 {
    let escape = TOTAL.log2() - freq[ESCAPE].max(1.0).log2() + 7.0;
    let each = |symbol: usize| match freq[symbol] {
        freq if symbol == ESCAPE || freq < 1.0 => escape,
        freq => TOTAL.log2() - freq.log2(),
    };
    (0..SYMBOLS).filter(|&symbol| counts[symbol] > 0.0).map(|symbol| counts[symbol] * each(symbol)).sum()
}

/// Family and shift of each pass.
fn assign(set: &Set, spreads: &[Spread], first: bool) -> Vec<(usize, i32)> {
    let mut total = 0.0;
    let chosen: Vec<(usize, i32)> = spreads
        .iter()
        .map(|spread| {
            let mut best = (0, 0, f64::INFINITY);
            for (shape, tables) in set.iter().enumerate() {
                for shift in -3..=3 {
                    let bits = spread.counts.iter().map(|(table, c)| cost(&tables[shifted(*table, shift)], c)).sum();
                    if bits < best.2 {
                        best = (shape, shift, bits);
                    }
                }
            }
            total += best.2;
            (best.0, best.1)
        })
        .collect();
    eprintln!("{} bytes with the {} set", (total / 8.0).round(), if first { "old" } else { "new" });
    chosen
}

/// What the passes of each family had, smoothed by neighbours and by the old set.
fn estimate(old: &Set, spreads: &[Spread], chosen: &[(usize, i32)]) -> Set {
    let mut counts: Set = vec![vec![vec![0.0; SYMBOLS]; PLAIN]; SHAPES];
    for (spread, &(shape, shift)) in spreads.iter().zip(chosen) {
        for (table, found) in &spread.counts {
            let target = &mut counts[shape][shifted(*table, shift)];
            target.iter_mut().zip(found).for_each(|(target, found)| *target += found * spread.weight);
        }
    }
    let mut new = old.clone();
    for shape in 0..SHAPES {
        for table in 0..PLAIN {
            let (kind, bin) = (table / BINS, table % BINS);
            let mut sum = counts[shape][table].clone();
            let mut add = |other: &Distribution, share: f64| {
                sum.iter_mut().zip(other).for_each(|(sum, other)| *sum += share * other);
            };
            for near in [bin.checked_sub(1), (bin + 1 < BINS).then_some(bin + 1)].into_iter().flatten() {
                add(&counts[shape][kind * BINS + near], 0.03);
            }
            add(&counts[1 - shape][table], 0.02);
            add(&old[shape][table], 3.0 / TOTAL);
            if kind == KINDS - 1 {
                // Without a fraction of the prediction both signs are alike.
                for k in 1..=CENTRE {
                    let mean = (sum[CENTRE - k] + sum[CENTRE + k]) / 2.0;
                    (sum[CENTRE - k], sum[CENTRE + k]) = (mean, mean);
                }
            }
            let all: f64 = sum.iter().sum();
            new[shape][table] = frequencies(&sum.iter().map(|sum| sum / all).collect());
        }
    }
    new
}

/// Whole frequencies; what is too rare is left to the escape.
fn frequencies(shares: &Distribution) -> Distribution {
    let mut freq = vec![0.0; SYMBOLS];
    let mut escape = shares[ESCAPE];
    for symbol in 0..ESCAPE {
        let exact = shares[symbol] * TOTAL;
        if exact < 0.6 {
            escape += shares[symbol];
        } else {
            freq[symbol] = exact.round().max(1.0);
        }
    }
    freq[ESCAPE] = (escape * TOTAL).round().max(1.0);
    let commonest = (0..ESCAPE).max_by(|&a, &b| freq[a].total_cmp(&freq[b])).unwrap_or(CENTRE);
    freq[commonest] += TOTAL - freq.iter().sum::<f64>();
    freq
}

/// Four filters that stand for all that were fitted to a pass: k-means.
fn cluster(fitted: &[Fitted], pass: usize, serial: bool) -> Vec<Vec<f64>> {
    let mut filters: Vec<Vec<f64>> = fitted
        .iter()
        .filter(|fit| fit.pass == pass && fit.serial == serial && fit.cells >= 2000)
        .map(|fit| fit.filter.iter().map(|&weight| f64::from(weight)).collect())
        .collect();
    filters.sort_by(|a: &Vec<f64>, b| a[4].total_cmp(&b[4]));
    let mut centres: Vec<Vec<f64>> =
        (0..VARIANTS).map(|variant| filters[(2 * variant + 1) * filters.len() / (2 * VARIANTS)].clone()).collect();
    for _ in 0..30 {
        let mut sums = vec![(vec![0.0; TAPS], 0.0); VARIANTS];
        for filter in &filters {
            let far = |centre: &Vec<f64>| centre.iter().zip(filter).map(|(a, b)| (a - b).powi(2)).sum::<f64>();
            let near = (0..VARIANTS).min_by(|&a, &b| far(&centres[a]).total_cmp(&far(&centres[b]))).unwrap_or(0);
            sums[near].0.iter_mut().zip(filter).for_each(|(sum, weight)| *sum += weight);
            sums[near].1 += 1.0;
        }
        for (centre, (sum, count)) in centres.iter_mut().zip(sums).filter(|(_, (_, count))| *count > 0.0) {
            *centre = sum.into_iter().map(|sum| sum / count).collect();
        }
    }
    centres
}

/// Medians of the codes of the weights of errors, for the steps that a variant is for.
fn median_codes(fitted: &[Fitted], pass: usize, serial: bool, variant: usize) -> Vec<u8> {
    let variant_of = |step: i64| match step {
        1 => 0,
        3 => 1,
        ..=11 => 2,
        _ => 3,
    };
    let fits: Vec<&Fitted> = fitted
        .iter()
        .filter(|fit| fit.pass == pass && fit.serial == serial && fit.cells >= 2400 && variant_of(fit.step) == variant)
        .collect();
    (0..fits[0].codes.len())
        .map(|part| {
            let mut codes: Vec<u8> = fits.iter().map(|fit| fit.codes[part]).collect();
            codes.sort_unstable();
            codes[codes.len() / 2]
        })
        .collect()
}
