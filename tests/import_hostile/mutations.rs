//! Good files changed at random: bytes flipped, pieces taken from other files, ends cut, numbers and keys replaced.

use std::path::{Path, PathBuf};

use bspray::import::ImportOptions;

use crate::import_contract::load_checked;
use crate::random::Random;

/// Seed of all changes; a failure prints the number of its case as well.
const SEED: u64 = 0x0b59_fa22;

/// Memory for one file.
const MEMORY: u64 = 64 << 20;

/// Largest file that is changed, in bytes: small ones fail in more ways a second.
const LARGEST: u64 = 40_000;

/// What numbers are replaced by.
const NUMBERS: [&str; 14] = [
    "0",
    "-1",
    "1",
    "255",
    "65536",
    "4294967295",
    "4294967296",
    "1099511627776",
    "18446744073709551615",
    "-9223372036854775808",
    "1e39",
    "1e-320",
    "0.5",
    "nan",
];

/// What text is spliced in.
const WORDS: [&str; 16] = [
    "f 1 2 3\n",
    "v nan 0 0\n",
    "vt 1\n",
    "vn 0 0 0\n",
    "o \n",
    "g a\n",
    "s 1\n",
    "usemtl m\n",
    "\\\n",
    "f -1 -2 -3 -4\n",
    "null",
    "[]",
    "{}",
    "\"POSITION\":0,",
    "\"sparse\":{},",
    "\"children\":[0],",
];

/// The small models of this repository.
fn seeds() -> Vec<(PathBuf, Vec<u8>)> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let folders = ["models", "models/malformed", "tests/import_gltf/packed"];
    let mut paths: Vec<PathBuf> = folders
        .iter()
        .flat_map(|folder| std::fs::read_dir(root.join(folder)).expect("a folder"))
        .map(|entry| entry.expect("an entry").path())
        .filter(|path| {
            let extension = path.extension().and_then(|e| e.to_str());
            let length = path.metadata().expect("its length").len();
            matches!(extension, Some("obj" | "mtl" | "gltf" | "glb")) && length <= LARGEST
        })
        .collect();
    paths.sort();
    assert!(paths.len() > 20);
    let read = |path: PathBuf| {
        let bytes = std::fs::read(&path).expect("its bytes");
        (path, bytes)
    };
    paths.into_iter().map(read).collect()
}

fn place(random: &mut Random, bytes: &[u8]) -> usize {
    random.integer(0, bytes.len() as i64) as usize
}

/// A range of at most `most` bytes.
fn range(random: &mut Random, bytes: &[u8], most: i64) -> std::ops::Range<usize> {
    let start = place(random, bytes);
    let end = start + random.integer(0, most) as usize;
    start..end.min(bytes.len())
}

/// Where runs of bytes of a kind begin and end.
fn runs(bytes: &[u8], is_part: impl Fn(u8) -> bool) -> Vec<std::ops::Range<usize>> {
    let mut runs = Vec::new();
    let mut start = None;
    for (at, &byte) in bytes.iter().chain(b"\n").enumerate() {
        match (start, at < bytes.len() && is_part(byte)) {
            (None, true) => start = Some(at),
            (Some(from), false) => {
                runs.push(from..at);
                start = None;
            }
            _ => {}
        }
    }
    runs
}

fn change(random: &mut Random, bytes: &mut Vec<u8>, other: &[u8]) {
    match random.integer(0, 7) {
        0 => bytes.truncate(place(random, bytes)),
        1 => {
            for _ in 0..random.integer(1, 8) {
                let at = place(random, bytes);
                if let Some(byte) = bytes.get_mut(at) {
                    *byte ^= 1 << random.integer(0, 7);
                }
            }
        }
        2 => {
            let at = place(random, bytes);
            let piece = other[range(random, other, 200)].to_vec();
            bytes.splice(at..at, piece);
        }
        3 => {
            let gone = range(random, bytes, 60);
            bytes.drain(gone);
        }
        4 => {
            let at = place(random, bytes);
            bytes.splice(at..at, random.pick(&WORDS).bytes());
        }
        5 | 6 => {
            let numbers = runs(bytes, |b| b.is_ascii_digit() || b"+-.".contains(&b));
            if !numbers.is_empty() {
                let chosen = numbers[random.integer(0, numbers.len() as i64 - 1) as usize].clone();
                bytes.splice(chosen, random.pick(&NUMBERS).bytes());
            }
        }
        _ => {
            let words = runs(bytes, |b| b.is_ascii_alphabetic() || b == b'_');
            if words.len() > 1 {
                let mut pick = || words[random.integer(0, words.len() as i64 - 1) as usize].clone();
                let (to, from) = (pick(), pick());
                let word = bytes[from].to_vec();
                bytes.splice(to, word);
            }
        }
    }
}

/// Makes the lengths of a GLB's first two chunks fit again, so that changes reach what is behind them.
fn mend_lengths(bytes: &mut [u8]) {
    let binary = bytes.windows(4).position(|w| w == b"BIN\0");
    let (Some(binary), true) = (binary, bytes.starts_with(b"glTF")) else {
        return;
    };
    let all = bytes.len();
    if binary >= 24 && all >= binary + 4 {
        bytes[8..12].copy_from_slice(&(all as u32).to_le_bytes());
        bytes[12..16].copy_from_slice(&(binary as u32 - 24).to_le_bytes());
        bytes[binary - 4..binary].copy_from_slice(&((all - binary - 4) as u32).to_le_bytes());
    }
}

fn try_cases(cases: std::ops::Range<u64>) {
    let seeds = seeds();
    let folder = tempfile::tempdir().expect("a folder");
    let mut scenes = 0;
    for case in cases.clone() {
        let mut random = Random::new(SEED, case);
        let mut pick = || &seeds[random.integer(0, seeds.len() as i64 - 1) as usize];
        let ((path, bytes), (_, other)) = (pick(), pick());
        let mut bytes = bytes.clone();
        for _ in 0..random.integer(1, 4) {
            change(&mut random, &mut bytes, other);
        }
        mend_lengths(&mut bytes);
        let extension = path.extension().and_then(|e| e.to_str()).unwrap_or("");
        let mut file = folder.path().join(format!("model.{extension}"));
        std::fs::write(&file, &bytes).expect("written");
        if extension == "mtl" {
            file = folder.path().join("with-mtl.obj");
            let names = ["red", "green", "white", "light", "m"];
            let uses = names
                .map(|name| format!("usemtl {name}\nf 1 2 3\n"))
                .concat();
            let text = format!("mtllib model.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\n{uses}");
            std::fs::write(&file, text).expect("written");
        }
        let options = ImportOptions {
            memory_limit: Some(MEMORY),
            crease_angle: (case % 3 == 0).then_some(40.0),
            ..ImportOptions::default()
        };
        let loaded = std::panic::catch_unwind(|| load_checked(&file, &options));
        match loaded {
            Ok(loaded) => scenes += usize::from(loaded.is_ok()),
            Err(_) => panic!(
                "case {case} of seed {SEED:#x}, made from {}",
                path.display()
            ),
        }
    }
    let count = (cases.end - cases.start) as usize;
    assert!(scenes > count / 20, "only {scenes} of {count} still load");
}

#[test]
fn changed_files_give_an_error_or_a_scene() {
    try_cases(0..3000);
}

#[test]
#[ignore = "takes minutes; run it with `cargo test --test import_hostile -- --ignored`"]
fn very_many_changed_files_give_an_error_or_a_scene() {
    try_cases(3000..300_000);
}
