//! A chunk: one tile of one band as it stands in the file, every segment with its checksum.

use super::description::Description;
use super::sparse::Sparse;
use super::tiling::Place;
use crate::codec::{
    BandRule, Bound, Cells, EncodedTile, SEGMENTS, TOP_LEVEL, TileShape, decode_tile, encode_tile, segments_for,
};
use crate::error::{Error, ErrorKind, Result};
use std::sync::Arc;

/// Bytes of the checksum after each segment that is not empty.
pub(super) const CHECKSUM: usize = 4;

/// A chunk on its way into a file.
#[derive(Clone, Debug)]
pub struct Chunk {
    /// Where it belongs.
    pub place: Place,
    /// The segments with their checksums, one after the other.
    pub bytes: Vec<u8>,
    /// Lengths of the segments, without checksums.
    pub lengths: [u32; SEGMENTS],
    /// The coarsest level of the *decoded* tile, for the overview.
    pub top: Cells,
    /// The largest error of a cell, in stored values.
    pub largest_error: f64,
}

/// Encodes the cells of a tile, decodes them again and looks that every cell keeps what its band promises.
///
/// Pure: threads may encode many tiles of a raster at once.
///
/// # Errors
/// When the place is not in the raster, the cells do not fit it, or the promise is broken (a fault of the program).
pub fn encode_chunk(description: &Description, place: Place, cells: &Cells) -> Result<Chunk> {
    let tiling = description.tiling();
    let band = description.bands.get(place.band).filter(|_| tiling.contains(place.col, place.row));
    let band = band.ok_or_else(|| Error::usage(format!("{place}: the raster has no such tile")))?;
    encode(place, tiling.shape(place.col, place.row), &band.rule, cells)
        .map_err(|error| error.at_place(place.to_string()))
}

/// [`encode_chunk`] for a tile of any raster.
pub(super) fn encode(place: Place, shape: TileShape, rule: &BandRule, cells: &Cells) -> Result<Chunk> {
    let tile = encode_tile(cells, shape, rule)?;
    let segments: Vec<&[u8]> = tile.segments.iter().map(Vec::as_slice).collect();
    let decoded = decode_tile(&segments, shape, rule, 0)?;
    let largest_error = largest_error(cells, &decoded, rule)?;
    let (bytes, lengths) = seal(&tile)?;
    Ok(Chunk { place, bytes, lengths, top: decoded.decimated(shape.width, TOP_LEVEL), largest_error })
}

/// The bytes of a chunk and the lengths of its segments.
pub(super) fn seal(tile: &EncodedTile) -> Result<(Vec<u8>, [u32; SEGMENTS])> {
    // A chunk without bytes would let a tiny file claim any number of tiles.
    if tile.segments[0].is_empty() {
        return Err(Error::new(
            ErrorKind::Unsupported,
            "the first segment is empty, which the container does not hold",
        ));
    }
    let mut bytes = vec![];
    let mut lengths = [0; SEGMENTS];
    for (segment, length) in tile.segments.iter().zip(&mut lengths) {
        *length = u32::try_from(segment.len())
            .map_err(|_| Error::new(ErrorKind::Unsupported, "a segment of more than 4 GiB"))?;
        bytes.extend_from_slice(segment);
        if !segment.is_empty() {
            bytes.extend(crc32c::crc32c(segment).to_le_bytes());
        }
    }
    Ok((bytes, lengths))
}

/// The largest error among the cells, after a look that all of them keep to the rule.
fn largest_error(cells: &Cells, decoded: &Cells, rule: &BandRule) -> Result<f64> {
    let broken =
        || Error::new(ErrorKind::Unsupported, "a cell does not keep to the guaranteed error: please report this");
    let bound = match rule.bound {
        Bound::Lossless => 0.0,
        Bound::MaxError(bound) => bound,
    };
    if cells.sample() != decoded.sample() || cells.len() != decoded.len() {
        return Err(broken());
    }
    let mut largest = 0.0_f64;
    macro_rules! compare {
        ($($variant:ident),*) => {
            match (cells, decoded) {
                $((Cells::$variant(before), Cells::$variant(after)) => {
                    for (&before, &after) in before.iter().zip(after) {
                        let (bits, back) = (before.to_le_bytes(), after.to_le_bytes());
                        if bits == back {
                            continue;
                        }
                        // Wide enough for every difference of integers; of floats the nearest.
                        let (x, y) = (f64::from(before), f64::from(after));
                        let void = |bytes: &[u8]| rule.nodata.is_some_and(|nodata| nodata.to_le_bytes()[..bytes.len()] == *bytes);
                        let error = (x - y).abs();
                        if void(&bits) || void(&back) || !x.is_finite() || !y.is_finite() || error > bound || bound == 0.0 {
                            return Err(broken());
                        }
                        largest = largest.max(error);
                    }
                })*
                _ => return Err(broken()),
            }
        };
    }
    compare!(U8, I8, U16, I16, U32, I32, F32, F64);
    Ok(largest)
}

/// The first bytes of a chunk as they were read.
#[derive(Clone, Debug)]
pub struct ChunkBytes {
    /// Where it belongs.
    pub place: Place,
    /// Size of its tile.
    pub shape: TileShape,
    /// Side of whole tiles.
    pub(super) side: usize,
    /// Type, nodata value and bound of its cells.
    pub rule: BandRule,
    /// How it is made of patches, where it is not one of cells.
    pub(super) sparse: Option<Arc<Sparse>>,
    /// Lengths of all of its segments, without checksums.
    pub lengths: [u32; SEGMENTS],
    /// Its first segments with their checksums.
    pub bytes: Vec<u8>,
}

impl ChunkBytes {
    /// Decodes a level of the tile, 0 to [`TOP_LEVEL`], for which enough segments must have been read.
    ///
    /// Pure: threads may decode many chunks at once.
    ///
    /// # Errors
    /// [`ErrorKind::Corrupt`], with the place, when a checksum is wrong or the codec does not know the bytes.
    pub fn decode(&self, level: u8) -> Result<Cells> {
        if level > TOP_LEVEL {
            return Err(Error::usage(format!("level {level}: a tile has levels 0 to {TOP_LEVEL}")));
        }
        if self.sparse.is_some() {
            return Err(Error::usage("the tile is made of patches, and so of its neighbours: read a window"));
        }
        let segments = self.sound_segments(segments_for(level))?;
        let cells = decode_tile(&segments, self.shape, &self.rule, level)
            .map_err(|error| error.at_place(self.place.to_string()))?;
        let expected = self.shape.at_level(level);
        if cells.len() != expected.cells() || cells.sample() != self.rule.sample {
            return Err(
                Error::new(ErrorKind::Corrupt, "the bytes are of another tile").at_place(self.place.to_string())
            );
        }
        Ok(cells)
    }

    /// Looks whether the chunk can be decoded, once all of it was read.
    ///
    /// # Errors
    /// As [`ChunkBytes::decode`].
    pub fn check(&self) -> Result<()> {
        match &self.sparse {
            Some(sparse) => self.patches(sparse).map(|_| ()),
            None => [0, TOP_LEVEL].into_iter().try_for_each(|level| self.decode(level).map(|_| ())),
        }
    }

    /// The segments, when the first `needed` are sound.
    pub(super) fn sound_segments(&self, needed: usize) -> Result<Vec<&[u8]>> {
        let (segments, damaged) = self.segments();
        match damaged.iter().find(|&&segment| segment < needed) {
            None => Ok(segments),
            Some(&segment) => Err(Error::new(ErrorKind::Corrupt, "the checksum is wrong: the bytes are damaged")
                .at_place(format!("{}, segment {segment}", self.place))),
        }
    }

    /// The segments that the bytes hold, and the numbers of those whose checksum is wrong.
    pub(super) fn segments(&self) -> (Vec<&[u8]>, Vec<usize>) {
        let (mut segments, mut damaged) = (vec![], vec![]);
        let mut rest = self.bytes.as_slice();
        for (number, &length) in self.lengths.iter().enumerate() {
            let Some((segment, after)) = rest.split_at_checked(length as usize) else { break };
            rest = after;
            if length > 0 {
                let Some((checksum, after)) = rest.split_first_chunk::<CHECKSUM>() else { break };
                rest = after;
                if u32::from_le_bytes(*checksum) != crc32c::crc32c(segment) {
                    damaged.push(number);
                }
            }
            segments.push(segment);
        }
        (segments, damaged)
    }
}

/// Bytes that the first `segments` of these lengths take, with checksums.
pub(super) fn stored_length(lengths: &[u32; SEGMENTS], segments: usize) -> u64 {
    lengths[..segments].iter().map(|&length| if length > 0 { u64::from(length) + CHECKSUM as u64 } else { 0 }).sum()
}

/// Whether all cells have the same bits.
pub(super) fn same_bits(a: &Cells, b: &Cells) -> bool {
    // Not `==`, to which no NaN is equal and both zeros are.
    a.sample() == b.sample() && a.to_le_bytes() == b.to_le_bytes()
}
