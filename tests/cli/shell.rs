//! Help, completions and the manual page know every argument.

use super::run::bspray;

/// The long options of a sub-command, as its help lists them.
fn long_options(command: &str) -> Vec<String> {
    let folder = tempfile::tempdir().expect("a folder");
    let ran = bspray(folder.path(), &[command, "--help"]);
    assert_eq!((ran.code, ran.stderr.as_str()), (Some(0), ""));
    let option = |line: &str| {
        let line = line.trim_start();
        let rest = line.strip_prefix("--").or_else(|| {
            line.starts_with('-')
                .then(|| line.split_once("--"))?
                .map(|p| p.1)
        })?;
        let end = rest.find(|c: char| c != '-' && !c.is_ascii_lowercase());
        Some(format!("--{}", &rest[..end.unwrap_or(rest.len())]))
    };
    ran.stdout.lines().filter_map(option).collect()
}

#[test]
fn help_lists_the_arguments_of_the_issue() {
    let options = long_options("render");
    for option in [
        "--output",
        "--resolution",
        "--spp",
        "--seed",
        "--threads",
        "--cropwindow",
        "--pixelbounds",
        "--pixel",
        "--stats",
        "--json",
        "--quiet",
        "--camera-index",
        "--camera-position",
        "--camera-focal-point",
        "--camera-view-up",
        "--camera-view-angle",
        "--camera-direction",
        "--up",
        "--tonemap",
        "--exposure",
        "--integrator",
        "--accel",
    ] {
        assert!(options.iter().any(|o| o == option), "{option}: {options:?}");
    }
}

#[test]
fn the_manual_page_has_every_option() {
    let folder = tempfile::tempdir().unwrap();
    let ran = bspray(folder.path(), &["man"]);
    assert_eq!((ran.code, ran.stderr.as_str()), (Some(0), ""));
    assert!(ran.stdout.lines().any(|l| l.starts_with(".TH bspray 1")));
    // In roff a hyphen is a backslash and a minus.
    let page = ran.stdout.replace("\\-", "-");
    for option in [long_options("render"), long_options("inspect")].concat() {
        assert!(page.contains(&format!("\\fB{option}\\fR")), "{option}");
    }
}

#[test]
fn completions_have_every_option() {
    let folder = tempfile::tempdir().unwrap();
    let options = long_options("render");
    for shell in ["bash", "zsh", "fish", "elvish", "powershell"] {
        let ran = bspray(folder.path(), &["completions", shell]);
        assert_eq!((ran.code, ran.stderr.as_str()), (Some(0), ""), "{shell}");
        for option in &options {
            let word = if shell == "fish" {
                format!("-l {}", &option[2..])
            } else {
                option.clone()
            };
            assert!(ran.stdout.contains(&word), "{shell}: {option}");
        }
    }
}

#[test]
fn the_version_is_the_packages() {
    let folder = tempfile::tempdir().unwrap();
    let ran = bspray(folder.path(), &["--version"]);
    assert_eq!(
        ran.stdout,
        format!("bspray {}\n", env!("CARGO_PKG_VERSION"))
    );
    assert_eq!((ran.code, ran.stderr.as_str()), (Some(0), ""));
}
