//! What goes in comes out.

use crate::case::{Case, SAMPLES, assert_same, cells, cut};
use orograph::codec::{Bound, Cells};
use orograph::error::ErrorKind;
use orograph::grid::{GeoTransform, SampleType};
use orograph::oro::{
    Band, CellMeaning, Description, Georeference, MetadataItem, Place, Reader, Window, Writer, encode_chunk,
};
use orograph::watch::Watch;
use proptest::prelude::*;

/// Every level of every band, as a whole and in windows, against the cells decimated.
fn assert_holds(case: &Case) {
    let (bytes, summary) = case.write();
    assert_eq!(bytes.len() as u64, summary.bytes);
    let reader = Reader::open(bytes.as_slice()).expect("opens");
    let description = reader.description();
    assert_eq!(format!("{description:?}"), format!("{:?}", case.description), "the description comes back");
    for (band, cells) in case.bands.iter().enumerate() {
        for level in 0..=description.last_level().min(14) {
            let (width, height) = description.level_size(level);
            let whole = Window { col: 0, row: 0, width, height };
            let expected = cells.decimated(description.width, level);
            assert_same(&reader.window(band, level, whole).expect("is read"), &expected, "the whole of a level");
            let part =
                Window { col: width / 3, row: height / 2, width: (width / 2).max(1), height: (height / 3).max(1) };
            let Window { col, row, width: columns, height: rows } = part;
            let expected = cut(&expected, width, col, row, columns, rows);
            assert_same(&reader.window(band, level, part).expect("is read"), &expected, "a window of a level");
        }
    }
    let report = reader.check(&Watch::default()).expect("is read");
    assert!(report.is_sound(), "{report:?}");
}

#[test]
fn every_type() {
    for sample in SAMPLES {
        assert_holds(&Case::new(130, 67, 64, &[sample]));
    }
    assert_holds(&Case::new(65, 65, 64, &SAMPLES));
    assert_holds(&Case::talkative());
}

#[test]
fn many_tiles_have_an_overview() {
    let case = Case::new(64 * 66 + 1, 64 * 3 - 5, 64, &[SampleType::U8, SampleType::I8]);
    assert!(case.write().1.sections.iter().any(|section| section.section.name() == "OVER"));
    assert_holds(&case);
    assert_holds(&Case::new(3, 64 * 70, 64, &[SampleType::I16]));
    assert_holds(&Case::new(65_537, 1, 64, &[SampleType::U8]));
    assert_holds(&Case::new(1, 100_000, 128, &[SampleType::U8]));
}

#[test]
fn tiles_are_read_one_by_one() {
    let case = Case::new(200, 130, 64, &[SampleType::I32, SampleType::U8]);
    let reader = Reader::open(case.write().0).expect("opens");
    let cells = reader.tile(Place { col: 3, row: 2, band: 1 }, 0).expect("is read");
    assert_same(&cells, &case.cut(1, 192, 128, 8, 2), "the last tile");
    let cells = reader.tile(Place { col: 0, row: 1, band: 0 }, 2).expect("is read");
    assert_same(&cells, &case.cut(0, 0, 64, 64, 64).decimated(64, 2), "a coarse tile");
    for (place, level) in [((4, 0, 0), 0), ((0, 3, 0), 0), ((0, 0, 2), 0), ((0, 0, 0), 7)] {
        let place = Place { col: place.0, row: place.1, band: place.2 };
        assert_eq!(reader.tile(place, level).expect_err("is not there").kind(), ErrorKind::Usage);
    }
    for (band, level, col, width) in
        [(2, 0, 0, 1), (0, 9, 0, 1), (0, 0, 200, 1), (0, 0, 0, 201), (0, 0, 0, 0), (0, 0, usize::MAX, 2)]
    {
        let window = Window { col, row: 0, width, height: 1 };
        assert_eq!(reader.window(band, level, window).expect_err("is not there").kind(), ErrorKind::Usage);
    }
}

#[test]
fn a_level_lies_on_its_samples() {
    let mut description = Description::new(5000, 3000, vec![Band::new(SampleType::U8)]);
    let transform = GeoTransform([100.0, 2.0, 0.5, 50.0, -0.25, -3.0]);
    description.georeference.transform = Some(transform);
    for level in [0, 1, 6, 9] {
        let coarse = description.level_transform(level).expect("there is one");
        let step = f64::from(1 << level);
        let (a, b) = (coarse.centre(3.0, 4.0), transform.centre(3.0 * step, 4.0 * step));
        assert!((a.0 - b.0).abs() < 1e-9 && (a.1 - b.1).abs() < 1e-9, "level {level}: {a:?} {b:?}");
        assert!((coarse.0[1] - 2.0 * step).abs() < 1e-12);
    }
    assert_eq!(description.last_level(), 13);
    assert_eq!(description.level_size(6), (79, 47));
}

#[test]
fn what_no_file_can_hold_is_refused() {
    let sound = || Description::new(10, 10, vec![Band::new(SampleType::U8)]);
    let with = |change: &dyn Fn(&mut Description)| {
        let mut description = sound();
        change(&mut description);
        Writer::new(vec![], description).expect_err("is refused").kind()
    };
    assert!(sound().check().is_ok());
    let changes: [&dyn Fn(&mut Description); 11] = [
        &|d| d.width = 0,
        &|d| d.height = 1 << 31,
        &|d| d.tile_side = 100,
        &|d| d.tile_side = 0,
        &|d| d.tile_side = 4096 + 64,
        &|d| d.bands.clear(),
        &|d| d.bands = vec![Band::new(SampleType::U8); 65_536],
        &|d| (d.width, d.height, d.tile_side) = ((1 << 31) - 1, (1 << 31) - 1, 64),
        &|d| d.bands[0].rule.nodata = Some(256),
        &|d| d.bands[0].rule.bound = Bound::MaxError(0.0),
        &|d| d.georeference.crs = Some("a\0b".into()),
    ];
    for (number, change) in changes.iter().enumerate() {
        assert_eq!(with(change), ErrorKind::Usage, "change {number}");
    }
}

#[test]
fn chunks_come_in_order_and_all_of_them() {
    let case = Case::new(130, 64, 64, &[SampleType::U8]);
    let chunk = |col: usize| {
        let shape = case.description.tiling().shape(col, 0);
        let cells = Cells::U8(vec![0; shape.cells()]);
        encode_chunk(&case.description, Place { col, row: 0, band: 0 }, &cells).expect("encodes")
    };
    let mut writer = Writer::new(vec![], case.description.clone()).expect("begins");
    assert!(writer.push(&chunk(1)).is_err(), "the second before the first");
    writer.push(&chunk(0)).expect("is next");
    assert!(writer.push(&chunk(0)).is_err(), "the first once more");
    writer.push(&chunk(1)).expect("is next");
    assert!(writer.finish().is_err(), "one is missing");
    let beyond = Place { col: 3, row: 0, band: 0 };
    assert!(encode_chunk(&case.description, beyond, &Cells::U8(vec![])).is_err(), "there is no such tile");
    let wrong = Cells::U16(vec![0; 64 * 64]);
    assert!(encode_chunk(&case.description, Place::default(), &wrong).is_err(), "another type");
}

fn text() -> impl Strategy<Value = String> {
    prop_oneof![Just(String::new()), Just("m".into()), "[^\0]{0,20}", "GEOGCRS\\[\"[A-Z]{1,9}\"\\]"]
}

fn items() -> impl Strategy<Value = Vec<MetadataItem>> {
    let item = (text(), text(), text()).prop_map(|(domain, key, value)| MetadataItem { domain, key, value });
    proptest::collection::vec(item, 0..4)
}

fn float() -> impl Strategy<Value = f64> {
    let numbers = vec![0.0, -0.0, 0.1, 30.0, 1.0 / 3600.0, f64::NAN, f64::INFINITY, f64::MIN_POSITIVE / 2.0];
    prop_oneof![any::<f64>(), any::<u64>().prop_map(f64::from_bits), proptest::sample::select(numbers)]
}

fn band() -> impl Strategy<Value = Band> {
    let numbers = (0..8_usize, proptest::option::of(any::<u64>()), proptest::option::of(1e-9..1e9_f64));
    (numbers, proptest::option::of(float()), proptest::option::of(float()), text(), text(), items()).prop_map(
        |((sample, nodata, bound), scale, offset, unit, description, metadata)| {
            let mut band = Band { scale, offset, unit, description, metadata, ..Band::new(SAMPLES[sample]) };
            let bits = 64 - SAMPLES[sample].bytes() * 8;
            band.rule.nodata = nodata.map(|nodata| nodata << bits >> bits);
            band.rule.bound = bound.map_or(Bound::Lossless, Bound::MaxError);
            band
        },
    )
}

fn georeference() -> impl Strategy<Value = Georeference> {
    let transform = proptest::option::of(proptest::array::uniform6(float()).prop_map(GeoTransform));
    let meaning = prop_oneof![Just(CellMeaning::Area), Just(CellMeaning::Point)];
    (transform, proptest::option::of(text()), proptest::option::of(float()), meaning)
        .prop_map(|(transform, crs, epoch, cells_are)| Georeference { transform, crs, epoch, cells_are })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, ..ProptestConfig::default() })]

    #[test]
    fn any_description_comes_back_to_the_bit(
        georeference in georeference(),
        bands in proptest::collection::vec(band(), 1..4),
        metadata in items(),
        repeats in 1..3_usize,
    ) {
        let bands = std::iter::repeat_n(bands, repeats).flatten().collect();
        let description = Description { georeference, metadata, ..Description::new(2, 1, bands) };
        let bands = description.bands.iter().map(|band| cells(band.rule.sample, 2, 1)).collect();
        let case = Case { description, bands };
        let reader = Reader::open(case.write().0).expect("opens");
        // Debug tells -0.0 from 0.0, and a NaN is equal to itself there.
        prop_assert_eq!(format!("{:?}", reader.description()), format!("{:?}", case.description));
    }

    #[test]
    fn any_shape_comes_back(width in 1..400_usize, height in 1..400_usize, side in 1..4_usize, samples in proptest::collection::vec(0..8_usize, 1..3)) {
        let samples: Vec<_> = samples.into_iter().map(|sample| SAMPLES[sample]).collect();
        assert_holds(&Case::new(width, height, side * 64, &samples));
    }
}
