//! Rasters and files for the tests.

use orograph::codec::{BandRule, Bound, Cells};
use orograph::error::Result;
use orograph::grid::{GeoTransform, SampleType};
use orograph::oro::{Band, CellMeaning, Description, MetadataItem, RangeRead, Summary, Writer, encode_chunk};
use std::sync::Mutex;

pub const SAMPLES: [SampleType; 8] = [
    SampleType::U8,
    SampleType::I8,
    SampleType::U16,
    SampleType::I16,
    SampleType::U32,
    SampleType::I32,
    SampleType::F32,
    SampleType::F64,
];

/// A raster in memory: what it is, and all cells of each band.
#[derive(Clone, Debug)]
pub struct Case {
    pub description: Description,
    pub bands: Vec<Cells>,
}

/// Numbers that look random and are the same each time.
pub fn noise(seed: u64) -> impl Iterator<Item = u64> {
    let mut state = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1;
    std::iter::repeat_with(move || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        state.wrapping_mul(0x2545_f491_4f6c_dd1d)
    })
}

/// Cells of any bits: NaN and infinities too.
pub fn cells(sample: SampleType, count: usize, seed: u64) -> Cells {
    let bytes: Vec<u8> = noise(seed).flat_map(u64::to_le_bytes).take(count * sample.bytes()).collect();
    Cells::from_le_bytes(sample, &bytes).expect("a whole number of cells")
}

impl Case {
    pub fn new(width: usize, height: usize, tile_side: usize, samples: &[SampleType]) -> Self {
        let bands = samples.iter().map(|&sample| Band::new(sample)).collect();
        let description = Description { tile_side, ..Description::new(width, height, bands) };
        let cells = |(seed, &sample)| cells(sample, width * height, seed as u64 + 1);
        Self { bands: samples.iter().enumerate().map(cells).collect(), description }
    }

    /// A case that says something in every field.
    pub fn talkative() -> Self {
        let mut case = Self::new(70, 3, 64, &[SampleType::I16, SampleType::F32]);
        let Description { georeference, bands, metadata, .. } = &mut case.description;
        georeference.transform = Some(GeoTransform([7.999_583, 1.0 / 1200.0, -0.0, 47.0, 1e-9, -1.0 / 1200.0]));
        georeference.crs = Some("LOCAL_CS[\"Grüße\"]".into());
        georeference.epoch = Some(2021.5);
        georeference.cells_are = CellMeaning::Point;
        let item = |key: &str, value: &str| MetadataItem {
            domain: "RPC\nand more".into(),
            key: key.into(),
            value: value.into(),
        };
        *metadata = vec![item("b", "2"), item("a", ""), item("b", "again"), item("", "<xml/>")];
        bands[0].rule.nodata = Some((-9999_i16) as u16 as u64);
        bands[0].scale = Some(0.1);
        bands[0].offset = Some(-100.25);
        bands[0].unit = "m".into();
        bands[1] = Band {
            rule: BandRule { sample: SampleType::F32, nodata: Some(0x7fc0_1234), bound: Bound::MaxError(0.05) },
            description: "canopy".into(),
            metadata: vec![item("x", "y")],
            ..bands[1].clone()
        };
        case
    }

    /// The cells of a rectangle.
    pub fn cut(&self, band: usize, col: usize, row: usize, width: usize, height: usize) -> Cells {
        cut(&self.bands[band], self.description.width, col, row, width, height)
    }

    /// The file and its summary.
    pub fn write(&self) -> (Vec<u8>, Summary) {
        let mut writer = Writer::new(vec![], self.description.clone()).expect("the description is sound");
        let (tiling, bands) = (self.description.tiling(), self.bands.len());
        for chunk in 0..self.description.chunks() {
            let place = tiling.place(chunk, bands);
            let shape = tiling.shape(place.col, place.row);
            let side = tiling.side;
            let cells = self.cut(place.band, place.col * side, place.row * side, shape.width, shape.height);
            writer.push(&encode_chunk(&self.description, place, &cells).expect("encodes")).expect("is written");
        }
        writer.finish().expect("is written")
    }
}

pub fn cut(cells: &Cells, raster_width: usize, col: usize, row: usize, width: usize, height: usize) -> Cells {
    let size = cells.sample().bytes();
    let bytes = cells.to_le_bytes();
    let rows = bytes.chunks(raster_width * size).skip(row).take(height);
    let bytes: Vec<u8> = rows.flat_map(|row| &row[col * size..(col + width) * size]).copied().collect();
    Cells::from_le_bytes(cells.sample(), &bytes).expect("a whole number of cells")
}

/// Cells compared by their bits: NaN equals itself.
#[track_caller]
pub fn assert_same(a: &Cells, b: &Cells, what: &str) {
    assert_eq!(a.sample(), b.sample(), "{what}: type");
    assert!(a.to_le_bytes() == b.to_le_bytes(), "{what}: {} and {} cells differ", a.len(), b.len());
}

/// Notes every request.
#[derive(Debug)]
pub struct Counted {
    pub bytes: Vec<u8>,
    pub requests: Mutex<Vec<(u64, usize)>>,
}

impl Counted {
    pub fn new(bytes: Vec<u8>) -> Self {
        Self { bytes, requests: Mutex::default() }
    }

    /// The requests since the last time.
    pub fn take(&self) -> Vec<(u64, usize)> {
        std::mem::take(&mut self.requests.lock().expect("no panic before"))
    }
}

impl RangeRead for Counted {
    fn len(&self) -> Result<u64> {
        RangeRead::len(&self.bytes)
    }

    fn read_at(&self, offset: u64, length: usize) -> Result<Vec<u8>> {
        self.requests.lock().expect("no panic before").push((offset, length));
        self.bytes.read_at(offset, length)
    }
}
