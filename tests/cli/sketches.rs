//! `orograph amplify --sketch` of greys that come as a palette, or as red, green and blue.

use super::rasters::{Raster, facts, terrain};
use super::{Run, fixture, folder, inside, listing};
use gdal::raster::{ColorEntry, ColorTable, PaletteInterpretation, RgbaEntry};
use gdal::{Dataset, DriverManager};
use tempfile::TempDir;

const SIZE: (usize, usize) = (40, 30);
const WORDS: [&str; 10] = [
    "--sketch",
    "--heights",
    "200m,3000m",
    "--bbox",
    "0,0,4000,3000",
    "--crs",
    "EPSG:32632",
    "--factor",
    "2",
    "--json",
];

fn write(dir: &TempDir, name: &str, bands: Vec<Vec<u8>>, more: fn(&mut Dataset)) -> String {
    let path = inside(dir, name);
    Raster { transform: None, crs: None, more, ..Raster::new(SIZE, bands) }.write(&path);
    path
}

/// The same as PNG.
fn as_png(dir: &TempDir, tif: &str, name: &str) -> String {
    let path = inside(dir, name);
    let driver = DriverManager::get_driver_by_name("PNG").expect("GDAL writes PNG");
    let file = Dataset::open(tif).expect("the sketch");
    file.create_copy(&driver, &path, &Default::default()).expect("a copy").close().expect("written");
    path
}

/// Numbers whose greys go the other way; `red` has red 3 in place of grey 3.
fn palette(dataset: &mut Dataset, is_red: bool) {
    let mut table = ColorTable::new(PaletteInterpretation::Rgba);
    for number in 0..256u16 {
        let grey = 255 - number as i16;
        let [g, b] = if is_red && number == 40 { [0; 2] } else { [grey; 2] };
        table.set_color_entry(number, &ColorEntry::Rgba(RgbaEntry { r: grey, g, b, a: 255 }));
    }
    dataset.rasterband(1).expect("a band").set_color_table(&table);
}

fn amplify(input: &str, output: &str) -> Run {
    let exemplar = fixture("jacksboro.tif");
    let words = ["amplify", input, output, "--exemplar", &exemplar, "--mode", "paper", "--patches", "2000"];
    Run::new(&[&words[..], &WORDS].concat())
}

#[test]
fn greys_of_all_kinds_are_the_same() {
    let dir = folder();
    let greys: Vec<u8> = terrain(SIZE.0, SIZE.1).into_iter().map(|v| (v * 255.0) as u8).collect();
    let plain = write(&dir, "plain.tif", vec![greys.clone()], |_| {});
    let known = inside(&dir, "known.tif");
    amplify(&plain, &known).expect(0, "");
    let known = facts(&known).bands[0].bits.clone();
    let indexed =
        write(&dir, "indexed.tif", vec![greys.iter().map(|grey| 255 - grey).collect()], |d| palette(d, false));
    let colours = write(&dir, "colours.tif", vec![greys.clone(); 3], |_| {});
    let pictures = [as_png(&dir, &indexed, "indexed.png"), as_png(&dir, &colours, "colours.png")];
    for (number, sketch) in [&indexed, &colours].into_iter().chain(&pictures).enumerate() {
        let out = inside(&dir, &format!("{number}.tif"));
        let run = amplify(sketch, &out);
        run.expect(0, "");
        run.check(!run.stderr().contains("colour"), "no word of its colours");
        assert!(facts(&out).bands[0].bits == known, "{sketch}");
    }
}

#[test]
fn colours_are_refused() {
    let dir = folder();
    let greys: Vec<u8> = terrain(SIZE.0, SIZE.1).into_iter().map(|v| (v * 255.0) as u8).collect();
    let red = write(&dir, "red.tif", vec![greys.clone()], |dataset| palette(dataset, true));
    let mut other = greys.clone();
    other[85] ^= 16;
    let blue = write(&dir, "blue.tif", vec![greys.clone(), greys.clone(), other], |_| {});
    let two = write(&dir, "two.tif", vec![greys.clone(), greys], |_| {});
    let before = listing(dir.path());
    for (sketch, code, words) in [
        (
            &red,
            3,
            "red.tif: colour 40 of its palette is red 215, green 0, blue 0, and a sketch is of greys; draw in greys",
        ),
        (&blue, 3, "blue.tif: row 2, column 5: its three bands differ: "),
        (&two, 2, "two.tif: 2 bands, and one is made finer"),
    ] {
        let run = amplify(sketch, &inside(&dir, "out.tif"));
        run.expect(code, words);
        run.check(listing(dir.path()) == before, "the folder as it was");
    }
    // One band of it will do.
    let out = inside(&dir, "out.tif");
    let exemplar = fixture("jacksboro.tif");
    let words =
        ["amplify", &blue, &out, "--exemplar", &exemplar, "--mode", "paper", "--patches", "2000", "--band", "1"];
    Run::done(&[&words[..], &WORDS].concat());
}
