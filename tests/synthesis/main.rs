//! Synthesis: trees are trees, measures are what a slow reference finds, and histograms are those of the range.
//!
//! `PROPTEST_CASES` sets how many ranges each property looks at.

#![cfg(feature = "program")]
#![allow(unreachable_pub, reason = "modules of a test binary say what they offer to each other")]

mod controls;
mod kept;
mod likeness;
mod measures;
mod range;
mod reference;
mod terrain;

/// How many ranges a property looks at, unless `PROPTEST_CASES` says it.
fn cases(usual: u32) -> proptest::test_runner::Config {
    let cases = std::env::var("PROPTEST_CASES").ok().and_then(|n| n.parse().ok()).unwrap_or(usual);
    proptest::test_runner::Config { cases, max_shrink_iters: 1000, failure_persistence: None, ..Default::default() }
}
