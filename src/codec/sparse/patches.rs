//! The patches of a tile as segments.

use super::super::cells::Cells;
use super::super::decode_tile::decode_tile;
use super::super::encode_tile::encode_tile;
use super::super::parts::{put_part, take_part};
use super::super::tile::{BandRule, Bound, EncodedTile, SEGMENTS, TileShape};
use super::terms::{self, MAX_TERMS, Term, Terms, decode_terms, encode_terms};
use crate::error::{Error, ErrorKind, Result};
use crate::grid::SampleType;

/// How means are coded: an ordinary tile with one cell a patch, void where there is no patch.
const MEANS: BandRule =
    BandRule { sample: SampleType::I32, nodata: Some(i32::MIN as u32 as u64), bound: Bound::Lossless };
/// How voids are coded: an ordinary tile whose cells are all 0 or void.
const VOIDS: BandRule = BandRule { sample: SampleType::U8, nodata: Some(1), bound: Bound::Lossless };

/// The patches of one tile, row by row.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct PatchTile {
    /// Columns and rows of places for patches; none where the tile holds no patch's place.
    pub across: usize,
    /// Rows of places.
    pub down: usize,
    /// The mean of the patch at each place in steps, more than `i32::MIN`; nothing where there is no patch.
    pub means: Vec<Option<i32>>,
    counts: Vec<u32>,
    terms: Vec<Term>,
    /// For each cell of the tile whether it is void; empty when none is.
    pub voids: Vec<bool>,
}

impl PatchTile {
    /// Places without patches.
    pub fn new(across: usize, down: usize) -> Self {
        Self { across, down, ..Self::default() }
    }

    /// Fills the next place: no patch, or a mean and its terms in any order.
    pub fn push(&mut self, patch: Option<(i32, &[Term])>) {
        self.means.push(patch.map(|(mean, _)| mean));
        if let Some((_, terms)) = patch {
            let begin = self.terms.len();
            self.terms.extend_from_slice(terms);
            terms::sort(&mut self.terms[begin..]);
            self.counts.push(terms.len() as u32);
        }
    }

    /// All places in their order: the mean and the terms of each patch.
    pub fn patches(&self) -> impl Iterator<Item = Option<(i32, &[Term])>> {
        let (mut patch, mut begin) = (0, 0);
        self.means.iter().map(move |mean| {
            let mean = (*mean)?;
            let end = begin + self.counts[patch] as usize;
            let terms = &self.terms[begin..end];
            (patch, begin) = (patch + 1, end);
            Some((mean, terms))
        })
    }

    fn present(&self) -> Vec<bool> {
        self.means.iter().map(Option::is_some).collect()
    }
}

/// Makes segments of the patches of a tile of `shape` cells: the first has the means, the second the terms, the third
/// the voids; of `atoms` atoms a patch takes `sparsity` at most.
///
/// # Errors
/// `Usage` when the patches do not fit their number, or terms their limits.
pub fn encode_patches(tile: &PatchTile, shape: TileShape, atoms: u32, sparsity: usize) -> Result<EncodedTile> {
    let places = tile.across * tile.down;
    let whole = tile.means.len() == places && (tile.voids.is_empty() || tile.voids.len() == shape.cells());
    if !whole || tile.means.contains(&Some(i32::MIN)) || atoms == 0 || sparsity > MAX_TERMS {
        return Err(Error::usage("patches that do not fit their tile"));
    }
    let mut encoded = EncodedTile::default();
    let means = tile.means.iter().map(|mean| mean.unwrap_or(i32::MIN)).collect();
    encoded.segments[0] = pack(Cells::I32(means), TileShape { width: tile.across, height: tile.down }, &MEANS)?;
    let terms = Terms { counts: tile.counts.clone(), terms: tile.terms.clone() };
    encoded.segments[1] = encode_terms(&terms, (tile.across, &tile.present()), (atoms, sparsity))?;
    if !tile.voids.is_empty() {
        let voids = tile.voids.iter().map(|&void| u8::from(void)).collect();
        encoded.segments[2] = pack(Cells::U8(voids), shape, &VOIDS)?;
    }
    Ok(encoded)
}

/// The patches of a tile of `shape` cells with so many places.
///
/// # Errors
/// [`ErrorKind::Corrupt`] when the segments are no such patches.
pub fn decode_patches(
    segments: &[&[u8]],
    shape: TileShape,
    (across, down): (usize, usize),
    (atoms, sparsity): (u32, usize),
) -> Result<PatchTile> {
    let corrupt = |message: &str| Error::new(ErrorKind::Corrupt, message);
    let &[means, terms, voids, rest] = segments else { return Err(corrupt("a segment of the tile is missing")) };
    if !rest.is_empty() {
        return Err(corrupt("segment 3 should be empty"));
    }
    if atoms == 0 || sparsity > MAX_TERMS {
        return Err(Error::usage("a dictionary without atoms, or too many terms"));
    }
    let mut tile = PatchTile::new(across, down);
    if let Cells::I32(means) = unpack(means, TileShape { width: across, height: down }, &MEANS)? {
        tile.means = means.into_iter().map(|mean| (mean != i32::MIN).then_some(mean)).collect();
    }
    let found = decode_terms(terms, (across, &tile.present()), (atoms, sparsity))?;
    (tile.counts, tile.terms) = (found.counts, found.terms);
    if !voids.is_empty()
        && let Cells::U8(cells) = unpack(voids, shape, &VOIDS)?
    {
        if cells.iter().any(|&cell| cell > 1) || !cells.contains(&1) {
            return Err(corrupt("segment 2 is no mask of voids"));
        }
        tile.voids = cells.into_iter().map(|cell| cell == 1).collect();
    }
    Ok(tile)
}

/// The segments of an ordinary tile as one string of bytes; empty ones for a tile without cells.
fn pack(cells: Cells, shape: TileShape, rule: &BandRule) -> Result<Vec<u8>> {
    let tile = match shape.cells() {
        0 => EncodedTile::default(),
        _ => encode_tile(&cells, shape, rule)?,
    };
    let mut packed = vec![];
    tile.segments.iter().for_each(|segment| put_part(&mut packed, segment));
    Ok(packed)
}

/// The cells of a packed tile.
fn unpack(mut packed: &[u8], shape: TileShape, rule: &BandRule) -> Result<Cells> {
    let mut segments = [&[][..]; SEGMENTS];
    for segment in &mut segments {
        *segment = take_part(&mut packed)?;
    }
    if !packed.is_empty() || (shape.cells() == 0 && segments.iter().any(|segment| !segment.is_empty())) {
        return Err(Error::new(ErrorKind::Corrupt, "a packed tile goes on after its end"));
    }
    match shape.cells() {
        0 => Ok(Cells::zeros(rule.sample, 0)),
        _ => decode_tile(&segments, shape, rule, 0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const SHAPE: TileShape = TileShape { width: 9, height: 7 };

    fn any_patch(atoms: u32, sparsity: usize) -> impl Strategy<Value = Option<(i32, Vec<Term>)>> {
        let part = prop_oneof![-3i32..4, -2000i32..2000, any::<i32>()];
        let term = (0..atoms, part.prop_filter("a coefficient", |&part| part != 0 && part != i32::MIN));
        let terms = prop::collection::btree_map(term.0, term.1, 0..=sparsity);
        let patch = (-20_000i32..20_000, terms);
        prop::option::weighted(0.8, patch).prop_map(|patch| {
            patch.map(|(mean, terms)| (mean, terms.into_iter().map(|(atom, part)| Term { atom, part }).collect()))
        })
    }

    fn any_tile() -> impl Strategy<Value = (PatchTile, u32, usize)> {
        (0usize..6, 0usize..6, 1u32..20, 0usize..5).prop_flat_map(|(across, down, atoms, sparsity)| {
            let sparsity = sparsity.min(atoms as usize);
            let patches = prop::collection::vec(any_patch(atoms, sparsity), across * down);
            let voids = prop_oneof![Just(vec![]), prop::collection::vec(any::<bool>(), SHAPE.cells())];
            (patches, voids).prop_map(move |(patches, voids)| {
                let mut tile = PatchTile::new(across, down);
                patches.iter().for_each(|patch| tile.push(patch.as_ref().map(|(mean, terms)| (*mean, &terms[..]))));
                tile.voids = if voids.contains(&true) { voids } else { vec![] };
                (tile, atoms, sparsity)
            })
        })
    }

    fn parts(encoded: &EncodedTile) -> Vec<&[u8]> {
        encoded.segments.iter().map(Vec::as_slice).collect()
    }

    proptest! {
        #[test]
        fn patches_come_back((tile, atoms, sparsity) in any_tile()) {
            let encoded = encode_patches(&tile, SHAPE, atoms, sparsity).unwrap();
            let back = decode_patches(&parts(&encoded), SHAPE, (tile.across, tile.down), (atoms, sparsity)).unwrap();
            prop_assert_eq!(&back, &tile);
            prop_assert_eq!(back.patches().count(), tile.across * tile.down);
        }

        #[test]
        fn damaged_bytes_are_refused_or_are_other_patches((tile, atoms, sparsity) in any_tile(), flips in any::<u64>()) {
            let encoded = encode_patches(&tile, SHAPE, atoms, sparsity).unwrap();
            let decode = |parts: &[&[u8]]| decode_patches(parts, SHAPE, (tile.across, tile.down), (atoms, sparsity));
            for segment in 0..3 {
                let mut damaged = encoded.clone();
                let bytes = &mut damaged.segments[segment];
                if bytes.is_empty() {
                    continue;
                }
                let bit = flips as usize % (bytes.len() * 8);
                bytes[bit / 8] ^= 1 << (bit % 8);
                let mut short = encoded.clone();
                short.segments[segment].pop();
                for bytes in [damaged, short] {
                    // A tile of voids alone has bits that say nothing; the terms have none.
                    let back = decode(&parts(&bytes));
                    prop_assert!(back.map_or(true, |back| segment != 1 || back != tile), "bytes that say nothing");
                }
            }
        }
    }

    #[test]
    fn a_place_without_a_patch_comes_back() {
        // Found by the property above.
        let mut tile = PatchTile::new(1, 1);
        tile.push(None);
        let encoded = encode_patches(&tile, SHAPE, 1, 0).unwrap();
        assert_eq!(decode_patches(&parts(&encoded), SHAPE, (1, 1), (1, 0)).unwrap(), tile);
        for bit in 0..encoded.segments[0].len() * 8 {
            let mut damaged = encoded.clone();
            damaged.segments[0][bit / 8] ^= 1 << (bit % 8);
            let _ = decode_patches(&parts(&damaged), SHAPE, (1, 1), (1, 0));
        }
    }

    #[test]
    fn what_does_not_fit_is_refused() {
        let mut tile = PatchTile::new(1, 1);
        assert!(encode_patches(&tile, SHAPE, 4, 2).is_err(), "a place is not filled");
        tile.push(Some((0, &[Term { atom: 4, part: 1 }])));
        assert!(encode_patches(&tile, SHAPE, 4, 2).is_err(), "no such atom");
        assert!(encode_patches(&tile, SHAPE, 5, 0).is_err(), "too many terms");
        assert!(encode_patches(&tile, SHAPE, 5, 1).is_ok());
        let mut twice = PatchTile::new(1, 1);
        twice.push(Some((0, &[Term { atom: 1, part: 1 }, Term { atom: 1, part: 2 }])));
        assert!(encode_patches(&twice, SHAPE, 4, 2).is_err(), "an atom twice");
    }
}
