//! Numbers and structures of Embree 4's C interface, as its manual and headers (`rtcore_*.h`) state them: layouts and constants are what the library was
//! compiled with, and any other value is misread by it.

use std::ffi::c_int;

use crate::geometry::Ray;

/// `RTC_DEVICE_PROPERTY_VERSION_MAJOR`, `_MINOR` and `_PATCH`.
pub(super) const VERSION_PARTS: [c_int; 3] = [1, 2, 3];
/// `RTC_DEVICE_PROPERTY_BACKFACE_CULLING_ENABLED`: whether the library was compiled to see front faces only.
pub(super) const CULLS_BACK_FACES: c_int = 65;

/// `RTC_SCENE_FLAG_ROBUST`: boxes and a triangle test that lose no edges.
pub(super) const ROBUST: c_int = 1 << 2;

/// `RTC_GEOMETRY_TYPE_TRIANGLE`.
pub(super) const TRIANGLES: c_int = 0;
/// `RTC_BUFFER_TYPE_INDEX`.
pub(super) const INDICES: c_int = 0;
/// `RTC_BUFFER_TYPE_VERTEX`.
pub(super) const VERTICES: c_int = 1;
/// `RTC_FORMAT_UINT3`.
pub(super) const THREE_UINTS: c_int = 0x5003;
/// `RTC_FORMAT_FLOAT3`.
pub(super) const THREE_FLOATS: c_int = 0x9003;

/// `RTC_INVALID_GEOMETRY_ID`: nothing was hit.
pub(super) const NO_GEOMETRY: u32 = u32::MAX;

/// `RTC_MAX_INSTANCE_LEVEL_COUNT` of a library with deeper instancing than anybody compiles; usually it is 1.
const INSTANCE_LEVELS: usize = 8;

/// What `rtcGetDeviceError` says, in words.
pub(super) fn error_words(code: c_int) -> &'static str {
    match code {
        0 => "no reason given",
        2 => "invalid argument",
        3 => "invalid operation",
        4 => "out of memory",
        5 => "it does not support this processor",
        6 => "cancelled",
        7 => "no graphics driver that it can use",
        _ => "unknown error",
    }
}

/// `RTCRay`. `t` is in units of the direction's length.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(16))]
pub(super) struct ForeignRay {
    origin: [f32; 3],
    /// At least 0.
    near: f32,
    direction: [f32; 3],
    time: f32,
    /// May be infinite. The hit's `t` afterwards; minus infinity after `rtcOccluded1` if there is one.
    pub(super) far: f32,
    mask: u32,
    id: u32,
    flags: u32,
}

/// `RTCRayHit`, and more room than it needs: two names for each level of instances, of which later versions write both.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(16))]
pub(super) struct ForeignRayHit {
    pub(super) ray: ForeignRay,
    normal: [f32; 3],
    uv: [f32; 2],
    pub(super) triangle: u32,
    /// [`NO_GEOMETRY`] where nothing is hit.
    pub(super) geometry: u32,
    instances: [[u32; INSTANCE_LEVELS]; 2],
}

impl ForeignRay {
    /// The ray from `near` to the end of its interval.
    pub(super) fn of(ray: &Ray, near: f32) -> Self {
        Self {
            origin: ray.origin.to_array(),
            near,
            direction: ray.direction.to_array(),
            time: 0.0,
            far: ray.interval.max,
            mask: u32::MAX,
            id: 0,
            flags: 0,
        }
    }

    /// As it has to be asked for a hit.
    pub(super) fn for_hit(self) -> ForeignRayHit {
        ForeignRayHit {
            ray: self,
            normal: [0.0; 3],
            uv: [0.0; 2],
            triangle: NO_GEOMETRY,
            geometry: NO_GEOMETRY,
            instances: [[NO_GEOMETRY; INSTANCE_LEVELS]; 2],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::mem::{align_of, offset_of, size_of};

    #[test]
    fn structures_lie_as_the_headers_have_them() {
        assert_eq!(
            (size_of::<ForeignRay>(), align_of::<ForeignRay>()),
            (48, 16)
        );
        assert_eq!(offset_of!(ForeignRay, near), 12);
        assert_eq!(offset_of!(ForeignRay, direction), 16);
        assert_eq!(offset_of!(ForeignRay, far), 32);
        assert_eq!(offset_of!(ForeignRayHit, normal), 48);
        assert_eq!(offset_of!(ForeignRayHit, triangle), 68);
        assert_eq!(offset_of!(ForeignRayHit, geometry), 72);
        assert_eq!(offset_of!(ForeignRayHit, instances), 76);
        assert!(align_of::<ForeignRayHit>() == 16 && size_of::<ForeignRayHit>() >= 96);
    }
}
