//! Cameras and lights, in world space. glTF 2.0 specification, section 3.10, and KHR_lights_punctual.

use std::f32::consts::{FRAC_PI_2, FRAC_PI_4};

use ::gltf::json::camera::Type;
use ::gltf::json::validation::Checked;
use glam::{DVec3, Vec3};

use super::document::{Document, label};
use super::extensions::Extension;
use super::nodes::Placed;
use super::notes::Notes;
use crate::geometry::Aabb;
use crate::scene::{Camera, Light, LightKind, Projection};

/// The camera that a node places, or `None` with a note. `bounds` are the scene's, in world space.
pub(super) fn camera(
    document: &Document,
    placed: &Placed,
    bounds: &Aabb,
    notes: &mut Notes,
) -> Option<Camera> {
    let json = document.root.cameras.get(placed.what);
    let element = label("camera", placed.what, json.and_then(|c| c.name.as_ref()));
    let Some(json) = json else {
        notes.add(
            document.node_label(placed.node),
            format!("{element} is not there"),
        );
        return None;
    };
    let projection = match (json.type_, &json.perspective, &json.orthographic) {
        (Checked::Valid(Type::Perspective), Some(p), _) => Projection::Perspective {
            view_angle: p.yfov.to_degrees(),
        },
        (Checked::Valid(Type::Orthographic), _, Some(o)) => Projection::Orthographic {
            height: 2.0 * o.ymag.abs(),
        },
        _ => {
            notes.add(element, "left out: it has no projection");
            return None;
        }
    };
    // Scale does not count (section 3.10.2): only directions are taken from the matrix.
    let axes = placed.world_from_node.matrix3;
    let position = placed.world_from_node.translation;
    let forward = (-axes.z_axis).try_normalize();
    let view_up = axes.y_axis.try_normalize();
    let camera = forward.zip(view_up).map(|(forward, view_up)| Camera {
        name: own_name(document, placed, json.name.as_ref(), &element),
        position: position.as_vec3(),
        focal_point: (position + forward * focal_distance(position, forward, bounds)).as_vec3(),
        view_up: view_up.as_vec3(),
        projection,
    });
    let camera = camera.filter(|c| c.frame(1, 1).is_some());
    if camera.is_none() {
        notes.add(
            element,
            "left out: its angle, its height or its node's transform shows nothing",
        );
    }
    camera
}

/// Least distance of the focal point, as a share of the camera's largest coordinate. Both points are rounded to single
/// precision, each by at most 2^-24 of that coordinate and axis, so this share keeps the view within 2^-12 radians.
const LEAST_FOCAL_SHARE: f64 = 1e-3;

/// How far away the focal point is put, in world units: beside the middle of the scene where that lies ahead.
fn focal_distance(position: DVec3, forward: DVec3, bounds: &Aabb) -> f64 {
    let least = position.abs().max_element() * LEAST_FOCAL_SHARE;
    let ahead = if bounds.is_empty() {
        0.0
    } else {
        (bounds.center().as_dvec3() - position).dot(forward)
    };
    let distance = if ahead > 0.0 {
        ahead
    } else {
        f64::from(bounds.diagonal())
    };
    let distance = distance.max(least);
    if distance > 0.0 { distance } else { 1.0 }
}

/// The light that a node places, or `None` with a note.
pub(super) fn light(document: &Document, placed: &Placed, notes: &mut Notes) -> Option<Light> {
    let root = document.root.extensions.as_ref().map(|e| &e.others);
    let lights = Extension::find(root, "KHR_lights_punctual").map(|e| e.objects("lights"));
    let Some(json) = lights.and_then(|l| l.get(placed.what).copied().flatten()) else {
        let text = format!("light {} is not there", placed.what);
        notes.add(document.node_label(placed.node), text);
        return None;
    };
    let name = json.text("name").map(str::to_owned);
    let element = label("light", placed.what, name.as_ref());
    let kind = match json.text("type") {
        Some("directional") => LightKind::Directional,
        Some("point") => LightKind::Point,
        Some("spot") => {
            let angle = |key| json.object("spot").and_then(|s| s.number(key));
            let outer_angle = angle("outerConeAngle")
                .unwrap_or(FRAC_PI_4)
                .clamp(0.0, FRAC_PI_2);
            LightKind::Spot {
                inner_angle: angle("innerConeAngle")
                    .unwrap_or(0.0)
                    .clamp(0.0, outer_angle),
                outer_angle,
            }
        }
        _ => {
            notes.add(element, "left out: its type is unknown");
            return None;
        }
    };
    // Light travels along -z; scale counts neither for it nor for the range.
    let direction = (-placed.world_from_node.matrix3.z_axis).try_normalize();
    let is_point = kind == LightKind::Point;
    let Some(direction) = direction.or(is_point.then_some(DVec3::NEG_Z)) else {
        notes.add(
            element,
            "left out: its node's transform leaves it no direction",
        );
        return None;
    };
    let intensity = json.number("intensity").unwrap_or(1.0).max(0.0);
    Some(Light {
        name: own_name(document, placed, name.as_ref(), &element),
        kind,
        intensity: json.color("color", Vec3::ONE).max(Vec3::ZERO) * intensity,
        position: placed.world_from_node.translation.as_vec3(),
        direction: direction.as_vec3(),
        range: json.number("range").filter(|&r| r > 0.0),
    })
}

/// The node's name (which is unique where one camera or light is placed twice), else its own, else a made one.
fn own_name(document: &Document, placed: &Placed, name: Option<&String>, made: &str) -> String {
    let node = document.root.nodes[placed.node].name.as_ref();
    let found = [node, name].into_iter().flatten().find(|n| !n.is_empty());
    found.cloned().unwrap_or_else(|| made.to_owned())
}
