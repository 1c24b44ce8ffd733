//! What a finer terrain is to be.

/// What a finer terrain is to be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Mode {
    /// The best estimate of the true heights.
    Accurate,
    /// One of the terrains that there may be, as rough as true ones; another for each seed.
    Realistic,
    /// What paper 001 makes of it (section 5.3): patches of the exemplars in place of the input's. It keeps no means.
    Paper,
}

impl Mode {
    /// All modes, with the number that stands for each in a file.
    const ALL: [(Self, u8); 3] = [(Self::Accurate, 1), (Self::Realistic, 2), (Self::Paper, 3)];

    /// Its name, as it is said on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Accurate => "accurate",
            Self::Realistic => "realistic",
            Self::Paper => "paper",
        }
    }

    /// The number that stands for it in a file.
    pub(super) fn tag(self) -> u8 {
        Self::ALL.iter().find(|(mode, _)| *mode == self).map_or(0, |(_, tag)| *tag)
    }

    /// What a number stands for.
    pub(super) fn of(tag: u8) -> Option<Self> {
        Self::ALL.iter().find(|(_, other)| *other == tag).map(|(mode, _)| *mode)
    }

    /// Whether anything is drawn while it learns, so that a seed decides what is learned.
    pub(super) fn draws_in_learning(self) -> bool {
        self != Self::Realistic
    }

    /// Bytes that an exemplar's cell takes while it is learned from: at all scales, with what steps make of it; or as it
    /// is, with sums.
    pub(super) fn bytes_per_exemplar_cell(self) -> u64 {
        match self {
            Self::Accurate | Self::Realistic => 96,
            Self::Paper => 32,
        }
    }
}
