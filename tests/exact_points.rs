//! Predicates on constructed points against plain rational numbers: sides of planes, equal planes, the order of points, and the bounds of rounded positions.
//!
//! The rational side solves for coordinates by elimination, where the crate evaluates determinants. Half of the cases are near-degenerate: few different
//! numbers, neighbours of each other, planes through common points.

#[path = "support/random.rs"]
#[allow(dead_code, reason = "shared by several tests")]
mod random;

use std::cmp::Ordering;

use bspray::geometry::exact::{ExactPlane, Point, Sign};
use dashu_ratio::Relaxed;
use glam::Vec3;
use random::Random;

type Rationals = [Relaxed; 3];

fn number(x: f64) -> Relaxed {
    Relaxed::try_from(x).expect("finite")
}

fn rational(v: Vec3) -> Rationals {
    v.to_array().map(|x| number(f64::from(x)))
}

fn minus(a: &Rationals, b: &Rationals) -> Rationals {
    std::array::from_fn(|i| &a[i] - &b[i])
}

fn dot(a: &Rationals, b: &Rationals) -> Relaxed {
    &a[0] * &b[0] + &a[1] * &b[1] + &a[2] * &b[2]
}

/// The plane's equation: normal and offset.
fn equation(plane: &ExactPlane) -> (Rationals, Relaxed) {
    let [a, b, c] = plane.points().map(rational);
    let [p, q] = [minus(&b, &a), minus(&c, &a)];
    let normal: Rationals = std::array::from_fn(|i| {
        let [j, k] = [(i + 1) % 3, (i + 2) % 3];
        &p[j] * &q[k] - &p[k] * &q[j]
    });
    let offset = dot(&normal, &a);
    (normal, offset)
}

/// Gauss's elimination of three equations in three unknowns.
fn solve(planes: [&ExactPlane; 3]) -> Option<Rationals> {
    let mut rows: Vec<Vec<Relaxed>> = planes
        .iter()
        .map(|p| {
            let (n, d) = equation(p);
            n.into_iter().chain([d]).collect()
        })
        .collect();
    for column in 0..3 {
        let pivot = (column..3).find(|&r| !rows[r][column].is_zero())?;
        rows.swap(column, pivot);
        for r in 0..3 {
            if r != column {
                let factor = &rows[r][column] / &rows[column][column];
                let pivot = rows[column].clone();
                for (x, p) in rows[r].iter_mut().zip(pivot) {
                    *x = &*x - &factor * p;
                }
            }
        }
    }
    Some(std::array::from_fn(|i| &rows[i][3] / &rows[i][i]))
}

fn coordinates(point: &Point) -> Option<Rationals> {
    match point {
        Point::Explicit(p) => Some(rational(*p)),
        Point::OnLine { line, plane } => {
            let [p, q] = line.map(rational);
            let (n, d) = equation(plane);
            let t = (&d - dot(&n, &p)) / dot(&n, &minus(&q, &p));
            let along = minus(&q, &p);
            Some(std::array::from_fn(|i| &p[i] + &t * &along[i]))
        }
        Point::OfPlanes(planes) => solve(*planes),
    }
}

fn sign(x: &Relaxed) -> Sign {
    match x.cmp(&Relaxed::ZERO) {
        Ordering::Less => Sign::Negative,
        Ordering::Equal => Sign::Zero,
        Ordering::Greater => Sign::Positive,
    }
}

/// Few values, so that much coincides; or neighbours; or anything.
fn coordinate(r: &mut Random, kind: i64) -> f32 {
    match kind {
        0 => r.integer(-2, 2) as f32,
        1 => {
            let base: f32 = r.pick(&[0.1, 1.0, -3.7]);
            match r.integer(0, 2) {
                0 => base,
                1 => base.next_up(),
                _ => base.next_down(),
            }
        }
        2 => (f64::from(r.signed()) * libm::exp10(r.integer(-30, 17) as f64)) as f32,
        3 => r.integer(-3, 3) as f32 * f32::from_bits(1),
        4 => 1e4 + r.integer(-50, 50) as f32 / 1024.0,
        _ => r.signed(),
    }
}

fn vector(r: &mut Random, kind: i64) -> Vec3 {
    Vec3::from_array([0; 3].map(|_| coordinate(r, kind)))
}

/// A plane, now and then through points of the others.
fn plane(r: &mut Random, kind: i64, others: &[ExactPlane]) -> ExactPlane {
    loop {
        let points = [0; 3].map(|_| match others {
            [] => vector(r, kind),
            _ if r.integer(0, 2) > 0 => vector(r, kind),
            _ => others[r.integer(0, others.len() as i64 - 1) as usize].points()
                [r.integer(0, 2) as usize],
        });
        if let Some(plane) = ExactPlane::new(points) {
            return plane;
        }
    }
}

fn points<'a>(r: &mut Random, kind: i64, planes: &'a [ExactPlane]) -> Vec<Point<'a>> {
    let mut points = vec![Point::Explicit(vector(r, kind))];
    for plane in planes {
        let line = [
            vector(r, kind),
            planes[0].points()[r.integer(0, 2) as usize],
        ];
        let sides = line.map(|p| plane.side_of(p));
        if sides.contains(&Sign::Positive) && sides.contains(&Sign::Negative) {
            points.push(Point::OnLine { line, plane });
        }
    }
    for i in 0..3 {
        let three = [&planes[i], &planes[(i + 1) % 4], &planes[(i + 2) % 4]];
        if solve(three).is_some() {
            points.push(Point::OfPlanes(three));
        }
    }
    points
}

#[test]
fn sides_orders_and_positions_are_those_of_rational_numbers() {
    let mut zeros = [0; 3];
    let mut kinds = [0; 3];
    for case in 0..6000 {
        let mut r = Random::new(20, case);
        let kind = (case % 6) as i64;
        let mut planes = Vec::new();
        for _ in 0..5 {
            let next = plane(&mut r, kind, &planes);
            planes.push(next);
        }
        let points = points(&mut r, kind, &planes);
        for point in &points {
            let truth = coordinates(point).expect("it exists");
            let which = match point {
                Point::Explicit(_) => 0,
                Point::OnLine { .. } => 1,
                Point::OfPlanes(_) => 2,
            };
            kinds[which] += 1;
            let position = point.position();
            for (i, truth) in truth.iter().enumerate() {
                let error = number(position.point[i]) - truth;
                let bound = number(position.error);
                assert!(
                    error <= bound && -error <= bound,
                    "case {case}: {position:?}"
                );
            }
            for plane in &planes {
                let (n, d) = equation(plane);
                let want = sign(&(dot(&n, &truth) - d));
                assert_eq!(
                    point.side(plane),
                    want,
                    "case {case}: {point:?} of {plane:?}"
                );
                assert_eq!(point.integer_side(plane), want, "case {case}");
                let (normal, error) = plane.normal();
                let quick = position.certain_side(normal, error, plane.points()[0]);
                assert!(
                    quick.is_none_or(|s| s == want),
                    "case {case}: the quick side"
                );
                zeros[which] += usize::from(want == Sign::Zero);
            }
        }
        for a in &points {
            for b in &points {
                let want = coordinates(a).cmp(&coordinates(b));
                assert_eq!(a.compare(b), want, "case {case}: {a:?} and {b:?}");
            }
        }
        for a in &planes {
            for b in &planes {
                let ([n, m], [d, e]) = {
                    let ((n, d), (m, e)) = (equation(a), equation(b));
                    ([n, m], [d, e])
                };
                let cross: Rationals = std::array::from_fn(|i| {
                    let [j, k] = [(i + 1) % 3, (i + 2) % 3];
                    &n[j] * &m[k] - &n[k] * &m[j]
                });
                let parallel = cross.iter().all(Relaxed::is_zero);
                let [nn, nm] = [dot(&n, &n), dot(&n, &m)];
                // m = n (n.m / n.n), and the offsets likewise.
                let is_same = parallel && &e * &nn == &d * &nm;
                let want = if is_same { sign(&nm) } else { Sign::Zero };
                assert_eq!(a.same(b), want, "case {case}: {a:?} and {b:?}");
                let direction = cross
                    .iter()
                    .map(sign)
                    .find(|&s| s != Sign::Zero)
                    .unwrap_or(Sign::Zero);
                assert_eq!(a.direction_of_meeting(b), direction, "case {case}");
            }
        }
    }
    assert!(zeros.iter().all(|&z| z > 200), "{zeros:?} of {kinds:?}");
}
