//! The models of this folder as functions: the same bytes on every machine, without clock, chance or the C library's sine.

mod cornell_box;
mod courtyard;
mod gltf;
mod lecture_block;
mod lecture_edges;
mod lecture_objects;
mod malformed;
mod shapes;
mod terrain;

use std::io;

pub(crate) use terrain::{MOST_TRIANGLES, terrain};

/// A file to be written.
pub(crate) struct GeneratedFile {
    /// Its path below the folder of models, with `/` between folders.
    pub name: &'static str,
    /// What it holds.
    pub contents: Vec<u8>,
}

impl GeneratedFile {
    fn new(name: &'static str, contents: impl Into<Vec<u8>>) -> Self {
        Self {
            name,
            contents: contents.into(),
        }
    }
}

/// A polygon that a fan would triangulate wrongly.
const CONCAVE: &str = "\
# A concave polygon of 8 corners, shaped like a U: 6 triangles that cover an area of 7. A fan would fill the notch.
v 0 0 0
v 3 0 0
v 3 3 0
v 2 3 0
v 2 1 0
v 1 1 0
v 1 3 0
v 0 3 0
f 1 2 3 4 5 6 7 8
";

/// Every generated model.
pub(crate) fn files() -> io::Result<Vec<GeneratedFile>> {
    let mut files = vec![
        GeneratedFile::new("lecture-block.obj", lecture_block::obj()),
        GeneratedFile::new("lecture-edges.obj", lecture_edges::obj()),
        GeneratedFile::new("lecture-objects.gltf", lecture_objects::gltf()?),
        GeneratedFile::new("courtyard.glb", courtyard::glb()?),
        GeneratedFile::new("concave.obj", CONCAVE),
        GeneratedFile::new("cornell-box.obj", cornell_box::obj()),
        GeneratedFile::new("cornell-box.mtl", cornell_box::MTL),
    ];
    files.extend(malformed::files());
    Ok(files)
}
