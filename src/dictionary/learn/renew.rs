//! Atoms that nobody needs make room for patches that are explained badly.

use super::super::pursuit::Projection;
use super::constrained::Candidates;
use super::residuals::{Residuals, User};
use crate::linalg::{dot, product, product_error};

/// Two atoms whose inner product has at least this size are twins: either can do the other's work.
const TWINS: f64 = 0.999;
/// Atoms of one product.
const BLOCK: usize = 256;

/// An atom that may go.
struct Spare {
    atom: usize,
    /// Its twin, which takes over its users; without one it has none.
    twin: Option<usize>,
}

/// New codes of some patches, and what they leave.
struct Moved {
    patch: usize,
    atoms: Vec<u32>,
    parts: Vec<f64>,
    error: f64,
}

/// Puts the patches that are explained worst in the place of atoms that have no users, or a twin.
///
/// K-SVD cannot do this by itself: twins share their users for ever. An atom goes only if the error of all does not
/// rise; `errors`, one a patch, are brought up to date.
pub(super) fn renew(state: &mut Residuals, errors: &mut [f64], candidates: Option<&Candidates>) {
    let users = state.codes.users(state.dictionary.len());
    let spare = spare_atoms(state, &users);
    if spare.is_empty() {
        return;
    }
    let mut worst: Vec<usize> = (0..errors.len()).filter(|&i| errors[i] > 0.0).collect();
    worst.sort_by(|&a, &b| errors[b].total_cmp(&errors[a]).then(a.cmp(&b)));
    for (Spare { atom, twin }, patch) in spare.into_iter().zip(worst) {
        let new = match candidates {
            None => Some(state.samples.atom(patch)),
            Some(candidates) => {
                candidates.best(&state.own_gram(patch)).map(|(values, origin)| (values.to_vec(), origin.clone()))
            }
        };
        let Some((values, origin)) = new else { continue };
        let mut moved = vec![];
        if let Some(twin) = twin {
            let movers = users[atom].iter().map(|user| user.0 as usize).filter(|&user| user != patch);
            moved.extend(movers.map(|user| refit(state, user, atom, twin)));
        }
        let explained = explain(state, patch, atom, &values);
        // With several atoms a patch may be better off as it is, unless it loses one of them.
        let keeps = !users[atom].iter().any(|user| user.0 as usize == patch);
        if !keeps || explained.error <= errors[patch] {
            moved.push(explained);
        }
        let before: f64 = moved.iter().map(|moved| errors[moved.patch]).sum();
        let after: f64 = moved.iter().map(|moved| moved.error).sum();
        if after <= before {
            for moved in moved {
                state.codes.set(moved.patch, &moved.atoms, &moved.parts);
                errors[moved.patch] = moved.error;
            }
            state.replace(atom, &values, origin);
        }
    }
}

/// Atoms without users, and of twins the one with the higher number; a twin that others are moved to stays.
fn spare_atoms(state: &Residuals, users: &[Vec<User>]) -> Vec<Spare> {
    let count = users.len();
    let size = state.atom(0).len();
    let atoms: Vec<f32> = (0..count).flat_map(|k| state.atom(k).iter().copied()).collect();
    // The product only proposes; atoms have length 1 within 1e-5.
    let least = (TWINS - 2.0 * product_error(size) - 1e-6) as f32;
    let mut spare: Vec<Spare> =
        (0..count).filter(|&k| users[k].is_empty()).map(|atom| Spare { atom, twin: None }).collect();
    let mut taken: Vec<bool> = users.iter().map(Vec::is_empty).collect();
    let mut scores = vec![];
    for (block, rows) in atoms.chunks(BLOCK * size).enumerate() {
        scores.resize(rows.len() / size * count, 0.0f32);
        product(rows, &atoms, size, &mut scores);
        for (row, scores) in scores.chunks_exact(count).enumerate() {
            let k = block * BLOCK + row;
            let twin = (0..k).find(|&other| {
                scores[other].abs() >= least && !taken[other] && dot(state.atom(other), state.atom(k)).abs() >= TWINS
            });
            if let Some(twin) = twin.filter(|_| !taken[k]) {
                (taken[k], taken[twin]) = (true, true);
                spare.push(Spare { atom: k, twin: Some(twin) });
            }
        }
    }
    spare
}

/// A user of an atom with its twin in its place.
fn refit(state: &Residuals, patch: usize, atom: usize, twin: usize) -> Moved {
    let mut projection = begin(state, patch);
    let (atoms, _) = state.codes.get(patch);
    for &k in atoms {
        let k = if k as usize == atom { twin as u32 } else { k };
        if !projection.atoms().contains(&k) {
            projection.take(k, state.atom(k as usize), None);
        }
    }
    moved(patch, &projection)
}

/// A patch by a new atom alone.
fn explain(state: &Residuals, patch: usize, atom: usize, values: &[f32]) -> Moved {
    let mut projection = begin(state, patch);
    let mut scaled = vec![0.0; state.samples.shape().disc_values()];
    state.samples.shape().scale_into(values, &mut scaled);
    projection.take(atom as u32, &scaled, None);
    moved(patch, &projection)
}

fn begin(state: &Residuals, patch: usize) -> Projection {
    let mut values = vec![0.0; state.samples.shape().disc_values()];
    state.samples.shape().scale_into(state.samples.patch_m(patch), &mut values);
    let mut projection = Projection::default();
    projection.begin(&values);
    projection
}

fn moved(patch: usize, projection: &Projection) -> Moved {
    Moved { patch, atoms: projection.atoms().to_vec(), parts: projection.coefficients().0, error: projection.error() }
}
