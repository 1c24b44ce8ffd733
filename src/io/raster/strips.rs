//! Rows of a raster in strips, shared among threads.

use std::sync::{Mutex, PoisonError};

/// Where strips of about `strip` rows begin and end, between the rows `from` and `to`: at its multiples.
pub(super) fn strip_bounds(from: usize, to: usize, strip: usize) -> Vec<usize> {
    let mut bounds = vec![from];
    while let Some(&last) = bounds.last().filter(|&&last| last < to) {
        bounds.push(((last / strip + 1) * strip).min(to));
    }
    bounds
}

/// Runs `work` on every strip, which is its first row with whatever belongs to it, on the threads of the pool; each
/// thread has a `scratch` of its own (GDAL's datasets must not be shared).
///
/// # Errors
/// Whichever thread fails first, the error is that of the first place in the file.
pub(super) fn each_strip<T: Send, S, E: Send>(
    mut strips: Vec<(usize, T)>,
    scratch: impl Fn() -> S + Sync,
    work: impl Fn(&mut S, usize, T) -> Result<(), E> + Sync,
) -> Result<(), E> {
    let threads = rayon::current_num_threads().min(strips.len());
    strips.reverse();
    let queue = Mutex::new(strips);
    let failed: Mutex<Option<(usize, E)>> = Mutex::new(None);
    let run = || {
        let mut scratch = scratch();
        loop {
            let next = queue.lock().unwrap_or_else(PoisonError::into_inner).pop();
            let Some((from, strip)) = next else { break };
            if let Err(error) = work(&mut scratch, from, strip) {
                let mut failed = failed.lock().unwrap_or_else(PoisonError::into_inner);
                if failed.as_ref().is_none_or(|&(row, _)| from < row) {
                    *failed = Some((from, error));
                }
                break;
            }
        }
    };
    if threads <= 1 {
        run();
    } else {
        std::thread::scope(|scope| {
            for _ in 0..threads {
                scope.spawn(run);
            }
        });
    }
    failed.into_inner().unwrap_or_else(PoisonError::into_inner).map_or(Ok(()), |(_, error)| Err(error))
}
