//! The only file that names `tobj`.
//!
//! It reads one list of vertices an object, each a combination of position, texture coordinate and normal in the order of
//! first use, and polygons as the file has them: its own triangulation is a fan, wrong for concave polygons.

use std::io::BufRead;
use std::panic::{AssertUnwindSafe, catch_unwind};

/// A material of an MTL file as `tobj` gives it.
pub(super) type MtlMaterial = tobj::Material;

/// An object's geometry. Attributes are empty or have one value a vertex.
#[derive(Debug, Default)]
pub(super) struct Geometry {
    /// x, y, z of each vertex.
    pub(super) positions: Vec<f32>,
    /// x, y, z of each vertex.
    pub(super) normals: Vec<f32>,
    /// u, v of each vertex, v upwards.
    pub(super) texcoords: Vec<f32>,
    /// Red, green, blue of each vertex.
    pub(super) colors: Vec<f32>,
    /// The vertices of all faces, in a row.
    pub(super) indices: Vec<u32>,
    /// The number of corners of each face; empty if all are triangles.
    pub(super) arities: Vec<u32>,
}

/// Reads an OBJ text of `v`, `vt`, `vn`, `o` and `f` statements: an entry for each `o` with faces.
///
/// # Errors
/// What `tobj` says, which knows no lines.
pub(super) fn read_objects(text: &mut impl BufRead) -> Result<Vec<Geometry>, String> {
    let options = tobj::LoadOptions {
        single_index: true,
        ..tobj::LoadOptions::default()
    };
    let no_library = |_: &std::path::Path| Err(tobj::LoadError::OpenFileFailed);
    let read = || tobj::load_obj_buf(text, &options, no_library);
    let (models, _) = without_panic(read)?.map_err(|e| e.to_string())?;
    let geometry = models.into_iter().map(|model| Geometry {
        positions: model.mesh.positions,
        normals: model.mesh.normals,
        texcoords: model.mesh.texcoords,
        colors: model.mesh.vertex_color,
        indices: model.mesh.indices,
        arities: model.mesh.face_arities,
    });
    // The reader closes the last object even if there is none.
    Ok(geometry.filter(|g| !g.indices.is_empty()).collect())
}

/// Reads the text of an MTL file.
///
/// # Errors
/// What `tobj` says, which knows no lines.
pub(super) fn read_materials(mut text: &[u8]) -> Result<Vec<MtlMaterial>, String> {
    let read = || tobj::load_mtl_buf(&mut text);
    let (materials, _) = without_panic(read)?.map_err(|e| e.to_string())?;
    Ok(materials)
}

/// The passes before this one leave nothing that is known to make `tobj` panic; this is for what is not known.
fn without_panic<T>(read: impl FnOnce() -> T) -> Result<T, String> {
    catch_unwind(AssertUnwindSafe(read)).map_err(|_| "the reader failed on this text".to_owned())
}
