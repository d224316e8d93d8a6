//! Files that the fuzz targets found, each made small, with what was wrong.

use crate::setup::load;

/// Bytes as a file of that name; the contract is checked.
fn check(name: &str, bytes: &[u8]) {
    let _ = load(name, bytes);
}

#[test]
fn names_of_extensions_do_not_break_lines() {
    check(
        "a.gltf",
        br#"{"asset":{"version":"2.0"},"extensionsUsed":["a\nb"],"extensionsRequired":["\u001b\n"]}"#,
    );
}
