//! Arguments for the loop over objects and their extents.

use anyhow::bail;
use bspray::accel::extents::{ExtentChoice, ExtentSphere, MeshAccelerator, View};
use bspray::accel::{AcceleratorKind, BuildOptions};
use clap::Args;

use super::UsageError;
use super::bsp_args::one_of;

/// How the loop over objects works.
#[derive(Args, Clone, Copy, Debug)]
pub(super) struct ExtentArgs {
    /// Which extents `extents` tests: none, auto, or some of screen, sphere-world, box-world, sphere-object, box-object with commas between [default: auto]
    #[arg(
        long,
        value_name = "LIST",
        help_heading = "Extents",
        long_help = "Which extents `extents` tests before an object's triangles: `none`, `auto` (for each object what costs least, by counted probe rays), or some of \
        screen, sphere-world, box-world, sphere-object and box-object, with commas between; they are applied in this order [default: auto]"
    )]
    extents: Option<ExtentChoice>,
    /// Which sphere an object of `extents` gets: smallest, or centroid as in the lecture [default: smallest]
    #[arg(long, value_name = "KIND", value_parser = sphere, help_heading = "Extents")]
    extent_sphere: Option<ExtentSphere>,
    /// What finds the hits within an object of `extents`: bsp, bvh2, cwbvh or linear [default: bsp]
    #[arg(long, value_name = "KIND", value_parser = mesh, help_heading = "Extents")]
    mesh_accel: Option<MeshAccelerator>,
}

impl ExtentArgs {
    /// Adds what was chosen to the options of a build for a view. A lens or a panorama has no screen extents.
    pub(super) fn add_to(&self, options: BuildOptions, view: View) -> BuildOptions {
        let has_extents = view.camera.has_screen() && view.camera.lens().is_none();
        BuildOptions {
            extents: self.extents.unwrap_or_default(),
            sphere: self.extent_sphere.unwrap_or_default(),
            mesh: self.mesh_accel.unwrap_or_default(),
            view: has_extents.then_some(view),
            ..options
        }
    }

    /// Refuses options that no structure would look at, nor a drawing of extents.
    pub(super) fn check(&self, kinds: &[AcceleratorKind], are_drawn: bool) -> anyhow::Result<()> {
        let given = [
            ("--extents", self.extents.is_some()),
            (
                "--extent-sphere",
                self.extent_sphere.is_some() && !are_drawn,
            ),
            ("--mesh-accel", self.mesh_accel.is_some()),
        ];
        let unused = given.iter().find(|(_, is_given)| *is_given);
        if let Some((option, _)) = unused.filter(|_| !kinds.contains(&AcceleratorKind::Extents)) {
            let words = format!("{option}: only --accel extents has objects with extents: add it");
            bail!(UsageError(words));
        }
        Ok(())
    }
}

fn sphere(text: &str) -> Result<ExtentSphere, String> {
    one_of(ExtentSphere::ALL, ExtentSphere::name, text)
}

pub(super) fn mesh(text: &str) -> Result<MeshAccelerator, String> {
    one_of(MeshAccelerator::ALL, MeshAccelerator::name, text)
}
