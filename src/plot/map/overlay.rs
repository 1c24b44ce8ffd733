//! What is drawn on the relief, in the coordinates of the relief's geotransform.

/// A peak.
#[derive(Clone, Debug, PartialEq)]
pub struct PeakMark {
    /// Easting or longitude.
    pub x: f64,
    /// Northing or latitude.
    pub y: f64,
    /// Prominence in metres; decides the size and who gets a label.
    pub prominence_m: f64,
    /// Elevation in metres, for the label; NaN where it is not known.
    pub elevation_m: f64,
    /// Name, for the label.
    pub name: Option<String>,
}

/// A line of the divide tree.
#[derive(Clone, Debug, PartialEq)]
pub struct Ridge {
    /// Its vertices; a line that crosses the antimeridian may jump or run on beyond 180 degrees.
    pub path: Vec<(f64, f64)>,
    /// Prominence in metres of the peak that ends at its saddle: how deep the line dips.
    pub prominence_m: f64,
    /// Greatest prominence in metres of the peaks that the line joins to the highest; decides the width.
    pub carried_m: f64,
}

/// Everything that is drawn on the relief; each part may be empty.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Overlay {
    /// Peaks, in any order.
    pub peaks: Vec<PeakMark>,
    /// Saddles.
    pub saddles: Vec<(f64, f64)>,
    /// Lines of the divide tree.
    pub ridges: Vec<Ridge>,
    /// Lines from peaks to the nearest higher ground.
    pub isolation: Vec<Vec<(f64, f64)>>,
}
