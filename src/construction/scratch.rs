//! Memory of a thread that evaluates blocks.

use super::operator::warp::Matrix;
use super::point::{Block, Places, WIDTH};

/// Places in the frame of a warp, with the Jacobians of the way there.
pub(super) type Frame = (Box<Places>, Vec<Matrix>);

/// Blocks for results on the way, kept from block to block.
#[derive(Default)]
pub(super) struct Scratch {
    pub(super) blocks: Vec<Box<Block>>,
    /// Places in the frames of warps, with the Jacobians of the way there.
    pub(super) frames: Vec<Frame>,
    /// Results of steps that several others ask for: none yet, nothing, or a block.
    pub(super) known: Vec<Option<Option<Box<Block>>>>,
}

impl Scratch {
    /// A block with anything in it; not inlined for the same reason as [`Scratch::take_frame`].
    #[inline(never)]
    pub(super) fn take(&mut self) -> Box<Block> {
        self.blocks.pop().unwrap_or_default()
    }

    /// Memory for places in another frame, with anything in it. Not inlined, so that what is made on the way takes no
    /// room on the stack of trees that are deep.
    #[inline(never)]
    pub(super) fn take_frame(&mut self) -> Frame {
        self.frames.pop().unwrap_or_else(|| (Box::default(), vec![[[0.0; 2]; 2]; WIDTH]))
    }

    pub(super) fn give(&mut self, block: Box<Block>) {
        self.blocks.push(block);
    }
}
