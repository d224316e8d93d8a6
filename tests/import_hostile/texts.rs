//! OBJ and MTL files with very long lines, and with very many names.

use std::fmt::Write;

use crate::setup::{expect, load_in, load_within, options};

const V: &str = "v 0 0 0\nv 2 0 0\nv 0 1 0\n";

/// Memory for files of some megabytes.
const MEMORY: u64 = 1 << 30;

#[test]
fn a_line_of_16_mb_is_read_or_refused() {
    try_line(16 << 20, 256 << 20);
}

#[test]
#[ignore = "takes half a minute; run it with `cargo test --test import_hostile -- --ignored`"]
fn a_line_of_100_mb_is_read_or_refused() {
    try_line(100 << 20, MEMORY);
}

/// A line of `size` bytes, within `memory`.
fn try_line(size: usize, memory: u64) {
    let face = format!("{V}f {}\n", "1 2 3 ".repeat(size / 6));
    let within = options(memory, false);
    let error = load_within("a.obj", face.as_bytes(), &within).expect_err("too many corners");
    expect(&error, &["a.obj: line 4: would take", "--memory-limit"]);
    for word in ["# ", "o ", "usemtl ", "v ", "mtllib ", "unknown "] {
        let text = format!("{V}{word}{}\nf 1 2 3\n", "x y ".repeat(size / 4));
        // It is a name, and too long for one, or nothing.
        match load_within("a.obj", text.as_bytes(), &within) {
            Ok(scene) => assert_eq!(scene.meshes[0].triangles.len(), 1, "{word}"),
            Err(error) => expect(&error, &["a.obj: line 4", "--memory-limit"]),
        }
    }
}

#[test]
fn a_million_objects_are_refused() {
    let text = format!("{V}{}", "o\nf 1 2 3\n".repeat(1 << 20));
    let error = load_within("a.obj", text.as_bytes(), &options(MEMORY, false));
    expect(
        &error.expect_err("too many"),
        &["a.obj: line ", "--memory-limit"],
    );
}

#[test]
fn names_of_files_that_are_not_there_are_looked_for_in_bounded_time() {
    let folder = tempfile::tempdir().expect("a folder");
    for n in 0..2000 {
        std::fs::write(folder.path().join(format!("other-{n}")), "").expect("written");
    }
    let mut libraries = String::new();
    let mut materials = String::new();
    let mut faces = String::new();
    for n in 0..40_000 {
        writeln!(libraries, "mtllib n{n} m{n}").expect("written");
    }
    for n in 0..5_000 {
        writeln!(materials, "newmtl m{n}\nmap_Kd {n}.png").expect("written");
        writeln!(faces, "usemtl m{n}\nf 1 2 3").expect("written");
    }
    std::fs::write(folder.path().join("a.mtl"), materials).expect("written");
    let text = format!("mtllib a.mtl\n{libraries}{V}{faces}");
    let loaded = load_in(
        folder.path(),
        "a.obj",
        text.as_bytes(),
        &options(MEMORY, false),
    );
    let scene = loaded.expect("loads");
    assert_eq!(scene.materials.len(), 5000);
    let words = "too many material files";
    assert!(scene.notes.iter().any(|n| n.to_string().contains(words)));
}

#[test]
fn paths_of_very_many_parts_are_no_files() {
    for part in ["../", "./", "a/", "..\\"] {
        let text = format!("mtllib {}a.mtl\n{V}f 1 2 3\n", part.repeat(1 << 20));
        let loaded = load_within("a.obj", text.as_bytes(), &options(MEMORY, false));
        assert_eq!(loaded.expect("loads").materials.len(), 1);
    }
}

#[test]
fn an_mtl_that_names_itself_is_read_once() {
    let folder = tempfile::tempdir().expect("a folder");
    let mtl = "mtllib a.mtl\nnewmtl a\nmtllib a.mtl\nKd 1 0 0\nmap_Kd a.mtl\n";
    std::fs::write(folder.path().join("a.mtl"), mtl).expect("written");
    let text = format!(
        "{}mtllib a.obj\n{V}usemtl a\nf 1 2 3\n",
        "mtllib a.mtl\n".repeat(10_000)
    );
    let loaded = load_in(
        folder.path(),
        "a.obj",
        text.as_bytes(),
        &options(MEMORY, false),
    );
    assert_eq!(loaded.expect("loads").materials.len(), 1);
}

#[test]
fn messages_cite_hostile_names_in_one_line() {
    let folder = tempfile::tempdir().expect("a folder");
    let name = "\u{1b}[2J\u{202e}x".repeat(5000);
    let text = format!("mtllib {name}\no {name}\n{V}usemtl {name}\nf 1 2 3\nf 1 1 2\n");
    let loaded = load_in(
        folder.path(),
        "a.obj",
        text.as_bytes(),
        &options(MEMORY, false),
    );
    assert!(loaded.expect("loads").notes.len() > 1);
}
