//! `bspray render --pixel X,Y`: everything about one pixel's rays.

use bspray::accel::TestSpaces;
use bspray::geometry::{Ray, exact};
use bspray::render::{Answer, PixelRenderer, RenderOptions, Stage, Surface, TracedRay, Tracer};
use bspray::scene::CameraFrame;
use serde_json::{Value, json};

use super::numbers::{number, numbers};
use super::{Done, output};

/// Samples of the pixel whose rays are all shown; more would not be read.
const SHOWN_SAMPLES: u32 = 4;

/// Prints the ray through the pixel's centre and the rays of its first samples, with what they met, and what exact
/// arithmetic says of each hit.
pub(super) fn run(
    stage: &Stage,
    camera: &CameraFrame,
    options: &RenderOptions,
    (x, y): (u32, u32),
    as_json: bool,
) -> anyhow::Result<Done> {
    let renderer = PixelRenderer {
        stage,
        camera,
        options,
    };
    let mut tracer = Tracer::new(stage.accelerator, true);
    tracer.record = Some(Vec::new());
    renderer.first_hit(&mut tracer, x, y);
    let center = tracer.record.replace(Vec::new()).unwrap_or_default();
    let mut samples = Vec::new();
    for sample in 0..options.samples.min(SHOWN_SAMPLES) {
        let seen = renderer.sample(&mut tracer, x, y, sample);
        samples.push((seen, tracer.record.replace(Vec::new()).unwrap_or_default()));
    }
    let rays = |rays: &[TracedRay]| rays.iter().map(|r| describe(stage, r)).collect::<Vec<_>>();
    let cost = tracer.cost.unwrap_or_default();
    let report = json!({
        "pixel": [x, y],
        "center": rays(&center),
        "samples": samples.iter().map(|(seen, traced)| json!({
            "color": numbers(seen.color.to_array()),
            "alpha": number(seen.alpha),
            "backdrop": numbers(seen.backdrop.to_array()),
            "rays": rays(traced),
        })).collect::<Vec<_>>(),
        "steps": { "nodes": cost.nodes, "leaves": cost.leaves, "primitives": cost.primitives, "extents": cost.extents },
    });
    output::report(&report, as_json, text)?;
    Ok(Done::Completely)
}

/// A ray and its answer.
fn describe(stage: &Stage, traced: &TracedRay) -> Value {
    let ray = &traced.ray;
    let mut value = json!({
        "kind": traced.kind.name(),
        "depth": ray.source.depth,
        "origin": numbers(ray.origin.to_array()),
        "direction": numbers(ray.direction.to_array()),
        "interval": numbers([ray.interval.min, ray.interval.max]),
    });
    match traced.answer {
        Answer::Any(hit) => value["occluded"] = json!(hit),
        Answer::Closest(None) => value["hit"] = Value::Null,
        Answer::Closest(Some(hit)) => {
            let surface = Surface::at(stage, ray, hit);
            let material = surface.material_point(stage);
            let instance = &stage.scene.instances[hit.instance as usize];
            value["hit"] = json!({
                "t": number(hit.t),
                "instance": hit.instance,
                "instance_name": instance.name,
                "triangle": hit.triangle,
                "barycentric": numbers([surface.barycentric.0, surface.barycentric.1]),
                "position": numbers(surface.position.to_array()),
                "geometric_normal": numbers(surface.geometric_normal.to_array()),
                "shading_normal": numbers(surface.shading_normal.to_array()),
                "side": if surface.is_front { "front" } else { "back" },
                "uv": numbers(surface.uv.to_array()),
                "material": surface.material,
                "material_name": stage.scene.materials[surface.material as usize].name,
                "base_color": numbers(material.base_color.to_array()),
                "alpha": number(material.alpha),
                "offset": number(surface.offset),
                "exact": verdict(stage, ray, &surface),
            });
            if let Some(fragment) = fragment(stage, &surface) {
                value["hit"]["fragment"] = fragment;
            }
        }
    }
    value
}

/// Where in the polygon BSP the hit is, if there is one.
fn fragment(stage: &Stage, surface: &Surface) -> Option<Value> {
    let trees = stage.trees?;
    let located = trees.locate(&surface.hit, surface.position.as_dvec3())?;
    Some(json!({
        "name": trees.trees()[located.tree as usize].bsp.name(located.fragment),
        "number": trees.fragment_number(&located),
        "tree": located.tree,
        "bsp_depth": located.depth,
    }))
}

/// What exact arithmetic says of the hit, in the space in which its triangle is tested.
fn verdict(stage: &Stage, ray: &Ray, surface: &Surface) -> Value {
    let hit = surface.hit;
    let (ray, triangle) =
        TestSpaces::of(stage.scene).test(stage.scene, ray, hit.instance, hit.triangle);
    match exact::depth(&ray, &triangle) {
        Some(depth) => {
            let t = depth.to_f32();
            let ulps_off = i64::from(hit.t.to_bits()) - i64::from(t.to_bits());
            json!({ "hits": true, "t": number(t), "ulps_off": ulps_off })
        }
        None => json!({ "hits": false }),
    }
}

/// The report as indented lines.
fn text(report: &Value) -> String {
    let mut lines = vec![format!(
        "pixel {},{}",
        report["pixel"][0], report["pixel"][1]
    )];
    let ray_lines = |rays: &Value, lines: &mut Vec<String>| {
        for ray in rays.as_array().into_iter().flatten() {
            lines.push(format!(
                "  {} ray, depth {}: origin {}, direction {}, t in {}",
                ray["kind"].as_str().unwrap_or(""),
                ray["depth"],
                ray["origin"],
                ray["direction"],
                ray["interval"]
            ));
            if let Some(occluded) = ray["occluded"].as_bool() {
                lines.push(format!(
                    "    {}",
                    if occluded { "occluded" } else { "free" }
                ));
            } else if ray["hit"].is_null() {
                lines.push("    no hit".to_owned());
            } else {
                for (name, value) in ray["hit"].as_object().into_iter().flatten() {
                    lines.push(format!("    {name}: {value}"));
                }
            }
        }
    };
    lines.push("center".to_owned());
    ray_lines(&report["center"], &mut lines);
    for (index, sample) in report["samples"]
        .as_array()
        .into_iter()
        .flatten()
        .enumerate()
    {
        lines.push(format!(
            "sample {index}: color {}, alpha {}",
            sample["color"], sample["alpha"]
        ));
        ray_lines(&sample["rays"], &mut lines);
    }
    let steps = &report["steps"];
    lines.push(format!(
        "steps of all these rays: {} nodes, {} leaves, {} triangles",
        steps["nodes"], steps["leaves"], steps["primitives"]
    ));
    lines.join("\n")
}
