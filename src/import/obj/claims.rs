//! What the faces of a file will take, in bytes, from above: it is charged to the budget before their mesh is made.
//!
//! A vertex of a mesh is a combination of position, texture coordinate and normal. The combination that a position had last in its
//! object is remembered, so that a vertex counts once where faces share it, and a seam more than once at worst.

use super::faces::Corner;

/// Bytes of a corner here, in `tobj` and in the mesh: its indices and its share of a triangle. Like [`VERTEX_BYTES`] measured as peak memory
/// (grids of a million triangles, half a million single ones, with and without attributes): charged are 1.0 to 1.3 times the peak.
const CORNER_BYTES: usize = 40;

/// Bytes of a vertex of a mesh, here, in `tobj` and in the mesh, beside its statements.
const VERTEX_BYTES: usize = 120;

/// Bytes of a corner of the largest polygon while it is triangulated.
const POLYGON_CORNER_BYTES: usize = 160;

/// The combination that a position had last.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Combination {
    /// 0 for none.
    object: u32,
    vt: u32,
    vn: u32,
}

/// What was claimed so far.
#[derive(Debug)]
pub(super) struct Claims {
    last: Vec<Combination>,
    object: u32,
    largest_polygon: usize,
}

impl Default for Claims {
    fn default() -> Self {
        Self {
            last: Vec::new(),
            object: 1,
            largest_polygon: 0,
        }
    }
}

impl Claims {
    /// Vertices are not shared with the faces before.
    pub(super) fn begin_object(&mut self) {
        self.object = self.object.saturating_add(1);
    }

    /// Bytes that a face takes. Indices count from 1; of positions there are `known` so far, and so many are remembered at most.
    pub(super) fn face(&mut self, corners: &[Corner], known: usize) -> usize {
        let mut vertices = 0;
        for corner in corners {
            let combination = Combination {
                object: self.object,
                // Others than the low bits hardly matter: files of so many are refused for their size.
                vt: corner.vt as u32,
                vn: corner.vn as u32,
            };
            let place = usize::try_from(corner.v).unwrap_or(usize::MAX);
            if place > known {
                vertices += 1;
                continue;
            }
            if self.last.len() <= place {
                self.last.resize(known + 1, Combination::default());
            }
            let last = std::mem::replace(&mut self.last[place], combination);
            vertices += usize::from(last != combination);
        }
        // One polygon is triangulated at a time.
        let more = corners.len().saturating_sub(self.largest_polygon.max(4));
        self.largest_polygon = self.largest_polygon.max(corners.len());
        CORNER_BYTES * corners.len() + VERTEX_BYTES * vertices + POLYGON_CORNER_BYTES * more
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn corners(indices: &[[i64; 2]]) -> Vec<Corner> {
        let corner = |&[v, vt]: &[i64; 2]| Corner { v, vt, vn: 0 };
        indices.iter().map(corner).collect()
    }

    #[test]
    fn vertices_count_once_where_they_are_shared() {
        let mut claims = Claims::default();
        let first = corners(&[[1, 5], [2, 6], [3, 7]]);
        let beside = corners(&[[3, 7], [2, 6], [4, 8]]);
        let seam = corners(&[[3, 9], [2, 6], [4, 8]]);
        let ahead = corners(&[[1, 5], [2, 6], [i64::MAX, 1]]);
        let of = |vertices| 3 * CORNER_BYTES + vertices * VERTEX_BYTES;
        assert_eq!(claims.face(&first, 4), of(3));
        assert_eq!(claims.face(&beside, 4), of(1));
        assert_eq!(claims.face(&seam, 4), of(1));
        assert_eq!(claims.face(&ahead, 4), of(1));
        claims.begin_object();
        assert_eq!(claims.face(&first, 4), of(3));
        assert_eq!(claims.last.len(), 5);
    }

    #[test]
    fn only_the_largest_polygon_is_charged_for_its_cutting() {
        let mut claims = Claims::default();
        let polygon = |count| corners(&vec![[1, 1]; count]);
        let cutting =
            |claims: &mut Claims, count| claims.face(&polygon(count), 1) - count * CORNER_BYTES;
        assert_eq!(
            cutting(&mut claims, 10),
            VERTEX_BYTES + 6 * POLYGON_CORNER_BYTES
        );
        assert_eq!(cutting(&mut claims, 10), 0);
        assert_eq!(cutting(&mut claims, 12), 2 * POLYGON_CORNER_BYTES);
    }
}
