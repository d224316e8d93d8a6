//! Writes the models of this folder: `cargo run --example generate-models [folder]`, by default the folder of this file; or a landscape
//! of any size: `cargo run --example generate-models terrain TRIANGLES FILE.glb`.

#[path = "generator/mod.rs"]
mod generator;

use std::path::{Path, PathBuf};
use std::{env, fs, io};

fn main() -> io::Result<()> {
    let arguments: Vec<_> = env::args().skip(1).collect();
    if let [word, triangles, file] = &arguments[..]
        && word == "terrain"
    {
        let triangles = triangles.parse::<u32>().ok();
        let triangles = triangles.filter(|t| (1..=generator::MOST_TRIANGLES).contains(t));
        let triangles = triangles.ok_or_else(|| {
            let most = generator::MOST_TRIANGLES;
            io::Error::other(format!(
                "terrain: want a number of triangles from 1 to {most}"
            ))
        })?;
        return fs::write(file, generator::terrain(triangles));
    }
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
