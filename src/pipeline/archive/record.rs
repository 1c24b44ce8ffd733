//! What a file says of a raster, in the words of the container and back.

use crate::codec::{BandRule, Bound};
use crate::io::raster::stored::{BandRecord, Item, Record};
use crate::oro::{Band, CellMeaning, Description, Georeference, MetadataItem};

/// The description of a container that keeps all of a record, with the guaranteed error of each band.
pub(in crate::pipeline) fn description_of(record: &Record, bounds: &[Bound], tile_side: usize) -> Description {
    let band = |(band, &bound): (&BandRecord, &Bound)| Band {
        rule: BandRule { sample: band.sample, nodata: band.nodata, bound },
        scale: band.scale,
        offset: band.offset,
        unit: band.unit.clone(),
        description: band.description.clone(),
        metadata: band.metadata.iter().map(kept).collect(),
    };
    Description {
        width: record.width,
        height: record.height,
        tile_side,
        georeference: Georeference {
            transform: record.transform,
            crs: record.crs.clone(),
            epoch: record.epoch,
            cells_are: if record.is_point { CellMeaning::Point } else { CellMeaning::Area },
        },
        bands: record.bands.iter().zip(bounds).map(band).collect(),
        metadata: record.metadata.iter().map(kept).collect(),
    }
}

/// The record of a container at level 0.
pub(in crate::pipeline) fn record_of(description: &Description) -> Record {
    let band = |band: &Band| BandRecord {
        sample: band.rule.sample,
        nodata: band.rule.nodata,
        scale: band.scale,
        offset: band.offset,
        unit: band.unit.clone(),
        description: band.description.clone(),
        metadata: band.metadata.iter().map(told).collect(),
    };
    let place = &description.georeference;
    Record {
        width: description.width,
        height: description.height,
        bands: description.bands.iter().map(band).collect(),
        transform: place.transform,
        crs: place.crs.clone(),
        epoch: place.epoch,
        is_point: place.cells_are == CellMeaning::Point,
        metadata: description.metadata.iter().map(told).collect(),
    }
}

fn kept(item: &Item) -> MetadataItem {
    let Item { domain, key, value } = item.clone();
    MetadataItem { domain, key, value }
}

fn told(item: &MetadataItem) -> Item {
    let MetadataItem { domain, key, value } = item.clone();
    Item { domain, key, value }
}
