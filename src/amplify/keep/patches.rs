//! Amplification with the patches of exemplars: the exemplars, and which of their patches are taken.

use super::super::paper::{Paper, PatchModel, Source, most_patches};
use super::bytes::{Cursor, corrupt, put_u8, put_u16, put_u32};
use super::numbers;
use crate::error::{Error, ErrorKind, Result};
use crate::watch::Watch;

/// Bytes of memory that a cell of an exemplar takes beside its height: sums, and cells of other sizes.
const BYTES_PER_CELL: u64 = 24;
/// Copies of a patch's values that there are at once while atoms are made of them.
const COPIES: u64 = 4;

impl Paper {
    /// What was learned, as bytes.
    ///
    /// # Errors
    /// When a number has no room there.
    pub(crate) fn put(&self, out: &mut Vec<u8>) -> Result<()> {
        let kept = self.kept();
        let PatchModel { side, step, sparsity, signed, atoms, patches, by, seed: _ } = kept.model;
        put_u8(out, *side as u8);
        put_u8(out, step.unwrap_or(0) as u8);
        put_u8(out, *sparsity as u8);
        put_u8(out, u8::from(*signed));
        put_u32(out, atoms.unwrap_or(0) as u32);
        put_u32(out, patches.unwrap_or(0) as u32);
        put_u16(out, by.unwrap_or(0) as u16);
        put_u16(
            out,
            u16::try_from(kept.sources.len()).map_err(|_| {
                Error::new(
                    ErrorKind::Unsupported,
                    format!("{} exemplars: at most 65535 can be kept", kept.sources.len()),
                )
            })?,
        );
        for source in kept.sources {
            put_u32(out, source.rows as u32);
            put_u32(out, source.cols as u32);
            numbers::put(out, source.cols, &source.heights_m)?;
        }
        for chosen in kept.chosen.into_iter().flatten() {
            put_u32(out, chosen.len() as u32);
            chosen.iter().for_each(|&atom| put_u32(out, atom));
        }
        Ok(())
    }

    /// Takes what was learned for a factor with a seed.
    ///
    /// # Errors
    /// When the bytes are none, or there is no room for it; a cancelled job.
    pub(crate) fn take(cursor: &mut Cursor<'_>, factor: usize, seed: u64, watch: &Watch) -> Result<Self> {
        let some = |value: usize| (value > 0).then_some(value);
        let model = PatchModel {
            side: cursor.u8("the side of patches")?.into(),
            step: some(cursor.u8("the step of patches")?.into()),
            sparsity: cursor.u8("the number of atoms of a patch")?.into(),
            signed: cursor.flag("whether patches are turned upside down")?,
            atoms: some(cursor.u32("the number of atoms")? as usize),
            patches: some(cursor.u32("the number of patches")? as usize),
            by: some(cursor.u16("the factor of a step")?.into()),
            seed,
        };
        let steps = model.steps(factor).map_err(|error| corrupt(error.message()))?.len();
        let count = cursor.u16("the number of exemplars")?;
        let mut sources = vec![];
        for number in 1..=count {
            let what = format!("exemplar {number}");
            let size = [cursor.u32(&what)?, cursor.u32(&what)?].map(|side| side as usize);
            let [rows, cols] = size;
            let cells = rows.saturating_mul(cols) as u64;
            cursor.reserve(cells.saturating_mul(BYTES_PER_CELL))?;
            let heights_m = numbers::take(cursor, size, &what)?;
            if let Some(at) = heights_m.iter().position(|height| height.is_infinite()) {
                return Err(corrupt(format!("{what}: the height of cell {at} is infinite")));
            }
            sources.push(Source { rows, cols, heights_m });
        }
        let mut chosen = vec![];
        if model.atoms.is_some() {
            for _ in 0..steps {
                let count = cursor.u32("the number of atoms of a step")? as usize;
                let bytes = cursor.bytes(count.saturating_mul(size_of::<u32>()), "the atoms of a step")?;
                chosen.push(bytes.as_chunks().0.iter().map(|bytes| u32::from_le_bytes(*bytes)).collect());
            }
        }
        let cells: usize = sources.iter().map(|source| source.heights_m.len()).sum();
        let patches = most_patches(&model, sources.len()).min(cells) as u64;
        cursor.reserve(patches * (model.side * model.side * size_of::<f32>()) as u64 * COPIES * steps as u64)?;
        Self::of(sources, factor, &model, chosen, watch).map_err(|error| match error.kind() {
            ErrorKind::Input => corrupt(error.message()),
            _ => error,
        })
    }
}
