//! Ray cones: how wide the patch is that a ray stands for, so that textures are looked up no finer.
//!
//! Akenine-Moeller, Crassin, Boksansky, Belcour, Panteleev and Wright, "Improved Shader and Texture Level of Detail Using Ray
//! Cones", JCGT 10(1), 2021, after "Texture Level of Detail Strategies for Real-Time Ray Tracing", Ray Tracing Gems, chapter
//! 20. Widths are diameters in model units, angles are in radians, in the approximation for small ones.

use glam::{Vec2, Vec3};

/// The cone around a ray.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RayCone {
    /// Diameter where the ray is now, in model units.
    pub width: f32,
    /// How much the diameter grows by length, in radians. Negative behind concave mirrors.
    pub spread: f32,
}

/// Least cosine between a ray and a surface that counts: at a grazing angle, patches grow beyond all bounds.
const LEAST_COSINE: f32 = 1.0 / 64.0;

impl RayCone {
    /// The cone of a pixel as a pinhole sees it. `spread` is the angle of a pixel: for a perspective camera,
    /// `2 tan(vertical view angle / 2) / rows`.
    pub fn of_pixel(spread: f32) -> Self {
        Self { width: 0.0, spread }
    }

    /// The cone after the ray has gone `distance`, in model units.
    #[must_use]
    pub fn propagated(self, distance: f32) -> Self {
        Self {
            width: self.width + self.spread * distance,
            ..self
        }
    }

    /// The cone after a bounce that spreads the light by another `angle`: twice the angle by which the surface's normal turns over the
    /// cone's width for a mirror, and about the width of the lobe for a rough surface.
    #[must_use]
    pub fn widened(self, angle: f32) -> Self {
        Self {
            spread: self.spread + angle,
            ..self
        }
    }

    /// The width of the patch that the cone covers on a surface, in model units: of the circle of the same area as the
    /// ellipse, whose axes are the cone's width and that by the `cosine` between ray and normal.
    ///
    /// The paper's isotropic level takes the longer axis, which blurs what is seen at an angle; here samples of the same pixel do the
    /// rest of the filtering.
    pub fn footprint(self, cosine: f32) -> f32 {
        self.width.abs() / cosine.abs().clamp(LEAST_COSINE, 1.0).sqrt()
    }
}

/// How many units of texture coordinates a model unit is on a triangle: the root of the ratio of its areas in both. 0 for a
/// triangle without an area, on which there is nothing to look up.
///
/// The paper has the logarithm of this ratio, in texels, in its triangle constant.
pub fn uv_per_length([a, b, c]: [Vec3; 3], [p, q, r]: [Vec2; 3]) -> f32 {
    let area = (b - a).cross(c - a).length();
    let uv_area = (q - p).perp_dot(r - p).abs();
    let ratio = (uv_area / area).sqrt();
    if ratio.is_finite() { ratio } else { 0.0 }
}

/// Most that a patch is longer than wide in texture coordinates, for what its width counts.
const MOST_ANISOTROPY: f32 = 16.0;

/// How wide a patch of a triangle is in texture coordinates, for each model unit of its width: [`uv_per_length`] where they are not stretched much. A patch that is longer than
/// 16 times its width counts as if it were as wide as that, as in graphics hardware (OpenGL's EXT_texture_filter_anisotropic): else triangles whose
/// coordinates lie nearly on a line, as along seams, would be looked up in the finest detail however far they are. 0 for a triangle without an area, and where all coordinates are one point.
pub fn uv_width_per_length(points: [Vec3; 3], uvs: [Vec2; 3]) -> f32 {
    let ([a, b, c], [p, q, r]) = (points, uvs);
    let (e, f, s, t) = (b - a, c - a, q - p, r - p);
    let area = e.cross(f).length_squared();
    // Sum and product of the squares of the map's singular values.
    let sum = s.length_squared() * f.length_squared() - 2.0 * s.dot(t) * e.dot(f)
        + t.length_squared() * e.length_squared();
    let (sum, product) = (sum / area, s.perp_dot(t) * s.perp_dot(t) / area);
    let longest = 0.5 * (sum + (sum * sum - 4.0 * product).max(0.0).sqrt());
    let least = (longest / MOST_ANISOTROPY).sqrt();
    let width = uv_per_length(points, uvs);
    if least.is_finite() {
        width.max(least)
    } else {
        width
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::texture::{ColorSpace, Textures};
    use crate::scene::{Image, Material, Pixels, Scene, Texture, TextureRef};
    use glam::{Affine2, Vec4};

    /// A picture of 64 x 32 pixels that is used for colour: `value` by column and row.
    fn scene(value: impl Fn(u32, u32) -> f32) -> (Scene, Textures) {
        let pixel = |i: u32| {
            let v = value(i % 64, i / 64);
            [v, v, v, 1.0]
        };
        let scene = Scene {
            materials: vec![Material {
                base_color_texture: Some(TextureRef::default()),
                ..Material::default()
            }],
            textures: vec![Texture::default()],
            images: vec![Image {
                width: 64,
                height: 32,
                pixels: Some(Pixels::RgbaF32((0..64 * 32).map(pixel).collect())),
                ..Image::default()
            }],
            ..Scene::default()
        };
        let textures = Textures::new(&scene);
        (scene, textures)
    }

    fn checkerboard() -> (Scene, Textures) {
        scene(|x, y| ((x + y) % 2) as f32)
    }

    #[test]
    fn a_cone_grows_with_the_way_and_the_angle() {
        let eye = RayCone::of_pixel(0.002);
        let there = eye.propagated(3.0).widened(0.01).propagated(2.0);
        assert!((there.width - (0.006 + 0.024)).abs() < 1e-6);
        assert!((there.footprint(-0.25) - 2.0 * there.width).abs() < 1e-6);
        assert!(there.footprint(0.0).is_finite());
    }

    #[test]
    fn a_checkerboard_far_away_is_grey_and_near_it_is_sharp() {
        let (scene, textures) = checkerboard();
        // A floor of 2 x 1 units under one image, seen from above.
        let points = [Vec3::ZERO, Vec3::X * 2.0, Vec3::Z];
        let uvs = [Vec2::ZERO, Vec2::X, Vec2::Y];
        let look = |distance: f32, uv| {
            let cone = RayCone::of_pixel(0.001).propagated(distance);
            let width = cone.footprint(1.0) * uv_per_length(points, uvs);
            textures
                .lookup(&scene, &TextureRef::default(), uv, ColorSpace::Srgb, width)
                .x
        };
        let middle = |x: u32, y: u32| Vec2::new((x as f32 + 0.5) / 64.0, (y as f32 + 0.5) / 32.0);
        for (x, y) in [(3, 4), (4, 4), (63, 31), (0, 0)] {
            // A texel is 1/32 wide: up to a distance of 31 it is wider than a pixel.
            assert_eq!(look(30.0, middle(x, y)), ((x + y) % 2) as f32);
            assert!((look(70.0, middle(x, y)) - 0.5).abs() < 1e-6);
        }
        // Between levels 0 and 1, all is mixed by the logarithm.
        let half = look(31.25 * std::f32::consts::SQRT_2, middle(4, 5));
        assert!((half - 0.75).abs() < 1e-3, "{half}");
    }

    #[test]
    fn the_level_has_texels_of_the_footprint_on_a_plane_seen_at_an_angle() {
        // A bright texel spreads over 1, 4, 16 texels of the levels, so that the value there tells the level.
        let (scene, textures) = scene(|x, y| f32::from(u8::from((x, y) == (32, 16))));
        let points = [Vec3::ZERO, Vec3::X * 8.0, Vec3::Z * 4.0];
        let uvs = [Vec2::ZERO, Vec2::X, Vec2::Y];
        let cosine = 0.36_f32;
        for side in [2.0_f32, 4.0, 8.0, 16.0] {
            // The patch on the plane has the area of side^2 texels, each 1/8 x 1/8 units.
            let axis = 0.125 * side * cosine.sqrt();
            let cone = RayCone {
                width: axis,
                spread: 0.0,
            };
            let width = cone.footprint(cosine) * uv_per_length(points, uvs);
            // In the middle of the texel of that level that covers the bright one.
            let middle = |i: f32, n: f32| ((i / side).floor() + 0.5) * side / n;
            let at = Vec2::new(middle(32.0, 64.0), middle(16.0, 32.0));
            let found = textures.lookup(
                &scene,
                &TextureRef::default(),
                at,
                ColorSpace::Linear,
                width,
            );
            let expected = 1.0 / (side * side);
            assert!((found.x / expected - 1.0).abs() < 1e-3, "{side}: {found}");
        }
    }

    #[test]
    fn the_scale_of_the_textures_transform_counts() {
        let (scene, textures) = checkerboard();
        let twice = TextureRef {
            transform: Affine2::from_scale_angle_translation(Vec2::splat(8.0), 0.7, Vec2::ONE),
            ..TextureRef::default()
        };
        let look = |texture: &TextureRef, uv, width| {
            textures.lookup(&scene, texture, uv, ColorSpace::Linear, width)
        };
        let uv = Vec2::new(0.3, 0.6);
        for width in [0.002, 0.004, 0.01] {
            let direct = look(&TextureRef::default(), twice.map(uv), 8.0 * width);
            let found = look(&twice, uv, width);
            assert!((direct - found).abs().max_element() < 1e-4, "{width}");
        }
    }

    #[test]
    fn stretched_coordinates_count_as_a_sixteenth_as_wide_as_long() {
        let turn = |v: Vec2, angle: f32| Vec2::from_angle(angle).rotate(v);
        for (long, wide, expected) in [
            (1.0_f32, 1.0, 1.0_f32),
            (2.0, 0.25, 0.5_f32.sqrt()),
            (4.0, 0.25, 1.0),
            (4.0, 0.01, 1.0),
            (4.0, 0.0, 1.0),
            (0.0, 0.0, 0.0),
        ] {
            for angle in [0.0, 0.4, 1.3] {
                // A triangle in a plane that is turned, with a map of these singular values.
                let corners = [Vec2::ZERO, Vec2::new(0.3, 0.1), Vec2::new(-0.2, 0.7)];
                let map = |v: Vec2| turn(Vec2::new(long, wide) * turn(v, angle), 1.0 - angle);
                let points = corners.map(|v| glam::Quat::from_rotation_x(angle) * v.extend(2.0));
                let found = uv_width_per_length(points, corners.map(map));
                assert!((found - expected).abs() < 1e-3, "{long} {wide}: {found}");
            }
        }
        let line = [Vec3::ZERO, Vec3::X, Vec3::X * 2.0];
        assert_eq!(
            uv_width_per_length(line, [Vec2::ZERO, Vec2::X, Vec2::Y]),
            0.0
        );
    }

    #[test]
    fn absurd_footprints_are_survived() {
        let (scene, textures) = checkerboard();
        let sharp = |width| {
            let texture = TextureRef::default();
            textures.lookup(&scene, &texture, Vec2::ZERO, ColorSpace::Srgb, width)
        };
        for width in [0.0, -1.0, f32::NAN, 1e-30] {
            assert_eq!(sharp(width), sharp(0.0));
        }
        for width in [f32::INFINITY, 1e30] {
            assert_eq!(sharp(width), Vec4::new(0.5, 0.5, 0.5, 1.0));
        }
        assert_eq!(
            uv_per_length([Vec3::ZERO; 3], [Vec2::ZERO, Vec2::X, Vec2::Y]),
            0.0
        );
    }
}
