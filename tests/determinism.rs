//! The same scene, options and seed give the same pixels, bit for bit: for any number of threads, any crop, any
//! accelerator, and however the samples are split into passes.

#[path = "support/scenes.rs"]
mod scenes;

use std::path::Path;
use std::sync::atomic::{AtomicU64, Ordering};

use bspray::accel::{AcceleratorKind, TraceCounters};
use bspray::render::{
    Film, FirstHit, Integrator, LightSearch, Observer, PixelRect, PixelRenderer, PixelSum,
    RenderOptions, SkyMode, Stage, Tracer, render,
};
use bspray::scene::{AlphaMode, Camera, Image, Material, Pixels, Projection, Scene, Texture};
use glam::{Vec3, Vec4};
use scenes::{film, level, options, point_light, quad, trees};

/// Not a multiple of a tile's edge, and six tiles.
const SIZE: (u32, u32) = (75, 41);

const INTEGRATORS: [Integrator; 12] = [
    Integrator::Path {
        max_depth: 4,
        search: LightSearch::Both,
    },
    Integrator::Whitted { max_depth: 4 },
    Integrator::Direct,
    Integrator::Ao { distance: 1.5 },
    Integrator::Normals,
    Integrator::Facing,
    Integrator::Albedo,
    Integrator::Uv,
    Integrator::Id,
    Integrator::Cost,
    Integrator::Fragment,
    Integrator::BspDepth,
];

/// Everything that can be seen of a pixel, as bits.
type Bits = (Vec<u32>, Option<Vec<u32>>);

fn pixel_bits(sum: &PixelSum, first: Option<&FirstHit>) -> Bits {
    let vector = |v: Vec3| v.to_array().map(f32::to_bits);
    let mut seen = vector(sum.color).to_vec();
    seen.extend(vector(sum.backdrop));
    seen.extend([sum.alpha.to_bits(), sum.samples]);
    let first = first.map(|f| {
        let mut bits = vec![f.hit.instance, f.hit.triangle, f.material];
        let fragment = f.fragment.map(|f| [f.number, f.depth]);
        bits.extend(fragment.into_iter().flatten());
        bits.extend([f.hit.t, f.depth, f.distance, f.uv.x, f.uv.y].map(f32::to_bits));
        for v in [f.position, f.shading_normal, f.geometric_normal, f.albedo] {
            bits.extend(vector(v));
        }
        bits
    });
    (seen, first)
}

fn bits(film: &Film) -> Vec<Bits> {
    film.map(|pixel| {
        let (mut sums, first) = pixel_bits(pixel.sum, pixel.first);
        let mean = pixel.mean();
        let layers = [
            mean.direct,
            mean.indirect,
            mean.diffuse_albedo,
            mean.specular_albedo,
            mean.normal,
            pixel.variance(),
        ];
        sums.extend(layers.iter().flat_map(|v| v.to_array()).map(f32::to_bits));
        (sums, first)
    })
}

fn costs(film: &Film) -> Vec<TraceCounters> {
    film.map(|pixel| pixel.sum.cost)
}

fn lecture_objects() -> Scene {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("models/lecture-objects.gltf");
    bspray::import::load(&[path]).expect("it is a model")
}

/// Blended panes before a masked one, on a floor, with every kind of light.
fn panes() -> Scene {
    let upright = |z: f32, x: f32| {
        quad([
            Vec3::new(x - 1.0, 0.1, z),
            Vec3::new(x + 0.8, 0.1, z + 0.2),
            Vec3::new(x + 0.8, 1.9, z + 0.2),
            Vec3::new(x - 1.0, 1.9, z),
        ])
    };
    let blend = |color| Material {
        base_color: color,
        alpha_mode: AlphaMode::Blend,
        ..Material::default()
    };
    let masked = Material {
        base_color_texture: Some(bspray::scene::TextureRef::default()),
        alpha_mode: AlphaMode::Mask { cutoff: 0.5 },
        ..Material::default()
    };
    let lamp = Material {
        emissive: Vec3::new(9.0, 7.0, 3.0),
        ..Material::default()
    };
    let mut scene = scenes::scene([
        (level(0.0, [-4.0, 5.0], [-6.0, 3.0]), Material::default()),
        (upright(0.5, -0.5), blend(Vec4::new(0.9, 0.2, 0.1, 0.4))),
        (upright(-0.5, 0.3), blend(Vec4::new(0.1, 0.4, 0.9, 0.7))),
        (upright(-1.5, 2.2), masked),
        (level(3.0, [-1.0, 1.5], [-1.0, 0.2]), lamp),
    ]);
    let checker = |i: u32| {
        [
            200,
            180,
            90,
            if (i + i / 8).is_multiple_of(2) {
                0
            } else {
                255
            },
        ]
    };
    scene.images.push(Image {
        width: 8,
        height: 8,
        pixels: Some(Pixels::Rgba8((0..64).map(checker).collect())),
        ..Image::default()
    });
    scene.textures.push(Texture::default());
    scene
        .lights
        .push(point_light(Vec3::new(2.0, 2.5, 1.0), Vec3::splat(4.0)));
    scene.cameras.push(Camera {
        name: String::new(),
        position: Vec3::new(0.7, 1.6, 5.0),
        focal_point: Vec3::new(0.0, 0.8, 0.0),
        view_up: Vec3::Y,
        projection: Projection::Perspective { view_angle: 38.0 },
    });
    scene
}

/// Calls `check` with both scenes under all integrators.
fn for_all(samples: u32, check: impl Fn(&str, &Scene, &RenderOptions)) {
    for (name, scene) in [("lecture objects", lecture_objects()), ("panes", panes())] {
        for integrator in INTEGRATORS {
            let name = format!("{name}, {}", integrator.name());
            check(&name, &scene, &options(SIZE, samples, integrator));
        }
    }
}

fn on_threads<T: Send>(threads: usize, work: impl FnOnce() -> T + Send) -> T {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
    pool.expect("threads").install(work)
}

#[test]
fn the_panes_are_all_seen() {
    let (scene, options) = (panes(), options(SIZE, 1, Integrator::Direct));
    let film = film(&scene, AcceleratorKind::Bvh2, SkyMode::On, &options);
    let seen = film.map(|pixel| pixel.first.map(|f| f.hit.instance));
    for instance in [None, Some(0), Some(1), Some(2), Some(3)] {
        assert!(seen.contains(&instance), "{instance:?}");
    }
}

#[test]
fn any_number_of_threads_gives_the_same_pixels() {
    for_all(3, |name, scene, options| {
        let of = |threads| {
            on_threads(threads, || {
                film(scene, AcceleratorKind::Bvh2, SkyMode::On, options)
            })
        };
        let one = of(1);
        assert!(one.is_complete && one.samples() == 75 * 41 * 3);
        for threads in [2, 3] {
            let other = of(threads);
            assert!(bits(&one) == bits(&other), "{name}: {threads} threads");
            assert_eq!(costs(&one), costs(&other), "{name}: {threads} threads");
            assert_eq!(one.rays(), other.rays(), "{name}: {threads} threads");
        }
    });
}

#[test]
fn crops_joined_are_the_whole() {
    for_all(2, |name, scene, options| {
        let of = |window| {
            let options = RenderOptions { window, ..*options };
            film(scene, AcceleratorKind::Bvh2, SkyMode::On, &options)
        };
        let whole = of(options.window);
        let (width, height) = SIZE;
        // Cut within a tile, not at its edge.
        let left = of(PixelRect {
            width: 37,
            ..options.window
        });
        let right = of(PixelRect {
            x: 37,
            width: width - 37,
            ..options.window
        });
        let (left, right) = (bits(&left), bits(&right));
        let joined: Vec<_> = (0..height as usize)
            .flat_map(|row| [&left[row * 37..][..37], &right[row * 38..][..38]].concat())
            .collect();
        assert!(joined == bits(&whole), "{name}");
    });
}

#[test]
fn any_accelerator_gives_the_same_pixels() {
    for_all(1, |name, scene, options| {
        // It shows by how much they differ.
        if options.integrator == Integrator::Cost {
            return;
        }
        let of = |kind| bits(&film(scene, kind, SkyMode::On, options));
        let [first, others @ ..] = AcceleratorKind::ALL;
        let want = of(first);
        for kind in others {
            assert!(of(kind) == want, "{name}: {kind} is not {first}");
        }
    });
}

#[test]
fn another_seed_gives_other_pixels() {
    for_all(1, |name, scene, options| {
        let of = |seed| {
            let options = RenderOptions { seed, ..*options };
            film(scene, AcceleratorKind::Bvh2, SkyMode::On, &options)
        };
        let (a, b) = (of(0), of(1));
        let differing = bits(&a)
            .iter()
            .zip(&bits(&b))
            .filter(|(a, b)| a.0 != b.0)
            .count();
        // On a flat wall of one normal nothing differs but the edges.
        let least = match options.integrator {
            Integrator::Path { .. } | Integrator::Direct => SIZE.0 * SIZE.1 / 2,
            _ => 20,
        };
        assert!(differing >= least as usize, "{name}: {differing}");
        let firsts = |film: &Film| bits(film).into_iter().map(|b| b.1).collect::<Vec<_>>();
        assert!(firsts(&a) == firsts(&b), "{name}: first hits have no seed");
    });
}

/// The sums of the first samples of every pixel, one after the other.
fn prefix(scene: &Scene, options: &RenderOptions, samples: impl Fn(usize) -> u32) -> Vec<Vec<u32>> {
    let accelerator = AcceleratorKind::Bvh2.build(scene);
    let trees = trees(scene, options);
    let stage = Stage::new(scene, &*accelerator, Vec3::Y, SkyMode::On).with_trees(trees.as_ref());
    let camera = scene.cameras[0].frame(SIZE.0, SIZE.1).expect("a camera");
    let pixel = PixelRenderer {
        stage: &stage,
        camera: &camera,
        options,
    };
    let mut tracer = Tracer::new(&*accelerator, false);
    let one = |(index, (x, y)): (usize, (u32, u32))| {
        let mut sum = PixelSum::default();
        for sample in 0..samples(index) {
            let seen = pixel.sample(&mut tracer, x, y, sample);
            sum.color += seen.color;
            sum.alpha += seen.alpha;
            sum.backdrop += seen.backdrop;
            sum.samples += 1;
        }
        pixel_bits(&sum, None).0
    };
    options.window.pixels().enumerate().map(one).collect()
}

fn beauty(film: &Film) -> Vec<Vec<u32>> {
    film.map(|pixel| pixel_bits(pixel.sum, None).0)
}

#[test]
fn passes_add_up_to_the_first_samples_in_their_order() {
    // 5 ends within a pass, 8 with one; and more of them than a pass before had.
    for samples in [1, 5, 8] {
        for_all(samples, |name, scene, options| {
            let want = prefix(scene, options, |_| samples);
            // Rays whose steps are counted go one by one, others together.
            for (kind, counts_cost) in [
                (AcceleratorKind::Bvh2, true),
                (AcceleratorKind::Bvh2, false),
                (AcceleratorKind::Bsp, false),
            ] {
                let options = RenderOptions {
                    counts_cost,
                    ..*options
                };
                if options.integrator == Integrator::Cost && kind != AcceleratorKind::Bvh2 {
                    continue;
                }
                let film = film(scene, kind, SkyMode::On, &options);
                let name = format!("{name}, {kind}, counted {counts_cost}");
                assert!(beauty(&film) == want, "{name}: {samples} samples");
            }
        });
    }
}

/// Ends a render when so many samples are done.
struct StopAfter {
    done: AtomicU64,
    limit: u64,
}

impl Observer for StopAfter {
    fn samples_done(&self, samples: u64) {
        self.done.fetch_add(samples, Ordering::Relaxed);
    }

    fn should_stop(&self) -> bool {
        self.done.load(Ordering::Relaxed) >= self.limit
    }
}

#[test]
fn a_render_that_is_stopped_has_whole_samples_in_their_order() {
    for_all(8, |name, scene, options| {
        let accelerator = AcceleratorKind::Bvh2.build(scene);
        let trees = trees(scene, options);
        let stage =
            Stage::new(scene, &*accelerator, Vec3::Y, SkyMode::On).with_trees(trees.as_ref());
        let camera = scene.cameras[0].frame(SIZE.0, SIZE.1).expect("a camera");
        let pixels = u64::from(SIZE.0 * SIZE.1);
        let observer = StopAfter {
            done: AtomicU64::new(0),
            // In the second pass, which has all that the first has left.
            limit: pixels * 5 / 2,
        };
        let film = render(&stage, &camera, options, &observer);
        assert!(!film.is_complete, "{name}");
        let counts = film.map(|pixel| pixel.sum.samples);
        assert!(
            counts.contains(&1) && counts.contains(&8),
            "{name}: {counts:?}"
        );
        assert!(
            counts.iter().all(|n| (1..=8).contains(n)),
            "{name}: {counts:?}"
        );
        let want = prefix(scene, options, |index| counts[index]);
        assert!(beauty(&film) == want, "{name}");
    });
}
