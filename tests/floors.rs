//! The floors of the design: which module may name which, and where the crates of formats and of the baseline are named.

use std::fs;
use std::path::{Path, PathBuf};

/// Modules of the library by floor. A file uses its own floor or a lower one; siblings that must not know each other are told
/// apart below.
const FLOORS: &[(&str, u32)] = &[
    ("geometry", 1),
    ("scene", 2),
    ("picture", 2),
    ("import", 3),
    ("accel", 3),
    ("render", 4),
    ("analysis", 5),
];

/// Crates, and the only places that may name them.
const HOMES: &[(&str, &[&str])] = &[
    // Guarded in one file, and as it comes, for measurements, in the other.
    ("obvhs", &["accel/bvh.rs", "accel/bvh_as_shipped.rs"]),
    // Loads a foreign library at run time.
    ("libloading", &["accel/embree/library.rs"]),
    ("robust", &["geometry/exact/orient.rs"]),
    ("exr", &["picture/exr.rs"]),
    ("image", &["picture/ldr.rs"]),
    ("tobj", &["import/obj/"]),
    ("gltf", &["import/gltf/"]),
    // Decodes buffers in one file, and simplifies meshes in the other.
    (
        "meshopt",
        &["import/gltf/meshopt_views.rs", "scene/detail/simplify.rs"],
    ),
    ("draco_core", &["import/gltf/draco.rs"]),
    ("basisu", &["import/gltf/ktx2.rs"]),
    ("earcut", &["import/obj/"]),
    ("noto_sans_mono_bitmap", &["picture/glyphs.rs"]),
    ("plotters", &["analysis/report/charts/"]),
    ("plotters_backend", &["analysis/report/charts/bitmap.rs"]),
    ("bevy_mikktspace", &["render/mikktspace.rs"]),
    ("clap", &["cli/"]),
    (
        "rustix",
        &["analysis/clock.rs", "analysis/stability/limits.rs"],
    ),
];

fn sources(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).expect("a folder of sources") {
        let path = entry.expect("an entry").path();
        if path.is_dir() {
            sources(&path, found);
        } else if path.extension().is_some_and(|e| e == "rs") {
            found.push(path);
        }
    }
}

/// Every source with its path below `src` and its lines of code, without comments.
fn code() -> Vec<(String, Vec<String>)> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut paths = Vec::new();
    sources(&root, &mut paths);
    let read = |path: PathBuf| {
        let name = path
            .strip_prefix(&root)
            .expect("below src")
            .to_string_lossy()
            .replace('\\', "/");
        let text = fs::read_to_string(&path).expect("a source");
        let lines = text
            .lines()
            .filter(|l| !l.trim_start().starts_with("//"))
            .map(str::to_owned)
            .collect();
        (name, lines)
    };
    paths.into_iter().map(read).collect()
}

fn floor_of(module: &str) -> Option<u32> {
    FLOORS
        .iter()
        .find(|(name, _)| *name == module)
        .map(|(_, floor)| *floor)
}

#[test]
fn no_file_uses_a_higher_floor_or_a_forbidden_sibling() {
    let mut seen = 0;
    for (name, lines) in code() {
        let Some(own) = name
            .split('/')
            .next()
            .and_then(|m| floor_of(m).map(|f| (m, f)))
        else {
            continue;
        };
        for line in &lines {
            for used in line.split("crate::").skip(1) {
                let module: String = used
                    .chars()
                    .take_while(|c| c.is_ascii_lowercase())
                    .collect();
                let Some(floor) = floor_of(&module) else {
                    continue;
                };
                seen += 1;
                assert!(
                    floor <= own.1,
                    "src/{name} is on floor {}, and uses {module} on {floor}: {line}",
                    own.1
                );
                let pair = [own.0, module.as_str()];
                let is_forbidden = pair == ["import", "accel"] || pair == ["accel", "import"];
                assert!(
                    !is_forbidden,
                    "src/{name}: import and accel do not know each other: {line}"
                );
            }
        }
    }
    assert!(
        seen > 50,
        "only {seen} uses found: is the layout another now?"
    );
}

#[test]
fn crates_are_named_at_home_only() {
    for (krate, homes) in HOMES {
        let mut at_home = 0;
        for (name, lines) in code() {
            // `use exr::`, `obvhs::bvh2` and `::gltf::json`, but neither `picture::exr::` nor `my_exr::`.
            let is_word = |c: char| c.is_alphanumeric() || c == '_';
            let names = lines.iter().filter(|line| {
                line.match_indices(&format!("{krate}::")).any(|(at, _)| {
                    let before = line[..at].strip_suffix("::").unwrap_or(&line[..at]);
                    !before.ends_with(is_word)
                })
            });
            for line in names {
                // Modules of ours bear the names of some of them.
                let is_ours = ["import/mod.rs", "picture/mod.rs"].contains(&name.as_str());
                let is_home = homes.iter().any(|home| name.starts_with(home));
                assert!(
                    is_home || is_ours,
                    "src/{name} names {krate}, whose homes are {homes:?}: {line}"
                );
                at_home += usize::from(is_home);
            }
        }
        assert!(at_home > 0, "nobody uses {krate}");
    }
}

/// Instructions that a machine may lack, and the functions of a foreign library.
const UNSAFE_HOMES: [&str; 2] = ["accel/bsp/wide/simd/", "accel/embree/library.rs"];

#[test]
fn unsafe_code_has_its_own_places() {
    for (name, lines) in code() {
        let is_home = UNSAFE_HOMES.iter().any(|home| name.starts_with(home));
        let has_unsafe = lines
            .iter()
            .any(|l| l.contains("unsafe ") || l.contains("unsafe{"));
        assert!(is_home || !has_unsafe, "src/{name} has unsafe code");
    }
}
