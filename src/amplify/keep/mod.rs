//! What was learned, as bytes that can be kept and read again: `format-spec/learned.md` describes them.
//!
//! One body for each kind of method: a [`cascade`](super::Cascade) of `networks` or of `steps` with texture, and `patches`
//! for [`Paper`](super::Paper). A new kind is a new file here and a new tag in [`Kind`]. A decoder checks each number
//! before it trusts it, and reserves memory only for what is there or what it was given [room](Cursor::reserve) for.

mod bytes;
mod cascade;
mod networks;
mod numbers;
mod patches;
mod steps;
#[cfg(test)]
pub(crate) mod tests;

pub(crate) use bytes::{Cursor, put_f64, put_text, put_u8, put_u16, put_u32, put_u64};

/// What a body holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    /// Steps that are networks.
    Networks,
    /// Steps of anchored regressions and texture.
    Steps,
    /// Patches of exemplars.
    Patches,
}

impl Kind {
    const ALL: [(Self, u8); 3] = [(Self::Networks, 1), (Self::Steps, 2), (Self::Patches, 3)];

    /// The number that stands for it in a file.
    pub(crate) fn tag(self) -> u8 {
        Self::ALL.iter().find(|(kind, _)| *kind == self).map_or(0, |(_, tag)| *tag)
    }

    /// What a number stands for.
    pub(crate) fn of(tag: u8) -> Option<Self> {
        Self::ALL.iter().find(|(_, other)| *other == tag).map(|(kind, _)| *kind)
    }
}
