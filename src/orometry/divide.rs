//! The divide tree of the whole raster: every peak with the saddle at which it ends.
//!
//! Tiles are scanned and swept on their own ([`super::tile`], [`super::forest`]); here their portals are traced to
//! peaks, and the candidates of all tiles, with the cells beside the unknown, are swept once more from above to
//! below. What comes out depends on the raster alone: tiles and threads only share the work.

use super::forest::{TileForest, sweep_tile};
use super::tile::{NO_NODE, Node, Scan, Scanner, Tile};
use crate::components::root;
use crate::error::{Error, ErrorKind, Result};
use crate::grid::neighbours::is_above;
use crate::grid::{Cell, Grid, Key};
use crate::watch::Watch;
use rayon::prelude::*;

/// Number of a peak in its [`DivideForest`]; numbers follow the tiles and mean nothing outside.
pub(super) type PeakNumber = u32;

/// No cell.
pub(super) const NO_CELL: Cell = Cell::MAX;

/// Where a peak ends.
#[derive(Clone, Copy, Debug)]
pub(super) struct Join<K> {
    /// The saddle; [`NO_CELL`] for a root.
    pub(super) saddle: Cell,
    /// Basin on the side of the peak that ends.
    pub(super) near: PeakNumber,
    /// Basin on the other side.
    pub(super) far: PeakNumber,
    /// Key of the saddle.
    pub(super) key: K,
    /// Number of the edge at its saddle: edges at one saddle follow the order of their cells.
    pub(super) nth: u8,
    /// Whether `near` is the basin of the saddle's topmost neighbour.
    pub(super) near_is_a: bool,
}

/// All peaks of a raster with their joins: the divide trees of its components, not pruned.
#[derive(Debug)]
pub(super) struct DivideForest<K> {
    /// The peaks' cells.
    pub(super) cells: Vec<Cell>,
    /// The peaks' keys.
    pub(super) keys: Vec<K>,
    /// Where each peak ends.
    pub(super) joins: Vec<Join<K>>,
    /// For each peak the cell at which its component first meets the unknown, if that is above its key saddle;
    /// else [`NO_CELL`].
    pub(super) touches: Vec<Cell>,
}

/// One step of the sweep over the whole raster.
struct Event<K> {
    key: K,
    cell: Cell,
    /// A pass's number at its saddle; [`TOUCH`] comes after all of them, as a saddle is no cell of the island.
    nth: u8,
    a: PeakNumber,
    b: PeakNumber,
}

const TOUCH: u8 = u8::MAX;

/// Puts steps in the order of the sweep, from above to below.
fn sort<K: Key>(events: &mut [Event<K>]) {
    events.par_sort_unstable_by(|p, q| (q.key, p.cell, p.nth).cmp(&(p.key, q.cell, q.nth)));
}

struct TileWork<K> {
    tile: Tile,
    scan: Scan<K>,
    forest: TileForest<K>,
    /// Number of the tile's first peak.
    base: PeakNumber,
}

impl<K: Key> DivideForest<K> {
    /// Finds the peaks and joins of a raster, in tiles of `side` times `side` cells.
    ///
    /// # Errors
    /// When interrupted, or when the raster has more than 2^32 - 2 peaks.
    pub(super) fn grow(grid: &Grid<K>, nodata_is_sea: bool, side: usize, watch: &Watch) -> Result<Self> {
        let tiles = Tile::all(grid.rows(), grid.cols(), side);
        watch.begin("joining basins", tiles.len() as u64);
        let mut work: Vec<TileWork<K>> = tiles
            .into_par_iter()
            .map_init(
                || Scanner::new(grid, nodata_is_sea),
                |scanner, tile| {
                    let mut scan = scanner.scan(tile);
                    let forest = sweep_tile(&scan);
                    scan.passes = Vec::new();
                    scan.cells.shrink_to_fit();
                    scan.keys.shrink_to_fit();
                    watch.advance(1)?;
                    Ok(TileWork { tile, scan, forest, base: 0 })
                },
            )
            .collect::<Result<_>>()?;
        let mut total = 0_u64;
        for tile in &mut work {
            tile.base = u32::try_from(total).unwrap_or(u32::MAX);
            total += tile.scan.peaks as u64;
        }
        if total >= u64::from(u32::MAX) {
            return Err(Error::new(
                ErrorKind::Unsupported,
                format!(
                    "the raster has {total} local peaks, more than the 4294967294 that can be joined; cut it with --window or --bbox"
                ),
            ));
        }
        let portals = Portals::trace(grid, &work, side);
        let (mut forest, mut parent) = Self::assemble(&work, &portals);
        let mut events = events_of(grid, &work, &portals);
        drop(work);
        watch.check()?;
        sort(&mut events);
        forest.sweep(&mut parent, &events);
        Ok(forest)
    }

    /// The forest of peaks with given cells and keys that meet at passes: the key and cell of each, its number among
    /// those of its cell, and the numbers of the peaks on its two sides, the first on that of the saddle's topmost
    /// neighbour.
    pub(super) fn of_passes(cells: Vec<Cell>, keys: Vec<K>, passes: &[(K, Cell, u8, [PeakNumber; 2])]) -> Self {
        let none = Join { saddle: NO_CELL, near: 0, far: 0, key: K::VOID, nth: 0, near_is_a: false };
        let mut parent: Vec<PeakNumber> = (0..).take(cells.len()).collect();
        let mut forest = Self { joins: vec![none; cells.len()], cells, keys, touches: Vec::new() };
        let mut events: Vec<Event<K>> =
            passes.iter().map(|&(key, cell, nth, [a, b])| Event { key, cell, nth, a, b }).collect();
        sort(&mut events);
        forest.sweep(&mut parent, &events);
        forest
    }

    /// Puts the tiles' peaks and certain joins together; the second result has the joined ones linked already.
    fn assemble(work: &[TileWork<K>], portals: &Portals) -> (Self, Vec<PeakNumber>) {
        let total = work.last().map_or(0, |tile| tile.base as usize + tile.scan.peaks);
        let none = Join { saddle: NO_CELL, near: 0, far: 0, key: K::VOID, nth: 0, near_is_a: false };
        let mut forest = Self {
            cells: Vec::with_capacity(total),
            keys: Vec::with_capacity(total),
            joins: vec![none; total],
            touches: Vec::new(),
        };
        let mut parent: Vec<PeakNumber> = (0..total as PeakNumber).collect();
        for (t, tile) in work.iter().enumerate() {
            forest.cells.extend_from_slice(&tile.scan.cells[..tile.scan.peaks]);
            forest.keys.extend_from_slice(&tile.scan.keys[..tile.scan.peaks]);
            for (key, join) in &tile.forest.joins {
                let number = |node: Node| portals.number(t, tile, node);
                let ended = number(join.ended);
                parent[ended as usize] = number(join.into);
                forest.joins[ended as usize] = Join {
                    saddle: join.saddle,
                    near: number(join.near),
                    far: number(join.far),
                    key: *key,
                    nth: join.nth,
                    near_is_a: join.near_is_a,
                };
            }
        }
        (forest, parent)
    }

    /// The sweep over what the tiles could not decide.
    fn sweep(&mut self, parent: &mut [PeakNumber], events: &[Event<K>]) {
        self.touches = vec![NO_CELL; self.cells.len()];
        for event in events {
            let top_a = root(parent, event.a);
            if event.nth == TOUCH {
                if self.touches[top_a as usize] == NO_CELL {
                    self.touches[top_a as usize] = event.cell;
                }
                continue;
            }
            let top_b = root(parent, event.b);
            if top_a == top_b {
                continue;
            }
            let near_is_a = is_above(self.order(top_b), self.order(top_a));
            let (low, high) = if near_is_a { (top_a, top_b) } else { (top_b, top_a) };
            let (near, far) = if near_is_a { (event.a, event.b) } else { (event.b, event.a) };
            self.joins[low as usize] =
                Join { saddle: event.cell, near, far, key: event.key, nth: event.nth, near_is_a };
            if self.touches[high as usize] == NO_CELL && self.touches[low as usize] != NO_CELL {
                // Through the ended component the unknown is reached from here on.
                self.touches[high as usize] = event.cell;
            }
            if self.touches[low as usize] == event.cell {
                // Reached only through the saddle itself, which is no cell of the island.
                self.touches[low as usize] = NO_CELL;
            }
            parent[low as usize] = high;
        }
    }

    /// What the peaks are ordered by.
    #[inline]
    pub(super) fn order(&self, peak: PeakNumber) -> (K, Cell) {
        (self.keys[peak as usize], self.cells[peak as usize])
    }
}

/// The peaks that the portals of the tiles lead to.
struct Portals {
    /// Number of the peak, for each portal of each tile.
    peaks: Vec<Vec<PeakNumber>>,
}

/// A portal that has not been traced yet.
const UNTRACED: PeakNumber = PeakNumber::MAX;

impl Portals {
    /// Traces each portal through the tiles that its way up crosses.
    fn trace<K: Key>(grid: &Grid<K>, work: &[TileWork<K>], side: usize) -> Self {
        let mut peaks: Vec<Vec<PeakNumber>> =
            work.iter().map(|tile| vec![UNTRACED; tile.scan.cells.len() - tile.scan.peaks]).collect();
        let tile_cols = grid.cols().div_ceil(side);
        let mut way = Vec::new();
        for t in 0..work.len() {
            for i in 0..peaks[t].len() {
                let (mut tile, mut portal) = (t, i);
                way.clear();
                let peak = loop {
                    if peaks[tile][portal] != UNTRACED {
                        break peaks[tile][portal];
                    }
                    way.push((tile, portal));
                    let scan = &work[tile].scan;
                    let (row, col) = grid.place(scan.cells[scan.peaks + portal]);
                    tile = row / side * tile_cols + col / side;
                    let next = &work[tile];
                    let node = next.scan.ring[next.tile.ring_index(row - next.tile.row, col - next.tile.col)];
                    debug_assert_ne!(node, NO_NODE, "a way up never leads into a void");
                    if (node as usize) < next.scan.peaks {
                        break next.base + node;
                    }
                    portal = node as usize - next.scan.peaks;
                };
                for &(tile, portal) in &way {
                    peaks[tile][portal] = peak;
                }
            }
        }
        Self { peaks }
    }

    #[inline]
    fn number<K>(&self, t: usize, tile: &TileWork<K>, node: Node) -> PeakNumber {
        match (node as usize).checked_sub(tile.scan.peaks) {
            None => tile.base + node,
            Some(portal) => self.peaks[t][portal],
        }
    }
}

fn events_of<K: Key>(grid: &Grid<K>, work: &[TileWork<K>], portals: &Portals) -> Vec<Event<K>> {
    let mut events =
        Vec::with_capacity(work.iter().map(|tile| tile.forest.candidates.len() + tile.scan.frontier.len()).sum());
    for (t, tile) in work.iter().enumerate() {
        for &(key, pass) in &tile.forest.candidates {
            let (a, b) = (portals.number(t, tile, pass.a), portals.number(t, tile, pass.b));
            if a != b {
                events.push(Event { key, cell: pass.saddle, nth: pass.nth, a, b });
            }
        }
        for &(node, cell) in &tile.scan.frontier {
            let a = portals.number(t, tile, node);
            events.push(Event { key: grid.key(cell), cell, nth: TOUCH, a, b: a });
        }
    }
    events
}
