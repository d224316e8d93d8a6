//! Runs the program in a folder of the test's own and takes what it says.

use std::path::Path;
use std::time::Duration;

/// Arguments of the cheapest picture.
pub(crate) const TINY: [&str; 4] = ["--resolution", "8x6", "--spp", "1"];

/// Nothing here takes a second; what takes this long hangs.
const HANG: Duration = Duration::from_secs(120);

/// What a run left behind.
#[derive(Debug)]
pub(crate) struct Ran {
    /// `None` if a signal ended it.
    pub(crate) code: Option<i32>,
    pub(crate) stdout: String,
    pub(crate) stderr: String,
}

/// Runs `bspray` with `args` in `folder`.
pub(crate) fn bspray<S: AsRef<str>>(folder: &Path, args: &[S]) -> Ran {
    let output = assert_cmd::cargo::cargo_bin_cmd!("bspray")
        .current_dir(folder)
        .args(args.iter().map(AsRef::as_ref))
        .timeout(HANG)
        .output()
        .expect("the program starts");
    Ran {
        code: output.status.code(),
        stdout: String::from_utf8(output.stdout).expect("UTF-8 on standard output"),
        stderr: String::from_utf8(output.stderr).expect("UTF-8 on standard error"),
    }
}

/// Renders `model` of `models/` as cheaply as can be, with more arguments behind.
pub(crate) fn render(folder: &Path, model: &str, args: &[&str]) -> Ran {
    let model = self::model(model);
    let all: Vec<&str> = ["render", &model]
        .into_iter()
        .chain(TINY)
        .chain(args.iter().copied())
        .collect();
    bspray(folder, &all)
}

/// The bytes of the picture of `lecture-objects` with these arguments.
pub(crate) fn picture(args: &[&str]) -> Vec<u8> {
    let folder = tempfile::tempdir().expect("a folder");
    let all = [&["-o", "a.png"], args].concat();
    let ran = render(folder.path(), "lecture-objects.gltf", &all);
    assert_eq!(ran.code, Some(0), "{ran:?}");
    std::fs::read(folder.path().join("a.png")).expect("a picture")
}

/// The path of a file in `models/`.
pub(crate) fn model(name: &str) -> String {
    format!("{}/models/{name}", env!("CARGO_MANIFEST_DIR"))
}

/// Names of everything in a folder, sorted.
pub(crate) fn names(folder: &Path) -> Vec<String> {
    let mut names: Vec<_> = std::fs::read_dir(folder)
        .expect("the folder is there")
        .map(|entry| {
            let name = entry.expect("an entry").file_name();
            name.to_string_lossy().into_owned()
        })
        .collect();
    names.sort();
    names
}
