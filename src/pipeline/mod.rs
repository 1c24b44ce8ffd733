//! Jobs from files to files: what reads, measures and writes, within a memory budget.

mod backbone;
pub mod layers;
pub mod map;
pub mod memory;
mod metric;
mod overlay;
pub mod peaks;
mod spikes;

pub use metric::{AnyMetric, Distance, metric_of};
pub use overlay::{OverlayLayers, ReadOverlay, read_overlay};
