//! Punctual lights: those of KHR_lights_punctual, in world space.

use glam::Vec3;

/// The shape of a punctual light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LightKind {
    /// Light from one direction everywhere; its intensity is an illuminance (lux).
    Directional,
    /// Light to all sides; its intensity is in candela.
    Point,
    /// Light within a cone; its intensity is in candela. Angles are from the axis, in radians, inner below outer.
    Spot {
        /// Full intensity inside this angle.
        inner_angle: f32,
        /// No light outside this angle.
        outer_angle: f32,
    },
}

/// A light of zero size.
#[derive(Clone, Debug, PartialEq)]
pub struct Light {
    /// Name in the file, or one made from its place there.
    pub name: String,
    /// Shape.
    pub kind: LightKind,
    /// Linear colour times intensity: lux for directional lights, candela for the others.
    pub intensity: Vec3,
    /// World position; directional lights ignore it.
    pub position: Vec3,
    /// Unit vector along which the light travels, in world space; point lights ignore it.
    pub direction: Vec3,
    /// Distance at which the light has faded to nothing, in model units; `None` for the plain inverse square law.
    pub range: Option<f32>,
}
