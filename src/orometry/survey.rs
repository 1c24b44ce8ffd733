//! What a survey of a DEM yields: the peaks and the divide tree above a prominence threshold.

use crate::grid::Cell;

/// The key saddle of a peak.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KeySaddle {
    /// The cell.
    pub cell: Cell,
    /// Its elevation in metres.
    pub elevation_m: f64,
    /// Distance from the peak in metres.
    pub distance_m: f64,
    /// Azimuth at the peak in degrees clockwise from north; NaN where there is none.
    pub azimuth: f64,
}

/// How far a peak is from higher ground.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Isolation {
    /// Distance in metres to the nearest strictly higher cell; `None` for the highest peak of the dataset.
    pub isolation_m: Option<f64>,
    /// Distance in metres to the nearest cell that is higher or unknown; `None` where there is no such cell.
    pub isolation_min_m: Option<f64>,
    /// Whether nothing unknown could shorten the isolation.
    pub certain: bool,
    /// Azimuth at the peak in degrees clockwise from north; NaN where there is no higher cell.
    pub azimuth: f64,
    /// The nearest strictly higher cell; ties go to the lowest index.
    pub higher: Option<Cell>,
}

/// A peak of the pruned divide tree, with all its measures.
///
/// Elevations, prominences and distances are in metres.
#[derive(Clone, Debug, PartialEq)]
pub struct Peak {
    /// 1 for the most prominent; by prominence, then by index.
    pub id: u32,
    /// The cell.
    pub cell: Cell,
    /// Elevation.
    pub elevation_m: f64,
    /// Prominence; the upper end of its interval unless the peak is a root, for which it is a convention.
    pub prominence_m: f64,
    /// Lower end of the interval of the prominence; the convention too for a root of which nothing is unknown.
    pub prominence_min_m: f64,
    /// Whether nothing unknown could change the prominence.
    pub prominence_certain: bool,
    /// Whether the peak is the top of a connected component, and so has no key saddle.
    pub is_root: bool,
    /// The key saddle; `None` for a root.
    pub key_saddle: Option<KeySaddle>,
    /// Id of the topmost peak of the component that this peak's joins at its key saddle.
    pub island_parent: Option<u32>,
    /// Id of the first peak with a greater prominence on the way to the island parent.
    pub prominence_parent: Option<u32>,
    /// Id of the first peak above this one on the way to the island parent.
    pub line_parent: Option<u32>,
    /// Isolation, unless it was not asked for.
    pub isolation: Option<Isolation>,
    /// Prominence over elevation; `None` where the elevation is not positive.
    pub dominance: Option<f64>,
    /// Prominence over the greatest prominence of the dataset; `None` where that is not positive.
    pub relative_prominence: Option<f64>,
    /// Elevation over the greatest elevation of the dataset; `None` where that is not positive.
    pub relative_elevation: Option<f64>,
    /// Geometric mean of the two; `None` where one is missing or negative.
    pub relevance: Option<f64>,
}

/// An edge of the pruned divide tree.
#[derive(Clone, Debug, PartialEq)]
pub struct TreeEdge {
    /// Id of the peak on the side of the saddle's topmost neighbour.
    pub peak_a: u32,
    /// Id of the peak on the other side.
    pub peak_b: u32,
    /// Id of the peak that ends at the saddle, and so of the saddle.
    pub saddle: u32,
    /// The saddle's cell.
    pub saddle_cell: Cell,
    /// Elevation of the saddle in metres.
    pub saddle_elevation_m: f64,
    /// Prominence in metres of the peak that ends here.
    pub prominence_m: f64,
    /// The cells of the line from peak a over the saddle to peak b; empty unless lines were asked for.
    pub path: Vec<Cell>,
    /// Length of that line in metres.
    pub length_m: f64,
}

/// Peaks and divide tree of one DEM.
#[derive(Clone, Debug, Default)]
pub struct Survey {
    /// The peaks at or above the threshold, by id; rows may be filtered, so ids may have gaps.
    pub peaks: Vec<Peak>,
    /// The edges of the pruned divide tree, by the id of the peak that ends there.
    pub edges: Vec<TreeEdge>,
    /// Local maxima of the raster, whatever their prominence.
    pub local_peaks: u64,
}

/// What to measure, and what to leave out.
#[derive(Clone, Debug)]
pub struct SurveyOptions {
    /// Peaks with a lower prominence are taken into the group of a higher one.
    pub min_prominence_m: f64,
    /// Elevation below which saddles count as this elevation, if any.
    pub base_level_m: Option<f64>,
    /// Voids are known to be lower than everything.
    pub nodata_is_sea: bool,
    /// Whether to measure isolation.
    pub isolation: bool,
    /// Whether to draw the lines of the divide tree.
    pub ridges: bool,
    /// Peaks with a lower isolation get no row; the highest peak always does.
    pub min_isolation_m: f64,
    /// Peaks whose prominence, or isolation where it is measured, is not certain get no row.
    pub certain_only: bool,
    /// Side in cells of the tiles that are worked on at once; results do not depend on it.
    pub tile: usize,
}

impl Default for SurveyOptions {
    fn default() -> Self {
        Self {
            min_prominence_m: 30.0,
            base_level_m: None,
            nodata_is_sea: false,
            isolation: true,
            ridges: true,
            min_isolation_m: 0.0,
            certain_only: false,
            tile: 256,
        }
    }
}
