//! How much memory a job may use, and how much it will.

use crate::error::{Error, ErrorKind, Result};

/// Bytes a cell that the divide tree takes besides the raster itself, on real terrain.
const TREE_BYTES_PER_CELL: u64 = 6;

/// Bytes a pixel that a map takes while it is drawn.
const MAP_BYTES_PER_PIXEL: u64 = 112;

/// Bytes a cell that a thread takes while it encodes, proves or decodes a tile of an archive.
///
/// `tests/codec_memory.rs` measures it on tiles of 1024 x 1024 cells and holds it against this: 64 for doubles of all
/// sizes, 57 for 32-bit integers of full range, 33 to 38 for what elevations mostly are. The tile's own cells, cut out
/// of their batch, are up to 8 more; the rest is a margin for allocators.
pub const CODEC_BYTES_PER_CELL: u64 = 80;

/// Bytes a cell of a mesh that has them all: vertices, two triangles each, normals and numbers, in vectors that grow.
const REGULAR_MESH_BYTES_PER_CELL: u64 = 120;

/// Bytes a vertex that a triangulation takes while it is refined, with its edges, its triangles and their queue.
const TIN_BYTES_PER_VERTEX: u64 = 480;

/// Bytes a cell of terrain that is raised: what a run of many cells took, and some more.
const TERRAIN_BYTES_PER_CELL: u64 = 64;
/// Bytes a peak that the synthesis of a divide tree takes, with its triangles and its rows in the output.
const SYNTHESIS_BYTES_PER_PEAK: u64 = 3000;

/// Bytes that a job takes whatever the raster.
const FIXED_BYTES: u64 = 96 << 20;

/// What may be used where the system does not tell what is free.
const UNKNOWN_FREE_BYTES: u64 = 4 << 30;

/// Copies of a batch that there are at once: one being read, one being worked on, and what it turns into.
const COPIES: u64 = 3;

/// What a job that works batch by batch may use where nothing is said, beside what its threads need.
const USUAL_BATCH_JOB_BYTES: u64 = 1 << 30;

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

/// Bytes that a mesh of a raster takes beside its vertices: elevations in double precision, and for a `regular` one all
/// that it is made of.
pub fn mesh_bytes(cells: u64, key_bytes: u64, regular: bool) -> u64 {
    let each = 8 + key_bytes + if regular { REGULAR_MESH_BYTES_PER_CELL } else { 0 };
    cells.saturating_mul(each).saturating_add(FIXED_BYTES)
}

/// Vertices of a triangulation that have room in so many bytes.
pub fn mesh_vertices(bytes: u64) -> usize {
    usize::try_from(bytes / TIN_BYTES_PER_VERTEX).unwrap_or(usize::MAX)
}

/// What a job takes that goes through a raster batch by batch.
#[derive(Clone, Copy, Debug)]
pub struct BatchNeeds {
    /// Bytes of the cells of the smallest batch.
    pub least: u64,
    /// Bytes that each thread needs while it works on a tile.
    pub per_thread: u64,
    /// Bytes that are kept for the whole raster.
    pub kept: u64,
}

/// Bytes of cells that a batch may have, so that the job stays within so much memory, or within about a gigabyte where
/// nothing is said: more makes nothing faster.
///
/// # Errors
/// When not even the smallest batch fits; with the estimate and `remedy`.
pub fn batch_budget(memory: Option<u64>, needs: &BatchNeeds, remedy: &str) -> Result<u64> {
    let threads = rayon::current_num_threads() as u64;
    let fixed = FIXED_BYTES.saturating_add(needs.per_thread.saturating_mul(threads)).saturating_add(needs.kept);
    let needed = fixed.saturating_add(needs.least.saturating_mul(COPIES));
    let usual = (needed + (256 << 20)).max(USUAL_BATCH_JOB_BYTES + needs.per_thread.saturating_mul(threads));
    let budget = memory.unwrap_or_else(|| free_bytes().min(usual));
    admit_or(needed, budget, remedy)?;
    Ok((budget - fixed) / COPIES)
}

/// Bytes that the synthesis of a divide tree of so many peaks takes.
pub fn synthesis_bytes(peaks: u64) -> u64 {
    peaks.saturating_mul(SYNTHESIS_BYTES_PER_PEAK).saturating_add(FIXED_BYTES)
}

/// Bytes that raising terrain of so many cells takes.
pub fn terrain_bytes(cells: u64) -> u64 {
    cells.saturating_mul(TERRAIN_BYTES_PER_CELL).saturating_add(FIXED_BYTES)
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
