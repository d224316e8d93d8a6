//! What it saves that only the vertices of a mesh's hull are transformed for each instance, and what finding them costs.
//!
//! `cargo bench --bench clusters [-- MODEL...]`; without a model, `models/lecture-objects.gltf` serves. World boxes and spheres of all instances are made from all vertices and from the
//! hull's, in turns; the median ratio and its quartiles are printed as a row of a Markdown table. Before anything is timed, both must give the same boxes and radii.

#![allow(clippy::print_stdout, reason = "the table is what it is for")]

use std::hint::black_box;
use std::path::{Path, PathBuf};
use std::time::Instant;

use bspray::accel::extents::PointCluster;
use bspray::geometry::{Aabb, BoundingSphere};
use bspray::scene::{Instance, Scene};
use glam::{DVec3, Vec3};

const ROUNDS: usize = 15;

fn main() {
    // `cargo test --benches` runs this too, without asking for a measurement.
    if !std::env::args().any(|a| a == "--bench") {
        println!("run with `cargo bench --bench clusters`");
        return;
    }
    let named = std::env::args().skip(1).filter(|a| !a.starts_with("--"));
    let mut models: Vec<PathBuf> = named.map(PathBuf::from).collect();
    if models.is_empty() {
        models.push(Path::new(env!("CARGO_MANIFEST_DIR")).join("models/lecture-objects.gltf"));
    }
    println!(
        "| model | instances | points transformed | of them on hulls | all over hull, time | quartiles | hulls, ms | instances a mesh that pay for its hull |\n|---|---:|---:|---:|---:|---:|---:|---:|"
    );
    models.iter().for_each(|model| measure(model));
}

/// Every vertex of a mesh, and their mean.
struct FullList {
    points: Vec<Vec3>,
    centroid: DVec3,
}

impl FullList {
    fn of(points: Vec<Vec3>) -> Self {
        let sum: DVec3 = points.iter().map(|p| p.as_dvec3()).sum();
        Self {
            centroid: sum / points.len().max(1) as f64,
            points,
        }
    }

    /// What [`PointCluster::transformed`] does, with all points.
    fn extents(&self, instance: &Instance) -> (Aabb, Option<BoundingSphere>) {
        let map = &instance.world_from_object;
        let place = |p: &Vec3| map.transform_point3(p.as_dvec3()).as_vec3();
        let placed: Vec<Vec3> = self.points.iter().map(place).collect();
        let center = map.transform_point3(self.centroid).as_vec3();
        (
            placed.iter().copied().collect(),
            BoundingSphere::around(center, &placed),
        )
    }
}

fn extents_of_hull(cluster: &PointCluster, instance: &Instance) -> (Aabb, Option<BoundingSphere>) {
    let placed = cluster.transformed(&instance.world_from_object);
    let placed = placed.expect("in single precision");
    (placed.bounds(), placed.centroid_sphere())
}

fn measure(model: &Path) {
    let scene = bspray::import::load(&[model.to_owned()]).expect("the model loads");
    let lists: Vec<FullList> = scene
        .meshes
        .iter()
        .map(|mesh| FullList::of(mesh.cluster(usize::MAX)))
        .collect();
    let hulls = || -> Vec<PointCluster> {
        let hull = |l: &FullList| PointCluster::new(&l.points).expect("finite points");
        lists.iter().map(hull).collect()
    };
    let clusters = hulls();
    for i in &scene.instances {
        let (all, hull) = (&lists[i.mesh as usize], &clusters[i.mesh as usize]);
        assert_eq!(all.extents(i), extents_of_hull(hull, i), "{:?}", i.name);
    }
    let from_all = || {
        for i in &scene.instances {
            black_box(lists[i.mesh as usize].extents(i));
        }
    };
    let from_hulls = || {
        for i in &scene.instances {
            black_box(extents_of_hull(&clusters[i.mesh as usize], i));
        }
    };
    let mut rounds: Vec<[f64; 3]> = (0..ROUNDS)
        .map(|_| {
            let hulls = seconds(1, || {
                black_box(hulls());
            });
            let calls = repeats(&scene);
            [seconds(calls, from_all), seconds(calls, from_hulls), hulls]
        })
        .collect();
    rounds.sort_by(|a, b| (a[0] / a[1]).total_cmp(&(b[0] / b[1])));
    let ratio = |quarter: usize| {
        let [all, hull, _] = rounds[quarter * (ROUNDS - 1) / 4];
        all / hull
    };
    let [all, hull, found] = rounds[ROUNDS / 2];
    let count = |of: &dyn Fn(usize) -> usize| -> usize {
        scene.instances.iter().map(|i| of(i.mesh as usize)).sum()
    };
    // A hull is found once a mesh; each instance saves the difference.
    let saved = (all - hull) / scene.instances.len() as f64;
    let pays = found / scene.meshes.len() as f64 / saved;
    println!(
        "| {} | {} | {} | {} | {:.1} | {:.1} to {:.1} | {:.1} | {} |",
        model.file_stem().unwrap_or_default().to_string_lossy(),
        scene.instances.len(),
        count(&|mesh| lists[mesh].points.len()),
        count(&|mesh| clusters[mesh].hull().len()),
        ratio(2),
        ratio(1),
        ratio(3),
        found * 1e3,
        if pays > 0.0 {
            format!("{pays:.0}")
        } else {
            "never".to_owned()
        }
    );
}

/// So many times that a measurement takes some milliseconds.
fn repeats(scene: &Scene) -> usize {
    let points = |i: &Instance| scene.meshes[i.mesh as usize].positions.len();
    (1_000_000 / scene.instances.iter().map(points).sum::<usize>().max(1)).max(1)
}

/// Seconds of one call.
fn seconds(calls: usize, mut work: impl FnMut()) -> f64 {
    let start = Instant::now();
    (0..calls).for_each(|_| work());
    start.elapsed().as_secs_f64() / calls as f64
}
