//! What is made is a tree, and its measures are right.

use super::{cases, range, reference};
use orograph::error::ErrorKind;
use orograph::grid::{AnyGrid, Elevations, Grid, SampleType};
use orograph::orometry::{GivenPass, GivenTree, SurveyOptions, survey, survey_tree};
use orograph::synthesis::{Controls, Extent, Synthesis, SynthesisOptions, synthesize};
use orograph::watch::Watch;
use proptest::prelude::*;

proptest! {
    #![proptest_config(cases(150))]

    #[test]
    fn trees_are_measured_as_the_reference_does(
        peaks in range::any(),
        count in 1..90_usize,
        (rows, cols) in (8..300_usize, 8..300_usize),
        cell_m in 10.0..200.0_f64,
        (seed, ridge_exponent) in (any::<u64>(), 0..3_u8),
    ) {
        let domain = range::domain(&peaks, 100.0);
        let target = range::target(&domain);
        let metric = range::cells(cell_m);
        let extent = Extent::new(rows, cols, &metric);
        let options = SynthesisOptions { seed, ridge_exponent };
        let make = || synthesize(&extent, &[&target], &[count], &Controls::default(), &options, &Watch::default());
        let Synthesis { tree, kinds, .. } = match make() {
            Ok(made) => made,
            Err(error) => {
                // So many peaks may find no room on so little land; nothing else may go wrong.
                prop_assert!(error.to_string().contains("room"), "{error}");
                return Ok(());
            }
        };
        prop_assert_eq!((tree.peaks.len(), tree.passes.len(), kinds.len()), (count, count - 1, count));
        tree.check().expect("a tree");
        prop_assert_eq!(&make().expect("as before").tree, &tree, "the same seed");
        let found = survey_tree(&tree, &metric).expect("a survey");
        let prominences_m = reference::prominences_m(&tree);
        let isolations_m = reference::isolations_m(&tree, &metric);
        prop_assert_eq!(found.peaks.len(), count);
        for (i, (cell, elevation_m)) in tree.peaks.iter().enumerate() {
            let peak = found.peaks.iter().find(|peak| peak.cell == *cell).expect("every peak");
            prop_assert_eq!(peak.elevation_m, *elevation_m);
            prop_assert_eq!(peak.prominence_m, prominences_m[i]);
            prop_assert_eq!(peak.isolation.and_then(|isolation| isolation.isolation_m), isolations_m[i]);
            prop_assert!(count < 3 || peak.is_root || peak.prominence_m > 0.0);
        }
    }

    /// The tree of a raster, given back as it was found, has the same peaks.
    #[test]
    fn a_given_tree_is_that_of_the_raster(rows in 2..14_usize, cols in 2..14_usize, seed in any::<u64>()) {
        let mut cells: Vec<i16> = (1..=(rows * cols) as i16).collect();
        orograph::rng::Rng::new(seed).shuffle(&mut cells);
        let grid = AnyGrid::Narrow(Grid::new(rows, cols, false, cells));
        let elevations = Elevations::metres(SampleType::I16);
        let metric = range::cells(10.0);
        let options = SurveyOptions { min_prominence_m: 0.0, ..SurveyOptions::default() };
        let truth = survey(&grid, &elevations, &metric, &options, &Watch::default()).expect("a survey");
        let mut saddles: Vec<u64> = truth.edges.iter().map(|edge| edge.saddle_cell).collect();
        saddles.sort_unstable();
        saddles.dedup();
        // Where three ridges meet at one saddle the tree cannot be given.
        prop_assume!(saddles.len() == truth.edges.len());
        let pass = |edge: &orograph::orometry::TreeEdge| {
            GivenPass::straight([edge.peak_a - 1, edge.peak_b - 1], edge.saddle_cell, edge.saddle_elevation_m)
        };
        let tree = GivenTree {
            cols,
            rows,
            peaks: truth.peaks.iter().map(|peak| (peak.cell, peak.elevation_m)).collect(),
            passes: truth.edges.iter().map(pass).collect(),
        };
        let found = survey_tree(&tree, &metric).expect("a tree");
        prop_assert_eq!(found.peaks.len(), truth.peaks.len());
        for (found, truth) in found.peaks.iter().zip(&truth.peaks) {
            let row = |peak: &orograph::orometry::Peak| (
                peak.id, peak.cell, peak.prominence_m, peak.is_root, peak.key_saddle.map(|saddle| saddle.cell),
                peak.island_parent, peak.prominence_parent, peak.line_parent, peak.relevance,
            );
            prop_assert_eq!(row(found), row(truth));
        }
        for (found, truth) in found.edges.iter().zip(&truth.edges) {
            let ends = |edge: &orograph::orometry::TreeEdge| (edge.saddle, edge.saddle_cell, edge.peak_a.min(edge.peak_b), edge.peak_a.max(edge.peak_b));
            prop_assert_eq!(ends(found), ends(truth));
        }
    }
}

#[test]
fn what_is_no_tree_is_refused() {
    let pass = GivenPass::straight;
    let good = GivenTree {
        cols: 10,
        rows: 10,
        peaks: vec![(3, 90.0), (40, 70.0), (77, 80.0)],
        passes: vec![pass([0, 1], 20, 60.0), pass([1, 2], 55, 65.0)],
    };
    good.check().expect("a tree");
    let with = |change: &dyn Fn(&mut GivenTree)| {
        let mut tree = good.clone();
        change(&mut tree);
        tree
    };
    for (tree, words) in [
        (with(&|tree| tree.passes.truncate(1)), "3 peaks and 1 saddles"),
        (with(&|tree| tree.passes[1] = pass([1, 0], 55, 50.0)), "close a ring"),
        (with(&|tree| tree.passes[1].peaks = [1, 3]), "not there"),
        (with(&|tree| tree.passes[1].elevation_m = 70.0), "not below its peaks"),
        (with(&|tree| tree.passes[1].elevation_m = f64::NAN), "not below its peaks"),
        (with(&|tree| tree.passes[1].cell = 3), "in cell 3"),
        (with(&|tree| tree.peaks[2].0 = 100), "outside"),
        (with(&|tree| tree.peaks[2].1 = f64::INFINITY), "not the elevation"),
    ] {
        let error = survey_tree(&tree, &range::cells(1.0)).expect_err("no tree");
        assert!(error.kind() == ErrorKind::Corrupt && error.to_string().contains(words), "{error}");
    }
}
