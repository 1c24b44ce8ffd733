//! From statistics to a divide tree.

use super::cast::{Role, STEP_M, cast, stepped};
use super::controls::{Controls, Weights};
use super::extent::Extent;
use super::grow::grow;
use super::ridges::ridges;
use super::saddles::saddles;
use super::strata::apportion;
use super::target::Target;
use super::throw::throw;
use crate::crs::Metric;
use crate::error::{Error, ErrorKind, Result};
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
    /// Peaks that found no room at the isolation that was drawn for them.
    pub misplaced: usize,
    /// Peaks that could not have a prominence that was drawn.
    pub misjudged: usize,
}

/// How many peaks like those of each range an extent is to have: by the ranges' densities, or `asked` in all, in the
/// proportions that the densities give.
///
/// # Errors
/// As [`synthesize`].
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
    let Some(asked) = asked else { return Ok(counts) };
    let mut shares: Vec<u64> = counts.iter().map(|&count| count as u64).collect();
    if shares.iter().all(|&share| share == 0) {
        // So small a land has no peak by density; the first range gives those that are asked for.
        shares.iter_mut().take(1).for_each(|share| *share = 1);
    }
    Ok(apportion(&shares, asked))
}

/// Makes a divide tree of peaks like those of some ranges, `counts` of each.
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
    let count: usize = counts.iter().sum();
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
    if let Some(kind) = (0..targets.len()).find(|&kind| counts[kind] > 0 && targets[kind].isolation.total() == 0)
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
    let top_m = |kind: &usize| targets[*kind].elevation.quantile(1.0);
    let there = (0..targets.len()).filter(|&kind| counts[kind] > 0);
    let highest = there.max_by(|a, b| top_m(a).total_cmp(&top_m(b)).then(b.cmp(a))).unwrap_or(0);
    let mut roles: Vec<Role> = Vec::with_capacity(count);
    for (kind, (target, &count)) in targets.iter().zip(counts).enumerate() {
        roles.extend(cast(target, kind, count, kind == highest, &mut part(16 + kind as u64)));
    }
    distinguish(&mut roles);
    let thrown = throw(targets, roles, extent, &weights, &mut part(0), watch)?;
    let (mut roles, places) = (thrown.roles, thrown.places);
    watch.begin("joining peaks", 0);
    let elevations_m: Vec<f64> = roles.iter().map(|role| role.elevation_m).collect();
    let ridges = ridges(extent, &places, &elevations_m, options.ridge_exponent)?;
    let grown = grow(&mut roles, &ridges, targets);
    watch.check()?;
    let cells = saddles(extent, &places, &elevations_m, &grown.edges, &ridges, &mut part(1))?;
    let passes = grown.edges.iter().zip(cells).map(|(edge, cell)| GivenPass {
        peaks: ridges[edge.ridge as usize].ends,
        cell,
        elevation_m: edge.saddle_m,
    });
    let peaks = places.iter().zip(&elevations_m).map(|(&place, &elevation_m)| (extent.cell(place), elevation_m));
    let tree = GivenTree { rows, cols, peaks: peaks.collect(), passes: passes.collect() };
    let kinds = roles.iter().map(|role| role.kind).collect();
    Ok(Synthesis { tree, kinds, misplaced: thrown.misplaced, misjudged: grown.missed })
}

/// Puts the peaks of all ranges into one order, from the highest to the lowest, without equals; the first has no key
/// saddle and no isolation.
fn distinguish(roles: &mut [Role]) {
    roles.sort_by(|a, b| b.elevation_m.total_cmp(&a.elevation_m).then(a.kind.cmp(&b.kind)));
    let mut above_m = f64::INFINITY;
    for role in roles.iter_mut() {
        role.elevation_m = stepped(role.elevation_m).min(above_m - STEP_M);
        above_m = role.elevation_m;
    }
    // Another range may have come out a little higher than the one that was expected to.
    if let Some(expected) = roles.iter().position(|role| role.isolation_m == f64::INFINITY) {
        let Role { prominence_m, isolation_m, azimuth, .. } = roles[0];
        let other = &mut roles[expected];
        (other.prominence_m, other.isolation_m, other.azimuth) = (prominence_m, isolation_m, azimuth);
        (roles[0].prominence_m, roles[0].isolation_m) = (roles[0].elevation_m, f64::INFINITY);
    }
}
