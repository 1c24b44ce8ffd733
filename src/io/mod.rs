//! Files in and out through GDAL: the only folder that says `gdal::`.

mod features;

pub use features::{Feature, Layer, LayerSummary, Value, list_layers, read_layer};
