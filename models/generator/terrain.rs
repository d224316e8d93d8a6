//! A landscape of any number of triangles: too large to be kept, made when it is wanted.
//!
//! A height field over a square grid, in metres, y up. Heights are sums of value noise of falling size, so that every triangle has a slope of its own.

use serde_json::json;

use super::gltf::glb;

/// Side of a grid's square, in metres.
const STEP: f32 = 0.5;

/// Octaves of noise; the largest has hills of 256 squares.
const OCTAVES: u32 = 8;

/// Most triangles: a GLB is smaller than 4 GiB, and a triangle with half a vertex takes 18 bytes.
pub(crate) const MOST_TRIANGLES: u32 = 200_000_000;

/// A GLB of one mesh with exactly so many triangles.
pub(crate) fn terrain(triangles: u32) -> Vec<u8> {
    // Twice as many triangles as squares; the last squares of the last row are left out.
    let columns = f64::from(triangles.div_ceil(2)).sqrt().ceil().max(1.0) as u32;
    let rows = triangles.div_ceil(2 * columns);
    let mut data = Vec::new();
    let (mut least, mut most) = ([f32::INFINITY; 3], [f32::NEG_INFINITY; 3]);
    for row in 0..=rows {
        for column in 0..=columns {
            let place = [column as f32 * STEP, height(column, row), row as f32 * STEP];
            for (axis, coordinate) in place.into_iter().enumerate() {
                least[axis] = least[axis].min(coordinate);
                most[axis] = most[axis].max(coordinate);
                data.extend(coordinate.to_le_bytes());
            }
        }
    }
    let position_bytes = data.len();
    let vertex = |column: u32, row: u32| row * (columns + 1) + column;
    let squares = (0..rows).flat_map(|row| (0..columns).map(move |column| (column, row)));
    let halves = squares.flat_map(|(c, r)| {
        let [a, b] = [vertex(c, r), vertex(c + 1, r)];
        let [d, e] = [vertex(c, r + 1), vertex(c + 1, r + 1)];
        [[a, d, e], [a, e, b]]
    });
    for index in halves.take(triangles as usize).flatten() {
        data.extend(index.to_le_bytes());
    }
    let vertices = position_bytes / 12;
    let document = json!({
        "asset": { "version": "2.0", "generator": "bspray" },
        "scene": 0,
        "scenes": [{ "nodes": [0] }],
        "nodes": [{ "mesh": 0, "name": "terrain" }],
        "meshes": [{ "name": "terrain", "primitives": [{ "attributes": { "POSITION": 0 }, "indices": 1 }] }],
        "accessors": [
            { "bufferView": 0, "componentType": 5126, "count": vertices, "type": "VEC3", "min": least, "max": most },
            { "bufferView": 1, "componentType": 5125, "count": u64::from(triangles) * 3, "type": "SCALAR" },
        ],
        "bufferViews": [
            { "buffer": 0, "byteLength": position_bytes },
            { "buffer": 0, "byteOffset": position_bytes, "byteLength": data.len() - position_bytes },
        ],
        "buffers": [{ "byteLength": data.len() }],
    });
    glb(&document.to_string(), data)
}

/// Height above the ground, in metres.
fn height(column: u32, row: u32) -> f32 {
    (0..OCTAVES).map(|octave| noise(column, row, octave)).sum()
}

/// Heights at the corners of squares of `2^octave` of the grid's, smooth between them, a seventh as high as the squares are wide.
fn noise(column: u32, row: u32, octave: u32) -> f32 {
    let side = 1 << octave;
    let share = |x: u32| {
        let t = (x % side) as f32 / side as f32;
        t * t * (3.0 - 2.0 * t)
    };
    let corner = |dx: u32, dy: u32| chance(column / side + dx, row / side + dy, octave);
    let (u, v) = (share(column), share(row));
    let along = |dy: u32| corner(0, dy) + (corner(1, dy) - corner(0, dy)) * u;
    (along(0) + (along(1) - along(0)) * v) * side as f32 * STEP / 7.0
}

/// A number in 0..1 (the finalizer of SplitMix64; Steele, Lea, Flood 2014).
fn chance(x: u32, y: u32, octave: u32) -> f32 {
    let mut z = u64::from(x) << 32 | u64::from(y);
    z = z.wrapping_add(0x9e37_79b9_7f4a_7c15_u64.wrapping_mul(u64::from(octave) + 1));
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    ((z ^ (z >> 31)) >> 40) as f32 / (1 << 24) as f32
}
