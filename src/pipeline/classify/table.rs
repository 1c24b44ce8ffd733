//! The disks as a table, for other programs to learn from.

use super::disks::DiskRow;
use crate::classify::{Part, table};
use std::fmt::Write;

/// The disks as CSV: class, range, centre, number of peaks, what each was for in every cut, and its features.
///
/// `disks` are disks with the numbers of their classes, and `parts` has an entry for every direction of the cuts, in it
/// one for every disk.
pub(super) fn csv(classes: &[String], disks: &[(DiskRow, u32)], parts: &[Vec<Part>]) -> String {
    let mut text = "class,range,x,y,peaks".to_string();
    // Writing to a String cannot fail.
    (1..=parts.len()).for_each(|cut| write!(text, ",cut_{cut}").expect("a String takes all"));
    for feature in table() {
        (0..feature.bins).for_each(|bin| write!(text, ",{}_{bin}", feature.metric).expect("a String takes all"));
    }
    text.push('\n');
    for (i, (disk, class)) in disks.iter().enumerate() {
        let (x, y) = disk.centre;
        let class = quoted(&classes[*class as usize]);
        write!(text, "{class},{},{x},{y},{}", disk.spot.range, disk.peaks).expect("a String takes all");
        for parts in parts {
            text.push_str(match parts[i] {
                Part::Learn => ",learn",
                Part::Test => ",test",
                Part::Neither => ",neither",
            });
        }
        disk.row.iter().for_each(|share| write!(text, ",{share}").expect("a String takes all"));
        text.push('\n');
    }
    text
}

fn quoted(text: &str) -> String {
    let must = text.contains([',', '"', '\n', '\r']);
    if must { format!("\"{}\"", text.replace('"', "\"\"")) } else { text.to_string() }
}
