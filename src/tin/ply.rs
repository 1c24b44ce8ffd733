//! PLY (Stanford polygon file), binary and little-endian.

use super::mesh::Mesh;
use std::io::{BufWriter, Result, Write};

/// Bytes that are gathered before they are written.
const BUFFER: usize = 1 << 20;

/// How to write a mesh as PLY.
#[derive(Clone, Debug, Default)]
pub struct PlyOptions {
    /// What is taken away from all coordinates.
    pub origin: [f64; 3],
    /// Whether vertices get normals, `nx ny nz` as 32-bit floats.
    pub normals: bool,
    /// Comments for the header, which should state the origin where there is one.
    pub remarks: Vec<String>,
}

/// Writes a mesh as PLY 1.0: vertices `x y z` as 64-bit floats, z up, and faces as `list uchar int vertex_indices`.
///
/// # Errors
/// Those of `out`; [`std::io::ErrorKind::InvalidInput`] for more vertices than a signed 32-bit number counts.
pub fn write_ply(mesh: &Mesh, options: &PlyOptions, out: &mut impl Write) -> Result<()> {
    if i32::try_from(mesh.vertices.len()).is_err() {
        let message = format!("{} vertices are more than a PLY file of 32-bit indices can have", mesh.vertices.len());
        return Err(std::io::Error::new(std::io::ErrorKind::InvalidInput, message));
    }
    let mut out = BufWriter::with_capacity(BUFFER, out);
    writeln!(out, "ply\nformat binary_little_endian 1.0")?;
    for remark in options.remarks.iter().flat_map(|remark| remark.lines()) {
        writeln!(out, "comment {remark}")?;
    }
    writeln!(out, "element vertex {}", mesh.vertices.len())?;
    writeln!(out, "property double x\nproperty double y\nproperty double z")?;
    if options.normals {
        writeln!(out, "property float nx\nproperty float ny\nproperty float nz")?;
    }
    writeln!(out, "element face {}", mesh.triangles.len())?;
    writeln!(out, "property list uchar int vertex_indices\nend_header")?;
    let normals = if options.normals { mesh.normals() } else { Vec::new() };
    for (i, vertex) in mesh.vertices.iter().enumerate() {
        for (v, o) in vertex.iter().zip(options.origin) {
            out.write_all(&(v - o).to_le_bytes())?;
        }
        #[allow(clippy::cast_possible_truncation, reason = "normals have this precision in the file")]
        for v in normals.get(i).into_iter().flatten() {
            out.write_all(&(*v as f32).to_le_bytes())?;
        }
    }
    for triangle in &mesh.triangles {
        out.write_all(&[3])?;
        for v in triangle {
            out.write_all(&v.to_le_bytes())?;
        }
    }
    out.flush()
}
