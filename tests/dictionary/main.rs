//! Dictionaries against slow references, over many small terrains.
//!
//! `PROPTEST_CASES` sets how many terrains each property looks at.

#![cfg(feature = "program")]
#![allow(unreachable_pub, reason = "modules of a test binary say what they offer to each other")]

mod ground;
mod learning;
mod matching;
mod pairs;
mod rebuilding;
mod reference;

/// How many terrains a property looks at, unless `PROPTEST_CASES` says it.
fn cases(usual: u32) -> proptest::test_runner::Config {
    let cases = std::env::var("PROPTEST_CASES").ok().and_then(|n| n.parse().ok()).unwrap_or(usual);
    proptest::test_runner::Config { cases, max_shrink_iters: 400, failure_persistence: None, ..Default::default() }
}

/// Runs something with a number of threads.
fn with_threads<T: Send>(threads: usize, work: impl FnOnce() -> T + Send) -> T {
    rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool of threads").install(work)
}
