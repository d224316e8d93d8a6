//! Watertightness: rays from inside a closed mesh, all of which must meet it. No oracle is asked, so that there can be very many.

use rayon::prelude::*;

use super::methods::{Built, Method};
use super::random::Random;
use super::results::LeakResult;
use super::statistics::Rate;
use super::sweeps::shapes::{self, Shape};
use crate::accel::Embree;
use crate::analysis::plain_scene::scene_of;
use crate::geometry::Ray;

/// Rays that are sent together; also what a thread takes at a time.
const CHUNK: u64 = 1 << 14;

/// How many times fewer rays a method gets than the default one: trees, and brute force over some 3,400 triangles.
const FEWER: [u64; 2] = [32, 4096];

/// Sends `rays` from inside a ball through the default method, and fewer through the others. `watch` is told of rays done by the default one.
pub(super) fn leaks(
    methods: &[Method],
    embree: Option<&Embree>,
    rays: u64,
    seed: u64,
    watch: &(dyn Fn(u64) + Sync),
) -> Vec<LeakResult> {
    let shape = shapes::ball(36, 48);
    let scene = scene_of(&shape.positions, &shape.triangles);
    let of_method = |&method: &Method| {
        let built = method.build(&scene, embree);
        let is_default = method == Method::DEFAULT;
        let count = match method {
            _ if is_default => rays,
            _ if method.is_brute_force() => (rays / FEWER[1]).max(100),
            _ => (rays / FEWER[0]).max(100),
        };
        let chunks = (0..count.div_ceil(CHUNK)).into_par_iter();
        let leaks = chunks.map(|chunk| {
            let sent = CHUNK.min(count - chunk * CHUNK);
            let leaks = chunk_leaks(&built, &chunk_rays(&shape, chunk, sent, seed), chunk);
            if is_default {
                watch(sent);
            }
            leaks
        });
        let leaks = leaks.sum();
        LeakResult {
            method: method.name().to_owned(),
            rays: count,
            leaks,
            rate: Rate::of(leaks, count),
        }
    };
    let is_asked = |method: &&Method| !method.needs_embree() || embree.is_some();
    methods.iter().filter(is_asked).map(of_method).collect()
}

/// Half of the rays are aimed at edges and corners.
fn chunk_rays(shape: &Shape, chunk: u64, count: u64, seed: u64) -> Vec<Ray> {
    let mut random = Random::new(seed, "leaks", chunk);
    let mut ray = |i| {
        // The ball's flat faces are all further from the middle than this.
        let origin = (random.direction() * random.unit() * 0.9).as_vec3();
        match i % 4 {
            0 => shapes::through(origin, shape.corner(&mut random)),
            1 => shapes::through(origin, shape.edge_point(&mut random)),
            _ => Ray::new(origin, random.direction().as_vec3()),
        }
    };
    (0..count).map(&mut ray).collect()
}

/// Structures are asked for closest hits in one chunk and for any hits in the next, each time together.
fn chunk_leaks(built: &Built, rays: &[Ray], chunk: u64) -> u64 {
    let Built::Structure(structure) = built else {
        return rays
            .iter()
            .filter(|r| built.closest_hit(r).is_none())
            .count() as u64;
    };
    if chunk.is_multiple_of(2) {
        let mut hits = vec![None; rays.len()];
        structure.closest_hits(rays, &mut hits);
        hits.iter().filter(|hit| hit.is_none()).count() as u64
    } else {
        let mut flags = vec![false; rays.len()];
        structure.any_hits(rays, &mut flags);
        flags.iter().filter(|flag| !**flag).count() as u64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_default_does_not_leak_and_naive_methods_do() {
        let methods = [Method::DEFAULT, Method::MollerTrumbore, Method::ObvhsBvh2];
        let found = leaks(&methods, None, 400_000, 1, &|_| ());
        assert_eq!((found[0].leaks, found[0].rays), (0, 400_000));
        assert_eq!(found[1].rays, 100);
        assert!(found[2].leaks > 20, "{found:?}");
        assert_eq!(found, leaks(&methods, None, 400_000, 1, &|_| ()));
    }
}
