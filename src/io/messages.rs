//! What GDAL says: caught before it prints, and turned into errors that name the file.

use crate::error::{Error, ErrorKind};
use gdal::errors::{CplErrType, GdalError};
use std::cell::RefCell;
use std::path::Path;
use std::sync::Once;

thread_local! {
    /// GDAL calls its handler on the thread that met the error, which is the one that asks.
    static MESSAGES: RefCell<Vec<(CplErrType, String)>> = const { RefCell::new(Vec::new()) };
}
static QUIET: Once = Once::new();

/// Keeps GDAL from printing, and fixes the options that every use of it here relies on. Call it before any other.
pub fn quiet() {
    QUIET.call_once(|| {
        gdal::config::set_error_handler(|kind, _, message| {
            MESSAGES.with_borrow_mut(|messages| {
                // A damaged file may complain about each of its blocks.
                if messages.len() < 100 && !matches!(kind, CplErrType::None | CplErrType::Debug) {
                    messages.push((kind, message.trim().to_string()));
                }
            });
        });
        for (key, value) in [
            ("OSR_WKT_FORMAT", "WKT2_2019"),
            // Time stamps in outputs do not depend on when they were made.
            ("OGR_CURRENT_DATE", "2000-01-01T00:00:00.000Z"),
            // The raster is kept in memory by this program: GDAL need not keep it once more.
            ("GDAL_CACHEMAX", "48"),
        ] {
            if gdal::config::get_config_option(key, "").is_ok_and(|set| set.is_empty()) {
                // Fails only for a NUL in the text.
                let _ = gdal::config::set_config_option(key, value);
            }
        }
    });
}

/// Versions of GDAL and PROJ, of the libraries that are in use.
#[allow(unsafe_code, reason = "the bindings do not ask PROJ for its version")]
pub fn versions() -> (String, String) {
    let (mut major, mut minor, mut patch) = (0, 0, 0);
    // SAFETY: the function writes three integers, which live here.
    unsafe { gdal_sys::OSRGetPROJVersion(&raw mut major, &raw mut minor, &raw mut patch) };
    (gdal::version::version_info("RELEASE_NAME"), format!("{major}.{minor}.{patch}"))
}

/// The failures that GDAL has reported on this thread since the last call, most important first; its warnings are dropped.
pub fn take_failures() -> Vec<String> {
    let said = MESSAGES.take();
    let is_failure = |kind: &CplErrType| matches!(kind, CplErrType::Failure | CplErrType::Fatal);
    let mut failures: Vec<String> =
        said.into_iter().filter(|(kind, _)| is_failure(kind)).map(|(_, message)| message).collect();
    failures.dedup();
    failures
}

/// An error of the given kind from what GDAL reported, with the file's path.
pub(super) fn failure(kind: ErrorKind, what: &str, path: &Path, error: &GdalError) -> Error {
    let said = take_failures();
    let detail = match error {
        _ if !said.is_empty() => said.join("; "),
        GdalError::CplError { msg, .. } | GdalError::NullPointer { msg, .. } if !msg.is_empty() => msg.clone(),
        other => other.to_string(),
    };
    Error::new(kind, format!("{what}: {detail}")).at_path(path)
}
