//! What is promised of each cell: the bits, or an error that is never exceeded.

use crate::codec::Bound;
use crate::error::{Error, Result};
use crate::io::raster::parse_crs;
use crate::io::raster::stored::{BandRecord, Record};
use crate::units::LengthUnit;

/// What a user wants of the cells.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Promise {
    /// Nothing was said: lossless for integers, a question for floats.
    Unsaid,
    /// All bits.
    Lossless,
    /// At most so far from the original.
    MaxError {
        /// The number as it was written.
        number: f64,
        /// The length in metres; `None` where it was a bare number.
        metres: Option<f64>,
    },
}

/// How close to a whole number of steps an error is taken to be that number: 0.3 m of 0.1 m each are three.
const NEARLY: f64 = 1e-9;

impl Promise {
    /// The bound of each band in stored values.
    ///
    /// # Errors
    /// A usage error for floats of which nothing was said, for errors that are no positive numbers, and for a length
    /// where a band's unit is none.
    pub(super) fn bounds(
        self,
        record: &Record,
        unit: Option<&LengthUnit>,
        note: &mut dyn FnMut(String),
    ) -> Result<Vec<Bound>> {
        let vertical = record.crs.as_deref().and_then(|wkt| parse_crs(wkt).ok()).and_then(|crs| crs.vertical_unit);
        (1..)
            .zip(&record.bands)
            .map(|(number, band)| {
                self.bound(band, unit, vertical.as_deref(), note)
                    .map_err(|error| error.at_place(format!("band {number}")))
            })
            .collect()
    }

    fn bound(
        self,
        band: &BandRecord,
        unit: Option<&LengthUnit>,
        vertical: Option<&str>,
        note: &mut dyn FnMut(String),
    ) -> Result<Bound> {
        let name = band.sample.name();
        let (number, metres) = match self {
            Self::Lossless => return Ok(Bound::Lossless),
            Self::Unsaid if !band.sample.is_float() => return Ok(Bound::Lossless),
            Self::Unsaid => {
                return Err(Error::usage(format!(
                    "its cells are {name}: say --max-error 0.1m for the error that you can do with, or --lossless for every bit (noise included, which takes most of the room)"
                )));
            }
            Self::MaxError { number, metres } => (number, metres),
        };
        if !(number > 0.0 && number.is_finite()) {
            return Err(Error::usage(format!(
                "--max-error {number}: expected more than 0; --lossless keeps every bit"
            )));
        }
        let scale = band.scale.unwrap_or(1.0).abs();
        let scale = if scale > 0.0 && scale.is_finite() { scale } else { 1.0 };
        let stored = match (unit_m(band, unit, vertical), metres) {
            // A bare number is metres where the band has lengths, and the band's own unit where it has not.
            (Some(unit_m), _) => metres.unwrap_or(number) / unit_m / scale,
            (None, None) => number / scale,
            (None, Some(_)) => {
                return Err(Error::usage(format!(
                    "--max-error is a length, and the band's unit '{}' is none: give a bare number, which is in that unit",
                    band.unit
                )));
            }
        };
        if band.sample.is_float() {
            return Ok(Bound::MaxError(stored));
        }
        let near = stored.round();
        let steps = if (stored - near).abs() <= NEARLY * stored { near } else { stored.floor() };
        if steps < 1.0 {
            note(format!("the greatest error is less than one step of {name} and its scale: lossless"));
            return Ok(Bound::Lossless);
        }
        Ok(Bound::MaxError(steps))
    }
}

/// Metres in one unit of a band's scaled values; `None` where these are no lengths.
pub(super) fn unit_m(band: &BandRecord, unit: Option<&LengthUnit>, vertical: Option<&str>) -> Option<f64> {
    let stated = band.unit.trim();
    match (unit, vertical) {
        (Some(unit), _) => Some(unit.metres),
        (None, _) if !stated.is_empty() => LengthUnit::from_name(stated).map(|unit| unit.metres),
        (None, Some(name)) => LengthUnit::from_name(name).map(|unit| unit.metres),
        (None, None) => Some(1.0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::SampleType;

    fn bound(promise: Promise, band: BandRecord) -> std::result::Result<Bound, String> {
        let record = Record { width: 1, height: 1, bands: vec![band], ..Record::default() };
        promise.bounds(&record, None, &mut |_| {}).map(|bounds| bounds[0]).map_err(|error| error.to_string())
    }

    fn metres(metres: f64) -> Promise {
        Promise::MaxError { number: metres, metres: Some(metres) }
    }

    #[test]
    fn metres_become_stored_values() {
        let plain = |sample| BandRecord::new(sample);
        let unit = |unit: &str| BandRecord { unit: unit.into(), ..plain(SampleType::F32) };
        let scaled = |scale| BandRecord { scale: Some(scale), ..plain(SampleType::I16) };
        assert_eq!(bound(metres(0.5), plain(SampleType::F32)), Ok(Bound::MaxError(0.5)));
        assert_eq!(bound(metres(0.3048), unit("ft")), Ok(Bound::MaxError(1.0)));
        assert_eq!(bound(metres(2.7), plain(SampleType::I16)), Ok(Bound::MaxError(2.0)));
        assert_eq!(bound(metres(0.3), scaled(0.1)), Ok(Bound::MaxError(3.0)), "three steps but for rounding");
        assert_eq!(bound(metres(0.3), scaled(-0.1)), Ok(Bound::MaxError(3.0)));
        assert_eq!(bound(metres(0.5), plain(SampleType::I16)), Ok(Bound::Lossless));
        let bare = Promise::MaxError { number: 2.0, metres: None };
        assert_eq!(bound(bare, unit("degree")), Ok(Bound::MaxError(2.0)));
        assert_eq!(bound(bare, unit("ft")), Ok(Bound::MaxError(2.0 / 0.3048)));
        assert!(bound(metres(2.0), unit("degree")).is_err_and(|error| error.contains("'degree' is none")));
    }

    #[test]
    fn floats_ask() {
        assert_eq!(bound(Promise::Unsaid, BandRecord::new(SampleType::I32)), Ok(Bound::Lossless));
        assert!(bound(Promise::Unsaid, BandRecord::new(SampleType::F64)).is_err_and(|e| e.contains("--lossless")));
        assert_eq!(bound(Promise::Lossless, BandRecord::new(SampleType::F64)), Ok(Bound::Lossless));
        for wrong in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert!(bound(metres(wrong), BandRecord::new(SampleType::F64)).is_err(), "{wrong}");
        }
    }
}
