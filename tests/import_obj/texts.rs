//! What others write, and what has no meaning: lines, files, bytes.

use std::path::Path;

use bspray::geometry::Aabb;
use bspray::import::{self, ImportError};
use bspray::scene::DefectCause;
use glam::Vec3;

use crate::setup::*;

#[test]
fn texts_that_others_write_are_read() {
    // (what, text behind the four vertices, triangles, notes)
    #[rustfmt::skip]
    let cases: &[(&str, &str, u64, usize)] = &[
        ("plain", "f 1 2 3", 1, 0),
        ("no line end at the end", "f 1 2 3 4", 2, 0),
        ("comment behind a face: tobj fails", "f 1 2 3 # c\n", 1, 0),
        ("comment that touches: tobj fails", "f 1 2 3#c\n", 1, 0),
        ("comment behind a vertex: tobj fails", "v 1 2 3 # c\nf 1 2 5\n", 1, 0),
        ("continued face: tobj fails", "f 1 \\\n 2 3\n", 1, 0),
        ("comment that ends in a backslash", "# c:\\\nf 1 2 3\n", 1, 0),
        ("line: tobj makes a triangle of it", "l 1 2 3\nl 1 2 3 4\nf 1 2 3\n", 1, 1),
        ("point", "p 1\np 2\nf 1 2 3\n", 1, 1),
        ("curves and surfaces", "vp 0.3\ncstype bezier\ndeg 3\ncurv 0 1 1 2 3 4\nsurf 0 1 0 1 1 2 3 4\nend\nf 1 2 3\n", 1, 2),
        ("smoothing groups and subdivision tags", "s 1\nt crease 2/1/0 0 1 4.7\nf 1 2 3\ns off\nf 1 3 4\n", 2, 0),
        ("unknown words", "xyzzy 1\nf 1 2 3\n\u{fffd}\u{1}\n", 1, 1),
        ("seven numbers: tobj fails", "v 0 0 1 1 0 0 0.5\nf 1 2 5\n", 1, 2),
        ("five numbers: tobj fails", "v 0 0 1 1 0\nf 1 2 5\n", 1, 1),
        ("weight of 0: tobj fails; unused", "v 0 0 1 0\nf 1 2 3\n", 1, 1),
        ("malformed number: tobj fails; unused", "v 3.1+e2 0 1\nf 1 2 3\n", 1, 1),
        ("number with a decimal comma; unused", "v 3,1 0 1\nf 1 2 3\n", 1, 1),
        ("two coordinates: tobj fails; unused", "v 3 4\nf 1 2 3\n", 1, 1),
        ("backward indices", "f -4 -3 -2\nv 5 5 5\nf -5 -3 -2\n", 2, 0),
        ("vertex behind its face: tobj fails across objects", "o a\nf 1 2 5\no b\nv 9 9 9\nf 1 2 3\n", 2, 0),
        ("normal that is not there: tobj fails", "f 1//1 2//2 3//3\n", 1, 1),
        ("normal 0: tobj fails", "vn 0 0 1\nf 1//0 2//1 3//1\n", 1, 1),
        ("texture coordinate far back: tobj overflows", "f 1/-9 2/-9 3/-9\n", 1, 1),
        ("one texture number: tobj fails", "vt 0.5\nf 1/1 2/1 3/1\n", 1, 0),
        ("malformed texture coordinate: tobj fails", "vt x 0\nf 1/1 2/1 3/1\n", 1, 1),
        ("malformed normal: tobj fails", "vn 0 0\nf 1//1 2//1 3//1\n", 1, 1),
        ("empty face: tobj fails", "f\nf 1 2 3\n", 1, 0),
        ("face with words: tobj fails", "f 1 2 x\nf 1 2 3\n", 1, 1),
        ("face with four indices a corner: tobj fails", "f 1/1/1/1 2 3\nf 1 2 3\n", 1, 1),
        ("face outline, the old word: tobj ignores it", "fo 1 2 3\n", 1, 0),
        ("cut off in a corner", "f 1 2 3\nf 1/", 1, 0),
        ("usemtl without a name: tobj fails", "usemtl\nf 1 2 3\n", 1, 1),
        ("empty names", "o\ng\nf 1 2 3\n", 1, 0),
        ("blanks of all sorts", "\t f\t1\u{b}2\u{c} 3 \t\n", 1, 0),
    ];
    for (what, text, triangles, note_count) in cases {
        for ends in ["\n", "\r\n", "\r"] {
            let text = format!("{V}{text}").replace('\n', ends);
            let scene = load(&text).unwrap_or_else(|e| panic!("{what}: {e}"));
            assert_eq!(scene.placed_triangles(), *triangles, "{what}");
            assert_eq!(
                notes(&scene).len(),
                *note_count,
                "{what}: {:?}",
                notes(&scene)
            );
        }
    }
}

#[test]
fn what_has_no_meaning_is_an_error_that_names_the_line() {
    #[rustfmt::skip]
    let cases: &[(&str, &str)] = &[
        ("f 0 1 2\n", "line 5: face names vertex 0"),
        ("f 1 2 9\n", "line 5: face names vertex 9 of 4: index out of range"),
        ("f 1 2 3\nf -5 1 2\n", "line 6: face names vertex -5, counted back from 4: index out of range"),
        ("f 1 2 \\\n 99999999999999999999999\n", "line 5: face names vertex"),
        ("f 9 1 2\nf 1 2 8\nv 0 0 0\n", "line 5: face names vertex 9 of 5"),
        ("f 1 2 3\nf 1 2 7\nf 1 2 9\nv 0 0 0\n", "line 6: face names vertex 7 of 5"),
        ("", "file: holds 4 vertices and no faces"),
        ("l 1 2\n", "file: holds 4 vertices and no faces"),
        ("f 1 2 x\n", "file: holds 4 vertices and no faces"),
    ];
    for (text, expected) in cases {
        let error = load(format!("{V}{text}")).unwrap_err();
        assert!(matches!(error, ImportError::Invalid { .. }), "{error}");
        let error = error.to_string();
        assert!(
            error.contains("model.obj: ") && error.contains(expected),
            "{error}"
        );
        assert_eq!(error.lines().count(), 1);
    }
    for empty in ["", " \n\t", "\u{feff}", "# only a comment\n"] {
        let error = load(empty).unwrap_err().to_string();
        assert!(error.contains("empty"), "{error}");
    }
}

#[test]
fn folders_and_missing_files_are_errors() {
    let folder = tempfile::tempdir().unwrap();
    let inner = folder.path().join("folder.obj");
    std::fs::create_dir(&inner).unwrap();
    assert!(matches!(
        import::load(&[inner]),
        Err(ImportError::Invalid { .. })
    ));
    let missing = folder.path().join("missing.obj");
    assert!(matches!(
        import::load(&[missing]),
        Err(ImportError::Io { .. })
    ));
}

#[test]
fn random_bytes_give_an_error_or_a_scene() {
    // SplitMix64, so that a failing seed can be named.
    let next = |state: &mut u64| {
        *state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = *state;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    };
    let alphabet = b"vvvtnfff  //#\\\n\n\n\r0123456789-+.eo gusemtl\xe9";
    for seed in 0..400 {
        let mut state = seed;
        let bytes: Vec<u8> = (0..next(&mut state) % 400)
            .map(|_| match seed % 2 {
                0 => next(&mut state) as u8,
                _ => alphabet[next(&mut state) as usize % alphabet.len()],
            })
            .collect();
        let mtl = [b"newmtl m\n".as_slice(), &bytes].concat();
        let obj = format!("mtllib a.mtl\n{V}usemtl m\nf 1 2 3\n");
        let scene = load_files(&[("model.obj", obj.as_bytes()), ("a.mtl", &mtl)]).unwrap();
        assert_eq!(scene.materials[0].name, "m", "seed {seed}");
        // Behind good lines, so that some faces name vertices.
        let text = [V.as_bytes(), b"vt 0 0\nvn 0 0 1\nf 1/1 2/1 3//1\n", &bytes].concat();
        if let Err(error) = load(text) {
            let error = error.to_string();
            assert!(!error.contains("reader"), "seed {seed}: {error}");
        }
    }
}

#[test]
fn every_cut_of_a_file_gives_an_error_or_a_scene() {
    let text = format!(
        "\u{feff}mtllib a.mtl\no a b\n{V}vt 0 0.5\nvn 0 0 1\nusemtl m\nf 1/1/1 2/1/1 3//1 4\nf -1 -2 -3\n"
    );
    for end in 0..text.len() {
        if let Err(error) = load(&text.as_bytes()[..end]) {
            assert!(!error.to_string().contains("reader"), "{end}: {error}");
        }
    }
}

#[test]
fn marks_and_foreign_letters_are_read() {
    let utf8 = load(format!("\u{feff}{V}o caf\u{e9}\nf 1 2 3\n")).unwrap();
    let latin1 = load([V.as_bytes(), b"# \xe9\xff\no caf\xe9\nf 1 2 3\n"].concat()).unwrap();
    let utf16: Vec<u8> = format!("\u{feff}{V}o caf\u{e9}\nf 1 2 3\n")
        .encode_utf16()
        .flat_map(u16::to_le_bytes)
        .collect();
    for scene in [utf8, latin1, load(utf16).unwrap()] {
        assert_eq!(scene.meshes[0].name, "caf\u{e9}");
    }
}

#[test]
fn malformed_models_do_what_their_first_line_says() {
    for name in ["index-out-of-range", "zero-index", "empty", "no-faces"] {
        let error = load_model(&format!("malformed/{name}.obj"))
            .unwrap_err()
            .to_string();
        assert!(
            error.contains(name) && error.lines().count() == 1,
            "{error}"
        );
        assert_eq!(error.contains("line 6"), name.contains("index"), "{error}");
    }
    for (name, cause) in [
        ("nan-vertex", DefectCause::NotFinite),
        ("huge-coordinate", DefectCause::TooLarge),
        ("malformed-number", DefectCause::NotFinite),
        ("repeated-corner", DefectCause::TooFewCorners),
        ("degenerate-triangle", DefectCause::Degenerate),
    ] {
        let scene = load_model(&format!("malformed/{name}.obj")).unwrap();
        assert_eq!(
            (scene.placed_triangles(), scene.defects.len()),
            (1, 1),
            "{name}"
        );
        assert_eq!(scene.defects[0].cause, cause, "{name}");
        assert_eq!(
            scene.bounds(),
            Aabb {
                min: Vec3::ZERO,
                max: Vec3::new(2.0, 1.0, 0.0)
            }
        );
    }
    for (name, note_count) in [
        ("missing-mtl", 2),
        ("missing-texture", 2),
        ("no-such-normal", 1),
    ] {
        let scene = load_model(&format!("malformed/{name}.obj")).unwrap();
        assert_eq!(
            (scene.placed_triangles(), scene.notes.len()),
            (1, note_count),
            "{name}"
        );
    }
}

#[test]
#[cfg(unix)]
fn devices_are_not_read() {
    for device in ["/dev/zero", "/dev/null"] {
        let error = import::load(&[Path::new(device).to_owned()]).unwrap_err();
        let text = error.to_string();
        assert!(text.contains("is not a regular file"), "{text}");
    }
}
