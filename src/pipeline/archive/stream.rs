//! Where a job writes: a file that is there whole or not at all, or a stream that somebody reads.

use crate::error::{Error, ErrorKind, Result};
use crate::io::output::Output;
use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Bytes that are gathered before they are written.
const BUFFER: usize = 1 << 20;

/// Where to write.
pub enum Target<'a> {
    /// A file.
    File {
        /// Its name.
        path: PathBuf,
        /// Whether an existing one may be replaced.
        overwrite: bool,
    },
    /// A stream, such as standard output; whoever reads it may stop early.
    Stream(&'a mut (dyn Write + Send)),
}

impl Target<'_> {
    /// The file's name, for messages.
    pub fn name(&self) -> PathBuf {
        match self {
            Self::File { path, .. } => path.clone(),
            Self::Stream(_) => Path::new("standard output").to_path_buf(),
        }
    }
}

/// Bytes on their way to a target.
pub(in crate::pipeline) struct ByteStream<'a> {
    sink: BufWriter<Sink<'a>>,
    output: Option<Output>,
    is_closed: Arc<AtomicBool>,
}

enum Sink<'a> {
    File(File),
    Stream(&'a mut (dyn Write + Send), Arc<AtomicBool>),
}

impl Sink<'_> {
    fn note<T>(&self, result: io::Result<T>) -> io::Result<T> {
        if let (Self::Stream(_, is_closed), Err(error)) = (self, &result)
            && error.kind() == io::ErrorKind::BrokenPipe
        {
            is_closed.store(true, Ordering::Relaxed);
        }
        result
    }
}

impl Write for Sink<'_> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let written = match self {
            Self::File(file) => file.write(bytes),
            Self::Stream(out, _) => out.write(bytes),
        };
        self.note(written)
    }

    fn flush(&mut self) -> io::Result<()> {
        let flushed = match self {
            Self::File(file) => file.flush(),
            Self::Stream(out, _) => out.flush(),
        };
        self.note(flushed)
    }
}

impl<'a> ByteStream<'a> {
    /// Opens the target.
    ///
    /// # Errors
    /// When the file exists and may not be replaced, or cannot be created.
    pub(in crate::pipeline) fn begin(target: Target<'a>) -> Result<Self> {
        let is_closed = Arc::default();
        let (sink, output) = match target {
            Target::Stream(out) => (Sink::Stream(out, Arc::clone(&is_closed)), None),
            Target::File { path, overwrite } => {
                let output = Output::begin(&path, overwrite)?;
                let file = File::create(output.path()).map_err(|error| {
                    Error::new(ErrorKind::Output, format!("it cannot be created: {error}")).at_path(&path)
                })?;
                (Sink::File(file), Some(output))
            }
        };
        Ok(Self { sink: BufWriter::with_capacity(BUFFER, sink), output, is_closed })
    }

    /// Becomes true when nobody reads the stream any more. Writes fail from then on, but whoever closed it has read
    /// enough: that is a success.
    pub(in crate::pipeline) fn is_closed(&self) -> Arc<AtomicBool> {
        Arc::clone(&self.is_closed)
    }

    /// Writes what is left, and gives a file its name.
    ///
    /// # Errors
    /// When the last bytes cannot be written.
    pub(in crate::pipeline) fn finish(mut self) -> Result<()> {
        self.sink.flush().map_err(|error| self.failed(&error))?;
        if let Sink::File(file) = self.sink.get_ref() {
            // Some file systems tell only now that there was no room.
            file.sync_data().map_err(|error| self.failed(&error))?;
        }
        self.output.map_or(Ok(()), Output::finish)
    }

    /// The error of bytes that cannot be written.
    pub(in crate::pipeline) fn failed(&self, error: &io::Error) -> Error {
        let error = Error::new(ErrorKind::Output, format!("it cannot be written: {error}"));
        match &self.output {
            Some(output) => error.at_path(output.target()),
            None => error.at_path("standard output"),
        }
    }
}

impl Write for ByteStream<'_> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.sink.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.sink.flush()
    }
}
