//! Ridges that touch others.

use super::crest::Crest;
use super::heights::Heights;
use super::skeleton::Skeleton;

/// By how much a ridge is lowered below the saddles that must not be passed by, in metres.
const BELOW_M: f32 = 0.1;
/// Rounds of lowering: what one brings may touch another ridge.
const ROUNDS: usize = 8;

/// Lowers ridges where they touch others that the tree joins farther down only.
///
/// Two neighbouring cells join their peaks at the elevation of the lower one. That must not be higher than the lowest
/// saddle between these peaks; a ridge can come down so far if its own saddle is no higher, for nobody needs it to be
/// higher than that. From there to its saddle it then is no higher either: there is no new peak.
pub(super) fn lower(crest: &mut Crest, skeleton: &Skeleton, heights: &Heights) {
    let mut least = vec![];
    let cells: Vec<u32> = (0..crest.z_m.len() as u32).filter(|&cell| crest.is(cell as usize)).collect();
    for &cell in &cells {
        let ridge = skeleton.ridges.get(crest.ridges[cell as usize] as usize);
        let is_filler = crest.is_filler(cell);
        least.push(match ridge {
            _ if is_filler => f32::NEG_INFINITY,
            Some(ridge) => skeleton.ends_m(ridge)[0] as f32,
            None => f32::INFINITY,
        });
    }
    let at = |cell: usize| cells.binary_search(&(cell as u32)).ok();
    for spot in skeleton.peaks.iter().chain(&skeleton.saddles) {
        if let Some(at) = at(spot.row * crest.cols + spot.col) {
            least[at] = spot.elevation_m as f32;
        }
    }
    for round in 0..ROUNDS {
        let mut has_changed = false;
        for (here, &cell) in cells.iter().enumerate() {
            let cell = cell as usize;
            for other in crest.around(cell).filter(|&other| other > cell) {
                let Some((p, q)) = crest.peak(skeleton, cell).zip(crest.peak(skeleton, other)) else { continue };
                let cap = heights.between(p, q);
                if crest.z_m[cell].min(crest.z_m[other]) <= cap {
                    continue;
                }
                let there = at(other).unwrap_or(here);
                let low = |(cell, at): (usize, usize)| (cell, least[at].max(cap - BELOW_M));
                let ways = [low((cell, here)), low((other, there))];
                let best = ways.into_iter().filter(|way| way.1 <= cap).min_by(|a, b| {
                    let cost = |way: &(usize, f32)| (way.1 == cap, crest.z_m[way.0] - way.1);
                    let (a, b) = (cost(a), cost(b));
                    a.0.cmp(&b.0).then(a.1.total_cmp(&b.1))
                });
                if let Some((cell, low_m)) = best {
                    crest.z_m[cell] = low_m;
                    crest.lowered.push(cell as u32);
                    has_changed = true;
                    if !crest.is_filler(cell as u32) {
                        crest.gates.push(cell as u32);
                    }
                } else if round == 0 {
                    let pair = [crest.ridges[cell], crest.ridges[other]];
                    crest.crossings.push([pair[0].min(pair[1]), pair[0].max(pair[1])]);
                }
            }
        }
        if !has_changed {
            break;
        }
        settle(crest, skeleton);
    }
    crest.gates.sort_unstable();
    crest.gates.dedup();
    crest.lowered.sort_unstable();
    crest.lowered.dedup();
    crest.crossings.sort_unstable();
    crest.crossings.dedup();
}

/// Lets every ridge rise to its peak without going down.
fn settle(crest: &mut Crest, skeleton: &Skeleton) {
    let lines = std::mem::take(&mut crest.lines);
    for (ridge, line) in skeleton.ridges.iter().zip(&lines) {
        let mut above_m = f32::INFINITY;
        for &cell in line.iter().rev() {
            let cell = cell as usize;
            let own = skeleton.ridges.get(crest.ridges[cell] as usize).filter(|own| own.peak == ridge.peak);
            if let Some(own) = own.filter(|_| crest.z_m[cell] > above_m) {
                crest.z_m[cell] = above_m.max(skeleton.ends_m(own)[0] as f32);
            }
            above_m = above_m.min(crest.z_m[cell]);
        }
    }
    crest.lines = lines;
    crest.settle_fillers();
}
