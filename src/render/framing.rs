//! Finds a camera for a scene that has none, or for one who says only where to look from.

use glam::{DVec3, Vec3};

use crate::scene::{Camera, Projection, Scene};

/// Share of the picture's width and height that stays free around the scene, on all sides together.
const MARGIN: f64 = 0.08;

/// Least distance of the eye from the nearest point, as a share of half the scene's diagonal.
const CLEARANCE: f64 = 0.5;

/// The full angle between the picture's top and bottom that cameras of our own have, in degrees: that of F3D and VTK.
pub const DEFAULT_VIEW_ANGLE: f32 = 30.0;

/// What is known of the camera before the scene is looked at. Whatever is `None` is chosen so that the whole scene is seen.
#[derive(Clone, Copy, Debug, Default)]
pub struct CameraWishes {
    /// Where the eye is.
    pub position: Option<Vec3>,
    /// What is in the middle of the picture.
    pub focal_point: Option<Vec3>,
    /// What appears upwards; by default the scene's up.
    pub view_up: Option<Vec3>,
    /// The full angle between the picture's top and bottom, in degrees.
    pub view_angle: Option<f32>,
    /// The direction in which the eye looks; need not be of unit length.
    pub direction: Option<Vec3>,
}

/// A camera that grants the wishes and sees the scene.
///
/// `up` is the scene's upward axis, `aspect` the picture's width over its height. Without a position the eye is put as
/// near as the whole scene allows, in the direction wished for or else before the scene, to the right and above.
pub fn frame_scene(scene: &Scene, wishes: &CameraWishes, up: Vec3, aspect: f64) -> Camera {
    let bounds = scene.bounds();
    let (center, radius) = if bounds.is_empty() {
        (Vec3::ZERO, 1.0)
    } else {
        (bounds.center(), (bounds.diagonal() / 2.0).max(1e-30))
    };
    let view_angle = wishes.view_angle.unwrap_or(DEFAULT_VIEW_ANGLE);
    let mut camera = Camera {
        name: String::new(),
        position: Vec3::ZERO,
        focal_point: Vec3::ZERO,
        view_up: wishes.view_up.unwrap_or(up),
        projection: Projection::Perspective { view_angle },
    };
    match (wishes.position, wishes.focal_point) {
        (Some(position), focal_point) => {
            camera.position = position;
            camera.focal_point = match (focal_point, wishes.direction) {
                (Some(focal_point), _) => focal_point,
                (None, Some(direction)) => position + direction.normalize_or_zero() * radius,
                // An eye in the very middle of the scene looks at something all the same.
                (None, None) if position.distance(center) < radius * 1e-4 => {
                    position + three_quarter(up) * radius
                }
                (None, None) => center,
            };
        }
        (None, focal_point) => {
            let into = || open_side(scene, up).map(|side| -side);
            let direction = wishes
                .direction
                .or_else(into)
                .unwrap_or_else(|| three_quarter(up));
            camera.focal_point = focal_point.unwrap_or(center);
            camera.position = camera.focal_point - direction.normalize_or_zero() * radius;
            let half_height = libm::tan(f64::from(view_angle).to_radians() / 2.0) * (1.0 - MARGIN);
            let tangents = [half_height * aspect, half_height];
            // An eye that just fits in a spike's tip would see nothing but the tip.
            let clearance = f64::from(radius) * CLEARANCE;
            fit(
                &mut camera,
                scene,
                tangents,
                focal_point.is_some(),
                clearance,
            );
        }
    }
    camera
}

/// The direction of the usual look at an object: from before it, a little from the right, and from above.
fn three_quarter(up: Vec3) -> Vec3 {
    // "Before" is +z where y is up, as glTF has it, and -y where z is up, as Blender has it.
    let up = up.normalize_or_zero();
    let front = if up.z.abs() > 0.9 {
        Vec3::NEG_Y
    } else {
        Vec3::Z
    };
    let front = (front - up * front.dot(up))
        .try_normalize()
        .unwrap_or(Vec3::X);
    let right = up.cross(front);
    -(front * 0.80 + right * 0.55 + up * 0.45).normalize_or_zero()
}

/// Share of the whole area that must be missing on one side for a scene to count as open there.
const OPEN: f64 = 0.08;

/// The horizontal direction, if any, in which the scene is a box without its front: one looks into it from there.
///
/// The areas of a closed surface, each times its normal, sum to zero; what is missing to that is the opening. A box whose
/// faces look inwards misses its front wall, a lone picture its back.
fn open_side(scene: &Scene, up: Vec3) -> Option<Vec3> {
    // Of each mesh, the sum of its area vectors and of their lengths.
    let areas = scene.meshes.iter().map(|mesh| {
        (0..mesh.triangles.len() as u32).fold((DVec3::ZERO, 0.0), |(sum, total), t| {
            let [a, b, c] = mesh.triangle(t).corners().map(|p| p.as_dvec3());
            let area = (b - a).cross(c - a) * 0.5;
            (sum + area, total + area.length())
        })
    });
    let areas: Vec<_> = areas.collect();
    let (mut sum, mut total) = (DVec3::ZERO, 0.0);
    for instance in &scene.instances {
        let (vector, area) = areas[instance.mesh as usize];
        // Cofactors take area vectors to world space, and turn a mirrored mesh's inside out.
        let cofactors = instance.cofactors();
        let norm = cofactors
            .to_cols_array()
            .iter()
            .map(|x| x * x)
            .sum::<f64>()
            .sqrt();
        sum += if instance.is_mirrored() {
            -(cofactors * vector)
        } else {
            cofactors * vector
        };
        // Right for even scales, and for others as a mean over directions.
        total += area * norm / 3.0_f64.sqrt();
    }
    let up = up.as_dvec3().normalize_or_zero();
    let horizontal = sum - up * sum.dot(up);
    (horizontal.length() > OPEN * total).then(|| horizontal.normalize().as_vec3())
}

/// Moves the eye so that the scene just fits into the picture, along the view and, unless the focal point is wished for, across it.
///
/// In the camera's axes a point at (x, y, z) is within the right edge if x - ex <= (ez - z) tan, for an eye at (ex, ey, ez). So
/// the least ez for each pair of opposite edges follows from the extremes of x + z tan and -x + z tan over all points. The eye
/// keeps the distance `clearance` from the nearest point.
fn fit(camera: &mut Camera, scene: &Scene, tangents: [f64; 2], is_centered: bool, clearance: f64) {
    let Some(frame) = camera.frame(1000, 1000) else {
        return;
    };
    let [right, up, back, _] = frame.world_from_camera();
    let origin = camera.focal_point.as_dvec3();
    // For each axis across the view, the greatest x + z tan and -x + z tan, and last the greatest z.
    let [x_tan, y_tan] = tangents;
    let [right_most, left_most, top_most, low_most, nearest] =
        scene.extremes(1.0 + x_tan.max(y_tan), |point| {
            let p = point.as_dvec3() - origin;
            let (x, y, z) = (p.dot(right), p.dot(up), p.dot(back));
            [
                x + z * x_tan,
                -x + z * x_tan,
                y + z * y_tan,
                -y + z * y_tan,
                z,
            ]
        });
    let extremes = [[right_most, left_most], [top_most, low_most]];
    let mut offset = DVec3::ZERO;
    let mut distance = nearest + clearance;
    for ((extreme, axis), tangent) in extremes.iter().zip([right, up]).zip(tangents) {
        if is_centered {
            distance = distance.max(extreme[0].max(extreme[1]) / tangent);
        } else {
            distance = distance.max((extreme[0] + extreme[1]) / (2.0 * tangent));
            offset += axis * ((extreme[0] - extreme[1]) / 2.0);
        }
    }
    if distance.is_finite() && distance > 0.0 {
        camera.focal_point = (origin + offset).as_vec3();
        camera.position = (origin + offset + back * distance).as_vec3();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Instance, Part, TriangleMesh};
    use glam::DAffine3;

    /// A long thin triangle, so that the fit across and along the view differ.
    fn scene() -> Scene {
        let mesh = TriangleMesh {
            positions: vec![
                Vec3::new(100.0, 0.0, 0.0),
                Vec3::new(108.0, 1.0, 0.0),
                Vec3::new(100.0, 0.0, 2.0),
            ],
            triangles: vec![[0, 1, 2]],
            parts: vec![Part {
                first_triangle: 0,
                triangle_count: 1,
                material: 0,
            }],
            ..TriangleMesh::default()
        };
        Scene {
            meshes: vec![mesh],
            instances: vec![Instance::new("", 0, DAffine3::IDENTITY)],
            ..Scene::default()
        }
    }

    /// Screen positions of all corners, from 0 to 1.
    fn on_screen(camera: &Camera, aspect: f64) -> Vec<(f64, f64)> {
        let frame = camera
            .frame((1000.0 * aspect) as u32, 1000)
            .expect("a camera that sees the scene");
        let [right, up, back, eye] = frame.world_from_camera();
        let half = frame.half_size();
        let place = |p: Vec3| {
            let p = p.as_dvec3() - eye;
            let z = -p.dot(back);
            assert!(z > 0.0, "behind the eye");
            (
                (p.dot(right) / z / half.0 + 1.0) / 2.0,
                (p.dot(up) / z / half.1 + 1.0) / 2.0,
            )
        };
        scene()
            .world_points(&scene().clusters())
            .map(place)
            .collect()
    }

    #[test]
    fn the_whole_scene_is_seen_and_touches_the_margin() {
        for aspect in [0.5, 1.0, 3.0] {
            for direction in [None, Some(Vec3::NEG_Z), Some(Vec3::new(-1.0, 0.1, 2.0))] {
                let wishes = CameraWishes {
                    direction,
                    ..CameraWishes::default()
                };
                let places = on_screen(&frame_scene(&scene(), &wishes, Vec3::Y, aspect), aspect);
                let all = places.iter().flat_map(|p| [p.0, p.1]);
                let (least, greatest) =
                    all.fold((1.0_f64, 0.0_f64), |(l, g), x| (l.min(x), g.max(x)));
                assert!(
                    least > MARGIN / 2.0 - 1e-3 && greatest < 1.0 - MARGIN / 2.0 + 1e-3,
                    "{aspect} {direction:?} {places:?}"
                );
                // By itself the eye looks down the spike, and keeps clear of it.
                assert!(
                    direction.is_none()
                        || least < MARGIN / 2.0 + 1e-3 && greatest > 1.0 - MARGIN / 2.0 - 1e-3,
                    "{places:?}"
                );
            }
        }
    }

    #[test]
    fn an_open_box_is_looked_into() {
        // The five inner faces of a box of 1 by 2 by 3 without its face at x = 1; corners counter-clockwise from inside.
        let corner = |i: u32| {
            Vec3::new(
                (i & 1) as f32,
                (i >> 1 & 1) as f32 * 2.0,
                (i >> 2) as f32 * 3.0,
            )
        };
        let quads = [
            [0, 4, 6, 2],
            [0, 1, 5, 4],
            [2, 6, 7, 3],
            [0, 2, 3, 1],
            [4, 5, 7, 6],
        ];
        let triangles: Vec<_> = quads
            .iter()
            .flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]])
            .collect();
        let turned = |triangles: Vec<[u32; 3]>| {
            let part = Part {
                first_triangle: 0,
                triangle_count: triangles.len() as u32,
                material: 0,
            };
            let positions = (0..8).map(corner).collect();
            let mesh = TriangleMesh {
                positions,
                triangles,
                parts: vec![part],
                ..TriangleMesh::default()
            };
            let instances = vec![Instance::new("", 0, DAffine3::IDENTITY)];
            Scene {
                meshes: vec![mesh],
                instances,
                ..Scene::default()
            }
        };
        let inside = turned(triangles.iter().map(|&[a, b, c]| [a, c, b]).collect());
        let side = open_side(&inside, Vec3::Y).expect("open");
        assert!((side.dot(Vec3::X).abs() - 1.0).abs() < 1e-6, "{side}");
        assert_eq!(
            open_side(&turned(triangles), Vec3::Y).map(|s| s.dot(side) < 0.0),
            Some(true)
        );
        let camera = frame_scene(&inside, &CameraWishes::default(), Vec3::Y, 1.0);
        assert!((camera.position - camera.focal_point).normalize().dot(side) > 0.999);
    }

    #[test]
    fn wishes_are_granted() {
        let wishes = CameraWishes {
            position: Some(Vec3::new(1.0, 2.0, 3.0)),
            view_angle: Some(50.0),
            view_up: Some(Vec3::X),
            ..CameraWishes::default()
        };
        let camera = frame_scene(&scene(), &wishes, Vec3::Y, 1.0);
        assert_eq!(camera.position, Vec3::new(1.0, 2.0, 3.0));
        assert_eq!(camera.focal_point, scene().bounds().center());
        assert_eq!(
            (camera.view_up, camera.projection),
            (Vec3::X, Projection::Perspective { view_angle: 50.0 })
        );
        let focal_point = Some(Vec3::new(104.0, 0.0, 0.0));
        let camera = frame_scene(
            &scene(),
            &CameraWishes {
                focal_point,
                ..CameraWishes::default()
            },
            Vec3::Y,
            1.0,
        );
        assert_eq!(camera.focal_point, Vec3::new(104.0, 0.0, 0.0));
    }
}
