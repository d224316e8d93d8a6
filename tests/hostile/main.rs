//! The wide BSP against testing everything, on scenes and rays made to break it: every set of instructions, axes and quality, one ray at a
//! time and many together. What was wrong once is in [`cases`].

mod cases;
#[path = "../support/random.rs"]
mod random;
mod rays;
mod scenes;
#[path = "../support/soup.rs"]
mod soup;

use bspray::accel::{
    Accelerator, AcceleratorKind, BspAxes, BspInstructions, BspQuality, BuildOptions, Hit,
};
use bspray::geometry::Ray;
use random::Random;
use scenes::Soup;

/// All that can be chosen of the wide tree of this quality on this machine.
fn choices(quality: BspQuality) -> Vec<BuildOptions> {
    let mut choices = Vec::new();
    for axes in BspAxes::ALL {
        for instructions in BspInstructions::ALL {
            if instructions != BspInstructions::Auto && instructions.is_available() {
                choices.push(BuildOptions {
                    quality,
                    axes,
                    instructions,
                    ..BuildOptions::default()
                });
            }
        }
    }
    choices
}

fn all_choices() -> Vec<BuildOptions> {
    BspQuality::ALL.into_iter().flat_map(choices).collect()
}

/// A name to compare hits by.
fn bits(hit: Option<Hit>) -> Option<(u32, u32, u32)> {
    hit.map(|hit| (hit.t.to_bits(), hit.instance, hit.triangle))
}

/// Where the answers to these rays differ from the truth: a ray's index, and how.
fn faults(tree: &dyn Accelerator, rays: &[Ray], truth: &[Option<Hit>]) -> Vec<(usize, String)> {
    let mut faults = Vec::new();
    let mut hits = vec![None; rays.len()];
    tree.closest_hits(rays, &mut hits);
    let mut flags = vec![true; rays.len()];
    tree.any_hits(rays, &mut flags);
    for (i, (ray, &truth)) in rays.iter().zip(truth).enumerate() {
        let mut expect = |query: &str, found: Option<Hit>| {
            if bits(found) != bits(truth) {
                faults.push((i, format!("{query}: {found:?}, truth {truth:?}")));
            }
        };
        expect("closest_hit", tree.closest_hit(ray));
        expect("closest_hits", hits[i]);
        for (query, flag) in [("any_hit", tree.any_hit(ray)), ("any_hits", flags[i])] {
            if flag != truth.is_some() {
                faults.push((i, format!("{query}: {flag}, truth {truth:?}")));
            }
        }
    }
    faults
}

/// The triangles without which the fault goes away, and what it is then.
fn reduced(soup: &Soup, options: &BuildOptions, rays: &[Ray], index: usize) -> (Soup, String) {
    let fault = |soup: &Soup| {
        let scene = scenes::scene(soup);
        let linear = AcceleratorKind::Linear.build(&scene);
        let truth: Vec<Option<Hit>> = rays.iter().map(|r| linear.closest_hit(r)).collect();
        let tree = AcceleratorKind::Bsp.build_with(&scene, options);
        let faults = faults(&*tree, rays, &truth);
        faults.into_iter().find(|(i, _)| *i == index).map(|f| f.1)
    };
    let (mut soup, mut what) = (soup.clone(), String::new());
    let mut size = soup.len() / 2;
    while size > 0 {
        let mut at = 0;
        while at < soup.len() && soup.len() > size {
            let mut fewer = soup.clone();
            fewer.drain(at..(at + size).min(soup.len()));
            match fault(&fewer) {
                Some(still) => (soup, what) = (fewer, still),
                None => at += size,
            }
        }
        size /= 2;
    }
    (soup, what)
}

/// What makes a scene of chance.
type Make = fn(&mut Random) -> Soup;

/// Scenes of these seeds, so many tiles of rays each.
fn hunt(make: Make, seeds: std::ops::Range<u64>, tiles: usize) {
    let (mut count, mut hits, mut reports) = (0, 0, Vec::new());
    for seed in seeds {
        let mut random = Random::new(0x5eed, seed);
        let soup = make(&mut random);
        let is_placed = random.integer(0, 3) == 0;
        let (scene, seen) = if is_placed {
            scenes::placed(&mut random, &soup)
        } else {
            (scenes::scene(&soup), soup.clone())
        };
        let linear = AcceleratorKind::Linear.build(&scene);
        let rays = rays::tiles(&mut random, &seen, &*linear, tiles);
        let truth: Vec<Option<Hit>> = rays.iter().map(|r| linear.closest_hit(r)).collect();
        count += rays.len();
        hits += truth.iter().flatten().count();
        for options in choices(random.pick(&BspQuality::ALL)) {
            let tree = AcceleratorKind::Bsp.build_with(&scene, &options);
            let faults = faults(&*tree, &rays, &truth);
            if let Some((index, fault)) = faults.first() {
                let tile = &rays[index / 64 * 64..][..64];
                let (few, what) = if is_placed {
                    (soup, format!("{:?}", scene.instances))
                } else {
                    reduced(&soup, &options, tile, index % 64)
                };
                let report = format!(
                    "seed {seed}, {} faults, {options:?}, ray {index}: {fault}\n  {:?}\n  {} triangles: {what}\n  {:?}",
                    faults.len(),
                    rays[*index],
                    few.len(),
                    &few[..few.len().min(4)],
                );
                eprintln!("{report}");
                reports.push(report);
                break;
            }
        }
        assert!(reports.len() < 12, "{} scenes are wrong", reports.len());
    }
    eprintln!("{count} rays, {hits} hits");
    assert!(reports.is_empty(), "{} scenes are wrong", reports.len());
    assert!(hits > count / 5, "{hits} of {count} hit");
}

#[test]
fn extreme_scenes_are_answered_as_by_testing_everything() {
    hunt(scenes::extreme, 0..40, 4);
}

#[test]
fn usual_scenes_are_answered_as_by_testing_everything() {
    hunt(scenes::usual, 0..10, 6);
}

/// A range of seeds from the environment: `HOSTILE_FIRST`, and `HOSTILE_SCENES` of about 2000 rays each, 0.1 s a scene.
fn hunt_long(make: Make) {
    let number = |name| std::env::var(name).ok().and_then(|x| x.parse().ok());
    let first = number("HOSTILE_FIRST").unwrap_or(0);
    hunt(
        make,
        first..first + number("HOSTILE_SCENES").unwrap_or(1000),
        30,
    );
}

#[test]
#[ignore = "takes as long as it is told to"]
fn many_extreme_scenes() {
    hunt_long(scenes::extreme);
}

#[test]
#[ignore = "takes as long as it is told to"]
fn many_usual_scenes() {
    hunt_long(scenes::usual);
}
