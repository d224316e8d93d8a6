//! Embree, loaded at run time. What is no Embree 4 is refused in one line, always; all else runs where the environment variable `BSPRAY_EMBREE` names a library.

#[path = "support/random.rs"]
#[allow(dead_code, reason = "each test file uses a part")]
mod random;
#[path = "support/soup.rs"]
#[allow(dead_code, reason = "each test file uses a part")]
mod soup;

use std::hint::black_box;
use std::path::Path;

use bspray::accel::{Accelerator, AcceleratorKind, Embree, EmbreeMode, EmbreeScene, Hit};
use bspray::geometry::{Interval, Ray, Triangle};
use bspray::scene::{Instance, Scene};
use glam::{DAffine3, DVec3, Vec3};

use random::Random;

/// Why this file is not loaded.
fn refusal(path: &Path) -> String {
    let error = Embree::load(path, 1).expect_err("not Embree 4");
    let words = error.to_string();
    assert!(!words.contains('\n'), "{words:?}");
    assert!(words.starts_with(&path.display().to_string()), "{words}");
    assert_eq!(
        words.matches(&path.display().to_string()).count(),
        1,
        "{words}"
    );
    words
}

#[test]
fn what_is_not_embree_is_refused_in_one_line() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("libembree4.so");
    assert!(refusal(&path).contains("o such file") || cfg!(windows));
    std::fs::write(&path, "words\n").expect("a file");
    assert!(refusal(&path).contains("is not a library that can be loaded: "));
    assert!(refusal(folder.path()).contains("is not a library that can be loaded: "));
}

/// Takes the path of a library that this very process has loaded.
#[cfg(target_os = "linux")]
#[test]
fn another_library_is_refused_by_what_it_lacks() {
    let maps = std::fs::read_to_string("/proc/self/maps").expect("Linux has it");
    let mut paths = maps
        .split_whitespace()
        .filter(|word| word.contains("/libc"));
    let libc = paths.next_back().expect("tests are linked to it");
    let words = refusal(libc.as_ref());
    assert!(
        words.ends_with("is not Embree 4: it has no function rtcNewDevice"),
        "{words}"
    );
}

/// The library, if the environment names one.
fn embree() -> Option<Embree> {
    let path = std::env::var_os("BSPRAY_EMBREE").filter(|path| !path.is_empty())?;
    Some(Embree::load(path.as_ref(), 1).expect("Embree 4"))
}

fn build(scene: &Scene, mode: EmbreeMode) -> Option<EmbreeScene> {
    Some(embree()?.build(scene, mode).expect("a scene"))
}

fn name(hit: Option<Hit>) -> Option<(u32, u32)> {
    hit.map(|hit| (hit.instance, hit.triangle))
}

#[test]
fn easy_rays_hit_what_brute_force_hits_and_denormals_stay() {
    let scene = bspray::import::load(&["models/lecture-objects.gltf".into()]).expect("a model");
    let truth = AcceleratorKind::Linear.build(&scene);
    for mode in EmbreeMode::ALL {
        let Some(tree) = build(&scene, mode) else {
            return;
        };
        let (mut random, center) = (Random::new(0, 0), scene.bounds().center());
        let (mut hits, mut others) = (0, 0);
        for _ in 0..2000 {
            let [from, to] = [10.0, 2.0]
                .map(|size| center + Vec3::from_array([0; 3].map(|_| random.signed())) * size);
            let ray = Ray::new(from, (to - from) * 0.37);
            let (want, got) = (truth.closest_hit(&ray), tree.closest_hit(&ray));
            assert_eq!(tree.any_hit(&ray), got.is_some());
            // A ray may pass an edge by chance.
            others += u32::from(name(got) != name(want));
            if let (Some(want), Some(got)) = (want, got) {
                assert!((got.t - want.t).abs() < 1e-3 * want.t, "{want:?} {got:?}");
                hits += 1;
            }
        }
        assert!(hits > 300 && others < 4, "{mode:?}: {others} of {hits}");
        let stats = tree.build_stats();
        assert_eq!(stats.triangles, scene.placed_triangles());
        assert!(stats.bytes > 40 * stats.triangles, "{stats:?}");
        assert!(tree.peak_bytes() > stats.bytes, "{stats:?}");
        assert!(black_box(f32::MIN_POSITIVE) * black_box(0.5) > 0.0);
    }
}

/// A triangle of 1 x 2 x 3, twice, the second one moved along z.
fn two_walls() -> Scene {
    let triangle = Triangle::new(
        Vec3::new(-1.0, -2.0, 3.0),
        Vec3::new(2.0, -2.0, 3.0),
        Vec3::new(0.0, 4.0, 3.0),
    );
    let mut scene = soup::scene_of(&[triangle, triangle]);
    let behind = DAffine3::from_translation(DVec3::new(0.0, 0.0, 4.0));
    scene.instances.push(Instance::new("", 0, behind));
    scene
}

#[test]
fn intervals_and_what_lies_behind_a_hit_are_kept() {
    for mode in EmbreeMode::ALL {
        let Some(tree) = build(&two_walls(), mode) else {
            return;
        };
        let ray = Ray::new(Vec3::new(0.1, 0.2, 1.0), Vec3::new(0.0, 0.0, 2.0));
        let within = |min, max| tree.closest_hit(&ray.within(Interval::new(min, max)));
        // Its tests round.
        let t = |hit: Option<Hit>| hit.map(|hit| ((1e3 * hit.t).round(), hit.instance));
        assert_eq!(t(tree.closest_hit(&ray)), Some((1e3, 0)), "{mode:?}");
        assert_eq!(t(within(1.5, f32::INFINITY)), Some((3e3, 1)));
        assert_eq!(t(within(-9.0, 1.5)), Some((1e3, 0)));
        assert_eq!(t(within(1.5, 2.5)), None);
        assert_eq!(t(within(-3.0, -1.0)), None);
        assert_eq!(t(within(2.0, 1.0)), None);
        assert_eq!(t(tree.closest_hit(&Ray::new(ray.origin, Vec3::ZERO))), None);
        // From one hit to the next, and to an end; of the pairs one may be passed over.
        let (mut rest, mut met) = (ray, Vec::new());
        while let Some(hit) = tree.closest_hit(&rest) {
            assert!(tree.any_hit(&rest) && met.len() < 4);
            met.push((1e3 * hit.t).round());
            rest = rest.behind(hit.t, (hit.instance, hit.triangle));
        }
        assert!(met.contains(&1e3) && met.contains(&3e3), "{met:?}");
        assert!(!tree.any_hit(&rest));
    }
}

#[test]
fn a_scene_of_nothing_is_never_hit_and_scenes_share_the_library() {
    let Some(embree) = embree() else {
        return;
    };
    assert!(embree.version().starts_with("4."), "{}", embree.version());
    let mode = EmbreeMode::Robust;
    let ray = Ray::new(Vec3::new(0.1, 0.2, 1.0), Vec3::Z);
    let instance = |tree: &EmbreeScene| tree.closest_hit(&ray).map(|hit| hit.instance);
    for scene in [Scene::default(), soup::scene_of(&[])] {
        let nothing = embree.build(&scene, mode).expect("a scene");
        assert_eq!(nothing.closest_hit(&ray), None);
        assert!(!nothing.any_hit(&ray));
    }
    let tree = embree.build(&two_walls(), mode).expect("a scene");
    std::thread::scope(|scope| {
        for _ in 0..4 {
            scope.spawn(|| {
                for _ in 0..50 {
                    let own = embree.build(&two_walls(), mode).expect("a scene");
                    assert_eq!(instance(&own), Some(0));
                    assert!(tree.any_hit(&ray));
                }
            });
        }
    });
    drop(embree);
    assert_eq!(instance(&tree), Some(0));
}
