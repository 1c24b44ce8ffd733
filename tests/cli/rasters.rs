//! Rasters that tests make, and what a file holds of one: every bit of the cells, and all that is said of them.

use gdal::raster::{Buffer, GdalType, RasterCreationOptions};
use gdal::spatial_ref::{AxisMappingStrategy, SpatialRef};
use gdal::{Dataset, DriverManager, Metadata};
use std::collections::BTreeMap;

/// A raster to be written as GeoTIFF.
pub(super) struct Raster<T> {
    pub(super) size: (usize, usize),
    /// Cells of each band.
    pub(super) bands: Vec<Vec<T>>,
    pub(super) nodata: Option<f64>,
    pub(super) transform: Option<[f64; 6]>,
    pub(super) crs: Option<&'static str>,
    pub(super) options: &'static [(&'static str, &'static str)],
    /// Sets what is left to set.
    pub(super) more: fn(&mut Dataset),
}

impl<T> Raster<T> {
    pub(super) fn new(size: (usize, usize), bands: Vec<Vec<T>>) -> Self {
        let transform = Some([500_000.0, 30.0, 0.0, 5_200_000.0, 0.0, -30.0]);
        Self { size, bands, nodata: None, transform, crs: Some("EPSG:32632"), options: &[], more: |_| {} }
    }
}

impl<T: GdalType + Copy> Raster<T> {
    pub(super) fn write(&self, path: &str) {
        let driver = DriverManager::get_driver_by_name("GTiff").expect("GDAL writes GeoTIFF");
        let mut options = RasterCreationOptions::new();
        for (key, value) in self.options {
            options.add_name_value(key, value).expect("an option");
        }
        let (cols, rows) = self.size;
        let mut dataset = driver
            .create_with_band_type_with_options::<T, _>(path, cols, rows, self.bands.len(), &options)
            .expect("a file");
        if let Some(crs) = self.crs {
            let mut srs = SpatialRef::from_definition(crs).expect("a CRS");
            srs.set_axis_mapping_strategy(AxisMappingStrategy::TraditionalGisOrder);
            dataset.set_spatial_ref(&srs).expect("a CRS");
        }
        if let Some(transform) = self.transform {
            dataset.set_geo_transform(&transform).expect("a geotransform");
        }
        for number in 1..=self.bands.len() {
            dataset.rasterband(number).expect("a band").set_no_data_value(self.nodata).ok();
        }
        (self.more)(&mut dataset);
        for (number, cells) in (1..).zip(&self.bands) {
            let mut band = dataset.rasterband(number).expect("a band");
            band.write((0, 0), self.size, &mut Buffer::new(self.size, cells.clone())).expect("cells");
        }
        dataset.close().expect("written");
    }
}

/// Slopes and noise, from 0 to 1.
pub(super) fn terrain(cols: usize, rows: usize) -> Vec<f64> {
    let mut state = 7_u32;
    let mut noise = || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        f64::from(state >> 8) / f64::from(1 << 24)
    };
    let cell = |i: usize| {
        let (x, y) = ((i % cols) as f64 / 37.0, (i / cols) as f64 / 29.0);
        0.5 + 0.3 * (x.sin() * y.cos()) + 0.1 * ((3.1 * x + y).sin()) + 0.02 * noise()
    };
    (0..cols * rows).map(cell).collect()
}

/// What a file says of a band, and the bits of its cells.
#[derive(Debug, PartialEq)]
pub(super) struct BandFacts {
    pub(super) kind: String,
    pub(super) bits: Vec<u64>,
    pub(super) nodata: Option<u64>,
    pub(super) scale: Option<f64>,
    pub(super) offset: Option<f64>,
    pub(super) unit: String,
    pub(super) description: String,
    pub(super) metadata: BTreeMap<String, Vec<String>>,
}

/// What a file says of a raster.
#[derive(Debug, PartialEq)]
pub(super) struct Facts {
    pub(super) size: (usize, usize),
    pub(super) transform: Option<[u64; 6]>,
    pub(super) crs: Option<String>,
    pub(super) metadata: BTreeMap<String, Vec<String>>,
    pub(super) bands: Vec<BandFacts>,
}

/// Reads a file through GDAL.
pub(super) fn facts(path: &str) -> Facts {
    orograph::io::messages::quiet();
    let dataset = Dataset::open(path).unwrap_or_else(|error| panic!("{path}: {error}"));
    let band = |number: usize| {
        let band = dataset.rasterband(number).expect("a band");
        let (kind, size) = (band.band_type().name(), dataset.raster_size());
        macro_rules! bits {
            ($($name:literal => $t:ty, $bits:expr);*) => {
                match kind.as_str() {
                    $($name => {
                        let cells = band.read_as::<$t>((0, 0), size, size, None).expect("cells");
                        cells.data().iter().map(|&cell| $bits(cell)).collect()
                    })*
                    other => panic!("{other} cells"),
                }
            };
        }
        // Integers as they sort: two files are compared, not a file with numbers.
        let bits: Vec<u64> = bits!(
            "Byte" => u8, u64::from; "UInt16" => u16, u64::from; "Int16" => i16, |v| v as u64;
            "UInt32" => u32, u64::from; "Int32" => i32, |v| v as u64;
            "Float32" => f32, |v: f32| u64::from(v.to_bits()); "Float64" => f64, f64::to_bits);
        BandFacts {
            kind,
            bits,
            nodata: band.no_data_value().map(f64::to_bits),
            scale: band.scale(),
            offset: band.offset(),
            unit: band.unit(),
            description: band.description().unwrap_or_default(),
            metadata: domains(&band),
        }
    };
    Facts {
        size: dataset.raster_size(),
        transform: dataset.geo_transform().ok().map(|transform| transform.map(f64::to_bits)),
        crs: dataset.spatial_ref().ok().map(|srs| srs.to_wkt().expect("WKT")),
        metadata: domains(&dataset),
        bands: (1..=dataset.raster_count()).map(band).collect(),
    }
}

/// Metadata without what describes the file.
fn domains(object: &impl Metadata) -> BTreeMap<String, Vec<String>> {
    let mut found = BTreeMap::new();
    for domain in object.metadata_domains() {
        if !["IMAGE_STRUCTURE", "DERIVED_SUBDATASETS"].contains(&domain.as_str()) {
            let mut items = object.metadata_domain(&domain).unwrap_or_default();
            items.sort();
            if !items.is_empty() {
                found.insert(domain, items);
            }
        }
    }
    found
}
