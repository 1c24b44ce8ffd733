//! Everything that a file says of a raster, beside the cells.

use crate::grid::{GeoTransform, SampleType};

/// What is known of a raster.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Record {
    /// Columns.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// At least one.
    pub bands: Vec<BandRecord>,
    /// From pixel to CRS coordinates, where the file says so.
    pub transform: Option<GeoTransform>,
    /// The CRS as WKT2:2019.
    pub crs: Option<String>,
    /// Epoch of the coordinates, as a decimal year.
    pub epoch: Option<f64>,
    /// Whether a value stands for the point at its cell's centre, not for the cell's area.
    pub is_point: bool,
    /// Metadata of the whole.
    pub metadata: Vec<Item>,
}

/// What is known of a band.
#[derive(Clone, Debug, PartialEq)]
pub struct BandRecord {
    /// Type of the cells.
    pub sample: SampleType,
    /// Value of the cells without data, as the bits of the type (little-endian, zero-extended).
    pub nodata: Option<u64>,
    /// Factor of the stored values, where one is set.
    pub scale: Option<f64>,
    /// Offset of the scaled values, where one is set.
    pub offset: Option<f64>,
    /// Unit of the scaled values; empty where none is set.
    pub unit: String,
    /// What the band is; empty where nothing is said.
    pub description: String,
    /// Metadata of the band.
    pub metadata: Vec<Item>,
}

/// A piece of metadata.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Item {
    /// Domain; empty for the default one.
    pub domain: String,
    /// Key; empty where the whole domain is one text, such as `xml:XMP`.
    pub key: String,
    /// Value.
    pub value: String,
}

impl BandRecord {
    /// A band of a type of which nothing else is known.
    pub fn new(sample: SampleType) -> Self {
        Self {
            sample,
            nodata: None,
            scale: None,
            offset: None,
            unit: String::new(),
            description: String::new(),
            metadata: Vec::new(),
        }
    }

    /// The nodata value as a number.
    pub fn nodata_value(&self) -> Option<f64> {
        self.nodata.map(|bits| self.sample.value_of_bits(bits))
    }
}
