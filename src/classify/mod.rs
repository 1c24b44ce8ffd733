//! Which range a place is in, told from the peaks around it (Argudo et al. 2019, section 4.2).
//!
//! [`features()`] are the shares of the paper's histograms in a disk. A [`Forest`] of trees ([`Tree`]) is grown on
//! [`Samples`], which are disks of known classes, and says of another disk how likely each class is. [`Apart`] parts the
//! disks so that what a forest is tested on shares no ground with what it was grown on, a [`Confusion`] counts what it
//! took for what, and a [`Model`] is the file that keeps it.
//!
//! Forests are equal to the bit for a seed, whatever the machine and its threads: impurities are compared as fractions
//! of whole numbers, and probabilities are added in the order of the trees.

mod apart;
mod confusion;
mod features;
mod forest;
mod model;
mod samples;
mod split;
mod tree;

pub use apart::{Apart, Part, Spot};
pub use confusion::Confusion;
pub use features::{Feature, features, table};
pub use forest::{Forest, ForestOptions, Grown};
pub use model::{ClassRecord, Conditions, MODEL_FORMAT, MODEL_VERSION, Model};
pub use samples::{MOST_SAMPLES, Samples};
pub use split::{Split, best_split};
pub use tree::{Node, Tree};
