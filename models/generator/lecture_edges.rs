//! The eleven edges of the lecture's "BSP Trees (3)" to "(9)": three polygons in the plane, as walls.
//!
//! The lecture's figure is lost. These corners give the tree that its text tells of: #1 leaves three edges behind it, #5 splits #9 alone.

use std::fmt::Write;

/// Corners of each polygon in x and y, counter-clockwise, so that normals point outwards. Edges are numbered as they come.
const POLYGONS: [&[(f32, f32)]; 3] = [
    &[(0.0, 0.0), (0.0, 4.0), (-2.0, 4.0), (-2.0, 0.0)],
    &[(5.0, 2.0), (2.0, 2.0), (3.0, 0.0)],
    &[(8.5, 4.5), (7.0, 4.0), (7.5, 1.0), (9.0, 2.0)],
];

pub(super) fn obj() -> String {
    let mut obj = String::from(
        "# The eleven edges of the lecture on extents and BSP trees, as walls from z = 0 to 1 whose fronts are outside.\n\
         o edges\n",
    );
    let line = |obj: &mut String, content: std::fmt::Arguments<'_>| {
        writeln!(obj, "{content}").expect("a string takes any text");
    };
    for (x, y) in POLYGONS.into_iter().flatten() {
        for z in 0..2 {
            line(&mut obj, format_args!("v {x} {y} {z}"));
        }
    }
    let (mut first, mut edge) = (0, 0);
    for corners in POLYGONS {
        let count = corners.len();
        for i in 0..count {
            // Vertices count from 1: below and above each corner.
            let [a, b] = [i, (i + 1) % count].map(|corner| 2 * (first + corner) + 1);
            edge += 1;
            line(&mut obj, format_args!("# #{edge}"));
            line(&mut obj, format_args!("f {a} {b} {} {}", b + 1, a + 1));
        }
        first += count;
    }
    obj
}
