//! The models of this folder as functions: the same bytes on every machine, without clock, chance or the C library's sine.

mod cornell_box;
mod gltf;
mod lecture_block;
mod lecture_objects;
mod malformed;
mod shapes;

use std::io;

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

/// Every generated model.
pub(crate) fn files() -> io::Result<Vec<GeneratedFile>> {
    let mut files = vec![
        GeneratedFile::new("lecture-block.obj", lecture_block::obj()),
        GeneratedFile::new("lecture-objects.gltf", lecture_objects::gltf()?),
        GeneratedFile::new("cornell-box.obj", cornell_box::obj()),
        GeneratedFile::new("cornell-box.mtl", cornell_box::MTL),
    ];
    files.extend(malformed::files());
    Ok(files)
}
