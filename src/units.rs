//! Lengths as users write them, and the units that elevations come in.

use crate::error::{Error, Result};

/// Metres in an international foot.
pub const FOOT_M: f64 = 0.3048;
/// Metres in a US survey foot.
pub const US_SURVEY_FOOT_M: f64 = 1200.0 / 3937.0;

/// A unit of length with the metres it stands for.
#[derive(Clone, Debug, PartialEq)]
pub struct LengthUnit {
    /// Name as found or given, for messages and metadata.
    pub name: String,
    /// Metres in one unit; positive and finite.
    pub metres: f64,
}

impl LengthUnit {
    /// The metre.
    pub fn metre() -> Self {
        Self { name: "m".into(), metres: 1.0 }
    }

    /// The unit that `name` stands for in band metadata, CRS definitions and options, or `None`.
    ///
    /// Case, spaces, dots, dashes and underscores do not matter.
    pub fn from_name(name: &str) -> Option<Self> {
        let plain: String =
            name.chars().filter(|c| !matches!(c, ' ' | '.' | '-' | '_')).flat_map(char::to_lowercase).collect();
        let metres = match plain.as_str() {
            "m" | "metre" | "metres" | "meter" | "meters" | "mtr" => 1.0,
            "dm" | "decimetre" | "decimeter" | "decimetres" | "decimeters" => 0.1,
            "cm" | "centimetre" | "centimeter" | "centimetres" | "centimeters" => 0.01,
            "mm" | "millimetre" | "millimeter" | "millimetres" | "millimeters" => 0.001,
            "km" | "kilometre" | "kilometer" | "kilometres" | "kilometers" => 1000.0,
            "ft" | "foot" | "feet" | "internationalfoot" | "intlfoot" | "footinternational" => FOOT_M,
            "usft" | "ftus" | "ussurveyfoot" | "ussurveyfeet" | "footus" | "usfoot" | "usfeet" | "surveyfoot" => {
                US_SURVEY_FOOT_M
            }
            "yd" | "yard" | "yards" => 0.9144,
            "mi" | "mile" | "miles" => 1609.344,
            "fathom" | "fathoms" => 1.8288,
            _ => return None,
        };
        Some(Self { name: name.trim().to_string(), metres })
    }
}

/// Reads a length such as `30m`, `100ft`, `1.5km`; a bare number is metres.
///
/// # Errors
/// A usage error that says what was expected, for anything that is not a finite number and a known unit.
pub fn parse_length_m(text: &str) -> Result<f64> {
    let text = text.trim();
    let digits = text
        .char_indices()
        .find(|&(i, c)| {
            c.is_ascii_alphabetic()
                && !((c == 'e' || c == 'E')
                    && text[i + 1..].starts_with(|n: char| n.is_ascii_digit() || n == '-' || n == '+'))
        })
        .map_or(text.len(), |(i, _)| i);
    let (number, unit) = (text[..digits].trim(), text[digits..].trim());
    let wrong = || {
        Error::usage(format!(
            "'{text}' is not a length: expected a number with an optional unit, such as 30m, 100ft or 1.5km"
        ))
    };
    let value: f64 = number.parse().map_err(|_| wrong())?;
    let metres = if unit.is_empty() { 1.0 } else { LengthUnit::from_name(unit).ok_or_else(wrong)?.metres };
    let length = value * metres;
    if length.is_finite() { Ok(length) } else { Err(wrong()) }
}

/// Reads an amount of memory such as `2G`, `800M`, `1.5GiB`; a bare number is bytes.
///
/// Powers of 1024 throughout, as `ls -h` and GDAL's `GDAL_CACHEMAX` count.
///
/// # Errors
/// A usage error for anything else.
pub fn parse_memory(text: &str) -> Result<u64> {
    let plain = text.trim().to_ascii_lowercase();
    let plain = plain.trim_end_matches("ib").trim_end_matches('b');
    let (number, power) = match plain.chars().last() {
        Some('k') => (&plain[..plain.len() - 1], 10),
        Some('m') => (&plain[..plain.len() - 1], 20),
        Some('g') => (&plain[..plain.len() - 1], 30),
        Some('t') => (&plain[..plain.len() - 1], 40),
        _ => (plain, 0),
    };
    match number.trim().parse::<f64>() {
        Ok(value) if value > 0.0 && value.is_finite() => Ok((value * (1_u64 << power) as f64) as u64),
        _ => Err(Error::usage(format!("'{text}' is not an amount of memory: expected for example 2G or 800M"))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_with_units() {
        for (text, metres) in [
            ("30", 30.0),
            ("30m", 30.0),
            (" 1.5 km ", 1500.0),
            ("100ft", 30.48),
            ("-5", -5.0),
            ("1e3", 1000.0),
            ("1e3ft", 304.8),
            ("2mi", 3218.688),
            ("3937us-ft", 1200.0),
        ] {
            let read = parse_length_m(text).unwrap();
            assert!((read - metres).abs() < 1e-9, "{text}: {read}");
        }
        for text in ["", "m", "30 parsecs", "nan", "inf", "1e999", "3..5"] {
            assert!(parse_length_m(text).is_err(), "{text} was taken for a length");
        }
    }

    #[test]
    fn memory_sizes() {
        assert_eq!(parse_memory("2G").unwrap(), 2 << 30);
        assert_eq!(parse_memory("1.5GiB").unwrap(), 3 << 29);
        assert_eq!(parse_memory("4096").unwrap(), 4096);
        for text in ["", "G", "-1G", "0", "many"] {
            assert!(parse_memory(text).is_err(), "{text} was taken for an amount of memory");
        }
    }
}
