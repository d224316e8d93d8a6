//! The images that material files name, and what stands in for those that cannot be had.

use bspray::import::{ImportOptions, TextureNeeds};
use bspray::scene::{AlphaMode, Filter, OpacityChannel, Pixels, Wrap};
use glam::{Vec2, Vec3, Vec4};

use crate::setup::*;

#[test]
fn textures_are_found_decoded_and_shared() {
    let mtl = "newmtl m\nmap_Kd -s 2 3 1 -o 0.5 0.25 my Tex.png\nmap_d -clamp on mask.png\nmap_Bump -bm 0.3 bump.png\nmap_Ke MY tex.png\n\
               newmtl n\nmap_Kd my Tex.png\n";
    let obj = format!("mtllib a.mtl\n{V}usemtl m\nf 1 2 3\nusemtl n\nf 1 3 4\n");
    let (red, grey) = (png([255, 0, 0, 255]), png([9, 9, 9, 255]));
    let files: [(&str, &[u8]); 5] = [
        ("model.obj", obj.as_bytes()),
        ("a.mtl", mtl.as_bytes()),
        ("my Tex.png", &red),
        ("mask.png", &grey),
        ("bump.png", &grey),
    ];
    let scene = load_files(&files).unwrap();
    assert!(scene.notes.is_empty(), "{:?}", scene.notes);
    assert_eq!(
        scene
            .images
            .iter()
            .map(|i| (&*i.name, i.width, i.height))
            .collect::<Vec<_>>(),
        [("my Tex.png", 2, 3), ("mask.png", 2, 3), ("bump.png", 2, 3)]
    );
    assert_eq!(
        scene.images[0].pixels,
        Some(Pixels::Rgba8(vec![[255, 0, 0, 255]; 6]))
    );
    assert_eq!(scene.textures.len(), 3);
    let [m, n] = &scene.materials[..] else {
        panic!()
    };
    assert_eq!(
        m.base_color_texture.unwrap().texture,
        n.base_color_texture.unwrap().texture
    );
    // OBJ's (0, 0), our (0, 1), is looked up at OBJ's (0.5, 0.25), our (0.5, 0.75).
    assert_eq!(
        m.base_color_texture.unwrap().map(Vec2::Y),
        Vec2::new(0.5, 0.75)
    );
    assert_eq!(
        scene.textures[m.opacity.unwrap().texture.texture as usize].wrap_u,
        Wrap::ClampToEdge
    );
    assert_eq!((m.alpha_mode, m.emissive), (AlphaMode::Blend, Vec3::ONE));
    assert_eq!(m.bump.unwrap().scale, 0.3);
}

#[test]
fn images_are_read_for_what_shows_them() {
    let obj = format!("mtllib a.mtl\n{V}usemtl m\nf 1 2 3\nusemtl n\nf 1 3 4\n");
    // The colour of the first is also the mask of the second, whose own colour has an alpha therefore.
    let mtl = b"newmtl m\nmap_Kd leaf.png\nmap_Ks shine.png\nmap_Bump bump.png\nnewmtl n\nmap_Kd bark.png\nmap_d leaf.png\n";
    let read = |textures| {
        let [leaf, grey] = [png([0, 255, 0, 128]), png([9, 9, 9, 255])];
        let files: [(&str, &[u8]); 6] = [
            ("model.obj", obj.as_bytes()),
            ("a.mtl", mtl),
            ("leaf.png", &leaf),
            ("shine.png", &grey),
            ("bump.png", &grey),
            ("bark.png", &grey),
        ];
        let options = ImportOptions {
            textures,
            ..ImportOptions::default()
        };
        load_files_with(&files, &options).unwrap()
    };
    let all = read(TextureNeeds::All);
    for (needs, expected) in [
        (TextureNeeds::Alpha, &["leaf.png", "bark.png"][..]),
        (TextureNeeds::Normals, &["leaf.png", "bump.png", "bark.png"]),
        (
            TextureNeeds::All,
            &["leaf.png", "shine.png", "bump.png", "bark.png"],
        ),
    ] {
        let scene = read(needs);
        let images = scene.images.iter().filter(|i| i.pixels.is_some());
        let names: Vec<&str> = images.map(|i| &*i.name).collect();
        assert_eq!(names, expected, "{needs:?}");
        // Materials and the rest are the same.
        assert_eq!(scene.files.len(), all.files.len());
        assert_eq!(notes(&scene), notes(&all));
        for (material, whole) in scene.materials.iter().zip(&all.materials) {
            assert_eq!(material.opacity, whole.opacity);
            assert_eq!(material.base_color_texture, whole.base_color_texture);
        }
    }
}

#[test]
fn alpha_of_one_image_counts_once() {
    let obj = format!("mtllib a.mtl\n{V}usemtl m\nf 1 2 3\n");
    let mtl = b"newmtl m\nmap_Kd leaf.png\nmap_d leaf.png\n";
    for (alpha, is_separate) in [(128, false), (255, true)] {
        let leaf = png([0, 255, 0, alpha]);
        let scene = load_files(&[
            ("model.obj", obj.as_bytes()),
            ("a.mtl", mtl),
            ("leaf.png", &leaf),
        ])
        .unwrap();
        assert_eq!(scene.materials[0].alpha_mode, AlphaMode::Blend);
        assert_eq!(scene.materials[0].opacity.is_some(), is_separate);
    }
}

#[test]
fn a_checker_stands_in_for_colours_that_cannot_be_read() {
    let obj = format!(
        "mtllib a.mtl\n{V}usemtl m\nf 1 2 3\nusemtl n\nf 1 2 3\nusemtl o\nf 1 2 3\nusemtl p\nf 1 2 3\n"
    );
    let mtl = b"newmtl m\nKd 0.5 0.5 0.5\nd 0.25\nmap_Kd broken.png\nnorm missing.png\n\
        newmtl n\nKd 0 0 0\nKs 1 1 1\nmap_Kd -s 2 2 2 gone.png\n\
        newmtl o\nKd 0.5 0.5 0.5\nKe 1 1 1\nKa 9 9 9\nmap_Ke gone.png\nmap_d gone.png\n\
        newmtl p\nKd 0.5 0.5 0.5\nmap_Kd -clamp on \n";
    let scene = load_files(&[
        ("model.obj", obj.as_bytes()),
        ("a.mtl", mtl),
        ("broken.png", b"\x89PNG no"),
    ])
    .unwrap();
    let [m, n, o, p] = &scene.materials[..] else {
        panic!("{:?}", scene.materials)
    };
    // One checker, as sharp and bright as that of glTF; alpha stays.
    assert_eq!((scene.images.len(), scene.textures.len()), (1, 1));
    assert_eq!(scene.textures[0].filter, Filter::Nearest);
    assert_eq!(scene.images[0].name, "stand-in");
    let Some(Pixels::Rgba8(pixels)) = &scene.images[0].pixels else {
        panic!("no pixels")
    };
    assert_eq!(pixels[..2], [[255, 0, 255, 255], [60, 0, 60, 255]]);
    assert_eq!(m.texture_refs().count(), 1);
    assert_eq!(m.base_color, Vec4::new(1.0, 1.0, 1.0, 0.25));
    assert_eq!(n.base_color, Vec4::ONE);
    assert_eq!(
        [m, n].map(|m| m.base_color_texture.unwrap().texture),
        [0, 0]
    );
    // Where nothing of the colour is lost it stays, and an image of light that is lost leaves none.
    assert_eq!(o.base_color, Vec4::new(0.5, 0.5, 0.5, 1.0));
    assert_eq!((o.emissive, o.texture_refs().count()), (Vec3::ZERO, 0));
    assert_eq!(p.base_color, Vec4::new(0.5, 0.5, 0.5, 1.0));
    assert_eq!(p.texture_refs().count(), 0);
    let notes = notes(&scene);
    let stands_in = "the image of its colour is left out: a magenta checker stands in for it";
    for (at, words) in [
        "texture \"broken.png\": cannot be read",
        &format!("material \"m\": {stands_in}"),
        "texture \"missing.png\": is not there",
        "texture \"gone.png\": is not there",
        &format!("material \"n\": {stands_in}"),
        "texture \"\": is not there",
    ]
    .iter()
    .enumerate()
    {
        assert!(notes[at].starts_with(words), "{at}: {notes:#?}");
    }
    assert_eq!(notes.len(), 6, "{notes:#?}");
}

#[test]
fn the_channel_of_map_d_is_one_for_the_whole_image() {
    let obj = format!("mtllib a.mtl\n{V}usemtl m\nf 1 2 3\n");
    // (first texel, second texel, channel, alpha of both)
    let cases = [
        // Dark and opaque beside transparent: dark does not mean transparent.
        (
            [10, 0, 0, 255],
            [255, 0, 0, 0],
            OpacityChannel::Alpha,
            [1.0, 0.0],
        ),
        (
            [255, 9, 9, 255],
            [0, 9, 9, 255],
            OpacityChannel::Red,
            [1.0, 0.0],
        ),
    ];
    for (first, second, channel, alpha) in cases {
        let mut bytes = std::io::Cursor::new(Vec::new());
        let mut image = image::RgbaImage::from_pixel(2, 1, image::Rgba(first));
        image.put_pixel(1, 0, image::Rgba(second));
        image.write_to(&mut bytes, image::ImageFormat::Png).unwrap();
        let scene = load_files(&[
            ("model.obj", obj.as_bytes()),
            ("a.mtl", b"newmtl m\nmap_d mask.png\n"),
            ("mask.png", bytes.get_ref()),
        ])
        .unwrap();
        let opacity = scene.materials[0].opacity.unwrap();
        assert_eq!(opacity.channel, channel);
        assert_eq!(
            scene.materials[0].texture_refs().collect::<Vec<_>>(),
            [opacity.texture]
        );
        let texels = [first, second].map(|t| Vec4::from(t.map(f32::from)) / 255.0);
        assert_eq!(texels.map(|t| opacity.channel.of(t)), alpha);
    }
}

#[test]
fn a_scene_knows_the_files_it_was_read_from() {
    let obj = format!("mtllib gone.mtl\nmtllib a.mtl\n{V}usemtl m\nf 1 2 3\n");
    let mtl = b"newmtl m\nmap_Kd tex.png\nmap_Ke tex.png\nbump bump.png\nmap_d broken.png\n";
    let tex = png([255, 0, 0, 255]);
    let scene = load_files(&[
        ("model.obj", obj.as_bytes()),
        ("a.mtl", mtl),
        ("tex.png", &tex),
        ("bump.png", b"only looked for"),
        ("broken.png", b"read in vain"),
        ("unused.png", &tex),
    ])
    .unwrap();
    let names = scene.files.iter().map(|f| f.file_name().unwrap().to_str());
    let mut names: Vec<&str> = names.flatten().collect();
    assert_eq!(names[..2], ["model.obj", "a.mtl"]);
    names.sort_unstable();
    let all = ["a.mtl", "broken.png", "bump.png", "model.obj", "tex.png"];
    assert_eq!(names, all);
}

#[test]
fn maps_of_the_physical_extension_are_read_or_named() {
    // tobj leaves all of these to its caller, unread.
    let obj = format!("mtllib a.mtl\n{V}usemtl m\nf 1 2 3\n");
    let grey = png([128, 128, 128, 255]);
    let load = |mtl: &str| {
        let scene = load_files(&[
            ("model.obj", obj.as_bytes()),
            ("a.mtl", mtl.as_bytes()),
            ("a b.png", &grey),
            ("n.png", &grey),
        ])
        .unwrap();
        let notes = notes(&scene);
        (scene.materials[0].clone(), notes)
    };
    let both = "map_Pr a b.png\nmap_Pm a b.png\nnorm n.png\nPr 0.5\n";
    let (m, told) = load(&format!("newmtl m\n{both}"));
    assert!(m.metallic_roughness_texture.is_some() && m.normal_texture.is_some());
    assert_eq!((m.roughness, m.metallic), (0.5, 1.0));
    assert!(told.is_empty(), "{told:?}");
    let (m, told) = load("newmtl m\nmap_Pr a b.png\n");
    assert!(m.metallic_roughness_texture.is_some() && told.is_empty());
    let (m, told) = load("newmtl m\nmap_Pm n.png\nmap_Pr a b.png\n");
    assert!(m.metallic_roughness_texture.is_none());
    assert!(told[0].contains("map_Pr and map_Pm are left out"));
    let (_, told) = load("newmtl m\ndisp n.png\naniso 0.5\nanisor 0.25\nmap_Ks n.png\nTf 1 1 1\n");
    assert_eq!(told, ["material \"m\": disp, aniso, anisor left out"]);
}

#[test]
fn maps_of_reflection_and_normals_find_their_slots() {
    let obj = format!("mtllib a.mtl\n{V}usemtl m\nf 1 2 3\n");
    let load = |mtl: &str| {
        let (blue, grey) = (png([127, 128, 250, 255]), png([90, 90, 90, 255]));
        let files: [(&str, &[u8]); 4] = [
            ("model.obj", obj.as_bytes()),
            ("a.mtl", mtl.as_bytes()),
            ("blue.png", &blue),
            ("grey.png", &grey),
        ];
        let scene = load_files(&files).unwrap();
        (notes(&scene), scene.materials[0].clone())
    };
    let (said, m) = load("newmtl m\nKd 1 1 1\nmap_Ks grey.png\nmap_Bump -bm 0.5 blue.png\n");
    let specular = m.specular.unwrap();
    assert!(specular.color_texture.is_some());
    assert_eq!(specular.color, Vec3::splat(2.0));
    assert!(m.normal_texture.is_some() && m.bump.is_none());
    assert_eq!((m.normal_scale, said.len()), (0.5, 1));
    let (said, m) =
        load("newmtl m\nKd 0 0 0\nKs 1 1 1\nmap_Ks grey.png\nbump grey.png\nmap_Ns grey.png\n");
    assert!(m.base_color_texture.is_some() && m.metallic == 1.0);
    assert!(m.bump.is_some() && m.normal_texture.is_none());
    assert!(said[0].ends_with("map_Ns left out"), "{said:?}");
    let (_, m) = load("newmtl m\nnorm blue.png\nmap_Bump grey.png\n");
    assert!(m.bump.is_some() && m.normal_texture.is_some());
}

#[test]
fn float_images_are_textures_and_their_bad_texels_are_mended() {
    use bspray::picture::{Channel, Picture, Samples, exr};
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.exr");
    let channel = |name, v: f32| Channel::new(name, Samples::F32(vec![v, 2.5]));
    let picture = Picture::new(2, 1)
        .with_channel(channel("R", f32::NAN))
        .with_channel(channel("G", 0.5))
        .with_channel(channel("B", -1.0));
    exr::write(&path, &picture).unwrap();
    let exr = std::fs::read(path).unwrap();
    let hdr = {
        let mut bytes = std::io::Cursor::new(Vec::new());
        let image = image::Rgb32FImage::from_pixel(1, 1, image::Rgb([4.0, 0.5, 0.0]));
        image.write_to(&mut bytes, image::ImageFormat::Hdr).unwrap();
        bytes.into_inner()
    };
    let obj = format!("mtllib a.mtl\n{V}usemtl m\nf 1 2 3\n");
    let scene = load_files(&[
        ("model.obj", obj.as_bytes()),
        ("a.mtl", b"newmtl m\nmap_Kd sky.exr\nmap_Ke lamp.hdr\n"),
        ("sky.exr", &exr),
        ("lamp.hdr", &hdr),
    ])
    .unwrap();
    let pixels = |i: usize| scene.images[i].pixels.clone();
    let mended = vec![[0.0, 0.5, 0.0, 1.0], [2.5, 2.5, 2.5, 1.0]];
    assert_eq!(pixels(0), Some(Pixels::RgbaF32(mended)));
    assert_eq!(pixels(1), Some(Pixels::RgbaF32(vec![[4.0, 0.5, 0.0, 1.0]])));
    let notes = notes(&scene);
    assert_eq!(notes.len(), 1, "{notes:?}");
    assert!(notes[0].starts_with("texture \"sky.exr\": 1 texels are negative"));
}
