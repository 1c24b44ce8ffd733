//! A divide tree read from the text that Argudo et al. (2019) publish their exemplars in, written by the program
//! `divide_tree` of A. Kirmse.
//!
//! `Peaks n`, and `n` lines of number, longitude, latitude, elevation, column, row; `PromSaddles` and others the same;
//! `Edges n`, and `n` lines of a peak, another peak, and the saddle between them, by their numbers from 1. Elevations
//! are whole feet. Longitudes and latitudes are those of a place at the equator: they become metres there.

use super::drawn::{DrawnLine, DrawnSpot, DrawnTree};
use crate::error::{Error, ErrorKind, Result};
use crate::io::text::read_text;
use crate::units::FOOT_M;
use std::path::Path;

/// Metres of a second of arc at the equator, as the exemplars count it.
const SECOND_M: f64 = 30.87;

/// Reads a tree.
///
/// # Errors
/// A text that is none, with the line.
pub(super) fn read_tree(path: &Path) -> Result<DrawnTree> {
    parse(&read_text(path)?).map_err(|error| error.at_path(path))
}

fn parse(text: &str) -> Result<DrawnTree> {
    let mut tree = DrawnTree::default();
    let mut section = "";
    let mut left = 0_usize;
    for (number, line) in (1..).zip(text.lines()) {
        let words: Vec<&str> = line.split_whitespace().collect();
        let wrong = |expected: &str| {
            Error::new(ErrorKind::Input, format!("found '{line}', expected {expected}"))
                .at_place(format!("line {number}"))
        };
        let Some(first) = words.first() else { continue };
        if first.starts_with(|c: char| c.is_ascii_alphabetic()) {
            if left > 0 {
                return Err(wrong(&format!("{left} more lines of {section}")));
            }
            section = first;
            left = words.get(1).and_then(|count| count.parse().ok()).ok_or_else(|| wrong("a section and its count"))?;
            continue;
        }
        if left == 0 {
            return Err(wrong("a section, such as 'Peaks 12'"));
        }
        left -= 1;
        let numbers: Option<Vec<f64>> =
            words.iter().map(|word| word.parse().ok().filter(|v: &f64| v.is_finite())).collect();
        let numbers = numbers.ok_or_else(|| wrong("numbers"))?;
        match section {
            "Peaks" | "PromSaddles" => {
                let [_, lon, lat, feet, ..] = numbers[..] else {
                    return Err(wrong("number, longitude, latitude, elevation"));
                };
                let (spots, kind) =
                    if section == "Peaks" { (&mut tree.peaks, "peak") } else { (&mut tree.saddles, "saddle") };
                let at = (lon * 3600.0 * SECOND_M, lat * 3600.0 * SECOND_M);
                spots.push(DrawnSpot { at, elevation_m: feet * FOOT_M, name: format!("{kind} {}", words[0]) });
            }
            "Edges" => {
                let [a, b, saddle] = [0, 1, 2].map(|k| numbers.get(k).copied().unwrap_or(0.0));
                let spot = |spots: &[DrawnSpot], number: f64| {
                    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a place in a list")]
                    let at = (number >= 1.0).then(|| spots.get(number as usize - 1).map(|spot| spot.at));
                    at.flatten()
                };
                let points = [spot(&tree.peaks, a), spot(&tree.saddles, saddle), spot(&tree.peaks, b)];
                let points: Option<Vec<(f64, f64)>> = points.into_iter().collect();
                let points = points.ok_or_else(|| wrong("two peaks and a saddle that are there"))?;
                tree.lines.push(DrawnLine { points, name: format!("the edge of line {number}") });
            }
            _ => {}
        }
    }
    if left > 0 {
        let message = format!("the text ends where {left} more lines of {section} are expected");
        return Err(Error::new(ErrorKind::Input, message));
    }
    if tree.peaks.is_empty() {
        return Err(Error::new(ErrorKind::Input, "there is no section Peaks: it is no text of a divide tree"));
    }
    Ok(tree)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tree() {
        let text = "Peaks 2\n1 0.01 0.0 100 12 0\n2 0.02 0.0 200 24 0\nPromSaddles 1\n1 0.015 0 50 18 0\nBasinSaddles 0\n\
                    Runoffs 1\n1 0 0 10 0 0\nEdges 1\n1 2 1\nRunoffEdges 1\n1\n";
        let tree = parse(text).unwrap();
        assert_eq!((tree.peaks.len(), tree.saddles.len(), tree.lines.len()), (2, 1, 1));
        assert_eq!(tree.peaks[1].elevation_m, 200.0 * FOOT_M);
        assert_eq!(tree.lines[0].points[1], tree.saddles[0].at);
        for (from, to, message) in [
            ("Peaks 2", "Peaks 3", "1 more lines of Peaks"),
            ("1 2 1\n", "1 2 7\n", "line 10"),
            ("0.01", "x", "line 2"),
            ("RunoffEdges 1\n1\n", "RunoffEdges 2\n1\n", "ends where 1"),
            ("Peaks 2", "1 2 3", "a section"),
        ] {
            let error = parse(&text.replacen(from, to, 1)).unwrap_err().to_string();
            assert!(error.contains(message), "{message}: {error}");
        }
        assert!(parse("").unwrap_err().to_string().contains("no section Peaks"));
    }
}
