//! What a container holds, in words and as JSON: shared by the verbs that write and show one.

use crate::codec::Bound;
use crate::oro::{Band, Description};
use serde_json::{Value, json};
use std::fmt::Write;

/// An amount of bytes for people.
pub(super) fn size_text(bytes: u64) -> String {
    let scaled = |power: u32| bytes as f64 / f64::from(1_u32 << power);
    match bytes {
        0..10_000 => format!("{bytes} bytes"),
        10_000..10_000_000 => format!("{:.1} KiB", scaled(10)),
        10_000_000..10_000_000_000 => format!("{:.1} MiB", scaled(20)),
        _ => format!("{:.2} GiB", scaled(30)),
    }
}

/// A line for each band: type, unit, and how exact it is; equal ones are told once.
pub(super) fn band_lines(description: &Description, largest_errors: Option<&[f64]>) -> String {
    let mut lines: Vec<(usize, String)> = Vec::new();
    let count = description.bands.len();
    for (i, band) in description.bands.iter().enumerate() {
        let line = band_line(band, largest_errors.and_then(|errors| errors.get(i).copied()));
        lines.push((i + 1, line));
    }
    let mut text = String::new();
    for group in lines.chunk_by(|a, b| a.1 == b.1) {
        let (first, last) = (group[0].0, group[group.len() - 1].0);
        let _ = match (count, first == last) {
            (1, _) => writeln!(text, "{}", group[0].1),
            (_, true) => writeln!(text, "band {first}: {}", group[0].1),
            (_, false) => writeln!(text, "bands {first} to {last}: {}", group[0].1),
        };
    }
    text
}

fn band_line(band: &Band, largest_error: Option<f64>) -> String {
    let mut text = band.rule.sample.name().to_string();
    if let Some(nodata) = nodata_of(band) {
        let _ = write!(text, ", nodata {nodata}");
    }
    match band.rule.bound {
        Bound::Lossless => text += ", lossless",
        Bound::MaxError(error) => {
            let _ = write!(text, ", greatest error {}", error_text(band, error));
            if let Some(found) = largest_error {
                let _ = write!(text, " (found: {})", error_text(band, found));
            }
        }
    }
    text
}

/// An error in stored values, in the band's unit.
fn error_text(band: &Band, stored: f64) -> String {
    let value = scaled(band, stored);
    // Enough digits to see that a bound is kept, without those of binary fractions.
    let digits = format!("{value:.6}");
    let digits = digits.trim_end_matches('0').trim_end_matches('.');
    let digits = if value != 0.0 && digits == "0" { format!("{value:e}") } else { digits.to_string() };
    match band.unit.as_str() {
        "" => digits,
        unit => format!("{digits} {unit}"),
    }
}

fn scaled(band: &Band, stored: f64) -> f64 {
    stored * band.scale.unwrap_or(1.0).abs()
}

fn nodata_of(band: &Band) -> Option<f64> {
    band.rule.nodata.map(|bits| band.rule.sample.value_of_bits(bits))
}

/// The bands for a JSON document.
pub(super) fn bands_json(description: &Description, largest_errors: Option<&[f64]>) -> Vec<Value> {
    let band = |(i, band): (usize, &Band)| {
        let bound = match band.rule.bound {
            Bound::Lossless => None,
            Bound::MaxError(error) => Some(error),
        };
        let mut value = json!({
            "type": band.rule.sample.name(),
            "nodata": nodata_of(band).map(number),
            "scale": band.scale,
            "offset": band.offset,
            "unit": band.unit,
            "description": band.description,
            "lossless": bound.is_none(),
            "max_error_stored": bound,
            "max_error": bound.map(|error| scaled(band, error)),
        });
        if let Some(errors) = largest_errors {
            value["largest_error"] = json!(errors.get(i).map(|&error| scaled(band, error)));
        }
        value
    };
    description.bands.iter().enumerate().map(band).collect()
}

/// A number that may be none in JSON.
pub(super) fn number(value: f64) -> Value {
    if value.is_finite() { json!(value) } else { json!(value.to_string().to_lowercase()) }
}
