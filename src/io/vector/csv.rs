//! Layers as CSV: written here rather than through OGR, as large surveys spend their time on it.

use super::table::{Geometry, GeometryKind, Table, Value};
use crate::error::{Error, ErrorKind, Result};
use crate::io::output::Output;
use crate::watch::Watch;
use rayon::prelude::*;
use std::fs::File;
use std::io::Write;

/// Rows that are turned into text at once.
const BATCH: usize = 4096;

/// Writes a layer with a header line; lines get a last column `wkt`.
pub(super) fn write(output: &Output, table: &dyn Table, watch: &Watch) -> Result<()> {
    let wrong = |error: std::io::Error| {
        Error::new(ErrorKind::Output, format!("it cannot be written: {error}")).at_path(output.target())
    };
    let mut file = File::create(output.path()).map_err(wrong)?;
    let has_wkt = table.geometry_kind() != GeometryKind::Point;
    let mut header: Vec<&str> = table.fields().iter().map(|field| field.name.as_str()).collect();
    if has_wkt {
        header.push("wkt");
    }
    writeln!(file, "{}", header.join(",")).map_err(wrong)?;
    // A few batches for each thread at a time: the text of a large layer is never in memory as a whole.
    let group = BATCH * 4 * rayon::current_num_threads();
    for start in (0..table.rows()).step_by(group) {
        let end = (start + group).min(table.rows());
        let starts: Vec<usize> = (start..end).step_by(BATCH).collect();
        let texts: Vec<Vec<u8>> = starts
            .par_iter()
            .map(|&from| {
                let mut text = Vec::with_capacity(BATCH * 256);
                let mut values = Vec::new();
                for row in from..(from + BATCH).min(end) {
                    values.clear();
                    table.values(row, &mut values);
                    append_row(&mut text, table, &values);
                    if has_wkt {
                        append_wkt(&mut text, &table.geometry(row));
                    }
                    text.push(b'\n');
                }
                text
            })
            .collect();
        for text in texts {
            file.write_all(&text).map_err(wrong)?;
        }
        watch.advance((end - start) as u64)?;
    }
    file.flush().map_err(wrong)
}

fn append_row(text: &mut Vec<u8>, table: &dyn Table, values: &[Value<'_>]) {
    let mut integer = itoa::Buffer::new();
    for (i, (field, value)) in table.fields().iter().zip(values).enumerate() {
        if i > 0 {
            text.push(b',');
        }
        match *value {
            Value::Null => {}
            Value::Integer(value) => text.extend_from_slice(integer.format(value).as_bytes()),
            Value::Boolean(value) => text.extend_from_slice(if value { b"true" } else { b"false" }),
            Value::Real(value) => append_real(text, value, field.decimals),
            Value::Text(value) => append_text(text, value),
        }
    }
}

/// Appends a number with at most the given decimals, without zeros at the end; nothing for NaN.
fn append_real(text: &mut Vec<u8>, value: f64, decimals: Option<u8>) {
    const POWERS: [f64; 10] = [1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9];
    if !value.is_finite() {
        return;
    }
    let mut integer = itoa::Buffer::new();
    if value.fract() == 0.0 && value.abs() < 1e15 {
        text.extend_from_slice(integer.format(value as i64).as_bytes());
        return;
    }
    let scaled = decimals.map(|decimals| (value * POWERS[decimals as usize], decimals as usize));
    match scaled {
        Some((scaled, decimals)) if scaled.abs() < 1e15 => {
            let rounded = scaled.abs().round() as u64;
            if value < 0.0 && rounded > 0 {
                text.push(b'-');
            }
            let power = POWERS[decimals] as u64;
            text.extend_from_slice(integer.format(rounded / power).as_bytes());
            let fraction = rounded % power;
            if fraction > 0 {
                text.push(b'.');
                let digits = integer.format(fraction + power).as_bytes();
                let end = digits.iter().rposition(|&digit| digit != b'0').map_or(1, |last| last + 1);
                text.extend_from_slice(&digits[1..end]);
            }
        }
        _ => text.extend_from_slice(ryu::Buffer::new().format_finite(value).as_bytes()),
    }
}

/// Appends text, quoted where it must be (RFC 4180).
fn append_text(text: &mut Vec<u8>, value: &str) {
    if value.contains(['"', ',', '\n', '\r']) {
        text.push(b'"');
        text.extend_from_slice(value.replace('"', "\"\"").as_bytes());
        text.push(b'"');
    } else {
        text.extend_from_slice(value.as_bytes());
    }
}

fn append_wkt(text: &mut Vec<u8>, geometry: &Geometry) {
    let pieces = match geometry {
        Geometry::Point(..) => return,
        Geometry::Lines(pieces) => pieces,
        Geometry::Triangle(corners) => {
            for (i, corner) in corners.iter().chain(&corners[..1]).enumerate() {
                text.extend_from_slice(if i == 0 { b",\"POLYGON Z ((" } else { b"," });
                for (j, &v) in corner.iter().enumerate() {
                    text.extend_from_slice(if j == 0 { b"" } else { b" " });
                    append_real(text, v, None);
                }
            }
            text.extend_from_slice(b"))\"");
            return;
        }
    };
    text.push(b',');
    let append_points = |text: &mut Vec<u8>, points: &[(f64, f64)]| {
        text.push(b'(');
        for (i, &(x, y)) in points.iter().enumerate() {
            if i > 0 {
                text.push(b',');
            }
            append_real(text, x, None);
            text.push(b' ');
            append_real(text, y, None);
        }
        text.push(b')');
    };
    text.push(b'"');
    if let [line] = pieces.as_slice() {
        text.extend_from_slice(b"LINESTRING ");
        append_points(text, line);
    } else {
        text.extend_from_slice(b"MULTILINESTRING (");
        for (i, piece) in pieces.iter().enumerate() {
            if i > 0 {
                text.push(b',');
            }
            append_points(text, piece);
        }
        text.push(b')');
    }
    text.push(b'"');
}

#[cfg(test)]
mod tests {
    use super::*;

    fn real(value: f64, decimals: Option<u8>) -> String {
        let mut text = Vec::new();
        append_real(&mut text, value, decimals);
        String::from_utf8(text).unwrap()
    }

    #[test]
    fn numbers_as_text() {
        assert_eq!(real(1234.0, Some(3)), "1234");
        assert_eq!(real(-0.0, Some(3)), "0");
        assert_eq!(real(1234.5, Some(3)), "1234.5");
        assert_eq!(real(-0.0004, Some(3)), "0");
        assert_eq!(real(-12.0305, Some(2)), "-12.03");
        assert_eq!(real(0.99999, Some(3)), "1");
        assert_eq!(real(9.600_138_888_888_89, None), "9.60013888888889");
        assert_eq!(real(f64::NAN, Some(3)), "");
        assert_eq!(real(1e300, Some(3)), "1e300");
    }

    #[test]
    fn triangles_as_text() {
        let mut text = Vec::new();
        append_wkt(&mut text, &Geometry::Triangle([[0.0, 0.0, 5.5], [1.0, 0.0, 6.0], [0.0, 1.0, 7.0]]));
        assert_eq!(text, b",\"POLYGON Z ((0 0 5.5,1 0 6,0 1 7,0 0 5.5))\"");
    }

    #[test]
    fn text_is_quoted_where_needed() {
        let mut text = Vec::new();
        append_text(&mut text, "Piz \"Kesch\", east");
        assert_eq!(text, b"\"Piz \"\"Kesch\"\", east\"");
    }
}
