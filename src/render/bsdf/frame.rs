//! The frame in which BSDFs are written: z along the shading normal.

use glam::Vec3;

/// Three unit vectors at right angles, in world space.
#[derive(Clone, Copy, Debug)]
pub(super) struct Frame {
    tangent: Vec3,
    bitangent: Vec3,
    normal: Vec3,
}

impl Frame {
    /// Around a unit normal; the turn around it is arbitrary, since no lobe has a grain.
    pub(super) fn around(normal: Vec3) -> Self {
        let (tangent, bitangent) = normal.any_orthonormal_pair();
        Self {
            tangent,
            bitangent,
            normal,
        }
    }

    pub(super) fn to_local(self, v: Vec3) -> Vec3 {
        Vec3::new(
            v.dot(self.tangent),
            v.dot(self.bitangent),
            v.dot(self.normal),
        )
    }

    pub(super) fn to_world(self, v: Vec3) -> Vec3 {
        self.tangent * v.x + self.bitangent * v.y + self.normal * v.z
    }
}
