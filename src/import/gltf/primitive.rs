//! Primitive modes: from a run of vertex indices to triangles. glTF 2.0 specification, section 3.7.2.1.

use ::gltf::json::mesh::Mode;

/// Whether the mode has triangles. Points and lines have none.
pub(super) fn has_triangles(mode: Mode) -> bool {
    matches!(
        mode,
        Mode::Triangles | Mode::TriangleStrip | Mode::TriangleFan
    )
}

/// The triangles of `mode` over `indices`, counter-clockwise where the file's are. Indices at the end of a list that are
/// too few for a triangle are left out.
pub(super) fn triangles(mode: Mode, indices: &[u32]) -> Vec<[u32; 3]> {
    match (mode, indices) {
        (Mode::Triangles, _) => indices.as_chunks::<3>().0.to_vec(),
        // p(i), p(i + 1 + i % 2), p(i + 2 - i % 2): every other triangle of a strip is turned.
        (Mode::TriangleStrip, _) => indices
            .windows(3)
            .enumerate()
            .map(|(i, p)| [p[0], p[1 + i % 2], p[2 - i % 2]])
            .collect(),
        // p(i + 1), p(i + 2), p(0).
        (Mode::TriangleFan, [center, rim @ ..]) => {
            rim.windows(2).map(|p| [p[0], p[1], *center]).collect()
        }
        _ => Vec::new(),
    }
}

/// The place of the first index that is not below `count`.
pub(super) fn first_beyond(indices: &[u32], count: usize) -> Option<usize> {
    let is_beyond = |&i: &u32| i as usize >= count;
    // The maximum of a slice is found many at a time, its place is not.
    let greatest = indices.iter().copied().max()?;
    is_beyond(&greatest).then(|| indices.iter().position(is_beyond).unwrap_or(0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strips_and_fans_keep_their_winding() {
        let indices = [7, 1, 2, 3, 9];
        assert_eq!(triangles(Mode::Triangles, &indices), [[7, 1, 2]]);
        assert_eq!(
            triangles(Mode::TriangleStrip, &indices),
            [[7, 1, 2], [1, 3, 2], [2, 3, 9]]
        );
        assert_eq!(
            triangles(Mode::TriangleFan, &indices),
            [[1, 2, 7], [2, 3, 7], [3, 9, 7]]
        );
        for mode in [Mode::Triangles, Mode::TriangleStrip, Mode::TriangleFan] {
            assert!(has_triangles(mode));
            for few in 0..3 {
                assert!(triangles(mode, &indices[..few]).is_empty());
            }
        }
        assert!(!has_triangles(Mode::LineStrip));
    }

    #[test]
    fn the_first_index_out_of_range_is_found() {
        assert_eq!(first_beyond(&[0, 4, 3, 5], 4), Some(1));
        assert_eq!(first_beyond(&[0, 3], 4), None);
        assert_eq!(first_beyond(&[], 0), None);
    }
}
