//! The Cornell box, as measured at <https://www.graphics.cornell.edu/online/box/data.html>, in millimetres.
//!
//! The front is open, as is each block's underside. Every face looks into the room, or out of its block. The colours are
//! the usual RGB values for the measured spectra. The camera of the original is at (278, 273, -800), looks along +z with y
//! up, and has a focal length of 35 mm over a film of 25 mm by 25 mm.

use std::fmt::Write;

/// How far the light hangs below the ceiling, so that the two do not coincide.
const LIGHT_HEIGHT: f32 = 548.3;

type Quad = [[f32; 3]; 4];

const FLOOR: &[Quad] = &[[
    [552.8, 0.0, 0.0],
    [0.0, 0.0, 0.0],
    [0.0, 0.0, 559.2],
    [549.6, 0.0, 559.2],
]];
const LIGHT: &[Quad] = &[[
    [343.0, LIGHT_HEIGHT, 227.0],
    [343.0, LIGHT_HEIGHT, 332.0],
    [213.0, LIGHT_HEIGHT, 332.0],
    [213.0, LIGHT_HEIGHT, 227.0],
]];
const CEILING: &[Quad] = &[[
    [556.0, 548.8, 0.0],
    [556.0, 548.8, 559.2],
    [0.0, 548.8, 559.2],
    [0.0, 548.8, 0.0],
]];
const BACK_WALL: &[Quad] = &[[
    [549.6, 0.0, 559.2],
    [0.0, 0.0, 559.2],
    [0.0, 548.8, 559.2],
    [556.0, 548.8, 559.2],
]];
const RIGHT_WALL: &[Quad] = &[[
    [0.0, 0.0, 559.2],
    [0.0, 0.0, 0.0],
    [0.0, 548.8, 0.0],
    [0.0, 548.8, 559.2],
]];
const LEFT_WALL: &[Quad] = &[[
    [552.8, 0.0, 0.0],
    [549.6, 0.0, 559.2],
    [556.0, 548.8, 559.2],
    [556.0, 548.8, 0.0],
]];
const SHORT_BLOCK: &[Quad] = &[
    [
        [130.0, 165.0, 65.0],
        [82.0, 165.0, 225.0],
        [240.0, 165.0, 272.0],
        [290.0, 165.0, 114.0],
    ],
    [
        [290.0, 0.0, 114.0],
        [290.0, 165.0, 114.0],
        [240.0, 165.0, 272.0],
        [240.0, 0.0, 272.0],
    ],
    [
        [130.0, 0.0, 65.0],
        [130.0, 165.0, 65.0],
        [290.0, 165.0, 114.0],
        [290.0, 0.0, 114.0],
    ],
    [
        [82.0, 0.0, 225.0],
        [82.0, 165.0, 225.0],
        [130.0, 165.0, 65.0],
        [130.0, 0.0, 65.0],
    ],
    [
        [240.0, 0.0, 272.0],
        [240.0, 165.0, 272.0],
        [82.0, 165.0, 225.0],
        [82.0, 0.0, 225.0],
    ],
];
const TALL_BLOCK: &[Quad] = &[
    [
        [423.0, 330.0, 247.0],
        [265.0, 330.0, 296.0],
        [314.0, 330.0, 456.0],
        [472.0, 330.0, 406.0],
    ],
    [
        [423.0, 0.0, 247.0],
        [423.0, 330.0, 247.0],
        [472.0, 330.0, 406.0],
        [472.0, 0.0, 406.0],
    ],
    [
        [472.0, 0.0, 406.0],
        [472.0, 330.0, 406.0],
        [314.0, 330.0, 456.0],
        [314.0, 0.0, 456.0],
    ],
    [
        [314.0, 0.0, 456.0],
        [314.0, 330.0, 456.0],
        [265.0, 330.0, 296.0],
        [265.0, 0.0, 296.0],
    ],
    [
        [265.0, 0.0, 296.0],
        [265.0, 330.0, 296.0],
        [423.0, 330.0, 247.0],
        [423.0, 0.0, 247.0],
    ],
];

/// Objects: name, material, faces.
const OBJECTS: [(&str, &str, &[Quad]); 8] = [
    ("floor", "white", FLOOR),
    ("light", "light", LIGHT),
    ("ceiling", "white", CEILING),
    ("back_wall", "white", BACK_WALL),
    ("right_wall", "green", RIGHT_WALL),
    ("left_wall", "red", LEFT_WALL),
    ("short_block", "white", SHORT_BLOCK),
    ("tall_block", "white", TALL_BLOCK),
];

/// Colours are linear; `Ke` is radiance.
pub(super) const MTL: &str = "\
# Materials of the Cornell box: linear RGB for the measured spectra.
newmtl white
Kd 0.725 0.71 0.68

newmtl red
Kd 0.63 0.065 0.05

newmtl green
Kd 0.14 0.45 0.091

newmtl light
Kd 0.78 0.78 0.78
Ke 17 12 4
";

pub(super) fn obj() -> String {
    let mut obj = String::from(
        "# The Cornell box, in millimetres, open in front (towards -z).\n\
         # Data: https://www.graphics.cornell.edu/online/box/data.html\n\
         # Camera: at 278 273 -800, looking along +z, y up, vertical field of view 39.3 degrees.\n\
         mtllib cornell-box.mtl\n",
    );
    let mut vertices = 0;
    for (name, material, quads) in OBJECTS {
        line(&mut obj, format_args!("o {name}"));
        for [x, y, z] in quads.iter().flatten() {
            line(&mut obj, format_args!("v {x} {y} {z}"));
        }
        line(&mut obj, format_args!("usemtl {material}"));
        for _ in quads {
            let v = vertices;
            line(
                &mut obj,
                format_args!("f {} {} {} {}", v + 1, v + 2, v + 3, v + 4),
            );
            vertices += 4;
        }
    }
    obj
}

fn line(text: &mut String, content: std::fmt::Arguments<'_>) {
    writeln!(text, "{content}").expect("a string takes any text");
}
