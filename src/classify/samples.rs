//! What a forest learns from: rows of numbers, each with its class.

use crate::error::{Error, ErrorKind, Result};

/// Most samples of a forest; impurities of so many are compared without rounding.
pub const MOST_SAMPLES: usize = 1 << 20;

/// Samples: for each a number of every feature, and a class.
#[derive(Clone, Debug, PartialEq)]
pub struct Samples {
    /// The values of the first feature, sample by sample, then those of the second ...
    values: Vec<f64>,
    features: usize,
    /// The class of each sample, counted from 0.
    labels: Vec<u32>,
    classes: usize,
}

impl Samples {
    /// Samples of `classes` classes from rows of equal length, each with its class.
    ///
    /// # Errors
    /// `Input` without rows or features, with more than [`MOST_SAMPLES`] rows, with rows of different lengths, with
    /// values that are no finite numbers, and with a class that there is not.
    pub fn new(rows: &[(Vec<f64>, u32)], classes: usize) -> Result<Self> {
        let refuse = |message: String| Err(Error::new(ErrorKind::Input, message));
        let features = rows.first().map_or(0, |(row, _)| row.len());
        if features == 0 {
            return refuse("there is nothing to learn from: no samples, or samples without features".into());
        }
        if rows.len() > MOST_SAMPLES {
            return refuse(format!("{} samples: a forest learns from at most {MOST_SAMPLES}", rows.len()));
        }
        let mut values = vec![0.0; rows.len() * features];
        for (sample, (row, label)) in rows.iter().enumerate() {
            if row.len() != features {
                return refuse(format!("sample {sample} has {} features: expected {features}", row.len()));
            }
            if *label as usize >= classes {
                return refuse(format!("sample {sample} is of class {label}: expected one below {classes}"));
            }
            for (feature, &value) in row.iter().enumerate() {
                if !value.is_finite() {
                    return refuse(format!(
                        "feature {feature} of sample {sample} is {value}: expected a finite number"
                    ));
                }
                // Only one zero.
                values[feature * rows.len() + sample] = value + 0.0;
            }
        }
        Ok(Self { values, features, labels: rows.iter().map(|(_, label)| *label).collect(), classes })
    }

    /// Number of samples.
    pub fn len(&self) -> usize {
        self.labels.len()
    }

    /// Whether there are none; never so.
    pub fn is_empty(&self) -> bool {
        self.labels.is_empty()
    }

    /// Number of features.
    pub fn features(&self) -> usize {
        self.features
    }

    /// Number of classes.
    pub fn classes(&self) -> usize {
        self.classes
    }

    /// The class of a sample.
    pub fn label(&self, sample: u32) -> u32 {
        self.labels[sample as usize]
    }

    /// The value of a feature in a sample.
    pub fn value(&self, feature: usize, sample: u32) -> f64 {
        self.values[feature * self.labels.len() + sample as usize]
    }

    /// All features of a sample.
    pub fn row(&self, sample: u32) -> Vec<f64> {
        (0..self.features).map(|feature| self.value(feature, sample)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_refused() {
        for (rows, words) in [
            (vec![], "nothing to learn from"),
            (vec![(vec![], 0)], "nothing to learn from"),
            (vec![(vec![1.0], 0), (vec![1.0, 2.0], 0)], "sample 1 has 2 features"),
            (vec![(vec![1.0], 2)], "class 2"),
            (vec![(vec![f64::NAN], 0)], "feature 0 of sample 0 is NaN"),
            (vec![(vec![1.0, f64::INFINITY], 0)], "feature 1 of sample 0 is inf"),
        ] {
            let error = Samples::new(&rows, 2).unwrap_err();
            assert!(error.kind() == ErrorKind::Input && error.to_string().contains(words), "{error}");
        }
        let samples = Samples::new(&[(vec![1.0, -0.0], 1), (vec![3.0, 4.0], 0)], 2).unwrap();
        assert_eq!((samples.row(0), samples.row(1)), (vec![1.0, 0.0], vec![3.0, 4.0]));
        assert!(samples.value(1, 0).is_sign_positive());
        assert_eq!((samples.len(), samples.features(), samples.label(0)), (2, 2, 1));
    }
}
