//! How large tiles are unless the user says so.

use crate::io::raster::stored::Record;
use crate::oro::DEFAULT_TILE_SIDE;

/// What a tile of longitudes and latitudes spans at most. Beyond it the cells of its rows differ so much in shape that
/// few filters do not predict them well: on ETOPO5 tiles of 1024 cells take 1 per cent more. Tiles of
/// 192 cells, too small for zones, take 3.5 per cent more.
const MOST_DEGREES: f64 = 32.0;
/// Smaller tiles cost more than they gain: on the Moon at four cells a degree 192 cells take 0.7 per cent more.
const LEAST_SIDE: usize = 384;

/// The side of a raster's tiles in cells.
pub(super) fn tile_side_of(record: &Record) -> usize {
    let is_geographic = record.crs.as_deref().is_some_and(|crs| crs.starts_with("GEOG"));
    match record.transform {
        Some(transform) if is_geographic => {
            let cells = MOST_DEGREES / transform.0[5].abs().max(transform.0[4].abs());
            // NaN and infinity end at one of the limits.
            (cells.min(4096.0) as usize / 64 * 64).clamp(LEAST_SIDE, DEFAULT_TILE_SIDE)
        }
        _ => DEFAULT_TILE_SIDE,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::GeoTransform;

    fn side(crs: &str, degrees: f64) -> usize {
        let transform = Some(GeoTransform([0.0, degrees, 0.0, 90.0, 0.0, -degrees]));
        tile_side_of(&Record {
            width: 10,
            height: 10,
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
        assert_eq!(side("GEOGCRS[\"WGS 84\"]", 1.0 / 3600.0), 1024);
        assert_eq!(side("GEOGCRS[\"WGS 84\"]", 1.0 / 120.0), 1024);
        assert_eq!(side("GEOGCRS[\"WGS 84\"]", 1.0 / 12.0), 384);
        assert_eq!(side("GEOGCRS[\"WGS 84\"]", 1.0 / 30.0), 960);
        assert_eq!(side("GEOGCRS[\"Moon\"]", 0.25), 384);
        assert_eq!(side("PROJCRS[\"UTM\"]", 30.0), 1024);
    }
}
