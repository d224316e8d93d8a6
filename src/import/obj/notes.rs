//! Notes about a text file, equal ones summed up.

use std::borrow::Cow;
use std::collections::{HashMap, HashSet};
use std::path::{Path, PathBuf};

use crate::import::line::one_line;
use crate::scene::Note;

/// Collects notes about one file.
pub(super) struct Notes {
    file: PathBuf,
    by_line: HashMap<Cow<'static, str>, Lines>,
    others: Vec<Note>,
    /// Elements and texts of `others`.
    known: HashSet<(String, String)>,
}

/// The lines with one text.
struct Lines {
    first: usize,
    count: usize,
}

impl Notes {
    pub(super) fn new(file: &Path) -> Self {
        Self {
            file: file.to_owned(),
            by_line: HashMap::new(),
            others: Vec::new(),
            known: HashSet::new(),
        }
    }

    /// The file that the notes are about.
    pub(super) fn file(&self) -> &Path {
        &self.file
    }

    /// Notes something about a line. Lines with the same text become one note.
    pub(super) fn line(&mut self, number: usize, text: impl Into<Cow<'static, str>>) {
        let lines = self.by_line.entry(text.into()).or_insert(Lines {
            first: number,
            count: 0,
        });
        lines.count += 1;
    }

    /// Notes something about an element, once.
    pub(super) fn element(&mut self, element: impl Into<String>, text: impl Into<String>) {
        let (element, text) = (element.into(), text.into());
        if self.known.insert((element.clone(), text.clone())) {
            self.others.push(Note {
                file: self.file.clone(),
                element: one_line(element),
                text: one_line(text),
            });
        }
    }

    /// The notes, those about lines first and in the order of their lines.
    pub(super) fn into_notes(self) -> Vec<Note> {
        let mut by_line: Vec<_> = self.by_line.into_iter().collect();
        // Several texts may be about one line, and a map has no order.
        by_line.sort_by(|(a, x), (b, y)| (x.first, a).cmp(&(y.first, b)));
        let lines = by_line
            .into_iter()
            .map(|(text, Lines { first, count })| Note {
                file: self.file.clone(),
                element: match count {
                    1 => format!("line {first}"),
                    2 => format!("line {first} and 1 more"),
                    _ => format!("line {first} and {} more", count - 1),
                },
                text: one_line(text),
            });
        lines.chain(self.others).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_notes_are_one() {
        let mut notes = Notes::new(Path::new("a.obj"));
        for line in [7, 9, 12] {
            notes.line(line, "points left out");
        }
        notes.line(3, "lines left out");
        notes.element("material \"a\"", "no such texture");
        notes.element("material \"a\"", "no such texture");
        let notes: Vec<String> = notes.into_notes().iter().map(Note::to_string).collect();
        assert_eq!(
            notes,
            [
                "a.obj: line 3: lines left out",
                "a.obj: line 7 and 2 more: points left out",
                "a.obj: material \"a\": no such texture"
            ]
        );
    }
}
