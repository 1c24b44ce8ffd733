//! Outputs that come with companions: a grid with its `.prj`, an image with its `.aux.xml`.

use super::output::{begun, clear, not_writable, over, place_for};
use crate::error::{Error, ErrorKind, Result};
use std::ffi::OsString;
use std::fs;
use std::path::{Path, PathBuf};

/// A file that is written under its own name in a temporary folder beside its target, with whatever its format puts
/// beside it; all are moved when they are finished.
///
/// Dropped before [`OutputFolder::finish`] it leaves nothing behind.
#[derive(Debug)]
pub struct OutputFolder {
    target: PathBuf,
    partial: PathBuf,
    name: OsString,
    overwrite: bool,
}

impl OutputFolder {
    /// Prepares an output.
    ///
    /// # Errors
    /// As [`super::output::Output::begin`].
    pub fn begin(target: &Path, overwrite: bool) -> Result<Self> {
        let (folder, name) = place_for(target, overwrite)?;
        let partial = folder.join(format!(".orograph-{}-{}.parts", std::process::id(), name.to_string_lossy()));
        // A run that was killed may have had this number.
        clear(&partial);
        fs::create_dir(&partial).map_err(|error| not_writable(target, folder, &error))?;
        begun(&partial);
        Ok(Self { target: target.to_path_buf(), partial, name: name.to_os_string(), overwrite })
    }

    /// Where to write for now.
    pub fn path(&self) -> PathBuf {
        self.partial.join(&self.name)
    }

    /// Where the file will be.
    pub fn target(&self) -> &Path {
        &self.target
    }

    /// A name in the temporary folder for what is only needed meanwhile; its user removes it.
    pub fn scratch(&self, name: &str) -> PathBuf {
        self.partial.join(name)
    }

    /// Moves the finished files to their places, the one that was asked for last; returns them, that one first.
    ///
    /// # Errors
    /// When it is not there, a companion would replace another file, or they cannot be moved.
    pub fn finish(self) -> Result<Vec<PathBuf>> {
        let wrong = |error: std::io::Error| {
            Error::new(ErrorKind::Output, format!("the finished file cannot be put in its place: {error}"))
                .at_path(&self.target)
        };
        let mut companions = Vec::new();
        for entry in fs::read_dir(&self.partial).map_err(wrong)? {
            let name = entry.map_err(wrong)?.file_name();
            if name != self.name {
                companions.push(name);
            }
        }
        companions.sort();
        let beside = |name: &OsString| self.target.with_file_name(name);
        if let Some(taken) = companions.iter().map(beside).find(|place| !self.overwrite && place.exists()) {
            let message = "the output comes with this file, which exists already; replace both with --overwrite";
            return Err(Error::new(ErrorKind::Output, message).at_path(taken));
        }
        // What GDAL once noted of a file that is replaced is not about the new one.
        let mut notes = self.name.clone();
        notes.push(".aux.xml");
        if self.overwrite && !companions.contains(&notes) {
            let _ = fs::remove_file(beside(&notes));
        }
        for name in &companions {
            fs::rename(self.partial.join(name), beside(name)).map_err(wrong)?;
        }
        fs::rename(self.path(), &self.target).map_err(wrong)?;
        Ok(std::iter::once(self.target.clone()).chain(companions.iter().map(beside)).collect())
    }
}

impl Drop for OutputFolder {
    fn drop(&mut self) {
        clear(&self.partial);
        over(&self.partial);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(folder: &Path) -> Vec<String> {
        let mut names: Vec<String> =
            fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }

    #[test]
    fn companions_follow() {
        let dir = tempfile::tempdir().unwrap();
        let target = dir.path().join("a.asc");
        let output = OutputFolder::begin(&target, false).unwrap();
        fs::write(output.path(), "grid").unwrap();
        fs::write(output.path().with_extension("prj"), "crs").unwrap();
        assert_eq!(output.finish().unwrap(), [target.clone(), target.with_extension("prj")]);
        assert_eq!(names(dir.path()), ["a.asc", "a.prj"]);

        // Another file of that name stays as it is.
        fs::write(dir.path().join("b.prj"), "other").unwrap();
        let output = OutputFolder::begin(&dir.path().join("b.asc"), false).unwrap();
        fs::write(output.path(), "grid").unwrap();
        fs::write(output.path().with_extension("prj"), "crs").unwrap();
        assert!(output.finish().is_err());
        assert_eq!(names(dir.path()), ["a.asc", "a.prj", "b.prj"]);
    }

    #[test]
    fn nothing_is_left_and_old_notes_go() {
        let dir = tempfile::tempdir().unwrap();
        let target = dir.path().join("a.tif");
        drop(OutputFolder::begin(&target, false).unwrap());
        assert_eq!(names(dir.path()), Vec::<String>::new());
        fs::write(&target, "old").unwrap();
        fs::write(dir.path().join("a.tif.aux.xml"), "old").unwrap();
        assert!(OutputFolder::begin(&target, false).is_err());
        let output = OutputFolder::begin(&target, true).unwrap();
        fs::write(output.path(), "new").unwrap();
        output.finish().unwrap();
        assert_eq!(names(dir.path()), ["a.tif"]);
        assert_eq!(fs::read(&target).unwrap(), b"new");
    }
}
