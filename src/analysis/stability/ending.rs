//! How the work on one step of a sweep ended.

use serde::{Deserialize, Serialize};

/// How the work on a cell ended.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Ending {
    /// All rays were answered.
    #[default]
    Answered,
    /// The child process was ended after so many seconds of processor time.
    DidNotEnd {
        /// The limit.
        seconds: u32,
    },
    /// The child process ended itself, and this is how.
    Died {
        /// Such as "stack overflow".
        how: String,
    },
    /// Its brute force needs more time than it is given at this size, or it failed to end at a smaller one.
    NotTried,
}
