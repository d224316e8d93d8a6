//! Motion vectors: how far, and where to, what a pixel shows moves on the picture until the frame after, and from where it came since the one before.
//!
//! A vector belongs to the surface point that the ray through the pixel's centre meets. The same point of the same triangle is looked for in the frame
//! beside, whose camera projects it. Names, unit and directions are those of Nuke's layers `forward` and `backward`: pixels, x to the
//! right and y upwards, from the place on this picture to the place on the other one.

use std::collections::HashMap;

use glam::{DVec2, DVec3};

use super::film::{Film, FirstHit};
use crate::picture::{Channel, Picture, Samples};
use crate::scene::{CameraFrame, Scene};

/// Names of the channels, in the order in which a pixel's numbers are worked out.
const CHANNELS: [&str; 4] = ["backward.u", "backward.v", "forward.u", "forward.v"];

/// One frame of a sequence: where things are, and who sees them.
#[derive(Clone, Copy, Debug)]
pub struct MotionFrame<'a> {
    /// The scene as it is posed then.
    pub scene: &'a Scene,
    /// The camera, for pictures of the size of the film.
    pub camera: &'a CameraFrame,
}

/// Adds the channels `backward.u`, `backward.v`, `forward.u` and `forward.v` to the layers of a film: from each pixel's surface point in the frame `now`, which the film shows,
/// to the same point in the frame `before` and in the frame `after`. In pixels, x to the right, y upwards.
///
/// A point may lead beyond the picture's edges. Zero where nothing is met, where the frame beside lacks the triangle, and where the point is there at or
/// behind the eye.
///
/// Instances are the same if they have one place in scenes of equally many, or else the only ones of their name; triangles by their place in meshes of equally many,
/// or else by their vertices in meshes of equally many of these.
#[must_use]
pub fn add_motion(
    picture: Picture,
    film: &Film,
    now: MotionFrame,
    before: MotionFrame,
    after: MotionFrame,
) -> Picture {
    let ways = [Way::new(now, before), Way::new(now, after)];
    let vectors: Vec<[f32; 4]> = film.map(|pixel| {
        let Some(first) = pixel.first else {
            return [0.0; 4];
        };
        let [back, on] = ways.each_ref().map(|way| way.vector(first));
        [back.x, back.y, on.x, on.y].map(|v| v as f32)
    });
    CHANNELS
        .iter()
        .enumerate()
        .fold(picture, |picture, (index, name)| {
            let values = vectors.iter().map(|v| v[index]).collect();
            picture.with_channel(Channel::new(*name, Samples::F32(values)))
        })
}

/// From one frame to another.
struct Way<'a> {
    from: MotionFrame<'a>,
    to: MotionFrame<'a>,
    /// For each instance of the first scene its index in the other.
    instances: Vec<Option<u32>>,
}

impl<'a> Way<'a> {
    fn new(from: MotionFrame<'a>, to: MotionFrame<'a>) -> Self {
        let instances = same_instances(from.scene, to.scene);
        Self {
            from,
            to,
            instances,
        }
    }

    /// How far a point moves on the picture, in pixels to the right and upwards; zero where that cannot be told.
    fn vector(&self, first: &FirstHit) -> DVec2 {
        // Both places are worked out alike, so that what stands still has exact zeros.
        let place = |frame: &MotionFrame, point| frame.camera.project(point);
        let here = self.here(first).and_then(|p| place(&self.from, p));
        let there = self.there(first).and_then(|p| place(&self.to, p));
        let (Some(here), Some(there)) = (here, there) else {
            return DVec2::ZERO;
        };
        let way = self.from.camera.way(here, there);
        // Not -0, of which a still picture would be full.
        DVec2::new(way.x, 0.0 - way.y)
    }

    /// The point in this frame.
    fn here(&self, first: &FirstHit) -> Option<DVec3> {
        let (scene, instance) = (self.from.scene, first.hit.instance);
        let corners = scene.mesh_of(instance).triangles[first.hit.triangle as usize];
        point(scene, instance, corners, first.barycentric)
    }

    /// The point in the other frame.
    fn there(&self, first: &FirstHit) -> Option<DVec3> {
        let instance = self.instances[first.hit.instance as usize]?;
        let mesh = self.from.scene.mesh_of(first.hit.instance);
        let other = self.to.scene.mesh_of(instance);
        let triangle = first.hit.triangle as usize;
        let corners = if mesh.triangles.len() == other.triangles.len() {
            other.triangles[triangle]
        } else if mesh.positions.len() == other.positions.len() {
            // One of them had to leave triangles out that it had squashed.
            mesh.triangles[triangle]
        } else {
            return None;
        };
        point(self.to.scene, instance, corners, first.barycentric)
    }
}

/// A point of a triangle of an instance, in world space.
fn point(scene: &Scene, instance: u32, corners: [u32; 3], (u, v): (f32, f32)) -> Option<DVec3> {
    let mesh = scene.mesh_of(instance);
    let [a, b, c] = corners.map(|v| mesh.positions[v as usize].as_dvec3());
    let on_mesh = a + (b - a) * f64::from(u) + (c - a) * f64::from(v);
    let placement = scene.instances[instance as usize].world_from_object;
    let placed = placement.transform_point3(on_mesh);
    placed.is_finite().then_some(placed)
}

/// For each instance of a scene its index in another pose of it.
fn same_instances(scene: &Scene, other: &Scene) -> Vec<Option<u32>> {
    if scene.instances.len() == other.instances.len() {
        return (0..scene.instances.len() as u32).map(Some).collect();
    }
    // Something came or went.
    let count = |scene: &'_ Scene| {
        let mut found: HashMap<String, (u32, u32)> = HashMap::new();
        for (index, instance) in (0..).zip(&scene.instances) {
            let (_, count) = found.entry(instance.name.clone()).or_insert((index, 0));
            *count += 1;
        }
        found
    };
    let (ours, theirs) = (count(scene), count(other));
    let only = |names: &HashMap<String, (u32, u32)>, name: &str| {
        let (index, count) = *names.get(name)?;
        (count == 1).then_some(index)
    };
    let instances = scene.instances.iter();
    instances
        .map(|i| only(&ours, &i.name).and_then(|_| only(&theirs, &i.name)))
        .collect()
}
