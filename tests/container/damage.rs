//! Damaged files: nothing panics, nothing wrong is taken for right, and what is sound can be read.

use crate::case::{Case, Counted, assert_same};
use orograph::codec::Cells;
use orograph::error::{ErrorKind, Result};
use orograph::grid::SampleType;
use orograph::oro::{FaultPlace, Place, Reader, Window};
use orograph::watch::Watch;

fn whole(case: &Case) -> Window {
    Window { col: 0, row: 0, width: case.description.width, height: case.description.height }
}

/// All cells of all bands, or the first error.
fn all_cells(case: &Case, file: &[u8]) -> Result<Vec<Cells>> {
    let reader = Reader::open(file)?;
    (0..case.bands.len()).map(|band| reader.window(band, 0, whole(case))).collect()
}

#[test]
fn every_bit_matters() {
    for case in [Case::talkative(), Case::new(5, 2, 64, &[SampleType::U8])] {
        let file = case.write().0;
        for byte in 0..file.len() {
            for bit in 0..8 {
                let mut damaged = file.clone();
                damaged[byte] ^= 1 << bit;
                if let Ok(cells) = all_cells(&case, &damaged) {
                    for (cells, expected) in cells.iter().zip(&case.bands) {
                        assert_same(cells, expected, &format!("bit {bit} of byte {byte}"));
                    }
                }
                if let Ok(reader) = Reader::open(damaged.as_slice()) {
                    let report = reader.check(&Watch::default()).expect("is read");
                    assert!(!report.is_sound(), "bit {bit} of byte {byte} is part of nothing that is checked");
                }
            }
        }
    }
}

#[test]
fn every_truncation_is_refused() {
    for case in [Case::talkative(), Case::new(300, 400, 64, &[SampleType::U8])] {
        let file = case.write().0;
        for length in (0..file.len()).step_by(1 + file.len() / 3000) {
            let error = Reader::open(&file[..length]).expect_err("is refused");
            assert_eq!(error.kind(), ErrorKind::Corrupt, "{length} of {} bytes: {error}", file.len());
            let error = Reader::open(&file[file.len() - length..]).expect_err("is refused");
            assert_eq!(error.kind(), ErrorKind::Corrupt, "the last {length} of {} bytes: {error}", file.len());
        }
        let mut longer = file.clone();
        longer.push(0);
        assert!(Reader::open(longer).is_err(), "a byte too many");
    }
}

#[test]
fn a_damaged_tile_leaves_the_others() {
    let case = Case::new(64 * 3, 64 * 2, 64, &[SampleType::I16, SampleType::U8]);
    let mut file = case.write().0;
    let reader = Reader::open(file.as_slice()).expect("opens");
    let bad = Place { col: 1, row: 1, band: 0 };
    let chunk = reader.chunk(bad, 0).expect("is read");
    let at = file.windows(chunk.bytes.len()).position(|bytes| bytes == chunk.bytes).expect("stands in the file");
    let finest = at + chunk.bytes.len() - 10;
    file[finest] ^= 1;

    let reader = Reader::open(file.as_slice()).expect("opens");
    let error = reader.tile(bad, 0).expect_err("is damaged");
    assert_eq!(error.kind(), ErrorKind::Corrupt);
    assert_eq!(error.place(), Some("tile column 1, row 1, band 1, segment 3"));
    assert!(reader.tile(bad, 1).is_ok(), "coarser levels do not need the last segment");
    assert_same(&reader.window(1, 0, whole(&case)).expect("is read"), &case.bands[1], "the other band");
    assert!(reader.window(0, 0, whole(&case)).is_err());

    let mut places = vec![];
    let saved = reader.window_or(0, 0, whole(&case), &mut |error| {
        places.push(error.place().unwrap_or_default().to_string());
        Ok(())
    });
    assert_eq!(places, ["tile column 1, row 1, band 1, segment 3"]);
    let saved = saved.expect("is read");
    let (Cells::I16(saved), Cells::I16(expected)) = (saved, &case.bands[0]) else { panic!("another type") };
    for (cell, (saved, expected)) in saved.iter().zip(expected).enumerate() {
        let (row, col) = (cell / 192, cell % 192);
        let damaged = row >= 64 && (64..128).contains(&col);
        assert_eq!(*saved, if damaged { 0 } else { *expected }, "row {row}, column {col}");
    }

    let report = reader.check(&Watch::default()).expect("is read");
    let faults: Vec<_> = report.faults.iter().map(|fault| fault.place).collect();
    assert_eq!(faults, [FaultPlace::Tile(bad, Some(3)), FaultPlace::Hash]);
    assert!(report.faults[0].offset <= finest as u64 && finest as u64 - report.faults[0].offset < 64 * 64 * 2);
}

#[test]
fn a_damaged_overview_costs_nothing_but_time() {
    let case = Case::new(64 * 5, 64 * 5, 64, &[SampleType::I16]);
    let mut file = case.write().0;
    let section = Reader::open(file.as_slice()).expect("opens").sections()[0];
    assert_eq!(section.section.name(), "OVER");
    file[section.offset as usize] ^= 1;
    let source = Counted::new(file);
    let reader = Reader::open(&source).expect("opens");
    for level in [6, 7, 8] {
        let (width, height) = case.description.level_size(level);
        let cells = reader.window(0, level, Window { col: 0, row: 0, width, height }).expect("is read");
        assert_same(&cells, &case.bands[0].decimated(case.description.width, level), "a coarse level");
    }
    let report = reader.check(&Watch::default()).expect("is read");
    let places: Vec<String> = report.faults.iter().map(|fault| fault.place.to_string()).collect();
    assert_eq!(places, ["section OVER", "overview, tile column 0, row 0, band 1, segment 0", "hash of the whole"]);
}

#[test]
fn a_check_can_be_stopped() {
    let reader = Reader::open(Case::talkative().write().0).expect("opens");
    let watch = Watch::default();
    watch.cancel();
    assert_eq!(reader.check(&watch).expect_err("is stopped").kind(), ErrorKind::Interrupted);
}
