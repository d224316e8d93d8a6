//! Material files: found, read line by line, and made into our materials.

use bspray::scene::{AlphaMode, Material};
use glam::{Vec3, Vec4};

use crate::setup::*;

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
