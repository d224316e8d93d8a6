//! Nodes that show their mesh many times: EXT_mesh_gpu_instancing.

use glam::{DAffine3, DQuat, DVec3, DVec4};

use super::accessor::Accessor;
use super::document::Document;
use super::extensions::Extension;
use super::notes::Notes;
use crate::import::ImportError;

/// Most instances of a file's meshes: 2^22, which is a gigabyte. Accessors without bytes make instances cost nothing in the file.
pub(super) const MOST_INSTANCES: usize = 1 << 22;

/// The placements `node_from_instance` of what a node shows, if it shows it more or less often than once.
pub(super) fn placements(
    document: &Document,
    node: usize,
    notes: &mut Notes,
) -> Result<Option<Vec<DAffine3>>, ImportError> {
    let json = &document.root.nodes[node];
    let extensions = json.extensions.as_ref().map(|e| &e.others);
    let Some(extension) = Extension::find(extensions, "EXT_mesh_gpu_instancing") else {
        return Ok(None);
    };
    let element = || format!("{}, EXT_mesh_gpu_instancing", document.node_label(node));
    if json.skin.is_some() {
        notes.add(element(), "left out: joints place the mesh, once");
        return Ok(None);
    }
    let attributes = extension.object("attributes");
    let open = |name: &str, width: usize| {
        let index = attributes.and_then(|a| a.index(name));
        let accessor = index.map(|i| Accessor::open(document, i)?.with_width(width..=width));
        let accessor = accessor.transpose();
        accessor.map_err(|cause| document.invalid(element(), format!("{name}: {cause}")))
    };
    let translations = open("TRANSLATION", 3)?;
    let rotations = open("ROTATION", 4)?.map(Accessor::into_normalized);
    let scales = open("SCALE", 3)?;
    let all = [&translations, &rotations, &scales];
    let counts = all.map(|a| a.as_ref().map(|a| a.count));
    let mut counts = counts.into_iter().flatten();
    let Some(count) = counts.next() else {
        notes.add(element(), "places nothing anywhere: the mesh is shown once");
        return Ok(None);
    };
    if let Some(other) = counts.find(|&c| c != count) {
        let cause = format!("its attributes place {count} and {other} instances");
        return Err(document.invalid(element(), cause));
    }
    if count > MOST_INSTANCES {
        let cause = format!("places {count} instances; at most {MOST_INSTANCES} are read");
        return Err(document.invalid(element(), cause));
    }
    super::charge_instances(document, node, count)?;
    // Fits: the count of an accessor has 32 bits.
    let wanted: Vec<u32> = (0..count as u32).collect();
    let translations = translations.map(|a| a.read(&wanted, [0.0_f32; 3]));
    let rotations = rotations.map(|a| a.read(&wanted, [0.0_f32; 4]));
    let scales = scales.map(|a| a.read(&wanted, [0.0_f32; 3]));
    let three = |values: &Option<Vec<[f32; 3]>>, i: usize, default| {
        let value = values.as_ref().map(|v| DVec3::from(v[i].map(f64::from)));
        value.unwrap_or(default)
    };
    let placement = |i: usize| {
        let rotation = rotations.as_ref().and_then(|v| {
            let unit = DVec4::from(v[i].map(f64::from)).try_normalize();
            unit.map(DQuat::from_vec4)
        });
        DAffine3::from_scale_rotation_translation(
            three(&scales, i, DVec3::ONE),
            rotation.unwrap_or(DQuat::IDENTITY),
            three(&translations, i, DVec3::ZERO),
        )
    };
    Ok(Some((0..count).map(placement).collect()))
}
