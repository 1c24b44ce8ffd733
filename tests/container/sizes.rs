//! Every byte counts: what a file has beside its chunks.

use crate::case::Case;
use orograph::codec::Cells;
use orograph::grid::{GeoTransform, SampleType};
use orograph::oro::Description;

/// CRSs as GDAL writes them, one a line.
const PRIMING: &str = include_str!("../../format-spec/tables/text-1.txt");

fn overhead(change: impl FnOnce(&mut Description)) -> u64 {
    let mut case = Case::new(1024, 1024, 1024, &[SampleType::I16]);
    change(&mut case.description);
    let (bytes, summary) = case.write();
    bytes.len() as u64 - summary.chunk_bytes
}

fn crs(name: &str) -> Option<String> {
    let line = PRIMING.lines().find(|line| line.contains(&format!("CRS[\"{name}\"")) && line.ends_with("]]"));
    Some(line.expect("the priming text has it").to_string())
}

#[test]
fn a_bare_file_is_small() {
    let bytes = overhead(|_| {});

    assert!(bytes <= 90, "{bytes} bytes");
}

#[test]
fn common_georeferences_are_small() {
    let geographic = overhead(|description| {
        description.georeference.crs = crs("WGS 84");
        description.georeference.transform = Some(GeoTransform([
            7.999_583_333_333_334,
            0.000_833_333_333_333_3,
            0.0,
            47.000_416_666_666_666,
            0.0,
            -0.000_833_333_333_333_3,
        ]));
        description.bands[0].unit = "m".into();
        description.bands[0].rule.nodata = Some(0x8000);
    });

    assert!(geographic <= 130, "{geographic} bytes");
    let utm = overhead(|description| {
        description.georeference.crs =
            crs("WGS 84 / UTM zone 32N").map(|crs| crs.replace("32N", "33N").replace("origin\",9", "origin\",15"));
        description.georeference.transform = Some(GeoTransform([463_215.0, 30.0, 0.0, 5_100_345.0, 0.0, -30.0]));
    });

    assert!(utm <= 150, "{utm} bytes");
    let lambert = overhead(|description| {
        description.georeference.crs = crs("RGF93 v1 / Lambert-93");
        description.georeference.transform = Some(GeoTransform([974_999.5, 1.0, 0.0, 6_500_000.5, 0.0, -1.0]));
    });

    assert!(lambert <= 130, "{lambert} bytes");
}

#[test]
fn an_index_takes_little() {
    let mut case = Case::new(64 * 40, 64 * 40, 64, &[SampleType::U8]);
    let index = |case: &Case| {
        let summary = case.write().1;
        summary.sections.iter().find(|section| section.section.name() == "INDX").expect("has an index").length
    };
    let noise = index(&case);
    assert!(noise < 9 * 1600, "{noise} bytes for 1600 chunks");
    // All lengths are equal: only the least of each column is stored.
    case.bands[0] = Cells::U8(vec![7; 64 * 40 * 64 * 40]);
    let equal = index(&case);
    assert!(equal < 40, "{equal} bytes for 1600 chunks");
}
