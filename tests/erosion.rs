//! Drainage and erosion against slow, obvious references.

#![cfg(feature = "program")]

use orograph::erosion::{Anchors, Drainage, Relief, breach, fill, incise, slide};
use proptest::prelude::*;
use std::collections::BTreeSet;

/// Small terrains with flats, ties, pits and voids.
fn reliefs() -> impl Strategy<Value = Relief> {
    let size = (1..9_usize, 1..9_usize);
    (size, 1..30_i32, prop::bool::ANY).prop_flat_map(|((rows, cols), range, has_voids)| {
        let cell = (0..range, 0..8).prop_map(move |(z, void)| if has_voids && void == 0 { f32::NAN } else { z as f32 });
        let cell_m = prop::sample::select(vec![[1.0, 1.0], [30.0, 30.0], [20.5, 30.0]]);
        (cell_m, prop::collection::vec(cell, rows * cols))
            .prop_map(move |(cell_m, z)| Relief::new(rows, cols, cell_m, z).expect("a relief"))
    })
}

/// Neighbours that are no voids, with their distance; the flag says whether water leaves at the cell.
fn around(relief: &Relief, cell: usize) -> (Vec<(usize, f32)>, bool) {
    let (rows, cols) = (relief.rows() as isize, relief.cols() as isize);
    let (row, col) = (cell as isize / cols, cell as isize % cols);
    let [width, height] = relief.cell_m();
    let (mut near, mut leaves) = (vec![], false);
    for (down, right) in [(-1, -1), (-1, 0), (-1, 1), (0, -1), (0, 1), (1, -1), (1, 0), (1, 1)] {
        let (row, col) = (row + down, col + right);
        let is_inside = (0..rows).contains(&row) && (0..cols).contains(&col);
        let other = (row * cols + col) as usize;
        if !is_inside || relief.z_m()[other].is_nan() {
            leaves = true;
            continue;
        }
        let (x, y) = (right as f32 * width, down as f32 * height);
        near.push((other, (x * x + y * y).sqrt()));
    }
    (near, leaves)
}

/// The levels to which depressions fill: each cell's is lowered to what its neighbours let it be, until nothing changes.
fn filled(relief: &Relief) -> Vec<f32> {
    let z = relief.z_m();
    let mut levels: Vec<f32> = z.iter().map(|z| if z.is_nan() { *z } else { f32::INFINITY }).collect();
    loop {
        let before = levels.clone();
        for cell in (0..z.len()).filter(|&cell| !z[cell].is_nan()) {
            let (near, leaves) = around(relief, cell);
            let lowest = near.iter().map(|&(other, _)| levels[other]).fold(f32::INFINITY, f32::min);
            levels[cell] = if leaves { z[cell] } else { z[cell].max(lowest) };
        }
        if levels.iter().zip(&before).all(|(a, b)| a.to_bits() == b.to_bits()) {
            return levels;
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 600, ..ProptestConfig::default() })]

    #[test]
    fn water_leaves_by_the_lowest_way(relief in reliefs()) {
        let (drainage, z) = (Drainage::of(&relief), relief.z_m());
        let ground: BTreeSet<u32> = (0..z.len() as u32).filter(|&cell| !z[cell as usize].is_nan()).collect();
        let mut seen = BTreeSet::new();
        for &cell in drainage.order() {
            let (near, leaves) = around(&relief, cell as usize);
            match drainage.receiver(cell as usize) {
                None => prop_assert!(leaves, "cell {cell} has no receiver"),
                Some(receiver) => {
                    prop_assert!(!leaves && near.iter().any(|&(other, _)| other == receiver));
                    prop_assert!(seen.contains(&(receiver as u32)), "{cell} before its receiver {receiver}");
                }
            }
            prop_assert!(seen.insert(cell), "{cell} twice");
        }
        prop_assert_eq!(&seen, &ground);
        let levels = drainage.levels_m(&relief);
        for (cell, (a, b)) in levels.iter().zip(filled(&relief)).enumerate() {
            prop_assert!(a.to_bits() == b.to_bits(), "cell {cell} fills to {a}, not {b}");
        }
        let bits = |levels: &[f32]| levels.iter().map(|z| z.to_bits()).collect::<Vec<u32>>();
        prop_assert_eq!(bits(&fill(&relief)), bits(&levels));
    }

    #[test]
    fn no_cell_is_higher_than_one_whose_water_passes(
        relief in reliefs(),
        fast in prop::collection::vec((0..3, -20..40_i32), 64),
    ) {
        // Where water goes is as the relief has it; some cells stand fast at other heights.
        let cells = 0..relief.z_m().len();
        let fast_m: Vec<f32> = cells.zip(&fast).map(|(cell, &(kind, z))| {
            if kind == 0 && !relief.z_m()[cell].is_nan() { z as f32 } else { f32::NAN }
        }).collect();
        let drainage = Drainage::of(&relief);
        let mut wanted: Vec<f32> =
            relief.z_m().iter().zip(&fast_m).map(|(&z, &fast)| if fast.is_nan() { z } else { fast }).collect();
        for &cell in drainage.order().iter().rev() {
            if let Some(receiver) = drainage.receiver(cell as usize).filter(|&receiver| fast_m[receiver].is_nan()) {
                wanted[receiver] = wanted[receiver].min(wanted[cell as usize]);
            }
        }
        let bits = |z: &[f32]| z.iter().map(|z| z.to_bits()).collect::<Vec<u32>>();
        prop_assert_eq!(bits(&breach(relief, &fast_m)), bits(&wanted));
    }

    #[test]
    fn outside_of_depressions_water_goes_the_steepest_way(relief in reliefs()) {
        let (drainage, levels) = (Drainage::of(&relief), filled(&relief));
        let z = relief.z_m();
        // Depressions, flats and the ways that are carved out of them aside, all that is left is a slope.
        let has_depression = (0..z.len()).any(|cell| {
            let (near, leaves) = around(&relief, cell);
            levels[cell] > z[cell] || (!z[cell].is_nan() && !leaves && near.iter().all(|&(other, _)| z[other] >= z[cell]))
        });
        if !has_depression {
            for cell in (0..z.len()).filter(|&cell| !z[cell].is_nan()) {
                let (near, leaves) = around(&relief, cell);
                let slope = |&(other, distance): &(usize, f32)| (z[cell] - z[other]) * (1.0 / distance);
                let steepest = near.iter().map(slope).fold(f32::NEG_INFINITY, f32::max);
                let first = near.iter().find(|next| slope(next) == steepest).map(|&(other, _)| other);
                prop_assert_eq!(drainage.receiver(cell), if leaves { None } else { first });
            }
        }
    }

    #[test]
    fn areas_count_what_passes(relief in reliefs()) {
        let drainage = Drainage::of(&relief);
        let mut counted = vec![0_u32; relief.z_m().len()];
        for &cell in drainage.order() {
            let mut at = Some(cell as usize);
            while let Some(cell) = at {
                counted[cell] += 1;
                at = drainage.receiver(cell);
            }
        }
        prop_assert_eq!(drainage.areas_cells(), counted);
    }

    #[test]
    fn a_step_of_erosion_solves_its_equation(relief in reliefs(), strength in 0.0..3.0_f64) {
        let (drainage, before) = (Drainage::of(&relief), relief.clone());
        let (areas, mut after) = (drainage.areas_cells(), relief);
        incise(&mut after, &drainage, &areas, strength);
        let [width, height] = before.cell_m().map(f64::from);
        for &cell in drainage.order() {
            let (cell, z) = (cell as usize, |relief: &Relief, cell: usize| f64::from(relief.z_m()[cell]));
            let Some(receiver) = drainage.receiver(cell) else {
                prop_assert_eq!(z(&after, cell), z(&before, cell));
                continue;
            };
            let (old, new, base) = (z(&before, cell), z(&after, cell), z(&after, receiver));
            if base >= old {
                prop_assert_eq!(new, old);
                continue;
            }
            let (near, _) = around(&before, cell);
            let distance = near.iter().find(|&&(other, _)| other == receiver).expect("a neighbour").1;
            // (new - old) = -K dt A^1/2 (new - base) / distance
            let fall = strength * (f64::from(areas[cell]) * width * height).sqrt() * (new - base) / f64::from(distance);
            prop_assert!((old - new - fall).abs() < 1e-4 * (1.0 + old.abs()), "{old} to {new} over {base}, {fall}");
        }
    }

    #[test]
    fn nothing_stands_steeper_than_it_may(relief in reliefs(), slope in 0.0..2.0_f64) {
        let (drainage, before) = (Drainage::of(&relief), relief.clone());
        let mut after = relief;
        slide(&mut after, &drainage, slope);
        for &cell in drainage.order() {
            let cell = cell as usize;
            prop_assert!(after.z_m()[cell] <= before.z_m()[cell]);
            let Some(receiver) = drainage.receiver(cell) else { continue };
            let distance = around(&before, cell).0.iter().find(|next| next.0 == receiver).expect("a neighbour").1;
            let most = after.z_m()[receiver] + slope as f32 * distance;
            prop_assert!(after.z_m()[cell] <= most);
            prop_assert!(after.z_m()[cell] == before.z_m()[cell] || after.z_m()[cell] == most, "lowered for nothing");
        }
    }

    #[test]
    fn anchors_give_back_by_distance(
        relief in reliefs(), places in prop::collection::vec((0..9_usize, 0..9_usize), 0..4), radius in 0.0..120.0_f64,
    ) {
        let places: Vec<[usize; 2]> = places.into_iter().map(|(row, col)| [row, col]).collect();
        let (anchors, mut lowered) = (Anchors::new(&relief, &places, radius), relief.clone());
        let before = anchors.before(&relief);
        lowered.z_m_mut().iter_mut().for_each(|z| *z -= 5.0);
        anchors.give_back(&mut lowered, &before);
        let [width, height] = relief.cell_m().map(f64::from);
        for cell in (0..relief.z_m().len()).filter(|&cell| !relief.z_m()[cell].is_nan()) {
            let (row, col) = (cell / relief.cols(), cell % relief.cols());
            let inside = places.iter().filter(|[row, col]| *row < relief.rows() && *col < relief.cols());
            let near = inside.map(|&[r, c]| {
                (row.abs_diff(r) as f64 * height).hypot(col.abs_diff(c) as f64 * width)
            }).fold(f64::INFINITY, f64::min);
            let share = if near == 0.0 { 1.0 } else { (1.0 - (near / radius).powi(2)).max(0.0).powi(3) };
            let wanted = f64::from(relief.z_m()[cell]) - 5.0 * (1.0 - share);
            prop_assert!((f64::from(lowered.z_m()[cell]) - wanted).abs() < 1e-4, "cell {cell} {near} m from an anchor");
            if near == 0.0 {
                prop_assert_eq!(lowered.z_m()[cell], relief.z_m()[cell]);
            }
        }
    }
}

#[test]
fn a_lake_overflows_at_its_lowest_side() {
    let z = [9, 9, 9, 9, 9, 9, 2, 3, 4, 1, 9, 5, 6, 7, 9, 9, 9, 9, 9, 9].map(|z| z as f32).to_vec();
    let relief = Relief::new(4, 5, [10.0, 10.0], z).expect("a relief");
    let drainage = Drainage::of(&relief);
    // From the pit (2) over 3 and 4 to the edge at 1.
    assert_eq!([6, 7, 8, 9].map(|cell| drainage.receiver(cell)), [Some(7), Some(8), Some(9), None]);
    assert_eq!(drainage.levels_m(&relief)[6..10], [4.0, 4.0, 4.0, 1.0]);
    assert_eq!(drainage.areas_cells()[9], 7, "six inner cells and itself");
}

#[test]
fn the_same_for_any_number_of_threads() {
    let z = |i: usize| ((i * 2_654_435_761) >> 7 & 0xff) as f32;
    let relief = Relief::new(300, 257, [30.0, 30.0], (0..300 * 257).map(z).collect()).expect("a relief");
    let route = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
        pool.install(|| Drainage::of(&relief))
    };
    assert!(route(1) == route(4));
}

#[test]
fn cells_without_a_size_are_refused() {
    for cell_m in [[0.0, 1.0], [1.0, f64::NAN], [-1.0, 1.0], [f64::INFINITY, 1.0]] {
        assert!(Relief::new(1, 1, cell_m, vec![0.0]).is_err());
    }
}
