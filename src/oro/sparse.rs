//! The sparse profile: chunks are patches, and cells are their blend.

use super::block::Block;
use super::chunk::{Chunk, ChunkBytes, seal};
use super::description::Description;
use super::dictionary::Dictionary;
use super::reader::Reader;
use super::shelf::Shelf;
use super::source::RangeRead;
use super::tiling::Place;
use crate::codec::sparse::{Blend, Lattice, PatchTile, blended, decode_patches, encode_patches};
use crate::codec::{Cells, SEGMENTS, TileShape};
use crate::error::{Error, ErrorKind, Result};
use std::ops::Range;
use std::sync::Arc;

/// A dictionary with the lattice of a raster's patches.
#[derive(Debug)]
pub(super) struct Sparse {
    pub(super) dictionary: Dictionary,
    pub(super) lattice: Lattice,
}

/// Columns and rows of the places that are stored with a tile of a raster whose whole tiles have a `side`.
fn places_of(lattice: &Lattice, place: Place, shape: TileShape, side: usize) -> (Range<usize>, Range<usize>) {
    let stored = |first: usize, length: usize| lattice.stored_with(first * side..first * side + length);
    (stored(place.col, shape.width), stored(place.row, shape.height))
}

/// Number of atoms, and most terms of a patch.
fn limits(dictionary: &Dictionary) -> (u32, usize) {
    // A dictionary has far fewer atoms than 2^32.
    (dictionary.count() as u32, dictionary.sparsity)
}

/// Encodes the patches of a tile: those at the places that its cells' columns and rows hold when each is divided by
/// the dictionary's step without a rest.
///
/// # Errors
/// When the place is not in the raster, or the patches do not fit it or the dictionary.
pub fn encode_patch_chunk(
    description: &Description,
    dictionary: &Dictionary,
    place: Place,
    patches: &PatchTile,
) -> Result<Chunk> {
    dictionary.check(description)?;
    let tiling = description.tiling();
    if !tiling.contains(place.col, place.row) || place.band != 0 {
        return Err(Error::usage(format!("{place}: the raster has no such tile")));
    }
    let shape = tiling.shape(place.col, place.row);
    let (cols, rows) = places_of(&dictionary.lattice(description), place, shape, tiling.side);
    if (patches.across, patches.down) != (cols.len(), rows.len()) {
        let (across, down) = (patches.across, patches.down);
        let message = format!("{across} x {down} patches for {} x {} places", cols.len(), rows.len());
        return Err(Error::usage(message).at_place(place.to_string()));
    }
    let (atoms, sparsity) = limits(dictionary);
    let tile = encode_patches(patches, shape, atoms, sparsity).map_err(|error| error.at_place(place.to_string()))?;
    let (bytes, lengths) = seal(&tile)?;
    Ok(Chunk { place, bytes, lengths, top: Cells::F32(vec![]), largest_error: 0.0 })
}

impl ChunkBytes {
    /// The patches of the chunk.
    pub(super) fn patches(&self, sparse: &Sparse) -> Result<PatchTile> {
        let segments = self.sound_segments(SEGMENTS)?;
        let (cols, rows) = places_of(&sparse.lattice, self.place, self.shape, self.side);
        decode_patches(&segments, self.shape, (cols.len(), rows.len()), limits(&sparse.dictionary))
            .map_err(|error| error.at_place(self.place.to_string()))
    }
}

impl<R: RangeRead> Reader<R> {
    /// The patches of a tile, with the column and the row of the first place that is stored with it.
    ///
    /// # Errors
    /// When the file is not of the sparse profile, the raster has no such tile, or its bytes are damaged.
    pub fn patches(&self, place: Place) -> Result<(PatchTile, [usize; 2])> {
        let sparse = self.tiles.sparse.as_deref();
        let sparse = sparse.ok_or_else(|| Error::usage("the file is not of the sparse profile: it has no patches"))?;
        let chunk = self.chunk(place, 0)?;
        let (cols, rows) = places_of(&sparse.lattice, place, chunk.shape, chunk.side);
        Ok((chunk.patches(sparse)?, [cols.start, rows.start]))
    }

    /// The chunks whose patches or voids reach into a block of a level, in ascending order.
    pub(super) fn chunks_of_patches(&self, sparse: &Sparse, band: usize, level: u8, block: Block) -> Vec<u64> {
        let area = &self.tiles;
        let (cols, rows) = (block.col..block.col + block.width, block.row..block.row + block.height);
        let whole = |cells: &Range<usize>| cells.start << level..((cells.end - 1) << level) + 1;
        let (place_cols, place_rows) = (sparse.lattice.columns(&whole(&cols)), sparse.lattice.rows(&whole(&rows)));
        // Places are stored with the tile that has the cell which is their number times the step, and voids with the
        // tile of the cells.
        let tiles = |places: &Range<usize>, cells: &Range<usize>| {
            let tile = |cell: usize| cell / area.tiling.side;
            let (first, last) = (cells.start << level, (cells.end - 1) << level);
            let (lowest, highest) = (places.start * sparse.dictionary.step, (places.end - 1) * sparse.dictionary.step);
            tile(first.min(lowest))..=tile(last.max(highest))
        };
        let (tile_cols, tile_rows) = (tiles(&place_cols, &cols), tiles(&place_rows, &rows));
        let places = tile_rows.flat_map(|row| tile_cols.clone().map(move |col| Place { col, row, band }));
        places.map(|place| area.chunk(place)).collect()
    }

    /// The cells of a block of a level: the blend of all patches that reach into it.
    pub(super) fn blend(
        &self,
        sparse: &Sparse,
        shelf: &Shelf,
        (band, level): (usize, u8),
        block: Block,
        damaged: &mut dyn FnMut(Error) -> Result<()>,
    ) -> Result<Cells> {
        let (area, rule) = (&self.tiles, self.tiles.rules[band]);
        let (cols, rows) = (block.col..block.col + block.width, block.row..block.row + block.height);
        let mut cells = super::block::zeros(rule.sample, block.width, block.height)?;
        let mut blend = Blend::new(sparse.lattice, 1 << level, cols, rows);
        let chunks = self.chunks_of_patches(sparse, band, level, block);
        let known: Vec<Option<Arc<PatchTile>>> = chunks.iter().map(|&chunk| shelf.get(chunk)).collect();
        let missing: Vec<u64> = chunks.iter().zip(&known).filter(|(_, tile)| tile.is_none()).map(|(c, _)| *c).collect();
        let mut read = vec![];
        for run in area.runs(missing, SEGMENTS) {
            read.extend(area.read(&self.source, &run, SEGMENTS)?);
        }
        let mut read = read.into_iter();
        let mut voids = vec![false; block.width * block.height];
        // Row by row over all tiles, as cells add up patches in that order whatever the tiles.
        let mut strip: Vec<(Arc<PatchTile>, [Range<usize>; 2])> = vec![];
        for (i, (&chunk, known)) in chunks.iter().zip(known).enumerate() {
            let place = area.place(chunk);
            let (shape, side) = (area.tiling.shape(place.col, place.row), area.tiling.side);
            let (cols, rows) = places_of(&sparse.lattice, place, shape, side);
            let cells =
                Block { col: place.col * side, row: place.row * side, width: shape.width, height: shape.height };
            let read = || match read.next() {
                Some(chunk) => chunk.patches(sparse).map(Arc::new),
                None => Err(Error::usage(format!("{place}: the tile was not read"))),
            };
            match known.map_or_else(read, Ok) {
                Ok(tile) => {
                    shelf.keep(chunk, &tile);
                    mark_voids(&mut voids, block, level, cells, Some(&tile.voids));
                    strip.push((tile, [cols, rows]));
                }
                Err(error) if error.kind() == ErrorKind::Corrupt => {
                    damaged(error)?;
                    rows.for_each(|row| cols.clone().for_each(|col| blend.spoil((row, col))));
                    mark_voids(&mut voids, block, level, cells, None);
                }
                Err(error) => return Err(error),
            }
            if chunks.get(i + 1).is_none_or(|&next| area.place(next).row != place.row) {
                add_strip(&mut blend, sparse, &std::mem::take(&mut strip));
            }
        }
        shelf.used(&chunks);
        if let Cells::F32(values) = &mut cells {
            let nodata = rule.nodata.map(|bits| bits as u32);
            for ((value, height), void) in values.iter_mut().zip(blend.cells()).zip(voids) {
                *value = match void || height.is_nan() {
                    true => nodata.map_or(f32::NAN, f32::from_bits),
                    false => blended(height, nodata),
                };
            }
        }
        Ok(cells)
    }
}

/// Adds the patches of tiles that lie side by side: row by row, and in each row tile by tile.
fn add_strip(blend: &mut Blend, sparse: &Sparse, strip: &[(Arc<PatchTile>, [Range<usize>; 2])]) {
    let Some((_, [_, rows])) = strip.first() else { return };
    let (wanted_cols, wanted_rows) = blend.places();
    let mut tiles: Vec<_> = strip.iter().map(|(tile, [cols, _])| (tile.patches(), cols.clone())).collect();
    for row in rows.clone() {
        for (patches, cols) in &mut tiles {
            for col in cols.clone() {
                let patch = patches.next().flatten();
                if let Some(patch) = patch.filter(|_| wanted_rows.contains(&row) && wanted_cols.contains(&col)) {
                    blend.add((row, col), patch, &sparse.dictionary.atoms, &sparse.dictionary.steps);
                }
            }
        }
    }
}

/// Marks those cells of a block that a tile says are void; all of its cells when nothing is known of it. `cells` are
/// where the tile lies.
fn mark_voids(voids: &mut [bool], block: Block, level: u8, cells: Block, tile: Option<&[bool]>) {
    if tile.is_some_and(<[bool]>::is_empty) {
        return;
    }
    let (left, top) = (cells.col, cells.row);
    for row in 0..block.height {
        for col in 0..block.width {
            let (x, y) = ((block.col + col) << level, (block.row + row) << level);
            if (left..left + cells.width).contains(&x) && (top..top + cells.height).contains(&y) {
                let inside = (y - top) * cells.width + x - left;
                voids[row * block.width + col] = tile.is_none_or(|tile| tile[inside]);
            }
        }
    }
}
