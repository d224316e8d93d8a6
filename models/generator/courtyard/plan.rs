//! The measures that parts share. Metres: x to the east, y up, z to the south; the fountain is at the origin.

/// From the middle to the axis of each arcade.
pub(super) const HALF: f64 = 5.5;

/// From the axis of one column to that of the next.
pub(super) const BAY: f64 = 2.2;

/// Bays on each side.
pub(super) const BAYS: u32 = 5;

/// Height at which the arches begin.
pub(super) const SPRING: f64 = 2.3;

/// Radius of the arches.
pub(super) const ARCH_RADIUS: f64 = 0.88;

/// Height of the arcades' walls.
pub(super) const ARCADE_TOP: f64 = 3.95;

/// How thick the arcades' walls are.
pub(super) const ARCADE_DEPTH: f64 = 0.42;

/// From the axis of an arcade to the wall behind its walk.
pub(super) const WALK: f64 = 3.2;

/// Where the roofs of the walks meet the walls.
pub(super) const ROOF_TOP: f64 = 5.35;

/// The axes of an arcade's columns, without the piers at its ends.
pub(super) fn column_axes() -> impl Iterator<Item = f64> {
    (1..BAYS).map(|i| f64::from(i) * BAY - HALF)
}

/// The middles of an arcade's bays.
pub(super) fn bay_axes() -> impl Iterator<Item = f64> {
    (0..BAYS).map(|i| (f64::from(i) + 0.5) * BAY - HALF)
}
