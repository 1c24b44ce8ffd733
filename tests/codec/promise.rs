//! What the codec promises of every tile.

use orograph::codec::{
    BandRule, Bound, Cells, EncodedTile, SEGMENTS, TOP_LEVEL, TileShape, decode_tile, encode_tile, segments_for,
};
use orograph::with_cells;

/// A tile to be encoded.
#[derive(Clone, Debug)]
pub struct Tile {
    /// The cells, row by row.
    pub cells: Cells,
    /// How many columns and rows they have.
    pub shape: TileShape,
    /// What is promised.
    pub rule: BandRule,
}

/// The segments as the decoder takes them.
pub fn segments(tile: &EncodedTile) -> [&[u8]; SEGMENTS] {
    tile.segments.each_ref().map(Vec::as_slice)
}

impl Tile {
    /// Encodes and decodes the tile, at every level, and looks that all promises are kept. Returns the bytes.
    #[track_caller]
    pub fn assert_holds(&self) -> EncodedTile {
        let Self { cells, shape, rule } = self;
        let what = format!("{shape:?} {rule:?}");
        let encoded = encode_tile(cells, *shape, rule).unwrap_or_else(|error| panic!("{what}: {error}"));
        assert!(!encoded.segments[0].is_empty(), "{what}: the container takes no tile without a first segment");
        assert_eq!(encode_tile(cells, *shape, rule).expect("encodes"), encoded, "{what}: other bytes the second time");
        let segments = segments(&encoded);
        let decode = |level: u8| {
            let needed = &segments[..segments_for(level)];
            decode_tile(needed, *shape, rule, level).unwrap_or_else(|error| panic!("{what}, level {level}: {error}"))
        };
        let decoded = decode(0);
        if let Some(index) = self.broken(&decoded) {
            let (before, after) = (text(cells, index), text(&decoded, index));
            panic!("{what}: cell {index} was {before} and came back as {after}");
        }
        for level in 1..=TOP_LEVEL {
            let same = decode(level).to_le_bytes() == decoded.decimated(shape.width, level).to_le_bytes();
            assert!(same, "{what}: level {level} is not the cells decimated");
        }
        encoded
    }

    /// The first cell that is not what the rule promises.
    pub fn broken(&self, decoded: &Cells) -> Option<usize> {
        assert_eq!((decoded.sample(), decoded.len()), (self.cells.sample(), self.cells.len()), "another tile");
        let bound = match self.rule.bound {
            Bound::Lossless => None,
            Bound::MaxError(bound) => Some(bound),
        };
        let size = self.cells.sample().bytes();
        let (before, after) = (self.cells.to_le_bytes(), decoded.to_le_bytes());
        let is_void = |bytes: &[u8]| self.rule.nodata.is_some_and(|bits| bits.to_le_bytes()[..size] == *bytes);
        (0..self.cells.len()).find(|&index| {
            let range = index * size..(index + 1) * size;
            let (bits, back) = (&before[range.clone()], &after[range]);
            if bits == back {
                return false;
            }
            // Voids, NaN and infinities come back to the bit, and nothing else becomes one of them.
            let Some(bound) = bound else { return true };
            let (x, y) = (value(&self.cells, index), value(decoded, index));
            is_void(bits) || is_void(back) || !x.is_finite() || !y.is_finite() || (x - y).abs() > bound
        })
    }
}

#[allow(clippy::useless_conversion, reason = "one of the types is f64 already")]
fn value(cells: &Cells, index: usize) -> f64 {
    with_cells!(cells, values => f64::from(values[index]))
}

fn text(cells: &Cells, index: usize) -> String {
    with_cells!(cells, values => format!("{:?}", values[index]))
}
