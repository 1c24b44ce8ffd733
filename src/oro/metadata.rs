//! META: everything that a [`Description`] says, in few bytes.

use super::bytes::{Cursor, put_float, put_varint};
use super::description::{
    Band, CellMeaning, Description, Georeference, MAX_BANDS, MAX_CHUNKS, MAX_SIDE, MAX_TEXT, MetadataItem,
    TILE_SIDE_STEP,
};
use super::{index, text};
use crate::codec::{BandRule, Bound, MAX_TILE_SIDE, TABLE_SET};
use crate::error::{Error, ErrorKind, Result};
use crate::grid::{GeoTransform, SampleType};

/// Flags of the raster.
mod flag {
    /// There is a geotransform.
    pub(super) const TRANSFORM: u8 = 1;
    /// Its terms of rotation are stored, else they are 0.
    pub(super) const ROTATED: u8 = 1 << 1;
    /// The height of its cells is stored, else it is the width's negative.
    pub(super) const NOT_SQUARE: u8 = 1 << 2;
    /// There is a CRS.
    pub(super) const CRS: u8 = 1 << 3;
    /// There is a coordinate epoch.
    pub(super) const EPOCH: u8 = 1 << 4;
    /// A cell's value stands for a point.
    pub(super) const POINT: u8 = 1 << 5;
    /// There is metadata.
    pub(super) const METADATA: u8 = 1 << 6;
    /// All bands are like the first, texts aside.
    pub(super) const ALIKE: u8 = 1 << 7;
}

/// Flags of a band; the low three bits are its type.
mod band_flag {
    /// Bits of the type.
    pub(super) const TYPE: u8 = 7;
    /// There is a nodata value.
    pub(super) const NODATA: u8 = 1 << 3;
    /// Cells may differ from the original.
    pub(super) const MAX_ERROR: u8 = 1 << 4;
    /// A scale is set.
    pub(super) const SCALE: u8 = 1 << 5;
    /// An offset is set.
    pub(super) const OFFSET: u8 = 1 << 6;
    /// There are texts.
    pub(super) const TEXTS: u8 = 1 << 7;
}

const SAMPLES: [SampleType; 8] = [
    SampleType::U8,
    SampleType::I8,
    SampleType::U16,
    SampleType::I16,
    SampleType::U32,
    SampleType::I32,
    SampleType::F32,
    SampleType::F64,
];

/// The section's bytes.
pub(super) fn write(description: &Description) -> Vec<u8> {
    let mut out = vec![];
    let Description { width, height, tile_side, georeference, bands, metadata } = description;
    put_varint(&mut out, *width as u64);
    put_varint(&mut out, *height as u64);
    put_varint(&mut out, (tile_side / TILE_SIDE_STEP) as u64);
    put_varint(&mut out, bands.len() as u64);
    put_varint(&mut out, u64::from(TABLE_SET));
    let mut flags = 0;
    let alike = bands.len() > 1 && bands.iter().all(|band| numbers(band) == numbers(&bands[0]));
    let mut floats = vec![];
    if let Some(GeoTransform(t)) = georeference.transform {
        flags |= flag::TRANSFORM;
        floats.extend([t[0], t[1], t[3]]);
        // Bits are compared, so that -0.0 survives.
        if t[2].to_bits() != 0 || t[4].to_bits() != 0 {
            flags |= flag::ROTATED;
            floats.extend([t[2], t[4]]);
        }
        if t[5].to_bits() != (-t[1]).to_bits() {
            flags |= flag::NOT_SQUARE;
            floats.push(t[5]);
        }
    }
    floats.extend(georeference.epoch);
    for (set, bit) in [
        (georeference.crs.is_some(), flag::CRS),
        (georeference.epoch.is_some(), flag::EPOCH),
        (georeference.cells_are == CellMeaning::Point, flag::POINT),
        (!metadata.is_empty(), flag::METADATA),
        (alike, flag::ALIKE),
    ] {
        flags |= if set { bit } else { 0 };
    }
    out.push(flags);
    floats.into_iter().for_each(|float| put_float(&mut out, float));

    let mut texts: Vec<&str> = georeference.crs.as_deref().into_iter().collect();
    bands.iter().take(if alike { 1 } else { bands.len() }).for_each(|band| out.extend(numbers(band)));
    for band in bands.iter().filter(|band| has_texts(band)) {
        put_varint(&mut out, band.metadata.len() as u64);
        texts.extend([band.unit.as_str(), &band.description]);
        push_items(&mut texts, &band.metadata);
    }
    if !metadata.is_empty() {
        put_varint(&mut out, metadata.len() as u64);
        push_items(&mut texts, metadata);
    }
    out.extend(text::encode(&texts));
    out
}

/// What a band says beside its texts.
fn numbers(band: &Band) -> Vec<u8> {
    let BandRule { sample, nodata, bound } = band.rule;
    let mut flags = SAMPLES.iter().position(|&other| other == sample).unwrap_or_default() as u8;
    let mut out = vec![0];
    if let Some(bits) = nodata {
        flags |= band_flag::NODATA;
        out.extend(&bits.to_le_bytes()[..sample.bytes()]);
    }
    let bound = match bound {
        Bound::Lossless => None,
        Bound::MaxError(error) => Some(error),
    };
    for (float, bit) in
        [(bound, band_flag::MAX_ERROR), (band.scale, band_flag::SCALE), (band.offset, band_flag::OFFSET)]
    {
        if let Some(float) = float {
            flags |= bit;
            put_float(&mut out, float);
        }
    }
    out[0] = flags | if has_texts(band) { band_flag::TEXTS } else { 0 };
    out
}

fn has_texts(band: &Band) -> bool {
    !band.unit.is_empty() || !band.description.is_empty() || !band.metadata.is_empty()
}

fn push_items<'a>(texts: &mut Vec<&'a str>, items: &'a [MetadataItem]) {
    texts.extend(items.iter().flat_map(|item| [item.domain.as_str(), &item.key, &item.value]));
}

/// Reads the section of a file whose chunks take `chunk_bytes`.
pub(super) fn read(bytes: &[u8], chunk_bytes: u64) -> Result<Description> {
    let mut cursor = Cursor::new(bytes, "section META");
    let width = cursor.varint_in("the number of columns", 1, MAX_SIDE as u64)? as usize;
    let height = cursor.varint_in("the number of rows", 1, MAX_SIDE as u64)? as usize;
    let most = (MAX_TILE_SIDE / TILE_SIDE_STEP) as u64;
    let tile_side = cursor.varint_in("the tiles' side in steps", 1, most)? as usize * TILE_SIDE_STEP;
    let mut description = Description { tile_side, ..Description::new(width, height, vec![]) };
    let count = cursor.varint_in("the number of bands", 1, MAX_BANDS as u64)?;
    // Before anything grows with their number.
    let chunks = description.tiling().tiles().saturating_mul(count);
    if chunks > MAX_CHUNKS {
        return Err(cursor.corrupt(format!("{chunks} chunks: expected at most {MAX_CHUNKS}")));
    }
    index::check_count(chunks, chunk_bytes)?;
    let tables = cursor.varint()?;
    if tables != u64::from(TABLE_SET) {
        let message = format!("made with set {tables} of the tables, of which this program knows set {TABLE_SET}");
        return Err(Error::new(ErrorKind::Unsupported, message).at_place("section META"));
    }

    let flags = cursor.u8()?;
    let has = |bit: u8| flags & bit != 0;
    if !has(flag::TRANSFORM) && (has(flag::ROTATED) || has(flag::NOT_SQUARE)) {
        return Err(cursor.corrupt("terms of a geotransform that is not there"));
    }
    description.georeference = Georeference {
        transform: has(flag::TRANSFORM).then(|| read_transform(&mut cursor, flags)).transpose()?,
        crs: None,
        epoch: has(flag::EPOCH).then(|| cursor.float()).transpose()?,
        cells_are: if has(flag::POINT) { CellMeaning::Point } else { CellMeaning::Area },
    };
    let mut texts = vec![];
    while description.bands.len() < count as usize {
        let (band, has_texts) = read_numbers(&mut cursor)?;
        let repeats = if has(flag::ALIKE) { count as usize } else { 1 };
        description.bands.extend(std::iter::repeat_n(band, repeats));
        texts.extend(std::iter::repeat_n(has_texts, repeats));
    }
    let mut counts = vec![];
    for &has_texts in &texts {
        // Each item has three texts, each with the zero byte that ends it.
        let most = (MAX_TEXT / 3) as u64;
        counts.push(if has_texts { Some(cursor.varint_in("the number of metadata items", 0, most)?) } else { None });
    }
    let most = (MAX_TEXT / 3) as u64;
    let items = if has(flag::METADATA) { cursor.varint_in("the number of metadata items", 1, most)? } else { 0 };

    let mut reader = text::Decoder::new(cursor.rest());
    if has(flag::CRS) {
        description.georeference.crs = Some(reader.text()?);
    }
    for (band, count) in description.bands.iter_mut().zip(counts) {
        if let Some(count) = count {
            band.unit = reader.text()?;
            band.description = reader.text()?;
            band.metadata = read_items(&mut reader, count)?;
        }
    }
    description.metadata = read_items(&mut reader, items)?;
    reader.end()?;
    description.check().map_err(|error| Error::new(ErrorKind::Corrupt, error.to_string()).at_place("section META"))?;
    Ok(description)
}

fn read_transform(cursor: &mut Cursor, flags: u8) -> Result<GeoTransform> {
    let [x, width, y] = [cursor.float()?, cursor.float()?, cursor.float()?];
    let [x_by_row, y_by_col] = if flags & flag::ROTATED == 0 { [0.0; 2] } else { [cursor.float()?, cursor.float()?] };
    let height = if flags & flag::NOT_SQUARE == 0 { -width } else { cursor.float()? };
    Ok(GeoTransform([x, width, x_by_row, y, y_by_col, height]))
}

/// One band without its texts, and whether it has some.
fn read_numbers(cursor: &mut Cursor) -> Result<(Band, bool)> {
    let flags = cursor.u8()?;
    let float = |bit: u8, cursor: &mut Cursor| if flags & bit == 0 { Ok(None) } else { cursor.float().map(Some) };
    let sample = SAMPLES[usize::from(flags & band_flag::TYPE)];
    let nodata = if flags & band_flag::NODATA == 0 {
        None
    } else {
        let mut bits = [0; 8];
        bits[..sample.bytes()].copy_from_slice(cursor.take(sample.bytes())?);
        Some(u64::from_le_bytes(bits))
    };
    let bound = float(band_flag::MAX_ERROR, cursor)?.map_or(Bound::Lossless, Bound::MaxError);
    let scale = float(band_flag::SCALE, cursor)?;
    let offset = float(band_flag::OFFSET, cursor)?;
    let band = Band { rule: BandRule { sample, nodata, bound }, scale, offset, ..Band::new(sample) };
    Ok((band, flags & band_flag::TEXTS != 0))
}

fn read_items(texts: &mut text::Decoder, count: u64) -> Result<Vec<MetadataItem>> {
    // Not allocated at once: the count has earned nothing yet.
    let mut items = vec![];
    for _ in 0..count {
        items.push(MetadataItem { domain: texts.text()?, key: texts.text()?, value: texts.text()? });
    }
    Ok(items)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The specification explains these bytes.
    #[test]
    fn the_worked_example_holds() {
        let mut band = Band { unit: "m".into(), ..Band::new(SampleType::I16) };
        band.rule.nodata = Some(0x8000);
        let mut description = Description::new(2, 1, vec![band]);
        description.georeference.transform = Some(GeoTransform([500_000.0, 30.0, 0.0, 5_100_000.0, 0.0, -30.0]));
        let mut expected = vec![2, 1, 0x10, 1, 1, 1, 0x04, 0x80, 0x84, 0x1e, 0x41, 0x02, 0x3e, 0x40];
        expected.extend([0x04, 0x78, 0x74, 0x53, 0x41, 0x8b, 0x00, 0x80, 0x00, 0x1b, 0xe9]);
        assert_eq!(write(&description), expected);
        assert_eq!(read(&expected, 100).unwrap(), description);
        assert!(read(&expected, 4).is_err(), "a chunk has at least 5 bytes");
    }
}
