//! How large tiles are unless the user says so.

use crate::io::raster::stored::Record;
use crate::oro::DEFAULT_TILE_SIDE;

/// What a tile of longitudes and latitudes spans at most. Beyond it the cells of its rows differ so much in shape that
/// few filters do not predict them well: on ETOPO5 tiles of 1024 cells take 1 per cent more. Tiles of
/// 192 cells, too small for zones, take 3.5 per cent more.
const MOST_DEGREES: f64 = 32.0;
/// Smaller tiles cost more than they gain: on the Moon at four cells a degree 192 cells take 0.7 per cent more.
const LEAST_SIDE: usize = 384;

/// Sides that are tried, from this part of the usual one to that.
const FACTORS: [f64; 2] = [0.625, 1.5];

/// The side of a raster's tiles in cells: the one nearest to 1024 that leaves no narrow tiles at the end of a row or
/// column, so that the degree cells of SRTM (1201 x 1201) are one tile and not four, three of them slivers that cost
/// time and up to 1 per cent of the bytes.
pub(in crate::pipeline) fn tile_side_of(record: &Record) -> usize {
    let most = most_cells(record);
    let [first, last] = FACTORS.map(|factor| (DEFAULT_TILE_SIDE as f64 * factor) as usize / 64);
    (first..=last)
        .map(|steps| steps * 64)
        .filter(|&side| side <= most && ends_well(record.width, side) && ends_well(record.height, side))
        // Of two as near, the larger, which costs fewer bytes.
        .min_by_key(|&side| (side.abs_diff(DEFAULT_TILE_SIDE), usize::MAX - side))
        .unwrap_or(most.min(DEFAULT_TILE_SIDE))
}

/// Whether the last tile along an edge is at least half as long as the others.
fn ends_well(cells: usize, side: usize) -> bool {
    cells <= side || cells.is_multiple_of(side) || cells % side >= side / 2
}

/// The longest side of tiles of longitudes and latitudes, a multiple of 64; no limit for others.
fn most_cells(record: &Record) -> usize {
    let is_geographic = record.crs.as_deref().is_some_and(|crs| crs.starts_with("GEOG"));
    match record.transform {
        Some(transform) if is_geographic => {
            let cells = MOST_DEGREES / transform.0[5].abs().max(transform.0[4].abs());
            // NaN and infinity end at one of the limits.
            (cells.min(4096.0) as usize / 64 * 64).max(LEAST_SIDE)
        }
        _ => usize::MAX,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::GeoTransform;

    fn side_of(crs: &str, degrees: f64, [width, height]: [usize; 2]) -> usize {
        let transform = Some(GeoTransform([0.0, degrees, 0.0, 90.0, 0.0, -degrees]));
        tile_side_of(&Record {
            width,
            height,
            bands: Vec::new(),
            transform,
            crs: Some(crs.to_owned()),
            epoch: None,
            is_point: false,
            metadata: Vec::new(),
        })
    }

    #[test]
    fn coarse_longitudes_and_latitudes_have_smaller_tiles() {
        let side = |crs, degrees| side_of(crs, degrees, [10, 10]);
        assert_eq!(side("GEOGCRS[\"WGS 84\"]", 1.0 / 3600.0), 1024);
        assert_eq!(side("GEOGCRS[\"WGS 84\"]", 1.0 / 120.0), 1024);
        assert_eq!(side("GEOGCRS[\"WGS 84\"]", 1.0 / 12.0), 384);
        assert_eq!(side("GEOGCRS[\"WGS 84\"]", 1.0 / 30.0), 960);
        assert_eq!(side("GEOGCRS[\"Moon\"]", 0.25), 384);
        assert_eq!(side("PROJCRS[\"UTM\"]", 30.0), 1024);
    }

    #[test]
    fn no_tile_is_a_sliver() {
        let side = |size| side_of("PROJCRS[\"UTM\"]", 30.0, size);
        assert_eq!(side([1201, 1201]), 1216);
        assert_eq!(side([3601, 3601]), 1024);
        assert_eq!(side([2160, 2160]), 1088);
        assert_eq!(side([1025, 300]), 1088);
        assert_eq!(side([10_801, 10_801]), 1024);
        assert_eq!(side([65_537, 1]), 1152);
        for cells in 1..6000 {
            let side = side([cells, cells]);
            assert!((640..=1536).contains(&side), "{cells}: {side}");
            assert!(ends_well(cells, side), "{cells}: {side}");
        }
    }
}
