//! What is drawn over a picture to understand it: the extents of its objects, and the edges of its triangles.
//!
//! An overlay is a layer of its own, premultiplied and linear, in place of none of the picture's values. Everything is drawn in pixels of the full picture, whose
//! crops show a part of the same drawing.

mod canvas;
mod edges;
mod extents;
mod labels;
mod screen_map;
mod silhouette;
mod text;

use canvas::{Canvas, Color};
use screen_map::ScreenMap;

use super::film::PixelRect;
use super::stage::Stage;
use crate::accel::extents::{ExtentSphere, View, viewed_extents};
use crate::picture::{Channel, Picture, Samples};

/// Of screen extents and names: orange (230, 159, 0). The colours of extents are of Okabe and Ito's set, which differ for all
/// colour-blind eyes; here as linear values.
const SCREEN_COLOR: Color = [0.791, 0.347, 0.0];
/// Of boxes: sky blue (86, 180, 233).
const BOX_COLOR: Color = [0.093, 0.456, 0.815];
/// Of spheres: reddish purple (204, 121, 167).
const SPHERE_COLOR: Color = [0.604, 0.191, 0.386];
/// Of edges: magenta (240, 40, 150), which surfaces seldom have, and which is lost neither on white nor on black. Dark lines on light base colours with light ones
/// on dark were tried: textures broke them into dashes, and in the dark they were lost.
const EDGE_COLOR: Color = [0.871, 0.021, 0.305];

/// Opacity of the dark plates behind text.
const PLATE_OPACITY: f32 = 0.9;

/// Height of a picture, in pixels, from which lines and text are twice as large.
const LARGE: u32 = 1440;

/// What is to be drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct OverlayOptions {
    /// Whether each object's screen extent is drawn, with its name, and the outlines of its box and sphere in world space.
    pub extents: bool,
    /// Which sphere.
    pub sphere: ExtentSphere,
    /// Whether the visible edges of all triangles are drawn.
    pub edges: bool,
}

/// Numbers of objects whose extents were drawn, or not.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct OverlayReport {
    /// Objects that have extents at all.
    pub objects: usize,
    /// Those that have a screen extent which holds a pixel of the full picture.
    pub on_picture: usize,
    /// Those that have their name on the full picture. Where names would hide one another, or too much, those of smaller objects are left out.
    pub named: usize,
    /// Those for which there is no screen extent: their placement is too skewed to bound the error of a ray, or leaves single precision.
    pub without_screen_extent: usize,
}

/// A drawing over a part of a picture.
///
/// ```
/// use bspray::accel::AcceleratorKind;
/// use bspray::accel::extents::View;
/// use bspray::render::{Overlay, OverlayOptions, PixelRect, SkyMode, Stage};
/// use glam::Vec3;
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let scene = bspray::import::load(&["models/lecture-objects.gltf".into()])?;
/// let accelerator = AcceleratorKind::default().build(&scene);
/// let stage = Stage::new(&scene, &*accelerator, Vec3::Y, SkyMode::Auto);
/// let camera = scene.cameras[0].frame(64, 48).ok_or("it sees nothing")?;
/// let view = View { camera, size: (64, 48), filter_radius: 0.5 };
/// let window = PixelRect { x: 0, y: 0, width: 64, height: 48 };
/// let options = OverlayOptions { extents: true, ..OverlayOptions::default() };
/// let overlay = Overlay::draw(&stage, &view, window, &options);
/// assert_eq!(overlay.report.objects, 14);
/// let mut white = vec![[1.0; 3]; 64 * 48];
/// overlay.lay_over(&mut white);
/// assert!(white.iter().any(|pixel| pixel[2] == 0.0));
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct Overlay {
    /// Row by row from the window's top: linear red, green and blue, multiplied by the opacity, and the opacity.
    pub pixels: Vec<[f32; 4]>,
    /// What was drawn of extents.
    pub report: OverlayReport,
}

impl Overlay {
    /// Names of its channels in pictures.
    pub const CHANNELS: [&str; 4] = ["overlay.R", "overlay.G", "overlay.B", "overlay.A"];

    /// Draws over `window` of the picture that a view shows of a stage. Work is shared by the threads of the rayon pool in which it is called.
    pub fn draw(stage: &Stage, view: &View, window: PixelRect, options: &OverlayOptions) -> Self {
        let map = ScreenMap::new(&view.camera, view.size);
        let scale = if view.size.1 < LARGE { 1 } else { 2 };
        let mut canvas = Canvas::new(window);
        let mut report = OverlayReport::default();
        if options.edges {
            edges::draw(&mut canvas, stage, &map, view, window, scale.into());
        }
        if options.extents {
            let extents = viewed_extents(stage.scene, options.sphere, view);
            let name = |index: u32| stage.scene.instances[index as usize].name.as_str();
            let objects: Vec<_> = extents.iter().map(|(i, e)| (name(*i), e)).collect();
            report = extents::draw(&mut canvas, &map, view.size, &objects, scale);
        }
        Self {
            pixels: canvas.into_pixels(),
            report,
        }
    }

    /// Lays it over display light, linear, row by row from the window's top.
    pub fn lay_over(&self, light: &mut [[f32; 3]]) {
        for (below, over) in light.iter_mut().zip(&self.pixels) {
            for (value, over_value) in below.iter_mut().zip(over) {
                *value = over_value + *value * (1.0 - over[3]);
            }
        }
    }

    /// Adds its channels to a picture of the same window.
    #[must_use]
    pub fn add_to(&self, picture: Picture) -> Picture {
        Self::CHANNELS
            .iter()
            .enumerate()
            .fold(picture, |picture, (i, name)| {
                let values = self.pixels.iter().map(|pixel| pixel[i]).collect();
                picture.with_channel(Channel::new(*name, Samples::F16(values)))
            })
    }
}

#[cfg(test)]
mod tests {
    use super::screen_map::tests::{PARALLEL, PERSPECTIVE, SIZE, frame};
    use super::*;
    use crate::accel::AcceleratorKind;
    use crate::render::SkyMode;
    use crate::render::integrator::first_visible;
    use crate::render::ray_cone::RayCone;
    use crate::render::tracer::{RayKind, Tracer};
    use crate::scene::Scene;
    use glam::Vec3;

    const WHOLE: PixelRect = PixelRect {
        x: 0,
        y: 0,
        width: SIZE.0,
        height: SIZE.1,
    };

    fn objects() -> Scene {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/models/lecture-objects.gltf");
        crate::import::load(&[path.into()]).unwrap()
    }

    fn on_stage<T>(scene: &Scene, body: impl Fn(&Stage) -> T) -> T {
        let accelerator = AcceleratorKind::default().build(scene);
        body(&Stage::new(scene, &*accelerator, Vec3::Y, SkyMode::On))
    }

    fn views() -> [View; 2] {
        [PERSPECTIVE, PARALLEL].map(|projection| View {
            camera: frame(projection),
            size: SIZE,
            filter_radius: 0.5,
        })
    }

    const BOTH: OverlayOptions = OverlayOptions {
        extents: true,
        sphere: ExtentSphere::Smallest,
        edges: true,
    };

    /// The pixels of each object that are seen lie between the four lines of its extent: there is its ink on the way to every border of the picture.
    #[test]
    fn what_is_seen_of_an_object_is_within_its_drawn_extent() {
        let mut scene = objects();
        let all = std::mem::take(&mut scene.instances);
        for instance in all {
            scene.instances = vec![instance];
            for view in views() {
                on_stage(&scene, |stage| {
                    let options = OverlayOptions {
                        edges: false,
                        ..BOTH
                    };
                    let overlay = Overlay::draw(stage, &view, WHOLE, &options);
                    let is_frame = |x: u32, y: u32| {
                        let [r, g, b, a] = overlay.pixels[(y * SIZE.0 + x) as usize];
                        a > 0.999
                            && [r, g, b]
                                .iter()
                                .zip(SCREEN_COLOR)
                                .all(|(v, c)| (v - c).abs() < 1e-6)
                    };
                    let mut tracer = Tracer::new(stage.accelerator, false);
                    for (x, y) in WHOLE.pixels() {
                        let (cx, cy) = (f64::from(x) + 0.5, f64::from(y) + 0.5);
                        let mut ray = view.camera.ray(cx, cy, Some((x, y)));
                        if first_visible(
                            stage,
                            &mut tracer,
                            &mut ray,
                            RayCone::default(),
                            RayKind::Eye,
                        )
                        .is_none()
                        {
                            continue;
                        }
                        let ways = [
                            (0..=x).any(|at| is_frame(at, y)),
                            (x..SIZE.0).any(|at| is_frame(at, y)),
                            (0..=y).any(|at| is_frame(x, at)),
                            (y..SIZE.1).any(|at| is_frame(x, at)),
                        ];
                        // Lines under a name are hidden by its plate.
                        let name = &scene.instances[0].name;
                        assert!(
                            ways.iter().filter(|w| **w).count() >= 3,
                            "{name}: {x} {y} {ways:?}"
                        );
                    }
                });
            }
        }
    }

    #[test]
    fn a_crop_is_a_part_of_the_same_drawing_and_threads_do_not_matter() {
        let crop = PixelRect {
            x: 77,
            y: 41,
            width: 133,
            height: 90,
        };
        for view in views() {
            on_stage(&objects(), |stage| {
                let whole = Overlay::draw(stage, &view, WHOLE, &BOTH);
                let pool = rayon::ThreadPoolBuilder::new()
                    .num_threads(3)
                    .build()
                    .unwrap();
                let part = pool.install(|| Overlay::draw(stage, &view, crop, &BOTH));
                let pixels = WHOLE.pixels().zip(&whole.pixels);
                let cut =
                    pixels.filter(|((x, y), _)| (77..210).contains(x) && (41..131).contains(y));
                let cut: Vec<[f32; 4]> = cut.map(|(_, pixel)| *pixel).collect();
                assert!(part.pixels == cut && part.report == whole.report);
                assert_eq!(whole.report.objects, 14);
            });
        }
    }

    #[test]
    fn it_lies_over_light_and_is_premultiplied() {
        let overlay = Overlay {
            pixels: vec![[0.25, 0.125, 0.0, 0.5], [0.0; 4]],
            report: OverlayReport::default(),
        };
        let mut light = [[1.0, 0.5, 0.25]; 2];
        overlay.lay_over(&mut light);
        assert_eq!(light, [[0.75, 0.375, 0.125], [1.0, 0.5, 0.25]]);
        let picture = overlay.add_to(Picture::new(2, 1));
        let alpha = Samples::F16(vec![0.5, 0.0]);
        assert_eq!(picture.channel("overlay.A"), Some(&alpha));
        assert_eq!(picture.channels.len(), 4);
        on_stage(&objects(), |stage| {
            let overlay = Overlay::draw(stage, &views()[0], WHOLE, &BOTH);
            assert!(overlay.pixels.iter().all(|[r, g, b, a]| {
                (0.0..=1.0).contains(a) && [r, g, b].iter().all(|c| (0.0..=*a).contains(*c))
            }));
        });
    }

    /// The eye is where the placed objects are, and sees some of them from within.
    #[test]
    fn objects_around_and_behind_the_eye_are_drawn_without_nonsense() {
        use crate::scene::{Camera, Projection};
        for (position, focal_point) in [
            (Vec3::new(0.0, 1.0, 0.0), Vec3::X),
            (Vec3::new(0.0, 0.0, 0.0), Vec3::new(1.0, 0.0, 0.3)),
            (Vec3::new(0.0, 50.0, 0.0), Vec3::new(0.0, 99.0, 0.1)),
        ] {
            for projection in [Projection::Perspective { view_angle: 120.0 }, PARALLEL] {
                let camera = Camera {
                    name: String::new(),
                    position,
                    focal_point,
                    view_up: Vec3::Y,
                    projection,
                };
                let view = View {
                    camera: camera.frame(SIZE.0, SIZE.1).unwrap(),
                    size: SIZE,
                    filter_radius: 1.5,
                };
                on_stage(&objects(), |stage| {
                    let overlay = Overlay::draw(stage, &view, WHOLE, &BOTH);
                    assert!(
                        overlay
                            .pixels
                            .iter()
                            .flatten()
                            .all(|v| (0.0..=1.0).contains(v))
                    );
                    let is_away = position.y > 10.0;
                    assert_eq!(
                        overlay.report.on_picture == 0,
                        is_away,
                        "{:?}",
                        overlay.report
                    );
                });
            }
        }
    }
}
