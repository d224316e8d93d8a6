//! What every combination of extents of an object would cost on some rays: counted once, then computed.
//!
//! Each ray is tested against all extents of an object and gets its full test. Since no extent changes an answer, the full tests are the same for all
//! combinations, and the costs of objects do not depend on one another.

use super::choice::{ExtentSet, ExtentTest};
use super::cost::{CostTable, speed_ratio};
use super::entry::{ExtentObject, limited};
use super::ray::ExtentRay;
use super::trace::ExtentsLoop;
use crate::accel::TraceSet;
use crate::accel::counters::TraceCounters;
use crate::accel::hit::Nearest;
use crate::geometry::Ray;

/// How many sets of tests there are.
const SETS: usize = 1 << ExtentTest::COUNT;

/// Rays at one object, by the set of tests that admitted them.
#[derive(Clone, Copy, Debug)]
struct Rays {
    count: [u64; SETS],
    /// What their full tests cost together.
    full: [f64; SETS],
}

impl Default for Rays {
    fn default() -> Self {
        Self {
            count: [0; SETS],
            full: [0.0; SETS],
        }
    }
}

impl Rays {
    fn total(&self) -> u64 {
        self.count.iter().sum()
    }
}

/// The place of rays with a pixel among both kinds.
const WITH_PIXEL: usize = 0;

/// The place of all others.
const OTHERS: usize = 1;

/// What some rays did at one object.
#[derive(Clone, Debug)]
pub struct ObjectStudy {
    /// Tests that the object has.
    available: ExtentSet,
    /// Whether a ray that gets the full test is transformed anyway.
    is_tested_in_object: bool,
    /// Rays with a pixel, and others.
    kinds: [Rays; 2],
    /// Rays that hit the object.
    pub hits: u64,
    /// By test: planes of all rays together.
    planes: [u64; ExtentTest::COUNT],
    table: CostTable,
}

impl ObjectStudy {
    fn new(available: ExtentSet, is_tested_in_object: bool, table: CostTable) -> Self {
        Self {
            available,
            is_tested_in_object,
            kinds: [Rays::default(); 2],
            hits: 0,
            planes: [0; ExtentTest::COUNT],
            table,
        }
    }

    /// Adds what the rays of another study did at the same object.
    pub fn add(&mut self, other: &Self) {
        for (rays, more) in self.kinds.iter_mut().zip(&other.kinds) {
            for set in 0..SETS {
                rays.count[set] += more.count[set];
                rays.full[set] += more.full[set];
            }
        }
        for (sum, planes) in self.planes.iter_mut().zip(&other.planes) {
            *sum += planes;
        }
        self.hits += other.hits;
    }

    /// Rays that were looked at.
    pub fn rays(&self) -> u64 {
        self.kinds.iter().map(Rays::total).sum()
    }

    /// Whether the object has the extent.
    pub fn has(&self, test: ExtentTest) -> bool {
        self.available.has(test)
    }

    /// Rays that reach an extent.
    pub fn admitted(&self, test: ExtentTest) -> u64 {
        let sets = ExtentSet::all().filter(|s| s.has(test));
        let rays = |s: ExtentSet| self.kinds.iter().map(move |rays| rays.count[s.number()]);
        sets.flat_map(rays).sum()
    }

    /// The lecture's `f`: the share of rays that reach an extent; 0 without rays.
    pub fn share(&self, test: ExtentTest) -> f64 {
        self.admitted(test) as f64 / self.rays().max(1) as f64
    }

    /// The lecture's `T`: the mean cost of a test, with the transformation where that is for this test only. Rays that have no pixel pay nothing for a screen extent.
    pub fn test_cost(&self, test: ExtentTest) -> f64 {
        if test == ExtentTest::Screen {
            let asked = self.kinds[WITH_PIXEL].total() as f64;
            return self.table.screen * asked / self.rays().max(1) as f64;
        }
        let planes = self.planes[test.index()] as f64 / self.rays().max(1) as f64;
        let transform = if test.is_in_object_space() {
            self.table.transform
        } else {
            0.0
        };
        transform + self.table.test(test, planes)
    }

    /// The lecture's `m`: the mean cost of the full test in tests of the extent.
    pub fn full_cost(&self, test: ExtentTest) -> f64 {
        self.cost(ExtentSet::NONE) / self.test_cost(test)
    }

    /// The mean cost of a ray with these tests, and with the full test for those that pass them all.
    pub fn cost(&self, set: ExtentSet) -> f64 {
        let [with_pixel, other] = &self.kinds;
        let total =
            self.cost_of(with_pixel, set) + self.cost_of(other, set.without(ExtentTest::Screen));
        total / self.rays().max(1) as f64
    }

    /// What all rays of one kind cost together.
    fn cost_of(&self, kind: &Rays, set: ExtentSet) -> f64 {
        let mut total = 0.0;
        for admitted in ExtentSet::all() {
            let rays = kind.count[admitted.number()] as f64;
            let (mut is_transformed, mut passes) = (false, true);
            for test in set.tests() {
                if test.is_in_object_space() && !is_transformed {
                    is_transformed = true;
                    total += rays * self.table.transform;
                }
                let planes = self.planes[test.index()] as f64 / self.rays().max(1) as f64;
                total += rays * self.table.test(test, planes);
                if !admitted.has(test) {
                    passes = false;
                    break;
                }
            }
            if passes {
                total += kind.full[admitted.number()];
                if self.is_tested_in_object && !is_transformed {
                    total += rays * self.table.bare_transform;
                }
            }
        }
        total
    }

    /// The lecture's prediction for one extent, from `m` and `f` alone.
    pub fn predicted(&self, test: ExtentTest) -> f64 {
        speed_ratio(self.full_cost(test), self.share(test))
    }

    /// How much less the rays cost with these tests than without, counted.
    pub fn gain(&self, set: ExtentSet) -> f64 {
        let with = self.cost(set);
        if with > 0.0 {
            self.cost(ExtentSet::NONE) / with
        } else {
            1.0
        }
    }

    /// The combination of least cost; of equals the one with fewer tests. Tests that the object has not are left out.
    pub fn best(&self) -> ExtentSet {
        let usable = ExtentSet::all().filter(|s| s.tests().all(|t| self.available.has(t)));
        let key = |s: &ExtentSet| (self.cost(*s), s.len());
        let best = usable.min_by(|a, b| {
            let ((a, few), (b, many)) = (key(a), key(b));
            a.total_cmp(&b).then(few.cmp(&many))
        });
        best.unwrap_or_default()
    }
}

impl ExtentsLoop {
    /// What every combination of extents would cost on these rays, for each object. `is_closest` tells whether the nearest hit is asked for, or any.
    pub fn study(&self, rays: &[Ray], is_closest: bool) -> Vec<ObjectStudy> {
        let new = |object: &ExtentObject| {
            let has = |t: &ExtentTest| object.extents.has(*t);
            let available = ExtentTest::ALL.into_iter().filter(has).collect();
            let in_object = object.extents.is_tested_in_object();
            ObjectStudy::new(available, in_object, self.table)
        };
        let mut studies: Vec<_> = self.objects.iter().map(new).collect();
        for ray in rays.iter().filter(|r| r.is_traceable()) {
            let mut nearest = Nearest::of(ray);
            let mut world = self.world_ray(ray);
            for (object, study) in self.objects.iter().zip(&mut studies) {
                let limited = limited(ray, nearest.limit());
                let in_object = object.extents.object_ray(&limited);
                let prepared = in_object.map(|ray| ExtentRay::new(&ray));
                let mut admitted = ExtentSet::NONE;
                for test in ExtentTest::ALL {
                    let mut planes = 0;
                    let extents = &object.extents;
                    if extents.admits(test, ray, &world, prepared.as_ref(), &mut planes) {
                        admitted = admitted.with(test);
                    }
                    study.planes[test.index()] += u64::from(planes);
                }
                let mut steps = TraceCounters::default();
                let is_hit = match object.tested_ray(&limited, in_object) {
                    None => false,
                    Some(tested) if is_closest => {
                        self.full_test(object, &tested, &mut nearest, &mut steps)
                    }
                    Some(tested) => self.sets[object.set as usize].any(&tested, &mut steps),
                };
                let kind = if world.has_pixel { WITH_PIXEL } else { OTHERS };
                let rays = &mut study.kinds[kind];
                rays.count[admitted.number()] += 1;
                rays.full[admitted.number()] += self.table.enter + self.table.steps(&steps);
                study.hits += u64::from(is_hit);
                if is_hit {
                    if !is_closest {
                        break;
                    }
                    world.ray.end_at(nearest.limit());
                }
            }
        }
        studies
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accel::extents::MeshAccelerator;

    fn study(full: f64, in_sphere: u64, in_box: u64) -> ObjectStudy {
        let all = ExtentSet::all().last().unwrap_or_default();
        let table = CostTable::of(MeshAccelerator::Linear);
        let mut study = ObjectStudy::new(all, false, table);
        let sphere = ExtentSet::NONE.with(ExtentTest::SphereWorld);
        let both = sphere.with(ExtentTest::BoxWorld);
        let rays = &mut study.kinds[OTHERS];
        rays.count[0] = 1000 - in_sphere;
        rays.count[sphere.number()] = in_sphere - in_box;
        rays.count[both.number()] = in_box;
        for set in 0..SETS {
            rays.full[set] = full * rays.count[set] as f64;
        }
        study.planes[ExtentTest::BoxWorld.index()] = 3000;
        study
    }

    #[test]
    fn where_the_full_test_costs_all_rays_the_same_the_lecture_is_right() {
        let study = study(96.0, 25, 10);
        let test = ExtentTest::SphereWorld;
        // m = 20, f = 1/40.
        assert!((study.full_cost(test) - 20.0).abs() < 1e-12);
        assert!((study.share(test) - 1.0 / 40.0).abs() < 1e-12);
        assert!((study.predicted(test) - 40.0 / 3.0).abs() < 1e-9);
        let alone = ExtentSet::NONE.with(test);
        assert!((study.gain(alone) - study.predicted(test)).abs() < 1e-9);
    }

    #[test]
    fn screen_extents_cost_only_rays_that_have_a_pixel() {
        let screen = ExtentSet::NONE.with(ExtentTest::Screen);
        let mut study = study(96.0, 25, 10);
        // Now half of the thousand rays have a pixel, of which the extent admits forty.
        let [with_pixel, others] = &mut study.kinds;
        others.count = [0; SETS];
        others.count[screen.number()] = 500;
        with_pixel.count[0] = 460;
        with_pixel.count[screen.number()] = 40;
        for rays in [with_pixel, others] {
            for set in 0..SETS {
                rays.full[set] = 96.0 * rays.count[set] as f64;
            }
        }
        let test = study.table.screen;
        assert!((study.cost(screen) - (0.5 * test + 0.54 * 96.0)).abs() < 1e-9);
        assert!((study.share(ExtentTest::Screen) - 0.54).abs() < 1e-12);
        assert!((study.predicted(ExtentTest::Screen) - study.gain(screen)).abs() < 1e-9);
    }

    #[test]
    fn cheap_objects_get_no_extent_and_expensive_ones_several() {
        let has = [ExtentTest::SphereWorld, ExtentTest::BoxWorld];
        let best = |mut study: ObjectStudy| {
            study.available = has.into_iter().collect();
            study.best()
        };
        // Two triangles, met by nearly all rays that reach the sphere.
        assert!(best(study(3.0, 900, 900)).is_empty());
        assert!(best(study(1e6, 900, 100)).has(ExtentTest::BoxWorld));
        // Where the box rejects no more than the sphere, it is not asked.
        let alone = best(study(96.0, 25, 25));
        assert_eq!(alone, ExtentSet::NONE.with(ExtentTest::SphereWorld));
        // Tests that the object has not are never chosen, even where they would admit nobody.
        assert!(!best(study(1e6, 900, 100)).has(ExtentTest::Screen));
    }
}
