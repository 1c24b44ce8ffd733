//! From meshes to rasters.

use super::{elevation, rasters};
use orograph::tin::{Breaklines, Mesh, RefineOptions, SUBCELLS, Triangulation, refine, regular, scan, snapped};
use orograph::watch::Watch;
use proptest::prelude::*;
use std::collections::BTreeSet;

/// The triangulation of some points with elevations.
fn meshes() -> impl Strategy<Value = Mesh> {
    prop::collection::vec([-4.0..14.0_f64, -4.0..14.0_f64, 0.0..9.0_f64], 3..20).prop_map(|points| {
        // Quarters of a cell make many centres lie on edges.
        let mut seen = BTreeSet::new();
        let points: Vec<[f64; 3]> = points
            .into_iter()
            .map(|[x, y, z]| [(x * 4.0).round() / 4.0, (y * 4.0).round() / 4.0, z])
            .filter(|[x, y, _]| seen.insert(((x * 4.0) as i64, (y * 4.0) as i64)))
            .collect();
        let places: Vec<[f64; 2]> = points.iter().map(|&[x, y, _]| [x, y]).collect();
        let z: Vec<f64> = points.iter().map(|point| point[2]).collect();
        Triangulation::new(&places, &[]).expect("different points").mesh(&z)
    })
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(500) })]

    #[test]
    fn every_cell_has_the_elevation_of_its_first_triangle(mesh in meshes(), rows in 1..11_usize, cols in 1..11_usize) {
        let z = scan(&mesh, rows, cols);
        for (i, z) in z.iter().enumerate() {
            let wanted = elevation(&mesh, (i % cols) as f64, (i / cols) as f64);
            prop_assert_eq!(!z.is_nan(), wanted.is_some(), "cell {}: {} and {:?}", i, z, wanted);
            prop_assert!(wanted.is_none_or(|wanted| (z - wanted).abs() < 1e-9), "cell {i}: {z} and {wanted:?}");
        }
    }

    #[test]
    fn a_regular_mesh_comes_back(heights in rasters()) {
        let mesh = regular(&heights);
        let z = scan(&mesh, heights.rows(), heights.cols());
        let mut wanted = vec![f64::NAN; z.len()];
        for v in &mesh.vertices {
            wanted[v[1] as usize * heights.cols() + v[0] as usize] = v[2];
        }
        prop_assert!(z.iter().zip(&wanted).all(|(a, b)| (a - b).abs() < 1e-9 || a.is_nan() && b.is_nan()), "{z:?}");
    }
}

#[test]
fn nothing_depends_on_threads() {
    let wave = |i: usize| ((i % 300) as f64 / 20.0).sin() * ((i / 300) as f64 / 31.0).cos() * 100.0;
    let heights = orograph::tin::Heights::new(400, 300, (0..400 * 300).map(wave).collect()).unwrap();
    let options = RefineOptions { max_error_m: 1.0, max_vertices: None };
    let mesh = refine(&heights, &Breaklines::default(), options, &Watch::default()).unwrap().mesh;
    let drawn = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| scan(&mesh, 400, 300)).into_iter().map(f64::to_bits).collect::<Vec<_>>()
    };
    let one = drawn(1);
    assert_eq!(one, drawn(3));
    for (bits, z) in one.iter().zip(heights.z_m()) {
        assert!((f64::from_bits(*bits) - z).abs() <= 1.0 + 1e-9, "within the error all over");
    }
}

#[test]
fn coordinates_are_known_in_parts_of_a_cell() {
    assert_eq!(snapped(1.0), 1.0);
    assert_eq!(snapped(0.3), (0.3 * SUBCELLS).round() / SUBCELLS);
    assert!((snapped(-7.77) + 7.77).abs() <= 0.5 / SUBCELLS);
}
