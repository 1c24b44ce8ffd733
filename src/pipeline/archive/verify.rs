//! The job behind `orograph verify`: whether a container is what it says.

use super::container::open;
use crate::error::Result;
use crate::oro::CheckReport;
use crate::watch::Watch;
use std::path::Path;

/// Reads a container from end to end, and decodes every tile.
///
/// # Errors
/// When it cannot be opened or read; damage inside is no error but a fault in the report.
pub fn run(path: &Path, watch: &Watch) -> Result<CheckReport> {
    open(path)?.check(watch).map_err(|error| error.at_path(path))
}
