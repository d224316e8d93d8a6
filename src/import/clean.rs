//! Drops what is broken in an otherwise good mesh, and says so.

use std::path::Path;

use glam::Vec3;

use super::line::one_line;
use crate::geometry::tolerance::COORDINATE_LIMIT;
use crate::scene::{Defect, DefectCause, TriangleMesh};

/// Drops triangles with a corner that is not finite or too large, and those without area. What was dropped is added to
/// `defects`, one entry a cause.
///
/// Positions that are not finite are set to zero (no triangle uses them any more), so that every position of the mesh
/// is finite.
pub(super) fn drop_broken_triangles(
    mesh: &mut TriangleMesh,
    file: &Path,
    defects: &mut Vec<Defect>,
) {
    let mut found: Vec<(DefectCause, u64, u64)> = Vec::new();
    let causes: Vec<Option<DefectCause>> = (0..mesh.triangles.len() as u32)
        .map(|t| cause_against(mesh, t))
        .collect();
    for (first, cause) in causes
        .iter()
        .enumerate()
        .filter_map(|(i, c)| c.map(|c| (i as u64, c)))
    {
        match found.iter_mut().find(|(c, ..)| *c == cause) {
            Some((_, count, _)) => *count += 1,
            None => found.push((cause, 1, first)),
        }
    }
    if !found.is_empty() {
        mesh.retain_triangles(|t| causes[t as usize].is_none());
        let element = one_line(format!("mesh {:?}", mesh.name));
        defects.extend(found.into_iter().map(|(cause, count, first)| Defect {
            file: file.to_owned(),
            element: element.clone(),
            cause,
            count,
            first,
        }));
    }
    for position in &mut mesh.positions {
        if !position.is_finite() || position.abs().max_element() > COORDINATE_LIMIT {
            *position = Vec3::ZERO;
        }
    }
}

fn cause_against(mesh: &TriangleMesh, triangle: u32) -> Option<DefectCause> {
    let t = mesh.triangle(triangle);
    if !t.corners().iter().all(|p| p.is_finite()) {
        Some(DefectCause::NotFinite)
    } else if t
        .corners()
        .iter()
        .any(|p| p.abs().max_element() > COORDINATE_LIMIT)
    {
        Some(DefectCause::TooLarge)
    } else if t.is_degenerate() {
        Some(DefectCause::Degenerate)
    } else {
        None
    }
}
