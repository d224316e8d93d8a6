//! The models that are checked in are what the generator makes of its source, byte for byte.

#[path = "../models/generator/mod.rs"]
mod generator;

use std::fs;
use std::path::Path;

#[test]
fn models_are_what_the_generator_makes() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("models");
    for file in generator::files().unwrap() {
        let path = folder.join(file.name);
        let found = fs::read(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
        // Not `assert_eq`, which would print both.
        assert!(
            found == file.contents,
            "{} is not what the generator makes; run `cargo run --example generate-models`",
            path.display()
        );
    }
}

#[test]
fn every_malformed_file_is_generated() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("models/malformed");
    let files = generator::files().unwrap();
    for entry in fs::read_dir(folder).unwrap() {
        let name = format!("malformed/{}", entry.unwrap().file_name().to_str().unwrap());
        assert!(
            files.iter().any(|f| f.name == name),
            "{name} is not in the table"
        );
    }
}
