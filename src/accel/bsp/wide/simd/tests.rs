//! Triangle tests in lanes beside their scalar twins, block by block, bit for bit.

use super::*;
use crate::accel::BspQuality;
use crate::accel::bsp::wide::tests::{rays, set};
use crate::geometry::{Double, Fast, Triangle, Watertight};

/// Every block of the tree: its address, and its triangles.
fn blocks(store: &Store) -> Vec<(*const f32, Vec<Triangle>)> {
    let reach = Reach {
        largest: 1.0,
        axes: None,
    };
    let tree = Tree::new(store, store.leaves[0], &reach);
    let mut found = Vec::new();
    for &leaf in &store.leaves {
        let mut blocks = tree.blocks(leaf);
        loop {
            let (block, count) = blocks.current();
            // SAFETY: the store's own blocks, and lanes of them.
            let triangle = |lane| unsafe { search::triangle(block, count, lane).0 };
            found.push((block, (0..count).map(triangle).collect()));
            if !blocks.advance() {
                break;
            }
        }
    }
    found
}

/// Lanes and scalar twin, for every block and some rays: how many hits.
fn compare<T: LaneTest>() -> usize {
    let tree = set(BspQuality::Default);
    let blocks = blocks(&tree.tree.store);
    let mut hits = 0;
    for instructions in Instructions::available() {
        for (number, ray) in rays().iter().enumerate().filter(|(_, r)| r.is_traceable()) {
            let scalar = T::new(ray);
            // A tenth of the blocks, others for each ray.
            for (block, triangles) in blocks.iter().skip(number % 10).step_by(10) {
                let lanes = dispatch!(
                    instructions,
                    tested::block_tested<T>(ray, *block, triangles.len())
                );
                for (lane, triangle) in triangles.iter().enumerate() {
                    let want = scalar.intersect(triangle).map(f32::to_bits);
                    assert_eq!(lanes[lane], want, "{instructions:?} {ray:?} {triangle:?}");
                    hits += usize::from(want.is_some());
                }
                assert!(lanes[triangles.len()..].iter().all(Option::is_none));
            }
        }
    }
    hits
}

#[test]
fn tests_in_lanes_have_the_bits_of_their_scalar_twins() {
    let hits = [
        compare::<Fast>(),
        compare::<Watertight>(),
        compare::<Double>(),
    ];
    assert!(hits.iter().all(|&h| h > 1000), "{hits:?}");
}
