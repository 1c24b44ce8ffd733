//! Values that look like nodata although nobody declared them so.

use crate::grid::{AnyGrid, Elevations, Key};
use crate::with_grid;
use std::fmt;

/// A value that looks like undeclared nodata.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sentinel {
    /// The stored value.
    pub value: f64,
    /// How many cells have it.
    pub cells: u64,
}

impl fmt::Display for Sentinel {
    /// What is suspect, and what to do about it.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { value, cells } = self;
        write!(
            f,
            "{cells} cells have the value {value}, far from all others and not declared as nodata; if it means nodata, \
             give --nodata {value}"
        )
    }
}

/// Values that programs write where there is no data.
const USUAL: [f64; 14] = [
    -32768.0,
    -32767.0,
    -9999.0,
    -99999.0,
    -999.0,
    -9998.0,
    32767.0,
    65535.0,
    9999.0,
    -2147483648.0,
    -3.402_823_466_385_288_6e38,
    -3.402_82e38,
    1e20,
    -1e10,
];

/// How far, in stored units, a usual value must lie from all others to be suspect.
const GAP: f64 = 500.0;

fn is_usual(value: f64) -> bool {
    // Single precision keeps some of them only nearly.
    USUAL.iter().any(|&usual| (value - usual).abs() <= usual.abs() * 1e-6)
}

/// The least and the greatest of stored values, seen part by part, with what tells whether they are suspect.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Ends {
    least: Option<End>,
    /// Of the values with the opposite sign.
    greatest: Option<End>,
}

/// The least of some values.
#[derive(Clone, Copy, Debug)]
struct End {
    value: f64,
    /// How many cells have it, and the least of the others; looked at only where the value is usual.
    cells: u64,
    next: Option<f64>,
}

impl End {
    fn with(self, other: Self) -> Self {
        let (low, high) = if other.value < self.value { (other, self) } else { (self, other) };
        let is_same = low.value == high.value;
        let next = [low.next, if is_same { high.next } else { Some(high.value) }].into_iter().flatten();
        Self { value: low.value, cells: low.cells + if is_same { high.cells } else { 0 }, next: next.reduce(f64::min) }
    }
}

impl Ends {
    /// The ends of values; those that are not finite are left out.
    pub(super) fn of(values: impl Iterator<Item = f64> + Clone) -> Self {
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for value in values.clone().filter(|value| value.is_finite()) {
            low = low.min(value);
            high = high.max(value);
        }
        let end = |value: f64, sign: f64| {
            let mut end = End { value: sign * value, cells: 0, next: None };
            for other in values.clone().filter(|other| other.is_finite() && is_usual(value)) {
                if other == value {
                    end.cells += 1;
                } else {
                    end.next = Some(end.next.map_or(sign * other, |next| next.min(sign * other)));
                }
            }
            end
        };
        if low > high { Self::default() } else { Self { least: Some(end(low, 1.0)), greatest: Some(end(high, -1.0)) } }
    }

    /// The ends of these values and others.
    pub(super) fn with(self, other: Self) -> Self {
        let both = |a: Option<End>, b: Option<End>| a.into_iter().chain(b).reduce(End::with);
        Self { least: both(self.least, other.least), greatest: both(self.greatest, other.greatest) }
    }

    /// Whether there was no value at all.
    pub(super) fn is_empty(&self) -> bool {
        self.least.is_none()
    }

    /// A usual nodata value far away from all other values.
    pub(super) fn sentinel(&self) -> Option<Sentinel> {
        [(self.least, 1.0), (self.greatest, -1.0)].into_iter().find_map(|(end, sign)| {
            let end = end?;
            let is_suspect = is_usual(sign * end.value) && end.next? - end.value > GAP;
            is_suspect.then_some(Sentinel { value: sign * end.value, cells: end.cells })
        })
    }
}

/// Looks at the extremes of a grid: a usual nodata value far away from all other values is suspect.
pub(super) fn find_sentinel(grid: &AnyGrid, elevations: &Elevations, least: i64, greatest: i64) -> Option<Sentinel> {
    [least, greatest].into_iter().find_map(|key| {
        let value = elevations.value(key);
        if !is_usual(value) {
            return None;
        }
        let (cells, next) = with_grid!(grid, grid => neighbour_of_extreme(grid.cells(), key, key == least));
        let next = next?;
        ((elevations.value(next) - value).abs() > GAP).then_some(Sentinel { value, cells })
    })
}

/// How many cells have the extreme key, and the next key after it.
fn neighbour_of_extreme<K: Key>(cells: &[K], extreme: i64, is_least: bool) -> (u64, Option<i64>) {
    let extreme = K::from_i64(extreme);
    let mut count = 0;
    let mut next: Option<K> = None;
    for &key in cells {
        if key == extreme {
            count += 1;
        } else if key != K::VOID && next.is_none_or(|next| if is_least { key < next } else { key > next }) {
            next = Some(key);
        }
    }
    (count, next.map(K::to_i64))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sentinel_is_found_whatever_the_parts() {
        let values = [310.0, -32767.0, 290.0, f64::NAN, -32767.0, 305.0, 288.0, -32767.0];
        for size in 1..=values.len() {
            let ends = values.chunks(size).map(|part| Ends::of(part.iter().copied())).reduce(Ends::with).unwrap();
            assert_eq!(ends.sentinel(), Some(Sentinel { value: -32767.0, cells: 3 }), "parts of {size}");
        }
        let high = Ends::of([65535.0, 4.0, 9.0].into_iter());
        assert_eq!(high.sentinel(), Some(Sentinel { value: 65535.0, cells: 1 }));
    }

    #[test]
    fn plain_values_are_not_suspect() {
        for values in [&[-9999.0, -9800.0][..], &[-500.0, 3000.0], &[-9999.0, -9999.0], &[f64::NAN]] {
            assert_eq!(Ends::of(values.iter().copied()).sentinel(), None, "{values:?}");
        }
        assert!(Ends::of(std::iter::once(f64::NAN)).is_empty());
    }
}
