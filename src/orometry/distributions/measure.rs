//! The measures that are counted: the ten of the paper's table 1, and plain elevations.

use super::peaks::PeakMeasures;

/// One measure of peaks (Argudo et al. 2019, section 4.1 and table 1).
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Measure {
    /// Prominence over elevation.
    Dominance,
    /// The same in Jurgalski's classes.
    DominanceGroups,
    /// Elevation between the lowest and the highest peak of the domain, 0 to 1.
    NormalisedElevation,
    /// Azimuth from the peak to the nearest higher cell.
    IsolationDirection,
    /// Isolation over the radius R.
    IsolationDistance,
    /// Azimuth from the peak to its key saddle.
    SaddleDirection,
    /// Distance to the key saddle over the radius R.
    SaddleDistance,
    /// Prominence.
    Prominence,
    /// Prominence over the greatest of the domain.
    RelativeProminence,
    /// Geometric mean of relative prominence and relative elevation.
    Relevance,
    /// Elevation; not in table 1, but what synthesis draws from.
    Elevation,
}

/// What the numbers on the axis of a measure are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unit {
    /// A fraction of one.
    Fraction,
    /// A fraction of the radius R.
    OfRadius,
    /// Degrees clockwise from north; 360 is 0.
    Azimuth,
    /// Metres.
    Metres,
}

/// What a domain's measures are relative to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    /// Elevation of the lowest peak in metres.
    pub lowest_m: f64,
    /// Elevation of the highest peak in metres.
    pub highest_m: f64,
    /// Prominence of the most prominent peak in metres.
    pub most_prominent_m: f64,
    /// The radius R in metres that distances are divided by.
    pub radius_m: f64,
}

impl Frame {
    /// The frame of a domain's peaks; `None` where there are none.
    pub fn of(peaks: &[&PeakMeasures], radius_m: f64) -> Option<Self> {
        let first = peaks.first()?;
        let start = Self {
            lowest_m: first.elevation_m,
            highest_m: first.elevation_m,
            most_prominent_m: first.prominence_m,
            radius_m,
        };
        Some(peaks.iter().fold(start, |f, p| Self {
            lowest_m: f.lowest_m.min(p.elevation_m),
            highest_m: f.highest_m.max(p.elevation_m),
            most_prominent_m: f.most_prominent_m.max(p.prominence_m),
            radius_m,
        }))
    }
}

impl Measure {
    /// The ten of table 1, in its order.
    pub const TABLE_1: [Self; 10] = [
        Self::Dominance,
        Self::DominanceGroups,
        Self::NormalisedElevation,
        Self::IsolationDirection,
        Self::IsolationDistance,
        Self::SaddleDirection,
        Self::SaddleDistance,
        Self::Prominence,
        Self::RelativeProminence,
        Self::Relevance,
    ];

    /// All that are counted, in the order of files.
    pub const ALL: [Self; 11] = [
        Self::Dominance,
        Self::DominanceGroups,
        Self::NormalisedElevation,
        Self::IsolationDirection,
        Self::IsolationDistance,
        Self::SaddleDirection,
        Self::SaddleDistance,
        Self::Prominence,
        Self::RelativeProminence,
        Self::Relevance,
        Self::Elevation,
    ];

    /// Name as it stands in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Dominance => "dominance",
            Self::DominanceGroups => "dominance_groups",
            Self::NormalisedElevation => "normalised_elevation",
            Self::IsolationDirection => "isolation_direction",
            Self::IsolationDistance => "isolation_distance",
            Self::SaddleDirection => "saddle_direction",
            Self::SaddleDistance => "saddle_distance",
            Self::Prominence => "prominence",
            Self::RelativeProminence => "relative_prominence",
            Self::Relevance => "relevance",
            Self::Elevation => "elevation",
        }
    }

    /// The measure of a name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|m| m.name() == name)
    }

    /// What the numbers on its axis are.
    pub fn unit(self) -> Unit {
        match self {
            Self::IsolationDirection | Self::SaddleDirection => Unit::Azimuth,
            Self::IsolationDistance | Self::SaddleDistance => Unit::OfRadius,
            Self::Prominence | Self::Elevation => Unit::Metres,
            _ => Unit::Fraction,
        }
    }

    /// The value of a peak; `None` where it has none, or one that is not a number.
    ///
    /// - Dominance is missing where the elevation is not positive.
    /// - Normalised elevation is `(h - min h) / (max h - min h)` over the peaks of the domain, missing where all are
    ///   as high. The paper's table writes `ĥ` and does not define it (its `h̃ = h / max h` is another letter); this is
    ///   what the authors' program computes, it needs no sea level, and it uses all bins on a high plateau too.
    /// - Relative prominence is missing where the greatest prominence is not positive; relevance
    ///   `sqrt(π / max π * h / max h)`, with the paper's `h̃`, also where an elevation is negative or the greatest one
    ///   is not positive.
    /// - Directions and distances are missing where there is no key saddle, or nothing higher.
    pub fn value(self, peak: &PeakMeasures, frame: &Frame) -> Option<f64> {
        let over = |part: f64, whole: f64| (whole > 0.0).then(|| part / whole);
        let value = match self {
            Self::Dominance | Self::DominanceGroups => over(peak.prominence_m, peak.elevation_m),
            Self::NormalisedElevation => over(peak.elevation_m - frame.lowest_m, frame.highest_m - frame.lowest_m),
            Self::IsolationDirection => peak.isolation_azimuth.map(turned),
            Self::IsolationDistance => peak.isolation_m.map(|d| d / frame.radius_m),
            Self::SaddleDirection => peak.saddle_azimuth.map(turned),
            Self::SaddleDistance => peak.saddle_distance_m.map(|d| d / frame.radius_m),
            Self::Prominence => Some(peak.prominence_m),
            Self::RelativeProminence => over(peak.prominence_m, frame.most_prominent_m),
            Self::Relevance => over(peak.prominence_m, frame.most_prominent_m)
                .zip(over(peak.elevation_m, frame.highest_m))
                .filter(|&(p, h)| p >= 0.0 && h >= 0.0)
                .map(|(p, h)| (p * h).sqrt()),
            Self::Elevation => Some(peak.elevation_m),
        };
        value.filter(|v| v.is_finite())
    }

    /// Whether nothing unknown could change what the value rests on: the prominence (and with it the key saddle) or
    /// the isolation. Elevations are always certain; what the greatest values of the domain add is not counted.
    pub fn is_certain(self, peak: &PeakMeasures) -> bool {
        match self {
            Self::IsolationDirection | Self::IsolationDistance => peak.isolation_certain,
            Self::NormalisedElevation | Self::Elevation => true,
            _ => peak.prominence_certain,
        }
    }
}

/// An azimuth brought into 0 to 360 degrees, 360 excluded.
fn turned(azimuth: f64) -> f64 {
    let turned = azimuth.rem_euclid(360.0);
    // A tiny negative number rounds up to the full turn.
    if turned < 360.0 { turned } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn peak(elevation_m: f64, prominence_m: f64) -> PeakMeasures {
        PeakMeasures { elevation_m, prominence_m, ..PeakMeasures::default() }
    }

    #[test]
    fn values_by_hand() {
        let (top, low) = (peak(4000.0, 4000.0), peak(1000.0, 250.0));
        let frame = Frame::of(&[&low, &top], 30_000.0).unwrap();
        let of = |m: Measure, p| m.value(p, &frame);
        assert_eq!(of(Measure::Dominance, &low), Some(0.25));
        assert_eq!(
            (of(Measure::NormalisedElevation, &low), of(Measure::NormalisedElevation, &top)),
            (Some(0.0), Some(1.0))
        );
        assert_eq!(of(Measure::RelativeProminence, &low), Some(0.0625));
        assert_eq!(of(Measure::Relevance, &low), Some(0.125), "sqrt(1/16 * 1/4)");
        assert_eq!(of(Measure::IsolationDistance, &low), None);
        let placed = PeakMeasures { isolation_m: Some(45_000.0), isolation_azimuth: Some(-1e-17), ..low.clone() };
        assert_eq!(of(Measure::IsolationDistance, &placed), Some(1.5));
        assert_eq!(of(Measure::IsolationDirection, &placed), Some(0.0), "never 360");
    }

    #[test]
    fn below_the_sea() {
        let (ridge, seamount) = (peak(-200.0, 1800.0), peak(-2500.0, 700.0));
        let frame = Frame::of(&[&ridge, &seamount], 30_000.0).unwrap();
        assert_eq!(Measure::Dominance.value(&ridge, &frame), None);
        assert_eq!(Measure::Relevance.value(&ridge, &frame), None);
        assert_eq!(Measure::NormalisedElevation.value(&seamount, &frame), Some(0.0));
        let flat = Frame::of(&[&ridge], 30_000.0).unwrap();
        assert_eq!(Measure::NormalisedElevation.value(&ridge, &flat), None, "one height is no range");
    }

    #[test]
    fn names_come_back() {
        for measure in Measure::ALL {
            assert_eq!(Measure::from_name(measure.name()), Some(measure));
        }
        assert_eq!(Measure::ALL[..10], Measure::TABLE_1);
    }
}
