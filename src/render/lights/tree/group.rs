//! Emitters by groups: what the tree knows of some of them, and where it divides them.

use std::f32::consts::{FRAC_PI_2, PI};

use glam::Vec3;

use crate::geometry::Aabb;

/// How much longer than the longest of its emitters the box of a leaf is at most: those that are side by side, as the faces of one lamp, are chosen by power alone.
const COMPACT: f32 = 2.0;

/// Places at which a node may be divided along each axis.
const BINS: usize = 12;

/// An emitter, as the tree sees it.
#[derive(Clone, Copy, Debug)]
pub(in crate::render::lights) struct Source {
    pub(in crate::render::lights) bounds: Aabb,
    /// Unit normal, of either side; zero if there is none.
    pub(in crate::render::lights) normal: Vec3,
    pub(in crate::render::lights) power: f64,
}

/// Some emitters, as far as dividing them goes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Group {
    pub(super) bounds: Aabb,
    /// Length of the longest emitter's box.
    longest: f32,
    pub(super) power: f64,
    /// Unit vector of the line in the middle of the normals, and how far from it they are at most, in radians; negative without any.
    pub(super) axis: Vec3,
    pub(super) angle: f32,
}

impl Default for Group {
    fn default() -> Self {
        Self {
            bounds: Aabb::EMPTY,
            longest: 0.0,
            power: 0.0,
            axis: Vec3::ZERO,
            angle: -1.0,
        }
    }
}

impl Group {
    pub(super) fn over(sources: &[Source], ids: &[u32]) -> Self {
        let all = ids.iter().map(|&id| Self::of(&sources[id as usize]));
        all.fold(Self::default(), Self::with)
    }

    fn of(source: &Source) -> Self {
        Self {
            bounds: source.bounds,
            longest: source.bounds.diagonal(),
            power: source.power,
            axis: source.normal,
            angle: if source.normal == Vec3::ZERO {
                -1.0
            } else {
                0.0
            },
        }
    }

    fn with(self, other: Self) -> Self {
        let (axis, angle) = lines_around((self.axis, self.angle), (other.axis, other.angle));
        Self {
            bounds: self.bounds.union(other.bounds),
            longest: self.longest.max(other.longest),
            power: self.power + other.power,
            axis,
            angle,
        }
    }

    /// Whether they are side by side.
    pub(super) fn is_compact(&self) -> bool {
        self.bounds.diagonal() <= COMPACT * self.longest
    }

    /// What choosing among them costs (Conty Estévez and Kulla, equation 1): the power, times the area of the box, times the solid angle that they send light to.
    fn cost(&self) -> f64 {
        if self.angle < 0.0 {
            return 0.0;
        }
        // Light goes up to a right angle from the normals.
        let most = (self.angle + FRAC_PI_2).min(PI);
        let (s, c) = libm::sincosf(self.angle);
        let beyond =
            2.0 * most * s - libm::cosf(self.angle - 2.0 * most) - 2.0 * self.angle * s + c;
        let solid = 2.0 * PI * (1.0 - c) + FRAC_PI_2 * beyond;
        self.power * f64::from(solid) * f64::from(self.bounds.surface_area())
    }
}

/// The narrowest cone of lines around two; each is the unit vector of its middle and an angle, negative for no line.
fn lines_around((axis, angle): (Vec3, f32), (other, of_other): (Vec3, f32)) -> (Vec3, f32) {
    if of_other < 0.0 {
        return (axis, angle);
    }
    if angle < 0.0 {
        return (other, of_other);
    }
    let other = if axis.dot(other) < 0.0 { -other } else { other };
    let between = libm::acosf(axis.dot(other).min(1.0));
    if between + of_other <= angle {
        return (axis, angle);
    }
    if between + angle <= of_other {
        return (other, of_other);
    }
    let both = ((angle + between + of_other) / 2.0).min(FRAC_PI_2);
    let turned = both - angle;
    let across = (other - axis * axis.dot(other)).normalize_or_zero();
    if both >= FRAC_PI_2 || across == Vec3::ZERO {
        // All lines.
        return (axis, FRAC_PI_2);
    }
    let (s, c) = libm::sincosf(turned);
    ((axis * c + across * s).normalize(), both)
}

/// Sorts emitters into two sides, where choosing among them costs least. Gives how many are on the first, and both.
pub(super) fn divide(sources: &[Source], ids: &mut [u32]) -> (usize, [Group; 2]) {
    let center = |id: u32| sources[id as usize].bounds.center();
    let centers: Aabb = ids.iter().map(|&id| center(id)).collect();
    let bounds = ids.iter().map(|&id| sources[id as usize].bounds);
    let extent = bounds.fold(Aabb::EMPTY, Aabb::union).extent();
    let bin = |id: u32, axis: usize| {
        let share = (center(id)[axis] - centers.min[axis]) / centers.extent()[axis];
        ((share * BINS as f32) as usize).min(BINS - 1)
    };
    let mut best = None;
    let mut least = f64::INFINITY;
    for axis in (0..3).filter(|&axis| centers.extent()[axis] > 0.0) {
        let mut bins = [Group::default(); BINS];
        for &id in ids.iter() {
            let into = &mut bins[bin(id, axis)];
            *into = into.with(Group::of(&sources[id as usize]));
        }
        // Thin boxes are to be cut across.
        let shape = f64::from(extent.max_element() / extent[axis]);
        let mut below = [Group::default(); BINS];
        let mut sum = Group::default();
        for (below, bin) in below.iter_mut().zip(bins) {
            sum = sum.with(bin);
            *below = sum;
        }
        let mut above = Group::default();
        for cut in (1..BINS).rev() {
            above = above.with(bins[cut]);
            let cost = shape * (below[cut - 1].cost() + above.cost());
            if cost < least && !below[cut - 1].bounds.is_empty() && !above.bounds.is_empty() {
                least = cost;
                best = Some((axis, cut, [below[cut - 1], above]));
            }
        }
    }
    let Some((axis, cut, sides)) = best else {
        // All at one place.
        let count = ids.len() / 2;
        let (one, other) = ids.split_at(count);
        return (count, [one, other].map(|ids| Group::over(sources, ids)));
    };
    let (one, other): (Vec<u32>, Vec<u32>) = ids.iter().partition(|&&id| bin(id, axis) < cut);
    ids[..one.len()].copy_from_slice(&one);
    ids[one.len()..].copy_from_slice(&other);
    (one.len(), sides)
}

#[cfg(test)]
mod tests {
    use super::super::tests::{direction, part};
    use super::*;

    #[test]
    fn a_cone_of_lines_holds_those_that_it_was_made_of() {
        for i in 0..500 {
            let mut cone = (Vec3::ZERO, -1.0);
            let lines: Vec<Vec3> = (0..i % 9)
                .map(|k| {
                    let near = (direction(i) + direction(99 * i + k) * part(i, 7)).normalize();
                    if k % 2 == 0 { near } else { -near }
                })
                .collect();
            for line in &lines {
                cone = lines_around(cone, (*line, 0.0));
            }
            for line in &lines {
                let angle = libm::acosf(line.dot(cone.0).abs().min(1.0));
                assert!(angle <= cone.1 + 2e-3, "{angle} {cone:?}");
            }
        }
    }
}
