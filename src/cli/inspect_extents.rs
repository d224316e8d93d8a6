//! `bspray inspect --extent-table`: what each object's extents are, and what they are worth on the rays of one view.

use std::fmt::Write;

use bspray::accel::extents::{
    ExtentChoice, ExtentObject, ExtentSet, ExtentShapes, ExtentTest, ExtentsLoop, MeshAccelerator,
    ObjectStudy, PointCluster, projected_area,
};
use bspray::accel::{AcceleratorKind, BuildOptions};
use bspray::analysis::{LadderOptions, Query, ray_sets};
use bspray::scene::{MeshMeasure, Scene};
use clap::Args;
use glam::DAffine3;
use serde_json::{Value, json};

use super::camera_args::{self, CameraArgs};
use super::{Done, extent_args, output, values};

/// Arguments for the table of extents.
#[derive(Args, Debug)]
pub(super) struct InspectExtentArgs {
    /// Tell of the objects' extents instead: their sizes, and what they are worth for eye, shadow and mirror rays of the camera
    #[arg(long, conflicts_with = "bsp")]
    pub(super) extent_table: bool,
    #[command(flatten)]
    pub(super) camera: CameraArgs,
    /// With --extent-table: what finds the hits within an object: linear (the lecture's), bsp, bvh2 or cwbvh
    #[arg(long, value_name = "KIND", default_value_t = MeshAccelerator::Linear, value_parser = extent_args::mesh, requires = "extent_table")]
    mesh_accel: MeshAccelerator,
    /// With --extent-table or --needs: width and height of the view, in pixels
    #[arg(long, value_name = "WxH", value_parser = values::resolution, default_value = "1280x720", requires = "view")]
    pub(super) resolution: (u32, u32),
    /// With --extent-table: most rays of each kind
    #[arg(long, value_name = "N", default_value_t = 2000, value_parser = clap::value_parser!(u32).range(1..=values::MOST_RAYS), requires = "extent_table")]
    rays: u32,
}

/// Tells of the extents.
pub(super) fn run(scene: &Scene, args: &InspectExtentArgs, as_json: bool) -> anyhow::Result<Done> {
    let camera = args.camera.choose(scene, args.resolution)?;
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
        up: args.camera.up(),
    };
    let mut studies = objects.study(&[], true);
    for (_, set) in ray_sets(scene, &*lookup, &options) {
        let more = objects.study(&set.rays, set.purpose.query() == Query::Closest);
        studies.iter_mut().zip(&more).for_each(|(s, m)| s.add(m));
    }
    let clusters: Vec<_> = scene
        .meshes
        .iter()
        .map(|mesh| PointCluster::new(&mesh.cluster(usize::MAX)))
        .collect();
    let rows: Vec<Value> = objects
        .objects()
        .iter()
        .zip(&studies)
        .map(|(object, study)| {
            let instance = &scene.instances[object.instance as usize];
            let cluster = clusters[instance.mesh as usize].as_ref();
            let placed = cluster.and_then(|c| c.transformed(&instance.world_from_object));
            let pixels = placed.and_then(|c| projected_area(c.hull(), &view));
            row(scene, object, study, pixels)
        })
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
    output::report(&report, as_json, text)?;
    Ok(Done::Completely)
}

/// Box and sphere in one space, and the object there: volumes, and surfaces, which rays meet in proportion to.
fn shapes(shapes: &ExtentShapes, object: &MeshMeasure) -> Value {
    let [x, y, z] = shapes.bounds.extent().to_array().map(f64::from);
    let of_extent = |volume: f64, surface: f64| {
        let over = |of_object: f64, of_extent: f64| {
            let is_sound = of_object > 0.0;
            is_sound.then(|| of_extent / of_object)
        };
        json!({ "volume": volume, "surface": surface,
            "volume_over_object": object.volume.and_then(|v| over(v, volume)),
            "surface_over_object": over(object.surface, surface) })
    };
    let mut bounds = of_extent(x * y * z, 2.0 * (x * y + y * z + z * x));
    bounds["size"] = json!([x, y, z]);
    let sphere = shapes.sphere.map(|s| {
        let mut sphere = of_extent(s.volume(), s.surface_area());
        sphere["radius"] = json!(s.radius);
        sphere
    });
    json!({ "volume": object.volume, "surface": object.surface, "box": bounds, "sphere": sphere })
}

/// `hull_pixels`: the projected area of the object's hull.
fn row(
    scene: &Scene,
    object: &ExtentObject,
    study: &ObjectStudy,
    hull_pixels: Option<f64>,
) -> Value {
    let instance = &scene.instances[object.instance as usize];
    let mesh = scene.mesh_of(object.instance);
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
        "name": instance.name,
        "instance": object.instance,
        "triangles": mesh.triangles.len(),
        "cluster": object.points.0,
        "hull": object.points.1,
        "object_space": shapes(&object.extents.object, &mesh.measure(&DAffine3::IDENTITY)),
        "world_space": object.extents.world.as_ref().map(|s| shapes(s, &mesh.measure(&instance.world_from_object))),
        "hull_pixels": hull_pixels,
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
        let _ = writeln!(
            out,
            "\n{} {}: {} triangles, {} points, {} on the hull",
            object["instance"],
            words("name"),
            object["triangles"],
            object["cluster"],
            object["hull"],
        );
        let _ = writeln!(
            out,
            "  {:<15}{:>12}{:>12}{:>24}{:>8}{:>20}{:>8}",
            "space",
            "surface",
            "volume",
            "box/object: surface",
            "volume",
            "sphere: surface",
            "volume"
        );
        for space in ["object", "world"] {
            let shapes = &object[format!("{space}_space")];
            let _ = writeln!(out, "  {space:<15}{}", sizes(shapes));
        }
        let screen = &object["screen"]["pixels"];
        let _ = match object["hull_pixels"].as_f64() {
            Some(hull) => writeln!(
                out,
                "  screen {screen} pixels in the extent, {hull:.0} in the hull"
            ),
            None => writeln!(
                out,
                "  screen {screen} pixels in the extent; the hull reaches behind the eye"
            ),
        };
        let _ = writeln!(
            out,
            "  {:<15}{:>8}{:>12}{:>9}{:>10}{:>9}{:>14}{:>8}",
            "extent", "T", "m", "f", "predicted", "counted", "false alarms", "hits"
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

/// The sizes in one space, below their headings.
fn sizes(shapes: &Value) -> String {
    if shapes.is_null() {
        return "beyond single precision".to_owned();
    }
    let size = |key: &str| match shapes[key].as_f64() {
        None => "open".to_owned(),
        Some(x) if (1e-3..1e6).contains(&x) => format!("{x:.4}"),
        Some(x) => format!("{x:.3e}"),
    };
    let ratio = |extent: &str, key: &str| {
        let ratio = shapes[extent][format!("{key}_over_object")].as_f64();
        ratio.map_or("-".to_owned(), |x| format!("{x:.2}"))
    };
    format!(
        "{:>12}{:>12}{:>24}{:>8}{:>20}{:>8}",
        size("surface"),
        size("volume"),
        ratio("box", "surface"),
        ratio("box", "volume"),
        ratio("sphere", "surface"),
        ratio("sphere", "volume")
    )
}
