//! Sparse terrains as nodes: they are what the dictionary's own evaluation says, within bounds.

use super::bounds::keeps;
use orograph::construction::primitive::Sparse;
use orograph::construction::{Affine, Area, Builder, Detail, Lattice, Tiling, Tree};
use orograph::dictionary::{Codes, Dictionary, NoiseFamily, Origin, PatchLayout, PatchShape, SparseTerrain};
use orograph::rng::Rng;
use orograph::watch::Watch;
use proptest::prelude::*;

/// Discs of random means and atoms; `missing` of a hundred places have none.
fn terrain(
    (rows, cols): (usize, usize),
    (side, step): (usize, usize),
    missing: u64,
    noise: bool,
    seed: u64,
) -> SparseTerrain {
    let mut rng = Rng::new(seed);
    let shape = PatchShape::new(side).expect("a side of 3 at least");
    let layout = PatchLayout::new(rows, cols, shape.clone(), Some(step)).expect("no gaps");
    let dictionary = if noise {
        Dictionary::noise(NoiseFamily::Perlin, &shape, 5, seed).expect("atoms")
    } else {
        let values = (0..5 * side * side).map(|_| rng.between(-0.5, 0.5) as f32).collect();
        Dictionary::from_values(side, values, vec![Origin::Learned; 5], vec![]).expect("sound")
    };
    let mut places: Vec<u32> = (0..layout.places() as u32).filter(|_| rng.below(100) >= missing).collect();
    if places.is_empty() {
        places.push(0);
    }
    let means = places.iter().map(|_| rng.between(0.0, 300.0) as f32).collect();
    let pairs: Vec<Vec<(u32, f64)>> = places
        .iter()
        .map(|_| (0..rng.below(3)).map(|_| (rng.below(5) as u32, rng.between(-40.0, 40.0))).collect())
        .collect();
    let codes = Codes::from_pairs(2, &pairs).expect("sound");
    SparseTerrain::new(layout, &places, means, &codes, dictionary).expect("sound")
}

fn any_terrain() -> impl Strategy<Value = SparseTerrain> {
    let cut = (3usize..10, 1usize..6).prop_filter("no gaps", |&(side, step)| {
        PatchLayout::new(9, 9, PatchShape::new(side).expect("a side"), Some(step)).is_ok()
    });
    ((2usize..30, 2usize..30), cut, prop_oneof![Just(0u64), 5u64..60], any::<bool>(), any::<u64>())
        .prop_map(|(size, cut, missing, noise, seed)| terrain(size, cut, missing, noise, seed))
}

fn tree(terrain: SparseTerrain) -> Tree {
    let mut builder = Builder::new();
    let root = builder.leaf(Sparse::new(terrain).expect("discs")).expect("a leaf");
    builder.finish(root, Detail::default()).expect("its own root")
}

proptest! {
    #![proptest_config(crate::cases(150))]

    #[test]
    fn it_is_the_dictionarys_terrain(terrain in any_terrain(), u in 0.0..1.0_f64, v in 0.0..1.0_f64) {
        let (rows, cols) = (terrain.layout().rows() as f64, terrain.layout().cols() as f64);
        let at = [u * cols, v * rows];
        let expected = terrain.elevation_m(at[1], at[0]);
        let point = tree(terrain).at(at);
        match expected {
            Some(expected) => prop_assert!(
                point.weight.value == 0.0 || (point.elevation.value - expected).abs() < 1e-9 * (1.0 + expected.abs()),
                "{} for {expected}", point.elevation.value
            ),
            None => prop_assert_eq!(point.weight.value, 0.0),
        }
    }

    #[test]
    fn slopes_are_those_of_differences(terrain in any_terrain(), u in 0.02..0.98_f64, v in 0.02..0.98_f64) {
        let (rows, cols) = (terrain.layout().rows() as f64, terrain.layout().cols() as f64);
        let tree = tree(terrain);
        let at = [u * cols, v * rows];
        let point = tree.at(at);
        // Towards the fringe slopes change too fast for differences.
        prop_assume!(point.weight.value > 0.05);
        let e = 1e-5;
        let beside = |dx: f64, dy: f64| tree.at([at[0] + dx, at[1] + dy]);
        let [left, right, up, down] = [beside(-e, 0.0), beside(e, 0.0), beside(0.0, -e), beside(0.0, e)];
        for (found, (before, after)) in [
            (point.elevation.dx, (left.elevation.value, right.elevation.value)),
            (point.elevation.dy, (up.elevation.value, down.elevation.value)),
            (point.weight.dx, (left.weight.value, right.weight.value)),
            (point.weight.dy, (up.weight.value, down.weight.value)),
        ] {
            let expected = (after - before) / (2.0 * e);
            prop_assert!((found - expected).abs() < 0.01 * (1.0 + expected.abs()), "{found}, differences {expected}");
        }
    }

    #[test]
    fn it_keeps_its_bounds(terrain in any_terrain(), x in -3.0..30.0_f64, y in -3.0..30.0_f64, side in 0.01..20.0_f64) {
        let tree = tree(terrain);
        let area = Area::of(&[[x, y], [x + side, y + side]]);
        keeps(&tree, &tree.bounds(&area), &area, 20);
        keeps(&tree, &tree.bounds(&Area::PLANE), &tree.support(), 40);
    }

    #[test]
    fn tiles_equal_points(terrain in any_terrain(), tile in 1usize..40) {
        let tree = tree(terrain);
        let lattice = Lattice { x0: -1.0, y0: 31.0, dx: 0.7, dy: -0.7, cols: 50, rows: 50 };
        let tiling = Tiling { cols: tile, rows: 1 + tile / 3 };
        let found = tree.evaluate(&lattice, tiling, true, &Watch::default(), |point| *point).expect("nobody cancels");
        for (i, point) in found.iter().enumerate() {
            let expected = tree.at(lattice.at(i / 50, i % 50));
            prop_assert_eq!(point.elevation.value.to_bits(), expected.elevation.value.to_bits());
            prop_assert_eq!(point.weight.dx.to_bits(), expected.weight.dx.to_bits());
        }
    }
}

#[test]
fn whole_terrain_has_a_weight_of_one_and_a_slope() {
    let terrain = terrain((40, 40), (8, 4), 0, false, 3);
    let tree = tree(terrain);
    for (x, y) in [(20.0, 20.0), (4.0, 36.0), (17.3, 9.1)] {
        assert_eq!(tree.at([x, y]).weight.value, 1.0, "{x} {y}");
    }
    let bounds = tree.bounds(&Area::of(&[[10.0, 10.0], [22.0, 22.0]]));
    assert!(bounds.slope.is_finite() && bounds.weight.min > 0.0, "{bounds:?}");
}

#[test]
fn a_node_is_put_where_its_cells_lie() {
    let terrain = terrain((20, 30), (8, 4), 0, false, 5);
    let expected = terrain.elevation_m(7.25, 11.5).expect("a disc");
    let mut builder = Builder::new();
    let leaf = builder.leaf(Sparse::new(terrain).expect("discs")).expect("a leaf");
    // Cells of 10 m, the north-western corner at (500, 900), heights in feet.
    let affine = Affine::new([[10.0, 0.0], [0.0, -10.0]], [500.0, 900.0], 0.3048, 2.0).expect("regular");
    let root = builder.place(leaf, affine).expect("a warp");
    let tree = builder.finish(root, Detail::default()).expect("its own root");
    let found = tree.elevation_m([500.0 + 115.0, 900.0 - 72.5]).expect("defined");
    assert!((found - (expected * 0.3048 + 2.0)).abs() < 1e-9);
    assert!((tree.support().x.max - 800.0).abs() < 1e-6 && (tree.support().y.min - 700.0).abs() < 1e-6);
}

#[test]
fn a_terrain_of_voids_is_refused() {
    let shape = PatchShape::new(4).expect("a side");
    let layout = PatchLayout::new(8, 8, shape, None).expect("no gaps");
    let dictionary = Dictionary::from_values(4, vec![0.0; 16], vec![Origin::Learned], vec![]).expect("sound");
    let codes = Codes::from_pairs(0, &[]).expect("none");
    let terrain = SparseTerrain::new(layout, &[], vec![], &codes, dictionary).expect("sound");
    assert!(Sparse::new(terrain).expect_err("void").message().contains("no disc"));
}
