//! A scene with what became known while its files were opened.

use super::files::{Cell, Files};
use crate::construction::scene::{Document, Scene};
use crate::construction::{Detail, Tree};
use crate::crs::Crs;
use crate::error::{Error, ErrorKind, Result};
use crate::watch::Watch;
use std::path::{Path, PathBuf};

/// A scene from a file.
#[derive(Debug)]
pub struct SceneFile {
    /// The file.
    pub path: PathBuf,
    /// The scene.
    pub scene: Scene,
    /// Its CRS: the one that it names, or that of the first of its files that has one.
    pub crs: Option<Crs>,
    /// The files that it names.
    pub inputs: Vec<PathBuf>,
    /// What a user should know of how it was read.
    pub notes: Vec<String>,
    /// A cell of the finest of its rasters.
    pub finest: Option<Cell>,
}

/// Where the level of detail comes from, if not from the scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum DetailOption {
    /// The same everywhere.
    Constant(f64),
    /// As [`Detail::Around`], with the centre in the scene's CRS.
    Around {
        /// Where detail is wanted.
        centre: [f64; 2],
        /// Distance up to which all is shown, in metres.
        near_m: f64,
        /// Distance beyond which nothing is, in metres.
        far_m: f64,
    },
}

impl SceneFile {
    /// Reads a scene and opens the files that it names.
    ///
    /// # Errors
    /// A file that is missing or no scene; whatever is wrong with its nodes and files, with the node's place.
    pub fn open(path: &Path, memory: Option<u64>, watch: &Watch) -> Result<Self> {
        let text = std::fs::read_to_string(path).map_err(|error| {
            let message = match error.kind() {
                std::io::ErrorKind::NotFound => "no such file".to_string(),
                std::io::ErrorKind::InvalidData => "it is no text, and so no scene".to_string(),
                _ => error.to_string(),
            };
            Error::new(ErrorKind::Input, message).at_path(path)
        })?;
        let at = |error: Error| error.at_path(path);
        let document = Document::parse(&text).map_err(at)?;
        let files = Files::new(path, document.crs(), memory, watch).map_err(|e| at(e.at_place("$.crs")))?;
        let scene = document.scene(&files).map_err(|error| if is_own(&error) { at(error) } else { error })?;
        let known = files.into_known();
        let notes = known.notes.into_iter().chain(scene.notes.iter().cloned()).collect();
        Ok(Self { path: path.to_path_buf(), scene, crs: known.crs, inputs: known.inputs, notes, finest: known.finest })
    }

    /// The tree of a layer, or the terrain's, with the level of detail that is asked for.
    ///
    /// # Errors
    /// A usage error for a layer that is not there; the message lists those that are.
    pub fn tree(&self, layer: Option<&str>, detail: Option<DetailOption>) -> Result<Tree> {
        let tree = match layer {
            None => &self.scene.tree,
            Some(name) => {
                let found = self.scene.layers.iter().find(|(known, _)| known == name);
                let names: Vec<&str> = self.scene.layers.iter().map(|(name, _)| name.as_str()).collect();
                let there =
                    if names.is_empty() { "it has none".into() } else { format!("it has {}", names.join(", ")) };
                let missing = || Error::usage(format!("--layer {name}: the scene has no such layer; {there}"));
                &found.ok_or_else(|| missing().at_path(&self.path))?.1
            }
        };
        let [x, y] = self.scene.origin;
        Ok(match detail {
            None => tree.clone(),
            Some(DetailOption::Constant(value)) => tree.with_detail(Detail::Constant(value)),
            Some(DetailOption::Around { centre, near_m, far_m }) => {
                let centre = [centre[0] - x, centre[1] - y];
                tree.with_detail(Detail::Around { centre, near_m, far_m })
            }
        })
    }
}

/// Whether an error is about the scene, and not about the running of this program.
fn is_own(error: &Error) -> bool {
    error.kind() != ErrorKind::Interrupted
}
