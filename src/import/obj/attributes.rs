//! The statements `v`, `vt` and `vn`, made such that `tobj` takes every one of them and counts as we do.
//!
//! - A coordinate that is no number, or is missing, becomes NaN: the faces that use the vertex are dropped as defects, and
//!   none is put in the wrong place. (`3.1+e2` is read as 3.1 or as 310 by other programs; neither is sure.)
//! - A vertex may carry a weight (4 numbers; the position is divided by it) or a colour (6 numbers, or 7 with alpha, which
//!   is left out). `tobj` loses track when only some vertices have colours, so the others become white.
//! - Texture coordinates and normals that cannot be read become zero: a zero normal means flat shading.

use std::io::Write;

use super::notes::Notes;
use super::numbers::{count_plain, parsed};
use super::pieces::{Piece, Pieces, Store};
use super::text::{Line, keyword};

/// How many of each attribute there are.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Counts {
    /// Positions (`v`).
    pub(super) v: usize,
    /// Texture coordinates (`vt`).
    pub(super) vt: usize,
    /// Normals (`vn`).
    pub(super) vn: usize,
}

/// The attribute statements of a file.
#[derive(Default)]
pub(super) struct Attributes {
    /// Those read so far.
    pub(super) counts: Counts,
    /// Their text.
    pub(super) pieces: Pieces,
    colored: usize,
    brightest: f32,
}

impl Attributes {
    /// Reads a `v` statement.
    pub(super) fn vertex(
        &mut self,
        values: &[u8],
        line: &Line,
        store: &mut Store,
        notes: &mut Notes,
    ) {
        self.counts.v += 1;
        let is_clean = match count_plain(values) {
            Some(3) => true,
            Some(4) => parsed(values)
                .nth(3)
                .flatten()
                .is_some_and(|w| w.is_finite() && w != 0.0),
            Some(6) => {
                self.colored += 1;
                let channels = parsed(values).skip(3).flatten();
                self.brightest = channels.fold(self.brightest, f32::max);
                true
            }
            _ => false,
        };
        let piece = match &line.span {
            Some(span) if is_clean => Piece::Source(span.clone()),
            _ => {
                let (position, color) = mended_vertex(values, line.number, notes);
                if let Some(color) = color
                    && !is_clean
                {
                    self.colored += 1;
                    self.brightest = color.iter().copied().fold(self.brightest, f32::max);
                }
                store.write(|out| {
                    write_numbers(out, "v", position.iter().chain(color.iter().flatten()))
                })
            }
        };
        self.pieces.push(piece);
    }

    /// Reads a `vt` statement. One number is a one-dimensional texture; a third number is a depth that no image has.
    pub(super) fn texcoord(
        &mut self,
        values: &[u8],
        line: &Line,
        store: &mut Store,
        notes: &mut Notes,
    ) {
        self.counts.vt += 1;
        let piece = match &line.span {
            Some(span) if count_plain(values).is_some_and(|n| n >= 2) => {
                Piece::Source(span.clone())
            }
            _ => {
                let mut numbers = parsed(values);
                let u = numbers.next().flatten();
                let v = numbers.next().unwrap_or(Some(0.0));
                if u.is_none() || v.is_none() {
                    notes.line(
                        line.number,
                        "texture coordinate cannot be read; 0 0 is used",
                    );
                }
                let uv = [u.unwrap_or(0.0), v.unwrap_or(0.0)];
                store.write(|out| write_numbers(out, "vt", &uv))
            }
        };
        self.pieces.push(piece);
    }

    /// Reads a `vn` statement.
    pub(super) fn normal(
        &mut self,
        values: &[u8],
        line: &Line,
        store: &mut Store,
        notes: &mut Notes,
    ) {
        self.counts.vn += 1;
        let piece = match &line.span {
            Some(span) if count_plain(values).is_some_and(|n| n >= 3) => {
                Piece::Source(span.clone())
            }
            _ => {
                let mut numbers = parsed(values);
                let normal = [(); 3].map(|()| numbers.next().flatten());
                if normal.contains(&None) {
                    notes.line(
                        line.number,
                        "normal cannot be read; its faces are shaded flat there",
                    );
                }
                let is_whole = !normal.contains(&None);
                let normal = normal.map(|n| n.filter(|_| is_whole).unwrap_or(0.0));
                store.write(|out| write_numbers(out, "vn", &normal))
            }
        };
        self.pieces.push(piece);
    }

    /// Factor that takes the file's colours to 0..1: some programs write 0..255.
    pub(super) fn color_scale(&self) -> f32 {
        if self.brightest > 1.0 {
            1.0 / 255.0
        } else {
            1.0
        }
    }

    /// Gives white to the vertices without colour, if there are others with one.
    pub(super) fn fill_colors(&mut self, store: &mut Store, notes: &mut Notes) {
        if self.color_scale() < 1.0 {
            notes.element("vertex colours", "go beyond 1; read as 0 to 255");
        }
        if self.colored == 0 || self.colored == self.counts.v {
            return;
        }
        let without = self.counts.v - self.colored;
        let text = format!(
            "{without} of {} vertices have none; they are white",
            self.counts.v
        );
        notes.element("vertex colours", text);
        let white = 1.0 / self.color_scale();
        let old = store.copy(&self.pieces);
        let filled = store.write(|out| {
            for line in old.split_inclusive(|&b| b == b'\n') {
                let (word, values) = keyword(line.trim_ascii_end());
                if word == b"v" && parsed(values).nth(5).is_none() {
                    let mut position: Vec<f32> = parsed(values).flatten().collect();
                    let w = position.get(3).copied().unwrap_or(1.0);
                    position.truncate(3);
                    position.iter_mut().for_each(|p| *p /= w);
                    position.extend([white; 3]);
                    write_numbers(out, "v", &position);
                } else {
                    out.extend_from_slice(line);
                }
            }
        });
        self.pieces = Pieces::default();
        self.pieces.push(filled);
    }

    /// Adds a zero texture coordinate, for corners without one.
    pub(super) fn pad_texcoord(&mut self, store: &mut Store) -> usize {
        self.counts.vt += 1;
        self.pieces
            .push(store.write(|out| write_numbers(out, "vt", &[0.0; 2])));
        self.counts.vt
    }

    /// Adds a zero normal, for corners without one.
    pub(super) fn pad_normal(&mut self, store: &mut Store) -> usize {
        self.counts.vn += 1;
        self.pieces
            .push(store.write(|out| write_numbers(out, "vn", &[0.0; 3])));
        self.counts.vn
    }
}

fn write_numbers<'n>(out: &mut Vec<u8>, word: &str, numbers: impl IntoIterator<Item = &'n f32>) {
    out.extend_from_slice(word.as_bytes());
    for number in numbers {
        // Writing to a vector cannot fail.
        let _ = write!(out, " {number:e}");
    }
    out.push(b'\n');
}

/// Position and colour of a vertex statement that is not plain.
fn mended_vertex(values: &[u8], line: usize, notes: &mut Notes) -> ([f32; 3], Option<[f32; 3]>) {
    let numbers: Vec<Option<f32>> = parsed(values).take(9).collect();
    let three = |at: usize| [0, 1, 2].map(|i| numbers.get(at + i).copied().flatten());
    let position = three(0);
    if numbers.len() < 3 {
        notes.line(
            line,
            "vertex with fewer than 3 coordinates; faces that use it are dropped",
        );
    } else if position.contains(&None) {
        notes.line(
            line,
            "vertex with a coordinate that is no number; faces that use it are dropped",
        );
    }
    let mut position = position.map(|p| p.unwrap_or(f32::NAN));
    let mut color = None;
    match numbers.len() {
        0..=3 => {}
        4 => match numbers[3].filter(|w| w.is_finite() && *w != 0.0) {
            Some(w) => position = position.map(|p| p / w),
            None => {
                notes.line(
                    line,
                    "vertex with a weight of 0 or no number; faces that use it are dropped",
                );
                position = [f32::NAN; 3];
            }
        },
        5 => notes.line(
            line,
            "numbers behind a vertex that are neither weight nor colour are left out",
        ),
        count => {
            let rgb = three(3);
            if rgb.iter().any(|c| !c.is_some_and(f32::is_finite)) {
                notes.line(line, "vertex colour cannot be read; white is used");
            } else {
                color = Some(rgb.map(|c| c.unwrap_or(1.0)));
            }
            if count == 7 {
                notes.line(line, "alpha of a vertex colour is left out");
            } else if count > 7 {
                notes.line(line, "numbers behind a vertex and its colour are left out");
            }
        }
    }
    (position, color)
}
