//! Scenes: construction trees in JSON, as `format-spec/scene.schema.json` has them.
//!
//! A scene lies in a CRS whose unit is the metre; its coordinates count from an origin. A node is an object with one
//! member, whose name says what it is; `{"ref": "name"}` stands for a node under `"nodes"`, which may be used many times.
//! Files are asked from [`Sources`], which whoever reads the scene brings along. What is wrong is said with the node's
//! path: `$.root.blend[2].image.heights`.

mod curve;
mod drape;
mod fields;
mod image;
mod leaf;
mod node;
mod sources;

pub use sources::{Line, LineQuery, RasterQuery, Sources, SparseSource};

use super::detail::Detail;
use super::tree::{Builder, NodeId, Tree};
use crate::error::{Error, ErrorKind, Result};
use fields::Value;
use node::Reader;

/// A scene that was read.
#[derive(Clone, Debug)]
pub struct Scene {
    /// The terrain.
    pub tree: Tree,
    /// Further trees over the same ground, such as water, by name.
    pub layers: Vec<(String, Tree)>,
    /// The CRS as the file names it.
    pub crs: Option<String>,
    /// CRS coordinates of the scene's point (0, 0).
    pub origin: [f64; 2],
    /// Nodes under `"nodes"` that nothing refers to.
    pub unused: Vec<String>,
    /// Nodes with their places in the file (`$.root.blend[2].disc`), children before parents. A node may come more than
    /// once; one that was merged into another is in no tree.
    pub places: Vec<(NodeId, String)>,
    /// What a user should know of how nodes were made.
    pub notes: Vec<String>,
}

/// A scene's text, checked for what it says of itself: enough to know its CRS before its files are opened.
#[derive(Clone, Debug)]
pub struct Document {
    json: serde_json::Value,
}

impl Document {
    /// Reads a scene's text.
    ///
    /// # Errors
    /// An input error with the place in the file, for text that is no JSON or no scene, and unknown or missing members.
    pub fn parse(text: &str) -> Result<Self> {
        let json: serde_json::Value = serde_json::from_str(text).map_err(|e| {
            Error::new(ErrorKind::Input, format!("no JSON: {e}")).at_place(format!(
                "line {}, column {}",
                e.line(),
                e.column()
            ))
        })?;
        let document = Self { json };
        let scene = document.object()?;
        let format = scene.need("format")?;
        if format.text()? != "orograph-scene" {
            return Err(format.fault("a scene's format is \"orograph-scene\""));
        }
        let version = scene.need("version")?;
        if version.number()? != 1.0 {
            return Err(version.fault("this program reads version 1"));
        }
        if let Some(crs) = scene.get("crs") {
            crs.text()?;
        }
        Ok(document)
    }

    fn object(&self) -> Result<fields::Object<'_>> {
        Value::root(&self.json).object(&["format", "version", "crs", "origin", "detail", "nodes", "root", "layers"])
    }

    /// The CRS as the file names it.
    pub fn crs(&self) -> Option<&str> {
        self.json.get("crs").and_then(|crs| crs.as_str())
    }

    /// Makes the scene; `sources` opens the files that it names.
    ///
    /// # Errors
    /// As [`Scene::read`].
    pub fn scene(&self, sources: &dyn Sources) -> Result<Scene> {
        let scene = self.object()?;
        let origin = scene.get("origin").map_or(Ok([0.0; 2]), |origin| origin.numbers())?;
        let detail = scene.get("detail").map_or(Ok(Detail::default()), |detail| read_detail(&detail))?;
        let mut reader = Reader::new(sources, origin, scene.get("nodes"))?;
        let mut builder = Builder::new();
        let root = reader.node(&mut builder, &scene.need("root")?)?;
        let mut named = vec![];
        if let Some(layers) = scene.get("layers") {
            for (name, layer) in layers.members()? {
                named.push((name, reader.node(&mut builder, &layer)?));
            }
        }
        let tree = builder.finish(root, detail)?;
        let layers = named.into_iter().map(|(name, id)| (name, tree.with_root(id))).collect();
        let unused = reader.unused();
        let Reader { places, notes, .. } = reader;
        Ok(Scene { tree, layers, crs: self.crs().map(str::to_string), origin, unused, places, notes })
    }
}

impl Scene {
    /// Reads a scene; `sources` opens the rasters and layers that it names.
    ///
    /// # Errors
    /// An input error with the place in the file, for text that is no JSON, unknown or missing members, values out of
    /// range, cycles, nodes that cannot be made, and files that `sources` refuses.
    pub fn read(text: &str, sources: &dyn Sources) -> Result<Self> {
        Document::parse(text)?.scene(sources)
    }
}

/// The source of the level of detail.
fn read_detail(value: &Value<'_>) -> Result<Detail> {
    let detail = value.object(&["constant", "around", "near_m", "far_m"])?;
    if let Some(constant) = detail.get("constant") {
        return Ok(Detail::Constant(constant.number_within(0.0, 1.0)?));
    }
    let (near, far) = (detail.need("near_m")?, detail.need("far_m")?);
    let (near_m, far_m) = (near.number_within(0.0, f64::MAX)?, far.number()?);
    if far_m <= near_m {
        return Err(far.fault("far_m must exceed near_m"));
    }
    Ok(Detail::Around { centre: detail.need("around")?.numbers()?, near_m, far_m })
}
