//! Shading normals that no file gives: smoothing groups of OBJ files, and the crease angle that a user asks for.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

use bspray::import::{self, ImportOptions};
use bspray::scene::Scene;
use glam::Vec3;

/// Vertices of two rectangles that meet at a right angle, the second one from the first's right edge.
const RIDGE: &str = "v 0 0 0\nv 0 3 0\nv -2 0 0\nv -2 3 0\nv 0 0 -1\nv 0 3 -1\n";

fn load(text: &str, crease_angle: Option<f32>) -> Scene {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.obj");
    std::fs::write(&path, text).unwrap();
    let options = ImportOptions {
        crease_angle,
        ..ImportOptions::default()
    };
    let scene = import::load_with(&[path], &options).unwrap();
    assert_eq!(scene.meshes[0].validate(), Ok(()));
    scene
}

#[test]
fn smoothing_groups_are_smooth_where_there_are_no_normals() {
    let normals = |text: &str| -> Vec<Vec3> {
        load(&format!("{RIDGE}{text}"), None).meshes[0]
            .normals
            .clone()
    };
    let faces = |first: &str, second: &str| format!("{first}f 1 2 4 3\n{second}f 1 5 6 2\n");
    let joined = (Vec3::Z + Vec3::X).normalize();
    let smooth = normals(&faces("s 3\n", ""));
    assert!(
        smooth.len() == 6 && (smooth[0] - joined).length() < 1e-6,
        "{smooth:?}"
    );
    assert_eq!(smooth, normals(&faces("s 0\ns on # all\n", "")));
    assert_eq!(smooth, normals(&faces("s 3\no late\n", "g part\n")));
    assert!(normals(&faces("", "")).is_empty());
    // Groups are smooth within: each side keeps its own normal, at its own copies of the two vertices.
    for apart in [faces("s 3\n", "s 4\n"), faces("s 1\n", "s off\n")] {
        let normals = normals(&apart);
        assert_eq!(normals.len(), 8, "{apart}");
        assert!(
            normals
                .iter()
                .all(|n| (*n - Vec3::Z).length().min((*n - Vec3::X).length()) < 1e-6)
        );
    }
    // Normals of the file stay.
    let given = normals(&format!(
        "vn 0 1 0\n{}",
        "s 1\nf 1//1 2//1 4//1 3//1\nf 1//1 5//1 6//1 2//1\n"
    ));
    assert_eq!(given, [Vec3::Y; 6]);
    let scene = load(&format!("{RIDGE}s x\nf 1 2 3\n"), None);
    let [note] = &scene.notes[..] else {
        panic!("{:?}", scene.notes);
    };
    assert!(note.element.contains("line 7") && scene.meshes[0].normals.is_empty());
}

#[test]
fn a_crease_angle_smooths_what_has_no_normals() {
    let text = format!("{RIDGE}f 1 2 4 3\nf 1 5 6 2\n");
    let normals = |degrees| load(&text, degrees).meshes[0].normals.len();
    assert_eq!(normals(None), 0);
    // A copy of each vertex of the edge, or none.
    assert_eq!(normals(Some(89.9)), 8);
    assert_eq!(normals(Some(90.1)), 6);
}
