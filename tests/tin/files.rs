//! Mesh files come back as what was written.

use super::mesh_files::{read_glb, read_obj, read_ply};
use super::rasters;
use orograph::tin::{GlbOptions, Mesh, PlyOptions, regular, write_glb, write_obj, write_ply};
use proptest::prelude::*;
use serde_json::json;

/// A mesh far from the origin of its coordinates.
fn far() -> impl Strategy<Value = Mesh> {
    rasters().prop_filter_map("triangles", |heights| {
        let mut mesh = regular(&heights);
        for v in &mut mesh.vertices {
            *v = [566_609.3 + 30.0 * v[0], 5_163_305.7 - 30.0 * v[1], v[2] * 1.1 - 20.0];
        }
        mesh.turn_over();
        (!mesh.triangles.is_empty()).then_some(mesh)
    })
}

const ORIGIN: [f64; 3] = [566_000.0, 5_163_000.0, 0.0];

/// Whether vertices are those of a mesh, less the origin, within a distance.
fn same(read: &[[f64; 3]], mesh: &Mesh, origin: [f64; 3], within: f64) -> bool {
    let near = |(a, b): (&[f64; 3], &[f64; 3])| (0..3).all(|i| (a[i] + origin[i] - b[i]).abs() <= within);
    read.len() == mesh.vertices.len() && read.iter().zip(&mesh.vertices).all(near)
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(50) })]

    #[test]
    fn what_is_written_is_read(mesh in far(), normals in any::<bool>()) {
        prop_assert_eq!(mesh.check(), Ok(()));
        let remarks = vec!["two\nlines".to_string(), "one".into()];
        let lines = ["two", "lines", "one"];

        let mut bytes = Vec::new();
        write_obj(&mesh, ORIGIN, &remarks, &mut bytes).unwrap();
        let read = read_obj(&bytes);
        // Adding the origin may round anew.
        prop_assert!(same(&read.vertices, &mesh, ORIGIN, 2e-9));
        prop_assert_eq!((&read.triangles, &read.remarks[..]), (&mesh.triangles, &lines.map(String::from)[..]));

        let mut bytes = Vec::new();
        write_ply(&mesh, &PlyOptions { origin: [0.0; 3], normals, remarks }, &mut bytes).unwrap();
        let read = read_ply(&bytes);
        prop_assert!(same(&read.vertices, &mesh, [0.0; 3], 0.0), "to the bit");
        prop_assert_eq!((&read.triangles, &read.remarks[..]), (&mesh.triangles, &lines.map(String::from)[..]));
        prop_assert_eq!(read.normals.len(), if normals { mesh.vertices.len() } else { 0 });

        let mut bytes = Vec::new();
        let extras = json!({ "crs": "somewhere" }).as_object().unwrap().clone();
        write_glb(&mesh, &GlbOptions { origin: ORIGIN, name: "name".into(), extras }, &mut bytes).unwrap();
        let read = read_glb(&bytes);
        // Half a step of single precision at a kilometre.
        prop_assert!(same(&read.vertices, &mesh, ORIGIN, 3.1e-5));
        prop_assert_eq!(&read.triangles, &mesh.triangles);
        for (read, own) in read.normals.iter().zip(mesh.normals()) {
            prop_assert!((0..3).all(|i| (f64::from(read[i]) - own[i]).abs() < 1e-7), "{read:?} {own:?}");
        }
        prop_assert_eq!(&read.document["extras"]["origin"], &json!(ORIGIN));
        prop_assert_eq!(&read.document["extras"]["crs"], "somewhere");
    }
}

#[test]
fn a_mesh_of_nothing_is_no_gltf() {
    let error = write_glb(&Mesh::default(), &GlbOptions::default(), &mut Vec::new()).unwrap_err();
    assert_eq!(error.kind(), std::io::ErrorKind::InvalidInput);
}
