//! Round arches: the wall of a bay above its springing, and the moulding around the opening.

use super::super::shapes::{Shape, turn};
use super::solids::{Point, TEXTURE_SIZE, revolve};

/// Pieces of the half circle: with fewer, the arch nearest to the camera shows corners.
const PIECES: u32 = 24;

/// A wall with a round opening from below: `half_width` to both sides of the axis, up to `top`, the springing at y = 0, its middle
/// plane at z = 0.
pub(super) fn arch_wall(half_width: f64, top: f64, radius: f64, depth: f64) -> Shape {
    let mut shape = Shape::default();
    let (front, back) = (depth / 2.0, -depth / 2.0);
    let circle: Vec<[f64; 2]> = (0..=PIECES)
        .map(|i| {
            let (sin, cos) = turn(f64::from(i) / f64::from(PIECES) / 2.0);
            [cos, if i == PIECES { 0.0 } else { sin }]
        })
        .collect();
    // Where rays from the centre meet the wall's outline; it goes up, to the left, down.
    let outline: Vec<[f64; 2]> = circle
        .iter()
        .map(|[cos, sin]| {
            let to_side = half_width / cos.abs().max(1e-9);
            let to_top = top / sin.max(1e-9);
            let reach = to_side.min(to_top);
            [cos * reach, sin * reach]
        })
        .collect();
    let at = |[x, y]: [f64; 2], z: f64| -> Point { [x, y, z] };
    let inner = |i: usize| circle[i].map(|v| v * radius);
    for i in 0..PIECES as usize {
        let (a, b) = (inner(i), inner(i + 1));
        let (c, d) = (outline[i + 1], outline[i]);
        // The corner of the wall, where the outline turns between two rays.
        let corner = [half_width.copysign(d[0] + c[0]), top];
        let turns_here = (c[1] - d[1]).abs() > 1e-9 && (c[0] - d[0]).abs() > 1e-9;
        let mut outer = vec![d];
        outer.extend(turns_here.then_some(corner));
        outer.push(c);
        let mut ring: Vec<[f64; 2]> = vec![a];
        ring.extend(&outer);
        ring.push(b);
        let facing: Vec<Point> = ring.iter().map(|p| at(*p, front)).collect();
        shape.face(&facing);
        let behind: Vec<Point> = ring.iter().rev().map(|p| at(*p, back)).collect();
        shape.face(&behind);
        for pair in outer.windows(2) {
            let [p, q] = [pair[0], pair[1]];
            shape.face(&[at(p, front), at(p, back), at(q, back), at(q, front)]);
        }
    }
    for side in [0, PIECES as usize] {
        let (a, d) = (inner(side), outline[side]);
        let mut foot = [at(a, front), at(a, back), at(d, back), at(d, front)];
        if side > 0 {
            foot.reverse();
        }
        shape.face(&foot);
    }
    // The intrados, round: its normals look at the axis.
    let first = shape.positions.len() as u16;
    for (i, [cos, sin]) in circle.iter().enumerate() {
        let along = std::f64::consts::PI * radius * i as f64 / f64::from(PIECES);
        for z in [back, front] {
            let [x, y] = inner(i);
            shape.corner(
                [x, y, z],
                [-cos, -sin, 0.0],
                [along, z].map(|v| v / TEXTURE_SIZE),
            );
        }
    }
    for i in 0..PIECES as u16 {
        let a = first + 2 * i;
        shape.cell([a, a + 1, a + 3, a + 2]);
    }
    shape
}

/// The moulding around an arch: a half ring that stands out on both sides of a wall of `depth`, and covers the intrados a little.
pub(super) fn archivolt(radius: f64, depth: f64) -> Shape {
    let front = depth / 2.0 + 0.045;
    // Radius and the place along the axis, around the section with the wall in its middle, outer side last.
    let half = [
        [radius - 0.015, front - 0.02],
        [radius + 0.015, front],
        [radius + 0.095, front],
        [radius + 0.155, front - 0.018],
        [radius + 0.175, depth / 2.0 - 0.005],
    ];
    let mirrored = half.iter().rev().map(|[r, z]| [*r, -z]);
    let mut section: Vec<[f64; 2]> = mirrored.collect();
    section.extend(half);
    section.reverse();
    // A half turn around z, from +x over +y, so that the ring stands on its feet.
    let mut shape = revolve(&section, PIECES as u16, 0.5);
    for v in shape.positions.iter_mut().chain(&mut shape.normals) {
        let [x, y, z] = *v;
        *v = [z, x, y];
    }
    shape
}
