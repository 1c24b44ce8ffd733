//! Triangulations against slow, literal references.

#![cfg(feature = "program")]

mod files;
mod ground;
#[path = "../mesh_files/mod.rs"]
mod mesh_files;
mod refinement;
mod scanning;

use orograph::tin::{Heights, Mesh};
use proptest::prelude::*;

/// Small rasters with few different elevations, so that ties are many, and voids.
fn rasters() -> impl Strategy<Value = Heights> {
    let cell = prop_oneof![8 => (0..6_i32).prop_map(f64::from), 1 => Just(f64::NAN)];
    let full = (0..60_i32).prop_map(|v| f64::from(v) / 4.0);
    (2..9_usize, 2..9_usize, any::<bool>()).prop_flat_map(move |(rows, cols, voids)| {
        let cell = if voids { cell.clone().boxed() } else { full.clone().boxed() };
        prop::collection::vec(cell, rows * cols).prop_map(move |z| Heights::new(rows, cols, z).expect("it is small"))
    })
}

fn has(heights: &Heights, x: i64, y: i64) -> bool {
    let inside = x >= 0 && y >= 0 && x < heights.cols() as i64 && y < heights.rows() as i64;
    inside && !heights.z_m()[y as usize * heights.cols() + x as usize].is_nan()
}

/// Elevation of a mesh at a place, by looking at every triangle.
fn elevation(mesh: &Mesh, x: f64, y: f64) -> Option<f64> {
    mesh.triangles.iter().find_map(|triangle| {
        let [a, b, c] = triangle.map(|v| mesh.vertices[v as usize]);
        let area2 = |p: [f64; 3], q: [f64; 3]| (p[0] - x) * (q[1] - y) - (q[0] - x) * (p[1] - y);
        let weights = [area2(b, c), area2(c, a), area2(a, b)];
        let sum: f64 = weights.iter().sum();
        let is_inside = weights.iter().all(|&w| w >= 0.0) && sum > 0.0;
        is_inside.then(|| (weights[0] * a[2] + weights[1] * b[2] + weights[2] * c[2]) / sum)
    })
}

/// Area of a mesh in cells.
fn area(mesh: &Mesh) -> f64 {
    let area2 = |[a, b, c]: [[f64; 3]; 3]| (b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1]);
    mesh.triangles.iter().map(|triangle| area2(triangle.map(|v| mesh.vertices[v as usize]))).sum::<f64>() / 2.0
}

/// The cells that are vertices of a mesh: column and row.
fn places(mesh: &Mesh) -> Vec<[i64; 2]> {
    mesh.vertices.iter().map(|v| [v[0] as i64, v[1] as i64]).collect()
}
