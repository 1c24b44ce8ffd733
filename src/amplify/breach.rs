//! Lets the water out of pits that are too small to be seen on the coarse plane: each is opened along the lowest way to
//! a lower cell nearby (least-cost breaching: Lindsay and Dhun 2015, doi:10.1080/13658816.2014.975715).

use super::plane::Plane;

/// Fine cells at each side of a pit in which a lower cell is looked for.
const RADIUS: usize = 4;
const SIDE: usize = 2 * RADIUS + 1;
/// Fine cells at each side that are needed beyond those that come out right: a cell changes for pits up to the radius
/// away, which look as far again.
pub(super) const BREACH_REACH: usize = 2 * RADIUS;
/// Part of what is dug from the sill that goes to the bottom of the pit, at most, so that less has to be made up for.
const FILLED: f64 = 0.9;

/// Opens the pits of a plane: cells lower than all eight neighbours. Cells that are `fixed` do not change. Pits that have
/// no lower cell within the radius stay; so do those nearer to the edge than the radius.
///
/// All pits see the plane as it was, and where several dig the lowest counts: their order does not matter.
pub(super) fn breach(plane: &mut Plane, fixed: &[bool]) {
    let mut flood = Flood::new();
    let (mut dug, mut raised) = (vec![], vec![]);
    for pit in pits(plane).into_iter().filter(|&pit| !fixed[pit]) {
        if let Some(ramp) = flood.ramp(plane, fixed, pit) {
            raised.push((pit, ramp.bottom));
            dug.extend(ramp.cells);
        }
    }
    let heights = plane.heights_mut();
    let before: Vec<f64> = raised.iter().map(|&(pit, _): &(usize, f64)| heights[pit]).collect();
    dug.into_iter().for_each(|(cell, height): (usize, f64)| heights[cell] = heights[cell].min(height));
    // A pit on another's way is not raised.
    for ((pit, height), before) in raised.into_iter().zip(before) {
        if heights[pit] == before {
            heights[pit] = height;
        }
    }
}

/// Cells lower than all eight neighbours, of all but [`RADIUS`] at each side.
fn pits(plane: &Plane) -> Vec<usize> {
    let cols = plane.cols();
    let mut found = vec![];
    for row in RADIUS..plane.rows().saturating_sub(RADIUS) {
        let [above, own, below] = [row - 1, row, row + 1].map(|row| plane.row(row));
        for col in RADIUS..cols.saturating_sub(RADIUS) {
            let height = own[col];
            // Most cells have a lower one beside them.
            if own[col - 1] > height && own[col + 1] > height {
                let lines = above[col - 1..col + 2].iter().chain(&below[col - 1..col + 2]);
                if lines.copied().all(|other| other > height) {
                    found.push(row * cols + col);
                }
            }
        }
    }
    found
}

/// A way out of a pit.
struct Ramp {
    /// The height that the pit itself gets.
    bottom: f64,
    /// The cells on the way that are dug, and how low.
    cells: Vec<(usize, f64)>,
}

/// The square around a pit, filled from its lowest cell upwards (Barnes, Lehman, Mulla 2014,
/// doi:10.1016/j.cageo.2013.04.024).
struct Flood {
    /// For each cell the one that water comes from; [`UNSEEN`] before it comes.
    from: [u8; SIDE * SIDE],
    /// Cells that water stands beside, with the height over which it reaches them.
    open: Vec<(f64, u8)>,
}

/// Water has not come here yet.
const UNSEEN: u8 = u8::MAX;
/// The square's middle.
const MIDDLE: u8 = (SIDE * SIDE / 2) as u8;

impl Flood {
    fn new() -> Self {
        Self { from: [UNSEEN; SIDE * SIDE], open: vec![] }
    }

    /// The lowest way from a pit to a lower cell, as a ramp that falls evenly.
    fn ramp(&mut self, plane: &Plane, fixed: &[bool], pit: usize) -> Option<Ramp> {
        let corner = pit - RADIUS * plane.cols() - RADIUS;
        let at = |cell: u8| corner + usize::from(cell) / SIDE * plane.cols() + usize::from(cell) % SIDE;
        let z = plane.heights_m();
        let end = self.lower(|cell| (z[at(cell)], fixed[at(cell)]))?;
        let mut way = vec![];
        let mut cell = end;
        while cell != MIDDLE {
            cell = self.from[usize::from(cell)];
            way.push(at(cell));
        }
        // As much earth is moved from the sill to the bottom as fits between the pit's other neighbours, and no more.
        let (end, steps) = (z[at(end)], way.len() as f64);
        let above: f64 = way.iter().map(|&cell| z[cell] - end).sum();
        let sill = way.iter().map(|&cell| z[cell]).fold(f64::NEG_INFINITY, f64::max);
        let before_last = way[way.len() - 2];
        let others = [0, 1, 2, 3, 5, 6, 7, 8].map(|k| pit - plane.cols() - 1 + k / 3 * plane.cols() + k % 3);
        let rim = others.into_iter().filter(|&other| other != before_last).map(|other| z[other]);
        let level = (end + above * 2.0 / (steps + 1.0)).min(rim.fold(sill, f64::min));
        let bottom = (z[pit] + FILLED * (level - z[pit])).max(z[pit]);
        let heights = (1..way.len()).map(|step| end + (bottom - end) * step as f64 / steps);
        let cells = way.iter().copied().zip(heights).filter(|&(cell, height)| height < z[cell]).collect();
        Some(Ramp { bottom, cells })
    }

    /// The first cell lower than the middle that water comes to, always over the lowest cell that it stands beside.
    fn lower(&mut self, look: impl Fn(u8) -> (f64, bool)) -> Option<u8> {
        self.from.fill(UNSEEN);
        self.open.clear();
        let bottom = look(MIDDLE).0;
        self.from[usize::from(MIDDLE)] = MIDDLE;
        self.open.push((bottom, MIDDLE));
        loop {
            // The first of equals, in the order in which water came to them.
            let lowest = (0..self.open.len()).min_by(|&a, &b| self.open[a].0.total_cmp(&self.open[b].0))?;
            let (level, cell) = self.open.remove(lowest);
            let (height, is_fixed) = look(cell);
            if height < bottom {
                return Some(cell);
            }
            let (row, col) = (usize::from(cell) / SIDE, usize::from(cell) % SIDE);
            let is_at_edge = row.min(col) == 0 || row.max(col) == SIDE - 1;
            if is_fixed || is_at_edge {
                continue;
            }
            for k in [0, 1, 2, 3, 5, 6, 7, 8] {
                let next = ((row + k / 3 - 1) * SIDE + col + k % 3 - 1) as u8;
                if self.from[usize::from(next)] == UNSEEN {
                    self.from[usize::from(next)] = cell;
                    self.open.push((level.max(look(next).0), next));
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::Rng;

    fn noise(side: usize, seed: u64) -> Plane {
        let mut rng = Rng::new(seed);
        Plane::new(side, side, (0..side * side).map(|i| (i / side) as f64 * 0.4 + rng.unit() * 3.0).collect())
    }

    fn plain_pits(plane: &Plane) -> Vec<usize> {
        let cols = plane.cols();
        let lower = |a: usize, b: usize| plane.heights_m()[a] > plane.heights_m()[b];
        let is_pit = |&cell: &usize| {
            let (row, col) = (cell / cols, cell % cols);
            let inside = |at: usize, count: usize| (RADIUS..count - RADIUS).contains(&at);
            inside(row, plane.rows())
                && inside(col, cols)
                && (row - 1..row + 2)
                    .all(|r| (col - 1..col + 2).all(|c| (r, c) == (row, col) || lower(r * cols + c, cell)))
        };
        (0..plane.heights_m().len()).filter(is_pit).collect()
    }

    /// The height over which water has to rise to get out of a pit, by widening from the pit until nothing changes.
    fn sill(plane: &Plane, pit: usize) -> Option<f64> {
        let (cols, z) = (plane.cols(), plane.heights_m());
        let corner = pit - RADIUS * cols - RADIUS;
        let at = |row: usize, col: usize| corner + row * cols + col;
        let mut levels = vec![f64::INFINITY; SIDE * SIDE];
        levels[SIDE * SIDE / 2] = z[pit];
        loop {
            let mut next = levels.clone();
            for (cell, next) in next.iter_mut().enumerate() {
                let (row, col) = (cell / SIDE, cell % SIDE);
                for r in row.max(1) - 1..SIDE.min(row + 2) {
                    for c in col.max(1) - 1..SIDE.min(col + 2) {
                        let is_at_edge = r.min(c) == 0 || r.max(c) == SIDE - 1;
                        if !is_at_edge {
                            *next = next.min(levels[r * SIDE + c].max(z[at(row, col)]));
                        }
                    }
                }
            }
            if next == levels {
                break;
            }
            levels = next;
        }
        let lower = (0..SIDE * SIDE).filter(|&cell| z[at(cell / SIDE, cell % SIDE)] < z[pit]);
        lower.map(|cell| levels[cell]).min_by(f64::total_cmp).filter(|level| level.is_finite())
    }

    #[test]
    fn ways_go_over_the_lowest_sill() {
        for seed in 0..20 {
            let plane = noise(40, seed);
            assert_eq!(pits(&plane), plain_pits(&plane));
            for pit in pits(&plane) {
                let ramp = Flood::new().ramp(&plane, &[false; 1600], pit);
                let known = sill(&plane, pit);
                assert_eq!(ramp.is_some(), known.is_some(), "seed {seed}, cell {pit}");
                let Some((ramp, known)) = ramp.zip(known) else { continue };
                let highest = ramp.cells.iter().map(|&(cell, _)| plane.heights_m()[cell]).fold(f64::MIN, f64::max);
                assert!(highest <= known, "{highest} and {known}");
                assert!(ramp.bottom >= plane.heights_m()[pit] && ramp.bottom < known);
            }
        }
    }

    #[test]
    fn most_pits_are_gone_and_what_is_fixed_stays() {
        let mut plane = noise(60, 5);
        let before = plane.clone();
        let fixed: Vec<bool> = (0..3600).map(|cell| cell % 60 >= 30).collect();
        breach(&mut plane, &fixed);
        let count = |plane: &Plane, fixed_side: bool| {
            plain_pits(plane).into_iter().filter(|pit| (pit % 60 >= 30 + RADIUS) == fixed_side).count()
        };
        assert!(count(&plane, false) * 3 < count(&before, false));
        assert_eq!(count(&plane, true), count(&before, true));
        let changed = (0..3600).filter(|&cell| plane.heights_m()[cell] != before.heights_m()[cell]);
        assert!(changed.clone().count() > 20 && changed.into_iter().all(|cell| !fixed[cell]));
    }

    #[test]
    fn what_is_far_away_does_not_matter() {
        let mut whole = noise(50, 8);
        let mut part = whole.part(10, 12, 30, 31);
        breach(&mut whole, &[false; 2500]);
        breach(&mut part, &[false; 930]);
        assert_eq!(part.trimmed(BREACH_REACH), whole.part(10, 12, 30, 31).trimmed(BREACH_REACH));
    }
}
