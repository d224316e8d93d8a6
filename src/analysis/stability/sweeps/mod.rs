//! The sweeps: for each parameter a scene and rays that are harder the further it goes. The one registry of them.
//!
//! A family of sweeps is one file with a list; a sweep is one entry and a function from (parameter, number of rays, random numbers) to a [`Case`].

mod aimed;
mod crowds;
mod lengths;
mod places;
mod planes;
pub(super) mod shapes;

use glam::Vec3;

use super::random::Random;
use crate::geometry::Ray;
use crate::geometry::tolerance::U32;
use crate::scene::Scene;

/// What methods are asked at one step.
pub(super) struct Case {
    pub(super) scene: Scene,
    pub(super) rays: Vec<Ray>,
    /// The mesh is closed and every ray starts inside: what meets nothing is a leak.
    pub(super) is_inside: bool,
}

/// A parameter, and what it makes hard.
#[derive(Clone, Copy, Debug)]
pub struct Sweep {
    /// The name on the command line.
    pub name: &'static str,
    /// One line about it.
    pub description: &'static str,
    /// What the parameter is.
    pub parameter: &'static str,
    /// Its unit; empty for ratios and counts.
    pub unit: &'static str,
    /// From the mildest to the hardest.
    values: fn() -> Vec<f64>,
    make: fn(f64, usize, &mut Random) -> Case,
    /// The parameter is a number of triangles: methods that may run away do their work in a child process.
    pub(super) is_crowd: bool,
    /// Only methods that take rays to object space as accelerators do; for others the question is another.
    pub(super) is_for_structures: bool,
}

impl Sweep {
    /// All of them.
    pub fn all() -> Vec<Self> {
        [
            places::SWEEPS,
            lengths::SWEEPS,
            planes::SWEEPS,
            aimed::SWEEPS,
            crowds::SWEEPS,
        ]
        .concat()
    }

    /// The sweep of this name.
    ///
    /// # Errors
    /// The names that there are.
    pub fn named(name: &str) -> Result<Self, String> {
        let all = Self::all();
        let names: Vec<_> = all.iter().map(|s| s.name).collect();
        let error = format!("no sweep {name:?}; there are {}", names.join(", "));
        all.into_iter().find(|s| s.name == name).ok_or(error)
    }

    /// The steps, from the mildest to the hardest.
    pub fn values(&self) -> Vec<f64> {
        (self.values)()
    }

    /// What is asked at a step. Crowds get fewer rays the larger they are, but eight at least.
    pub(super) fn case(&self, value: f64, rays: usize, seed: u64) -> Case {
        let rays = if self.is_crowd {
            rays.min(((rays * 256) as f64 / value) as usize).max(8)
        } else {
            rays
        };
        (self.make)(
            value,
            rays,
            &mut Random::new(seed, self.name, value.to_bits()),
        )
    }
}

/// What every entry has unless it says otherwise.
const PLAIN: Sweep = Sweep {
    name: "",
    description: "",
    parameter: "",
    unit: "",
    values: Vec::new,
    make: |_, _, _| unreachable!("every sweep has its own"),
    is_crowd: false,
    is_for_structures: false,
};

/// `steps + 1` powers of ten, their exponents evenly from `first` to `last`.
fn powers(first: f64, last: f64, steps: u32) -> Vec<f64> {
    let exponent = |i: u32| first + (last - first) * f64::from(i) / f64::from(steps);
    (0..=steps).map(|i| libm::pow(10.0, exponent(i))).collect()
}

/// Distances in ulps, down to none.
fn ulps() -> Vec<f64> {
    let mut ulps: Vec<f64> = (0..12).rev().map(|i| f64::from(1 << i)).collect();
    ulps.push(0.0);
    ulps
}

/// The float so many steps above (or below) `x`, which is finite.
fn moved(x: f32, steps: f64) -> f32 {
    // Consecutive integers for consecutive floats, zero only once.
    let bits = x.to_bits();
    let magnitude = i64::from(bits & 0x7fff_ffff);
    let key = if x.is_sign_negative() {
        -magnitude
    } else {
        magnitude
    } + steps as i64;
    let magnitude = f32::from_bits(key.unsigned_abs() as u32);
    if key < 0 { -magnitude } else { magnitude }
}

/// Each coordinate moved by up to so many ulps of the floats below 1, which is the size of what the sweeps over ulps aim at. (Those of the
/// coordinate itself would be nothing at all where it is 0.)
fn shaken(point: Vec3, ulps: f64, random: &mut Random) -> Vec3 {
    let ulp = f64::from(U32);
    let mut shake = |x: f32| (f64::from(x) + (random.signed() * ulps).round() * ulp) as f32;
    Vec3::from_array(point.to_array().map(&mut shake))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_sweep_has_twelve_steps_and_a_name_of_its_own_and_repeats() {
        let all = Sweep::all();
        assert!(all.len() >= 24);
        for (i, sweep) in all.iter().enumerate() {
            assert!(
                all[..i].iter().all(|s| s.name != sweep.name),
                "{}",
                sweep.name
            );
            let values = sweep.values();
            assert!(values.len() >= 12, "{}", sweep.name);
            for &value in [values[0], values[5]]
                .iter()
                .filter(|v| v.abs() < 1e3 || !sweep.is_crowd)
            {
                let case = |seed| sweep.case(value, 20, seed);
                let (a, b, c) = (case(1), case(1), case(2));
                assert!(a.rays.len() >= 8, "{}", sweep.name);
                assert_eq!(a.rays, b.rays, "{}", sweep.name);
                assert_ne!(a.rays, c.rays, "{}", sweep.name);
                for mesh in &a.scene.meshes {
                    assert_eq!(mesh.validate(), Ok(()), "{}", sweep.name);
                }
            }
        }
        assert!(Sweep::named("nothing").err().unwrap().contains("grazing"));
    }

    #[test]
    fn floats_are_counted_across_zero() {
        assert_eq!(moved(1.0, 1.0), 1.0_f32.next_up());
        assert_eq!(moved(-1.0, 3.0), (-1.0_f32).next_up().next_up().next_up());
        assert_eq!(moved(0.0, -2.0), -f32::from_bits(2));
        assert_eq!(moved(f32::from_bits(1), -2.0), -f32::from_bits(1));
        assert_eq!(ulps().len(), 13);
        assert_eq!(powers(0.0, -4.0, 2)[1], 0.01);
    }
}
