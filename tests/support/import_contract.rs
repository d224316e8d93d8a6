//! What every import owes, whatever the file: a scene that keeps its own rules, or an error of one line that begins with the file.
//!
//! Used by the tests and by the fuzz targets of `tests/fuzz`.

use std::path::Path;

use bspray::geometry::tolerance::COORDINATE_LIMIT;
use bspray::import::{ImportOptions, load_with};
use bspray::scene::{Pixels, Scene};

/// Longest message, in bytes without the file's name: what a terminal shows in a few rows.
const LONGEST_LINE: usize = 4000;

/// Loads a file and checks the outcome. The error is the message.
///
/// # Panics
/// If the import breaks its contract.
pub(crate) fn load_checked(file: &Path, options: &ImportOptions) -> Result<Scene, String> {
    match load_with(&[file.to_owned()], options) {
        Ok(scene) => {
            check_scene(&scene);
            Ok(scene)
        }
        Err(error) => {
            let line = error.to_string();
            let name = file.display().to_string();
            assert!(
                line.starts_with(&name),
                "does not begin with the file: {line:?}"
            );
            check_line(&line);
            Err(line)
        }
    }
}

fn check_line(line: &str) {
    assert!(
        !line.contains(char::is_control),
        "more than a line: {line:?}"
    );
    assert!(line.len() <= LONGEST_LINE, "{} bytes", line.len());
}

fn check_scene(scene: &Scene) {
    for mesh in &scene.meshes {
        assert_eq!(mesh.validate(), Ok(()));
        let far = |p: &glam::Vec3| !p.is_finite() || p.abs().max_element() > COORDINATE_LIMIT;
        assert!(!mesh.positions.iter().any(far), "a position is far out");
        assert!(mesh.normals.iter().all(|n| n.is_finite()));
        assert!(mesh.colors.iter().all(|c| c.is_finite()));
        assert!(mesh.uv_sets.iter().flatten().all(|uv| uv.is_finite()));
        for part in &mesh.parts {
            assert!((part.material as usize) < scene.materials.len());
        }
        for outline in &mesh.outlines {
            let end = outline.first_triangle as usize + outline.triangle_count as usize;
            assert!(end <= mesh.triangles.len() && outline.corners.len() > 3);
            let vertices = mesh.positions.len();
            assert!(outline.corners.iter().all(|&c| (c as usize) < vertices));
        }
    }
    assert!(scene.placed_triangles() > 0);
    for instance in &scene.instances {
        assert!((instance.mesh as usize) < scene.meshes.len());
        assert!(instance.world_from_object.is_finite());
    }
    for reference in scene.materials.iter().flat_map(|m| m.texture_refs()) {
        assert!((reference.texture as usize) < scene.textures.len());
        assert!(reference.transform.is_finite());
    }
    for texture in &scene.textures {
        assert!((texture.image as usize) < scene.images.len());
    }
    for image in &scene.images {
        let found = match &image.pixels {
            Some(Pixels::Rgba8(pixels)) => pixels.len(),
            Some(Pixels::Rgba16(pixels)) => pixels.len(),
            Some(Pixels::RgbaF32(pixels)) => pixels.len(),
            None => continue,
        };
        assert_eq!(image.width as usize * image.height as usize, found);
        assert!(found > 0);
    }
    let notes = scene.notes.iter().map(ToString::to_string);
    let defects = scene.defects.iter().map(ToString::to_string);
    notes.chain(defects).for_each(|line| check_line(&line));
}
