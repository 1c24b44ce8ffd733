//! The sparse profile: chunks are patches, and cells are their blend.

use super::block::Block;
use super::chunk::{Chunk, ChunkBytes, seal};
use super::description::Description;
use super::dictionary::Dictionary;
use super::reader::Reader;
use super::source::RangeRead;
use super::tiling::Place;
use crate::codec::sparse::{Blend, Lattice, PatchTile, blended, decode_patches, encode_patches};
use crate::codec::{Cells, SEGMENTS, TileShape};
use crate::error::{Error, ErrorKind, Result};
use std::ops::Range;

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

    /// The cells of a block of a level: the blend of all patches that reach into it.
    pub(super) fn blend(
        &self,
        sparse: &Sparse,
        band: usize,
        level: u8,
        block: Block,
        damaged: &mut dyn FnMut(Error) -> Result<()>,
    ) -> Result<Cells> {
        let (area, rule) = (&self.tiles, self.tiles.rules[band]);
        let (cols, rows) = (block.col..block.col + block.width, block.row..block.row + block.height);
        let mut cells = super::block::zeros(rule.sample, block.width, block.height)?;
        let mut blend = Blend::new(sparse.lattice, 1 << level, cols.clone(), rows.clone());
        let (place_cols, place_rows) = blend.places();
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
        let chunks: Vec<u64> = places.map(|place| area.chunk(place)).collect();
        let mut voids = vec![false; block.width * block.height];
        // Row by row over all tiles, as cells add up patches in that order whatever the tiles.
        let mut strip: Vec<(PatchTile, [Range<usize>; 2])> = vec![];
        let mut read = vec![];
        for run in area.runs(chunks, SEGMENTS) {
            read.extend(area.read(&self.source, &run, SEGMENTS)?);
        }
        for (i, chunk) in read.iter().enumerate() {
            let (cols, rows) = places_of(&sparse.lattice, chunk.place, chunk.shape, chunk.side);
            match chunk.patches(sparse) {
                Ok(tile) => {
                    mark_voids(&mut voids, block, level, chunk, Some(&tile.voids));
                    strip.push((tile, [cols, rows]));
                }
                Err(error) if error.kind() == ErrorKind::Corrupt => {
                    damaged(error)?;
                    rows.for_each(|row| cols.clone().for_each(|col| blend.spoil((row, col))));
                    mark_voids(&mut voids, block, level, chunk, None);
                }
                Err(error) => return Err(error),
            }
            if read.get(i + 1).is_none_or(|next| next.place.row != chunk.place.row) {
                add_strip(&mut blend, sparse, &std::mem::take(&mut strip));
            }
        }
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
fn add_strip(blend: &mut Blend, sparse: &Sparse, strip: &[(PatchTile, [Range<usize>; 2])]) {
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

/// Marks those cells of a block that a tile says are void; all of its cells when nothing is known of it.
fn mark_voids(voids: &mut [bool], block: Block, level: u8, chunk: &ChunkBytes, tile: Option<&[bool]>) {
    if tile.is_some_and(<[bool]>::is_empty) {
        return;
    }
    let (left, top) = (chunk.place.col * chunk.side, chunk.place.row * chunk.side);
    for row in 0..block.height {
        for col in 0..block.width {
            let (x, y) = ((block.col + col) << level, (block.row + row) << level);
            if (left..left + chunk.shape.width).contains(&x) && (top..top + chunk.shape.height).contains(&y) {
                let inside = (y - top) * chunk.shape.width + x - left;
                voids[row * block.width + col] = tile.is_none_or(|tile| tile[inside]);
            }
        }
    }
}
