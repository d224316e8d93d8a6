//! MTL files: found, cleaned for `tobj`, read.
//!
//! `tobj` 4.0.5 panics on `Kd 0.8`, loses a whole file for one line that it cannot read, and knows most keywords in one
//! spelling only. So each statement is checked and written anew; a bad one is noted with its line and left out.

use std::collections::HashMap;
use std::fmt::Write;
use std::path::{Path, PathBuf};

use super::files::Finder;
use super::notes::Notes;
use super::numbers::parsed;
use super::prepass::Named;
use super::reader::{MtlMaterial, read_materials};
use super::text::{Lines, before_comment, decoded, keyword, with_plain_line_ends};
use crate::import::budget::Budget;
use crate::scene::Note;

/// Bytes that a byte of an MTL file may become: `newmtl a` is a material of half a kilobyte for `tobj` and here.
const MTL_GROWTH: u64 = 128;

/// Most names of material files that are looked for. A name costs the file two bytes, and its search many calls of the system.
const MOST_LIBRARIES: usize = 1 << 16;

const TOO_MANY_LIBRARIES: &str =
    "too many material files are named; the materials of this one get the default";

/// What became of a name of a material file.
enum Search {
    Found(PathBuf),
    NotThere,
    /// Too many names were looked for before.
    NotDone,
}

impl Search {
    fn found(self) -> Option<PathBuf> {
        match self {
            Self::Found(path) => Some(path),
            Self::NotThere | Self::NotDone => None,
        }
    }
}

/// An MTL file that was read.
pub(super) struct MtlFile {
    /// Where texture names start from.
    pub(super) folder: PathBuf,
    /// What is to be said of it.
    pub(super) notes: Notes,
}

/// The materials of all MTL files that an OBJ names.
#[derive(Default)]
pub(super) struct Libraries {
    files: Vec<MtlFile>,
    by_name: HashMap<String, (MtlMaterial, usize)>,
}

impl Libraries {
    /// Reads the files that `mtllib` statements of an OBJ in `folder` name. What is missing is noted in `notes`.
    pub(super) fn load(
        statements: &[Named],
        folder: &Path,
        budget: &Budget,
        notes: &mut Notes,
    ) -> Self {
        let mut libraries = Self::default();
        let mut finder = Finder::default();
        // A folder is searched once for a name, however often it is named.
        let mut found: HashMap<&str, Option<PathBuf>> = HashMap::new();
        let mut find = |name| {
            if found.len() >= MOST_LIBRARIES && !found.contains_key(name) {
                return Search::NotDone;
            }
            let path = found
                .entry(name)
                .or_insert_with(|| finder.find(folder, name));
            path.clone().map_or(Search::NotThere, Search::Found)
        };
        for Named { name, line } in statements {
            // One name with blanks, or several names.
            let whole = [Some(name.as_str()), before_comment(name)];
            let mut whole = whole.into_iter().flatten().map(&mut find);
            if let Some(path) = whole.find_map(Search::found) {
                libraries.read(&path, budget, notes);
                continue;
            }
            let names = before_comment(name).unwrap_or(name);
            for name in names.split_whitespace() {
                match find(name) {
                    Search::Found(path) => libraries.read(&path, budget, notes),
                    Search::NotThere => {
                        let text = format!(
                            "material file {name:?} is not there; its materials get the default"
                        );
                        notes.line(*line, text);
                    }
                    Search::NotDone => notes.line(*line, TOO_MANY_LIBRARIES),
                }
            }
        }
        libraries
    }

    fn read(&mut self, path: &Path, budget: &Budget, notes: &mut Notes) {
        if self.files.iter().any(|f| f.notes.file() == path) {
            return;
        }
        let element = || format!("material file {:?}", path.display());
        let length = std::fs::metadata(path).map_or(0, |m| m.len());
        // Each of a material's statements is kept by itself.
        let charged = budget.charge(length.saturating_mul(MTL_GROWTH), element);
        let read = match charged {
            Ok(()) => std::fs::read(path).map_err(|e| e.to_string()),
            Err(cause) => Err(cause),
        };
        let bytes = match read {
            Ok(bytes) => bytes,
            Err(error) => {
                let text = format!("cannot be read: {error}; its materials get the default");
                return notes.element(element(), text);
            }
        };
        let mut notes = Notes::new(path);
        let text = cleaned(&bytes, &mut notes);
        let file = self.files.len();
        match read_materials(text.as_bytes()) {
            Ok(materials) => {
                for material in materials {
                    let name = material.name.clone();
                    if let Some((_, of)) = self.by_name.insert(name.clone(), (material, file)) {
                        let where_else = if of == file {
                            "here"
                        } else {
                            "in a file before"
                        };
                        let text = format!("also stands {where_else}; the last one counts");
                        notes.element(format!("material {name:?}"), text);
                    }
                }
            }
            Err(error) => notes.element("file", format!("{error}; its materials get the default")),
        }
        self.files.push(MtlFile {
            folder: path.parent().unwrap_or(Path::new("")).to_owned(),
            notes,
        });
    }

    /// The material that a `usemtl` statement names, and its file.
    pub(super) fn find(&mut self, name: &str) -> Option<(&MtlMaterial, &mut MtlFile)> {
        let by_name = &self.by_name;
        let (material, file) = by_name
            .get(name)
            .or_else(|| by_name.get(before_comment(name)?))?;
        Some((material, &mut self.files[*file]))
    }

    /// The files that were read.
    pub(super) fn files(&self) -> impl Iterator<Item = PathBuf> {
        self.files.iter().map(|f| f.notes.file().to_owned())
    }

    /// The notes of all files.
    pub(super) fn into_notes(self) -> impl Iterator<Item = Note> {
        self.files.into_iter().flat_map(|f| f.notes.into_notes())
    }
}

/// The statements that `tobj` can read, in its spelling, one a line.
fn cleaned(bytes: &[u8], notes: &mut Notes) -> String {
    let source = with_plain_line_ends(bytes);
    let mut out = String::with_capacity(source.len());
    let mut is_in_material = false;
    for line in Lines::new(&source) {
        let (word, rest) = keyword(&line.text);
        if word.first().is_none_or(|&b| b == b'#') {
            continue;
        }
        let name = decoded(word);
        if name.eq_ignore_ascii_case("newmtl") {
            let rest = decoded(rest);
            is_in_material = !rest.trim().is_empty();
            if !is_in_material {
                notes.line(
                    line.number,
                    "newmtl without a name; it and what follows is left out",
                );
            } else {
                let _ = writeln!(out, "newmtl {}", rest.trim());
            }
            continue;
        }
        // What stands before the first material belongs to none.
        if !is_in_material {
            continue;
        }
        match statement(&name, rest) {
            Ok(statement) => {
                out.push_str(&statement);
                out.push('\n');
            }
            Err(text) => notes.line(line.number, text),
        }
    }
    out
}

/// A statement as `tobj` reads it, or why not.
fn statement(word: &str, rest: &[u8]) -> Result<String, &'static str> {
    let lower = word.to_ascii_lowercase();
    match lower.as_str() {
        "ka" | "kd" | "ks" | "ke" | "tf" => {
            let [r, g, b] = color(rest)?;
            let mut canonical = lower;
            canonical[..1].make_ascii_uppercase();
            Ok(format!("{canonical} {r:e} {g:e} {b:e}"))
        }
        "ns" | "ni" | "d" | "tr" | "pr" | "pm" | "ps" | "pc" | "pcr" => {
            // `d -halo 0.5` fades towards the silhouette.
            let rest = rest.strip_prefix(b"-halo").unwrap_or(rest);
            match parsed(rest).next().flatten().filter(|n| n.is_finite()) {
                Some(number) => {
                    let mut canonical = lower;
                    if canonical != "d" {
                        canonical[..1].make_ascii_uppercase();
                    }
                    Ok(format!("{canonical} {number:e}"))
                }
                None => Err("statement without its number is left out"),
            }
        }
        "illum" => match parsed(rest).next().flatten() {
            Some(model) if (0.0..=10.0).contains(&model) => Ok(format!("illum {}", model as u8)),
            _ => Err("illum that is no number from 0 to 10 is left out"),
        },
        _ => {
            // Foreign blanks, such as U+00A0, are blanks for `tobj`: such a word could turn into another statement.
            if !word.bytes().all(|b| b.is_ascii_graphic()) {
                return Err("unknown statements are left out");
            }
            let value = decoded(rest);
            if value.trim().is_empty() {
                return Err("statement without a value is left out");
            }
            let canonical = match lower.as_str() {
                "map_ka" => "map_Ka",
                "map_kd" => "map_Kd",
                "map_ks" => "map_Ks",
                "map_ke" => "map_Ke",
                "map_ns" => "map_Ns",
                "map_d" | "map_opacity" => "map_d",
                "map_bump" | "bump" => "map_Bump",
                "map_pr" => "map_Pr",
                "map_pm" => "map_Pm",
                "norm" | "map_kn" => "norm",
                other => other,
            };
            Ok(format!("{canonical} {}", value.trim()))
        }
    }
}

/// The colour of a statement: one number for all channels, three, or three of CIE XYZ.
fn color(rest: &[u8]) -> Result<[f32; 3], &'static str> {
    const BAD: &str = "colour that is not one or three numbers is left out";
    let (word, values) = keyword(rest);
    if word == b"spectral" {
        return Err("colour given by a spectral curve is left out; write three numbers");
    }
    let is_xyz = word == b"xyz";
    let numbers: Vec<f32> = parsed(if is_xyz { values } else { rest })
        .map(|n| n.filter(|n| n.is_finite()).ok_or(BAD))
        .collect::<Result<_, _>>()?;
    let [x, y, z] = match numbers[..] {
        [a] => [a; 3],
        [a, b, c, ..] => [a, b, c],
        _ => return Err(BAD),
    };
    if !is_xyz {
        return Ok([x, y, z]);
    }
    // To linear Rec. 709, white D65 (IEC 61966-2-1).
    Ok([
        3.240_6 * x - 1.537_2 * y - 0.498_6 * z,
        -0.968_9 * x + 1.875_8 * y + 0.041_5 * z,
        0.055_7 * x - 0.204 * y + 1.057 * z,
    ]
    .map(|c| c.max(0.0)))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn clean(text: &str) -> (Vec<String>, Vec<String>) {
        let mut notes = Notes::new(Path::new("a.mtl"));
        let text = cleaned(text.as_bytes(), &mut notes);
        let notes = notes
            .into_notes()
            .iter()
            .map(|n| n.element.clone())
            .collect();
        (text.lines().map(str::to_owned).collect(), notes)
    }

    #[test]
    fn statements_are_spelt_as_tobj_reads_them() {
        let (lines, notes) = clean(
            "newmtl\ta b \n\tKd\t0.8\nkd 1 2 3 # x\nNS 10\nMAP_KD\t-s 2 2 x y.png\nbump\tb.png\r\nd -halo 0.5\n",
        );
        let expected = [
            "newmtl a b",
            "Kd 8e-1 8e-1 8e-1",
            "Kd 1e0 2e0 3e0",
            "Ns 1e1",
            "map_Kd -s 2 2 x y.png",
            "map_Bump b.png",
            "d 5e-1",
        ];
        assert_eq!(lines, expected);
        assert!(notes.is_empty());
    }

    #[test]
    fn a_bad_statement_costs_only_itself() {
        let (lines, notes) = clean(
            "Kd 1 1 1\nnewmtl a\nKd spectral f.rfl\nKs 1 2\nNs\nillum x\nmap_Kd\nNi 1.5\nnewmtl\nKd 1 1 1\n",
        );
        assert_eq!(lines, ["newmtl a", "Ni 1.5e0"]);
        assert_eq!(
            notes,
            ["line 3", "line 4", "line 5", "line 6", "line 7", "line 9"]
        );
    }

    #[test]
    fn white_in_xyz_is_white() {
        let white = color(b"xyz 0.9505 1 1.089").unwrap();
        assert!(white.iter().all(|c| (c - 1.0).abs() < 1e-3), "{white:?}");
    }
}
