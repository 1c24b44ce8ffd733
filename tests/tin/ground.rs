//! Where a mesh of a raster is and where it is not.

use super::{area, elevation, has, places, rasters};
use orograph::tin::{Breaklines, RefineOptions, refine, regular};
use orograph::watch::Watch;
use proptest::prelude::*;

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(400) })]

    #[test]
    fn a_regular_mesh_is_the_squares_with_data(heights in rasters()) {
        let mesh = regular(&heights);
        prop_assert_eq!(mesh.check(), Ok(()));
        let (rows, cols) = (heights.rows() as i64, heights.cols() as i64);
        let mut wanted = 0.0;
        for y in 0..rows {
            for x in 0..cols {
                let filled = |x, y| [(x, y), (x + 1, y), (x, y + 1), (x + 1, y + 1)].iter().filter(|p| has(&heights, p.0, p.1)).count();
                wanted += match filled(x, y) { 4 => 1.0, 3 => 0.5, _ => 0.0 };
                let is_vertex = has(&heights, x, y) && (0..4).any(|i| filled(x - i % 2, y - i / 2) >= 3);
                prop_assert_eq!(places(&mesh).contains(&[x, y]), is_vertex, "column {}, row {}", x, y);
            }
        }
        prop_assert_eq!(area(&mesh), wanted);
    }

    #[test]
    fn a_refined_mesh_covers_what_the_regular_one_does(heights in rasters(), max_error_m in 0..8_i32) {
        let whole = regular(&heights);
        let options = RefineOptions { max_error_m: f64::from(max_error_m), max_vertices: None };
        let refined = refine(&heights, &Breaklines::default(), options, &Watch::default());
        if whole.triangles.is_empty() {
            prop_assert!(refined.unwrap_err().to_string().contains("nothing to triangulate"));
            return Ok(());
        }
        let refined = refined.unwrap();
        prop_assert_eq!(refined.mesh.check(), Ok(()));
        prop_assert_eq!(area(&refined.mesh), area(&whole));
        let again = refine(&heights, &Breaklines::default(), options, &Watch::default()).unwrap();
        prop_assert_eq!(&again, &refined, "equal inputs, equal meshes");
        let data = heights.z_m().iter().filter(|z| !z.is_nan()).count();
        prop_assert_eq!(refined.uncovered as usize, data - whole.vertices.len());
        let mut worst = 0.0_f64;
        for &[x, y, z] in &whole.vertices {
            let surface = elevation(&refined.mesh, x, y);
            prop_assert!(surface.is_some(), "column {x}, row {y} is not covered");
            worst = worst.max((surface.unwrap() - z).abs());
        }
        prop_assert!(worst <= options.max_error_m + 1e-9, "{worst} m");
        prop_assert!((worst - refined.error_m).abs() < 1e-9, "{worst} m, said to be {}", refined.error_m);
        let vertices = places(&refined.mesh);
        for [x, y] in places(&whole) {
            let is_beside = (-1..=1).any(|dy| (-1..=1).any(|dx| {
                let (x, y) = (x + dx, y + dy);
                (0..heights.cols() as i64).contains(&x) && (0..heights.rows() as i64).contains(&y) && !has(&heights, x, y)
            }));
            prop_assert!(!is_beside || vertices.contains(&[x, y]), "column {x}, row {y} is beside a void");
        }
    }
}
