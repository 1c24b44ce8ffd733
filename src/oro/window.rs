//! Reads a rectangle of cells at any level.

use super::area::Area;
use super::block::{self, Block};
use super::reader::Reader;
use super::shelf::Shelf;
use super::source::RangeRead;
use super::tiling::Place;
use crate::codec::{Cells, TOP_LEVEL, segments_for};
use crate::error::{Error, ErrorKind, Result};

/// A rectangle of the cells of a level.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Window {
    /// First column.
    pub col: usize,
    /// First row.
    pub row: usize,
    /// Columns.
    pub width: usize,
    /// Rows.
    pub height: usize,
}

impl From<Window> for Block {
    fn from(window: Window) -> Self {
        Self { col: window.col, row: window.row, width: window.width, height: window.height }
    }
}

impl<R: RangeRead> Reader<R> {
    /// The cells of a window of a level, row by row; columns and rows count the level's own cells.
    ///
    /// Tiles that lie side by side in the file are read in one request. Levels from 6 on come from the overview where
    /// there is one, and from the tiles where there is none or it is damaged.
    ///
    /// # Errors
    /// When the window is not in the level, a tile is damaged, or the source cannot be read.
    pub fn window(&self, band: usize, level: u8, window: Window) -> Result<Cells> {
        self.window_or(band, level, window, &mut Err)
    }

    /// As [`Reader::window`]; but damaged tiles are shown to `damaged`, and when that says `Ok` their cells are voids:
    /// the nodata value, or 0 where there is none.
    ///
    /// # Errors
    /// When the window is not in the level, `damaged` says so, or the source cannot be read.
    pub fn window_or(
        &self,
        band: usize,
        level: u8,
        window: Window,
        damaged: &mut dyn FnMut(Error) -> Result<()>,
    ) -> Result<Cells> {
        self.window_with(&Shelf::default(), band, level, window, damaged)
    }

    /// As [`Reader::window_or`], for one of the windows that a shelf was made for: tiles that they share are decoded
    /// once.
    ///
    /// # Errors
    /// As [`Reader::window_or`].
    pub fn window_with(
        &self,
        shelf: &Shelf,
        band: usize,
        level: u8,
        window: Window,
        damaged: &mut dyn FnMut(Error) -> Result<()>,
    ) -> Result<Cells> {
        self.check_window(band, level, window)?;
        let block: Block = window.into();
        if let Some(sparse) = &self.tiles.sparse {
            return self.blend(sparse, shelf, (band, level), block, damaged);
        }
        if level >= TOP_LEVEL
            && let Some(overview) = &self.overview
        {
            match self.assemble(overview, band, level - TOP_LEVEL, block, &mut Err) {
                // The tiles say the same once more.
                Err(error) if error.kind() == ErrorKind::Corrupt => {}
                done => return done,
            }
        }
        self.assemble(&self.tiles, band, level, block, damaged)
    }

    /// The cells of a window as the tiles have them, whatever the overview says.
    pub(super) fn window_of_tiles(&self, band: usize, level: u8, window: Window) -> Result<Cells> {
        self.check_window(band, level, window)?;
        self.assemble(&self.tiles, band, level, window.into(), &mut Err)
    }

    pub(super) fn check_window(&self, band: usize, level: u8, window: Window) -> Result<()> {
        let bands = self.description.bands.len();
        if band >= bands {
            return Err(Error::usage(format!("band {}: the raster has {bands}", band + 1)));
        }
        let last = self.description.last_level();
        if level > last {
            return Err(Error::usage(format!("level {level}: the raster has levels 0 to {last}")));
        }
        let (width, height) = self.description.level_size(level);
        let fits = |from: usize, length: usize, side: usize| {
            length > 0 && from.checked_add(length).is_some_and(|end| end <= side)
        };
        if !fits(window.col, window.width, width) || !fits(window.row, window.height, height) {
            let Window { col, row, width: columns, height: rows } = window;
            let message =
                format!("{columns} x {rows} cells from column {col}, row {row}: level {level} has {width} x {height}");
            return Err(Error::usage(message));
        }
        Ok(())
    }

    /// A block of a level of the raster that an area holds.
    fn assemble(
        &self,
        area: &Area,
        band: usize,
        level: u8,
        block: Block,
        damaged: &mut dyn FnMut(Error) -> Result<()>,
    ) -> Result<Cells> {
        if level > TOP_LEVEL {
            // Tiles have no such level: their sides need not be multiples of its step.
            let beyond = level - TOP_LEVEL;
            let finer = Block {
                col: block.col << beyond,
                row: block.row << beyond,
                width: ((block.width - 1) << beyond) + 1,
                height: ((block.height - 1) << beyond) + 1,
            };
            let cells = self.assemble(area, band, TOP_LEVEL, finer, damaged)?;
            return Ok(cells.decimated(finer.width, beyond));
        }
        let side = area.tiling.side >> level;
        let (cols, rows) = (
            block.col / side..=(block.col + block.width - 1) / side,
            block.row / side..=(block.row + block.height - 1) / side,
        );
        let chunks = rows.flat_map(|row| cols.clone().map(move |col| area.chunk(Place { col, row, band })));
        let rule = area.rules[band];
        let mut cells = block::zeros(rule.sample, block.width, block.height)?;
        let segments = segments_for(level);
        for run in area.runs(chunks, segments) {
            for chunk in area.read(&self.source, &run, segments)? {
                let shape = chunk.shape.at_level(level);
                let Place { col, row, .. } = chunk.place;
                let from = Block { col: col * side, row: row * side, width: shape.width, height: shape.height };
                let tile = match chunk.decode(level) {
                    Err(error) if error.kind() == ErrorKind::Corrupt => {
                        damaged(error)?;
                        block::voids(rule.sample, rule.nodata, shape.cells())
                    }
                    decoded => decoded?,
                };
                block::copy(&mut cells, block, &tile, from);
            }
        }
        Ok(cells)
    }
}
