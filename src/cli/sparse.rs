//! Words about patches and dictionaries that verbs share.

use super::container_text::{band_lines, bands_json, number, size_text};
use super::shared::PartOptions;
use crate::dictionary::Storage;
use crate::error::{Error, Result};
use crate::io::raster::stored::StoredOptions;
use crate::oro::{Description, Dictionary};
use crate::pipeline::sparse::ModelOptions;
use crate::pipeline::sparse::encode::SparseReport;
use clap::Args;
use serde_json::{Value, json};

/// What to read of a raster that is kept as it is.
#[derive(Args, Clone, Debug)]
#[command(next_help_heading = "Input")]
pub(super) struct StoredInput {
    /// Band to read, from 1; may be given several times. All unless given.
    #[arg(long = "band", value_name = "N")]
    bands: Vec<usize>,
    /// Value of cells without data; replaces a declared one.
    #[arg(long, value_name = "VALUE", allow_negative_numbers = true)]
    nodata: Option<f64>,
    /// CRS that replaces the input's: EPSG:2056, WKT, a PROJ string.
    #[arg(long, value_name = "CRS")]
    crs: Option<String>,
    /// Unit of the elevations: m, ft, us-ft, dm, cm, ...; replaces a declared one.
    #[arg(long, value_name = "UNIT")]
    pub(super) vertical_unit: Option<String>,
    #[command(flatten)]
    part: PartOptions,
}

impl StoredInput {
    /// What the options mean.
    pub(super) fn meant(&self) -> Result<StoredOptions> {
        let (window, bbox) = self.part.meant()?;
        Ok(StoredOptions { bands: self.bands.clone(), nodata: self.nodata, crs: self.crs.clone(), window, bbox })
    }

    /// The first of the options that was given.
    pub(super) fn first_said(&self) -> Option<&'static str> {
        let said = [
            ("--band", !self.bands.is_empty()),
            ("--nodata", self.nodata.is_some()),
            ("--crs", self.crs.is_some()),
            ("--vertical-unit", self.vertical_unit.is_some()),
        ];
        said.iter().find(|(_, said)| *said).map(|(option, _)| *option).or_else(|| self.part.first_said())
    }
}

/// How patches are described.
#[derive(Args, Clone, Debug, Default)]
#[command(next_help_heading = "Patches")]
pub(super) struct PatchOptions {
    /// Atoms to learn [default: 128].
    #[arg(long, value_name = "N")]
    pub(super) atoms: Option<usize>,
    /// Most atoms of a patch, 1 to 64 [default: 2].
    #[arg(long, value_name = "S", value_parser = clap::value_parser!(u8).range(1..=64))]
    pub(super) sparsity: Option<u8>,
    /// Side of a patch in cells [default: 8].
    #[arg(long, value_name = "CELLS")]
    pub(super) patch: Option<usize>,
    /// From one patch to the next in cells; half a side unless given.
    #[arg(long, value_name = "CELLS")]
    pub(super) step: Option<usize>,
    /// Turns of learning [default: 10].
    #[arg(long, value_name = "N")]
    pub(super) iterations: Option<usize>,
    /// Seed that the first atoms are drawn by [default: 1].
    #[arg(long, value_name = "N")]
    pub(super) seed: Option<u64>,
}

impl PatchOptions {
    /// What the options mean.
    pub(super) fn meant(&self) -> ModelOptions {
        let usual = ModelOptions::default();
        ModelOptions {
            atoms: self.atoms.unwrap_or(usual.atoms),
            sparsity: self.sparsity.map_or(usual.sparsity, usize::from),
            side: self.patch.unwrap_or(usual.side),
            step: self.step,
            iterations: self.iterations.unwrap_or(usual.iterations),
            seed: self.seed.unwrap_or(usual.seed),
        }
    }

    /// Refuses options that say nothing without another.
    pub(super) fn only_with(&self, given: bool, option: &str) -> Result<()> {
        let said = [
            ("--atoms", self.atoms.is_some()),
            ("--sparsity", self.sparsity.is_some()),
            ("--patch", self.patch.is_some()),
            ("--step", self.step.is_some()),
            ("--iterations", self.iterations.is_some()),
            ("--seed", self.seed.is_some()),
        ];
        match said.iter().find(|(_, said)| *said && !given) {
            Some((name, _)) => Err(Error::usage(format!("{name}: it is for {option} only"))),
            None => Ok(()),
        }
    }
}

/// What `encode --sparse` did, in words.
pub(super) fn sparse_text(report: &SparseReport) -> String {
    let SparseReport { description, summary, model, .. } = report;
    format!(
        "{} x {} cells in {} patches, {} terms: {} of {} ({:.1} times smaller), {:.3} bits a cell, {:.1} s\n{}{}",
        description.width,
        description.height,
        model.patches(),
        model.terms(),
        size_text(summary.bytes),
        size_text(report.raw_bytes),
        report.raw_bytes as f64 / summary.bytes as f64,
        report.bits_per_cell(),
        report.time.as_secs_f64(),
        dictionary_lines(description, &model.dictionary),
        band_lines(description, Some(&summary.largest_errors)),
    )
}

/// A dictionary in words, a line for each thing.
pub(super) fn dictionary_lines(description: &Description, dictionary: &Dictionary) -> String {
    let storage = storage_of(description, dictionary);
    let unit = description.bands.first().map_or("", |band| band.unit.as_str());
    let mut text = format!(
        "dictionary: {} atoms of {} x {} cells, at most {} a patch, a patch every {} cells\n",
        dictionary.count(),
        dictionary.side,
        dictionary.side,
        dictionary.sparsity,
        dictionary.step,
    );
    let found = dictionary.found;
    if found.greatest > found.least {
        text += &format!(
            "psnr: {:.1} dB (root mean square error {:.3} {unit}, range {:.0} {unit})\n",
            dictionary.psnr_db(),
            found.rmse,
            found.greatest - found.least,
        );
        text += &format!(
            "values to store: {:.1} % of the cells by the paper's formula, {:.1} % as its table counts\n",
            100.0 * storage.ratio_as_printed(),
            100.0 * storage.ratio_as_counted(),
        );
    }
    text
}

/// A dictionary for a JSON document.
pub(super) fn dictionary_json(description: &Description, dictionary: &Dictionary) -> Value {
    let storage = storage_of(description, dictionary);
    let Dictionary { found, steps, .. } = dictionary;
    json!({
        "atoms": dictionary.count(),
        "patch": dictionary.side,
        "step": dictionary.step,
        "sparsity": dictionary.sparsity,
        "mean_step": steps.mean,
        "coefficient_step": steps.part,
        "atom_step": steps.atom,
        "least": number(found.least),
        "greatest": number(found.greatest),
        "rmse": number(found.rmse),
        "psnr_db": number(dictionary.psnr_db()),
        "rho_as_printed": storage.ratio_as_printed(),
        "rho_as_counted": storage.ratio_as_counted(),
    })
}

fn storage_of(description: &Description, dictionary: &Dictionary) -> Storage {
    let lattice = dictionary.lattice(description);
    Storage {
        cells: description.width * description.height,
        patches: lattice.across * lattice.down,
        values: dictionary.side * dictionary.side,
        atoms: dictionary.count(),
        sparsity: dictionary.sparsity,
    }
}

/// What `encode --sparse` did, as JSON.
pub(super) fn sparse_json(report: &SparseReport) -> Value {
    let SparseReport { description, summary, model, .. } = report;
    json!({
        "cols": description.width,
        "rows": description.height,
        "tile_size": description.tile_side,
        "tiles": description.tiling().tiles(),
        "cells": description.width * description.height,
        "bytes": summary.bytes,
        "cell_bytes": summary.chunk_bytes,
        "raw_bytes": report.raw_bytes,
        "ratio": report.raw_bytes as f64 / summary.bytes as f64,
        "bits_per_cell": report.bits_per_cell(),
        "patches": model.patches(),
        "terms": model.terms(),
        "mean_bytes": report.segment_bytes[0],
        "term_bytes": report.segment_bytes[1],
        "void_bytes": report.segment_bytes[2],
        "dictionary": dictionary_json(description, &model.dictionary),
        "bands": bands_json(description, Some(&summary.largest_errors)),
        "seconds": report.time.as_secs_f64(),
    })
}
