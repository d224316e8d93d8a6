//! Finds the files that OBJ and MTL name.

use std::path::{Path, PathBuf};

/// The file that `name` means in a model file of `folder`.
///
/// Tried in this order: the name as it is; with backslashes as slashes, and without quotes; the same in any case; the last
/// part of the name alone, beside the model, since many exporters write the path of their own machine.
pub(super) fn find(folder: &Path, name: &str) -> Option<PathBuf> {
    let exact = folder.join(name);
    if !name.is_empty() && exact.is_file() {
        return Some(exact);
    }
    let name = name.trim().trim_matches('"').replace('\\', "/");
    let last = name.rsplit('/').next().unwrap_or(&name);
    if last.is_empty() {
        return None;
    }
    in_any_case(folder, &name).or_else(|| in_any_case(folder, last))
}

fn in_any_case(folder: &Path, name: &str) -> Option<PathBuf> {
    let exact = folder.join(name);
    if exact.is_file() {
        return Some(exact);
    }
    if Path::new(name).is_absolute() {
        return None;
    }
    let mut path = folder.to_owned();
    for part in name.split('/').filter(|p| !p.is_empty() && *p != ".") {
        let as_written = path.join(part);
        path = if part == ".." || as_written.exists() {
            as_written
        } else {
            let here = if path.as_os_str().is_empty() {
                Path::new(".")
            } else {
                &path
            };
            let mut alike: Vec<_> = std::fs::read_dir(here)
                .ok()?
                .filter_map(|entry| Some(entry.ok()?.file_name()))
                .filter(|entry| entry.to_str().is_some_and(|e| e.eq_ignore_ascii_case(part)))
                .collect();
            // A folder is listed in no order.
            alike.sort();
            path.join(alike.first()?)
        };
    }
    path.is_file().then_some(path)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_are_found_as_they_are_written_elsewhere() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::create_dir(folder.path().join("Maps")).unwrap();
        for name in ["Maps/Wood Dark.PNG", "a.mtl"] {
            std::fs::write(folder.path().join(name), "x").unwrap();
        }
        let found = |name: &str| {
            let path = find(folder.path(), name)?;
            Some(
                path.strip_prefix(folder.path())
                    .unwrap()
                    .to_str()
                    .unwrap()
                    .to_owned(),
            )
        };
        for name in [
            "Maps/Wood Dark.PNG",
            "maps\\wood dark.png",
            "./maps/WOOD DARK.png",
            "\"Maps/Wood Dark.PNG\"",
        ] {
            assert_eq!(found(name).as_deref(), Some("Maps/Wood Dark.PNG"), "{name}");
        }
        assert_eq!(found("C:\\models\\A.MTL").as_deref(), Some("a.mtl"));
        assert_eq!(found("/nowhere/a.mtl").as_deref(), Some("a.mtl"));
        for name in ["", "b.mtl", "Maps", "maps/", ".."] {
            assert_eq!(found(name), None, "{name}");
        }
    }
}
