//! Small readers of mesh files: strict, and only for what is written here.

use serde_json::Value;

/// A mesh as it stands in a file.
#[derive(Debug, Default, PartialEq)]
pub(crate) struct MeshFile {
    /// x, y and z, z up, without the origin that was taken away.
    pub(crate) vertices: Vec<[f64; 3]>,
    /// Positions of vertices, from 0.
    pub(crate) triangles: Vec<[u32; 3]>,
    /// Normals of the vertices, where there are some.
    pub(crate) normals: Vec<[f32; 3]>,
    /// Comments, or the JSON part.
    pub(crate) remarks: Vec<String>,
    /// The JSON part of a glTF file.
    pub(crate) document: Value,
}

/// Reads Wavefront OBJ.
pub(crate) fn read_obj(bytes: &[u8]) -> MeshFile {
    let mut mesh = MeshFile::default();
    for line in std::str::from_utf8(bytes).expect("text").lines() {
        let (kind, rest) = line.split_once(' ').expect("a kind and values");
        let words: Vec<&str> = rest.split(' ').collect();
        match kind {
            "#" => mesh.remarks.push(rest.into()),
            "v" => mesh.vertices.push(std::array::from_fn(|i| words[i].parse().expect("a number"))),
            "f" => mesh.triangles.push(std::array::from_fn(|i| words[i].parse::<u32>().expect("a position") - 1)),
            other => panic!("'{other}' in an OBJ file"),
        }
        assert!(kind == "#" || words.len() == 3, "{line}");
    }
    mesh
}

/// Takes so many bytes off the front.
fn take<'a>(bytes: &mut &'a [u8], n: usize) -> &'a [u8] {
    let (head, tail) = bytes.split_at(n);
    *bytes = tail;
    head
}

fn word(bytes: &mut &[u8]) -> u32 {
    u32::from_le_bytes(take(bytes, 4).try_into().expect("four bytes"))
}

fn single(bytes: &mut &[u8]) -> f32 {
    f32::from_bits(word(bytes))
}

/// Reads PLY.
pub(crate) fn read_ply(bytes: &[u8]) -> MeshFile {
    let end = bytes.windows(11).position(|part| part == b"end_header\n").expect("a header") + 11;
    let header = std::str::from_utf8(&bytes[..end]).expect("text");
    let mut rest = &bytes[end..];
    let mut mesh = MeshFile::default();
    let mut lines: Vec<&str> = header.lines().collect();
    lines.retain(|line| match line.strip_prefix("comment ") {
        Some(remark) => {
            mesh.remarks.push(remark.into());
            false
        }
        None => true,
    });
    let number = |line: &str| line.rsplit(' ').next().and_then(|n| n.parse::<usize>().ok()).expect("a count");
    assert_eq!(lines[..2], ["ply", "format binary_little_endian 1.0"]);
    assert!(lines[2].starts_with("element vertex "));
    assert_eq!(lines[3..6], ["property double x", "property double y", "property double z"]);
    let has_normals = lines[6] == "property float nx";
    let faces = if has_normals { 9 } else { 6 };
    assert!(lines[faces].starts_with("element face "));
    assert_eq!(lines[faces + 1..], ["property list uchar int vertex_indices", "end_header"]);
    for _ in 0..number(lines[2]) {
        let double = |_| f64::from_le_bytes(take(&mut rest, 8).try_into().expect("eight bytes"));
        mesh.vertices.push([0; 3].map(double));
        if has_normals {
            mesh.normals.push([0; 3].map(|_| single(&mut rest)));
        }
    }
    for _ in 0..number(lines[faces]) {
        assert_eq!(take(&mut rest, 1), [3]);
        mesh.triangles.push([0; 3].map(|_| word(&mut rest)));
    }
    assert!(rest.is_empty(), "{} bytes too many", rest.len());
    mesh
}

/// Reads binary glTF with one mesh, and checks the rules of the specification that concern it.
pub(crate) fn read_glb(bytes: &[u8]) -> MeshFile {
    let mut rest = bytes;
    assert_eq!(take(&mut rest, 4), b"glTF");
    assert_eq!(word(&mut rest), 2, "the version");
    assert_eq!(word(&mut rest) as usize, bytes.len(), "the length of the whole");
    let length = word(&mut rest) as usize;
    assert_eq!(word(&mut rest), 0x4E4F_534A, "the first chunk is JSON");
    assert_eq!(length % 4, 0, "chunks are aligned");
    let text = std::str::from_utf8(take(&mut rest, length)).expect("UTF-8");
    let document: Value = serde_json::from_str(text).expect("JSON");
    let length = word(&mut rest) as usize;
    assert_eq!(word(&mut rest), 0x004E_4942, "the second chunk is binary");
    assert_eq!((length % 4, rest.len()), (0, length), "and the last");
    let count = |v: &Value| v.as_u64().expect("a whole number") as usize;
    assert_eq!(document["asset"]["version"], "2.0");
    assert_eq!(count(&document["buffers"][0]["byteLength"]), rest.len());
    let primitive = &document["meshes"][0]["primitives"][0];
    assert_eq!(primitive["mode"], 4, "triangles");
    // The bytes of an accessor, each number of four bytes.
    let numbers = |accessor: &Value, kind: &str, component: u32, target: u32| -> Vec<[u8; 4]> {
        let accessor = &document["accessors"][count(accessor)];
        assert_eq!((&accessor["type"], &accessor["componentType"]), (&kind.into(), &component.into()));
        let view = &document["bufferViews"][count(&accessor["bufferView"])];
        assert_eq!((&view["buffer"], &view["target"]), (&0.into(), &target.into()));
        let (offset, length) = (count(&view["byteOffset"]), count(&view["byteLength"]));
        let width = if kind == "VEC3" { 12 } else { 4 };
        assert_eq!((offset % 4, length), (0, count(&accessor["count"]) * width));
        rest[offset..offset + length].chunks_exact(4).map(|four| four.try_into().expect("four bytes")).collect()
    };
    let vectors = |accessor: &Value| -> Vec<[f32; 3]> {
        let all = numbers(accessor, "VEC3", 5126, 34962);
        all.chunks_exact(3).map(|three| std::array::from_fn(|i| f32::from_le_bytes(three[i]))).collect()
    };
    let positions = vectors(&primitive["attributes"]["POSITION"]);
    let accessor = &document["accessors"][count(&primitive["attributes"]["POSITION"])];
    for i in 0..3 {
        let all = || positions.iter().map(|p| f64::from(p[i]));
        assert_eq!(accessor["min"][i].as_f64(), all().reduce(f64::min));
        assert_eq!(accessor["max"][i].as_f64(), all().reduce(f64::max));
    }
    let normals = vectors(&primitive["attributes"]["NORMAL"]);
    assert_eq!(normals.len(), positions.len());
    for normal in &normals {
        let length = normal.iter().map(|&v| f64::from(v).powi(2)).sum::<f64>().sqrt();
        assert!((length - 1.0).abs() < 1e-5, "{normal:?}");
    }
    let indices = numbers(&primitive["indices"], "SCALAR", 5125, 34963);
    assert_eq!(indices.len() % 3, 0);
    let up = |[x, y, z]: [f32; 3]| [x, -z, y];
    MeshFile {
        vertices: positions.into_iter().map(|p| up(p).map(f64::from)).collect(),
        triangles: indices.chunks_exact(3).map(|t| std::array::from_fn(|i| u32::from_le_bytes(t[i]))).collect(),
        normals: normals.into_iter().map(up).collect(),
        remarks: Vec::new(),
        document,
    }
}
