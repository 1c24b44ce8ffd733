//! Meshes into files.

use super::super::layers::TrianglesLayer;
use super::place::Placed;
use crate::crs::Crs;
use crate::error::{Error, ErrorKind, Result};
use crate::io::output::Output;
use crate::io::vector::Writer;
use crate::tin::{GlbOptions, Mesh, PlyOptions, write_glb, write_obj, write_ply};
use crate::watch::Watch;
use serde_json::json;
use std::fs::File;
use std::path::Path;

/// A format of meshes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MeshFormat {
    /// Wavefront OBJ, relative to an origin.
    Obj,
    /// PLY with double precision and coordinates as they are.
    Ply,
    /// Binary glTF, relative to an origin.
    Glb,
    /// A layer of triangles with z in the raster's own CRS.
    GeoPackage,
}

impl MeshFormat {
    /// The format that a file's extension stands for.
    ///
    /// # Errors
    /// A usage error that names the known extensions.
    pub fn of(path: &Path) -> Result<Self> {
        let extension = path.extension().map(|e| e.to_string_lossy().to_ascii_lowercase()).unwrap_or_default();
        match extension.as_str() {
            "obj" => Ok(Self::Obj),
            "ply" => Ok(Self::Ply),
            "glb" => Ok(Self::Glb),
            "gpkg" => Ok(Self::GeoPackage),
            _ => Err(Error::usage(format!(
                "the extension '{extension}' is not that of a mesh: expected .obj, .ply, .glb or .gpkg"
            ))
            .at_path(path)),
        }
    }
}

/// What a file says of its origin.
pub(in crate::pipeline) struct Provenance<'a> {
    /// The command that makes it.
    pub(in crate::pipeline) command: &'a str,
    /// The file that it is made of.
    pub(in crate::pipeline) input: &'a Path,
    /// That file's CRS.
    pub(in crate::pipeline) crs: Option<&'a Crs>,
    pub(in crate::pipeline) placed: &'a Placed,
    pub(in crate::pipeline) origin: [f64; 3],
    pub(in crate::pipeline) error_m: f64,
}

impl Provenance<'_> {
    /// Keys and values: nothing that differs from run to run.
    fn facts(&self) -> Vec<(&'static str, String)> {
        let mut facts = vec![
            ("command", self.command.to_string()),
            ("version", env!("CARGO_PKG_VERSION").to_string()),
            ("input", self.input.display().to_string()),
            ("error_m", self.error_m.to_string()),
        ];
        let coordinates = match (self.placed, self.crs) {
            (Placed::Kept, _) => return facts,
            (Placed::Plane(plane, _), _) => plane.definition().to_string(),
            (Placed::Metres(metres), Some(crs)) if *metres != 1.0 => {
                format!("{} in metres ({metres} a unit)", crs.label())
            }
            (Placed::Metres(_), Some(crs)) => crs.label().to_string(),
            (Placed::Metres(_), None) => "no CRS".to_string(),
        };
        facts.push(("crs", coordinates));
        facts.push(("unit", "metre".into()));
        facts
    }

    /// The facts as lines of text, with the origin.
    fn remarks(&self) -> Vec<String> {
        let [x, y, z] = self.origin;
        let facts = self.facts().into_iter().map(|(key, value)| format!("{key}: {value}"));
        facts.chain([format!("origin: {x} {y} {z} (to be added to all coordinates)")]).collect()
    }
}

/// Where a mesh will be written.
pub(in crate::pipeline) enum Target {
    Mesh(Output, MeshFormat),
    Layer(Writer),
}

impl Target {
    /// Prepares the output.
    ///
    /// # Errors
    /// As [`Output::begin`].
    pub(in crate::pipeline) fn begin(path: &Path, format: MeshFormat, overwrite: bool) -> Result<Self> {
        match format {
            MeshFormat::GeoPackage => Writer::begin(path, &["triangles"], overwrite).map(Self::Layer),
            _ => Output::begin(path, overwrite).map(|output| Self::Mesh(output, format)),
        }
    }

    /// Writes the mesh and puts the file in its place.
    ///
    /// # Errors
    /// A full disk or another failure to write, a mesh that the format cannot have, or an interrupt; then no file is
    /// changed.
    pub(in crate::pipeline) fn write(self, mesh: &Mesh, provenance: &Provenance<'_>, watch: &Watch) -> Result<()> {
        let (output, format) = match self {
            Self::Layer(writer) => {
                let metadata: Vec<(String, String)> = provenance
                    .facts()
                    .into_iter()
                    .map(|(key, value)| (format!("OROGRAPH_{}", key.to_uppercase()), value))
                    .collect();
                return writer.write(&[&TrianglesLayer::new(mesh)], provenance.crs, &metadata, watch);
            }
            Self::Mesh(output, format) => (output, format),
        };
        let wrong = |error: std::io::Error| {
            let (kind, message) = match error.kind() {
                std::io::ErrorKind::InvalidInput => (ErrorKind::Unsupported, error.to_string()),
                _ => (ErrorKind::Output, format!("the mesh cannot be written ({error}); is there room left?")),
            };
            Error::new(kind, message).at_path(output.target())
        };
        let mut file = Watched { file: File::create(output.path()).map_err(wrong)?, watch };
        let origin = provenance.origin;
        let written = match format {
            MeshFormat::Obj => write_obj(mesh, origin, &provenance.remarks(), &mut file),
            MeshFormat::Ply => {
                let options = PlyOptions { origin, normals: true, remarks: provenance.remarks() };
                write_ply(mesh, &options, &mut file)
            }
            _ => {
                let extras =
                    provenance.facts().into_iter().map(|(key, value)| (key.to_string(), json!(value))).collect();
                let name = provenance.input.file_stem().map(|stem| stem.to_string_lossy().into_owned());
                write_glb(mesh, &GlbOptions { origin, name: name.unwrap_or_default(), extras }, &mut file)
            }
        };
        // An interrupt shows as a failure to write.
        watch.check()?;
        written.map_err(wrong)?;
        drop(file);
        output.finish()
    }
}

/// A file that takes no more once the job is cancelled.
struct Watched<'a> {
    file: File,
    watch: &'a Watch,
}

impl std::io::Write for Watched<'_> {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        self.watch.check().map_err(std::io::Error::other)?;
        self.file.write(bytes)
    }

    fn flush(&mut self) -> std::io::Result<()> {
        self.file.flush()
    }
}
