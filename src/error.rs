//! The one error type: what went wrong, in which file, at which place, and what to do about it.

use std::fmt;
use std::path::{Path, PathBuf};

/// Result of everything in this crate that can fail.
pub type Result<T> = std::result::Result<T, Error>;

/// What kind of failure this is; each kind has one exit code.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum ErrorKind {
    /// The call itself is wrong: an option, a value, a combination. The user meets it before any work starts.
    Usage,
    /// An input is missing, cannot be opened, or holds nothing that can be worked on.
    Input,
    /// An input was opened but its content is damaged or ends early.
    Corrupt,
    /// An input is sound but is of a kind, or of a size, that this program or this machine cannot handle.
    Unsupported,
    /// An output exists already or cannot be written.
    Output,
    /// The user interrupted the run.
    Interrupted,
}

impl ErrorKind {
    /// Exit code of the process that ends with this kind of error.
    pub fn exit_code(self) -> u8 {
        match self {
            Self::Usage => 2,
            Self::Input | Self::Corrupt | Self::Unsupported => 3,
            Self::Output => 4,
            Self::Interrupted => 130,
        }
    }

    /// The kind as it stands in `--json` documents.
    pub fn name(self) -> &'static str {
        match self {
            Self::Usage => "usage",
            Self::Input => "input",
            Self::Corrupt => "corrupt",
            Self::Unsupported => "unsupported",
            Self::Output => "output",
            Self::Interrupted => "interrupted",
        }
    }
}

/// An error with the file and the place that it concerns.
#[derive(Debug)]
pub struct Error {
    kind: ErrorKind,
    message: String,
    path: Option<PathBuf>,
    place: Option<String>,
}

impl Error {
    /// A new error; `message` says what was found, what was expected and what to do.
    pub fn new(kind: ErrorKind, message: impl Into<String>) -> Self {
        Self { kind, message: message.into(), path: None, place: None }
    }

    /// Shorthand for [`ErrorKind::Usage`].
    pub fn usage(message: impl Into<String>) -> Self {
        Self::new(ErrorKind::Usage, message)
    }

    /// Shorthand for [`ErrorKind::Interrupted`].
    pub fn interrupted() -> Self {
        Self::new(ErrorKind::Interrupted, "interrupted; nothing was written")
    }

    /// Names the file that the error concerns, unless it names one already.
    #[must_use]
    pub fn at_path(mut self, path: impl AsRef<Path>) -> Self {
        self.path.get_or_insert_with(|| path.as_ref().to_path_buf());
        self
    }

    /// Names the place inside the file (a band, a row, a layer, a field).
    #[must_use]
    pub fn at_place(mut self, place: impl Into<String>) -> Self {
        self.place.get_or_insert_with(|| place.into());
        self
    }

    /// The kind, which decides the exit code.
    pub fn kind(&self) -> ErrorKind {
        self.kind
    }

    /// The message without file and place.
    pub fn message(&self) -> &str {
        &self.message
    }

    /// The file that the error concerns.
    pub fn path(&self) -> Option<&Path> {
        self.path.as_deref()
    }

    /// The place inside the file.
    pub fn place(&self) -> Option<&str> {
        self.place.as_deref()
    }
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(path) = &self.path {
            write!(f, "{}: ", path.display())?;
        }
        if let Some(place) = &self.place {
            write!(f, "{place}: ")?;
        }
        f.write_str(&self.message)
    }
}

impl std::error::Error for Error {}
