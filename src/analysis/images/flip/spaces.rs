//! The colour spaces of FLIP, from linear RGB of Rec. 709 primaries: XYZ, the linear opponent space YyCxCz, and L*a*b*.
//!
//! The white of all three is that of sRGB (D65): what RGB (1, 1, 1) becomes. Formulas: CIE 15, and Zhang and Wandell 1997 for YyCxCz.

/// Linear RGB of Rec. 709 primaries and D65 (x 0.3127, y 0.3290) to XYZ: the exact solution of the primaries' equations.
const XYZ_OF_RGB: [[f64; 3]; 3] = [
    [
        10_135_552.0 / 24_577_794.0,
        8_788_810.0 / 24_577_794.0,
        4_435_075.0 / 24_577_794.0,
    ],
    [
        2_613_072.0 / 12_288_897.0,
        8_788_810.0 / 12_288_897.0,
        887_015.0 / 12_288_897.0,
    ],
    [
        1_425_312.0 / 73_733_382.0,
        8_788_810.0 / 73_733_382.0,
        70_074_185.0 / 73_733_382.0,
    ],
];

const RGB_OF_XYZ: [[f64; 3]; 3] = inverse(XYZ_OF_RGB);

/// XYZ of RGB (1, 1, 1).
const WHITE: [f64; 3] = product(XYZ_OF_RGB, [1.0; 3]);

/// Where the cube root of L*a*b* gives way to a line: (6/29)^3.
const LAB_LINE_END: f64 = 216.0 / 24_389.0;

const fn product(m: [[f64; 3]; 3], [x, y, z]: [f64; 3]) -> [f64; 3] {
    let [a, b, c] = m;
    [
        a[0] * x + a[1] * y + a[2] * z,
        b[0] * x + b[1] * y + b[2] * z,
        c[0] * x + c[1] * y + c[2] * z,
    ]
}

const fn inverse([a, b, c]: [[f64; 3]; 3]) -> [[f64; 3]; 3] {
    let [p, q, r] = [cross(b, c), cross(c, a), cross(a, b)];
    let determinant = a[0] * p[0] + a[1] * p[1] + a[2] * p[2];
    [
        [p[0] / determinant, q[0] / determinant, r[0] / determinant],
        [p[1] / determinant, q[1] / determinant, r[1] / determinant],
        [p[2] / determinant, q[2] / determinant, r[2] / determinant],
    ]
}

const fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

/// YyCxCz: lightness without the cube root, red against green, blue against yellow.
pub(super) fn opponent(rgb: [f32; 3]) -> [f64; 3] {
    let [x, y, z] = product(XYZ_OF_RGB, rgb.map(f64::from));
    let [x, y, z] = [x / WHITE[0], y / WHITE[1], z / WHITE[2]];
    [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
}

/// The inverse of [`opponent`].
pub(super) fn rgb_of_opponent([yy, cx, cz]: [f64; 3]) -> [f64; 3] {
    let y = (yy + 16.0) / 116.0;
    let xyz = [
        (y + cx / 500.0) * WHITE[0],
        y * WHITE[1],
        (y - cz / 200.0) * WHITE[2],
    ];
    product(RGB_OF_XYZ, xyz)
}

/// L*a*b* of linear RGB.
pub(super) fn lab(rgb: [f64; 3]) -> [f64; 3] {
    let xyz = product(XYZ_OF_RGB, rgb);
    let [x, y, z] = std::array::from_fn(|i| {
        let t = xyz[i] / WHITE[i];
        if t > LAB_LINE_END {
            libm::cbrt(t)
        } else {
            // The line that has the cube root's slope (29/6)^2 / 3 where they meet.
            t * (841.0 / 108.0) + 4.0 / 29.0
        }
    });
    [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn near(a: [f64; 3], b: [f64; 3], tolerance: f64) -> bool {
        a.iter().zip(b).all(|(a, b)| (a - b).abs() < tolerance)
    }

    #[test]
    fn xyz_is_that_of_the_standard_and_has_its_inverse() {
        // IEC 61966-2-1 rounds to four digits, and its white, too.
        let standard = [
            [0.4124, 0.3576, 0.1805],
            [0.2126, 0.7152, 0.0722],
            [0.0193, 0.1192, 0.9505],
        ];
        for (row, expected) in XYZ_OF_RGB.into_iter().zip(standard) {
            assert!(near(row, expected, 2e-4), "{row:?}");
        }
        let rgb = [0.1, 0.7, 0.3];
        assert!(near(
            product(RGB_OF_XYZ, product(XYZ_OF_RGB, rgb)),
            rgb,
            1e-14
        ));
        assert!(near(rgb_of_opponent(opponent([0.1, 0.7, 0.3])), rgb, 1e-7));
    }

    #[test]
    fn lab_of_white_black_and_red_is_as_published() {
        assert!(near(lab([1.0; 3]), [100.0, 0.0, 0.0], 1e-9));
        assert!(near(lab([0.0; 3]), [0.0; 3], 1e-9));
        // As every converter prints it for D65.
        assert!(near(lab([1.0, 0.0, 0.0]), [53.24, 80.09, 67.20], 0.02));
        // The line and the root meet.
        let at = |t| lab([t; 3])[0];
        assert!((at(LAB_LINE_END * (1.0 + 1e-9)) - at(LAB_LINE_END)).abs() < 1e-5);
        assert!(near(opponent([1.0; 3]), [100.0, 0.0, 0.0], 1e-9));
    }
}
