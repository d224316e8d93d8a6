//! The messages of one file, with equal ones told once.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use crate::import::line::one_line;
use crate::scene::Note;

/// Collects notes. Those with the same text become one, which names the first element and counts the others.
#[derive(Debug)]
pub(super) struct Notes {
    file: PathBuf,
    /// Element, text and how often, in the order of first appearance.
    entries: Vec<(String, String, u64)>,
    by_text: HashMap<String, usize>,
}

impl Notes {
    pub(super) fn new(file: &Path) -> Self {
        Self {
            file: file.to_owned(),
            entries: Vec::new(),
            by_text: HashMap::new(),
        }
    }

    pub(super) fn add(&mut self, element: impl Into<String>, text: impl Into<String>) {
        self.add_many(element.into(), text.into(), 1);
    }

    /// Adds all notes of `other`, in its order.
    pub(super) fn append(&mut self, other: Self) {
        for (element, text, count) in other.entries {
            self.add_many(element, text, count);
        }
    }

    fn add_many(&mut self, element: String, text: String, count: u64) {
        if let Some(&entry) = self.by_text.get(&text) {
            self.entries[entry].2 += count;
        } else {
            self.by_text.insert(text.clone(), self.entries.len());
            self.entries.push((element, text, count));
        }
    }

    pub(super) fn finish(self) -> Vec<Note> {
        let file = self.file;
        self.entries
            .into_iter()
            .map(|(element, text, count)| Note {
                file: file.clone(),
                element: match count {
                    1 => one_line(element),
                    n => format!("{} and {} more", one_line(element), n - 1),
                },
                text: one_line(text),
            })
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_texts_become_one_note() {
        let mut notes = Notes::new(Path::new("a.gltf"));
        notes.add("mesh 0", "skipped");
        notes.add("mesh 1", "other");
        let mut more = Notes::new(Path::new("a.gltf"));
        more.add("mesh 2", "skipped");
        more.add("mesh 3", "skipped");
        notes.append(more);
        let texts: Vec<String> = notes.finish().iter().map(Note::to_string).collect();
        assert_eq!(
            texts,
            [
                "a.gltf: mesh 0 and 2 more: skipped",
                "a.gltf: mesh 1: other"
            ]
        );
    }
}
