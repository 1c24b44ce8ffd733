//! Containers: what comes back from them.

use super::rasters::{Facts, Raster, facts, terrain};
use super::{PROGRAM, Run, fixture, folder, inside, listing};
use gdal::raster::{ColorInterpretation, GdalType};
use gdal::{DriverManager, Metadata};
use std::fs;
use std::io::Read;
use std::process::{Command, Stdio};
use tempfile::TempDir;

/// Encodes and decodes a raster; returns what the original and the copy hold.
fn there_and_back(dir: &TempDir, options: &[&str]) -> (Facts, Facts) {
    let [before, oro, after] = ["before.tif", "a.oro", "after.tif"].map(|name| inside(dir, name));
    Run::done(&[&["encode", &before, &oro, "--overwrite"], options].concat());
    Run::done(&["verify", &oro]);
    Run::done(&["decode", &oro, &after, "--overwrite"]);
    (facts(&before), facts(&after))
}

/// Writes a raster, and expects it back bit for bit.
fn comes_back<T: GdalType + Copy>(raster: &Raster<T>, options: &[&str]) -> Facts {
    let dir = folder();
    raster.write(&inside(&dir, "before.tif"));
    let (before, after) = there_and_back(&dir, options);
    assert_eq!(before, after);
    after
}

fn cells<T>(cols: usize, rows: usize, of: impl Fn(f64) -> T) -> Vec<T> {
    terrain(cols, rows).into_iter().map(of).collect()
}

#[test]
fn every_type() {
    let (c, r) = (150, 70);
    comes_back(&Raster::new((c, r), vec![cells(c, r, |v| (v * 255.0) as u8)]), &[]);
    comes_back(&Raster::new((c, r), vec![cells(c, r, |v| (v * 65535.0) as u16)]), &["--tile-size", "64"]);
    comes_back(&Raster::new((c, r), vec![cells(c, r, |v| (v * 9000.0 - 4000.0) as i16)]), &["--tile-size", "64"]);
    comes_back(&Raster::new((c, r), vec![cells(c, r, |v| (v * 4e9) as u32)]), &[]);
    comes_back(&Raster::new((c, r), vec![cells(c, r, |v| ((v - 0.5) * 4e9) as i32)]), &[]);
    comes_back(&Raster::new((c, r), vec![cells(c, r, |v| v as f32)]), &["--lossless"]);
    comes_back(&Raster::new((c, r), vec![cells(c, r, |v| v * 1e-3)]), &["--lossless", "--tile-size", "64"]);
    let signed = Raster {
        nodata: Some(-128.0),
        options: &[("PIXELTYPE", "SIGNEDBYTE")],
        ..Raster::new((c, r), vec![cells(c, r, |v| ((v * 255.0) as i16 - 128) as i8 as u8)])
    };
    let dir = folder();
    signed.write(&inside(&dir, "before.tif"));
    let (before, after) = there_and_back(&dir, &[]);
    assert_eq!(before, after);
    let told = Run::done(&["info", &inside(&dir, "a.oro"), "--json"]).json();
    assert_eq!(told["result"]["bands"][0]["type"], "Int8");
    assert_eq!(told["result"]["bands"][0]["nodata"], -128.0);
}

#[test]
fn odd_floats() {
    let singles = [f32::NAN, f32::INFINITY, -0.0, 1e-45, f32::MIN, 0.1];
    let mut values = singles.map(f32::to_bits).to_vec();
    // NaNs with a payload, signed and signalling ones.
    values.extend([0x7fc0_1234, 0xffc0_0001, 0x7f80_0001]);
    let band: Vec<f32> = (0..80 * 70).map(|i| f32::from_bits(values[i % values.len()])).collect();
    let found = comes_back(&Raster::new((80, 70), vec![band.clone()]), &["--lossless"]);
    assert!(found.bands[0].bits.contains(&0x7fc0_1234) && found.bands[0].bits.contains(&0x8000_0000));
    comes_back(&Raster { nodata: Some(f64::NAN), ..Raster::new((80, 70), vec![band]) }, &["--lossless"]);
    let doubles = [f64::NAN, -0.0, 5e-324, f64::MAX, f64::from_bits(0xfff8_0000_dead_beef)];
    let band: Vec<f64> = (0..80 * 70).map(|i| doubles[i % doubles.len()]).collect();
    comes_back(&Raster { nodata: Some(f64::MAX), ..Raster::new((80, 70), vec![band]) }, &["--lossless"]);
}

#[test]
fn all_that_is_said() {
    let (c, r) = (90, 65);
    let bands = vec![cells(c, r, |v| (v * 9000.0) as i16), cells(c, r, |v| (v * 100.0) as i16)];
    let raster = Raster {
        nodata: Some(-9999.0),
        more: |dataset| {
            for (key, value, domain) in [
                ("AREA_OR_POINT", "Point", ""),
                ("TIFFTAG_DATETIME", "2019:07:01 12:00:00", ""),
                ("licence", "CC0 = no rights", ""),
                ("Größe", "naïve — 高さ", "PROJECT"),
                ("b", "2", "PROJECT"),
            ] {
                dataset.set_metadata_item(key, value, domain).expect("metadata");
            }
            let mut band = dataset.rasterband(1).expect("a band");
            band.set_scale(0.1).expect("a scale");
            band.set_offset(-100.5).expect("an offset");
            band.set_description("elevation of the ground").expect("a description");
            band.set_metadata_item("method", "lidar", "").expect("metadata");
            band.set_metadata_item("STATISTICS_MAXIMUM", "12", "").expect("metadata");
            let mut band = dataset.rasterband(2).expect("a band");
            band.set_description("uncertainty").expect("a description");
        },
        ..Raster::new((c, r), bands)
    };
    let dir = folder();
    raster.write(&inside(&dir, "before.tif"));
    let (mut before, after) = there_and_back(&dir, &[]);
    // Statistics need not be true of what comes back.
    let items = before.bands[0].metadata.get_mut("").expect("metadata");
    items.retain(|item| !item.starts_with("STATISTICS_"));
    assert_eq!(before, after);
    assert_eq!(after.metadata["PROJECT"], ["Größe=naïve — 高さ", "b=2"]);
    assert!(after.metadata[""].contains(&"AREA_OR_POINT=Point".to_string()));
    assert_eq!((after.bands[0].scale, after.bands[0].offset), (Some(0.1), Some(-100.5)));
    // One band alone, and the bands the other way round.
    let (oro, one) = (inside(&dir, "a.oro"), inside(&dir, "one.tif"));
    Run::done(&["decode", &oro, &one, "--band", "2"]);
    assert_eq!(facts(&one).bands, after.bands[1..]);
    let turned = inside(&dir, "turned.oro");
    Run::done(&["encode", &inside(&dir, "before.tif"), &turned, "--band", "2", "--band", "1"]);
    Run::done(&["decode", &turned, &one, "--overwrite"]);
    assert_eq!(facts(&one).bands[1], after.bands[0]);
}

#[test]
fn texts_that_are_whole_domains() {
    let raster = Raster {
        more: |dataset| {
            let xml = "<?xpacket begin='a=b'?><x:xmpmeta xmlns:x='adobe:ns:meta/'/>";
            // A key without a value is a text.
            dataset.set_metadata_item("RPC_LIKE", "1", "OTHER").expect("metadata");
            dataset.set_metadata_item("text", xml, "OTHER").expect("metadata");
        },
        ..Raster::new((64, 64), vec![vec![1_u8; 64 * 64]])
    };
    comes_back(&raster, &[]);
}

#[test]
fn places() {
    let band = || vec![cells(40, 30, |v| (v * 9000.0) as i16)];
    let plain = |transform, crs| Raster { transform, crs, ..Raster::new((40, 30), band()) };
    let third = 1.0 / 3.0;
    for transform in [
        [500_000.1, 80.0, 60.0, 5_200_000.7, 60.0, -80.0],
        [500_000.0, 30.0, 0.0, 5_200_000.0, 0.0, 30.0],
        [third, -1e-3 * third, 1e-9, -third, 1e-7, 2e-3 * third],
    ] {
        let found = comes_back(&plain(Some(transform), Some("EPSG:2056")), &[]);
        assert_eq!(found.transform, Some(transform.map(f64::to_bits)), "to the bit");
    }
    assert_eq!(comes_back(&plain(None, None), &[]).transform, None);
    for crs in [
        "EPSG:4326",
        "EPSG:4979",
        "EPSG:2193",
        "EPSG:7415",
        "EPSG:6318+5703",
        "+proj=laea +lat_0=-37.5 +lon_0=145.25 +R=6371000 +units=m +no_defs",
        "+proj=longlat +a=1737400 +b=1737400 +no_defs",
    ] {
        let found = comes_back(&plain(Some([7.0, 0.01, 0.0, 46.0, 0.0, -0.01]), Some(crs)), &[]);
        assert!(found.crs.is_some(), "{crs}");
    }
    // A CRS that is given replaces the file's.
    let dir = folder();
    plain(Some([7.0, 0.01, 0.0, 46.0, 0.0, -0.01]), None).write(&inside(&dir, "before.tif"));
    let (_, after) = there_and_back(&dir, &["--crs", "EPSG:4258"]);
    assert!(after.crs.is_some_and(|wkt| wkt.contains("4258")));
}

/// A coordinate epoch, which only newer GDALs and few formats keep.
#[test]
fn epochs() {
    let dir = folder();
    let vrt = inside(&dir, "a.vrt");
    let text = format!(
        r#"<VRTDataset rasterXSize="403" rasterYSize="344"><SRS coordinateEpoch="2021.3" dataAxisToSRSAxisMapping="2,1">EPSG:7912</SRS>
        <GeoTransform>-84.4, 0.0008, 0, 36.7, 0, -0.0008</GeoTransform>
        <VRTRasterBand dataType="Int16" band="1"><SimpleSource>
        <SourceFilename relativeToVRT="0">{}</SourceFilename><SourceBand>1</SourceBand>
        </SimpleSource></VRTRasterBand></VRTDataset>"#,
        fixture("jacksboro.tif")
    );
    fs::write(&vrt, text).expect("a VRT");
    let (oro, tif) = (inside(&dir, "a.oro"), inside(&dir, "a.tif"));
    Run::done(&["encode", &vrt, &oro]);
    assert_eq!(Run::done(&["info", &oro, "--json"]).json()["result"]["epoch"], 2021.3);
    Run::done(&["decode", &oro, &tif]);
    let again = inside(&dir, "b.oro");
    Run::done(&["encode", &tif, &again]);
    assert_eq!(Run::done(&["info", &again, "--json"]).json()["result"]["epoch"], 2021.3);
}

#[test]
fn masked_cells() {
    let (c, r) = (70, 66);
    let dir = folder();
    let [before, oro, after] = ["before.tif", "a.oro", "after.tif"].map(|name| inside(&dir, name));
    // An alpha band: cells where it is 0 have no data.
    let alpha: Vec<u16> = (0..c * r).map(|i| if i % 7 == 0 { 0 } else { 65535 }).collect();
    let raster = Raster {
        options: &[("ALPHA", "YES")],
        more: |dataset| {
            let mut band = dataset.rasterband(2).expect("a band");
            band.set_color_interpretation(ColorInterpretation::AlphaBand).expect("alpha");
        },
        ..Raster::new((c, r), vec![cells(c, r, |v| (v * 9000.0) as u16), alpha])
    };
    raster.write(&before);
    let run = Run::done(&["encode", &before, &oro]);
    run.expect(0, "band 2 is an alpha band");
    run.expect(0, "the mask of band 1 hides become nodata, with the value 65535");
    Run::done(&["decode", &oro, &after]);
    let (was, is) = (facts(&before), facts(&after));
    assert_eq!((is.bands.len(), is.bands[0].nodata), (1, Some(65535_f64.to_bits())));
    for (i, (was, is)) in was.bands[0].bits.iter().zip(&is.bands[0].bits).enumerate() {
        assert_eq!(*is, if i % 7 == 0 { 65535 } else { *was }, "cell {i}");
    }
    // Both bands named: nothing is masked, for alpha is there to say it.
    Run::done(&["encode", &before, &oro, "--overwrite", "--band", "1", "--band", "2"]);
    Run::done(&["decode", &oro, &after, "--overwrite"]);
    let is = facts(&after);
    assert_eq!((&is.bands[0].bits, &is.bands[1].bits), (&was.bands[0].bits, &was.bands[1].bits));
    // A cell that has the value that was chosen.
    let mut full = cells(c, r, |v| (v * 9000.0) as u16);
    full[100] = u16::MAX;
    let alpha = (0..c * r).map(|i| if i % 7 == 0 { 0 } else { 65535 }).collect();
    Raster { bands: vec![full, alpha], ..raster }.write(&before);
    Run::new(&["encode", &before, &oro, "--overwrite"]).expect(3, "name one that no cell has with --nodata");
    Run::done(&["encode", &before, &oro, "--overwrite", "--nodata", "64000"]);
}

#[test]
fn nodata_that_no_cell_can_have() {
    let dir = folder();
    let raster = Raster { nodata: Some(-9999.0), ..Raster::new((70, 66), vec![cells(70, 66, |v| (v * 255.0) as u8)]) };
    raster.write(&inside(&dir, "before.tif"));
    let oro = inside(&dir, "a.oro");
    Run::done(&["encode", &inside(&dir, "before.tif"), &oro]).expect(0, "nodata value -9999, which no cell of Byte");
    assert!(Run::done(&["info", &oro, "--json"]).json()["result"]["bands"][0]["nodata"].is_null());
    Run::new(&["encode", &inside(&dir, "before.tif"), &oro, "--nodata", "-1"])
        .expect(2, "is no value of its type, Byte");
}

/// Encodes a raster with the bound and returns the greatest difference of a cell that has data.
fn greatest_difference(dir: &TempDir, options: &[&str]) -> f64 {
    let (before, after) = there_and_back(dir, options);
    let value = |band: &super::rasters::BandFacts, bits: u64| match band.kind.as_str() {
        "Float32" => f64::from(f32::from_bits(bits as u32)),
        _ => bits as i64 as f64,
    };
    let (was, is) = (&before.bands[0], &after.bands[0]);
    let void = was.nodata.map(f64::from_bits);
    let mut greatest = 0.0_f64;
    for (&before, &after) in was.bits.iter().zip(&is.bits) {
        let (x, y) = (value(was, before), value(is, after));
        if x.is_nan() || Some(x) == void || y.is_nan() || Some(y) == void {
            assert_eq!(before, after, "voids come back, and nothing becomes one");
        } else {
            greatest = greatest.max((x - y).abs() * was.scale.unwrap_or(1.0));
        }
    }
    greatest
}

#[test]
fn greatest_errors() {
    let dir = folder();
    let before = inside(&dir, "before.tif");
    let mut band = cells(200, 150, |v| (v * 3000.0) as f32);
    band[77] = f32::NAN;
    band[78] = -9999.0;
    Raster { nodata: Some(-9999.0), ..Raster::new((200, 150), vec![band]) }.write(&before);
    let oro = inside(&dir, "a.oro");
    let run = Run::new(&["encode", &before, &oro]);
    run.expect(2, "band 1: its cells are Float32: say --max-error 0.1m");
    assert!(greatest_difference(&dir, &["--max-error", "0.5m"]) <= 0.5);
    assert!(greatest_difference(&dir, &["--max-error", "1ft"]) <= 0.3048);
    let document = Run::done(&["encode", &before, &oro, "--overwrite", "--max-error", "2", "--json"]).json();
    let band = &document["result"]["bands"][0];
    assert_eq!((&band["max_error"], &band["lossless"]), (&2.0.into(), &false.into()));
    assert!(band["largest_error"].as_f64().is_some_and(|found| (0.0..=2.0).contains(&found)));
    // Integers: whole steps of the scale.
    let raster = Raster {
        more: |dataset| dataset.rasterband(1).expect("a band").set_scale(0.1).expect("a scale"),
        ..Raster::new((200, 150), vec![cells(200, 150, |v| (v * 30000.0) as i16)])
    };
    raster.write(&before);
    assert!(greatest_difference(&dir, &["--max-error", "0.3m"]) <= 0.3 + 1e-9);
    let stored =
        |oro: &str| Run::done(&["info", oro, "--json"]).json()["result"]["bands"][0]["max_error_stored"].clone();
    assert_eq!(stored(&oro), 3.0);
    let run = Run::done(&["encode", &before, &oro, "--overwrite", "--max-error", "0.05m"]);
    run.expect(0, "less than one step of Int16 and its scale: lossless");
    assert!(stored(&oro).is_null());
    Run::new(&["encode", &before, &oro, "--overwrite", "--max-error", "0"]).expect(2, "--max-error 0");
    Run::new(&["encode", &before, &oro, "--overwrite", "--max-error", "1x"]).expect(2, "--max-error");
    Run::new(&["encode", &before, &oro, "--max-error", "1", "--lossless"]).expect(2, "cannot be used with");
}

#[test]
fn same_bytes_whatever_threads_and_memory() {
    let dir = folder();
    let before = inside(&dir, "before.tif");
    let bands = vec![cells(700, 500, |v| (v * 9000.0) as i16), cells(700, 500, |v| (v * 500.0) as i16)];
    Raster::new((700, 500), bands).write(&before);
    let encode = |name: &str, options: &[&str]| {
        let out = inside(&dir, name);
        Run::done(&[&["encode", &before, &out, "--tile-size", "64", "--max-error", "2m"], options].concat());
        fs::read(&out).expect("the container")
    };
    let one = encode("one.oro", &["-j", "1"]);
    assert!(one == encode("two.oro", &["-j", "2"]), "threads");
    assert!(one == encode("less.oro", &["-j", "2", "--memory", "98M"]), "memory");
    // Through a pipe too, and once more from the container itself.
    let run = Run::done(&["encode", &before, "-", "--tile-size", "64", "--max-error", "2m"]);
    assert!(one == run.output.stdout, "a pipe");
    let decode = |name: &str, options: &[&str]| {
        let out = inside(&dir, name);
        Run::done(&[&["decode", &inside(&dir, "one.oro"), &out], options].concat());
        fs::read(&out).expect("the raster")
    };
    let one = decode("one.tif", &["-j", "1"]);
    assert!(one == decode("two.tif", &["-j", "2"]), "threads");
    assert_eq!(facts(&inside(&dir, "one.tif")), {
        decode("less.tif", &["-j", "2", "--memory", "98M"]);
        facts(&inside(&dir, "less.tif"))
    });
}

#[test]
fn containers_as_inputs() {
    let dir = folder();
    let dem = fixture("jacksboro.tif");
    let [oro, again, csv, other] = ["a.oro", "again.oro", "a.csv", "b.csv"].map(|name| inside(&dir, name));
    Run::done(&["encode", &dem, &oro, "--tile-size", "128"]);
    Run::done(&["encode", &oro, &again, "--tile-size", "128"]);
    assert!(fs::read(&oro).expect("bytes") == fs::read(&again).expect("bytes"), "the same once more");
    Run::done(&["peaks", &oro, &csv, "--layers", "peaks", "--window", "100,50,200,250"]);
    Run::done(&["peaks", &dem, &other, "--layers", "peaks", "--window", "100,50,200,250"]);
    assert!(fs::read(&csv).expect("bytes") == fs::read(&other).expect("bytes"), "the same peaks");
    Run::done(&["stats", &oro, &dem]);
    Run::done(&["map", &oro, &inside(&dir, "a.png")]);
    Run::done(&["encode", &dem, &oro, "--overwrite", "--max-error", "5m"]);
    Run::done(&["peaks", &oro, &csv, "--overwrite", "--layers", "peaks"])
        .expect(0, "may be up to 5 m from the original's");
    Run::new(&["peaks", &oro, &csv, "--overwrite", "--memory", "1M"]).expect(3, "MiB of memory");
    Run::new(&["peaks", &oro, &csv, "--overwrite", "--band", "2"]).expect(2, "no band 2");
}

#[test]
fn parts_and_levels() {
    let dir = folder();
    let (cols, rows) = (330, 270);
    let band = cells(cols, rows, |v| (v * 9000.0) as i16);
    let before = inside(&dir, "before.tif");
    Raster::new((cols, rows), vec![band.clone()]).write(&before);
    let (oro, out) = (inside(&dir, "a.oro"), inside(&dir, "out.tif"));
    Run::done(&["encode", &before, &oro, "--tile-size", "64"]);
    let decoded = |options: &[&str]| {
        Run::done(&[&["decode", &oro, &out, "--overwrite"], options].concat());
        facts(&out)
    };
    for level in 0..=9_usize {
        let step = 1 << level;
        let found = decoded(&["--level", &level.to_string()]);
        let (w, h) = (cols.div_ceil(step), rows.div_ceil(step));
        assert_eq!(found.size, (w, h), "level {level}");
        let expected: Vec<u64> = (0..w * h).map(|i| band[i / w * step * cols + i % w * step] as u64).collect();
        assert!(found.bands[0].bits == expected, "level {level}");
        // The centre of the first pixel is that of the first cell.
        let t = found.transform.expect("a place").map(f64::from_bits);
        assert_eq!((t[0] + t[1] / 2.0, t[3] + t[5] / 2.0), (500_015.0, 5_199_985.0), "level {level}");
        assert_eq!(t[1], 30.0 * step as f64);
    }
    Run::new(&["decode", &oro, &out, "--overwrite", "--level", "10"]).expect(2, "levels 0 to 9");
    // A window is cut at full resolution, whatever the level.
    let found = decoded(&["--window", "101,30,100,50", "--level", "2"]);
    assert_eq!(found.size, (25, 12));
    assert_eq!(found.bands[0].bits[0], band[32 * cols + 104] as u64);
    let t = found.transform.expect("a place").map(f64::from_bits);
    assert_eq!((t[0] + t[1] / 2.0, t[3] + t[5] / 2.0), (500_000.0 + 104.5 * 30.0, 5_200_000.0 - 32.5 * 30.0));
    Run::new(&["decode", &oro, &out, "--overwrite", "--window", "1,1,2,2", "--level", "2"])
        .expect(2, "no cell of level 2");
    let found = decoded(&["--bbox", "500300,5199000,501000,5199700"]);
    let (left, top) = ((300 / 30), (300 / 30));
    assert_eq!(found.bands[0].bits[0], band[top * cols + left] as u64);
    // The same part, cut while it is encoded.
    let part = inside(&dir, "part.oro");
    Run::done(&["encode", &before, &part, "--bbox", "500300,5199000,501000,5199700"]);
    let same = inside(&dir, "same.tif");
    Run::done(&["decode", &part, &same]);
    assert_eq!(facts(&same), found);
    Run::new(&["decode", &oro, &out, "--overwrite", "--window", "0,0,9999,1"]).expect(2, "does not lie in the raster");
}

#[test]
fn bare_cells() {
    let dir = folder();
    let bands = vec![cells(150, 140, |v| (v * 9000.0) as i16), cells(150, 140, |v| (v * 100.0) as i16)];
    Raster::new((150, 140), bands.clone()).write(&inside(&dir, "before.tif"));
    let oro = inside(&dir, "a.oro");
    Run::done(&["encode", &inside(&dir, "before.tif"), &oro, "--tile-size", "64"]);
    let expected: Vec<u8> = bands.concat().iter().flat_map(|cell| cell.to_le_bytes()).collect();
    let run = Run::done(&["decode", &oro, "-", "--of", "raw"]);
    assert!(run.output.stdout == expected, "both bands, row by row");
    let raw = inside(&dir, "a.bin");
    Run::done(&["decode", &oro, &raw, "--of", "raw", "--memory", "98M"]);
    assert!(fs::read(&raw).expect("bytes") == expected, "to a file");
    Run::new(&["decode", &oro, "-"]).expect(2, "give --of raw");
    Run::new(&["decode", &oro, "-", "--of", "raw", "--json"]).expect(2, "--json and the output -");
    // Whoever closes a pipe has read enough.
    for arguments in [&["decode", &oro, "-", "--of", "raw"][..], &["encode", &inside(&dir, "before.tif"), "-"]] {
        let mut command = Command::new(PROGRAM);
        command.args(arguments).stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
        let mut child = command.spawn().expect("the program starts");
        let mut first = [0; 10];
        child.stdout.take().expect("a pipe").read_exact(&mut first).expect("bytes");
        let output = child.wait_with_output().expect("the program ends");
        let said = String::from_utf8_lossy(&output.stderr);
        assert_eq!((output.status.code(), &*said), (Some(0), ""), "{arguments:?}");
    }
}

#[test]
fn other_formats() {
    let dir = folder();
    Raster::new((60, 50), vec![cells(60, 50, |v| (v * 9000.0) as i16)]).write(&inside(&dir, "before.tif"));
    let oro = inside(&dir, "a.oro");
    Run::done(&["encode", &inside(&dir, "before.tif"), &oro]);
    let bits = facts(&inside(&dir, "before.tif")).bands[0].bits.clone();
    for (name, companions, options) in [
        ("a.asc", &["a.asc.aux.xml", "a.prj"][..], &[][..]),
        ("i.img", &["i.img.aux.xml"], &[]),
        ("e.bil", &["e.bil.aux.xml", "e.hdr", "e.prj"], &[]),
        ("n.dat", &["n.dat.aux.xml", "n.hdr"], &["--of", "ENVI"]),
        ("cog.tif", &[], &["--of", "COG", "--co", "COMPRESS=LZW"]),
    ] {
        let before = listing(dir.path());
        let out = inside(&dir, name);
        let run = Run::done(&[&["decode", &oro, &out, "--json"], options].concat());
        assert_eq!(facts(&out).bands[0].bits, bits, "{name}");
        let mut new: Vec<String> = listing(dir.path()).into_iter().filter(|file| !before.contains(file)).collect();
        new.retain(|file| file != name);
        assert!(new.iter().all(|file| companions.contains(&file.as_str())), "{name}: {new:?}");
        assert_eq!(run.json()["outputs"].as_array().map(Vec::len), Some(new.len() + 1), "{name}");
    }
    for (name, options, code, words) in [
        ("a.png", &[][..], 3, "the format PNG holds no cells of Int16, but Byte UInt16"),
        ("a.nonsense", &[], 2, "name one with --of"),
        ("a", &[], 2, "name one with --of"),
        ("a.vrt", &[], 2, "VRT is no format"),
        ("b.tif", &["--of", "Nonsense"], 2, "no such format"),
        ("b.tif", &["--co", "COMPRESS"], 2, "expected KEY=VALUE"),
        ("b.oro", &[], 2, "name one with --of"),
    ] {
        let before = listing(dir.path());
        let run = Run::new(&[&["decode", &oro, &inside(&dir, name)], options].concat());
        run.expect(code, words);
        run.check(listing(dir.path()) == before, "the folder as it was");
    }
    if DriverManager::get_driver_by_name("PNG").is_ok() {
        Raster::new((60, 50), vec![cells(60, 50, |v| (v * 65535.0) as u16)]).write(&inside(&dir, "u16.tif"));
        Run::done(&["encode", &inside(&dir, "u16.tif"), &oro, "--overwrite"]);
        Run::done(&["decode", &oro, &inside(&dir, "a.png")]);
        assert_eq!(facts(&inside(&dir, "a.png")).bands[0].bits, facts(&inside(&dir, "u16.tif")).bands[0].bits);
    }
}

#[test]
fn formats_that_lose() {
    let dir = folder();
    let oro = inside(&dir, "a.oro");
    Raster::new((90, 80), vec![cells(90, 80, |v| (v * 250.0) as u8)]).write(&inside(&dir, "u8.tif"));
    Run::done(&["encode", &inside(&dir, "u8.tif"), &oro]);
    let words = "does not keep these cells: ";
    let said = |name: &str, options: &[&str]| {
        let out = inside(&dir, name);
        let run = Run::done(&[&["decode", &oro, &out, "--overwrite"], options].concat());
        run.stderr()
    };
    let is_there = |name: &str| DriverManager::get_driver_by_name(name).is_ok();
    if is_there("JPEG") {
        assert!(said("a.jpg", &[]).contains(&format!("the format JPEG {words}")), "JPEG");
        assert!(said("a.tif", &["--co", "COMPRESS=JPEG"]).contains(words), "GeoTIFF with JPEG");
    }
    if is_there("JP2OpenJPEG") {
        assert!(said("a.jp2", &[]).contains(words), "JPEG 2000");
        assert_eq!(said("a.jp2", &["--co", "QUALITY=100", "--co", "REVERSIBLE=YES"]), "", "JPEG 2000, reversible");
    }
    for name in ["a.tif", "a.png", "a.img", "a.asc"] {
        assert!(!said(name, &[]).contains(words), "{name}");
    }
    // A type that the format turns into another unasked.
    Raster::new((90, 80), vec![cells(90, 80, |v| v * 1000.0)]).write(&inside(&dir, "f64.tif"));
    Run::done(&["encode", &inside(&dir, "f64.tif"), &oro, "--overwrite", "--lossless"]);
    assert!(said("a.xyz", &[]).contains(words), "numbers as short texts");
}
