//! Maps of containers: a level that is fine enough will do.

use super::rasters::{Raster, facts};
use super::{Run, folder, inside};
use orograph::oro::Reader;
use std::fs;

/// Damages the finest segments of all tiles.
fn damage_finest(oro: &str) {
    let mut bytes = fs::read(oro).expect("the container");
    let reader = Reader::open(bytes.clone()).expect("a container");
    let tiling = reader.description().tiling();
    for number in 0..tiling.tiles() {
        let place = tiling.place(number, 1);
        let [all, coarse] = [0, 1].map(|level| reader.chunk(place, level).expect("the chunk").bytes);
        let at = bytes.windows(all.len()).position(|window| window == all).expect("the chunk is in the file");
        bytes[at + coarse.len() + 1] ^= 0x10;
    }
    fs::write(oro, bytes).expect("written");
}

#[test]
fn small_maps_take_a_coarse_level() {
    let dir = folder();
    let [before, oro, from_dem, from_oro] = ["a.tif", "a.oro", "dem.png", "oro.png"].map(|name| inside(&dir, name));
    let band: Vec<f32> = (0..1500 * 1300)
        .map(|i| {
            let (x, y) = ((i % 1500) as f32, (i / 1500) as f32);
            900.0 + 700.0 * (x / 210.0).sin() * (y / 170.0).cos()
        })
        .collect();
    Raster::new((1500, 1300), vec![band]).write(&before);
    Run::done(&["encode", &before, &oro, "--tile-size", "512", "--max-error", "0.01"]);
    let map = |input: &str, out: &str, width: &str| {
        let options = ["--width", width, "--source", "", "--overwrite", "--json"];
        Run::new(&[&["map", input, out], &options[..]].concat())
    };
    // The same picture but for rounding: no pixel is of another colour.
    let facts_of = |input: &str, out: &str, width: &str| {
        let run = map(input, out, width);
        run.expect(0, "");
        let report = run.json()["result"].clone();
        assert_eq!((&report["cols"], &report["rows"]), (&1500.into(), &1300.into()));
        facts(out)
    };
    let (dem, coarse) = (facts_of(&before, &from_dem, "200"), facts_of(&oro, &from_oro, "200"));
    assert_eq!(dem.size, coarse.size);
    for (band, (dem, coarse)) in dem.bands.iter().zip(&coarse.bands).enumerate() {
        let far = dem.bits.iter().zip(&coarse.bits).map(|(a, b)| a.abs_diff(*b)).max();
        assert!(far < Some(24), "band {band}: {far:?}");
    }
    damage_finest(&oro);
    assert_eq!(facts_of(&oro, &from_oro, "200").bands[0].bits, coarse.bands[0].bits, "the finest level is not read");
    map(&oro, &from_oro, "900").expect(3, "checksum");
}
