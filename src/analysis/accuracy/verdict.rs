//! What is wrong with an answer, and whether that counts: exact methods owe bits, others a plausible depth of the nearest triangle.

use super::{Fault, Kind, Oracle, judge};
use crate::accel::Hit;
use crate::geometry::Ray;
use crate::geometry::tolerance::{PLAUSIBLE_DEPTH, SINGLE_DOUBT};
use crate::render::Answer;

/// What exact arithmetic says of an answer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::analysis) enum Verdict {
    Right,
    /// Another triangle than the true one, at its depth as far as single precision can tell: the exact depths round to one `t`, or the triangle is the neighbour
    /// over an edge. No failure of a method that does not promise names.
    Unresolved,
    Wrong(Kind),
}

/// Judges the answer of a method that owes the exact one.
pub(in crate::analysis) fn of_exact(
    oracle: &Oracle,
    ray: &Ray,
    truth: Option<Hit>,
    answer: Answer,
) -> Verdict {
    let owed = match answer {
        Answer::Closest(_) => Answer::Closest(truth),
        Answer::Any(_) => Answer::Any(truth.is_some()),
    };
    match judge(owed, answer) {
        None => Verdict::Right,
        Some(Fault::Hole) => Verdict::Wrong(Kind::Hole),
        Some(Fault::Ghost) => Verdict::Wrong(Kind::Ghost),
        Some(Fault::WrongName) => Verdict::Wrong(Kind::WrongName),
        Some(Fault::WrongDepth) => {
            let named = |hit: Hit| oracle.hit_of(ray, hit.instance, hit.triangle);
            let is_other = match answer {
                Answer::Closest(Some(hit)) => named(hit).is_some_and(|t| differs(t, truth)),
                _ => false,
            };
            Verdict::Wrong(if is_other {
                Kind::WrongOrder
            } else {
                Kind::WrongDepth
            })
        }
    }
}

/// Judges the answer of a method that owes a plausible one.
pub(in crate::analysis) fn of_plausible(
    oracle: &Oracle,
    ray: &Ray,
    truth: Option<Hit>,
    answer: Option<Hit>,
) -> Verdict {
    let (truth, answer) = match (truth, answer) {
        (None, None) => return Verdict::Right,
        (Some(_), None) => return Verdict::Wrong(Kind::Hole),
        (None, Some(_)) => return Verdict::Wrong(Kind::Ghost),
        (Some(truth), Some(answer)) => (truth, answer),
    };
    let is_same = (answer.instance, answer.triangle) == (truth.instance, truth.triangle);
    let named = || oracle.hit_of(ray, answer.instance, answer.triangle);
    if !is_same && named().is_some_and(|t| differs(t, Some(truth))) {
        return Verdict::Wrong(Kind::WrongOrder);
    }
    if !is_plausible(oracle, ray, truth, answer) {
        return Verdict::Wrong(Kind::WrongDepth);
    }
    if is_same {
        Verdict::Right
    } else {
        Verdict::Unresolved
    }
}

fn differs(t: f32, truth: Option<Hit>) -> bool {
    truth.is_none_or(|hit| hit.t.to_bits() != t.to_bits())
}

/// Whether the depth is right but for what a test in single precision may do to it: a share of itself, and what the rounding of coordinates makes of it.
fn is_plausible(oracle: &Oracle, ray: &Ray, truth: Hit, answer: Hit) -> bool {
    let Some((ray, triangle)) = oracle.tested(ray, truth.instance, truth.triangle) else {
        return false;
    };
    let points = triangle.corners().iter().chain([&ray.origin]);
    let span = points.fold(0.0, |span: f32, p| span.max(p.abs().max_element()));
    let (t, length) = (f64::from(truth.t), ray.direction.as_dvec3().length());
    let error = PLAUSIBLE_DEPTH * t.abs() + SINGLE_DOUBT * f64::from(span) / length;
    (f64::from(answer.t) - t).abs() <= error
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::Query;
    use crate::analysis::plain_scene::scene_of;
    use crate::scene::Scene;
    use glam::{DVec3, Vec3};

    fn true_hit(oracle: &Oracle, ray: &Ray) -> Option<Hit> {
        match oracle.truth(ray, Query::Closest) {
            Answer::Closest(hit) => hit,
            Answer::Any(_) => None,
        }
    }

    /// Two triangles one behind the other, at z = 1 and 2, and a third with an edge in common with the first.
    fn walls() -> Scene {
        let at = |z| {
            [
                DVec3::new(-4.0, -3.0, z),
                DVec3::new(5.0, -3.0, z),
                DVec3::new(0.0, 6.0, z),
            ]
        };
        let [a, b, c] = at(1.0);
        let [d, e, f] = at(2.0);
        let beside = DVec3::new(9.0, 5.0, 1.0);
        scene_of(
            &[a, b, c, d, e, f, beside],
            &[[0, 1, 2], [3, 4, 5], [2, 1, 6]],
        )
    }

    #[test]
    fn plausible_methods_owe_order_and_depth_but_neither_bits_nor_neighbours() {
        let scene = walls();
        let oracle = Oracle::new(&scene);
        let ray = Ray::new(Vec3::new(0.1, 0.2, 0.0), Vec3::Z);
        let truth = true_hit(&oracle, &ray);
        let hit = |t, triangle| {
            Some(Hit {
                t,
                instance: 0,
                triangle,
            })
        };
        assert_eq!(truth, hit(1.0, 0));
        let verdict = |answer| of_plausible(&oracle, &ray, truth, answer);
        assert_eq!(verdict(hit(1.0001, 0)), Verdict::Right);
        assert_eq!(verdict(hit(1.01, 0)), Verdict::Wrong(Kind::WrongDepth));
        assert_eq!(verdict(hit(2.0, 1)), Verdict::Wrong(Kind::WrongOrder));
        assert_eq!(verdict(hit(1.0, 2)), Verdict::Unresolved);
        assert_eq!(verdict(None), Verdict::Wrong(Kind::Hole));
        let ghost = of_plausible(&oracle, &ray, None, hit(1.0, 0));
        assert_eq!(ghost, Verdict::Wrong(Kind::Ghost));
    }

    #[test]
    fn exact_methods_owe_every_bit_to_every_question() {
        let scene = walls();
        let oracle = Oracle::new(&scene);
        let ray = Ray::new(Vec3::new(0.1, 0.2, 0.0), Vec3::Z);
        let truth = true_hit(&oracle, &ray);
        let verdict = |answer| of_exact(&oracle, &ray, truth, answer);
        let closest = |t, triangle| {
            Answer::Closest(Some(Hit {
                t,
                instance: 0,
                triangle,
            }))
        };
        assert_eq!(verdict(closest(1.0, 0)), Verdict::Right);
        assert_eq!(
            verdict(closest(1.0_f32.next_up(), 0)),
            Verdict::Wrong(Kind::WrongDepth)
        );
        assert_eq!(verdict(closest(2.0, 1)), Verdict::Wrong(Kind::WrongOrder));
        assert_eq!(verdict(closest(1.0, 2)), Verdict::Wrong(Kind::WrongName));
        assert_eq!(verdict(Answer::Any(true)), Verdict::Right);
        assert_eq!(verdict(Answer::Any(false)), Verdict::Wrong(Kind::Hole));
    }
}
