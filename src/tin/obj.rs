//! Wavefront OBJ: text.

use super::mesh::Mesh;
use std::io::{BufWriter, Result, Write};

/// Bytes that are gathered before they are written.
const BUFFER: usize = 1 << 20;

/// Writes a mesh as Wavefront OBJ: `v x y z` and `f a b c`, z up, positions counted from 1.
///
/// Coordinates are written less `origin`, with as many digits as it takes to read the same number again. Programs that
/// draw keep them in single precision, which has steps of half a metre at a northing of 5,000 km: an origin near the
/// mesh avoids them. Each line of `remarks` becomes a comment at the top, where the origin should be stated.
///
/// # Errors
/// Those of `out`.
pub fn write_obj(mesh: &Mesh, origin: [f64; 3], remarks: &[String], out: &mut impl Write) -> Result<()> {
    let mut out = BufWriter::with_capacity(BUFFER, out);
    for remark in remarks.iter().flat_map(|remark| remark.lines()) {
        writeln!(out, "# {remark}")?;
    }
    let (mut real, mut integer) = (ryu::Buffer::new(), itoa::Buffer::new());
    for vertex in &mesh.vertices {
        out.write_all(b"v")?;
        for (v, o) in vertex.iter().zip(origin) {
            let v = v - o;
            out.write_all(b" ")?;
            if v.fract() == 0.0 && v.abs() < 1e15 {
                out.write_all(integer.format(v as i64).as_bytes())?;
            } else {
                out.write_all(real.format_finite(v).as_bytes())?;
            }
        }
        out.write_all(b"\n")?;
    }
    for triangle in &mesh.triangles {
        out.write_all(b"f")?;
        for &v in triangle {
            out.write_all(b" ")?;
            out.write_all(integer.format(u64::from(v) + 1).as_bytes())?;
        }
        out.write_all(b"\n")?;
    }
    out.flush()
}
