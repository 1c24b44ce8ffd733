//! Tiles of patches that several windows need, decoded once.

use super::reader::Reader;
use super::source::RangeRead;
use super::window::Window;
use crate::codec::sparse::PatchTile;
use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// Decoded tiles of the sparse profile, kept until the last of the windows that were announced has used them.
///
/// A window of a tile needs the patches of its neighbours too; whoever reads many announces them with
/// [`Reader::shelf`], and then reads each with [`Reader::window_with`], from as many threads as there are. Of other
/// profiles nothing is kept.
#[derive(Debug, Default)]
pub struct Shelf {
    tiles: Mutex<BTreeMap<u64, Kept>>,
}

/// A tile, and how many windows will still ask for it.
#[derive(Debug, Default)]
struct Kept {
    uses: usize,
    tile: Option<Arc<PatchTile>>,
}

impl Shelf {
    fn tiles(&self) -> MutexGuard<'_, BTreeMap<u64, Kept>> {
        // What is kept is whole at any time.
        self.tiles.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// A tile, if another window has decoded it.
    pub(super) fn get(&self, chunk: u64) -> Option<Arc<PatchTile>> {
        self.tiles().get(&chunk)?.tile.clone()
    }

    /// Keeps a tile for those who come.
    pub(super) fn keep(&self, chunk: u64, tile: &Arc<PatchTile>) {
        if let Some(kept) = self.tiles().get_mut(&chunk) {
            kept.tile.get_or_insert_with(|| Arc::clone(tile));
        }
    }

    /// One window less will ask for these tiles.
    pub(super) fn used(&self, chunks: &[u64]) {
        let mut tiles = self.tiles();
        for chunk in chunks {
            if let Some(kept) = tiles.get_mut(chunk) {
                kept.uses = kept.uses.saturating_sub(1);
                if kept.uses == 0 {
                    tiles.remove(chunk);
                }
            }
        }
    }
}

impl<R: RangeRead> Reader<R> {
    /// A place for tiles that windows of a level share; windows that are not in the raster are passed over.
    pub fn shelf(&self, band: usize, level: u8, windows: &[Window]) -> Shelf {
        let mut tiles: BTreeMap<u64, Kept> = BTreeMap::new();
        if let Some(sparse) = &self.tiles.sparse {
            let sound = windows.iter().filter(|window| self.check_window(band, level, **window).is_ok());
            for chunk in sound.flat_map(|&window| self.chunks_of_patches(sparse, band, level, window.into())) {
                tiles.entry(chunk).or_default().uses += 1;
            }
            // What one window alone needs is not worth keeping.
            tiles.retain(|_, kept| kept.uses > 1);
        }
        Shelf { tiles: Mutex::new(tiles) }
    }
}
