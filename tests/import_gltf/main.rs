//! glTF files as they should be and as they should not, through the public loader.

mod animations;
mod extensions;
mod files;
mod materials;
mod meshes;
mod model;
mod nodes;
mod packed;
mod shown;
mod skins;
mod variants;
mod verdicts;
