//! glTF 2.0, binary (Khronos Group 2021, "glTF 2.0 Specification").

use super::mesh::Mesh;
use serde_json::{Map, Value, json};
use std::io::{BufWriter, Error, ErrorKind, Result, Write};

/// Bytes that are gathered before they are written.
const BUFFER: usize = 1 << 20;

/// Codes of the specification: types of components, targets of buffer views, types of chunks.
const FLOAT: u32 = 5126;
const UNSIGNED_INT: u32 = 5125;
const ARRAY_BUFFER: u32 = 34962;
const ELEMENT_ARRAY_BUFFER: u32 = 34963;
const JSON: u32 = 0x4E4F_534A;
const BIN: u32 = 0x004E_4942;

/// How to write a mesh as glTF.
#[derive(Clone, Debug, Default)]
pub struct GlbOptions {
    /// What is taken away from all coordinates, before they are rounded to single precision.
    pub origin: [f64; 3],
    /// Name of the mesh.
    pub name: String,
    /// What else is to stand in the file's `extras`.
    pub extras: Map<String, Value>,
}

/// Writes a mesh as one binary glTF file: positions and normals as 32-bit floats, indices as 32-bit integers.
///
/// glTF has y up: x stays, z becomes y and y becomes -z. `extras` of the file say so, with the `origin` whose addition
/// gives coordinates again.
///
/// # Errors
/// Those of `out`; [`ErrorKind::InvalidInput`] for a mesh without triangles, or one that would take 4 GiB or more,
/// which the format cannot have.
pub fn write_glb(mesh: &Mesh, options: &GlbOptions, out: &mut impl Write) -> Result<()> {
    let refuse = |message: &str| Err(Error::new(ErrorKind::InvalidInput, message));
    let normals = mesh.normals();
    let position = |v: &[f64; 3]| turned(std::array::from_fn(|i| v[i] - options.origin[i]));
    let Some(bounds) = bounds(mesh.vertices.iter().map(position)).filter(|_| !mesh.triangles.is_empty()) else {
        return refuse("a mesh without triangles cannot be a glTF mesh");
    };
    // All three parts are made of numbers of four bytes, so all begin at multiples of four.
    let (vertices, indices) = (mesh.vertices.len() as u64, mesh.triangles.len() as u64 * 3);
    let bytes = 24 * vertices + 4 * indices;
    let mut text = serde_json::to_vec(&document(options, vertices, indices, bounds))?;
    text.resize(text.len().next_multiple_of(4), b' ');
    let whole = 12 + 8 + text.len() as u64 + 8 + bytes;
    let Ok(whole) = u32::try_from(whole) else {
        return refuse("the mesh would take 4 GiB or more, which glTF cannot have; allow a larger error");
    };
    let mut out = BufWriter::with_capacity(BUFFER, out);
    #[allow(clippy::cast_possible_truncation, reason = "the whole has fewer bytes than 32 bits count")]
    let (json_bytes, bin_bytes) = (text.len() as u32, bytes as u32);
    out.write_all(b"glTF")?;
    put(&mut out, [2, whole].map(u32::to_le_bytes))?;
    put(&mut out, [json_bytes, JSON].map(u32::to_le_bytes))?;
    out.write_all(&text)?;
    put(&mut out, [bin_bytes, BIN].map(u32::to_le_bytes))?;
    for vertex in &mesh.vertices {
        put(&mut out, position(vertex).map(f32::to_le_bytes))?;
    }
    for &normal in &normals {
        put(&mut out, turned(normal).map(f32::to_le_bytes))?;
    }
    for triangle in &mesh.triangles {
        put(&mut out, triangle.map(u32::to_le_bytes))?;
    }
    out.flush()
}

fn put<const N: usize>(out: &mut impl Write, words: [[u8; 4]; N]) -> Result<()> {
    out.write_all(words.as_flattened())
}

/// A vector with y up, in single precision.
#[allow(clippy::cast_possible_truncation, reason = "glTF has single precision")]
fn turned([x, y, z]: [f64; 3]) -> [f32; 3] {
    // Adding 0 leaves no -0, which some programs write out.
    [x as f32, z as f32, -y as f32 + 0.0]
}

/// Least and greatest of each component, as they stand in the file.
fn bounds(mut positions: impl Iterator<Item = [f32; 3]>) -> Option<([f32; 3], [f32; 3])> {
    let first = positions.next()?;
    Some(positions.fold((first, first), |(low, high), p| {
        (std::array::from_fn(|i| low[i].min(p[i])), std::array::from_fn(|i| high[i].max(p[i])))
    }))
}

/// The JSON part of the file.
fn document(options: &GlbOptions, vertices: u64, indices: u64, (low, high): ([f32; 3], [f32; 3])) -> Value {
    let mut extras = Map::new();
    extras.insert("origin".into(), json!(options.origin));
    extras.insert("axes".into(), json!("y is up: coordinates are origin + (x, -z, y)"));
    extras.extend(options.extras.clone());
    let view = |offset: u64, length: u64, target: u32| json!({ "buffer": 0, "byteOffset": offset, "byteLength": length, "target": target });
    // A single-precision number and the double next to its text are not the same: exact ones are asked for.
    let exact = |v: [f32; 3]| v.map(f64::from);
    json!({
        "asset": { "version": "2.0", "generator": concat!("orograph ", env!("CARGO_PKG_VERSION")) },
        "extras": extras,
        "scene": 0,
        "scenes": [{ "nodes": [0] }],
        "nodes": [{ "mesh": 0, "name": options.name }],
        "meshes": [{
            "name": options.name,
            "primitives": [{ "attributes": { "POSITION": 0, "NORMAL": 1 }, "indices": 2, "material": 0, "mode": 4 }],
        }],
        "materials": [{
            "name": "terrain",
            "pbrMetallicRoughness": { "baseColorFactor": [0.72, 0.68, 0.6, 1.0], "metallicFactor": 0.0, "roughnessFactor": 1.0 },
            "doubleSided": true,
        }],
        "buffers": [{ "byteLength": 24 * vertices + 4 * indices }],
        "bufferViews": [
            view(0, 12 * vertices, ARRAY_BUFFER),
            view(12 * vertices, 12 * vertices, ARRAY_BUFFER),
            view(24 * vertices, 4 * indices, ELEMENT_ARRAY_BUFFER),
        ],
        "accessors": [
            { "bufferView": 0, "componentType": FLOAT, "count": vertices, "type": "VEC3", "min": exact(low), "max": exact(high) },
            { "bufferView": 1, "componentType": FLOAT, "count": vertices, "type": "VEC3" },
            { "bufferView": 2, "componentType": UNSIGNED_INT, "count": indices, "type": "SCALAR" },
        ],
    })
}
