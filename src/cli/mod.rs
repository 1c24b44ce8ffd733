//! The command line: words to calls, results to words. One file a verb.

mod amplify;
mod classify;
mod container_info;
mod container_text;
mod decode;
mod encode;
mod exactness;
mod info;
mod learn;
mod map;
mod peaks;
mod progress;
mod report;
mod scene;
mod shared;
mod sparse;
mod stats;
mod stats_text;
mod synthesize;
mod tags;
mod teaching;
mod terrain;
mod terrain_shape;
mod tin;
mod verify;

use crate::error::{Error, Result};
use clap::{Parser, Subcommand};
use report::Reporter;
use std::ffi::OsString;

/// Mountains from elevation models: peaks, key saddles, prominence, isolation, divide trees; and an archive for them.
#[derive(Debug, Parser)]
#[command(name = "orograph", disable_version_flag = true, max_term_width = 100, arg_required_else_help = true)]
struct Arguments {
    /// Print the versions of orograph, GDAL and PROJ.
    #[arg(short = 'V', long)]
    version: bool,
    #[command(subcommand)]
    verb: Option<Verb>,
}

#[derive(Debug, Subcommand)]
enum Verb {
    Amplify(Box<amplify::Amplify>),
    Classify(classify::Classify),
    Decode(Box<decode::Decode>),
    Encode(Box<encode::Encode>),
    Info(info::Info),
    Learn(Box<learn::Learn>),
    Map(map::Map),
    Peaks(Box<peaks::Peaks>),
    Scene(scene::Scene),
    Stats(Box<stats::Stats>),
    Synthesize(Box<synthesize::Synthesize>),
    Terrain(Box<terrain::Terrain>),
    Tin(Box<tin::Tin>),
    Verify(verify::Verify),
}

/// Runs the program with its arguments, the program's name first; returns the exit code.
pub fn run(arguments: impl IntoIterator<Item = OsString>) -> u8 {
    let arguments: Vec<OsString> = arguments.into_iter().collect();
    // A wrong call has no options that could be asked whether JSON is wanted.
    let wants_json = arguments.iter().any(|argument| argument == "--json");
    let parsed = match Arguments::try_parse_from(&arguments) {
        Ok(parsed) => parsed,
        Err(error) => return report::usage(&error, wants_json),
    };
    if parsed.version {
        return report::version();
    }
    match parsed.verb {
        None => report::usage(&clap::Error::new(clap::error::ErrorKind::MissingSubcommand), wants_json),
        Some(Verb::Amplify(verb)) => execute("amplify", &verb.common.clone(), |reporter| verb.run(reporter)),
        Some(Verb::Classify(verb)) => verb.run(),
        Some(Verb::Decode(verb)) => execute("decode", &verb.common.clone(), |reporter| verb.run(reporter)),
        Some(Verb::Encode(verb)) => execute("encode", &verb.common.clone(), |reporter| verb.run(reporter)),
        Some(Verb::Info(verb)) => execute("info", &verb.common.clone(), |reporter| verb.run(reporter)),
        Some(Verb::Learn(verb)) => execute("learn", &verb.common.clone(), |reporter| verb.run(reporter)),
        Some(Verb::Map(verb)) => execute("map", &verb.common.clone(), |reporter| verb.run(reporter)),
        Some(Verb::Peaks(verb)) => execute("peaks", &verb.common.clone(), |reporter| verb.run(reporter)),
        Some(Verb::Scene(verb)) => verb.run(),
        Some(Verb::Stats(verb)) => execute("stats", &verb.common.clone(), |reporter| verb.run(reporter)),
        Some(Verb::Synthesize(verb)) => execute("synthesize", &verb.common.clone(), |reporter| verb.run(reporter)),
        Some(Verb::Terrain(verb)) => execute("terrain", &verb.common.clone(), |reporter| verb.run(reporter)),
        Some(Verb::Tin(verb)) => execute("tin", &verb.common.clone(), |reporter| verb.run(reporter)),
        Some(Verb::Verify(verb)) => execute("verify", &verb.common.clone(), |reporter| verb.run(reporter)),
    }
}

/// Runs one verb: threads, interrupts, report.
fn execute(
    verb: &'static str,
    common: &shared::CommonOptions,
    run: impl FnOnce(&mut Reporter) -> Result<serde_json::Value>,
) -> u8 {
    let mut reporter = Reporter::new(verb, common);
    let result = common.start_threads().and_then(|()| run(&mut reporter));
    reporter.finish(result)
}

/// A usage error of a value that clap let through.
fn wrong_value(option: &str, error: &Error) -> Error {
    Error::usage(format!("{option}: {error}"))
}
