//! A model comes back from its file as it was, and nothing damaged gets through.

use super::schema::validate;
use orograph::classify::{ClassRecord, Conditions, Forest, ForestOptions, Model, Samples, table};
use orograph::error::ErrorKind;
use orograph::rng::Rng;
use orograph::watch::Watch;
use std::panic::catch_unwind;

fn model() -> (Model, Samples) {
    let features: usize = table().iter().map(|feature| feature.bins).sum();
    let mut rng = Rng::new(4);
    let rows: Vec<(Vec<f64>, u32)> =
        (0..40).map(|i| ((0..features).map(|_| rng.unit() / 3.0).collect(), i % 3)).collect();
    let samples = Samples::new(&rows, 3).expect("sound samples");
    let grown = Forest::grow(&samples, &ForestOptions { trees: 3, seed: 1 }, &Watch::default()).expect("grown");
    let conditions = Conditions { disk_radius_m: 10_000.0, min_peaks: 10, min_prominence_m: Some(30.48) };
    let classes = ["a", "b", "c"].map(|name| ClassRecord { name: name.into(), disks: 13 }).to_vec();
    (Model::new(conditions, classes, grown.forest), samples)
}

#[test]
fn there_and_back() {
    let (model, samples) = model();
    let back = Model::from_json(&model.to_json()).expect("it reads what it wrote");
    assert_eq!(back, model, "thresholds to the bit");
    assert_eq!(back.to_json(), model.to_json());
    for sample in 0..40 {
        let row = samples.row(sample);
        let (class, probabilities) = back.tell(&row);
        assert_eq!(probabilities, model.forest.probabilities(&row, 3));
        assert!(probabilities.iter().all(|&p| p <= probabilities[class]));
    }
}

#[test]
fn files_fit_the_schema() {
    let schema: serde_json::Value =
        serde_json::from_str(include_str!("../../format-spec/classifier.schema.json")).expect("the schema is JSON");
    let (mut model, _) = model();
    for min_prominence_m in [Some(30.48), None] {
        model.conditions.min_prominence_m = min_prominence_m;
        let document = serde_json::from_str(&model.to_json()).expect("JSON");
        validate(&document, &schema, &schema, "model");
    }
    let mut document: serde_json::Value = serde_json::from_str(&model.to_json()).expect("JSON");
    document["forest"][0][0] = serde_json::json!({ "feature": 176, "threshold": 0.5, "right": 2 });
    assert!(catch_unwind(|| validate(&document, &schema, &schema, "model")).is_err(), "there is no such feature");
}

#[test]
fn damage_is_refused_or_harmless() {
    let (model, samples) = model();
    let text = model.to_json();
    for end in 0..text.len() - 1 {
        let error = Model::from_json(&text[..end]).expect_err("it breaks off");
        assert!(matches!(error.kind(), ErrorKind::Input | ErrorKind::Corrupt), "{end}: {error}");
    }
    // A byte changed anywhere: what is still read can be asked without a panic.
    let mut rng = Rng::new(2);
    let mut read = 0;
    for _ in 0..4000 {
        let mut bytes = text.clone().into_bytes();
        let at = rng.below(bytes.len() as u64) as usize;
        bytes[at] = b"0123456789-.e,:{}[]\""[rng.below(20) as usize];
        let damaged = String::from_utf8(bytes).expect("ASCII");
        if let Ok(model) = Model::from_json(&damaged) {
            read += 1;
            let row = samples.row(0);
            assert!(catch_unwind(|| model.tell(&row)).is_ok(), "byte {at}");
        }
    }
    assert!(read > 100, "digits of thresholds may change: {read}");
}
