//! A pass over the file's lines before `tobj` reads them.
//!
//! `tobj` 4.0.5 fails, panics or misplaces data on much that other programs write (tests/import_obj has a case of
//! each), and keeps neither line numbers nor the names of objects with groups. This pass gives it text without any of
//! that, and keeps what it would lose. Clean lines are passed through as they are.
//!
//! In the text for `tobj` all attributes come first, then each object as `o` with its faces. So a face may name a vertex
//! that the file defines later, and padding can be added behind the file's attributes.
//!
//! What cannot be read is noted and left out. Two things end the import, because what the file means is unknown: a
//! face that names vertex 0, and one that names a vertex which is not there. Texture coordinates and normals that are not
//! there only cost their corner that attribute.

use std::collections::HashMap;
use std::path::Path;

use super::super::ImportError;
use super::super::budget::Budget;
use super::attributes::Attributes;
use super::claims::Claims;
use super::faces::{self, Corner, Pads};
use super::notes::Notes;
use super::objects::{Given, Object, Objects, Presence};
use super::pieces::{Piece, Pieces, Store};
use super::text::{Line, Lines, decoded, keyword};

/// A name that a statement gives, and its line.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Named {
    /// The rest of the line.
    pub(super) name: String,
    /// The statement's line.
    pub(super) line: usize,
}

/// The file, ready for `tobj`.
pub(super) struct Prepared<'a> {
    /// Holds the text.
    pub(super) store: Store<'a>,
    /// The text.
    pub(super) text: Pieces,
    /// The objects, as the text orders them.
    pub(super) objects: Vec<Object>,
    /// Names that `usemtl` gives, by index.
    pub(super) materials: Vec<Named>,
    /// What stands behind `mtllib`.
    pub(super) libraries: Vec<Named>,
    /// Takes the file's colours to 0..1.
    pub(super) color_scale: f32,
    /// Number of positions in the file.
    pub(super) vertices: usize,
}

/// Bytes of a `v`, `vt` or `vn`, here and in `tobj`.
const ATTRIBUTE_BYTES: usize = 32;

/// Bytes of an object, group, material or library beside its name: the lists that name it, an empty mesh, its instance.
const STATEMENT_BYTES: usize = 2048;

/// Bytes that a character behind `mtllib` becomes: two may be the name of a file that is not there, with the note of it.
const LIBRARY_BYTES: usize = 128;

/// Bytes of a line that are charged before they are read, and not with its corners.
const LONG_LINE: usize = 1 << 16;

/// Bytes that are charged at once: the budget is shared by threads, and slow to ask.
const CHARGE_BYTES: usize = 1 << 20;

/// Reads the lines of `source`, whose line ends are plain. `file_name` names what has no name in the file.
pub(super) fn prepare<'a>(
    source: &'a [u8],
    file_name: &str,
    budget: &Budget,
    notes: &mut Notes,
) -> Result<Prepared<'a>, ImportError> {
    let mut pass = Pass {
        budget,
        claimed: 0,
        claims: Claims::default(),
        notes,
        store: Store::new(source),
        attributes: Attributes::default(),
        objects: Objects::default(),
        corners: Vec::new(),
        corner_count: 0,
        ahead: Vec::new(),
        attributes_ahead: Vec::new(),
        materials: Vec::new(),
        material_index: HashMap::new(),
        libraries: Vec::new(),
    };
    for line in Lines::new(source) {
        pass.statement(&line)?;
    }
    pass.finish(file_name)
}

struct Pass<'a, 'n> {
    budget: &'n Budget,
    // Bytes that are not charged yet.
    claimed: usize,
    claims: Claims,
    notes: &'n mut Notes,
    store: Store<'a>,
    attributes: Attributes,
    objects: Objects,
    corners: Vec<Corner>,
    corner_count: u64,
    // Vertices that a face named before they were there, each larger than the last, and the face's line.
    ahead: Vec<(i64, usize)>,
    // Lines of faces that named a texture coordinate or normal before it was there, and the largest of each.
    attributes_ahead: Vec<(usize, (i64, i64))>,
    materials: Vec<Named>,
    material_index: HashMap<Vec<u8>, u32>,
    libraries: Vec<Named>,
}

impl<'a> Pass<'a, '_> {
    fn statement(&mut self, line: &Line) -> Result<(), ImportError> {
        let (word, rest) = keyword(&line.text);
        self.claimed += match word {
            b"v" | b"vt" | b"vn" => ATTRIBUTE_BYTES,
            b"o" | b"g" | b"usemtl" => STATEMENT_BYTES + 4 * line.text.len(),
            b"mtllib" => STATEMENT_BYTES + LIBRARY_BYTES * line.text.len(),
            // The corners of a face are read at once, and have two bytes at least.
            b"f" | b"fo" if rest.len() > LONG_LINE => size_of::<Corner>() * rest.len(),
            _ => 0,
        };
        self.charge(line)?;
        let (store, notes) = (&mut self.store, &mut *self.notes);
        match word {
            b"v" => self.attributes.vertex(rest, line, store, notes),
            b"vt" => self.attributes.texcoord(rest, line, store, notes),
            b"vn" => self.attributes.normal(rest, line, store, notes),
            b"f" => self.face(rest, line, true)?,
            // "Face outline", the old word for the same.
            b"fo" => self.face(rest, line, false)?,
            b"o" => {
                self.claims.begin_object();
                self.objects.begin_object(decoded(rest).into_owned());
            }
            b"g" => {
                self.claims.begin_object();
                self.objects.begin_group(decoded(rest).into_owned());
            }
            b"usemtl" => self.use_material(rest, line.number),
            b"s" => self.smoothing_group(rest, line.number),
            b"mtllib" if !rest.is_empty() => self.libraries.push(Named {
                name: decoded(rest).into_owned(),
                line: line.number,
            }),
            _ if word.first().is_none_or(|&b| b == b'#') => {}
            _ => {
                if let Some(text) = left_out(word) {
                    notes.line(line.number, text);
                }
            }
        }
        Ok(())
    }

    /// Takes the memory of what was read, up to `line`, some at a time.
    fn charge(&mut self, line: &Line) -> Result<(), ImportError> {
        if self.claimed < CHARGE_BYTES {
            return Ok(());
        }
        let bytes = std::mem::take(&mut self.claimed);
        let element = || at_line(line.number);
        let charged = self.budget.charge(bytes as u64, element);
        charged.map_err(|cause| ImportError::invalid(self.notes.file(), element(), cause))
    }

    fn use_material(&mut self, name: &[u8], line: usize) {
        if name.is_empty() {
            self.notes
                .line(line, "usemtl without a name; the default material is used");
            return self.objects.use_material(None);
        }
        let index = match self.material_index.get(name) {
            Some(&index) => index,
            None => {
                let index = self.materials.len() as u32;
                self.material_index.insert(name.to_owned(), index);
                let name = decoded(name).trim().to_owned();
                self.materials.push(Named { name, line });
                index
            }
        };
        self.objects.use_material(Some(index));
    }

    fn smoothing_group(&mut self, text: &[u8], line: usize) {
        let text = text.split(|&b| b == b'#').next().unwrap_or_default();
        let group = match text.trim_ascii() {
            b"" | b"off" => 0,
            // Some programs know only one group.
            b"on" => 1,
            number => std::str::from_utf8(number)
                .ok()
                .and_then(|n| n.parse().ok())
                .unwrap_or_else(|| {
                    let text = "smoothing group that is no number; faces are flat from here on";
                    self.notes.line(line, text);
                    0
                }),
        };
        self.objects.use_smoothing_group(group);
    }

    fn face(&mut self, text: &[u8], line: &Line, is_f: bool) -> Result<(), ImportError> {
        let counts = self.attributes.counts;
        let Some(syntax) = faces::parse(text, &mut self.corners) else {
            let text = "face with a corner that is not made of indices is left out";
            self.notes.line(line.number, text);
            return Ok(());
        };
        let mut is_plain = syntax.is_plain && is_f;
        let mut presence = Presence::default();
        for corner in &mut self.corners {
            is_plain &= corner.v > 0;
            let Some(v) = faces::from_start(corner.v, counts.v) else {
                return Err(vertex_not_there(
                    self.notes.file(),
                    line.number,
                    corner.v,
                    counts.v,
                ));
            };
            corner.v = v as i64;
            if v > counts.v && self.ahead.last().is_none_or(|&(last, _)| last < corner.v) {
                self.ahead.push((corner.v, line.number));
            }
            let vt = resolve(&mut corner.vt, counts.vt, &mut presence.vt);
            let vn = resolve(&mut corner.vn, counts.vn, &mut presence.vn);
            if vt == Resolved::NotThere {
                self.notes.line(line.number, NO_SUCH_TEXCOORD);
            }
            if vn == Resolved::NotThere {
                self.notes.line(line.number, NO_SUCH_NORMAL);
            }
            is_plain &= vt == Resolved::AsWritten && vn == Resolved::AsWritten;
        }
        if faces::has_too_few_corners(&self.corners) {
            self.objects.drop_face(line.number);
            return Ok(());
        }
        self.claimed += self.claims.face(&self.corners, counts.v);
        self.corner_count += self.corners.len() as u64;
        if self.corner_count > u64::from(u32::MAX) {
            let cause = "more than 4,294,967,295 face corners; split the file";
            return Err(ImportError::unsupported(
                self.notes.file(),
                at_line(line.number),
                cause,
            ));
        }
        let piece = match &line.span {
            Some(span) if is_plain => Piece::Source(span.clone()),
            _ => self.store.write(|out| faces::write(out, &self.corners)),
        };
        if presence.vt.is_ahead || presence.vn.is_ahead {
            self.attributes_ahead.push((
                line.number,
                self.corners
                    .iter()
                    .fold((0, 0), |m, c| (m.0.max(c.vt), m.1.max(c.vn))),
            ));
        }
        self.objects.add_face(piece, presence);
        Ok(())
    }

    fn finish(mut self, file_name: &str) -> Result<Prepared<'a>, ImportError> {
        let counts = self.attributes.counts;
        if let Some(&(index, line)) = self
            .ahead
            .iter()
            .find(|(index, _)| *index > counts.v as i64)
        {
            return Err(vertex_not_there(self.notes.file(), line, index, counts.v));
        }
        for &(line, (vt, vn)) in &self.attributes_ahead {
            if vt > counts.vt as i64 {
                self.notes.line(line, NO_SUCH_TEXCOORD);
            }
            if vn > counts.vn as i64 {
                self.notes.line(line, NO_SUCH_NORMAL);
            }
        }
        let mut objects = self.objects.finish(file_name);
        self.attributes.fill_colors(&mut self.store, self.notes);
        let mut pads = None;
        for object in objects.iter_mut().filter(|o| o.presence.needs_alignment()) {
            let pads = *pads.get_or_insert_with(|| Pads {
                vt: self.attributes.pad_texcoord(&mut self.store),
                vn: self.attributes.pad_normal(&mut self.store),
            });
            let text = faces::aligned(&self.store.copy(&object.faces), counts, pads);
            object.faces = Pieces::default();
            object
                .faces
                .push(self.store.write(|out| out.extend_from_slice(&text)));
        }
        let color_scale = self.attributes.color_scale();
        let mut text = self.attributes.pieces;
        for object in &mut objects {
            text.push(self.store.write(|out| out.extend_from_slice(b"o\n")));
            text.append(std::mem::take(&mut object.faces));
        }
        Ok(Prepared {
            store: self.store,
            text,
            objects,
            materials: self.materials,
            libraries: self.libraries,
            color_scale,
            vertices: counts.v,
        })
    }
}

const NO_SUCH_TEXCOORD: &str = "face names a texture coordinate that is not there; 0 0 is used";
const NO_SUCH_NORMAL: &str = "face names a normal that is not there; it is shaded flat";

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Resolved {
    AsWritten,
    Rewritten,
    NotThere,
}

/// Makes an optional index count from the start, or absent if it cannot be there.
fn resolve(index: &mut i64, count: usize, given: &mut Given) -> Resolved {
    if *index == faces::ABSENT {
        given.not_by_all = true;
        return Resolved::AsWritten;
    }
    let Some(from_start) = faces::from_start(*index, count) else {
        given.not_by_all = true;
        *index = faces::ABSENT;
        return Resolved::NotThere;
    };
    given.by_some = true;
    given.is_ahead |= from_start > count;
    let from_start = from_start as i64;
    let written = std::mem::replace(index, from_start);
    if written == from_start {
        Resolved::AsWritten
    } else {
        Resolved::Rewritten
    }
}

fn at_line(line: usize) -> String {
    format!("line {line}")
}

fn vertex_not_there(file: &Path, line: usize, index: i64, vertices: usize) -> ImportError {
    let cause = match index {
        0 => "face names vertex 0; vertices are counted from 1".to_owned(),
        _ if index < 0 => {
            format!("face names vertex {index}, counted back from {vertices}: index out of range")
        }
        _ => format!("face names vertex {index} of {vertices}: index out of range"),
    };
    ImportError::invalid(file, at_line(line), cause)
}

/// What is said of a statement that makes no face, or `None` if nothing is lost with it.
fn left_out(word: &[u8]) -> Option<&'static str> {
    Some(match word {
        b"mtllib" => "mtllib without a name is left out",
        // Merging groups, parameter vertices, tags of subdivision surfaces, display attributes of faces.
        b"mg" | b"vp" | b"t" | b"bevel" | b"c_interp" | b"d_interp" | b"lod" => return None,
        // Parts of the free-form statements below, and techniques of drawing them.
        b"cstype" | b"deg" | b"bmat" | b"step" | b"parm" | b"trim" | b"hole" | b"scrv" | b"sp"
        | b"end" | b"con" | b"ctech" | b"stech" => return None,
        b"p" => "points are left out; only faces are rendered",
        b"l" => "lines are left out; only faces are rendered",
        b"curv" | b"curv2" => "curves are left out; only faces are rendered",
        b"surf" => "free-form surfaces are left out; export them as polygons",
        b"bsp" | b"bzp" | b"cdc" | b"cdp" | b"res" => {
            "patches of an old version are left out; export them as polygons"
        }
        b"call" | b"csh" => "calls of other files are left out; load those files too",
        b"shadow_obj" | b"trace_obj" => "stand-ins for shadows and reflections are left out",
        b"maplib" | b"usemap" => "usemap is left out; name the texture in the MTL",
        _ => "unknown statements are left out",
    })
}
