//! `bspray inspect --extent-table`: what each object's extents are, and what they are worth on the rays of one view.

use std::fmt::Write;

use bspray::accel::extents::{
    ExtentChoice, ExtentObject, ExtentSet, ExtentShapes, ExtentTest, ExtentsLoop, MeshAccelerator,
    ObjectStudy,
};
use bspray::accel::{AcceleratorKind, BuildOptions};
use bspray::analysis::{LadderOptions, Query, ray_sets};
use bspray::render::{CameraWishes, frame_scene};
use bspray::scene::Scene;
use clap::Args;
use glam::Vec3;
use serde_json::{Value, json};

use super::{Done, camera_args, extent_args, output, values};

/// Arguments for the table of extents.
#[derive(Args, Debug)]
pub(super) struct InspectExtentArgs {
    /// Tell of the objects' extents instead: their sizes, and what they are worth for eye, shadow and mirror rays of the file's first camera
    #[arg(long, conflicts_with = "bsp")]
    pub(super) extent_table: bool,
    /// With --extent-table: what finds the hits within an object: linear (the lecture's), bsp, bvh2 or cwbvh
    #[arg(long, value_name = "KIND", default_value_t = MeshAccelerator::Linear, value_parser = extent_args::mesh, requires = "extent_table")]
    mesh_accel: MeshAccelerator,
    /// With --extent-table: width and height of the view, in pixels
    #[arg(long, value_name = "WxH", value_parser = values::resolution, default_value = "1280x720", requires = "extent_table")]
    resolution: (u32, u32),
    /// With --extent-table: most rays of each kind
    #[arg(long, value_name = "N", default_value_t = 2000, value_parser = clap::value_parser!(u32).range(1..=values::MOST_RAYS), requires = "extent_table")]
    rays: u32,
}

/// Tells of the extents.
pub(super) fn run(scene: &Scene, args: &InspectExtentArgs, as_json: bool) -> anyhow::Result<Done> {
    let (width, height) = args.resolution;
    let aspect = f64::from(width) / f64::from(height);
    let framed = || frame_scene(scene, &CameraWishes::default(), Vec3::Y, aspect);
    let camera = scene.cameras.first().cloned().unwrap_or_else(framed);
    let view = camera_args::view(&camera, args.resolution, 0.0)?;
    let build = BuildOptions {
        extents: ExtentChoice::Auto,
        mesh: args.mesh_accel,
        view: Some(view),
        ..BuildOptions::default()
    };
    let objects = ExtentsLoop::build(scene, &build);
    let lookup = AcceleratorKind::Bsp.build(scene);
    let options = LadderOptions {
        build,
        view,
        most_rays: args.rays as usize,
        repetitions: 0,
        seed: 0,
        up: Vec3::Y,
    };
    let mut studies = objects.study(&[], true);
    for (_, set) in ray_sets(scene, &*lookup, &options) {
        let more = objects.study(&set.rays, set.purpose.query() == Query::Closest);
        studies.iter_mut().zip(&more).for_each(|(s, m)| s.add(m));
    }
    let rows: Vec<Value> = objects
        .objects()
        .iter()
        .zip(&studies)
        .map(|(object, study)| row(scene, object, study))
        .collect();
    let sum = |cost: &dyn Fn(usize) -> f64| (0..studies.len()).map(cost).sum::<f64>();
    let usable = |object: usize, set: ExtentSet| -> ExtentSet {
        set.tests().filter(|&t| studies[object].has(t)).collect()
    };
    let same = |set: ExtentSet| sum(&|o| studies[o].cost(usable(o, set)));
    let best = ExtentSet::all().min_by(|a, b| same(*a).total_cmp(&same(*b)));
    let best = best.unwrap_or_default();
    let report = json!({
        "mesh_accel": args.mesh_accel.name(),
        "rays": studies.first().map_or(0, ObjectStudy::rays),
        "objects": rows,
        "cost": {
            "none": same(ExtentSet::NONE),
            "auto": sum(&|o| studies[o].cost(objects.objects()[o].tests)),
            "best_of_all_rays": sum(&|o| studies[o].cost(studies[o].best())),
            "best_same_for_all": { "extents": best.to_string(), "cost": same(best) },
        },
    });
    output::result(&if as_json {
        format!("{report:#}")
    } else {
        text(&report)
    })?;
    Ok(Done::Completely)
}

/// Box and sphere: volumes and surfaces, which rays meet in proportion to.
fn shapes(shapes: &ExtentShapes) -> Value {
    let [x, y, z] = shapes.bounds.extent().to_array().map(f64::from);
    let surface = 2.0 * (x * y + y * z + z * x);
    let sphere = shapes.sphere.map(|s| {
        json!({ "radius": s.radius, "volume": s.volume(), "surface": s.surface_area(),
            "surface_over_box": if surface > 0.0 { json!(s.surface_area() / surface) } else { Value::Null } })
    });
    json!({ "box": { "size": [x, y, z], "volume": x * y * z, "surface": surface }, "sphere": sphere })
}

fn row(scene: &Scene, object: &ExtentObject, study: &ObjectStudy) -> Value {
    let tests = ExtentTest::ALL.into_iter().filter(|&t| study.has(t));
    let tests = tests.map(|test| {
        json!({
            "test": test.name(),
            "T": study.test_cost(test),
            "m": study.full_cost(test),
            "f": study.share(test),
            "rejected": study.rays() - study.admitted(test),
            "false_alarms": study.admitted(test).saturating_sub(study.hits),
            "hits": study.hits,
            "predicted": study.predicted(test),
            "counted": study.gain(ExtentSet::NONE.with(test)),
        })
    });
    json!({
        "name": scene.instances[object.instance as usize].name,
        "instance": object.instance,
        "triangles": scene.mesh_of(object.instance).triangles.len(),
        "cluster": object.points.0,
        "hull": object.points.1,
        "object_space": shapes(&object.extents.object),
        "world_space": object.extents.world.as_ref().map(shapes),
        "screen": object.extents.screen.map(|s| json!({ "left": s.left, "right": s.right, "top": s.top, "bottom": s.bottom, "pixels": s.area() })),
        "tests": tests.collect::<Vec<_>>(),
        "choice": object.tests.to_string(),
        "gain": study.gain(object.tests),
        "reason": reason(object.tests, study),
    })
}

/// Why these tests were chosen, in a few words.
fn reason(tests: ExtentSet, study: &ObjectStudy) -> String {
    let full = study.cost(ExtentSet::NONE);
    let cost = |set| study.cost(set);
    if tests.is_empty() {
        let singles = ExtentTest::ALL.into_iter().filter(|&t| study.has(t));
        let least = singles
            .map(|t| cost(ExtentSet::NONE.with(t)))
            .fold(f64::INFINITY, f64::min);
        return format!("the full test costs {full:.1} a ray, with the cheapest extent {least:.1}");
    }
    format!(
        "{:.1} a ray instead of {full:.1} without extents",
        cost(tests)
    )
}

/// The report as a table.
fn text(report: &Value) -> String {
    let real = |v: &Value| v.as_f64().unwrap_or_default();
    let mut out = format!(
        "{} rays; {} in objects; m: cost of the full test in tests of the extent; f: share of rays that reach it\n",
        report["rays"],
        report["mesh_accel"].as_str().unwrap_or_default()
    );
    for object in report["objects"].as_array().into_iter().flatten() {
        let words = |key: &str| object[key].as_str().unwrap_or_default();
        let ratio = &object["world_space"]["sphere"]["surface_over_box"];
        let _ = writeln!(
            out,
            "\n{} {}: {} triangles, {} points, {} on the hull; in world space the sphere has {:.2} of the box's surface\n  {:<15}{:>8}{:>12}{:>9}{:>10}{:>9}{:>14}{:>8}",
            object["instance"],
            words("name"),
            object["triangles"],
            object["cluster"],
            object["hull"],
            real(ratio),
            "extent",
            "T",
            "m",
            "f",
            "predicted",
            "counted",
            "false alarms",
            "hits"
        );
        for test in object["tests"].as_array().into_iter().flatten() {
            let _ = writeln!(
                out,
                "  {:<15}{:>8.1}{:>12.1}{:>9.4}{:>10.2}{:>9.2}{:>14}{:>8}",
                test["test"].as_str().unwrap_or_default(),
                real(&test["T"]),
                real(&test["m"]),
                real(&test["f"]),
                real(&test["predicted"]),
                real(&test["counted"]),
                test["false_alarms"].as_u64().unwrap_or_default(),
                test["hits"].as_u64().unwrap_or_default()
            );
        }
        let _ = writeln!(out, "  auto: {}: {}", words("choice"), words("reason"));
    }
    let cost = &report["cost"];
    let _ = writeln!(
        out,
        "\ncounted cost of a ray: {:.1} without extents, {:.1} with auto, {:.1} with the best of each object on these rays, {:.1} with {} for all",
        real(&cost["none"]),
        real(&cost["auto"]),
        real(&cost["best_of_all_rays"]),
        real(&cost["best_same_for_all"]["cost"]),
        cost["best_same_for_all"]["extents"]
            .as_str()
            .unwrap_or_default()
    );
    out
}
