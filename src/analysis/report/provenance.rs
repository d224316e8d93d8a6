//! Where a report's numbers come from: everything that is needed to get them again.

use serde_json::{Map, Value, json};

use crate::analysis::{compiled_instructions, machine, processor};

/// Facts about a run, by name, in the order in which they are told.
#[derive(Clone, Debug, PartialEq)]
pub struct Provenance {
    facts: Vec<(String, String)>,
}

impl Provenance {
    /// The program's version and commit, the machine, the instruction sets, and the command line.
    ///
    /// The commit is the one that the environment named as `BSPRAY_COMMIT` when the program was compiled.
    pub fn of_run(command_line: &str) -> Self {
        let commit = option_env!("BSPRAY_COMMIT").unwrap_or("not known");
        let threads = std::thread::available_parallelism().map_or(0, usize::from);
        Self { facts: Vec::new() }
            .with("command line", command_line)
            .with("bspray", env!("CARGO_PKG_VERSION"))
            .with("commit", commit)
            .with("processor", processor().as_deref().unwrap_or("not known"))
            .with("hardware threads", &threads.to_string())
            .with("machine and its instructions", &machine())
            .with("instructions compiled for", &compiled_instructions())
    }

    /// With one more fact.
    #[must_use]
    pub fn with(mut self, name: &str, value: &str) -> Self {
        self.facts.push((name.to_owned(), value.to_owned()));
        self
    }

    /// All facts.
    pub fn facts(&self) -> &[(String, String)] {
        &self.facts
    }

    /// One object.
    pub fn json(&self) -> Value {
        let facts = self.facts.iter();
        Value::Object(
            facts
                .map(|(k, v)| (k.clone(), json!(v)))
                .collect::<Map<_, _>>(),
        )
    }
}
