//! Progress on standard error, and Ctrl-C.
#![allow(clippy::print_stderr, reason = "progress is for people who watch")]

use super::report::Reporter;
use crate::error::Result;
use crate::io::output::abandon;
use crate::watch::Watch;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::io::IsTerminal;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, OnceLock};
use std::thread;
use std::time::{Duration, Instant};

/// How long a job may take before its progress is shown.
const PATIENCE: Duration = Duration::from_millis(1500);

static WATCH: OnceLock<Arc<Watch>> = OnceLock::new();

/// Runs a job under a watch: shows its progress, and cancels it on Ctrl-C.
pub(super) fn watched<T>(reporter: &mut Reporter, job: impl FnOnce(&Watch, &mut Reporter) -> Result<T>) -> Result<T> {
    let watch = Arc::clone(WATCH.get_or_init(Arc::default));
    // The second Ctrl-C need not wait for the job to notice the first. A handler that cannot be set is no reason to
    // refuse the work.
    let handled = Arc::clone(&watch);
    let pressed = AtomicBool::new(false);
    let _ = ctrlc::set_handler(move || {
        if pressed.swap(true, Ordering::Relaxed) {
            abandon();
            std::process::exit(130);
        }
        handled.cancel();
    });
    if !reporter.shows_progress() {
        return job(&watch, reporter);
    }
    let over = Arc::new(AtomicBool::new(false));
    let shown = {
        let (watch, over) = (Arc::clone(&watch), Arc::clone(&over));
        thread::spawn(move || show(&watch, &over))
    };
    let result = job(&watch, reporter);
    over.store(true, Ordering::Relaxed);
    shown.thread().unpark();
    // Showing progress cannot fail in a way that matters.
    let _ = shown.join();
    result
}

fn show(watch: &Watch, over: &AtomicBool) {
    let begun = Instant::now();
    while begun.elapsed() < PATIENCE {
        thread::park_timeout(PATIENCE);
        if over.load(Ordering::Relaxed) {
            return;
        }
    }
    if std::io::stderr().is_terminal() { show_bar(watch, over) } else { show_lines(watch, over) }
}

fn show_bar(watch: &Watch, over: &AtomicBool) {
    let bar = ProgressBar::with_draw_target(None, ProgressDrawTarget::stderr());
    if let Ok(style) = ProgressStyle::with_template("{elapsed_precise} [{bar:40}] {percent:>3}% {msg}") {
        bar.set_style(style.progress_chars("=> "));
    }
    while !over.load(Ordering::Relaxed) {
        let (done, total) = watch.done();
        bar.set_length(total.max(1));
        bar.set_position(done);
        bar.set_message(watch.stage());
        thread::park_timeout(Duration::from_millis(100));
    }
    bar.finish_and_clear();
}

fn show_lines(watch: &Watch, over: &AtomicBool) {
    let mut last = ("", 0);
    while !over.load(Ordering::Relaxed) {
        let (done, total) = watch.done();
        let now = (watch.stage(), (done * 10 / total.max(1)).min(10));
        if now != last && now.1 > 0 {
            eprintln!("{}: {}%", now.0, now.1 * 10);
            last = now;
        }
        thread::park_timeout(Duration::from_millis(200));
    }
}
