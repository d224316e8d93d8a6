//! The outline of a sphere on the screen: an ellipse, a parabola or a branch of a hyperbola where the rays meet in the eye, a circle where they are parallel.
//!
//! The rays from the eye that touch a sphere form a cone: with the sphere's middle at a distance `d`, each is at an angle of `asin(r / d)` from the middle's direction.
//! Its points ahead of the eye are projected as they are, so that a sphere beside or around the border of the view needs no case of its own.

use glam::{DVec2, DVec3};

use super::canvas::nearest;
use super::screen_map::ScreenMap;
use crate::geometry::BoundingSphere;

/// How far the drawn polygon may be from the outline, in pixels, at the middle of an arc: not to be seen. Twice as fine costs 1.4 times the lines.
const FLATNESS: f64 = 0.05;

/// Arcs that are looked at first: too short for their middles to lie on their chords by chance.
const ARCS: u32 = 16;

/// Most halvings of an arc. Only arcs that go far beyond the picture, which is cut off, ask for so many.
const MOST_HALVINGS: u32 = 9;

/// The outline of what is ahead of the eye of a sphere, as segments in pixels, in the picture and a margin. Nothing for an eye within the sphere.
pub(super) fn silhouette(map: &ScreenMap, sphere: &BoundingSphere) -> Vec<[DVec2; 2]> {
    let center = map.seen(sphere.center);
    let radius = f64::from(sphere.radius);
    let Some(outline) = (if map.is_perspective() {
        cone(center, radius)
    } else {
        cylinder(center, radius)
    }) else {
        return Vec::new();
    };
    let at = |turn: f64| {
        let angle = turn * std::f64::consts::TAU;
        outline[0] + outline[1] * libm::cos(angle) + outline[2] * libm::sin(angle)
    };
    let mut segments = Vec::new();
    for arc in 0..ARCS {
        let ends = [arc, arc + 1].map(|i| f64::from(i) / f64::from(ARCS));
        add_arc(map, &at, ends, MOST_HALVINGS, &mut segments);
    }
    segments
}

/// Middle and two half axes of a circle through which the touching rays from the eye go.
fn cone(center: DVec3, radius: f64) -> Option<[DVec3; 3]> {
    let distance = center.length();
    if radius >= distance {
        return None;
    }
    let axis = center / distance;
    let (side, other) = axis.any_orthonormal_pair();
    let sine = radius / distance;
    let cosine = (1.0 - sine * sine).sqrt();
    Some([axis * cosine, side * sine, other * sine])
}

/// The same for parallel rays. Of a sphere whose middle is behind their start a smaller circle is ahead.
fn cylinder(center: DVec3, radius: f64) -> Option<[DVec3; 3]> {
    let behind = center.z.min(0.0);
    let ahead = radius * radius - behind * behind;
    let center = center.with_z(center.z.max(0.0));
    (ahead >= 0.0).then(|| [center, DVec3::X * ahead.sqrt(), DVec3::Y * ahead.sqrt()])
}

fn add_arc(
    map: &ScreenMap,
    at: &impl Fn(f64) -> DVec3,
    [from, to]: [f64; 2],
    halvings: u32,
    segments: &mut Vec<[DVec2; 2]>,
) {
    let middle = f64::midpoint(from, to);
    let points = [from, middle, to].map(at);
    let ahead = points.map(|p| !map.is_perspective() || p.z > 0.0);
    if ahead == [false; 3] {
        return;
    }
    let is_flat = || {
        let [a, m, b] = points.map(|p| map.place(p));
        nearest([a, b], m).1.distance(m) <= FLATNESS
    };
    if halvings == 0 || (ahead == [true; 3] && is_flat()) {
        segments.extend(map.segment([points[0], points[2]]));
    } else {
        add_arc(map, at, [from, middle], halvings - 1, segments);
        add_arc(map, at, [middle, to], halvings - 1, segments);
    }
}

#[cfg(test)]
mod tests {
    use super::super::screen_map::tests::{PARALLEL, PERSPECTIVE, SIZE, frame};
    use super::*;
    use glam::Vec3;

    /// Middles, radii: whole in the picture, to the side, around its border, and reaching behind the eye.
    const SPHERES: [(Vec3, f32); 5] = [
        (Vec3::new(0.4, 1.1, -1.0), 1.5),
        (Vec3::new(-2.5, 2.5, 1.0), 0.7),
        (Vec3::new(3.0, 0.0, 2.0), 2.5),
        (Vec3::new(-3.0, 2.0, 5.0), 2.9),
        (Vec3::new(1.0, -200.0, -3.0), 199.5),
    ];

    /// Distance of a ray's line from a point, by its definition.
    fn distance(ray: &crate::geometry::Ray, point: Vec3) -> f64 {
        let (o, d) = (ray.origin.as_dvec3(), ray.direction.as_dvec3());
        let p = point.as_dvec3() - o;
        (p - d * (p.dot(d) / d.length_squared())).length()
    }

    #[test]
    fn rays_through_the_outline_touch_the_sphere() {
        for projection in [PERSPECTIVE, PARALLEL] {
            let camera = frame(projection);
            let map = ScreenMap::new(&camera, SIZE);
            for (center, radius) in SPHERES {
                let found = silhouette(&map, &BoundingSphere { center, radius });
                assert!(!found.is_empty(), "{center} {radius}");
                for place in found.iter().flatten() {
                    let here = distance(&camera.ray(place.x, place.y, None), center);
                    // A pixel aside the distance is as much another as a flat arc allows, twenty times.
                    let aside =
                        |x, y| distance(&camera.ray(place.x + x, place.y + y, None), center) - here;
                    let a_pixel = DVec2::new(aside(1.0, 0.0), aside(0.0, 1.0)).length();
                    let off = (here - f64::from(radius)).abs() / a_pixel;
                    let is_cut =
                        place.x < 0.0 || place.y < 0.0 || place.x > 320.0 || place.y > 200.0;
                    assert!(
                        off < if is_cut { 0.5 } else { 2.0 * FLATNESS },
                        "{place}: {off}"
                    );
                }
            }
        }
    }

    /// Every ray of the picture hits the sphere just if an odd number of segments lies to its left, where the whole outline is in the picture.
    #[test]
    fn just_the_rays_within_the_outline_hit() {
        for projection in [PERSPECTIVE, PARALLEL] {
            let camera = frame(projection);
            let map = ScreenMap::new(&camera, SIZE);
            let (center, radius) = SPHERES[0];
            let found = silhouette(&map, &BoundingSphere { center, radius });
            for i in 0..SIZE.0 * SIZE.1 {
                let (x, y) = (f64::from(i % SIZE.0) + 0.5, f64::from(i / SIZE.0) + 0.5);
                let crosses = |[a, b]: &&[DVec2; 2]| {
                    (a.y <= y) != (b.y <= y) && a.x + (b.x - a.x) * (y - a.y) / (b.y - a.y) < x
                };
                let is_inside = found.iter().filter(crosses).count() % 2 == 1;
                let place = DVec2::new(x, y);
                let near = found.iter().map(|s| nearest(*s, place).1.distance(place));
                if near.fold(f64::INFINITY, f64::min) > 0.1 {
                    let hits = distance(&camera.ray(x, y, None), center) <= f64::from(radius);
                    assert_eq!(is_inside, hits, "{x} {y}");
                }
            }
        }
    }

    #[test]
    fn within_and_behind_there_is_no_outline() {
        let around = BoundingSphere {
            center: Vec3::new(2.0, 2.0, 6.0),
            radius: 1.5,
        };
        let behind = BoundingSphere {
            center: Vec3::new(1.0, 2.0, 9.0),
            radius: 1.0,
        };
        let map = ScreenMap::new(&frame(PERSPECTIVE), SIZE);
        assert!(silhouette(&map, &around).is_empty() && silhouette(&map, &behind).is_empty());
        let map = ScreenMap::new(&frame(PARALLEL), SIZE);
        assert!(!silhouette(&map, &around).is_empty() && silhouette(&map, &behind).is_empty());
    }
}
