//! The visible edges of all triangles, as lines a pixel wide.
//!
//! The ray through each pixel's centre finds the triangle that is seen there, and the distance of the centre from that triangle's projected edges is the line. What is
//! hidden is never found, so that no depths are compared to find out what is visible, and no edge is looked at twice.
//! (Baerentzen et al., Single-pass Wireframe Rendering, 2006.)
//!
//! Half of a silhouette's line lies on what is behind it. So a pixel also draws the edges of triangles that its eight neighbours see, unless its own triangle hides
//! the nearest point of the edge. A line may so reach behind an object by a pixel, where more than one triangle of it is near.

use std::collections::HashMap;

use glam::{DVec2, DVec3};
use rayon::prelude::*;

use super::EDGE_COLOR;
use super::canvas::{Canvas, line_coverage, nearest};
use super::screen_map::ScreenMap;
use crate::accel::extents::View;
use crate::render::integrator::first_visible;
use crate::render::{PixelRect, RayCone, RayKind, Stage, Tracer};

/// Edge of a tile, in pixels.
const TILE: u32 = 32;

/// Height of a triangle on the screen from which its edges are drawn in full, in line widths. Lines of lower ones are fainter: they would run together and hide the
/// picture of a mesh whose triangles are smaller than pixels.
const FULL_HEIGHT: f64 = 5.0;

/// Opacity of the lines of the smallest triangles.
const LEAST_OPACITY: f64 = 0.12;

/// Draws the edges in the window of a canvas. Rays are sent for its pixels and for those around it, also beyond the picture, so that a crop shows the same.
pub(super) fn draw(
    canvas: &mut Canvas,
    stage: &Stage,
    map: &ScreenMap,
    view: &View,
    window: PixelRect,
    width: f64,
) {
    let tiles = window.tiles(TILE);
    let drawn: Vec<Vec<f32>> = tiles
        .par_iter()
        .map(|rect| Tile::new(stage, map, view, *rect).opacities(map, width))
        .collect();
    for (rect, opacities) in tiles.iter().zip(drawn) {
        for ((x, y), opacity) in rect.pixels().zip(opacities) {
            canvas.dot(x.into(), y.into(), EDGE_COLOR, opacity);
        }
    }
}

/// A triangle on the screen.
struct Drawn {
    /// In camera space.
    corners: [DVec3; 3],
    /// The parts of the edges that the picture shows, in camera space, and their places.
    edges: [Option<([DVec3; 2], [DVec2; 2])>; 3],
    opacity: f64,
}

impl Drawn {
    fn new(map: &ScreenMap, corners: [DVec3; 3]) -> Self {
        let edges = [[0, 1], [1, 2], [2, 0]].map(|ends| {
            let ends = ends.map(|i: usize| corners[i]);
            Some((map.clip(ends)?, map.segment(ends)?))
        });
        Self {
            corners,
            edges,
            opacity: 1.0,
        }
    }

    /// Fainter if the triangle is small. One that the eye's plane cuts is near.
    fn with_opacity(self, map: &ScreenMap, width: f64) -> Self {
        if map.is_perspective() && self.corners.iter().any(|p| p.z <= 0.0) {
            return self;
        }
        let [a, b, c] = self.corners.map(|p| map.place(p));
        let longest = a.distance(b).max(b.distance(c)).max(c.distance(a));
        let height = (b - a).perp_dot(c - a).abs() / longest.max(f64::MIN_POSITIVE);
        Self {
            opacity: (height / (FULL_HEIGHT * width)).clamp(LEAST_OPACITY, 1.0),
            ..self
        }
    }

    /// Whether the triangle covers a place of the screen, before a depth.
    fn hides(&self, map: &ScreenMap, place: DVec2, depth: f64) -> bool {
        let [origin, direction] = map.ray(place);
        let [a, b, c] = self.corners.map(|p| p - origin);
        // The edge functions: volumes with the ray's direction.
        let volume = |p: DVec3, q: DVec3| direction.dot(p.cross(q));
        let (of_a, of_b, of_c) = (volume(b, c), volume(c, a), volume(a, b));
        let is_inside = (of_a >= 0.0 && of_b >= 0.0 && of_c >= 0.0)
            || (of_a <= 0.0 && of_b <= 0.0 && of_c <= 0.0);
        let sum = of_a + of_b + of_c;
        is_inside && (a.z * of_a + b.z * of_b + c.z * of_c) / sum < depth
    }
}

/// What is seen through the centres of a tile's pixels and of one more all around.
struct Tile {
    rect: PixelRect,
    /// Each triangle once.
    drawn: Vec<Drawn>,
    /// Row by row, with the border.
    seen: Vec<Option<u32>>,
}

impl Tile {
    fn new(stage: &Stage, map: &ScreenMap, view: &View, rect: PixelRect) -> Self {
        let mut tracer = Tracer::new(stage.accelerator, false);
        let mut numbers = HashMap::new();
        let mut drawn = Vec::new();
        let mut seen = Vec::new();
        for row in 0..rect.height + 2 {
            for column in 0..rect.width + 2 {
                let [x, y] = [(rect.x, column), (rect.y, row)]
                    .map(|(first, i)| i64::from(first) + i64::from(i) - 1);
                let inside = |at: i64, end: u32| u32::try_from(at).ok().filter(|&at| at < end);
                // Rays beyond the picture have no pixel, and no screen extent rejects them.
                let pixel = inside(x, view.size.0).zip(inside(y, view.size.1));
                let mut ray = view.camera.ray(x as f64 + 0.5, y as f64 + 0.5, pixel);
                let first = first_visible(
                    stage,
                    &mut tracer,
                    &mut ray,
                    RayCone::default(),
                    RayKind::Eye,
                );
                let hit = first.map(|(surface, _)| surface.hit);
                seen.push(hit.map(|hit| {
                    *numbers
                        .entry((hit.instance, hit.triangle))
                        .or_insert_with(|| {
                            let instance = &stage.scene.instances[hit.instance as usize];
                            let corners = stage.scene.mesh_of(hit.instance).triangle(hit.triangle);
                            let corners =
                                corners.corners().map(|p| map.seen(instance.world_point(p)));
                            drawn.push(Drawn::new(map, corners));
                            drawn.len() as u32 - 1
                        })
                }));
            }
        }
        Self { rect, drawn, seen }
    }

    /// How much of each pixel's colour is the lines'.
    fn opacities(self, map: &ScreenMap, width: f64) -> Vec<f32> {
        let drawn: Vec<Drawn> = self
            .drawn
            .into_iter()
            .map(|d| d.with_opacity(map, width))
            .collect();
        let columns = self.rect.width as usize + 2;
        let pixel = |(x, y): (u32, u32)| {
            let at = (y - self.rect.y) as usize * columns + (x - self.rect.x) as usize;
            let rows = [at, at + columns, at + 2 * columns];
            let own = self.seen[rows[1] + 1];
            let mut near: Vec<u32> = rows
                .iter()
                .flat_map(|&r| self.seen[r..r + 3].iter().flatten())
                .copied()
                .collect();
            near.sort_unstable();
            near.dedup();
            let place = DVec2::new(f64::from(x), f64::from(y)) + 0.5;
            let own_triangle = own.map(|own| &drawn[own as usize]);
            let opacity = near.iter().map(|&number| {
                let other = own_triangle.filter(|_| Some(number) != own);
                line_opacity(map, &drawn[number as usize], other, place, width)
            });
            opacity.fold(0.0, f64::max) as f32
        };
        self.rect.pixels().map(pixel).collect()
    }
}

/// The opacity of a triangle's lines at a place, in front of which another triangle may be.
fn line_opacity(
    map: &ScreenMap,
    drawn: &Drawn,
    other: Option<&Drawn>,
    place: DVec2,
    width: f64,
) -> f64 {
    let mut most = 0.0_f64;
    for (ends, places) in drawn.edges.iter().flatten() {
        let (share, point) = nearest(*places, place);
        let opacity = drawn.opacity * line_coverage(point.distance(place), width);
        if opacity <= most {
            continue;
        }
        // On the screen, it is the reciprocals of depths that are straight.
        let depth = if map.is_perspective() {
            1.0 / ((1.0 - share) / ends[0].z + share / ends[1].z)
        } else {
            ends[0].z + (ends[1].z - ends[0].z) * share
        };
        if !other.is_some_and(|other| other.hides(map, point, depth)) {
            most = opacity;
        }
    }
    most
}

#[cfg(test)]
mod tests {
    use super::super::screen_map::tests::{PARALLEL, PERSPECTIVE, SIZE, frame};
    use super::*;
    use crate::accel::AcceleratorKind;
    use crate::render::SkyMode;
    use crate::scene::{Instance, Material, Part, Projection, Scene, TriangleMesh};
    use glam::{DAffine3, Vec3};

    /// A large triangle, and behind it another that reaches out from behind it on one side.
    fn scene() -> Scene {
        let mesh = TriangleMesh {
            positions: vec![
                Vec3::new(-1.5, -0.5, 0.0),
                Vec3::new(2.0, 0.2, 0.3),
                Vec3::new(0.2, 2.7, -0.5),
                Vec3::new(0.0, 0.5, -3.0),
                Vec3::new(4.5, 0.9, -2.0),
                Vec3::new(0.7, 1.6, -2.5),
            ],
            triangles: vec![[0, 1, 2], [3, 4, 5]],
            parts: vec![Part {
                first_triangle: 0,
                triangle_count: 2,
                material: 0,
            }],
            ..TriangleMesh::default()
        };
        Scene {
            meshes: vec![mesh],
            instances: vec![Instance::new("two", 0, DAffine3::IDENTITY)],
            materials: vec![Material::default()],
            ..Scene::default()
        }
    }

    fn drawn(projection: Projection, window: PixelRect) -> Vec<f32> {
        let scene = scene();
        let accelerator = AcceleratorKind::Linear.build(&scene);
        let stage = Stage::new(&scene, &*accelerator, Vec3::Y, SkyMode::On);
        let view = View {
            camera: frame(projection),
            size: SIZE,
            filter_radius: 0.5,
        };
        let map = ScreenMap::new(&view.camera, SIZE);
        let mut canvas = Canvas::new(window);
        draw(&mut canvas, &stage, &map, &view, window, 1.0);
        canvas.into_pixels().iter().map(|p| p[3]).collect()
    }

    const WHOLE: PixelRect = PixelRect {
        x: 0,
        y: 0,
        width: SIZE.0,
        height: SIZE.1,
    };

    /// Where many points of the edges fall that are seen: nothing of the scene is before them, by `linear` and a margin that is neither's rounding.
    fn visible_points(projection: Projection) -> Vec<DVec2> {
        let scene = scene();
        let accelerator = AcceleratorKind::Linear.build(&scene);
        let camera = frame(projection);
        let map = ScreenMap::new(&camera, SIZE);
        let mut places = Vec::new();
        for triangle in 0..2 {
            let [a, b, c] = *scene.meshes[0].triangle(triangle).corners();
            for [from, to] in [[a, b], [b, c], [c, a]] {
                for i in 0..=4000 {
                    let point = from.lerp(to, i as f32 / 4000.0);
                    let place = map.place(map.seen(point));
                    let ray = camera.ray(place.x, place.y, None);
                    let far = (point - ray.origin).dot(ray.direction);
                    if accelerator
                        .closest_hit(&ray)
                        .is_none_or(|h| h.t > far - 0.01)
                    {
                        places.push(place);
                    }
                }
            }
        }
        places
    }

    #[test]
    fn lines_are_where_edges_are_seen_and_nowhere_else() {
        for projection in [PERSPECTIVE, PARALLEL] {
            let points = visible_points(projection);
            let found = drawn(projection, WHOLE);
            let map = ScreenMap::new(&frame(projection), SIZE);
            let corners = scene().meshes[0].positions.clone();
            let corners: Vec<DVec2> = corners.iter().map(|p| map.place(map.seen(*p))).collect();
            let mut inked = 0;
            for ((x, y), alpha) in WHOLE.pixels().zip(&found) {
                let center = DVec2::new(f64::from(x), f64::from(y)) + 0.5;
                let nearest = points.iter().map(|p| p.distance(center));
                let distance = nearest.fold(f64::INFINITY, f64::min);
                let want = line_coverage(distance, 1.0) as f32;
                // The points of a line that goes behind the large triangle end there; the line may go on for a pixel.
                assert!(
                    *alpha <= want + 0.02 || distance < 2.0,
                    "{x} {y}: {alpha}, {distance}"
                );
                // No pixel's centre may lie in the tip of a triangle.
                let is_tip = corners.iter().any(|c| c.distance(center) < 3.0);
                assert!(
                    *alpha >= want - 0.02 || is_tip,
                    "{x} {y}: {alpha} instead of {want}"
                );
                inked += u32::from(*alpha > want + 0.02);
            }
            assert!(inked < 8, "{inked} pixels beyond the ends of hidden lines");
        }
    }

    #[test]
    fn a_crop_across_tiles_shows_the_same() {
        let crop = PixelRect {
            x: 101,
            y: 53,
            width: 90,
            height: 71,
        };
        let whole = WHOLE.pixels().zip(drawn(PERSPECTIVE, WHOLE));
        let cut = whole.filter(|((x, y), _)| (101..191).contains(x) && (53..124).contains(y));
        let cut: Vec<f32> = cut.map(|(_, alpha)| alpha).collect();
        assert!(cut.iter().filter(|a| **a > 0.0).count() > 100);
        assert_eq!(drawn(PERSPECTIVE, crop), cut);
    }

    #[test]
    fn lines_of_small_triangles_are_faint() {
        let map = ScreenMap::new(&frame(PARALLEL), SIZE);
        let opacity = |size: f64| {
            let corners = [
                DVec3::Z,
                DVec3::new(3.0 * size, 0.0, 2.0),
                DVec3::new(size, size, 1.0),
            ];
            Drawn::new(&map, corners).with_opacity(&map, 1.0).opacity
        };
        // 200 pixels show a height of 7: the height of the triangle is `size` times that, above its longest edge.
        let pixels = 7.0 / 200.0;
        assert_eq!(
            (opacity(0.01 * pixels), opacity(9.0 * pixels)),
            (LEAST_OPACITY, 1.0)
        );
        assert!((opacity(2.5 * pixels) - 0.5).abs() < 1e-9);
    }
}
