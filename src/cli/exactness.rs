//! How exact a mesh is to be, for the verbs that make one.

use super::wrong_value;
use crate::error::{Error, Result};
use crate::pipeline::tin::Exactness;
use crate::units::parse_length_m;
use clap::Args;

/// How exact a mesh is to be.
#[derive(Args, Clone, Debug)]
pub(super) struct ExactnessOptions {
    /// Greatest vertical distance of a cell, or of a point of the grid, from the mesh.
    #[arg(long, value_name = "LENGTH", allow_hyphen_values = true)]
    max_error: Option<String>,
    /// Greatest number of vertices; where they run out the error is larger, and is told.
    #[arg(long, value_name = "N")]
    max_vertices: Option<usize>,
    /// All cells or points are vertices, in squares of two triangles.
    #[arg(long, conflicts_with_all = ["max_error", "max_vertices"])]
    regular: bool,
}

impl ExactnessOptions {
    /// What the options mean.
    pub(super) fn meant(&self) -> Result<Exactness> {
        if self.regular {
            return Ok(Exactness::Regular);
        }
        let max_error_m = match &self.max_error {
            Some(text) => parse_length_m(text).map_err(|error| wrong_value("--max-error", &error))?,
            // As exact as it gets with so many.
            None if self.max_vertices.is_some() => 0.0,
            None => {
                return Err(Error::usage(
                    "how exact is the mesh to be? Give --max-error (10m), --max-vertices, or --regular for all cells",
                ));
            }
        };
        if max_error_m < 0.0 {
            let given = self.max_error.as_deref().unwrap_or_default();
            return Err(Error::usage(format!("--max-error {given}: expected 0 or more")));
        }
        Ok(Exactness::Refined { max_error_m, max_vertices: self.max_vertices })
    }

    /// The options as they were given.
    pub(super) fn words(&self) -> Vec<String> {
        let mut words = vec![];
        let numbers =
            [("--max-error", self.max_error.clone()), ("--max-vertices", self.max_vertices.map(|n| n.to_string()))];
        for (option, value) in numbers {
            words.extend(value.map(|value| [option.to_string(), value]).into_iter().flatten());
        }
        if self.regular {
            words.push("--regular".into());
        }
        words
    }
}

/// An error of a mesh in millimetres' precision, rounded up, so that what is told is no less than what is.
pub(super) fn error_text_m(error_m: f64) -> f64 {
    (error_m * 1000.0 - 1e-6).ceil().max(0.0) / 1000.0
}
