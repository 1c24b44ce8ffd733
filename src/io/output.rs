//! Outputs that are there whole or not at all.

use crate::error::{Error, ErrorKind, Result};
use std::ffi::OsStr;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Temporary names of the outputs that are not finished.
static UNFINISHED: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

fn unfinished() -> MutexGuard<'static, Vec<PathBuf>> {
    UNFINISHED.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Removes what unfinished outputs have left so far: for a process that is about to exit without unwinding.
pub fn abandon() {
    unfinished().iter().for_each(|partial| clear(partial));
}

/// A file that is written under a temporary name beside its target and takes its place when it is finished.
///
/// Dropped before [`Output::finish`] it leaves nothing behind.
#[derive(Debug)]
pub struct Output {
    target: PathBuf,
    partial: PathBuf,
    finished: bool,
}

impl Output {
    /// Prepares an output; nothing is created yet.
    ///
    /// # Errors
    /// When the target exists and may not be replaced, is a folder, or its folder is missing or not writable: looked
    /// at before any work is done.
    pub fn begin(target: &Path, overwrite: bool) -> Result<Self> {
        let (folder, name) = place_for(target, overwrite)?;
        // The extension stays at the end: drivers look at it.
        let partial = folder.join(format!(".orograph-{}-{}", std::process::id(), name.to_string_lossy()));
        if let Err(error) = fs::File::create(&partial) {
            return Err(not_writable(target, folder, &error));
        }
        // Drivers want to create the file themselves.
        let output = Self { target: target.to_path_buf(), partial, finished: false };
        clear(&output.partial);
        begun(&output.partial);
        Ok(output)
    }

    /// Where to write for now.
    pub fn path(&self) -> &Path {
        &self.partial
    }

    /// Where the file will be.
    pub fn target(&self) -> &Path {
        &self.target
    }

    /// Puts the finished file in its place.
    ///
    /// # Errors
    /// When it cannot be moved there.
    pub fn finish(mut self) -> Result<()> {
        fs::rename(&self.partial, &self.target).map_err(|error| {
            Error::new(ErrorKind::Output, format!("the finished file cannot be put in its place: {error}"))
                .at_path(&self.target)
        })?;
        self.finished = true;
        Ok(())
    }
}

/// Folder and name of an output that may be written.
///
/// # Errors
/// When the target exists and may not be replaced, is a folder, or its folder is missing.
pub(super) fn place_for(target: &Path, overwrite: bool) -> Result<(&Path, &OsStr)> {
    let refuse = |message: String| Err(Error::new(ErrorKind::Output, message).at_path(target));
    if let Ok(found) = fs::symlink_metadata(target) {
        if found.is_dir() {
            return refuse("the output is a folder; name a file".into());
        }
        if !overwrite {
            return refuse("the output exists already; replace it with --overwrite".into());
        }
    }
    let Some(name) = target.file_name() else { return refuse("the output has no file name".into()) };
    let folder = match target.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    if !folder.is_dir() {
        let shown = folder.display();
        return refuse(match folder.exists() {
            true => format!("{shown} is not a folder"),
            false => format!("the folder {shown} does not exist"),
        });
    }
    Ok((folder, name))
}

/// The error of a folder in which nothing can be created.
pub(super) fn not_writable(target: &Path, folder: &Path, error: &std::io::Error) -> Error {
    let message = format!("the folder {} cannot be written to: {error}", folder.display());
    Error::new(ErrorKind::Output, message).at_path(target)
}

/// A temporary file or folder is there from now on.
pub(super) fn begun(partial: &Path) {
    unfinished().push(partial.to_path_buf());
}

/// A temporary file or folder is no longer there.
pub(super) fn over(partial: &Path) {
    unfinished().retain(|known| known != partial);
}

/// Removes a temporary file or folder.
pub(super) fn clear(partial: &Path) {
    if partial.is_dir() {
        // What cannot be removed stays; there is nobody left to tell.
        let _ = fs::remove_dir_all(partial);
        return;
    }
    let side = |suffix: &str| PathBuf::from(format!("{}{suffix}", partial.display()));
    // Whatever is not there need not be removed; SQLite may leave companions.
    for path in [partial.to_path_buf(), side("-journal"), side("-wal"), side("-shm")] {
        let _ = fs::remove_file(path);
    }
}

impl Drop for Output {
    fn drop(&mut self) {
        if !self.finished {
            clear(&self.partial);
        }
        over(&self.partial);
    }
}
