//! Water: cells that lie exactly as high as some of their neighbours. What is level stays level.

use super::plane::Plane;

/// Neighbours as high as a cell that make it level; fewer happen to be so where elevations are whole metres.
const LEVEL_NEIGHBOURS: usize = 3;

/// Which cells are level, of all but one at each side.
pub(super) fn level(plane: &Plane) -> Vec<bool> {
    let mut found = Vec::with_capacity((plane.rows() - 2) * (plane.cols() - 2));
    for row in 1..plane.rows() - 1 {
        let [above, own, below] = [row - 1, row, row + 1].map(|row| plane.row(row));
        for col in 1..plane.cols() - 1 {
            let around = [&above[col - 1..col + 2], &own[col - 1..col + 2], &below[col - 1..col + 2]];
            let equals = around.iter().flat_map(|line| line.iter()).filter(|height| **height == own[col]).count();
            found.push(equals > LEVEL_NEIGHBOURS);
        }
    }
    found
}

/// Gives the fine cells of level ones their height.
pub(super) fn keep_level(fine: &mut Plane, coarse: &Plane, is_level: &[bool], factor: usize) {
    let (cols, wide) = (coarse.cols(), fine.cols());
    for (cell, _) in is_level.iter().enumerate().filter(|(_, is_level)| **is_level) {
        let corner = (cell / cols * wide + cell % cols) * factor;
        for line in 0..factor {
            fine.heights_mut()[corner + line * wide..][..factor].fill(coarse.heights_m()[cell]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lakes_are_level_and_slopes_are_not() {
        let lake = [5.0, 5.0, 6.0, 9.0, 5.0, 5.0, 5.0, 8.0, 4.0, 4.0, 7.0, 6.0];
        let plane = Plane::new(3, 4, lake.to_vec());
        assert_eq!(level(&plane), [true, false]);
        let mut fine = Plane::new(2, 4, (0..8).map(f64::from).collect());
        keep_level(&mut fine, &Plane::new(1, 2, vec![5.0, 5.0]), &level(&plane), 2);
        assert_eq!(fine.heights_m(), [5.0, 5.0, 2.0, 3.0, 5.0, 5.0, 6.0, 7.0]);
        let slope = Plane::new(3, 3, vec![1.0, 2.0, 3.0, 1.0, 2.0, 3.0, 1.0, 2.0, 3.0]);
        assert_eq!(level(&slope), [false]);
    }
}
