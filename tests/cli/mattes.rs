//! Cryptomatte as a compositor reads it: the manifest's ids in the ranks, and mattes that agree with what the pixels' centres show.

use std::collections::BTreeMap;

use bspray::picture::{Attribute, Picture, Samples, exr};

use super::run::{bspray, model};

/// The manifest of the layer of that name, found as the specification says: by its attributes, not by their key.
fn manifest(picture: &Picture, layer: &str) -> BTreeMap<String, String> {
    let text = |name: &str| match picture.attributes.get(name) {
        Some(Attribute::Text(text)) => text.as_str(),
        other => panic!("{name}: {other:?}"),
    };
    let keys = picture.attributes.keys();
    let mut names = keys.filter_map(|key| {
        let start = key.strip_suffix("/name")?;
        (start.starts_with("cryptomatte/") && text(key) == layer).then_some(start)
    });
    let start = names.next().expect("the layer has attributes");
    assert_eq!(text(&format!("{start}/hash")), "MurmurHash3_32");
    assert_eq!(text(&format!("{start}/conversion")), "uint32_to_float32");
    serde_json::from_str(text(&format!("{start}/manifest"))).expect("JSON")
}

fn floats<'a>(picture: &'a Picture, name: &str) -> &'a [f32] {
    match picture.channel(name) {
        Some(Samples::F32(values)) => values,
        other => panic!("{name}: {other:?}"),
    }
}

fn numbers<'a>(picture: &'a Picture, name: &str) -> &'a [u32] {
    match picture.channel(name) {
        Some(Samples::U32(values)) => values,
        other => panic!("{name}: {other:?}"),
    }
}

/// How much of each pixel the id covers: the sum over all ranks that have it.
fn matte(picture: &Picture, layer: &str, id: f32) -> Vec<f32> {
    let mut sum = vec![0.0; picture.window.pixels() as usize];
    for number in 0..3 {
        for (of_id, of_coverage) in [("R", "G"), ("B", "A")] {
            let ids = floats(picture, &format!("{layer}{number:02}.{of_id}"));
            let coverages = floats(picture, &format!("{layer}{number:02}.{of_coverage}"));
            for ((sum, &found), coverage) in sum.iter_mut().zip(ids).zip(coverages) {
                if found.to_bits() == id.to_bits() {
                    *sum += coverage;
                }
            }
        }
    }
    sum
}

#[test]
fn mattes_add_up_to_the_coverage_and_agree_with_the_ids() {
    let folder = tempfile::tempdir().unwrap();
    let objects = model("lecture-objects.gltf");
    let args = [
        "render",
        &objects,
        "-o",
        "a.exr",
        "--resolution=96x64",
        "--filter=box",
    ];
    let ran = bspray(folder.path(), &args);
    assert_eq!(ran.code, Some(0), "{ran:?}");
    let picture = exr::read(&folder.path().join("a.exr")).unwrap();
    let scene = bspray::import::load(&[objects.into()]).unwrap();
    let names = scene.instances.iter().map(|i| i.name.as_str());
    let materials = scene.materials.iter().map(|m| m.name.as_str());
    for (layer, of_centre, names) in [
        ("CryptoObject", "id", names.collect::<Vec<_>>()),
        ("CryptoMaterial", "material", materials.collect()),
    ] {
        let manifest = manifest(&picture, layer);
        let centres = numbers(&picture, of_centre);
        let mut sums = vec![0.0_f32; centres.len()];
        let mut seen = 0;
        for (name, hex) in &manifest {
            let id = f32::from_bits(u32::from_str_radix(hex, 16).unwrap());
            let matte = matte(&picture, layer, id);
            for (index, coverage) in matte.iter().enumerate() {
                assert!((0.0..=1.0).contains(coverage));
                sums[index] += coverage;
                // A pixel that is covered wholly shows nothing else at its centre, and a pixel without it does not show it.
                let centre = names.get(centres[index] as usize).copied();
                if *coverage >= 1.0 {
                    assert_eq!(centre, Some(name.as_str()), "{layer} {index}");
                    seen += 1;
                } else if *coverage <= 0.0 {
                    // A sliver may pass between the samples, not more.
                    let nearby = [
                        index.wrapping_sub(1),
                        index + 1,
                        index.wrapping_sub(96),
                        index + 96,
                    ];
                    let is_near = nearby
                        .iter()
                        .any(|&i| matte.get(i).is_some_and(|c| *c > 0.0));
                    assert!(centre != Some(name) || is_near, "{layer} {name} {index}");
                }
            }
        }
        assert!(seen > 1000, "{layer}: {seen}");
        // Nowhere here are more than six in one pixel.
        for (sum, alpha) in sums.iter().zip(floats(&picture, "A")) {
            assert!((sum - alpha).abs() < 1e-6, "{layer}: {sum} of {alpha}");
        }
    }
}

#[test]
fn panes_share_what_is_behind_them() {
    let folder = tempfile::tempdir().unwrap();
    let glass = [
        "newmtl glass\nKd 1 1 1\nd 0.25\nnewmtl wall\nKd 1 0 0\n",
        "mtllib a.mtl\nv -9 -9 0\nv 9 -9 0\nv 9 9 0\nv -9 9 0\nv -9 -9 -1\nv 9 -9 -1\nv 9 9 -1\nv -9 9 -1\n\
         o pane\nusemtl glass\nf 1 2 3 4\no behind\nusemtl wall\nf 5 6 7 8\n",
    ];
    std::fs::write(folder.path().join("a.mtl"), glass[0]).unwrap();
    std::fs::write(folder.path().join("a.obj"), glass[1]).unwrap();
    let args = [
        "render",
        "a.obj",
        "-o",
        "a.exr",
        "--resolution=4x3",
        "--spp=3",
    ];
    let eye = ["--camera-position=0,0,5", "--camera-focal-point=0,0,0"];
    let ran = bspray(folder.path(), &[&args[..], &eye].concat());
    assert_eq!(ran.code, Some(0), "{ran:?}");
    let picture = exr::read(&folder.path().join("a.exr")).unwrap();
    for (layer, wanted) in [
        ("CryptoObject", [("behind", 0.75), ("pane", 0.25)]),
        ("CryptoMaterial", [("wall", 0.75), ("glass", 0.25)]),
    ] {
        for ((name, want), [id, coverage]) in wanted.iter().zip([["R", "G"], ["B", "A"]]) {
            let id = floats(&picture, &format!("{layer}00.{id}"))[5].to_bits();
            assert_eq!(id, bspray::render::matte_id(name), "{layer} {name}");
            let coverage = floats(&picture, &format!("{layer}00.{coverage}"))[5];
            assert!((coverage - want).abs() < 1e-6, "{layer} {name}: {coverage}");
        }
    }
}
