//! Finds the files that OBJ and MTL name.

use std::collections::HashMap;
use std::ffi::OsString;
use std::path::{Path, PathBuf};

/// Longest name of a file that is looked for, in bytes: no system has longer ones. The time to look for a name grows with its square.
const LONGEST_NAME: usize = 4096;

/// Finds files. Folders are listed once, however many names are looked for in them.
#[derive(Default)]
pub(super) struct Finder {
    /// The names in each folder by what they are in small letters; of those alike the first.
    lists: HashMap<PathBuf, HashMap<String, OsString>>,
}

impl Finder {
    /// The file that `name` means in a model file of `folder`.
    ///
    /// Tried in this order: the name as it is; with backslashes as slashes, and without quotes; the same in any case; the last
    /// part of the name alone, beside the model, since many exporters write the path of their own machine.
    pub(super) fn find(&mut self, folder: &Path, name: &str) -> Option<PathBuf> {
        if name.len() > LONGEST_NAME {
            return None;
        }
        let exact = folder.join(name);
        if !name.is_empty() && exact.is_file() {
            return Some(exact);
        }
        let name = name.trim().trim_matches('"').replace('\\', "/");
        let last = name.rsplit('/').next().unwrap_or(&name);
        if last.is_empty() {
            return None;
        }
        let found = self.in_any_case(folder, &name);
        found.or_else(|| self.in_any_case(folder, last))
    }

    fn in_any_case(&mut self, folder: &Path, name: &str) -> Option<PathBuf> {
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
                let list = self.list(&path);
                path.join(list.get(&part.to_ascii_lowercase())?)
            };
        }
        path.is_file().then_some(path)
    }

    /// What is in a folder: nothing, if it cannot be read.
    fn list(&mut self, folder: &Path) -> &HashMap<String, OsString> {
        let list = || {
            let here = match folder.as_os_str().is_empty() {
                true => Path::new("."),
                false => folder,
            };
            let entries = std::fs::read_dir(here).into_iter().flatten();
            let mut names: Vec<_> = entries
                .filter_map(|entry| Some(entry.ok()?.file_name()))
                .collect();
            // A folder is listed in no order. The first of those alike comes last, and stays.
            names.sort_by(|a, b| b.cmp(a));
            let lower = |name: OsString| Some((name.to_str()?.to_ascii_lowercase(), name));
            names.into_iter().filter_map(lower).collect()
        };
        self.lists.entry(folder.to_owned()).or_insert_with(list)
    }
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
            let path = Finder::default().find(folder.path(), name)?;
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
