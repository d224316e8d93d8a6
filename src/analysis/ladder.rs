//! The ladder: what each step from the lecture's plain loop to trees gives, for eye, shadow and mirror rays, counted and timed.
//!
//! The lecture says that projection extents give eye rays "a dramatic gain", and that extents are "of little service for secondary rays": this puts numbers to it.

use super::measure::{self, Speed};
use super::view_rays::{Query, RaySet, ViewOptions, view_rays};
use crate::accel::extents::{
    CostTable, ExtentChoice, ExtentSet, ExtentTally, ExtentTest, ExtentsLoop, MeshAccelerator,
    ObjectTally, View,
};
use crate::accel::{Accelerator, AcceleratorKind, BuildOptions};
use crate::render::{SkyMode, Stage};
use crate::scene::Scene;
use glam::Vec3;

/// What is measured, and how.
#[derive(Clone, Copy, Debug)]
pub struct LadderOptions {
    /// How structures are built. The mesh's structure is that of the lower steps.
    pub build: BuildOptions,
    /// The camera of the eye rays.
    pub view: View,
    /// Most rays of each kind.
    pub most_rays: usize,
    /// How often each step is timed.
    pub repetitions: usize,
    /// Changes every random number.
    pub seed: u32,
    /// The scene's upward axis.
    pub up: Vec3,
}

/// One step on the rays of one kind.
#[derive(Clone, Debug)]
pub struct StepOnRays {
    /// How fast; ratios are to the first step. `None` without rays.
    pub speed: Option<Speed>,
    /// Counted cost of a ray, in the unit of [`CostTable`]. A structure of the whole scene costs what a full test of an object with its steps would.
    pub cost: f64,
    /// The outcomes at all objects together; `None` for structures without objects.
    pub tally: Option<ObjectTally>,
}

/// A step of the ladder.
#[derive(Clone, Debug)]
pub struct LadderStep {
    /// What it is.
    pub name: String,
    /// For each kind of rays, in the order of [`Ladder::kinds`].
    pub rays: Vec<StepOnRays>,
}

/// The ladder of a scene.
#[derive(Clone, Debug)]
pub struct Ladder {
    /// Kinds of rays, and how many there are of each.
    pub kinds: Vec<(&'static str, usize)>,
    /// From no extents at all to a tree alone.
    pub steps: Vec<LadderStep>,
}

/// A structure of a step, which may be a loop over objects.
enum Built {
    Loop(ExtentsLoop),
    /// With what its steps cost.
    Whole(Box<dyn Accelerator>, CostTable),
}

impl Built {
    fn accelerator(&self) -> &dyn Accelerator {
        match self {
            Self::Loop(objects) => objects,
            Self::Whole(accelerator, _) => &**accelerator,
        }
    }
}

impl Ladder {
    /// Climbs the ladder. Builds with the threads of the rayon pool in which it is called; rays are timed on one thread.
    pub fn of(scene: &Scene, options: &LadderOptions) -> Self {
        let lookup = AcceleratorKind::Bsp.build_with(scene, &options.build);
        let sets = ray_sets(scene, &*lookup, options);
        let steps = steps(options.build.mesh);
        let build = |(_, plan): &(String, Plan)| match plan {
            Plan::Objects(extents, mesh) => {
                let build = BuildOptions {
                    mesh: *mesh,
                    extents: *extents,
                    view: Some(options.view),
                    ..options.build
                };
                Built::Loop(ExtentsLoop::build(scene, &build))
            }
            Plan::Alone(kind, costs) => Built::Whole(
                kind.build_with(scene, &options.build),
                CostTable::of(*costs),
            ),
        };
        let built: Vec<Built> = steps.iter().map(build).collect();
        let accelerators: Vec<&dyn Accelerator> = built.iter().map(Built::accelerator).collect();
        let mut found: Vec<LadderStep> = steps
            .iter()
            .map(|(name, _)| LadderStep {
                name: name.clone(),
                rays: Vec::new(),
            })
            .collect();
        for (_, set) in &sets {
            let speeds = measure::speeds_in_turns(
                &accelerators,
                set,
                options.repetitions,
                options.seed,
                &|| (),
            );
            for (number, step) in found.iter_mut().enumerate() {
                let (cost, tally) = match &built[number] {
                    Built::Loop(objects) => {
                        let (cost, tally) = count(objects, set);
                        (cost, Some(tally))
                    }
                    Built::Whole(whole, costs) => (count_whole(&**whole, costs, set), None),
                };
                step.rays.push(StepOnRays {
                    speed: speeds.as_ref().map(|s| s[number]),
                    cost: cost / set.rays.len().max(1) as f64,
                    tally,
                });
            }
        }
        Self {
            kinds: sets.iter().map(|(n, s)| (*n, s.rays.len())).collect(),
            steps: found,
        }
    }
}

/// How a step's structure is built.
enum Plan {
    /// A loop over objects with these extents, and such a structure within each.
    Objects(ExtentChoice, MeshAccelerator),
    /// One structure for the whole scene, whose steps cost what those of such a structure within an object do.
    Alone(AcceleratorKind, MeshAccelerator),
}

/// The steps, with their names.
fn steps(mesh: MeshAccelerator) -> Vec<(String, Plan)> {
    use ExtentTest::{BoxWorld, Screen, SphereWorld};
    let (sphere, both) = (
        ExtentSet::NONE.with(SphereWorld),
        ExtentSet::NONE.with(SphereWorld).with(BoxWorld),
    );
    let sets = [
        ("no extents", ExtentSet::NONE),
        ("sphere", sphere),
        ("box", ExtentSet::NONE.with(BoxWorld)),
        ("sphere and box", both),
        ("screen, sphere and box", both.with(Screen)),
        (
            "screen and box",
            ExtentSet::NONE.with(BoxWorld).with(Screen),
        ),
    ];
    let mut steps: Vec<_> = sets
        .into_iter()
        .map(|(name, set)| {
            let plan = Plan::Objects(ExtentChoice::Fixed(set), mesh);
            (format!("{name}, {mesh} in objects"), plan)
        })
        .collect();
    for within in [mesh, MeshAccelerator::Bvh2, MeshAccelerator::Bsp] {
        let name = format!("auto, {within} in objects");
        if steps.iter().all(|(other, _)| *other != name) {
            steps.push((name, Plan::Objects(ExtentChoice::Auto, within)));
        }
    }
    for (kind, costs) in [
        (AcceleratorKind::Bvh2, MeshAccelerator::Bvh2),
        (AcceleratorKind::Bsp, MeshAccelerator::Bsp),
    ] {
        steps.push((format!("{kind} alone"), Plan::Alone(kind, costs)));
    }
    steps
}

/// Counted cost of the rays, and the outcomes.
fn count(objects: &ExtentsLoop, set: &RaySet) -> (f64, ObjectTally) {
    let mut tally = ExtentTally::new(objects.objects().len());
    for ray in &set.rays {
        match set.purpose.query() {
            Query::Closest => {
                objects.closest_tallied(ray, &mut tally);
            }
            Query::Any => {
                objects.any_tallied(ray, &mut tally);
            }
        }
    }
    (objects.tallied_cost(&tally), tally.total())
}

/// Counted cost of the rays in a structure of the whole scene: it is entered once by each, and then takes its steps.
fn count_whole(accelerator: &dyn Accelerator, costs: &CostTable, set: &RaySet) -> f64 {
    costs.enter * set.rays.len() as f64 + costs.steps(&measure::steps(accelerator, set))
}

/// Eye, shadow and mirror rays of the view.
pub fn ray_sets(
    scene: &Scene,
    accelerator: &dyn Accelerator,
    options: &LadderOptions,
) -> [(&'static str, RaySet); 3] {
    let stage = Stage::new(scene, accelerator, options.up, SkyMode::Auto);
    let view = ViewOptions {
        size: options.view.size,
        most_rays: options.most_rays,
        seed: options.seed,
    };
    let [eye, shadow, mirror, ..] = view_rays(&stage, &options.view.camera, &view);
    [eye, shadow, mirror].map(|set| (set.purpose.name(), set))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn extents_reject_most_rays_and_screens_only_eye_rays() {
        let scene = crate::import::load(&["models/lecture-objects.gltf".into()]).unwrap();
        let size = (64, 36);
        let options = LadderOptions {
            build: BuildOptions {
                mesh: MeshAccelerator::Bsp,
                ..BuildOptions::default()
            },
            view: View {
                camera: scene.cameras[0].frame(size.0, size.1).unwrap(),
                size,
                filter_radius: 0.0,
            },
            most_rays: 600,
            repetitions: 1,
            seed: 0,
            up: Vec3::Y,
        };
        let ladder = Ladder::of(&scene, &options);
        let names: Vec<_> = ladder.kinds.iter().map(|(name, _)| *name).collect();
        assert_eq!(names, ["eye", "shadow", "mirror"]);
        let tally = |step: usize, kind: usize| ladder.steps[step].rays[kind].tally.unwrap();
        let cost = |step: usize, kind: usize| ladder.steps[step].rays[kind].cost;
        // With a sphere and a box, fewer than a third of the full tests are left.
        assert!(3 * tally(3, 0).full_tests < tally(0, 0).full_tests);
        assert_eq!(tally(3, 0).hits, tally(0, 0).hits);
        let screen = |kind| tally(4, kind).tests[ExtentTest::Screen.index()];
        assert!(screen(0).rejected > 0);
        assert!(cost(4, 0) < cost(3, 0));
        // Of little service for secondary rays, but at no cost to them.
        assert_eq!((screen(1).tested, screen(2).tested), (0, 0));
        assert_eq!((cost(4, 1), cost(4, 2)), (cost(3, 1), cost(3, 2)));
    }
}
