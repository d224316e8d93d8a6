//! The smallest sphere around points: by pivoting, after Gärtner, "Fast and Robust Smallest Enclosing Balls", ESA 1999.
//!
//! The sphere about at most four points that touch it grows by the point that is farthest outside, until none is. The smallest sphere about
//! five points is that through the right two, three or four of them (Welzl 1991), which are few enough to try.

use glam::{DMat3, DVec3};

/// Growth of the radius that is not worth another step, as a share: a thousandth of what rounding to single precision changes.
const LEAST_GROWTH: f64 = 1e-10;

/// Steps after which the sphere is good enough: it grows with every step, and is usually done after ten.
const MOST_STEPS: usize = 1000;

/// Centre and radius.
#[derive(Clone, Copy)]
struct Ball {
    center: DVec3,
    radius: f64,
}

impl Ball {
    fn holds(&self, point: DVec3) -> bool {
        (point - self.center).length() <= self.radius * (1.0 + LEAST_GROWTH)
    }
}

/// The centre of the smallest sphere around the points; `None` without points.
pub(super) fn center(points: &[DVec3]) -> Option<DVec3> {
    let mut support = vec![*points.first()?];
    let mut ball = Ball {
        center: support[0],
        radius: 0.0,
    };
    for _ in 0..MOST_STEPS {
        let distance = |p: &DVec3| (*p - ball.center).length_squared();
        let farthest = points
            .iter()
            .copied()
            .max_by(|a, b| distance(a).total_cmp(&distance(b)))?;
        if ball.holds(farthest) {
            break;
        }
        support.push(farthest);
        let Some((next, touching)) = around_few(&support).filter(|(b, _)| b.radius > ball.radius)
        else {
            break;
        };
        (ball, support) = (next, touching);
    }
    Some(ball.center)
}

/// The smallest sphere around at most five points, and those that it goes through.
fn around_few(points: &[DVec3]) -> Option<(Ball, Vec<DVec3>)> {
    let mut best: Option<(Ball, Vec<DVec3>)> = None;
    for choice in 1_u32..1 << points.len() {
        let chosen = (0..points.len()).filter(|i| choice >> i & 1 == 1);
        let chosen: Vec<DVec3> = chosen.map(|i| points[i]).collect();
        let Some(ball) = through(&chosen) else {
            continue;
        };
        let is_smaller = best.as_ref().is_none_or(|(b, _)| ball.radius < b.radius);
        if is_smaller && points.iter().all(|&p| ball.holds(p)) {
            best = Some((ball, chosen));
        }
    }
    best
}

/// The sphere through all the points whose centre lies in the plane, line or point that they span; `None` for more than four, or where
/// they span less than they could.
fn through(points: &[DVec3]) -> Option<Ball> {
    let (&first, others) = points.split_first()?;
    let [a, b, c] = [0, 1, 2].map(|i| others.get(i).map_or(DVec3::ZERO, |&p| p - first));
    // The centre is first + q, with q . x = x . x / 2 for each difference x.
    let offset = match others.len() {
        0 => DVec3::ZERO,
        1 => a * 0.5,
        2 => {
            let normal = a.cross(b);
            let numerator = a.length_squared() * b - b.length_squared() * a;
            numerator.cross(normal) / (2.0 * normal.length_squared())
        }
        3 => {
            let rows = DMat3::from_cols(a, b, c).transpose();
            let squares = DVec3::new(a.length_squared(), b.length_squared(), c.length_squared());
            rows.inverse() * (squares * 0.5)
        }
        _ => return None,
    };
    let radius = offset.length();
    radius.is_finite().then_some(Ball {
        center: first + offset,
        radius,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn radius(points: &[DVec3]) -> f64 {
        let center = center(points).unwrap();
        let distances = points.iter().map(|p| (*p - center).length());
        distances.fold(0.0, f64::max)
    }

    #[test]
    fn two_three_and_four_points_decide() {
        let longest = [
            DVec3::ZERO,
            DVec3::new(6.0, 2.0, 3.0),
            DVec3::new(3.0, 1.0, 1.0),
        ];
        assert!((radius(&longest) - 3.5).abs() < 1e-12);
        // An acute triangle of sides 13, 14, 15: circumradius 65 / 8.
        let triangle = [
            DVec3::ZERO,
            DVec3::new(14.0, 0.0, 0.0),
            DVec3::new(5.0, 12.0, 0.0),
        ];
        assert!((radius(&triangle) - 8.125).abs() < 1e-12);
        let box_corners: Vec<DVec3> = (0..8)
            .map(|i| DVec3::new((i & 1) as f64, (i & 2) as f64, 1.5 * (i & 4) as f64 / 2.0))
            .collect();
        assert!((radius(&box_corners) - 14.0_f64.sqrt() / 2.0).abs() < 1e-12);
    }

    #[test]
    fn no_sphere_of_random_points_can_be_shrunk() {
        let mut state = 1_u64;
        let mut next = || {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            (state >> 40) as f64 / (1 << 24) as f64
        };
        for _ in 0..50 {
            let points: Vec<DVec3> = (0..60)
                .map(|_| DVec3::new(next(), 2.0 * next(), 3.0 * next()))
                .collect();
            let best = radius(&points);
            let center = center(&points).unwrap();
            // The function to be least is convex: no neighbour of the centre is better.
            for _ in 0..60 {
                let moved = center + 1e-3 * (DVec3::new(next(), next(), next()) - 0.5);
                let reach = points.iter().map(|p| (*p - moved).length());
                assert!(reach.fold(0.0, f64::max) >= best);
            }
        }
    }

    #[test]
    fn flat_straight_and_equal_points_have_spheres() {
        let line: Vec<DVec3> = (0..9)
            .map(|i| DVec3::new(1.0, 2.0, 2.0) * f64::from(i))
            .collect();
        assert!((radius(&line) - 12.0).abs() < 1e-12);
        assert!(radius(&[DVec3::ONE; 4]) <= 0.0);
        assert!(center(&[]).is_none());
    }
}
