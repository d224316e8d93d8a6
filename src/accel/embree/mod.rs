//! Intel's Embree 4, where a user has it: another structure that nobody here wrote, to compare with. It is loaded at run time from the file that the user names
//! and never needed. World space, model units.
//!
//! It does not keep the contract of [`Accelerator`](super::Accelerator), since it makes other promises. Both of its triangle tests are single precision: `t` is
//! what they say, and which of several triangles at an edge or at one depth is hit is theirs to choose. Of hits at just an end of the interval Embree promises
//! nothing. What lies before a ray's origin (`t < 0`) it never finds. Steps are not counted.
//!
//! The library is behind one file, `library`; `layout` has its numbers and structures. Wald, Woop, Benthin, Johnson, Ernst, "Embree: A Kernel Framework for
//! Efficient CPU Ray Tracing", SIGGRAPH 2014; the test of robust scenes is Pluecker's, that of others Moller and Trumbore's.

mod error;
mod layout;
mod library;
mod scene;

use std::path::Path;
use std::sync::Arc;

pub use error::EmbreeError;
pub use scene::EmbreeScene;

use crate::scene::Scene;
use library::{Committed, Device, Geometry};

/// How Embree's scenes are made.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum EmbreeMode {
    /// As it comes.
    Default,
    /// With the flag `RTC_SCENE_FLAG_ROBUST`: no ray is lost at the edges of triangles and boxes.
    Robust,
}

impl EmbreeMode {
    /// Both.
    pub const ALL: [Self; 2] = [Self::Default, Self::Robust];

    /// The name on the command line and in reports.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Default => "embree",
            Self::Robust => "embree-robust",
        }
    }

    /// One line about it.
    pub const fn description(self) -> &'static str {
        match self {
            Self::Default => "Intel's Embree 4 as it comes (--embree)",
            Self::Robust => "Intel's Embree 4 with its flag ROBUST (--embree)",
        }
    }
}

/// The library, loaded, ready to build scenes. Copies share it.
///
/// ```no_run
/// use bspray::accel::{Accelerator, Embree, EmbreeMode};
/// use bspray::geometry::Ray;
/// use glam::Vec3;
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let embree = Embree::load("/usr/lib/libembree4.so.4".as_ref(), 0)?;
/// let scene = bspray::import::load(&["models/lecture-block.obj".into()])?;
/// let tree = embree.build(&scene, EmbreeMode::Robust)?;
/// println!("Embree {}", embree.version());
/// println!("{:?}", tree.closest_hit(&Ray::new(Vec3::splat(9.0), Vec3::NEG_ONE)));
/// # Ok(())
/// # }
/// ```
#[derive(Clone)]
pub struct Embree {
    device: Arc<Device>,
}

impl std::fmt::Debug for Embree {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "Embree {}", self.version())
    }
}

impl PartialEq for Embree {
    /// Whether they share a library.
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.device, &other.device)
    }
}

impl Eq for Embree {}

impl Embree {
    /// Loads the library in the file, with so many threads for building; 0 for one a core. It stays loaded until the program ends.
    ///
    /// # Errors
    /// No such file; no library; another one; a version other than 4; one that does not see back faces; one that cannot run here.
    pub fn load(path: &Path, threads: usize) -> Result<Self, EmbreeError> {
        Device::load(path, threads).map(|device| Self {
            device: Arc::new(device),
        })
    }

    /// Major, minor and patch, as "4.4.0".
    pub fn version(&self) -> &str {
        self.device.version()
    }

    /// Builds over all instances of the scene, every triangle in world space, each corner rounded once, as
    /// [`world_triangles`](super::world_triangles) has them.
    ///
    /// # Errors
    /// What the library reports, such as that it has not enough memory.
    ///
    /// # Panics
    /// If triangles name corners that their mesh has not.
    pub fn build(&self, scene: &Scene, mode: EmbreeMode) -> Result<EmbreeScene, EmbreeError> {
        let geometries: Vec<Geometry> = scene
            .instances
            .iter()
            .map(|placed| {
                let mesh = &scene.meshes[placed.mesh as usize];
                let place = |point: &glam::Vec3| placed.world_point(*point).to_array();
                Geometry {
                    positions: mesh.positions.iter().map(place).collect(),
                    triangles: &mesh.triangles,
                }
            })
            .collect();
        let committed = Committed::build(&self.device, mode == EmbreeMode::Robust, &geometries)?;
        Ok(EmbreeScene::new(committed, scene.placed_triangles()))
    }
}
