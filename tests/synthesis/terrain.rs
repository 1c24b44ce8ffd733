//! Terrain keeps its tree: what a survey of the terrain finds is what it was raised on.

use super::range::cells;
use orograph::grid::{AnyGrid, Cell, Elevations, Grid, Key, SampleType};
use orograph::noise::{NoiseKind, NoiseSum, Sample, Spectrum};
use orograph::orometry::{GivenPass, GivenTree, Survey, SurveyOptions, survey};
use orograph::synthesis::terrain::{
    Form, FormMap, Free, Ground, Likeness, RidgeLine, Skeleton, Spot, TerrainOptions, fit, raise,
};
use orograph::watch::Watch;
use proptest::prelude::*;

const CELL_M: f64 = 50.0;

/// Hills of 64 to 16 cells, some 500 m high.
fn hills(rows: usize, cols: usize, seed: u64) -> Vec<f32> {
    let spectrum =
        Spectrum { octaves: 3, amplitude: 400.0, wavelength: 64.0, persistence: 0.45, lacunarity: 2.0, seed };
    let noise = NoiseSum::new(NoiseKind::Fractal, spectrum.terms()).with_base(900.0);
    let at = |cell: usize| noise.at((cell % cols) as f64, (cell / cols) as f64, Sample::default()).value as f32;
    (0..rows * cols).map(at).collect()
}

fn surveyed(z_m: &[f32], rows: usize, cols: usize, threshold_m: f64) -> Survey {
    let elevations = Elevations::metres(SampleType::F32);
    let keys = z_m.iter().map(|&z| Key::from_i64(elevations.key_of(z))).collect();
    let grid = AnyGrid::Middle(Grid::new(rows, cols, false, keys));
    let options = SurveyOptions { min_prominence_m: threshold_m, isolation: false, ..SurveyOptions::default() };
    survey(&grid, &elevations, &cells(CELL_M), &options, &Watch::default()).expect("a survey")
}

/// The tree of a survey, with its lines.
fn skeleton(survey: &Survey, rows: usize, cols: usize) -> Skeleton {
    let spot =
        |cell: Cell, elevation_m: f64| Spot { row: cell as usize / cols, col: cell as usize % cols, elevation_m };
    let position = |id: u32| survey.peaks.iter().position(|peak| peak.id == id).expect("a peak") as u32;
    let mut made = Skeleton {
        size: [rows, cols],
        cell_m: [CELL_M; 2],
        peaks: survey.peaks.iter().map(|peak| spot(peak.cell, peak.elevation_m)).collect(),
        saddles: vec![],
        ridges: vec![],
    };
    for edge in &survey.edges {
        let at = edge.path.iter().position(|&cell| cell == edge.saddle_cell).expect("the saddle is on its line");
        let saddle = made.saddles.len() as u32;
        made.saddles.push(spot(edge.saddle_cell, edge.saddle_elevation_m));
        let points = |part: &mut dyn Iterator<Item = &Cell>| -> Vec<[f64; 2]> {
            part.map(|&cell| [(cell as usize % cols) as f64, (cell as usize / cols) as f64]).collect()
        };
        let back = points(&mut edge.path[..=at].iter().rev());
        let on = points(&mut edge.path[at..].iter());
        made.ridges.push(RidgeLine { saddle, peak: position(edge.peak_a), points: back });
        made.ridges.push(RidgeLine { saddle, peak: position(edge.peak_b), points: on });
    }
    made
}

/// Cells and prominences of the peaks, and elevations of their key saddles.
fn told(survey: &Survey) -> Vec<(Cell, f64, Option<f64>)> {
    let mut told: Vec<(Cell, f64, Option<f64>)> = survey
        .peaks
        .iter()
        .map(|peak| (peak.cell, peak.elevation_m, peak.key_saddle.map(|saddle| saddle.elevation_m)))
        .collect();
    told.sort_by_key(|peak| peak.0);
    told
}

proptest! {
    #![proptest_config(super::cases(48))]

    /// Without detail the terrain has the peaks of the tree, and no other; their key saddles are as high.
    #[test]
    fn the_tree_of_hills(
        rows in 24..90_usize,
        cols in 24..90_usize,
        seed: u64,
        slope in 0.3..0.9_f64,
        erosion in prop_oneof![Just(0.0), 0.0..2.0_f64],
    ) {
        let threshold_m = 60.0;
        let real = surveyed(&hills(rows, cols, seed), rows, cols, threshold_m);
        prop_assume!(real.peaks.len() > 1);
        let options = TerrainOptions { erosion, floor_m: -500.0, ..formed(Form { slope, roughness: 0.0, ..Form::default() }) };
        let raised = raise(&skeleton(&real, rows, cols), &options, &Watch::default()).expect("terrain");
        prop_assert_eq!(&raised.crossings, &Vec::<[u32; 2]>::new());
        let found = surveyed(raised.relief.z_m(), rows, cols, threshold_m);
        let (found, wanted) = (told(&found), told(&real));
        for peak in &wanted {
            prop_assert!(found.contains(peak), "{:?} is not among {:?}", peak, found);
        }
        // The border may show a slope as a peak of its own: few, and never among the wanted.
        prop_assert!(found.len() <= wanted.len() + wanted.len() / 8 + 1, "{:?} for {:?}", found, wanted);
    }

    /// Nothing holds water between the ridges, whatever the detail, and the elevations of the tree stay.
    #[test]
    fn peaks_and_saddles_stay(
        rows in 10..60_usize,
        cols in 10..60_usize,
        seed: u64,
        roughness in 0.0..0.4_f64,
        erosion in prop_oneof![Just(0.0), 0.0..4.0_f64],
    ) {
        let real = surveyed(&hills(rows, cols, seed), rows, cols, 30.0);
        let skeleton = skeleton(&real, rows, cols);
        let ground = Some(Ground { size: [1, 1], z_m: vec![850.0] });
        let options = TerrainOptions { erosion, ground, seed, ..formed(Form { roughness, ..Form::default() }) };
        let raised = raise(&skeleton, &options, &Watch::default()).expect("terrain");
        prop_assert!(raised.relief.z_m().iter().all(|z| z.is_finite()));
        for spot in skeleton.peaks.iter().chain(&skeleton.saddles) {
            prop_assert_eq!(raised.relief.z_m()[spot.row * cols + spot.col], spot.elevation_m as f32);
        }
        prop_assert_eq!(&raised.relief, &raise(&skeleton, &options, &Watch::default()).expect("again").relief);
    }
}

#[test]
fn the_same_whatever_the_threads() {
    let real = surveyed(&hills(120, 150, 4), 120, 150, 50.0);
    let skeleton = skeleton(&real, 120, 150);
    let with = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        let options = TerrainOptions { erosion: 1.0, ..TerrainOptions::default() };
        pool.install(|| raise(&skeleton, &options, &Watch::default()).expect("terrain").relief)
    };
    assert_eq!(with(1), with(3));
}

#[test]
fn what_is_chosen_is_more_like_the_range() {
    let (rows, cols) = (160, 140);
    let z_m = hills(rows, cols, 11);
    let skeleton = skeleton(&surveyed(&z_m, rows, cols, 40.0), rows, cols);
    let like = Likeness::of(&z_m, [rows, cols], [CELL_M; 2], CELL_M);
    let apart = |options: &TerrainOptions| {
        let z_m = raise(&skeleton, options, &Watch::default()).expect("terrain").relief.into_z_m();
        Likeness::of(&z_m, [rows, cols], [CELL_M; 2], CELL_M).distance(&like)
    };
    let ground = Some(Ground::of(&z_m, [rows, cols], [8, 7]));
    let usual = TerrainOptions { ground, ..formed(Form { roughness: 0.07, slope: 0.9, ..Form::default() }) };
    let all = Free { slope: true, roughness: true, curvature: true };
    let chosen = fit(&skeleton, &usual, all, &[Some(&like)], &Watch::default()).expect("options");
    assert!(apart(&chosen) < 0.8 * apart(&usual), "{} and {} degrees", apart(&chosen), apart(&usual));
    // What is not free stays; what must be known of the ground is not touched.
    let fixed = Free { roughness: false, ..all };
    let kept = fit(&skeleton, &usual, fixed, &[Some(&like)], &Watch::default()).expect("options");
    assert_eq!((kept.forms[0].roughness, &kept.ground), (0.07, &usual.ground));
    assert_ne!(kept.forms[0].slope, usual.forms[0].slope);
}

/// Options with one form everywhere.
fn formed(form: Form) -> TerrainOptions {
    TerrainOptions { forms: vec![form], ..TerrainOptions::default() }
}

/// West and east of a raster, the other half being void.
fn halves(z_m: &[f32], cols: usize) -> [Vec<f32>; 2] {
    [true, false].map(|is_west| {
        let own = |(cell, &z): (usize, &f32)| if (cell % cols < cols / 2) == is_west { z } else { f32::NAN };
        z_m.iter().enumerate().map(own).collect()
    })
}

#[test]
fn each_part_is_formed_like_its_range() {
    let (rows, cols) = (160, 240);
    // Four times as high in the west as in the east.
    let steep = |(cell, &z): (usize, &f32)| if cell % cols < cols / 2 { 4.0 * z } else { z };
    let z_m: Vec<f32> = hills(rows, cols, 11).iter().enumerate().map(steep).collect();
    let skeleton = skeleton(&surveyed(&z_m, rows, cols, 40.0), rows, cols);
    let kinds: Vec<usize> = skeleton.peaks.iter().map(|peak| usize::from(peak.col >= cols / 2)).collect();
    let likes = halves(&z_m, cols).map(|half| Likeness::of(&half, [rows, cols], [CELL_M; 2], CELL_M));
    let form = Form { roughness: 0.05, ..Form::default() };
    let map = FormMap::of_peaks(&skeleton, &kinds);
    let ground = Some(Ground::of(&z_m, [rows, cols], [8, 12]));
    let usual = TerrainOptions { forms: vec![form; 2], form_map: Some(map), ground, ..TerrainOptions::default() };
    let terrain = |options: &TerrainOptions| raise(&skeleton, options, &Watch::default()).expect("terrain").relief;
    let one = TerrainOptions { form_map: None, ..usual.clone() };
    assert_eq!(terrain(&usual), terrain(&one), "a form in two parts is one form");
    let free = Free { slope: true, roughness: true, curvature: true };
    let chosen = fit(&skeleton, &usual, free, &[Some(&likes[0]), Some(&likes[1])], &Watch::default()).expect("options");
    assert!(chosen.forms[0].slope > 1.5 * chosen.forms[1].slope, "{:?}", chosen.forms);
    let apart = |options: &TerrainOptions| {
        let halves = halves(&terrain(options).into_z_m(), cols);
        let of = |half: &Vec<f32>| Likeness::of(half, [rows, cols], [CELL_M; 2], CELL_M);
        [0, 1].map(|half| of(&halves[half]).distance(&likes[half]))
    };
    // Like the west everywhere, the east is too steep.
    let west = fit(&skeleton, &one, free, &[Some(&likes[0]), None], &Watch::default()).expect("options");
    let (both, west) = (apart(&chosen), apart(&TerrainOptions { form_map: None, ..west }));
    assert!(both[1] < 0.8 * west[1], "{both:?} and {west:?} degrees");
    // A form without a range stays.
    let half = fit(&skeleton, &usual, free, &[None, Some(&likes[1])], &Watch::default()).expect("options");
    assert_eq!(half.forms[0], form);
}

#[test]
fn a_tree_of_one_peak_and_one_on_a_single_cell() {
    for size in [[1, 1], [1, 9], [9, 1], [5, 5]] {
        let peak = Spot { row: size[0] / 2, col: size[1] / 2, elevation_m: 500.0 };
        let skeleton = Skeleton { size, cell_m: [30.0; 2], peaks: vec![peak], saddles: vec![], ridges: vec![] };
        let raised = raise(&skeleton, &TerrainOptions::default(), &Watch::default()).expect("terrain");
        let top = raised.relief.z_m()[peak.row * size[1] + peak.col];
        assert_eq!(top, 500.0);
        assert!(raised.relief.z_m().iter().all(|&z| z.is_finite() && z <= top), "{size:?}");
    }
}

#[test]
fn a_bent_tree_without_lines() {
    let cell = |row: u64, col: u64| row * 200 + col;
    let tree = GivenTree {
        rows: 150,
        cols: 200,
        peaks: vec![(cell(40, 40), 1200.0), (cell(100, 90), 1100.0), (cell(50, 160), 1000.0)],
        passes: vec![
            GivenPass::straight([0, 1], cell(70, 60), 800.0),
            GivenPass::straight([1, 2], cell(70, 130), 700.0),
        ],
    };
    let skeleton = Skeleton::of_tree(&tree, &|_| false, [CELL_M; 2], 7);
    assert_ne!(skeleton.ridges, Skeleton::of_tree(&tree, &|_| false, [CELL_M; 2], 8).ridges, "the seed bends them");
    for ridge in &skeleton.ridges {
        let spot = &skeleton.saddles[ridge.saddle as usize];
        let top = &skeleton.peaks[ridge.peak as usize];
        assert_eq!(ridge.points.first(), Some(&[spot.col as f64, spot.row as f64]));
        let last = ridge.points.last().expect("points");
        assert!((last[0] - top.col as f64).abs() < 1e-9 && (last[1] - top.row as f64).abs() < 1e-9);
    }
    let options = TerrainOptions { floor_m: 300.0, ..formed(Form { roughness: 0.05, ..Form::default() }) };
    let raised = raise(&skeleton, &options, &Watch::default()).expect("terrain");
    let found = told(&surveyed(raised.relief.z_m(), 150, 200, 100.0));
    let wanted =
        vec![(cell(40, 40), 1200.0, None), (cell(50, 160), 1000.0, Some(700.0)), (cell(100, 90), 1100.0, Some(800.0))];
    assert_eq!(found, wanted);
}

#[test]
fn faults_have_names() {
    let spot = |row, elevation_m| Spot { row, col: 1, elevation_m };
    let sound = Skeleton {
        size: [9, 3],
        cell_m: [30.0; 2],
        peaks: vec![spot(1, 50.0), spot(7, 60.0)],
        saddles: vec![spot(4, 40.0)],
        ridges: vec![
            RidgeLine { saddle: 0, peak: 0, points: vec![[1.0, 4.0], [1.0, 1.0]] },
            RidgeLine { saddle: 0, peak: 1, points: vec![[1.0, 4.0], [1.0, 7.0]] },
        ],
    };
    let refused = |change: fn(&mut Skeleton), words: &str| {
        let mut faulty = sound.clone();
        change(&mut faulty);
        let error = raise(&faulty, &TerrainOptions::default(), &Watch::default()).expect_err(words).to_string();
        assert!(error.contains(words), "{error}");
    };
    raise(&sound, &TerrainOptions::default(), &Watch::default()).expect("terrain");
    refused(|s| s.peaks[0].row = 9, "peak of 50 m at row 9");
    refused(|s| s.saddles[0].elevation_m = f64::NAN, "saddle of NaN m");
    refused(|s| s.saddles[0].elevation_m = 55.0, "above its peak");
    refused(|s| s.ridges[1].peak = 2, "not there");
}
