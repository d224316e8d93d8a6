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

/// Of screen extents and names: orange (230, 159, 0). All four are colours of Okabe and Ito, which differ for all colour-blind eyes, here as linear values.
const SCREEN_COLOR: Color = [0.791, 0.347, 0.0];
/// Of boxes: sky blue (86, 180, 233).
const BOX_COLOR: Color = [0.093, 0.456, 0.815];
/// Of spheres: reddish purple (204, 121, 167).
const SPHERE_COLOR: Color = [0.604, 0.191, 0.386];
/// Of edges: vermilion (213, 94, 0), neither lost on white nor on black.
const EDGE_COLOR: Color = [0.665, 0.112, 0.0];

/// Opacity of the dark plates behind text.
const PLATE_OPACITY: f32 = 0.75;

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
