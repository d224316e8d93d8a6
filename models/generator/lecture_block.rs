//! The block of the lecture: an L of eight faces with one concave edge.
//!
//! Its corners in x and y are (0,0) (2,0) (2,1) (1,1) (1,2) (0,2), and z goes from 0 to 1. Faces are numbered as in the lecture.

use std::fmt::Write;

/// The outline, counter-clockwise seen from +z.
const OUTLINE: [(u8, u8); 6] = [(0, 0), (2, 0), (2, 1), (1, 1), (1, 2), (0, 2)];

/// The six sides in the lecture's order: where they are, and the outline's corner at which their edge starts.
const SIDES: [(&str, usize); 6] = [
    ("y = 2", 4),
    ("x = 0", 5),
    ("y = 1", 2),
    ("x = 1", 3),
    ("x = 2", 1),
    ("y = 0", 0),
];

pub(super) fn obj() -> String {
    let mut obj = String::from(
        "# The eight-face block of the lecture on extents and BSP trees.\n\
         # Corners counter-clockwise from outside; the caps, #7 and #8, are concave and kept whole.\n\
         o block\n",
    );
    for z in 0..2 {
        for (x, y) in OUTLINE {
            line(&mut obj, format_args!("v {x} {y} {z}"));
        }
    }
    // Vertices count from 1: 1 to 6 at z = 0, 7 to 12 at z = 1.
    let vertex = |corner: usize, z: usize| corner % 6 + 1 + 6 * z;
    for (number, (place, start)) in SIDES.into_iter().enumerate() {
        let (a, b) = (vertex(start, 0), vertex(start + 1, 0));
        line(&mut obj, format_args!("# #{}: {place}", number + 1));
        line(&mut obj, format_args!("f {a} {b} {} {}", b + 6, a + 6));
    }
    let caps: [(&str, Vec<usize>); 2] = [
        (
            "#7: z = 1, concave",
            (0..6).map(|corner| vertex(corner, 1)).collect(),
        ),
        (
            "#8: z = 0, concave",
            (0..6).rev().map(|corner| vertex(corner, 0)).collect(),
        ),
    ];
    for (comment, corners) in caps {
        let corners: Vec<String> = corners.iter().map(usize::to_string).collect();
        line(&mut obj, format_args!("# {comment}"));
        line(&mut obj, format_args!("f {}", corners.join(" ")));
    }
    obj
}

fn line(text: &mut String, content: std::fmt::Arguments<'_>) {
    writeln!(text, "{content}").expect("a string takes any text");
}
