//! A ray's vectors, read component by component.

use glam::{Vec3, Vec4};

/// The vector, and zero.
///
/// A processor hands a value that was just stored to a load only if one store wrote all of it. Rays have just been written, some in pieces of
/// 4 bytes and some of 8 or 16; a compiler that reads two components at once, as it likes to, waits until the pieces are in the cache: 10 to
/// 20 ns of the 50 to 150 ns of a ray. So they are read one by one.
#[inline(always)]
pub(in super::super) fn parts(v: &Vec3) -> Vec4 {
    // SAFETY: three references to floats.
    let [x, y, z] = unsafe {
        [
            (&raw const v.x).read_volatile(),
            (&raw const v.y).read_volatile(),
            (&raw const v.z).read_volatile(),
        ]
    };
    Vec4::new(x, y, z, 0.0)
}
