//! Notes about a text file, equal ones summed up.

use std::path::{Path, PathBuf};

use crate::scene::Note;

/// Collects notes about one file.
pub(super) struct Notes {
    file: PathBuf,
    by_line: Vec<LineNote>,
    others: Vec<Note>,
}

struct LineNote {
    text: &'static str,
    first: usize,
    count: usize,
}

impl Notes {
    pub(super) fn new(file: &Path) -> Self {
        Self {
            file: file.to_owned(),
            by_line: Vec::new(),
            others: Vec::new(),
        }
    }

    /// The file that the notes are about.
    pub(super) fn file(&self) -> &Path {
        &self.file
    }

    /// Notes something about a line. Lines with the same text become one note.
    pub(super) fn line(&mut self, number: usize, text: &'static str) {
        match self
            .by_line
            .iter_mut()
            .find(|n| std::ptr::eq(n.text, text) || n.text == text)
        {
            Some(note) => note.count += 1,
            None => self.by_line.push(LineNote {
                text,
                first: number,
                count: 1,
            }),
        }
    }

    /// Notes something about an element, once.
    pub(super) fn element(&mut self, element: impl Into<String>, text: impl Into<String>) {
        let note = Note {
            file: self.file.clone(),
            element: element.into(),
            text: text.into(),
        };
        if !self.others.contains(&note) {
            self.others.push(note);
        }
    }

    /// The notes, those about lines first and in the order of their lines.
    pub(super) fn into_notes(mut self) -> Vec<Note> {
        self.by_line.sort_by_key(|n| n.first);
        let lines = self.by_line.into_iter().map(|n| Note {
            file: self.file.clone(),
            element: match n.count {
                1 => format!("line {}", n.first),
                2 => format!("line {} and 1 more", n.first),
                count => format!("line {} and {} more", n.first, count - 1),
            },
            text: n.text.to_owned(),
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
