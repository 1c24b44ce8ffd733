//! What a container says of its raster: size, bands, where it lies, and what people wrote about it.

use super::block;
use super::tiling::Tiling;
use crate::codec::{BandRule, Bound, Cells, MAX_TILE_SIDE};
use crate::error::{Error, ErrorKind, Result};
use crate::grid::{GeoTransform, SampleType};

/// Greatest number of columns or rows.
pub const MAX_SIDE: usize = (1 << 31) - 1;
/// Greatest number of bands.
pub const MAX_BANDS: usize = 65_535;
/// Greatest number of chunks: tiles times bands.
pub const MAX_CHUNKS: u64 = 1 << 40;
/// Greatest length of all texts together, each with the zero byte that ends it.
pub const MAX_TEXT: usize = 16 << 20;
/// Sides of tiles are multiples of this, so that the coarsest level of a tile begins with each of its tiles' cells.
pub const TILE_SIDE_STEP: usize = 64;
/// The side of tiles unless another is asked for.
pub const DEFAULT_TILE_SIDE: usize = 1024;
/// Coarsest level that can be asked for; a greater raster than [`MAX_SIDE`] has none beyond.
pub const MAX_LEVEL: u8 = 31;

/// Everything that a container says of its raster beside the cells.
#[derive(Clone, Debug, PartialEq)]
pub struct Description {
    /// Columns.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Side of the square tiles, in cells: a multiple of 64 from 64 to 4096.
    pub tile_side: usize,
    /// Where the raster lies.
    pub georeference: Georeference,
    /// At least one.
    pub bands: Vec<Band>,
    /// Metadata of the whole, in order.
    pub metadata: Vec<MetadataItem>,
}

/// Where a raster lies on Earth or elsewhere.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Georeference {
    /// From pixel to CRS coordinates.
    pub transform: Option<GeoTransform>,
    /// The coordinate reference system as WKT2 (or whatever text the writer had).
    pub crs: Option<String>,
    /// Epoch of the coordinates in a dynamic CRS, as a decimal year.
    pub epoch: Option<f64>,
    /// What a cell's value stands for.
    pub cells_are: CellMeaning,
}

/// What a cell's value stands for. The geotransform speaks of corners in both cases, as GDAL's does.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum CellMeaning {
    /// The cell's area.
    #[default]
    Area,
    /// The point at its centre.
    Point,
}

/// One band.
#[derive(Clone, Debug, PartialEq)]
pub struct Band {
    /// Type, nodata value and guaranteed error: what the codec has to know.
    pub rule: BandRule,
    /// Factor of the stored values, where one is set.
    pub scale: Option<f64>,
    /// Offset of the scaled values, where one is set.
    pub offset: Option<f64>,
    /// Unit of the scaled values; empty when unknown.
    pub unit: String,
    /// What the band is; may be empty.
    pub description: String,
    /// Metadata of the band, in order.
    pub metadata: Vec<MetadataItem>,
}

/// One piece of metadata.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct MetadataItem {
    /// GDAL's metadata domain; empty for the default one.
    pub domain: String,
    /// Key; may be empty where the domain is one text, such as `xml:XMP`.
    pub key: String,
    /// Value.
    pub value: String,
}

impl Band {
    /// A band of a type, without nodata, lossless, with nothing else said about it.
    pub fn new(sample: SampleType) -> Self {
        Self {
            rule: BandRule { sample, nodata: None, bound: Bound::Lossless },
            scale: None,
            offset: None,
            unit: String::new(),
            description: String::new(),
            metadata: vec![],
        }
    }
}

impl Description {
    /// A raster without georeference or metadata, in tiles of the default side.
    pub fn new(width: usize, height: usize, bands: Vec<Band>) -> Self {
        Self {
            width,
            height,
            tile_side: DEFAULT_TILE_SIDE,
            georeference: Georeference::default(),
            bands,
            metadata: vec![],
        }
    }

    /// How the raster is cut into tiles.
    pub fn tiling(&self) -> Tiling {
        Tiling { width: self.width, height: self.height, side: self.tile_side }
    }

    /// Number of chunks: tiles times bands.
    pub fn chunks(&self) -> u64 {
        self.tiling().tiles() * self.bands.len() as u64
    }

    /// Columns and rows of a level.
    pub fn level_size(&self, level: u8) -> (usize, usize) {
        (self.width.div_ceil(1 << level), self.height.div_ceil(1 << level))
    }

    /// The geotransform of a level.
    ///
    /// A cell of level `k` is the sample of the cell at `(column * 2^k, row * 2^k)`, no average. Its pixel is `2^k`
    /// times as large, and placed so that its centre is the sample's: the origin moves by `(1 - 2^k) / 2` pixels.
    pub fn level_transform(&self, level: u8) -> Option<GeoTransform> {
        let step = f64::from(1_u32 << level);
        let shift = (1.0 - step) / 2.0;
        self.georeference.transform.map(|t| if level == 0 { t } else { t.window(shift, shift).scaled(step, step) })
    }

    /// The first level at which the raster is one cell, or [`MAX_LEVEL`].
    pub fn last_level(&self) -> u8 {
        (0..MAX_LEVEL).find(|&level| self.level_size(level) == (1, 1)).unwrap_or(MAX_LEVEL)
    }

    /// Whether the file gets a section OVER.
    pub(super) fn has_overview(&self) -> bool {
        self.tiling().tiles() > super::overview::MAX_TILES_WITHOUT
    }

    /// Looks whether a container can hold this.
    ///
    /// # Errors
    /// A usage error that names the field, what it is and what it may be.
    pub fn check(&self) -> Result<()> {
        for (name, side) in [("columns", self.width), ("rows", self.height)] {
            if side == 0 || side > MAX_SIDE {
                return Err(wrong(format!("{side} {name}: expected 1 to {MAX_SIDE}")));
            }
        }
        let step = TILE_SIDE_STEP;
        if !self.tile_side.is_multiple_of(step) || !(step..=MAX_TILE_SIDE).contains(&self.tile_side) {
            let side = self.tile_side;
            return Err(wrong(format!("tiles of {side} cells: expected a multiple of {step} up to {MAX_TILE_SIDE}")));
        }
        if self.bands.is_empty() || self.bands.len() > MAX_BANDS {
            return Err(wrong(format!("{} bands: expected 1 to {MAX_BANDS}", self.bands.len())));
        }
        // Cannot overflow: at most 2^50 tiles, and fewer than 2^14 of the remaining factors are left after this.
        if self.tiling().tiles() > MAX_CHUNKS / self.bands.len() as u64 {
            return Err(wrong(format!("more than {MAX_CHUNKS} tiles: take larger ones")));
        }
        for (number, band) in self.bands.iter().enumerate() {
            band.check().map_err(|error| error.at_place(format!("band {}", number + 1)))?;
        }
        if self.texts().any(|text| text.contains('\0')) {
            return Err(wrong("a text holds a zero byte".into()));
        }
        let text: usize = self.texts().map(|text| text.len() + 1).sum();
        if text > MAX_TEXT {
            return Err(wrong(format!("{text} bytes of metadata: expected at most {MAX_TEXT}")));
        }
        Ok(())
    }

    fn texts(&self) -> impl Iterator<Item = &str> {
        let of_bands = self.bands.iter().flat_map(|band| {
            [&band.unit, &band.description].into_iter().map(String::as_str).chain(texts_of(&band.metadata))
        });
        self.georeference.crs.as_deref().into_iter().chain(of_bands).chain(texts_of(&self.metadata))
    }
}

impl Band {
    /// So many cells without data: the nodata value, or 0 where there is none.
    pub fn voids(&self, count: usize) -> Cells {
        block::voids(self.rule.sample, self.rule.nodata, count)
    }

    fn check(&self) -> Result<()> {
        let bits = self.rule.sample.bytes() * 8;
        if let Some(nodata) = self.rule.nodata
            && bits < 64
            && nodata >> bits != 0
        {
            return Err(wrong(format!("the nodata value {nodata:#x} has more than {bits} bits")));
        }
        match self.rule.bound {
            Bound::MaxError(error) if !(error > 0.0 && error.is_finite()) => {
                Err(wrong(format!("a greatest error of {error}: expected a number above 0")))
            }
            _ => Ok(()),
        }
    }
}

fn texts_of(metadata: &[MetadataItem]) -> impl Iterator<Item = &str> {
    metadata.iter().flat_map(|item| [item.domain.as_str(), &item.key, &item.value])
}

fn wrong(message: String) -> Error {
    Error::new(ErrorKind::Usage, message)
}
