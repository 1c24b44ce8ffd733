//! Which cells refinement chooses, and lines that are kept.

use super::{area, elevation, places, rasters};
use orograph::tin::{Breaklines, Heights, RefineOptions, Triangulation, refine, regular};
use orograph::watch::Watch;
use proptest::prelude::*;
use std::collections::BTreeSet;

fn options(max_error_m: f64) -> RefineOptions {
    RefineOptions { max_error_m, max_vertices: None }
}

/// Greedy insertion that looks at every cell of every triangle before each vertex; for rasters without voids.
fn slow_greedy(heights: &Heights, max_error_m: f64, max_vertices: usize) -> (BTreeSet<[i64; 2]>, f64) {
    let (rows, cols) = (heights.rows() as i64, heights.cols() as i64);
    let z = |p: [i64; 2]| heights.z_m()[(p[1] * cols + p[0]) as usize];
    let corners = [[0, 0], [cols - 1, 0], [0, rows - 1], [cols - 1, rows - 1]];
    let mut made = Triangulation::new(&corners.map(|p| p.map(|v| v as f64)), &[]).expect("four corners");
    loop {
        let mut worst: Option<(f64, [i64; 2], u32)> = None;
        for triangle in made.triangles() {
            let mut places = triangle.map(|v| made.point(v).map(|v| v as i64));
            places.sort_by_key(|p| (p[1], p[0]));
            let [a, b, c] = places;
            let cross =
                |p: [i64; 2], q: [i64; 2], r: [i64; 2]| (q[0] - p[0]) * (r[1] - p[1]) - (r[0] - p[0]) * (q[1] - p[1]);
            let turn = cross(a, b, c).signum();
            let (bz, cz) = (z(b) - z(a), z(c) - z(a));
            let det = cross(a, b, c) as f64;
            let slope_x = (bz * (c[1] - a[1]) as f64 - cz * (b[1] - a[1]) as f64) / det;
            let slope_y = ((b[0] - a[0]) as f64 * cz - (c[0] - a[0]) as f64 * bz) / det;
            for y in 0..rows {
                // As a row begins, so it goes on: the same rounding as the fast one's.
                let inside: Vec<i64> = (0..cols)
                    .filter(|&x| [(a, b), (b, c), (c, a)].iter().all(|&(p, q)| cross(p, q, [x, y]) * turn >= 0))
                    .collect();
                for &x in &inside {
                    let begin = z(a) + slope_x * (inside[0] - a[0]) as f64 + slope_y * (y - a[1]) as f64;
                    let error = (z([x, y]) - (begin + slope_x * (x - inside[0]) as f64)).abs();
                    let is_worse =
                        worst.is_none_or(|(most, [wx, wy], _)| error > most || error == most && (y, x) < (wy, wx));
                    if is_worse {
                        worst = Some((error, [x, y], triangle[0]));
                    }
                }
            }
        }
        let (error, place, near) = worst.expect("there are cells");
        if error <= max_error_m || made.vertices() >= max_vertices {
            let vertices = (0..made.vertices() as u32).map(|v| made.point(v).map(|v| v as i64)).collect();
            return (vertices, error);
        }
        made.insert(place.map(|v| v as f64), near).expect("a cell");
    }
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(300) })]

    #[test]
    fn the_worst_cell_comes_next(heights in rasters(), max_error in 0..12_i32, max_vertices in 4..40_usize) {
        prop_assume!(!heights.has_voids());
        let max_error_m = f64::from(max_error) / 2.0;
        let made = refine(
            &heights,
            &Breaklines::default(),
            RefineOptions { max_error_m, max_vertices: Some(max_vertices) },
            &Watch::default(),
        ).unwrap();
        let (vertices, error_m) = slow_greedy(&heights, max_error_m, max_vertices);
        prop_assert_eq!(places(&made.mesh).into_iter().collect::<BTreeSet<_>>(), vertices);
        prop_assert!((made.error_m - error_m).abs() < 1e-9, "{} m, slowly {error_m} m", made.error_m);
    }

    #[test]
    fn lines_are_edges(
        heights in rasters(),
        lines in prop::collection::vec(prop::collection::vec([-2.0..10.0_f64, -2.0..10.0_f64], 2..5), 1..5),
    ) {
        prop_assume!(!regular(&heights).triangles.is_empty());
        let lines = Breaklines::new(&lines, &heights);
        let mesh = refine(&heights, &lines, options(2.0), &Watch::default()).unwrap().mesh;
        prop_assert_eq!(mesh.check(), Ok(()));
        prop_assert_eq!(area(&mesh), area(&regular(&heights)));
        let again = refine(&heights, &lines, options(2.0), &Watch::default()).unwrap().mesh;
        prop_assert_eq!(&again, &mesh, "equal inputs, equal meshes");
        let vertices: BTreeSet<[i64; 2]> = places(&mesh).into_iter().collect();
        let cols = heights.cols() as i64;
        let cross = |p: [i64; 2], q: [i64; 2], r: [i64; 2]| (q[0] - p[0]) * (r[1] - p[1]) - (r[0] - p[0]) * (q[1] - p[1]);
        for edge in lines.edges() {
            let [a, b] = edge.map(|cell| [i64::from(cell) % cols, i64::from(cell) / cols]);
            prop_assert!(vertices.contains(&a) && vertices.contains(&b), "{a:?} and {b:?} are vertices");
            for triangle in &mesh.triangles {
                let corners = triangle.map(|v| mesh.vertices[v as usize]).map(|v| [v[0] as i64, v[1] as i64]);
                for (i, &p) in corners.iter().enumerate() {
                    let q = corners[(i + 1) % 3];
                    let crosses = cross(a, b, p).signum() * cross(a, b, q).signum() < 0
                        && cross(p, q, a).signum() * cross(p, q, b).signum() < 0;
                    prop_assert!(!crosses, "{p:?} to {q:?} crosses the line from {a:?} to {b:?}");
                }
            }
        }
        for &[x, y, z] in &regular(&heights).vertices {
            prop_assert!((elevation(&mesh, x, y).unwrap() - z).abs() <= 2.0 + 1e-9);
        }
    }
}

#[test]
fn a_plane_needs_its_corners_only() {
    let z = (0..20 * 30).map(|i| 3.0 * f64::from(i % 30) - 2.0 * f64::from(i / 30)).collect();
    let made = refine(&Heights::new(20, 30, z).unwrap(), &Breaklines::default(), options(0.0), &Watch::default());
    let made = made.unwrap();
    assert_eq!((made.mesh.vertices.len(), made.mesh.triangles.len(), made.error_m), (4, 2, 0.0));
}

#[test]
fn too_few_vertices_are_refused() {
    let mut z = vec![1.0; 25];
    z[12] = f64::NAN;
    let heights = Heights::new(5, 5, z).unwrap();
    let options = RefineOptions { max_error_m: 1.0, max_vertices: Some(11) };
    let error = refine(&heights, &Breaklines::default(), options, &Watch::default()).unwrap_err().to_string();
    assert!(error.contains("12 vertices are needed"), "{error}");
}

#[test]
fn an_interrupt_ends_it() {
    let watch = Watch::default();
    watch.cancel();
    let heights = Heights::new(2, 2, vec![0.0; 4]).unwrap();
    let error = refine(&heights, &Breaklines::default(), options(1.0), &watch).unwrap_err();
    assert_eq!(error.kind(), orograph::error::ErrorKind::Interrupted);
}

#[test]
fn rasters_that_are_too_large_are_refused() {
    assert!(Heights::admit(1 << 20, 4000).is_ok());
    assert!(Heights::admit(1 << 20, 4096).is_err());
    assert!(Heights::admit((1 << 20) + 1, 1).is_err());
}
