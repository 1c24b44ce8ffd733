//! Construction trees: random trees of all nodes against a literal reference, their bounds, and each other.
//!
//! `PROPTEST_CASES` sets how many trees each property looks at.

#![cfg(feature = "program")]
#![allow(unreachable_pub, reason = "modules of a test binary say what they offer to each other")]

mod agreement;
mod bounds;
mod literal;
mod primitives;
mod scene;
mod sparse;
mod spec;
mod strategy;
mod trace;

/// How many trees a property looks at, unless `PROPTEST_CASES` says it.
fn cases(usual: u32) -> proptest::test_runner::Config {
    let cases = std::env::var("PROPTEST_CASES").ok().and_then(|n| n.parse().ok()).unwrap_or(usual);
    proptest::test_runner::Config { cases, max_shrink_iters: 4000, failure_persistence: None, ..Default::default() }
}
