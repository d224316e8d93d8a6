//! How the answers of two methods to the same rays lie to one another.

use crate::accel::Hit;
use crate::geometry::Ray;
use crate::geometry::tolerance::PLAUSIBLE_DEPTH;
use crate::render::Answer;
use crate::scene::Scene;

/// How two answers to one ray lie to one another.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Agreement {
    /// Bit for bit the same.
    #[default]
    Same,
    /// Two triangles at the same depth, bit for bit.
    Tie,
    /// Hits at different depths.
    OtherDepth,
    /// A hit against nothing.
    HitAgainstMiss,
}

impl Agreement {
    /// All of them, from the best to the worst: their places are the classes in pictures.
    pub const ALL: [Self; 4] = [
        Self::Same,
        Self::Tie,
        Self::OtherDepth,
        Self::HitAgainstMiss,
    ];

    /// The name in reports.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Same => "same",
            Self::Tie => "tie",
            Self::OtherDepth => "other depth",
            Self::HitAgainstMiss => "hit against miss",
        }
    }

    /// Of two answers to the same question.
    pub fn of(a: Answer, b: Answer) -> Self {
        match (a, b) {
            (Answer::Closest(Some(a)), Answer::Closest(Some(b))) => {
                if a.t.to_bits() != b.t.to_bits() {
                    Self::OtherDepth
                } else if (a.instance, a.triangle) == (b.instance, b.triangle) {
                    Self::Same
                } else {
                    Self::Tie
                }
            }
            _ if is_hit(a) == is_hit(b) => Self::Same,
            _ => Self::HitAgainstMiss,
        }
    }
}

impl Agreement {
    /// Of two answers to the same question, of which one may be in single precision: depths agree that lie no further apart than such a method's may.
    pub(super) fn in_single_precision(a: Answer, b: Answer) -> Self {
        let (Answer::Closest(Some(hit)), Answer::Closest(Some(other))) = (a, b) else {
            return Self::of(a, b);
        };
        let [t, u] = [hit.t, other.t].map(f64::from);
        if (t - u).abs() > PLAUSIBLE_DEPTH * t.abs().max(u.abs()) {
            Self::OtherDepth
        } else if (hit.instance, hit.triangle) == (other.instance, other.triangle) {
            Self::Same
        } else {
            Self::Tie
        }
    }
}

/// Whether something is hit.
pub(super) fn is_hit(answer: Answer) -> bool {
    matches!(answer, Answer::Closest(Some(_)) | Answer::Any(true))
}

/// Median and largest of some distances.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Distances {
    /// The middle one; of two in the middle the greater.
    pub median: f64,
    /// The largest one.
    pub largest: f64,
}

impl Distances {
    fn of(mut values: Vec<f64>) -> Option<Self> {
        values.sort_by(f64::total_cmp);
        Some(Self {
            median: *values.get(values.len() / 2)?,
            largest: *values.last()?,
        })
    }
}

/// Two methods on the same rays.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PairReport {
    /// Their indices.
    pub methods: [usize; 2],
    /// How many rays for each [`Agreement`].
    pub counts: [u64; 4],
    /// Between other depths, in units in the last place of `f32`: how many floats further. `None` without such.
    pub ulps: Option<Distances>,
    /// The same in model units.
    pub lengths: Option<Distances>,
    /// Between the planes of two triangles that one and the other hit, in degrees: how far apart the normals are, of which either way counts. `None` where all hits have the
    /// same names.
    pub turns: Option<Distances>,
}

impl PairReport {
    /// Of the answers of methods `a` and `b` among all.
    pub(super) fn of(
        scene: &Scene,
        [a, b]: [usize; 2],
        rays: &[Ray],
        answers: &[Vec<Answer>],
    ) -> Self {
        let mut counts = [0; 4];
        let (mut ulps, mut lengths, mut turns) = (Vec::new(), Vec::new(), Vec::new());
        for (ray, (&one, &other)) in rays.iter().zip(answers[a].iter().zip(&answers[b])) {
            let agreement = Agreement::of(one, other);
            counts[agreement as usize] += 1;
            if let (Answer::Closest(Some(one)), Answer::Closest(Some(other))) = (one, other)
                && (one.instance, one.triangle) != (other.instance, other.triangle)
            {
                turns.extend(turn(scene, one, other));
            }
            if agreement != Agreement::OtherDepth {
                continue;
            }
            if let (Answer::Closest(Some(one)), Answer::Closest(Some(other))) = (one, other) {
                ulps.push(ulps_between(one.t, other.t) as f64);
                let apart = (f64::from(one.t) - f64::from(other.t)).abs();
                lengths.push(apart * ray.direction.as_dvec3().length());
            }
        }
        Self {
            methods: [a, b],
            counts,
            ulps: Distances::of(ulps),
            lengths: Distances::of(lengths),
            turns: Distances::of(turns),
        }
    }

    /// How many rays of that kind.
    pub fn count(&self, agreement: Agreement) -> u64 {
        self.counts[agreement as usize]
    }

    /// Rays that are not answered the same.
    pub fn different(&self) -> u64 {
        self.counts[1..].iter().sum()
    }
}

/// Degrees between the planes of the triangles that were hit; `None` of triangles without area and of names that nobody has.
fn turn(scene: &Scene, one: Hit, other: Hit) -> Option<f64> {
    let normal = |hit: Hit| {
        let placed = scene.instances.get(hit.instance as usize)?;
        let mesh = scene.mesh_of(hit.instance);
        let indices = mesh.triangles.get(hit.triangle as usize)?;
        let [a, b, c] = indices.map(|i| placed.world_point(mesh.positions[i as usize]).as_dvec3());
        (b - a).cross(c - a).try_normalize()
    };
    let (n, m) = (normal(one)?, normal(other)?);
    Some(libm::atan2(n.cross(m).length(), n.dot(m).abs()).to_degrees())
}

/// How many steps from one float to the next lie between two that are no NaN. The zeros are one step apart.
fn ulps_between(a: f32, b: f32) -> u64 {
    let place = |x: f32| {
        let magnitude = i64::from(x.to_bits() & 0x7fff_ffff);
        if x.is_sign_negative() {
            -1 - magnitude
        } else {
            magnitude
        }
    };
    place(a).abs_diff(place(b))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::plain_scene::scene_of;
    use glam::{DVec3, Vec3};

    fn at(t: f32, triangle: u32) -> Answer {
        Answer::Closest(Some(Hit {
            t,
            instance: 0,
            triangle,
        }))
    }

    #[test]
    fn floats_are_counted_across_zero() {
        assert_eq!(ulps_between(1.0, 1.0_f32.next_up().next_up()), 2);
        assert_eq!(ulps_between(-1e-45, 1e-45), 3);
        assert_eq!(ulps_between(2.0, 1.0), 1 << 23);
        assert_eq!(ulps_between(0.0, -0.0), 1);
    }

    #[test]
    fn single_precision_is_not_blamed_for_its_last_digits() {
        let [near, far] = [2.0001, 2.01];
        let said = |t, triangle| Agreement::in_single_precision(at(2.0, 1), at(t, triangle));
        assert_eq!(said(near, 1), Agreement::Same);
        assert_eq!(said(near, 4), Agreement::Tie);
        assert_eq!(said(far, 1), Agreement::OtherDepth);
        let missed = Agreement::in_single_precision(at(2.0, 1), Answer::Closest(None));
        assert_eq!(missed, Agreement::HitAgainstMiss);
    }

    #[test]
    fn each_agreement_is_counted_and_depths_are_measured() {
        let nothing = Answer::Closest(None);
        let ray = Ray::new(Vec3::ZERO, Vec3::new(0.0, 3.0, 4.0));
        let next = 2.0_f32.next_up();
        let one = vec![at(2.0, 1), at(2.0, 1), nothing, at(2.0, 1), at(2.0, 1)];
        let other = vec![at(2.0, 1), at(2.0, 7), at(2.0, 1), at(next, 1), at(2.5, 1)];
        // Triangle 7 leans by 45 degrees; all others lie flat, either side up.
        let [o, x, y] = [DVec3::ZERO, DVec3::X * 2.0, DVec3::Y * 3.0];
        let mut triangles = vec![[0, 1, 2], [0, 2, 1]];
        triangles.resize(8, [0, 2, 1]);
        triangles[7] = [0, 1, 3];
        let scene = scene_of(&[o, x, y, y + DVec3::Z * 3.0], &triangles);
        let pair = PairReport::of(&scene, [0, 1], &[ray; 5], &[one, other]);
        let turns = pair.turns.unwrap();
        assert!((turns.largest - 45.0).abs() < 1e-9 && turns.median == turns.largest);
        assert_eq!(pair.counts, [1, 1, 2, 1]);
        assert_eq!(pair.different(), 4);
        // Of 1 and 2 ^ 21 steps, and of a hair and half a unit of five.
        let (ulps, lengths) = (pair.ulps.unwrap(), pair.lengths.unwrap());
        assert_eq!((ulps.median, ulps.largest), (2_097_152.0, 2_097_152.0));
        assert_eq!(lengths.largest, 2.5);
        let yes = [vec![Answer::Any(true); 5], vec![Answer::Any(true); 5]];
        let same = PairReport::of(&scene, [0, 1], &[ray; 5], &yes);
        assert_eq!(
            (same.counts, same.ulps, same.turns),
            ([5, 0, 0, 0], None, None)
        );
    }
}
