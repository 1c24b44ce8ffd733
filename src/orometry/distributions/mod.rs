//! Statistics of peaks and terrain: the ten histograms of Argudo et al. 2019 (table 1), slopes and hypsometry, by domain.
//!
//! A survey's peaks, or the rows of a `peaks` layer, become [`PeakMeasures`]. A [`Selection`] says which of them form
//! a [`Domain`]: all, a region, a disk. [`Domain::measure`] counts each [`Measure`] in two sets of bins ([`BinSet`]);
//! [`measure_terrain`] does the same for the cells of a [`CellSet`]. A [`StatsDocument`] is the file that holds it all
//! (`format-spec/stats.md`), which synthesis and classification read back; [`csv()`] is the same as a table, and
//! [`compare()`] says how far two domains are from each other.

mod bins;
mod cell_set;
mod cell_shape;
mod classes;
mod compare;
mod disk;
mod document;
mod domain;
mod histogram;
mod layout;
mod measure;
mod metrics;
mod peaks;
mod table;
mod terrain;

pub use bins::{BinSet, elevation_edges, slope_edges};
pub use cell_set::CellSet;
pub use cell_shape::CellShape;
pub use classes::ProminenceClass;
pub use compare::{
    Comparison, compare, compare_documents, emd_circular, emd_linear, largest_bin_difference, total_variation,
};
pub use disk::{Centre, Disk, DiskOutline, parse_disk};
pub use document::{DEFAULT_RADIUS_M, Definitions, Input, InputKind, STATS_FORMAT, STATS_VERSION, StatsDocument};
pub use domain::{AreaFrom, Domain, DomainKind, Extremes, Selection, region_names};
pub use histogram::{AreaHistogram, Histogram};
pub use measure::{Frame, Measure, Unit};
pub use metrics::{Histograms, MeasureStatistics, Metrics, PerMeasure};
pub use peaks::PeakMeasures;
pub use table::csv;
pub use terrain::{Terrain, measure_terrain};
