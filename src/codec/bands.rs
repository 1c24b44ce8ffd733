//! Which rows of a plane a pass runs on: all of them, or, while an encoder makes up its mind, a few bands that stand
//! for all.

/// Rows of each band of a sample.
const BAND: usize = 8;

/// Rows of a plane.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Bands {
    /// All rows.
    All,
    /// So many bands, evenly spread.
    Sample(usize),
}

impl Bands {
    /// A sample of about so many cells; all rows of a plane that has not many more.
    pub(super) fn of_cells(cells: usize, width: usize, height: usize) -> Self {
        let count = (cells / (BAND * width.max(1))).max(1);
        if height / BAND < 2 * count { Self::All } else { Self::Sample(count) }
    }

    /// The rows, and whether nothing is known of the row above.
    pub(super) fn rows(self, height: usize) -> impl Iterator<Item = (usize, bool)> {
        let (count, length) = match self {
            Self::All => (1, height),
            Self::Sample(count) => (count, BAND),
        };
        let first = move |band: usize| (2 * band + 1) * (height - length) / (2 * count);
        (0..count).flat_map(move |band| (0..length).map(move |row| (first(band) + row, row == 0)))
    }

    /// Number of rows.
    pub(super) fn count(self, height: usize) -> usize {
        match self {
            Self::All => height,
            Self::Sample(count) => count * BAND,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bands_do_not_overlap_and_lie_within() {
        for (cells, width, height) in
            [(20_000, 512, 512), (20_000, 129, 512), (20_000, 2000, 17), (10, 3, 3), (10, 1, 1)]
        {
            let bands = Bands::of_cells(cells, width, height);
            let rows: Vec<_> = bands.rows(height).collect();
            assert_eq!(rows.len(), bands.count(height));
            assert!(rows.windows(2).all(|pair| pair[0].0 < pair[1].0) && rows[rows.len() - 1].0 < height);
            assert!(rows[0].1 && rows.windows(2).all(|pair| pair[1].1 || pair[0].0 + 1 == pair[1].0));
        }
    }
}
