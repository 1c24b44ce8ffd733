//! Hand-drawn maps: greys that stand for elevations.

use crate::codec::Cells;
use crate::error::{Error, ErrorKind, Result};
use crate::grid::{GeoTransform, SampleType};
use crate::io::raster::stored::{Record, StoredOptions};
use crate::pipeline::archive::Input;
use std::path::Path;

/// Cells that are looked at together.
const PART: usize = 1 << 22;
/// What is to be done with colours.
const REMEDY: &str = "draw in greys, or choose one band with --band after gdal_translate -expand rgb";

/// What greys stand for.
#[derive(Clone, Debug)]
pub(super) struct Greys {
    black_m: f64,
    /// Metres from one grey to the next.
    step_m: f64,
    /// The grey of each entry of the palette, where cells are its numbers; nothing for entries that nobody sees.
    palette: Option<Vec<Option<u8>>>,
}

impl Greys {
    /// The elevation that a cell stands for; nothing where its palette has none.
    pub(super) fn elevation_m(&self, cell: f64) -> Option<f64> {
        let grey = match &self.palette {
            Some(palette) => f64::from(palette.get(cell as usize).copied().flatten()?),
            None => cell,
        };
        Some(grey * self.step_m + self.black_m)
    }
}

/// Opens a sketch, of which black and white stand for elevations in metres: what is read, and what is said of its one
/// band. Where the file does not say where it lies, the options' box is its place, and else what is read of it.
///
/// # Errors
/// When it cannot be opened; cells of other than 8 or 16 bits, colours, and a place that is not known.
pub(super) fn open(path: &Path, options: &StoredOptions, heights_m: [f64; 2]) -> Result<(Input, Record, Greys)> {
    let whole = StoredOptions { bbox: None, ..options.clone() };
    let mut input = Input::open(path, &whole)?;
    let mut record = input.record().clone();
    match (record.transform, options.bbox) {
        (Some(_), Some(_)) => {
            input = Input::open(path, options)?;
            record = input.record().clone();
        }
        (Some(_), None) => {}
        (None, Some([left, bottom, right, top])) => {
            let (wide, high) = (right - left, top - bottom);
            if !(wide > 0.0 && high > 0.0 && wide.is_finite() && high.is_finite()) {
                let message = format!("--bbox {left},{bottom},{right},{top}: expected xmin,ymin,xmax,ymax");
                return Err(Error::usage(message));
            }
            let (cols, rows) = (record.width as f64, record.height as f64);
            record.transform = Some(GeoTransform([left, wide / cols, 0.0, top, 0.0, -high / rows]));
        }
        (None, None) => {
            let message = "the sketch does not say where it lies: say it with --bbox xmin,ymin,xmax,ymax and --crs";
            return Err(Error::usage(message).at_path(path));
        }
    }
    let white = match record.bands.first().map(|band| band.sample) {
        Some(SampleType::U8) => f64::from(u8::MAX),
        Some(SampleType::U16) => f64::from(u16::MAX),
        other => {
            let kind = other.map_or("nothing", SampleType::name);
            let message = format!("a sketch has greys of 8 or 16 bits, and this is {kind}; leave --sketch away");
            return Err(Error::usage(message).at_path(path));
        }
    };
    for band in &mut record.bands {
        (band.unit, band.scale, band.offset) = ("m".into(), None, None);
    }
    // Grey as a picture has it: red, green and blue.
    if record.bands.len() == 3 {
        expect_equal(&input, &record).map_err(|error| error.at_path(path))?;
        record.bands.truncate(1);
    }
    let palette = match &input {
        Input::Stored(source) => source.palette(0).map(greys_of).transpose().map_err(|error| error.at_path(path))?,
        Input::Container(_) => None,
    };
    let white = if palette.is_some() { f64::from(u8::MAX) } else { white };
    let [black_m, white_m] = heights_m;
    Ok((input, record, Greys { black_m, step_m: (white_m - black_m) / white, palette }))
}

/// The greys of a palette of red, green, blue and opacity; nothing for what is transparent.
///
/// # Errors
/// When one is a colour.
fn greys_of(palette: &[[u8; 4]]) -> Result<Vec<Option<u8>>> {
    let grey = |(number, &[red, green, blue, opacity]): (usize, &[u8; 4])| match (
        red == green && green == blue,
        opacity,
    ) {
        (_, 0) => Ok(None),
        (true, _) => Ok(Some(red)),
        (false, _) => {
            let message = format!(
                "colour {number} of its palette is red {red}, green {green}, blue {blue}, and a sketch is of greys; {REMEDY}"
            );
            Err(Error::new(ErrorKind::Unsupported, message))
        }
    };
    palette.iter().enumerate().map(grey).collect()
}

/// Looks whether three bands are the same, in all cells.
///
/// # Errors
/// When they are not, with the first cell, or cannot be read.
fn expect_equal(input: &Input, record: &Record) -> Result<()> {
    let high = (PART / record.width.max(1)).max(1);
    for row in (0..record.height).step_by(high) {
        let rows = high.min(record.height - row);
        let mut bands = vec![];
        for band in 0..record.bands.len() {
            bands.push(match input.read(band, [0, row, record.width, rows])? {
                Cells::U8(cells) => cells.into_iter().map(u16::from).collect(),
                Cells::U16(cells) => cells,
                other => {
                    let kind = other.sample().name();
                    let message = format!("band {} is of {kind}, and not of 8 or 16 bits as greys are", band + 1);
                    return Err(Error::new(ErrorKind::Unsupported, message));
                }
            });
        }
        let differs = |&cell: &usize| bands.iter().any(|band| band[cell] != bands[0][cell]);
        if let Some(cell) = (0..rows * record.width).find(differs) {
            let colours: Vec<String> = bands.iter().map(|band| band[cell].to_string()).collect();
            let message = format!(
                "its three bands differ: {}, and a sketch is of greys; choose one with --band, or draw in greys",
                colours.join(", ")
            );
            let place = format!("row {}, column {}", row + cell / record.width, cell % record.width);
            return Err(Error::new(ErrorKind::Unsupported, message).at_place(place));
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn grey_palettes_only() {
        let palette = [[0, 0, 0, 255], [200, 200, 200, 255], [9, 8, 7, 0], [255, 255, 255, 100]];
        let greys = greys_of(&palette).unwrap();
        assert_eq!(greys, [Some(0), Some(200), None, Some(255)]);
        let greys = Greys { black_m: 100.0, step_m: 2.0, palette: Some(greys) };
        let found = [0.0, 1.0, 2.0, 3.0, 4.0].map(|cell| greys.elevation_m(cell));
        assert_eq!(found, [Some(100.0), Some(500.0), None, Some(610.0), None]);
        let plain = Greys { palette: None, ..greys };
        assert_eq!(plain.elevation_m(4.0), Some(108.0));
        let error = greys_of(&[[1, 1, 1, 255], [3, 4, 3, 255]]).unwrap_err();
        assert!(error.message().starts_with("colour 1 of its palette is red 3, green 4, blue 3"), "{error}");
    }
}
