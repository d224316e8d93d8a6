//! Golden pictures: what the program makes of `models/` is what it made before, layer by layer.
//!
//! The references lie in `golden/`; `BSPRAY_BLESS=1 cargo test --test golden` writes them anew. Look at them before they are
//! committed. When a picture differs, render, reference and difference are written to `target/golden-failures/`.

#[path = "support/picture_difference.rs"]
mod picture_difference;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use bspray::picture::{Attribute, Picture, Samples, exr};
use picture_difference::{Tolerance, differences, tolerance, write_all};

struct Golden {
    /// Of the reference, without its extension.
    name: &'static str,
    model: &'static str,
    camera: &'static [&'static str; 4],
    /// Arguments beside those of all.
    args: &'static [&'static str],
    /// Layers of the reference; empty for all but `cost`.
    layers: &'static [&'static str],
}

/// Arguments of every golden picture.
const ARGS: [&str; 4] = ["--spp=16", "--seed=0", "--filter=box", "--quiet"];

/// Of those that say nothing else.
const RESOLUTION: &str = "--resolution=64x64";

const OBJECTS: [&str; 4] = [
    "--camera-position=0.6,3,9.2",
    "--camera-focal-point=0.1,1.1,0.1",
    "--camera-view-up=0,1,0",
    "--camera-view-angle=46",
];

const COLOR: [&str; 4] = ["R", "G", "B", "A"];

/// Colour, and the partition by the polygon BSP.
const PARTITION: [&str; 6] = ["R", "G", "B", "A", "fragment", "bsp-depth"];

const BLOCK: [&str; 4] = [
    "--camera-position=3.7,3.1,4.5",
    "--camera-focal-point=1,0.9,0.5",
    "--camera-view-up=0,1,0",
    "--camera-view-angle=30",
];

const BOX: [&str; 4] = [
    "--camera-position=278,273,-800",
    "--camera-focal-point=278,273,0",
    "--camera-view-up=0,1,0",
    "--camera-view-angle=39.3",
];

const GOLDEN: [Golden; 12] = [
    Golden {
        name: "lecture-block",
        model: "lecture-block.obj",
        camera: &BLOCK,
        args: &["--integrator=direct"],
        layers: &[],
    },
    Golden {
        name: "lecture-objects",
        model: "lecture-objects.gltf",
        camera: &OBJECTS,
        args: &["--integrator=direct"],
        layers: &[],
    },
    Golden {
        name: "lecture-objects-path",
        model: "lecture-objects.gltf",
        camera: &OBJECTS,
        args: &["--integrator=path", "--exhaustive"],
        layers: &COLOR,
    },
    Golden {
        name: "lecture-objects-whitted",
        model: "lecture-objects.gltf",
        camera: &OBJECTS,
        args: &["--integrator=whitted"],
        layers: &COLOR,
    },
    Golden {
        name: "cornell-box",
        model: "cornell-box.obj",
        camera: &BOX,
        args: &["--integrator=direct"],
        layers: &[],
    },
    Golden {
        name: "lecture-objects-ao",
        model: "lecture-objects.gltf",
        camera: &OBJECTS,
        args: &["--integrator=ao", "--ao-distance=2"],
        layers: &COLOR,
    },
    Golden {
        name: "lecture-objects-normals",
        model: "lecture-objects.gltf",
        camera: &OBJECTS,
        args: &["--integrator=normals"],
        layers: &COLOR,
    },
    Golden {
        name: "lecture-objects-facing",
        model: "lecture-objects.gltf",
        camera: &OBJECTS,
        args: &["--integrator=facing"],
        layers: &COLOR,
    },
    Golden {
        name: "lecture-block-fragment",
        model: "lecture-block.obj",
        camera: &BLOCK,
        args: &["--integrator=fragment", "--bsp-order=file"],
        layers: &PARTITION,
    },
    Golden {
        name: "lecture-objects-bsp-depth",
        model: "lecture-objects.gltf",
        camera: &OBJECTS,
        args: &["--integrator=bsp-depth", "--bsp-merge"],
        layers: &PARTITION,
    },
    // A part with a name, with outlines of all kinds, and of the legend.
    Golden {
        name: "lecture-objects-overlay-extents",
        model: "lecture-objects.gltf",
        camera: &OBJECTS,
        args: &[
            "--resolution=400x300",
            "--pixelbounds=30, 170, 130, 290",
            "--overlay=extents",
        ],
        layers: &["overlay"],
    },
    Golden {
        name: "lecture-objects-overlay-edges",
        model: "lecture-objects.gltf",
        camera: &OBJECTS,
        args: &[
            "--resolution=400x300",
            "--pixelbounds=150, 270, 90, 210",
            "--overlay=edges",
        ],
        layers: &["overlay"],
    },
];

impl Golden {
    fn reference(&self) -> PathBuf {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/golden");
        folder.join(format!("{}.exr", self.name))
    }

    fn args(&self) -> Vec<&'static str> {
        let has_own = self.args.iter().any(|a| a.starts_with("--resolution="));
        let resolution = (!has_own).then_some(RESOLUTION);
        resolution
            .into_iter()
            .chain(ARGS)
            .chain(self.camera.iter().copied())
            .chain(self.args.iter().copied())
            .collect()
    }

    /// The picture, without what differs from run to run (attributes) and from machine to machine (counts of steps).
    fn render(&self) -> Picture {
        let folder = tempfile::tempdir().expect("a folder");
        let model = Path::new(env!("CARGO_MANIFEST_DIR"))
            .join("models")
            .join(self.model);
        let output = assert_cmd::cargo::cargo_bin_cmd!("bspray")
            .current_dir(folder.path())
            .arg("render")
            .arg(model)
            .args(self.args())
            .args(["-o", "picture.exr"])
            .output()
            .expect("the program starts");
        assert!(output.status.success(), "{}: {output:?}", self.name);
        let mut picture = exr::read(&folder.path().join("picture.exr")).expect("an EXR file");
        picture.channels.retain(|channel| {
            let layer = channel.name.split('.').next().unwrap_or_default();
            // Of mattes the first two ranks; nothing here has more than a few pixels of others.
            let is_low_rank = layer.starts_with("Crypto") && !layer.ends_with("00");
            layer != "cost"
                && !is_low_rank
                && (self.layers.is_empty() || self.layers.contains(&layer))
        });
        // How to make it again.
        let command = [vec!["bspray render", self.model], self.args()].concat();
        let attribute = Attribute::Text(command.join(" "));
        picture.attributes = BTreeMap::from([("bspray/commandLine".to_owned(), attribute)]);
        picture
    }
}

fn failures() -> PathBuf {
    let temporary = Path::new(env!("CARGO_TARGET_TMPDIR"));
    temporary
        .parent()
        .unwrap_or(temporary)
        .join("golden-failures")
}

#[test]
fn pictures_are_what_they_were() {
    let is_blessing = std::env::var_os("BSPRAY_BLESS").is_some_and(|v| v == "1");
    let mut report = String::new();
    for golden in &GOLDEN {
        let found = golden.render();
        let reference = golden.reference();
        if is_blessing {
            exr::write(&reference, &found).unwrap();
            continue;
        }
        let want = exr::read(&reference)
            .unwrap_or_else(|e| panic!("{e}; BSPRAY_BLESS=1 writes the references"));
        let lines = differences(&found, &want);
        if !lines.is_empty() {
            let files = write_all(&failures(), golden.name, &found, &want).unwrap();
            report += &format!("{}:\n{lines}see {}\n", golden.name, files.join("\n    "));
        }
    }
    assert!(
        report.is_empty(),
        "\n{report}BSPRAY_BLESS=1 takes the new pictures as references"
    );
}

#[test]
fn references_are_small_and_all_used() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/golden");
    for entry in folder.read_dir().unwrap() {
        let entry = entry.unwrap();
        let name = entry.file_name().into_string().unwrap();
        if name == ".gitattributes" {
            continue;
        }
        let is_used = GOLDEN.iter().any(|g| format!("{}.exr", g.name) == name);
        assert!(is_used, "{name} is the reference of nothing");
        assert!(entry.metadata().unwrap().len() < 300_000, "{name}");
    }
}

/// A value made another.
type Change = fn(f32) -> f32;

/// Changes the first value of a channel that is not 0 or infinite.
fn with_change(picture: &Picture, name: &str, change: impl Fn(f32) -> f32) -> Picture {
    let mut changed = picture.clone();
    let channel = changed.channels.iter_mut().find(|c| c.name == name);
    match &mut channel.expect("the channel").samples {
        Samples::U32(values) => values[17] ^= 1,
        Samples::F16(values) | Samples::F32(values) => {
            let value = values.iter_mut().find(|v| v.is_finite() && v.abs() > 1e-3);
            let value = value.expect("a value");
            *value = change(*value);
        }
    }
    changed
}

#[test]
fn every_change_beyond_the_tolerance_is_found_and_shown() {
    let folder = tempfile::tempdir().unwrap();
    let reference = GOLDEN[1].render();
    assert_eq!(differences(&reference, &reference), "");
    for channel in &reference.channels {
        let name = channel.name.as_str();
        let (within, beyond): (Change, Change) = match tolerance(name) {
            Tolerance::Exact => (|v| v, |v| f32::from_bits(v.to_bits() ^ 1)),
            Tolerance::Ulps(_) => (|v| v * (1.0 + f32::EPSILON), |v| v + 1e-3),
            Tolerance::Color { .. } => (|v| v + 5e-6, |v| v * 1.001 + 1e-4),
        };
        if let Samples::F16(values) | Samples::F32(values) = &channel.samples
            && values.iter().all(|v| !v.is_finite() || v.abs() <= 1e-3)
        {
            // Nothing here has texture coordinates, mirrors, or an id of low rank in any pixel.
            continue;
        }
        if tolerance(name) != Tolerance::Exact {
            assert_eq!(
                differences(&with_change(&reference, name, within), &reference),
                ""
            );
        }
        let changed = with_change(&reference, name, beyond);
        let lines = differences(&changed, &reference);
        let start = format!("{name}: 1 of 4096 pixels, the first at ");
        assert!(
            lines.starts_with(&start) && lines.lines().count() == 1,
            "{lines}"
        );
        for file in write_all(folder.path(), name, &changed, &reference).unwrap() {
            assert!(Path::new(&file).metadata().unwrap().len() > 100, "{file}");
        }
        let nan = with_change(&reference, name, |_| f32::NAN);
        assert!(!differences(&nan, &reference).is_empty(), "{name}: NaN");
    }
    let mut missing = reference.clone();
    missing.channels.remove(0);
    assert!(differences(&missing, &reference).contains(" is missing"));
}
