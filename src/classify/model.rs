//! The file of a classifier.

use super::features::{Feature, table};
use super::forest::Forest;
use crate::error::{Error, ErrorKind, Result};
use serde::{Deserialize, Serialize};

/// What the field `format` of a classifier says.
pub const MODEL_FORMAT: &str = "orograph-classifier";
/// The version of classifiers that this program writes and reads.
pub const MODEL_VERSION: u32 = 1;

/// A classifier: a forest, and all that its answers rest on.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Model {
    /// Always [`MODEL_FORMAT`].
    pub format: String,
    /// Always [`MODEL_VERSION`].
    pub version: u32,
    /// Name and version of the program that wrote the file.
    pub program: String,
    /// What disks must be like.
    pub conditions: Conditions,
    /// The histograms that make up a row of features.
    pub features: Vec<Feature>,
    /// The classes, in the order of the counts in leaves.
    pub classes: Vec<ClassRecord>,
    /// The trees.
    pub forest: Forest,
}

/// Which disks a classifier was made from, and can tell of.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Conditions {
    /// Their radius in metres, which distances are divided by.
    pub disk_radius_m: f64,
    /// Fewest peaks of a disk.
    pub min_peaks: usize,
    /// Least prominence of their peaks in metres; `None` where it is not known.
    pub min_prominence_m: Option<f64>,
}

/// A class.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct ClassRecord {
    /// Its name, unlike that of any other.
    pub name: String,
    /// Number of the disks that it was learned from.
    pub disks: usize,
}

/// What must be right before anything else is looked at.
#[derive(Deserialize)]
struct Head {
    format: Option<String>,
    version: Option<serde_json::Value>,
}

impl Model {
    /// A classifier of this program's making.
    pub fn new(conditions: Conditions, classes: Vec<ClassRecord>, forest: Forest) -> Self {
        Self {
            format: MODEL_FORMAT.into(),
            version: MODEL_VERSION,
            program: concat!("orograph ", env!("CARGO_PKG_VERSION")).into(),
            conditions,
            features: table(),
            classes,
            forest,
        }
    }

    /// Reads a classifier; nothing in it is believed unless it was checked.
    ///
    /// # Errors
    /// `Input` when the text is no classifier, `Unsupported` for another version or other features, `Corrupt` when
    /// something is missing, out of range, or no tree.
    pub fn from_json(text: &str) -> Result<Self> {
        let input = |message: String| Error::new(ErrorKind::Input, message);
        let head: Head = serde_json::from_str(text).map_err(|e| input(format!("not a classifier: {e}")))?;
        if head.format.as_deref() != Some(MODEL_FORMAT) {
            let found = head.format.map_or("no \"format\"".into(), |f| format!("\"format\": \"{f}\""));
            return Err(input(format!("not a classifier: expected \"format\": \"{MODEL_FORMAT}\", found {found}")));
        }
        let version = head.version.unwrap_or_default();
        if version.as_u64() != Some(u64::from(MODEL_VERSION)) {
            let message =
                format!("a classifier of version {version}: this program reads version {MODEL_VERSION}; train it anew");
            return Err(Error::new(ErrorKind::Unsupported, message));
        }
        let model: Self = serde_json::from_str(text)
            .map_err(|e| Error::new(ErrorKind::Corrupt, format!("broken classifier: {e}")))?;
        model.check()?;
        Ok(model)
    }

    /// The classifier as text.
    ///
    /// # Panics
    /// Never: all its maps are by name.
    pub fn to_json(&self) -> String {
        let mut text = serde_json::to_string(self).expect("maps by name, written to memory");
        text.push('\n');
        text
    }

    /// The most probable class of a row of features, the first of equals, and the probability of each.
    ///
    /// # Panics
    /// When the row is not as long as [`super::features()`] makes it.
    pub fn tell(&self, row: &[f64]) -> (usize, Vec<f64>) {
        let probabilities = self.forest.probabilities(row, self.classes.len());
        (super::forest::first_greatest(&probabilities), probabilities)
    }

    /// Checks everything that a reader relies on.
    ///
    /// # Errors
    /// As [`Model::from_json`].
    pub fn check(&self) -> Result<()> {
        let corrupt = |message: String, place: &str| Err(Error::new(ErrorKind::Corrupt, message).at_place(place));
        let Conditions { disk_radius_m, min_prominence_m, .. } = self.conditions;
        if !(disk_radius_m.is_finite() && disk_radius_m > 0.0) {
            let message = format!("the radius is {disk_radius_m}: expected a positive number");
            return corrupt(message, "conditions.disk_radius_m");
        }
        if let Some(least_m) = min_prominence_m.filter(|m| !(m.is_finite() && *m >= 0.0)) {
            let message = format!("the least prominence is {least_m}: expected 0 or more");
            return corrupt(message, "conditions.min_prominence_m");
        }
        if self.features != table() {
            let message = "its features are not those that this program measures; train it anew";
            return Err(Error::new(ErrorKind::Unsupported, message).at_place("features"));
        }
        if self.classes.len() < 2 {
            return corrupt(format!("{} classes: expected at least 2", self.classes.len()), "classes");
        }
        for (i, class) in self.classes.iter().enumerate() {
            if self.classes[..i].iter().any(|other| other.name == class.name) {
                return corrupt(format!("two classes are called '{}'", class.name), "classes");
            }
        }
        self.forest.check(self.features.iter().map(|feature| feature.bins).sum(), self.classes.len())
    }
}
