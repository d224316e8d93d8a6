//! Images that claim, or unpack to, more than they are.

use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use bspray::picture::{Raster, RasterPixels, ldr};
use serde_json::{Value, json};

use crate::setup::{add, expect, load, load_in, options, triangle};

/// A PNG of one colour: deflate packs it a thousand times.
fn plain_png(side: u32) -> Vec<u8> {
    let pixels = RasterPixels::Rgb(vec![[90, 90, 90]; (side * side) as usize]);
    let raster = Raster {
        width: side,
        height: side,
        pixels,
    };
    ldr::png_bytes(&raster).expect("a PNG")
}

/// The same bytes with a header that claims another size; the checksum is right.
fn claiming(mut png: Vec<u8>, width: u32, height: u32) -> Vec<u8> {
    png[16..20].copy_from_slice(&width.to_be_bytes());
    png[20..24].copy_from_slice(&height.to_be_bytes());
    let mut crc = u32::MAX;
    for &byte in &png[12..29] {
        crc ^= u32::from(byte);
        for _ in 0..8 {
            crc = (crc >> 1) ^ (0xedb8_8320 & (crc & 1).wrapping_neg());
        }
    }
    png[29..33].copy_from_slice(&(!crc).to_be_bytes());
    png
}

/// The triangle with `count` images of the same bytes, all of which are seen.
fn with_images(image: &[u8], count: usize) -> Value {
    let mut model = triangle();
    let uri = format!("data:;base64,{}", BASE64_STANDARD.encode(image));
    add(
        &mut model,
        "buffers",
        json!({"byteLength": image.len(), "uri": uri}),
    );
    add(
        &mut model,
        "bufferViews",
        json!({"buffer": 1, "byteLength": image.len()}),
    );
    let each = |item: &dyn Fn(usize) -> Value| (0..count).map(item).collect::<Value>();
    model["images"] = each(&|_| json!({"bufferView": 1, "mimeType": "image/png"}));
    model["textures"] = each(&|n| json!({"source": n}));
    model["materials"] =
        each(&|n| json!({"pbrMetallicRoughness": {"baseColorTexture": {"index": n}}}));
    model["meshes"][0]["primitives"] =
        each(&|n| json!({"attributes": {"POSITION": 0}, "material": n}));
    model
}

fn note_of(image: &[u8]) -> String {
    let model = with_images(image, 1).to_string();
    let scene = load("model.gltf", model.as_bytes()).expect("loads without it");
    scene.notes[0].to_string()
}

#[test]
fn a_png_of_claims_alone_is_not_decoded() {
    let png = plain_png(8);
    for (width, height, words) in [
        (50_000, 50_000, "more than 2 GiB"),
        (1 << 20, 4, "more than 65536 pixels"),
        (u32::MAX, u32::MAX, "cannot be decoded"),
        (0, 8, "cannot be decoded"),
        (2000, 1900, "bytes are too few"),
    ] {
        let note = note_of(&claiming(png.clone(), width, height));
        expect(&note, &["image 0", words]);
    }
}

#[test]
fn bombs_are_charged_with_all_others_of_the_file() {
    // 12 MB of pixels become 44 with four channels, of 8 KB.
    let png = plain_png(2000);
    let two = with_images(&png, 2).to_string();
    let error = load("model.gltf", two.as_bytes()).expect_err("two are too many");
    let words = [
        "model.gltf: image 1: would take",
        "--memory-limit raises the limit",
    ];
    expect(&error, &words);
    assert!(load("model.gltf", with_images(&png, 1).to_string().as_bytes()).is_ok());
}

#[test]
fn textures_of_mtl_files_are_charged() {
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("a.png"), plain_png(2000)).expect("written");
    std::fs::write(folder.path().join("a.mtl"), "newmtl a\nmap_Kd a.png\n").expect("written");
    let obj = b"mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl a\nf 1 2 3\n";
    let within = |memory| load_in(folder.path(), "a.obj", obj, &options(memory, false));
    let error = within(20 << 20).expect_err("too large");
    expect(
        &error,
        &[
            "a.obj: texture \"a.png\": would take 42.0 MiB",
            "--memory-limit",
        ],
    );
    assert!(within(60 << 20).is_ok());
}

#[test]
fn a_ktx2_image_is_charged_before_it_is_transcoded() {
    let mut image = include_bytes!("../import_gltf/packed/etc1s.ktx2").to_vec();
    image[20..24].copy_from_slice(&16_384_u32.to_le_bytes());
    image[24..28].copy_from_slice(&16_384_u32.to_le_bytes());
    let model = with_images(&image, 1).to_string();
    let error = load("model.gltf", model.as_bytes()).expect_err("too large");
    expect(&error, &["image 0: would take 2.5 GiB", "--memory-limit"]);
}

#[cfg(unix)]
#[test]
fn files_with_holes_are_not_allocated() {
    let folder = tempfile::tempdir().expect("a folder");
    let hollow = |name: &str| {
        let file = std::fs::File::create(folder.path().join(name)).expect("created");
        // 4 TiB, which take no room.
        file.set_len(1 << 42).is_ok()
    };
    if !hollow("a.png") {
        return;
    }
    let mut model = with_images(&[], 1);
    model["images"][0] = json!({"uri": "a.png"});
    let load = |model: &Value, memory| {
        let text = model.to_string();
        load_in(
            folder.path(),
            "a.gltf",
            text.as_bytes(),
            &options(memory, false),
        )
    };
    let error = load(&model, 1 << 20).expect_err("too large");
    expect(&error, &["image 0: would take 4.0 TiB", "--memory-limit"]);
    // Without a limit the allocation itself fails, and the image is left out.
    let scene = load(&model, u64::MAX);
    let notes = scene.map(|s| s.notes[0].to_string());
    expect(&notes.expect("loads"), &["image 0", "cannot read"]);

    model["buffers"][0] = json!({"uri": "a.png", "byteLength": 1_u64 << 42});
    let error = load(&model, 1 << 20).expect_err("too large");
    expect(&error, &["buffer 0: would take 4.0 TiB"]);
    assert!(hollow("a.obj"));
    let file = folder.path().join("a.obj");
    let loaded = crate::import_contract::load_checked(&file, &options(1 << 20, false));
    expect(
        &loaded.expect_err("too large"),
        &["a.obj: file: would take 4.0 TiB"],
    );
}
