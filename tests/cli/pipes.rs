//! A reader that goes away, as `head` does, is no failure.

use std::process::{Command, Stdio};

use super::run::{TINY, model};

#[test]
fn a_closed_standard_output_is_no_failure() {
    let folder = tempfile::tempdir().unwrap();
    let (block, objects) = (model("lecture-block.obj"), model("lecture-objects.gltf"));
    let render = |report| [&["render", &block, report, "-o", "a.png"][..], &TINY].concat();
    for args in [
        vec!["inspect", "--json", &objects],
        vec!["inspect", &objects],
        vec!["man"],
        vec!["completions", "bash"],
        vec!["completions", "zsh"],
        vec!["--help"],
        vec!["render", "--help"],
        render("--stats"),
        render("--json"),
        [&["render", &block, "--json", "--pixel", "1,1"][..], &TINY].concat(),
    ] {
        let (reader, writer) = std::io::pipe().unwrap();
        drop(reader);
        let output = Command::new(env!("CARGO_BIN_EXE_bspray"))
            .args(&args)
            .current_dir(folder.path())
            .stdout(writer)
            .stderr(Stdio::piped())
            .output()
            .unwrap();
        let stderr = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(0), "{args:?}: {stderr}");
        for word in ["panicked", "error", "Broken pipe"] {
            assert!(!stderr.contains(word), "{args:?}: {stderr}");
        }
    }
    // The picture is there all the same.
    assert!(folder.path().join("a.png").is_file());
}

#[test]
fn a_closed_standard_error_does_not_stop_a_render() {
    let folder = tempfile::tempdir().unwrap();
    let (reader, writer) = std::io::pipe().unwrap();
    drop(reader);
    let output = Command::new(env!("CARGO_BIN_EXE_bspray"))
        .args(["render", &model("lecture-block.obj"), "-o", "a.png"])
        .args(TINY)
        .current_dir(folder.path())
        .stderr(writer)
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(0));
    assert!(folder.path().join("a.png").is_file());
}
