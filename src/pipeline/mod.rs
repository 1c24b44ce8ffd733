//! Jobs from files to files: what reads, measures and writes, within a memory budget.

pub mod amplify;
pub mod archive;
mod backbone;
pub mod classify;
mod land;
mod land_map;
pub mod layers;
pub mod map;
pub mod memory;
mod metric;
mod names;
mod overlay;
pub mod peaks;
mod regions;
pub mod scene;
pub mod sparse;
mod spikes;
pub mod stats;
mod surveying;
pub mod synthesize;
mod tags;
pub mod terrain;
pub mod tin;
pub mod view;

pub use metric::{AnyMetric, Distance, metric_of};
pub use names::Names;
pub use overlay::{OverlayLayers, ReadOverlay, read_overlay};
pub use regions::Regions;
pub use tags::{NameLayer, TagLayer, TagOptions, Tagger};
