//! How the answers of two methods to the same rays lie to one another.

use crate::geometry::Ray;
use crate::render::Answer;

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
}

impl PairReport {
    /// Of the answers of methods `a` and `b` among all.
    pub(super) fn of([a, b]: [usize; 2], rays: &[Ray], answers: &[Vec<Answer>]) -> Self {
        let mut counts = [0; 4];
        let (mut ulps, mut lengths) = (Vec::new(), Vec::new());
        for (ray, (&one, &other)) in rays.iter().zip(answers[a].iter().zip(&answers[b])) {
            let agreement = Agreement::of(one, other);
            counts[agreement as usize] += 1;
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
    use crate::accel::Hit;
    use glam::Vec3;

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
    fn each_agreement_is_counted_and_depths_are_measured() {
        let nothing = Answer::Closest(None);
        let ray = Ray::new(Vec3::ZERO, Vec3::new(0.0, 3.0, 4.0));
        let next = 2.0_f32.next_up();
        let one = vec![at(2.0, 1), at(2.0, 1), nothing, at(2.0, 1), at(2.0, 1)];
        let other = vec![at(2.0, 1), at(2.0, 7), at(2.0, 1), at(next, 1), at(2.5, 1)];
        let pair = PairReport::of([0, 1], &[ray; 5], &[one, other]);
        assert_eq!(pair.counts, [1, 1, 2, 1]);
        assert_eq!(pair.different(), 4);
        // Of 1 and 2 ^ 21 steps, and of a hair and half a unit of five.
        let (ulps, lengths) = (pair.ulps.unwrap(), pair.lengths.unwrap());
        assert_eq!((ulps.median, ulps.largest), (2_097_152.0, 2_097_152.0));
        assert_eq!(lengths.largest, 2.5);
        let yes = [vec![Answer::Any(true); 5], vec![Answer::Any(true); 5]];
        let same = PairReport::of([0, 1], &[ray; 5], &yes);
        assert_eq!((same.counts, same.ulps), ([5, 0, 0, 0], None));
    }
}
