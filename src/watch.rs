//! How long work tells how far it is, and learns that nobody wants it any more.

use crate::error::{Error, Result};
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

/// Progress and cancellation of one job; shared by all its threads.
///
/// Methods call [`Watch::advance`] at natural steps (a tile, a thousand rows); whoever started the job looks at
/// [`Watch::done`] from another thread and may call [`Watch::cancel`].
#[derive(Debug, Default)]
pub struct Watch {
    done: AtomicU64,
    total: AtomicU64,
    stage: Mutex<&'static str>,
    cancelled: AtomicBool,
}

impl Watch {
    /// Starts a stage of `total` steps; `stage` says in a word or two what is done in it.
    pub fn begin(&self, stage: &'static str, total: u64) {
        *self.stage.lock().unwrap_or_else(std::sync::PoisonError::into_inner) = stage;
        self.total.store(total, Ordering::Relaxed);
        self.done.store(0, Ordering::Relaxed);
    }

    /// Reports `steps` more steps done.
    ///
    /// # Errors
    /// [`crate::error::ErrorKind::Interrupted`] when the job was cancelled.
    pub fn advance(&self, steps: u64) -> Result<()> {
        self.done.fetch_add(steps, Ordering::Relaxed);
        self.check()
    }

    /// Ends the work here if the job was cancelled.
    ///
    /// # Errors
    /// [`crate::error::ErrorKind::Interrupted`] when the job was cancelled.
    pub fn check(&self) -> Result<()> {
        if self.cancelled.load(Ordering::Relaxed) { Err(Error::interrupted()) } else { Ok(()) }
    }

    /// Asks the job to end soon.
    pub fn cancel(&self) {
        self.cancelled.store(true, Ordering::Relaxed);
    }

    /// What the stage under way does.
    pub fn stage(&self) -> &'static str {
        *self.stage.lock().unwrap_or_else(std::sync::PoisonError::into_inner)
    }

    /// Steps done and steps in all, of the stage under way.
    pub fn done(&self) -> (u64, u64) {
        (self.done.load(Ordering::Relaxed), self.total.load(Ordering::Relaxed))
    }
}
