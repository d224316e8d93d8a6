//! The frames before and after a picture of an animation, for its motion vectors: what the same arguments would show then.

use bspray::picture::Picture;
use bspray::render::{Film, MotionFrame, add_motion};
use bspray::scene::{Camera, CameraFrame, Scene};

use super::camera_args;
use super::frames::FrameArgs;
use super::model_args::{ModelArgs, Wants};
use super::render::RenderArgs;

/// Loads the models, and where everything is in the frames before and after, if pictures have layers and one moment of an animation is shown by one
/// picture. All pictures of a turntable show the same moment.
///
/// # Errors
/// The models cannot be read, or a frame rate is given that no picture needs.
pub(super) fn load(
    input: &ModelArgs,
    frames: &FrameArgs,
    has_layers: bool,
    wants: Wants,
) -> anyhow::Result<(Scene, Option<[Scene; 2]>)> {
    let step = frames.step(has_layers)?;
    if has_layers && !frames.is_turntable() {
        input.load_with_neighbors(step, wants)
    } else {
        Ok((input.load_wanted(wants)?, None))
    }
}

/// The frame before and the frame after.
pub(super) struct Neighbors {
    /// Where everything is.
    pub(super) scenes: [Scene; 2],
    /// Chosen as the picture's own: those of the file move with their nodes, and automatic ones with what they frame.
    pub(super) cameras: [Camera; 2],
}

impl Neighbors {
    /// With the cameras that the arguments choose then.
    ///
    /// # Errors
    /// There is no such camera.
    pub(super) fn new(args: &RenderArgs, scenes: [Scene; 2]) -> anyhow::Result<Self> {
        let camera = |scene| {
            let camera = args.camera.choose(scene, args.resolution)?;
            anyhow::Ok(args.lens.project(camera))
        };
        let cameras = [camera(&scenes[0])?, camera(&scenes[1])?];
        Ok(Self { scenes, cameras })
    }
}

/// The frames beside a picture.
pub(super) struct Around<'a>([(&'a Scene, CameraFrame); 2]);

impl<'a> Around<'a> {
    /// The frame before and the one after, for pictures of `size`.
    ///
    /// # Errors
    /// A camera is impossible.
    pub(super) fn new(
        scenes: [&'a Scene; 2],
        cameras: &[Camera; 2],
        size: (u32, u32),
    ) -> anyhow::Result<Self> {
        // The filter has no part in where things are.
        let view = |camera| camera_args::view(camera, size, 0.0);
        let [before, after] = cameras.each_ref().map(view);
        Ok(Self([
            (scenes[0], before?.camera),
            (scenes[1], after?.camera),
        ]))
    }

    /// Adds the motion vectors of a film, which shows `scene` through `camera`, to its layers.
    pub(super) fn add_to(
        &self,
        layers: Picture,
        film: &Film,
        scene: &Scene,
        camera: &CameraFrame,
    ) -> Picture {
        let now = MotionFrame { scene, camera };
        let [before, after] = self
            .0
            .each_ref()
            .map(|(scene, camera)| MotionFrame { scene, camera });
        add_motion(layers, film, now, before, after)
    }
}
