//! Texts, read whole.

use crate::error::{Error, ErrorKind, Result};
use std::path::Path;

/// The text of a file.
///
/// # Errors
/// A file that is missing, cannot be read, or is no text.
pub fn read_text(path: &Path) -> Result<String> {
    std::fs::read_to_string(path).map_err(|error| {
        let message = match error.kind() {
            std::io::ErrorKind::NotFound => "no such file; check the path".into(),
            _ => format!("it cannot be read: {error}"),
        };
        Error::new(ErrorKind::Input, message).at_path(path)
    })
}
