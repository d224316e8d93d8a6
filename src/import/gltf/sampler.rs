//! Values between the keyframes of an animation. glTF 2.0 specification, section 3.11 and appendix C.

use glam::{DQuat, DVec4};

/// How values between two keyframes are found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Interpolation {
    /// The earlier value.
    Step,
    /// On a line; rotations on an arc.
    Linear,
    /// On a cubic curve: each keyframe has an incoming tangent, a value and an outgoing tangent.
    CubicSpline,
}

impl Interpolation {
    pub(super) fn of(name: Option<&str>) -> Option<Self> {
        match name.unwrap_or("LINEAR") {
            "STEP" => Some(Self::Step),
            "LINEAR" => Some(Self::Linear),
            "CUBICSPLINE" => Some(Self::CubicSpline),
            _ => None,
        }
    }

    /// How many rows of values a keyframe has.
    pub(super) fn rows(self) -> usize {
        match self {
            Self::Step | Self::Linear => 1,
            Self::CubicSpline => 3,
        }
    }
}

/// A place between two keyframes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Between {
    pub(super) first: usize,
    /// The same as `first` at and beyond the ends.
    pub(super) second: usize,
    /// From 0 at the first to 1 at the second.
    pub(super) share: f64,
    /// Seconds from the first to the second.
    pub(super) span: f64,
}

/// Where `seconds` lies among the times of keyframes, which ascend and are at least one. Times before the first and after the last
/// are these.
pub(super) fn between(times: &[f32], seconds: f64) -> Between {
    let after = times.partition_point(|&t| f64::from(t) <= seconds);
    if after == 0 || after == times.len() {
        let end = after.saturating_sub(1);
        return Between {
            first: end,
            second: end,
            share: 0.0,
            span: 0.0,
        };
    }
    let (start, end) = (f64::from(times[after - 1]), f64::from(times[after]));
    Between {
        first: after - 1,
        second: after,
        share: (seconds - start) / (end - start),
        span: end - start,
    }
}

/// The numbers at a place between two keyframes, given the rows of both: one row each, or tangent, value and tangent.
pub(super) fn mix(
    interpolation: Interpolation,
    place: Between,
    first: &[Vec<f64>],
    second: &[Vec<f64>],
) -> Vec<f64> {
    let (t, span) = (place.share, place.span);
    match interpolation {
        Interpolation::Step => first[0].clone(),
        Interpolation::Linear => {
            let pairs = first[0].iter().zip(&second[0]);
            pairs.map(|(a, b)| a * (1.0 - t) + b * t).collect()
        }
        Interpolation::CubicSpline => {
            // Appendix C.5, with the incoming tangent of a keyframe in row 0, its value in row 1, the outgoing tangent in row 2.
            let (t2, t3) = (t * t, t * t * t);
            let weights = [
                2.0 * t3 - 3.0 * t2 + 1.0,
                span * (t3 - 2.0 * t2 + t),
                -2.0 * t3 + 3.0 * t2,
                span * (t3 - t2),
            ];
            (0..first[1].len())
                .map(|i| {
                    let values = [first[1][i], first[2][i], second[1][i], second[0][i]];
                    values.iter().zip(weights).map(|(v, w)| v * w).sum()
                })
                .collect()
        }
    }
}

/// A rotation (x, y, z, w) between two keyframes, `None` where it has no direction.
pub(super) fn mix_rotations(
    interpolation: Interpolation,
    place: Between,
    first: &[Vec<f64>],
    second: &[Vec<f64>],
) -> Option<[f64; 4]> {
    let unit = |v: &[f64]| DVec4::from_slice(v).try_normalize();
    let mixed = match interpolation {
        Interpolation::Linear => {
            let [a, b] = [unit(&first[0])?, unit(&second[0])?].map(DQuat::from_vec4);
            // The shorter way around, as appendix C.4 has it.
            return Some(a.slerp(b, place.share).into());
        }
        _ => mix(interpolation, place, first, second),
    };
    unit(&mixed).map(Into::into)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_beyond_the_ends_are_the_ends() {
        let times = [0.5, 1.0, 3.0];
        let place = |seconds| between(&times, seconds);
        let at = |p: Between| (p.first, p.second, p.share, p.span);
        assert_eq!(at(place(-1.0)), (0, 0, 0.0, 0.0));
        assert_eq!(at(place(0.5)), (0, 1, 0.0, 0.5));
        assert_eq!(at(place(1.5)), (1, 2, 0.25, 2.0));
        assert_eq!(at(place(3.0)), (2, 2, 0.0, 0.0));
        assert_eq!(at(place(9.0)), (2, 2, 0.0, 0.0));
        assert_eq!(at(between(&[2.0], 2.0)), (0, 0, 0.0, 0.0));
    }

    #[test]
    fn cubic_splines_follow_the_cubic_that_they_were_made_from() {
        // f(s) = s^3 - 2 s^2 + 5, from 1 s to 3 s, with its own slopes.
        let f = |s: f64| s * s * s - 2.0 * s * s + 5.0;
        let slope = |s: f64| 3.0 * s * s - 4.0 * s;
        let key = |s: f64| [vec![slope(s)], vec![f(s)], vec![slope(s)]];
        for s in [1.0, 1.25, 2.0, 2.9] {
            let place = between(&[1.0, 3.0], s);
            let found = mix(Interpolation::CubicSpline, place, &key(1.0), &key(3.0));
            assert!((found[0] - f(s)).abs() < 1e-12, "{s}: {}", found[0]);
        }
    }

    #[test]
    fn rotations_go_the_shorter_way_at_even_speed() {
        // A quarter turn about y, written with the opposite sign; a third of it is a turn by 30 degrees.
        let half = std::f64::consts::FRAC_1_SQRT_2;
        let (a, b) = ([vec![0.0, 0.0, 0.0, 1.0]], [vec![0.0, -half, 0.0, -half]]);
        let place = between(&[0.0, 3.0], 1.0);
        let found = mix_rotations(Interpolation::Linear, place, &a, &b).expect("a direction");
        let expected = DQuat::from_rotation_y(30.0_f64.to_radians());
        assert!(
            DQuat::from_array(found).abs_diff_eq(expected, 1e-12),
            "{found:?}"
        );
        let step = mix_rotations(Interpolation::Step, place, &b, &a).expect("a direction");
        assert!((step[1] + half).abs() < 1e-15);
        assert_eq!(
            mix_rotations(Interpolation::Step, place, &[vec![0.0; 4]], &a),
            None
        );
    }
}
