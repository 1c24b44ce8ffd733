//! The histograms of all measures, as files and programs handle them together.

use super::bins::BinSet;
use super::histogram::Histogram;
use super::measure::{Frame, Measure};
use super::peaks::PeakMeasures;
use crate::error::{Error, ErrorKind, Result};
use serde::de::{Error as _, MapAccess, Visitor};
use serde::ser::SerializeMap;
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use std::fmt;
use std::marker::PhantomData;

/// One value for each measure of [`Measure::ALL`]; a map by name in files.
#[derive(Clone, Debug, PartialEq)]
pub struct PerMeasure<T>(Vec<T>);

/// Histograms of all measures in the fine bins.
pub type Histograms = PerMeasure<Histogram>;

/// What is known of the distributions of all measures in a domain.
pub type Metrics = PerMeasure<MeasureStatistics>;

/// The distribution of one measure.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct MeasureStatistics {
    /// Peaks without a value.
    pub missing: u64,
    /// Peaks that are counted although what their value rests on could change with what is unknown.
    pub uncertain: u64,
    /// Histogram in the paper's bins; `None` for plain elevations.
    pub paper: Option<Histogram>,
    /// Histogram in the fine bins.
    pub fine: Histogram,
}

impl MeasureStatistics {
    /// The histogram in one of the two sets of bins.
    pub fn histogram(&self, set: BinSet) -> Option<&Histogram> {
        match set {
            BinSet::Paper => self.paper.as_ref(),
            BinSet::Fine => Some(&self.fine),
        }
    }
}

impl<T> PerMeasure<T> {
    /// The values of all measures.
    pub fn from_fn(value: impl FnMut(Measure) -> T) -> Self {
        Self(Measure::ALL.into_iter().map(value).collect())
    }

    /// The value of a measure.
    pub fn get(&self, measure: Measure) -> &T {
        &self.0[measure as usize]
    }

    /// The value of a measure, to be changed.
    pub fn get_mut(&mut self, measure: Measure) -> &mut T {
        &mut self.0[measure as usize]
    }

    /// All measures with their values, in the order of files.
    pub fn iter(&self) -> impl Iterator<Item = (Measure, &T)> {
        Measure::ALL.into_iter().zip(&self.0)
    }
}

/// Counts the measures of a domain's peaks in both sets of bins.
pub(super) fn count(peaks: &[&PeakMeasures], frame: &Frame) -> Metrics {
    PerMeasure::from_fn(|measure| {
        let histogram = |set: BinSet| set.edges(measure, (frame.lowest_m, frame.highest_m)).map(Histogram::new);
        let mut statistics = MeasureStatistics {
            missing: 0,
            uncertain: 0,
            paper: histogram(BinSet::Paper),
            fine: histogram(BinSet::Fine).expect("the fine set has bins for every measure"),
        };
        for peak in peaks {
            match measure.value(peak, frame) {
                Some(value) => {
                    statistics.fine.add(value);
                    statistics.paper.iter_mut().for_each(|h| h.add(value));
                    statistics.uncertain += u64::from(!measure.is_certain(peak));
                }
                None => statistics.missing += 1,
            }
        }
        statistics
    })
}

/// Counts the measures of some of a domain's peaks in its fine bins.
pub(super) fn count_fine(peaks: &[&PeakMeasures], frame: &Frame) -> Histograms {
    let metrics = count(peaks, frame);
    PerMeasure(metrics.0.into_iter().map(|statistics| statistics.fine).collect())
}

/// Checks that a histogram of a measure has the shape that the measure asks for.
pub(super) fn check(measure: Measure, histogram: &Histogram) -> Result<()> {
    histogram.check()?;
    let (first, last) = (histogram.edges[0], histogram.edges[histogram.edges.len() - 1]);
    if matches!(measure, Measure::IsolationDirection | Measure::SaddleDirection) && (first, last) != (0.0, 360.0) {
        return Err(Error::new(
            ErrorKind::Corrupt,
            format!("bins of directions go from 0 to 360 degrees, these from {first} to {last}"),
        ));
    }
    Ok(())
}

impl<T: Serialize> Serialize for PerMeasure<T> {
    fn serialize<S: Serializer>(&self, serializer: S) -> std::result::Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(Some(self.0.len()))?;
        for (measure, value) in self.iter() {
            map.serialize_entry(measure.name(), value)?;
        }
        map.end()
    }
}

impl<'de, T: Deserialize<'de>> Deserialize<'de> for PerMeasure<T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> std::result::Result<Self, D::Error> {
        deserializer.deserialize_map(PerMeasureVisitor(PhantomData))
    }
}

struct PerMeasureVisitor<T>(PhantomData<T>);

impl<'de, T: Deserialize<'de>> Visitor<'de> for PerMeasureVisitor<T> {
    type Value = PerMeasure<T>;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a map with one entry for each metric")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> std::result::Result<Self::Value, A::Error> {
        let mut values: Vec<Option<T>> = Measure::ALL.iter().map(|_| None).collect();
        while let Some(name) = map.next_key::<String>()? {
            match Measure::from_name(&name) {
                // A later minor version may count more.
                None => {
                    map.next_value::<serde::de::IgnoredAny>()?;
                }
                Some(measure) => {
                    let value = map.next_value().map_err(|e| A::Error::custom(format!("metric {name}: {e}")))?;
                    if values[measure as usize].replace(value).is_some() {
                        return Err(A::Error::custom(format!("metric {name} is there twice")));
                    }
                }
            }
        }
        if let Some((missing, _)) = Measure::ALL.into_iter().zip(&values).find(|(_, v)| v.is_none()) {
            return Err(A::Error::custom(format!("metric {} is missing", missing.name())));
        }
        Ok(PerMeasure(values.into_iter().flatten().collect()))
    }
}
