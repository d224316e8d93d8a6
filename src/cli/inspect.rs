//! `bspray inspect`: what model files hold.

use std::fmt::Write;
use std::path::PathBuf;
use std::time::Instant;

use bspray::scene::{AlphaMode, LightKind, Material, Projection, Scene};
use clap::Args;
use serde_json::{Value, json};

use super::inspect_bsp::{self, InspectBspArgs};
use super::inspect_extents::{self, InspectExtentArgs};
use super::inspect_needs::{self, InspectNeedsArgs};
use super::model_args::ModelArgs;
use super::numbers::{number, numbers};
use super::{Done, output};

/// Arguments of `bspray inspect`.
#[derive(Args, Debug)]
#[command(group(clap::ArgGroup::new("view").args(["extent_table", "needs"])),
    mut_group("CameraArgs", |group| group.requires("view")))]
pub(super) struct InspectArgs {
    #[command(flatten)]
    input: ModelArgs,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    bsp: InspectBspArgs,
    #[command(flatten)]
    extents: InspectExtentArgs,
    #[command(flatten)]
    needs: InspectNeedsArgs,
}

/// Rows of a list that are shown without `--json`.
const SHOWN_ROWS: usize = 40;

/// Loads and tells.
pub(super) fn run(args: &InspectArgs) -> anyhow::Result<Done> {
    args.bsp.check_files()?;
    let started = Instant::now();
    let scene = args.input.load()?;
    let load = started.elapsed().as_secs_f64();
    if args.bsp.bsp {
        return inspect_bsp::run(&scene, &args.input.models, &args.bsp, args.json);
    }
    if args.extents.extent_table {
        return inspect_extents::run(&scene, &args.extents, args.json);
    }
    if args.needs.needs {
        let (camera, size) = (&args.extents.camera, args.extents.resolution);
        return inspect_needs::run(scene, &args.needs, camera, size, load, args.json);
    }
    let report = report(&scene, &args.input.models);
    output::report(&report, args.json, text)?;
    Ok(Done::Completely)
}

fn report(scene: &Scene, models: &[PathBuf]) -> Value {
    let bounds = scene.bounds();
    let mut placed = vec![0_u64; scene.meshes.len()];
    for instance in &scene.instances {
        placed[instance.mesh as usize] += 1;
    }
    let meshes = scene.meshes.iter().zip(placed).map(|(mesh, instances)| {
        json!({
            "name": mesh.name,
            "triangles": mesh.triangles.len(),
            "vertices": mesh.positions.len(),
            "instances": instances,
            "polygons": mesh.outlines.len(),
            "materials": mesh.parts.iter().map(|p| p.material).collect::<Vec<_>>(),
            "normals": !mesh.normals.is_empty(),
            "uv_sets": mesh.uv_sets.iter().filter(|s| !s.is_empty()).count(),
            "colors": !mesh.colors.is_empty(),
        })
    });
    let instances = scene
        .instances
        .iter()
        .map(|i| match i.materials.as_slice() {
            [] => json!({ "name": i.name, "mesh": i.mesh }),
            own => json!({ "name": i.name, "mesh": i.mesh, "materials": own }),
        });
    let images = scene.images.iter().map(|image| {
        json!({ "name": image.name, "size": [image.width, image.height], "decoded": image.pixels.is_some() })
    });
    let lights = scene.lights.iter().map(|light| {
        let kind = match light.kind {
            LightKind::Directional => "directional",
            LightKind::Point => "point",
            LightKind::Spot { .. } => "spot",
        };
        json!({ "name": light.name, "kind": kind, "intensity": numbers(light.intensity.to_array()),
            "position": numbers(light.position.to_array()), "direction": numbers(light.direction.to_array()), "range": light.range.map(number) })
    });
    let cameras = scene.cameras.iter().map(|camera| {
        let projection = match camera.projection {
            Projection::Perspective { view_angle } => {
                json!({ "perspective": { "view_angle": number(view_angle) } })
            }
            Projection::Orthographic { height } => {
                json!({ "orthographic": { "height": number(height) } })
            }
            Projection::Panoramic => json!("panoramic"),
        };
        json!({ "name": camera.name, "position": numbers(camera.position.to_array()),
            "focal_point": numbers(camera.focal_point.to_array()), "projection": projection })
    });
    json!({
        "models": models.iter().map(|m| m.to_string_lossy()).collect::<Vec<_>>(),
        "triangles": scene.meshes.iter().map(|m| m.triangles.len()).sum::<usize>(),
        "triangles_placed": scene.placed_triangles(),
        "vertices": scene.meshes.iter().map(|m| m.positions.len()).sum::<usize>(),
        "bounds": { "min": numbers(bounds.min.to_array()), "max": numbers(bounds.max.to_array()), "diagonal": number(bounds.diagonal()) },
        "meshes": meshes.collect::<Vec<_>>(),
        "instances": instances.collect::<Vec<_>>(),
        "materials": scene.materials.iter().map(material).collect::<Vec<_>>(),
        "textures": scene.textures.len(),
        "images": images.collect::<Vec<_>>(),
        "lights": lights.collect::<Vec<_>>(),
        "cameras": cameras.collect::<Vec<_>>(),
        "notes": scene.notes.iter().map(ToString::to_string).collect::<Vec<_>>(),
        "defects": scene.defects.iter().map(ToString::to_string).collect::<Vec<_>>(),
    })
}

fn material(material: &Material) -> Value {
    let lobes = [
        ("specular", material.specular.is_some()),
        ("transmission", material.transmission.is_some()),
        ("volume", material.volume.is_some()),
        ("clearcoat", material.clearcoat.is_some()),
        ("sheen", material.sheen.is_some()),
        ("unlit", material.unlit),
        ("double-sided", material.double_sided),
    ];
    json!({
        "name": material.name,
        "base_color": numbers(material.base_color.to_array()),
        "metallic": number(material.metallic),
        "roughness": number(material.roughness),
        "emissive": numbers(material.emissive.to_array()),
        "alpha": match material.alpha_mode {
            AlphaMode::Opaque => json!("opaque"),
            AlphaMode::Mask { cutoff } => json!({ "mask": number(cutoff) }),
            AlphaMode::Blend => json!("blend"),
        },
        "textures": material.texture_refs().count(),
        "features": lobes.into_iter().filter(|(_, has)| *has).map(|(name, _)| name).collect::<Vec<_>>(),
    })
}

/// The report as lists.
fn text(report: &Value) -> String {
    let count = |key: &str| report[key].as_array().map_or(0, Vec::len);
    let bounds = &report["bounds"];
    let mut out = format!(
        "triangles   {} ({} placed)\nvertices    {}\nbounds      {} to {} (diagonal {})\n",
        report["triangles"],
        report["triangles_placed"],
        report["vertices"],
        bounds["min"],
        bounds["max"],
        bounds["diagonal"]
    );
    let list = |out: &mut String, key: &str, row: &dyn Fn(usize, &Value) -> String| {
        let _ = writeln!(out, "{key:<12}{}", count(key));
        let rows = report[key].as_array().into_iter().flatten().enumerate();
        for (index, value) in rows.take(SHOWN_ROWS) {
            let _ = writeln!(out, "  {}", row(index, value));
        }
        if count(key) > SHOWN_ROWS {
            let _ = writeln!(
                out,
                "  ... {} more; --json has all",
                count(key) - SHOWN_ROWS
            );
        }
    };
    list(&mut out, "meshes", &|i, m| {
        let (name, triangles, vertices) = (&m["name"], &m["triangles"], &m["vertices"]);
        let instances = if m["instances"] == 1 {
            String::new()
        } else {
            format!(", {} instances", m["instances"])
        };
        let polygons = if m["polygons"] == 0 {
            String::new()
        } else {
            format!(", {} polygons", m["polygons"])
        };
        format!("{i} {name}: {triangles} triangles, {vertices} vertices{polygons}{instances}")
    });
    list(&mut out, "instances", &|i, v| {
        format!("{i} {}: mesh {}", v["name"], v["mesh"])
    });
    list(&mut out, "materials", &|i, m| {
        let features: Vec<_> = m["features"]
            .as_array()
            .into_iter()
            .flatten()
            .filter_map(Value::as_str)
            .collect();
        let features = if features.is_empty() {
            String::new()
        } else {
            format!(", {}", features.join(", "))
        };
        let (name, color, textures) = (&m["name"], &m["base_color"], &m["textures"]);
        format!(
            "{i} {name}: colour {color}, {textures} textures, alpha {}{features}",
            m["alpha"]
        )
    });
    let _ = writeln!(out, "{:<12}{}", "textures", report["textures"]);
    list(&mut out, "images", &|i, v| {
        let decoded = if v["decoded"] == true {
            ""
        } else {
            " (not decoded)"
        };
        format!(
            "{i} {}: {}x{}{decoded}",
            v["name"], v["size"][0], v["size"][1]
        )
    });
    list(&mut out, "lights", &|i, v| {
        format!(
            "{i} {}: {}, intensity {}",
            v["name"], v["kind"], v["intensity"]
        )
    });
    list(&mut out, "cameras", &|i, v| {
        format!(
            "{i} {}: {}, at {}",
            v["name"], v["projection"], v["position"]
        )
    });
    let plain = |_: usize, v: &Value| v.as_str().unwrap_or_default().to_owned();
    list(&mut out, "defects", &plain);
    list(&mut out, "notes", &plain);
    out
}
