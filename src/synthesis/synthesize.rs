//! From statistics to a divide tree.

use super::cast::Role;
use super::controls::{Controls, Weights};
use super::extent::Extent;
use super::grow::{Edge, grow};
use super::ridges::ridges;
use super::roles::roles;
use super::saddles::saddles;
use super::strata::apportion;
use super::target::Target;
use super::throw::throw;
use crate::crs::{Metric, Place};
use crate::error::{Error, ErrorKind, Result};
use crate::grid::Cell;
use crate::orometry::{GivenPass, GivenTree};
use crate::rng::Rng;
use crate::watch::Watch;

/// How to synthesise.
#[derive(Clone, Debug)]
pub struct SynthesisOptions {
    /// Equal seeds give equal trees.
    pub seed: u64,
    /// The exponent rho of the paper's equation 1: 0 joins peaks by short ridges, 1 and 2 by higher ones.
    pub ridge_exponent: u8,
}

impl Default for SynthesisOptions {
    fn default() -> Self {
        Self { seed: 0, ridge_exponent: 1 }
    }
}

/// A tree made from statistics.
#[derive(Clone, Debug)]
pub struct Synthesis {
    /// The tree, its peaks from the highest to the lowest.
    pub tree: GivenTree,
    /// For each peak the position of the range that it is like.
    pub kinds: Vec<usize>,
    /// For each peak its position among the kept ones, if it is one.
    pub kept: Vec<Option<u32>>,
    /// For each pass the position of the kept ridge that it is on, if it is on one.
    pub kept_passes: Vec<Option<u32>>,
    /// New peaks that found no room at the isolation that was drawn for them.
    pub misplaced: usize,
    /// New peaks that could not have a prominence that was drawn.
    pub misjudged: usize,
    /// Kept peaks with another prominence than in the tree that they come from.
    pub altered: usize,
}

/// How many new peaks like those of each range an extent is to have: by the ranges' densities, or `asked` in all, in the
/// proportions that the densities give. Kept peaks are among those that are asked for; among those of the density they
/// are where no part of the extent is kept as it is.
///
/// # Errors
/// As [`synthesize`]; more peaks that are kept than are asked for.
pub fn peak_counts<M: Metric + ?Sized>(
    extent: &Extent<'_, M>,
    targets: &[&Target],
    controls: &Controls,
    asked: Option<usize>,
) -> Result<Vec<usize>> {
    let weights = Weights::new(extent, controls, targets)?;
    let area_km2 = extent.area_km2();
    let count = |(kind, target): (usize, &&Target)| target.count_on(area_km2 * weights.share(kind));
    let counts: Vec<usize> = targets.iter().enumerate().map(count).collect();
    let kept = &controls.kept;
    let asked = match asked {
        None if kept.is_empty() || kept.within.is_some() => return Ok(counts),
        None => counts.iter().sum::<usize>().saturating_sub(kept.peaks.len()),
        Some(asked) if asked < kept.peaks.len() => {
            let message = format!("--peaks {asked} is fewer than the {} peaks that are kept", kept.peaks.len());
            return Err(Error::usage(message));
        }
        Some(asked) => asked - kept.peaks.len(),
    };
    let mut shares: Vec<u64> = counts.iter().map(|&count| count as u64).collect();
    if shares.iter().all(|&share| share == 0) {
        // So small a land has no peak by density; the first range gives those that are asked for.
        shares.iter_mut().take(1).for_each(|share| *share = 1);
    }
    Ok(apportion(&shares, asked))
}

/// Makes a divide tree of peaks like those of some ranges, `counts` of each, beside those that are kept.
///
/// Kept peaks and ridges are among the tree's, each where it is. A kept peak has the prominence that it has in its own
/// tree where that is decided by what is kept, and else where another ridge allows it.
///
/// What is made depends on the arguments alone.
///
/// # Errors
/// No peaks at all; maps that leave no room; more peaks and saddles than the extent has room for; an interrupt.
///
/// # Complexity
/// About `n log n` in the number of peaks.
pub fn synthesize<M: Metric + ?Sized>(
    extent: &Extent<'_, M>,
    targets: &[&Target],
    counts: &[usize],
    controls: &Controls,
    options: &SynthesisOptions,
    watch: &Watch,
) -> Result<Synthesis> {
    let kept = &controls.kept;
    let count: usize = counts.iter().sum::<usize>() + kept.peaks.len();
    if count == 0 {
        return Err(Error::usage("there would be no peaks: give a larger extent, or a number of them with --peaks"));
    }
    let (rows, cols) = extent.size();
    // A peak needs a cell, and so does its saddle.
    if 2 * count as u64 > rows as u64 * cols as u64 {
        return Err(Error::usage(format!(
            "{count} peaks and their saddles have no room on {cols} x {rows} cells: give fewer with --peaks, or a finer --resolution"
        )));
    }
    kept.check(rows, cols)?;
    let is_cast = |kind: usize| counts[kind] > 0 || !kept.is_empty();
    if let Some(kind) = (0..targets.len()).find(|&kind| is_cast(kind) && targets[kind].isolation.total() == 0)
        && count > 1
    {
        let peaks = targets[kind].peak_count;
        return Err(Error::new(
            ErrorKind::Input,
            format!("{peaks} peak without any isolation does not say how far {count} are to be from each other"),
        ));
    }
    watch.begin("casting peaks", 0);
    let weights = Weights::new(extent, controls, targets)?;
    let part = |part: u64| Rng::for_part(options.seed, part);
    let roles = roles(targets, counts, kept, &weights, &part);
    let thrown = throw(targets, roles, extent, &weights, &mut part(0), watch)?;
    let (mut roles, places) = (thrown.roles, thrown.places);
    watch.begin("joining peaks", 0);
    let elevations_m: Vec<f64> = roles.iter().map(|role| role.elevation_m).collect();
    let mut numbers = vec![0; kept.peaks.len()];
    let fixed = |role: &Role| role.kept.map(|kept| kept.number);
    for (number, kept) in (0..).zip(roles.iter().map(fixed)) {
        kept.into_iter().for_each(|kept| numbers[kept as usize] = number);
    }
    let web = ridges(extent, &places, &elevations_m, options.ridge_exponent, (kept, &numbers))?;
    let grown = grow(&mut roles, &web.ridges, targets);
    watch.check()?;
    let cells = saddles(extent, &elevations_m, &grown.edges, &web, kept, &mut part(1))?;
    let pass = |(edge, cell): (&Edge, Cell)| {
        let ridge = &web.ridges[edge.ridge as usize];
        let cells = |places: &[Place]| places.iter().map(|&place| extent.cell(place)).collect();
        let bends = match ridge.kept {
            None => ridge.joints.map(|joint| cells(&web.way(joint, kept))),
            Some(number) => {
                let peaks = kept.ridges[number as usize].peaks;
                let is_turned = numbers[peaks[0] as usize] != ridge.ends[0];
                [is_turned, !is_turned].map(|side| {
                    let line = kept.line(number as usize, usize::from(side));
                    cells(&line[1..line.len() - 1])
                })
            }
        };
        GivenPass { peaks: ridge.ends, cell, elevation_m: edge.saddle_m, bends }
    };
    let passes = grown.edges.iter().zip(cells).map(pass).collect();
    let peaks = places.iter().zip(&elevations_m).map(|(&place, &elevation_m)| (extent.cell(place), elevation_m));
    let tree = GivenTree { rows, cols, peaks: peaks.collect(), passes };
    let is_other = |role: &&Role| {
        let own = fixed(role).and_then(|number| kept.peaks[number as usize].prominence_m);
        own.is_some_and(|own_m| own_m != role.prominence_m)
    };
    Ok(Synthesis {
        tree,
        kinds: roles.iter().map(|role| role.kind).collect(),
        kept: roles.iter().map(fixed).collect(),
        kept_passes: grown.edges.iter().map(|edge| web.ridges[edge.ridge as usize].kept).collect(),
        misplaced: thrown.misplaced,
        misjudged: grown.missed,
        altered: roles.iter().filter(is_other).count(),
    })
}
