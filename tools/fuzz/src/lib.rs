//! What the fuzzers of `targets/` and the maker of their seeds share.

#[path = "../../../tests/codec/ground.rs"]
pub mod ground;
pub mod input;
#[path = "../../../tests/codec/promise.rs"]
pub mod promise;
pub mod seal;
