//! Writes the models of this folder: `cargo run --example generate-models [folder]`, by default the folder of this file.

#[path = "generator/mod.rs"]
mod generator;

use std::path::{Path, PathBuf};
use std::{env, fs, io};

fn main() -> io::Result<()> {
    let beside = Path::new(env!("CARGO_MANIFEST_DIR")).join("models");
    let folder = env::args_os().nth(1).map_or(beside, PathBuf::from);
    for file in generator::files()? {
        let path = folder.join(file.name);
        if let Some(parent) = path.parent() {
            fs::create_dir_all(parent)?;
        }
        fs::write(path, file.contents)?;
    }
    Ok(())
}
