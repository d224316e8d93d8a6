//! Objects, groups and material runs: what becomes a mesh.
//!
//! A mesh is what `o` names. Blender, MeshLab and Rhino write `o` for each object and `g` for parts of one; 3ds Max, Maya,
//! SketchUp and ZBrush write only `g`, one for each object. So: if the file has an `o`, groups are parts of the object in
//! which they stand; if it has none, each `g` with faces is a mesh, and one that is named again at once goes on. The
//! whole rest of a line is a name (`g front cube` is one group, called "front cube"). Materials and smoothing groups stay in use across `o` and `g`.

use super::pieces::{Piece, Pieces};

/// Faces in a row with one material, or in one smoothing group.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Run<T> {
    /// Index of its first face in the object.
    pub(super) first_face: u32,
    /// What they have.
    pub(super) value: T,
}

/// Goes on with another value from a face on.
fn start_run<T: PartialEq>(runs: &mut Vec<Run<T>>, value: T, first_face: u32) {
    match runs.last_mut() {
        Some(last) if last.value == value => {}
        Some(last) if last.first_face == first_face => last.value = value,
        _ => runs.push(Run { first_face, value }),
    }
}

/// Faces left out because they have too few corners.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct TooFewCorners {
    /// How many.
    pub(super) count: u64,
    /// Index of the first one in the object.
    pub(super) first_face: u64,
    /// Line of the first one.
    pub(super) line: usize,
}

/// How corners give an index that is optional.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Given {
    /// Some corner has it.
    pub(super) by_some: bool,
    /// Some corner lacks it.
    pub(super) not_by_all: bool,
    /// Some corner names what was not there yet, and may never be.
    pub(super) is_ahead: bool,
}

impl Given {
    fn is_mixed(self) -> bool {
        self.is_ahead || (self.by_some && self.not_by_all)
    }

    fn join(&mut self, other: Self) {
        self.by_some |= other.by_some;
        self.not_by_all |= other.not_by_all;
        self.is_ahead |= other.is_ahead;
    }
}

/// How corners give their optional indices.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Presence {
    /// Texture coordinates.
    pub(super) vt: Given,
    /// Normals.
    pub(super) vn: Given,
}

impl Presence {
    /// Whether the faces must be written anew to be read right.
    pub(super) fn needs_alignment(self) -> bool {
        self.vt.is_mixed() || self.vn.is_mixed()
    }

    fn join(&mut self, other: Self) {
        self.vt.join(other.vt);
        self.vn.join(other.vn);
    }
}

/// The faces of one mesh to be.
#[derive(Debug, Default)]
pub(super) struct Object {
    /// Its name.
    pub(super) name: String,
    /// Runs of the indices of `usemtl` names, where there are any.
    pub(super) materials: Vec<Run<Option<u32>>>,
    /// Runs of smoothing groups; 0 is none.
    pub(super) smoothing: Vec<Run<u32>>,
    /// The text of its faces.
    pub(super) faces: Pieces,
    /// Number of faces in that text.
    pub(super) face_count: u32,
    /// Faces that are not in that text.
    pub(super) dropped: Option<TooFewCorners>,
    /// Which indices its corners have.
    pub(super) presence: Presence,
    // Which `o` it belongs to (0: before the first), and which group.
    ordinal: usize,
    group: Option<String>,
}

impl Object {
    fn is_empty(&self) -> bool {
        self.face_count == 0 && self.dropped.is_none()
    }

    fn faces_read(&self) -> u64 {
        u64::from(self.face_count) + self.dropped.map_or(0, |d| d.count)
    }

    fn join(&mut self, next: Object) {
        let read = self.faces_read();
        for run in next.materials {
            let first_face = self.face_count + run.first_face;
            start_run(&mut self.materials, run.value, first_face);
        }
        for run in next.smoothing {
            let first_face = self.face_count + run.first_face;
            start_run(&mut self.smoothing, run.value, first_face);
        }
        self.dropped = match (self.dropped, next.dropped) {
            (Some(a), b) => Some(TooFewCorners {
                count: a.count + b.map_or(0, |b| b.count),
                ..a
            }),
            (None, b) => b.map(|b| TooFewCorners {
                first_face: read + b.first_face,
                ..b
            }),
        };
        self.face_count += next.face_count;
        self.faces.append(next.faces);
        self.presence.join(next.presence);
    }
}

/// Takes statements in the file's order and makes objects of them.
#[derive(Default)]
pub(super) struct Objects {
    done: Vec<Object>,
    current: Object,
    names: Vec<String>,
    material: Option<u32>,
    smoothing_group: u32,
}

impl Objects {
    /// `o`.
    pub(super) fn begin_object(&mut self, name: String) {
        self.names.push(name);
        self.begin(None);
    }

    /// `g`.
    pub(super) fn begin_group(&mut self, name: String) {
        let name = if name.is_empty() {
            "default".to_owned()
        } else {
            name
        };
        self.begin(Some(name));
    }

    fn begin(&mut self, group: Option<String>) {
        if !self.current.is_empty() {
            self.done.push(std::mem::take(&mut self.current));
        }
        self.current.ordinal = self.names.len();
        self.current.group = group;
    }

    /// `usemtl`.
    pub(super) fn use_material(&mut self, material: Option<u32>) {
        self.material = material;
    }

    /// `s`; 0 ends a group.
    pub(super) fn use_smoothing_group(&mut self, group: u32) {
        self.smoothing_group = group;
    }

    /// `f`.
    pub(super) fn add_face(&mut self, face: Piece, presence: Presence) {
        let number = self.current.face_count;
        start_run(&mut self.current.materials, self.material, number);
        start_run(&mut self.current.smoothing, self.smoothing_group, number);
        self.current.faces.push(face);
        self.current.face_count += 1;
        self.current.presence.join(presence);
    }

    /// `f` with fewer than three different corners.
    pub(super) fn drop_face(&mut self, line: usize) {
        let first_face = self.current.faces_read();
        self.current
            .dropped
            .get_or_insert(TooFewCorners {
                count: 0,
                first_face,
                line,
            })
            .count += 1;
    }

    /// The objects that have faces, in the file's order, named. `file_name` names what nothing in the file does.
    pub(super) fn finish(mut self, file_name: &str) -> Vec<Object> {
        self.begin(None);
        let mut objects: Vec<Object> = Vec::new();
        for segment in self.done {
            let goes_on = |last: &&mut Object| {
                if self.names.is_empty() {
                    last.group == segment.group
                } else {
                    last.ordinal == segment.ordinal
                }
            };
            match objects.last_mut().filter(goes_on) {
                Some(last) => last.join(segment),
                None => objects.push(segment),
            }
        }
        for object in &mut objects {
            object.name = match object.ordinal.checked_sub(1).map(|i| &self.names[i]) {
                Some(name) if name.is_empty() => format!("object {}", object.ordinal),
                Some(name) => name.clone(),
                None => object.group.take().unwrap_or_else(|| file_name.to_owned()),
            };
        }
        objects
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn face(objects: &mut Objects, at: usize) {
        objects.add_face(Piece::Source(at..at + 1), Presence::default());
    }

    fn named_counts(objects: Objects) -> Vec<(String, u32)> {
        objects
            .finish("file")
            .into_iter()
            .map(|o| (o.name, o.face_count))
            .collect()
    }

    #[test]
    fn groups_are_parts_of_objects() {
        let mut objects = Objects::default();
        face(&mut objects, 0);
        objects.begin_object("a".to_owned());
        for (at, group) in ["x", "y"].into_iter().enumerate() {
            objects.begin_group(group.to_owned());
            face(&mut objects, 10 + 5 * at);
        }
        objects.begin_object(String::new());
        face(&mut objects, 30);
        let expected = [("file", 1), ("a", 2), ("object 2", 1)];
        assert_eq!(
            named_counts(objects),
            expected.map(|(n, c)| (n.to_owned(), c))
        );
    }

    #[test]
    fn without_objects_each_group_is_one() {
        let mut objects = Objects::default();
        for (at, group) in ["x", "x", "", "empty", "x"].into_iter().enumerate() {
            objects.begin_group(group.to_owned());
            if group != "empty" {
                face(&mut objects, 5 * at);
            }
        }
        let expected = [("x", 2), ("default", 1), ("x", 1)];
        assert_eq!(
            named_counts(objects),
            expected.map(|(n, c)| (n.to_owned(), c))
        );
    }

    #[test]
    fn runs_merge_and_carry_into_the_next_object() {
        let mut objects = Objects::default();
        objects.use_material(Some(4));
        objects.begin_object("a".to_owned());
        for (at, material) in [Some(4), Some(7), None, None].into_iter().enumerate() {
            objects.begin_group(format!("{at}"));
            objects.use_material(material);
            face(&mut objects, 10 * at);
        }
        let objects = objects.finish("file");
        let run = |first_face, value| Run { first_face, value };
        assert_eq!(
            objects[0].materials,
            [run(0, Some(4)), run(1, Some(7)), run(2, None)]
        );
        // Groups of vertices are no smoothing groups.
        let none = Run {
            first_face: 0,
            value: 0,
        };
        assert_eq!(objects[0].smoothing, [none]);
    }
}
