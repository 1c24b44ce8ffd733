//! How much memory a job may use, and how much it will.

use crate::error::{Error, ErrorKind, Result};

/// Bytes a cell that the divide tree takes besides the raster itself, on real terrain.
const TREE_BYTES_PER_CELL: u64 = 6;

/// Bytes a pixel that a map takes while it is drawn.
const MAP_BYTES_PER_PIXEL: u64 = 112;

/// Bytes that a job takes whatever the raster.
const FIXED_BYTES: u64 = 96 << 20;

/// What may be used where the system does not tell what is free.
const UNKNOWN_FREE_BYTES: u64 = 4 << 30;

/// Bytes of memory that the machine has free for this process, limits of its control group included.
pub fn free_bytes() -> u64 {
    // A system that does not tell is taken to be a small one.
    let Ok(mut system) = sysinfo::System::new() else { return UNKNOWN_FREE_BYTES };
    system.refresh_memory();
    let free = system.available_memory();
    match system.cgroup_limits() {
        Some(limits) if limits.total_memory > 0 => free.min(limits.total_memory.saturating_sub(limits.rss)),
        _ => free,
    }
}

/// Bytes that the survey of `cells` cells with keys of `key_bytes` bytes takes.
pub fn survey_bytes(cells: u64, key_bytes: u64) -> u64 {
    cells.saturating_mul(key_bytes + TREE_BYTES_PER_CELL).saturating_add(FIXED_BYTES)
}

/// Bytes that a map of so many pixels takes, drawn from a raster of at most twice its resolution.
pub fn map_bytes(pixels: u64) -> u64 {
    pixels.saturating_mul(MAP_BYTES_PER_PIXEL).saturating_add(FIXED_BYTES)
}

/// Refuses a survey that would not fit.
///
/// # Errors
/// With the estimate, the budget and what to do.
pub fn admit(needed: u64, budget: u64) -> Result<()> {
    admit_or(needed, budget, "cut the raster with --window or --bbox")
}

/// Refuses a job that would not fit; `remedy` is what makes it smaller.
///
/// # Errors
/// With the estimate, the budget and what to do.
pub fn admit_or(needed: u64, budget: u64, remedy: &str) -> Result<()> {
    if needed <= budget {
        return Ok(());
    }
    Err(Error::new(
        ErrorKind::Unsupported,
        format!(
            "the work needs about {} of memory and may use {}; {remedy}, raise --memory, or use a machine with more",
            text(needed),
            text(budget)
        ),
    ))
}

fn text(bytes: u64) -> String {
    if bytes >= 10 << 30 { format!("{} GiB", bytes >> 30) } else { format!("{} MiB", bytes.div_ceil(1 << 20)) }
}
