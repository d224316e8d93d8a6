//! The rays of one view, sorted by purpose: what a renderer would send, without the rendering.
//!
//! They depend on the scene, the camera, the options and the seed only: every accelerator gives the same first hits.

use super::specular_rays::{mirror_ray, refraction_ray};
use crate::geometry::{Ray, RayOrigin};
use crate::render::{Sampler, Stage, Surface, hemisphere_ray, shadow_ray};
use crate::scene::CameraFrame;
use glam::Vec3;

/// Side of the square tiles in which eye rays come, in pixels: neighbours in the list are neighbours in the picture.
const TILE: u32 = 8;

/// Length of ambient rays as a share of the scene's diagonal, as the ambient-occlusion integrator has it by default.
const AMBIENT_SHARE: f32 = 0.1;

/// What a ray of a view is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum RayPurpose {
    /// Through the centre of a pixel.
    Eye,
    /// From what an eye ray met to a light.
    Shadow,
    /// From there on as a mirror would send it, whatever is there.
    Mirror,
    /// From there on as clear glass would send it, whatever is there.
    Refraction,
    /// From there into the hemisphere, as far as a tenth of the scene's diagonal.
    Ambient,
    /// From there into the hemisphere, without an end.
    Bounce,
}

/// What is asked of an accelerator.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Query {
    /// The nearest hit.
    Closest,
    /// Whether anything is hit.
    Any,
}

impl RayPurpose {
    /// All of them.
    pub const ALL: [Self; 6] = [
        Self::Eye,
        Self::Shadow,
        Self::Mirror,
        Self::Refraction,
        Self::Ambient,
        Self::Bounce,
    ];

    /// The name in reports.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Eye => "eye",
            Self::Shadow => "shadow",
            Self::Mirror => "mirror",
            Self::Refraction => "refraction",
            Self::Ambient => "ambient",
            Self::Bounce => "bounce",
        }
    }

    /// What a renderer asks with such a ray.
    pub const fn query(self) -> Query {
        match self {
            Self::Eye | Self::Mirror | Self::Refraction | Self::Bounce => Query::Closest,
            Self::Shadow | Self::Ambient => Query::Any,
        }
    }
}

impl Query {
    /// The name in reports.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Closest => "closest hit",
            Self::Any => "any hit",
        }
    }
}

/// Rays of one purpose, in world space.
#[derive(Clone, Debug)]
pub struct RaySet {
    /// What they are for.
    pub purpose: RayPurpose,
    /// The rays, by tiles of the picture.
    pub rays: Vec<Ray>,
}

/// Which rays of a view.
#[derive(Clone, Copy, Debug)]
pub struct ViewOptions {
    /// Width and height of the picture, in pixels.
    pub size: (u32, u32),
    /// Most rays of each purpose. If the picture has more pixels, tiles of it are chosen by chance.
    pub most_rays: usize,
    /// Changes every random number.
    pub seed: u32,
}

/// The rays of a view: a set for each purpose, in the order of [`RayPurpose::ALL`]. Each eye ray that meets something gives at most one ray of
/// every other purpose.
pub fn view_rays(stage: &Stage, camera: &CameraFrame, options: &ViewOptions) -> [RaySet; 6] {
    let mut sets = RayPurpose::ALL.map(|purpose| RaySet {
        purpose,
        rays: Vec::new(),
    });
    let [eye, shadow, mirror, refraction, ambient, bounce] = &mut sets;
    for (x, y) in pixels(options) {
        let ray = camera.ray(f64::from(x) + 0.5, f64::from(y) + 0.5, Some((x, y)));
        eye.rays.push(ray);
        let Some(hit) = stage.accelerator.closest_hit(&ray) else {
            continue;
        };
        let surface = Surface::at(stage, &ray, hit);
        let mut sampler = Sampler::new(x, y, 0, options.seed);
        let reach = stage.diagonal * AMBIENT_SHARE;
        ambient
            .rays
            .push(hemisphere_ray(&surface, sampler.next_2d(), reach));
        let endless = hemisphere_ray(&surface, sampler.next_2d(), f32::INFINITY);
        bounce.rays.push(endless);
        shadow
            .rays
            .extend(shadow_ray(stage, &surface, &mut sampler));
        mirror.rays.extend(mirror_ray(&ray, &surface));
        let through = refraction_ray(stage, &ray, &surface);
        refraction.rays.extend(through);
    }
    sets
}

/// A ray without an end that leaves a surface which an eye ray met.
pub(super) fn secondary(origin: Vec3, direction: Vec3) -> Ray {
    let source = RayOrigin {
        depth: 1,
        pixel: None,
    };
    Ray {
        source,
        ..Ray::new(origin, direction)
    }
}

/// The pixels whose eye rays are sent, tile by tile.
fn pixels(options: &ViewOptions) -> Vec<(u32, u32)> {
    let (width, height) = options.size;
    let across = width.div_ceil(TILE);
    let mut tiles: Vec<u32> = (0..across * height.div_ceil(TILE)).collect();
    let wanted = options.most_rays.div_ceil((TILE * TILE) as usize);
    if u64::from(width) * u64::from(height) > options.most_rays as u64 && wanted < tiles.len() {
        // A number of its own for each tile; those with the least are taken.
        let key = |t: &u32| Sampler::new(t % across, t / across, 1, options.seed).next_1d();
        tiles.sort_by(|a, b| key(a).total_cmp(&key(b)));
        tiles.truncate(wanted);
        tiles.sort_unstable();
    }
    let of_tile = |tile: u32| {
        let (x, y) = (tile % across * TILE, tile / across * TILE);
        (y..(y + TILE).min(height))
            .flat_map(move |y| (x..(x + TILE).min(width)).map(move |x| (x, y)))
    };
    let mut pixels: Vec<_> = tiles.into_iter().flat_map(of_tile).collect();
    pixels.truncate(options.most_rays);
    pixels
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accel::AcceleratorKind;
    use crate::render::{CameraWishes, SkyMode, frame_scene};

    fn options(size: (u32, u32), most_rays: usize, seed: u32) -> ViewOptions {
        ViewOptions {
            size,
            most_rays,
            seed,
        }
    }

    #[test]
    fn all_pixels_come_once_and_fewer_when_asked_for() {
        let mut all = pixels(&options((21, 10), 1000, 3));
        assert_eq!(&all[..3], [(0, 0), (1, 0), (2, 0)]);
        assert_eq!(all[8], (0, 1));
        all.sort_unstable();
        all.dedup();
        assert_eq!(all.len(), 210);
        let few = pixels(&options((640, 480), 1000, 3));
        assert_eq!(few.len(), 1000);
        assert_ne!(few, pixels(&options((640, 480), 1000, 4)));
        assert_eq!(few, pixels(&options((640, 480), 1000, 3)));
        assert_eq!(pixels(&options((640, 480), 5, 3)).len(), 5);
    }

    #[test]
    fn every_hit_sends_its_rays_and_no_two_accelerators_send_others() {
        let scene = crate::import::load(&["models/lecture-block.obj".into()]).unwrap();
        let camera = frame_scene(&scene, &CameraWishes::default(), Vec3::Y, 1.5);
        let frame = camera.frame(48, 32).unwrap();
        let sets = |kind: AcceleratorKind, seed| {
            let accelerator = kind.build(&scene);
            let stage = Stage::new(&scene, &*accelerator, Vec3::Y, SkyMode::Auto);
            view_rays(&stage, &frame, &options((48, 32), 9999, seed)).map(|s| s.rays)
        };
        let [eye, shadow, mirror, refraction, ambient, bounce] = sets(AcceleratorKind::Linear, 1);
        assert_eq!(eye.len(), 48 * 32);
        assert!(ambient.len() > 200 && ambient.len() < eye.len());
        assert_eq!(ambient.len(), bounce.len());
        assert!(!shadow.is_empty() && shadow.len() <= ambient.len());
        assert!(bounce.iter().all(|r| r.interval.max == f32::INFINITY));
        assert!(ambient.iter().all(|r| r.interval.max.is_finite()));
        let other = sets(AcceleratorKind::Cwbvh, 1);
        assert_eq!(
            (mirror.len(), refraction.len()),
            (bounce.len(), bounce.len())
        );
        let all = [eye, shadow, mirror, refraction, ambient, bounce];
        assert_eq!(all, other);
        assert_ne!(all[5], sets(AcceleratorKind::Linear, 2)[5]);
    }
}
