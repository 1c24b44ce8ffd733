//! A step and its texture.

use super::super::anchors::{ANCHORS, Anchors, BRANCHES, Knot};
use super::super::features::{DIMS, Features, INPUTS};
use super::super::step::{Estimator, Step, detail_side};
use super::super::strength::{MEASURES, Strength};
use super::super::texture::{MOST_VALUES, Texture, sample_side};
use super::bytes::{Cursor, corrupt, put_f64, put_u8, put_u32};
use super::{networks, numbers};
use crate::error::Result;

/// Stands for the kind of a sample that only kinds have which have them all.
const NO_KIND: u8 = 255;

/// Appends a step.
///
/// # Errors
/// When a number has no room there.
pub(super) fn put(out: &mut Vec<u8>, step: &Step, texture: Option<&Texture>) -> Result<()> {
    put_step(out, step)?;
    put_u8(out, u8::from(texture.is_some()));
    texture.map_or(Ok(()), |texture| put_texture(out, texture, step.factor))
}

/// Takes a step of a factor.
///
/// # Errors
/// When the bytes are none, or there is no room for it.
pub(super) fn take(cursor: &mut Cursor<'_>, factor: usize) -> Result<(Step, Option<Texture>)> {
    let step = take_step(cursor, factor)?;
    let is_there = cursor.flag("whether a step has texture")?;
    Ok((step, is_there.then(|| take_texture(cursor, factor)).transpose()?))
}

fn put_step(out: &mut Vec<u8>, step: &Step) -> Result<()> {
    put_u8(out, u8::from(step.is_square));
    numbers::put(out, DIMS, step.features.weights.as_flattened())?;
    let knots = std::iter::once(&step.anchors.root).chain(&step.anchors.knots);
    let vectors: Vec<f32> = knots.flat_map(|knot| knot.0.as_flattened()).copied().collect();
    numbers::put(out, BRANCHES, &vectors)?;
    match &step.estimator {
        Estimator::Regressions(regressors) => {
            put_u8(out, 0);
            numbers::put(out, patch_cells(step.factor), regressors)
        }
        Estimator::Network(network) => {
            put_u8(out, 1);
            networks::put_layers(out, network)
        }
    }
}

/// Fine cells of a patch.
fn patch_cells(factor: usize) -> usize {
    detail_side(factor) * detail_side(factor)
}

fn take_step(cursor: &mut Cursor<'_>, factor: usize) -> Result<Step> {
    let is_square = cursor.flag("whether cells are square")?;
    let weights = numbers::take_finite(cursor, [INPUTS, DIMS], "the features")?;
    let vectors = numbers::take_finite(cursor, [(1 + BRANCHES) * DIMS, BRANCHES], "the anchors")?;
    let knot = |values: &[[f32; BRANCHES]]| {
        let mut knot = Knot([[0.0; BRANCHES]; DIMS]);
        knot.0.copy_from_slice(values);
        knot
    };
    let knots: Vec<Knot> = vectors.as_chunks().0.chunks_exact(DIMS).map(knot).collect();
    let Some((root, knots)) = knots.split_first() else { return Err(corrupt("there are no anchors")) };
    let anchors = Anchors { root: root.clone(), knots: knots.to_vec() };
    let estimator = match cursor.flag("whether estimates are by a network")? {
        true => Estimator::Network(networks::take_layers(cursor, factor, is_square)?),
        false => Estimator::Regressions(numbers::take_finite(
            cursor,
            [ANCHORS * DIMS, patch_cells(factor)],
            "the regressions",
        )?),
    };
    Ok(Step { factor, is_square, features: Features { weights: weights.as_chunks().0.to_vec() }, anchors, estimator })
}

fn put_texture(out: &mut Vec<u8>, texture: &Texture, factor: usize) -> Result<()> {
    texture.strength.weights.iter().for_each(|&weight| put_f64(out, weight));
    let side = sample_side(factor);
    let count = texture.samples.len() / (side * side);
    put_u32(out, count as u32);
    let mut kinds = vec![NO_KIND; count];
    for (number, own) in texture.kinds.iter().enumerate() {
        let has_all = own.len() == count;
        put_u8(out, u8::from(has_all));
        if !has_all {
            own.iter().for_each(|&sample| kinds[sample as usize] = number as u8);
        }
    }
    out.extend(&kinds);
    numbers::put(out, side, &texture.samples)
}

fn take_texture(cursor: &mut Cursor<'_>, factor: usize) -> Result<Texture> {
    let mut weights = [0.0; MEASURES];
    for weight in &mut weights {
        *weight = cursor.f64_from(0.0, "a weight of texture's strength")?;
    }
    let side = sample_side(factor);
    let count = u64::from(cursor.u32("the number of samples")?);
    let count = cursor.within(count, [1, (MOST_VALUES / (side * side)) as u64], "the number of samples")?;
    let mut has_all = [false; Step::KINDS];
    for has_all in &mut has_all {
        *has_all = cursor.flag("whether a kind of patch has all samples")?;
    }
    let mut kinds: Vec<Vec<u32>> = vec![vec![]; Step::KINDS];
    for (sample, &kind) in cursor.bytes(count, "the kinds of samples")?.iter().enumerate() {
        if kind == NO_KIND {
            continue;
        }
        match kinds.get_mut(usize::from(kind)) {
            Some(own) if !has_all[usize::from(kind)] => own.push(sample as u32),
            _ => return Err(corrupt(format!("sample {sample} is of kind {kind}, which has none of its own"))),
        }
    }
    for (kind, (own, has_all)) in kinds.iter_mut().zip(has_all).enumerate() {
        if has_all {
            *own = (0..count as u32).collect();
        } else if own.is_empty() {
            return Err(corrupt(format!("kind {kind} of patches has no samples")));
        }
    }
    cursor.reserve((Step::KINDS * count * size_of::<u32>()) as u64)?;
    let samples = numbers::take_finite(cursor, [count * side, side], "the samples of texture")?;
    Ok(Texture { strength: Strength { weights }, kinds, samples })
}
