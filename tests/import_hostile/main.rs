//! Files that are broken at random, and files made to harm: each gives a scene that keeps its rules or an error of one line, in
//! bounded time and memory.
//!
//! The fuzz targets of `tests/fuzz` look for such files without an end; what they found stands here as a case.

#[path = "../support/import_contract.rs"]
mod import_contract;
#[path = "../support/random.rs"]
#[allow(dead_code, reason = "other tests use the rest")]
mod random;

mod bombs;
mod claims;
mod found;
mod mutations;
mod setup;
mod texts;
