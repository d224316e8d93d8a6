//! What the OBJ importer owes to materials and textures.

#![allow(
    clippy::unwrap_used,
    clippy::float_cmp,
    reason = "a test may panic, and compares values that are exact by construction"
)]

use bspray::import::{self, ImportError};
use bspray::scene::{AlphaMode, Material, OpacityChannel, Pixels, Scene, Wrap};
use glam::{Vec2, Vec3, Vec4};

/// Three vertices of a right triangle with legs 2 and 1, and a fourth that makes a rectangle.
const V: &str = "v 0 0 0\nv 2 0 0\nv 2 1 0\nv 0 1 0\n";

/// Loads the first of some files; they lie in one folder.
fn load_files(files: &[(&str, &[u8])]) -> Result<Scene, ImportError> {
    let folder = tempfile::tempdir().unwrap();
    for (name, bytes) in files {
        std::fs::write(folder.path().join(name), bytes).unwrap();
    }
    let scene = import::load(&[folder.path().join(files[0].0)])?;
    for mesh in &scene.meshes {
        assert_eq!(mesh.validate(), Ok(()));
    }
    Ok(scene)
}

fn load_with_mtl(obj: &str, mtl: &str) -> Scene {
    load_files(&[("model.obj", obj.as_bytes()), ("a.mtl", mtl.as_bytes())]).unwrap()
}

/// A triangle, with a material of the MTL given.
fn material(mtl: &str) -> (Scene, Material) {
    let scene = load_with_mtl(&format!("mtllib a.mtl\n{V}usemtl m\nf 1 2 3\n"), mtl);
    let material = scene.materials[0].clone();
    (scene, material)
}

fn notes(scene: &Scene) -> Vec<String> {
    scene
        .notes
        .iter()
        .map(|n| format!("{}: {}", n.element, n.text))
        .collect()
}

fn png(rgba: [u8; 4]) -> Vec<u8> {
    let mut bytes = std::io::Cursor::new(Vec::new());
    let image = image::RgbaImage::from_pixel(2, 3, image::Rgba(rgba));
    image.write_to(&mut bytes, image::ImageFormat::Png).unwrap();
    bytes.into_inner()
}

#[test]
fn materials_are_runs_and_carry_over() {
    let text = format!(
        "mtllib a.mtl\n{V}usemtl red one\no A\nf 1 2 3 4\nusemtl blue\nusemtl red one\nf 1 2 3\nusemtl\tblue\nf 1 2 3\no B\nf 1 2 3\n"
    );
    let scene = load_with_mtl(
        &text,
        "newmtl blue\nKd 0 0 1\nnewmtl\tred one\nKd 1 0 0\nnewmtl unused\n",
    );
    assert_eq!(
        scene.materials.iter().map(|m| &*m.name).collect::<Vec<_>>(),
        ["red one", "blue"]
    );
    assert_eq!(scene.materials[1].base_color, Vec4::new(0.0, 0.0, 1.0, 1.0));
    let parts: Vec<_> = scene.meshes[0]
        .parts
        .iter()
        .map(|p| (p.first_triangle, p.triangle_count, p.material))
        .collect();
    assert_eq!(parts, [(0, 3, 0), (3, 1, 1)]);
    assert_eq!(scene.material_of(1, 0), 1);
    assert!(scene.notes.is_empty());
}

#[test]
fn missing_materials_keep_their_runs() {
    // tobj makes one model of this, without materials.
    let text =
        format!("mtllib not there.mtl\n{V}usemtl red\nf 1 2 3\nusemtl blue\nf 1 3 4\nf 1 2 4\n");
    let scene = load_files(&[("model.obj", text.as_bytes())]).unwrap();
    assert_eq!(
        scene.materials.iter().map(|m| &*m.name).collect::<Vec<_>>(),
        ["red", "blue"]
    );
    assert_eq!([0, 1, 2].map(|t| scene.material_of(0, t)), [0, 1, 1]);
    let notes = notes(&scene);
    assert_eq!(notes.len(), 3);
    assert!(
        notes[0].contains("\"not\"") && notes[2].contains("material \"red\" and 1 more"),
        "{notes:?}"
    );
}

#[test]
fn libraries_are_found_as_they_are_written() {
    let mtl = b"newmtl m\nKd 0 1 0\n";
    for line in [
        "mtllib my mat.mtl",
        "mtllib\tmy mat.mtl",
        "mtllib x.mtl a.mtl",
        "mtllib a.mtl # c",
        "mtllib A.MTL",
        "mtllib .\\a.mtl",
        "mtllib C:\\models\\a.mtl",
        "mtllib x.mtl\nmtllib a.mtl",
        "mtllib \"my mat.mtl\"",
    ] {
        let obj = format!("{line}\n{V}usemtl m\nf 1 2 3\n");
        let scene = load_files(&[
            ("model.obj", obj.as_bytes()),
            ("my mat.mtl", mtl),
            ("a.mtl", mtl),
        ])
        .unwrap();
        assert_eq!(
            scene.materials[0].base_color,
            Vec4::new(0.0, 1.0, 0.0, 1.0),
            "{line}"
        );
    }
}

#[test]
fn one_bad_line_of_an_mtl_costs_only_itself() {
    // tobj panics on the first and loses all materials for the second.
    for bad in [
        "Kd 0.8",
        "Kd spectral a.rfl",
        "Kd 1",
        "Ns",
        "illum x",
        "map_Kd",
        "d",
        "Kd a b c",
        "newmtl",
    ] {
        let (_, material) = material(&format!(
            "newmtl other\n{bad}\nnewmtl m\nKd 0.5 0.25 1\nNi 2\n"
        ));
        assert_eq!(
            (material.base_color, material.ior),
            (Vec4::new(0.5, 0.25, 1.0, 1.0), 2.0),
            "{bad}"
        );
    }
    let (scene, grey) = material("newmtl m\nKd 0.75\nNs x\n");
    assert_eq!(grey.base_color, Vec4::new(0.75, 0.75, 0.75, 1.0));
    assert!(
        scene.notes[0].to_string().contains("a.mtl: line 3: "),
        "{}",
        scene.notes[0]
    );
}

#[test]
fn phong_numbers_are_mapped() {
    let (_, m) =
        material("newmtl m\nKd 0.5 0.5 0.5\nKs 0.25 0.25 0.25\nNs 30\nNi 1.25\nillum 2\nTr 0.25\n");
    assert_eq!(
        (m.base_color.w, m.alpha_mode, m.ior),
        (0.75, AlphaMode::Blend, 1.25)
    );
    assert_eq!(m.specular.unwrap().color, Vec3::splat(0.5));
    assert!((m.roughness - (1.0_f32 / 16.0).sqrt().sqrt()).abs() < 1e-6);
    let (_, matte) = material("newmtl m\nKs 1 1 1\nillum 1\n");
    assert_eq!(matte.specular.unwrap().factor, 0.0);
    let (_, mirror) = material("newmtl m\nKd 0 0 0\nKs 0.9 0.8 0.7\nillum 3\n");
    assert_eq!(
        (mirror.metallic, mirror.base_color),
        (1.0, Vec4::new(0.9, 0.8, 0.7, 1.0))
    );
    let (_, glass) = material("newmtl m\nKd 0 0 0\nTf 0.5 1 1\nNi 1.33\nillum 7\n");
    assert_eq!((glass.transmission.unwrap().factor, glass.ior), (1.0, 1.33));
    assert_eq!(glass.base_color, Vec4::new(0.5, 1.0, 1.0, 1.0));
    let (_, physical) = material("newmtl m\nPr 0.25\nPm 1\nPc 0.5\nPcr 0.1\nPs 0.2\nKe 3 2 1\n");
    assert_eq!((physical.roughness, physical.metallic), (0.25, 1.0));
    assert_eq!(
        physical.clearcoat.map(|c| (c.factor, c.roughness)),
        Some((0.5, 0.1))
    );
    assert_eq!(
        (physical.sheen.unwrap().color, physical.emissive),
        (Vec3::splat(0.2), Vec3::new(3.0, 2.0, 1.0))
    );
    let (scene, lamp) = material("newmtl m\nKa 20 19 18\n");
    assert_eq!(
        (lamp.emissive, scene.notes.len()),
        (Vec3::new(20.0, 19.0, 18.0), 1)
    );
    let (_, plain) = material("newmtl m\nKa 1 1 1\n");
    assert_eq!(plain.emissive, Vec3::ZERO);
}

#[test]
fn every_illumination_model_has_its_material() {
    let of = |illum: u32, more: &str| {
        let mtl =
            format!("newmtl m\nKd 0.5 0.25 0.125\nKs 0.75 0.5 0.25\nNs 98\nillum {illum}\n{more}");
        material(&mtl).1
    };
    let lobe = (0.02_f32).sqrt().sqrt();
    let seen = |m: &Material| {
        let specular = m.specular.map(|s| (s.factor, s.color));
        let passes = m.transmission.map(|t| t.factor);
        (m.metallic, m.roughness, specular, passes, m.alpha_mode)
    };
    let ks = Vec3::new(0.75, 0.5, 0.25);
    let opaque = AlphaMode::Opaque;
    let highlight = (0.0, lobe, Some((1.0, 2.0 * ks)), None, opaque);
    for matt in [0, 1] {
        let expected = (0.0, lobe, Some((0.0, Vec3::ONE)), None, opaque);
        assert_eq!(seen(&of(matt, "")), expected);
    }
    for plain in [2, 4, 9, 10] {
        assert_eq!(seen(&of(plain, "")), highlight, "{plain}");
    }
    // Air to 3 reflects (2 / 4)^2: a quarter, of which the colour makes Ks.
    for mirror in [3, 8] {
        let expected = (0.0, 0.0, Some((1.0, 4.0 * ks)), None, opaque);
        assert_eq!(seen(&of(mirror, "Ni 3\n")), expected, "{mirror}");
    }
    let by_fresnel = (0.0, 0.0, Some((1.0, 2.0 * ks)), None, opaque);
    assert_eq!(seen(&of(5, "")), by_fresnel);
    for glass in [6, 7] {
        let m = of(glass, "Ni 1.25\nTf 0.5 1 1\n");
        assert_eq!(seen(&m), (0.0, 0.0, Some((1.0, ks)), Some(1.0), opaque));
        assert_eq!((m.ior, m.base_color), (1.25, Vec4::new(0.5, 1.0, 1.0, 1.0)));
        let clear = of(glass, "Ks 1 1 1\nd 0.25\n");
        assert_eq!(seen(&clear), (0.0, 0.0, None, Some(0.75), opaque));
    }
    let glass = of(4, "Ni 1.5\nd 0.25\n");
    assert_eq!(seen(&glass).3, Some(0.75));
    for pane in [of(4, "d 0.25\n"), of(9, "Ni 1.5\nd 0.25\n")] {
        assert_eq!(
            (pane.transmission, pane.alpha_mode),
            (None, AlphaMode::Blend)
        );
        assert_eq!(pane.base_color.w, 0.25);
    }
    let metal = of(3, "Ka 0.75 0.75 0.75\nKs 0.5 0.5 0.5\n");
    assert_eq!(seen(&metal), (0.75, lobe, None, None, opaque));
    assert_eq!(metal.base_color, Vec4::new(0.5, 0.25, 0.125, 1.0));
    // The extension has the last word.
    let physical = of(3, "Pr 0.5\nPm 0.25\n");
    assert_eq!((physical.roughness, physical.metallic), (0.5, 0.25));
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
fn textures_that_cannot_be_read_are_left_out() {
    let obj = format!("mtllib a.mtl\n{V}usemtl m\nf 1 2 3\n");
    let mtl = b"newmtl m\nKd 0.5 0.5 0.5\nmap_Kd broken.png\nnorm missing.png\n";
    let scene = load_files(&[
        ("model.obj", obj.as_bytes()),
        ("a.mtl", mtl),
        ("broken.png", b"\x89PNG no"),
    ])
    .unwrap();
    assert_eq!(scene.materials[0].texture_refs().count(), 0);
    assert!(scene.images.is_empty() && scene.textures.is_empty());
    let notes = notes(&scene);
    assert!(
        notes.len() == 2
            && notes[0].contains("cannot be read")
            && notes[1].contains("is not there"),
        "{notes:?}"
    );
}

#[test]
fn many_missing_libraries_of_one_name_are_one_note() {
    let lines = "mtllib gone.mtl\n".repeat(20_000);
    let scene = load_files(&[("model.obj", format!("{lines}{V}f 1 2 3\n").as_bytes())]).unwrap();
    let text = "material file \"gone.mtl\" is not there; its materials get the default";
    assert_eq!(notes(&scene), [format!("line 1 and 19999 more: {text}")]);
}

#[test]
fn many_missing_libraries_of_many_names_are_told_in_order() {
    let lines: String = (0..20_000).map(|i| format!("mtllib {i}.mtl\n")).collect();
    let scene = load_files(&[("model.obj", format!("{lines}{V}f 1 2 3\n").as_bytes())]).unwrap();
    assert_eq!(scene.notes.len(), 20_000);
    assert_eq!(scene.notes[19_999].element, "line 20000");
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
