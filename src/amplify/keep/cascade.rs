//! A cascade: its steps one after the other, equal ones once.

use super::super::cascade::{Cascade, Stage, steps_of};
use super::super::network::NETWORK_FACTORS;
use super::super::step::STEP_FACTORS;
use super::bytes::{Cursor, corrupt, put_u8};
use super::{Kind, networks, steps};
use crate::error::Result;

impl Cascade {
    /// What its steps are.
    pub(crate) fn kind(&self) -> Kind {
        if self.is_textured() { Kind::Steps } else { Kind::Networks }
    }

    /// What was learned, as bytes.
    ///
    /// # Errors
    /// When a number has no room there.
    pub(crate) fn put(&self, out: &mut Vec<u8>) -> Result<()> {
        put_u8(out, self.borrowed as u8);
        let mut kept: Vec<(usize, Vec<u8>)> = vec![];
        for stage in &self.steps {
            let mut own = vec![];
            match stage {
                Stage::Estimate(network) => networks::put(&mut own, network)?,
                Stage::Terrain { step, texture } => steps::put(&mut own, step, texture.as_ref())?,
            }
            let own = (stage.factor(), own);
            // Steps that were learned at a finer scale than their own are those of that scale.
            match kept.iter().position(|other| *other == own) {
                Some(other) => put_u8(out, other as u8 + 1),
                None => {
                    put_u8(out, 0);
                    put_u8(out, own.0 as u8);
                    out.extend(&own.1);
                }
            }
            kept.push(own);
        }
        Ok(())
    }

    /// Takes a cascade of a factor, whose steps are networks or those of regressions.
    ///
    /// # Errors
    /// When the bytes are none, or there is no room for it.
    ///
    /// # Panics
    /// For another kind.
    pub(crate) fn take(cursor: &mut Cursor<'_>, kind: Kind, factor: usize) -> Result<Self> {
        let parts: &[usize] = match kind {
            Kind::Networks => &NETWORK_FACTORS,
            Kind::Steps => &STEP_FACTORS,
            Kind::Patches => unreachable!("a cascade has no patches"),
        };
        let factors = steps_of(factor, parts).map_err(|error| corrupt(error.message()))?;
        let borrowed = u64::from(cursor.u8("the number of borrowed steps")?);
        // One at least found enough to learn from.
        let borrowed = cursor.within(borrowed, [0, factors.len() as u64 - 1], "the number of borrowed steps")?;
        let mut stages: Vec<Stage> = vec![];
        for (number, &factor) in factors.iter().enumerate() {
            let other = u64::from(cursor.u8("the number of a step")?);
            let other = cursor.within(other, [0, number as u64], "the number of a step that is the same")?;
            if let Some(other) = other.checked_sub(1) {
                let stage = stages[other].clone();
                if stage.factor() != factor {
                    let message =
                        format!("step {} is of {factor}, and the same as one of {}", number + 1, stage.factor());
                    return Err(corrupt(message));
                }
                cursor.reserve((stage.len() * size_of::<f32>()) as u64)?;
                stages.push(stage);
                continue;
            }
            let own = u64::from(cursor.u8("the factor of a step")?);
            cursor.within(own, [factor as u64; 2], "the factor of a step")?;
            stages.push(match kind {
                Kind::Networks => Stage::Estimate(networks::take(cursor, factor)?),
                Kind::Steps | Kind::Patches => {
                    let (step, texture) = steps::take(cursor, factor)?;
                    Stage::Terrain { step: Box::new(step), texture }
                }
            });
        }
        Ok(Self { steps: stages, borrowed })
    }
}
