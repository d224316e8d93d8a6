//! Made-up faults, each of which is found and blamed on whose it is.

use super::*;
use crate::accel::{Accelerator, AcceleratorKind, BuildStats, TraceCounters};
use crate::analysis::compare::{NamedRays, SetReport, compare_set};
use crate::analysis::measure;
use crate::analysis::view_rays::{Query, RayPurpose};
use crate::geometry::Interval;
use glam::Vec3;

/// Answers wrongly in one way wherever it can.
struct Liar<'a> {
    honest: &'a dyn Accelerator,
    fault: Fault,
}

impl Liar<'_> {
    fn lie(&self, hit: Option<Hit>) -> Option<Hit> {
        let made_up = Hit {
            t: 0.5,
            instance: 0,
            triangle: 3,
        };
        match (self.fault, hit) {
            (Fault::Hole, Some(_)) => None,
            (Fault::Ghost, None) => Some(made_up),
            (Fault::WrongDepth, Some(hit)) => Some(Hit {
                t: hit.t.next_up(),
                ..hit
            }),
            (Fault::WrongName, Some(hit)) => Some(Hit {
                triangle: hit.triangle ^ 1,
                ..hit
            }),
            (_, hit) => hit,
        }
    }
}

impl Accelerator for Liar<'_> {
    fn closest_hit(&self, ray: &Ray) -> Option<Hit> {
        self.lie(self.honest.closest_hit(ray))
    }

    fn any_hit(&self, ray: &Ray) -> bool {
        self.closest_hit(ray).is_some()
    }

    fn closest_hit_counted(&self, ray: &Ray, counters: &mut TraceCounters) -> Option<Hit> {
        self.lie(self.honest.closest_hit_counted(ray, counters))
    }

    fn any_hit_counted(&self, ray: &Ray, counters: &mut TraceCounters) -> bool {
        self.closest_hit_counted(ray, counters).is_some()
    }

    fn build_stats(&self) -> BuildStats {
        self.honest.build_stats()
    }
}

fn bvh2() -> Contestant {
    Contestant::structure(AcceleratorKind::Bvh2)
}

/// The accelerators under one contestant's name.
fn entrants<'a>(of: &'a Contestant, all: &[&'a dyn Accelerator]) -> Vec<Entrant<'a>> {
    let entrant = |&accelerator: &&'a dyn Accelerator| Entrant {
        contestant: of,
        accelerator,
    };
    all.iter().map(entrant).collect()
}

fn report(scene: &Scene, of: &Contestant, all: &[&dyn Accelerator], set: &RaySet) -> SetReport {
    let rays = NamedRays {
        name: String::new(),
        set: set.clone(),
    };
    compare_set(scene, &entrants(of, all), &rays, 0, 0, &|| ())
}

fn block() -> Scene {
    crate::import::load(&["models/lecture-block.obj".into()]).unwrap()
}

/// Forty rays down on the block, of which some miss.
fn rays(purpose: RayPurpose) -> RaySet {
    let ray = |i: u8| {
        let x = f32::from(i) * 0.07 - 0.33;
        Ray::new(Vec3::new(x, 5.0, 0.4), Vec3::NEG_Y).within(Interval::new(0.0, 99.0))
    };
    RaySet {
        purpose,
        rays: (0..40).map(ray).collect(),
    }
}

#[test]
fn every_made_up_fault_is_found_and_the_honest_are_not_blamed() {
    let scene = block();
    let honest = AcceleratorKind::Bvh2.build(&scene);
    for purpose in RayPurpose::ALL {
        let set = rays(purpose);
        let hits = set.rays.iter().filter(|r| honest.any_hit(r)).count();
        assert!(hits > 5 && hits < 35);
        for fault in Fault::ALL {
            let liar = Liar {
                honest: &*honest,
                fault,
            };
            let is_closest = purpose.query() == Query::Closest;
            let want = match fault {
                Fault::Hole => hits,
                Fault::Ghost => 40 - hits,
                Fault::WrongDepth | Fault::WrongName if is_closest => hits,
                _ => 0,
            };
            let report = report(&scene, &bvh2(), &[&*honest, &liar], &set);
            assert_eq!(report.methods[0].mistakes, Mistakes::default());
            let mistakes = report.methods[1].mistakes;
            // Brute force is honest: it is not the triangle test.
            assert_eq!((mistakes.by_test, mistakes.by_traversal), (0, want as u64));
            assert_eq!(mistakes.troubles.iter().sum::<u64>(), want as u64);
            let faults = mistakes.faults;
            assert!(report.wrong.iter().all(|w| w.faults == [None, Some(fault)]));
            assert_eq!(report.pairs[0].different(), want as u64);
            assert_eq!(faults.count(fault), want as u64, "{purpose:?} {fault:?}");
            assert_eq!(faults.total(), want as u64);
            assert_eq!((report.disputed, report.hits), (want, hits));
            assert_eq!(report.wrong.len(), want.min(KEPT));
            assert_eq!(report.sampled, 40 - want);
        }
    }
}

#[test]
fn what_all_get_wrong_is_found_in_the_sample() {
    let scene = block();
    let honest = AcceleratorKind::Linear.build(&scene);
    let liar = Liar {
        honest: &*honest,
        fault: Fault::Hole,
    };
    let report = report(&scene, &bvh2(), &[&liar, &liar], &rays(RayPurpose::Eye));
    assert_eq!(report.disputed, 0);
    assert!(report.methods.iter().all(|m| m.mistakes.faults.total() > 5));
}

#[test]
fn a_dispute_beyond_the_budget_is_decided_among_what_was_named() {
    let scene = block();
    let honest = AcceleratorKind::Bvh2.build(&scene);
    let liar = Liar {
        honest: &*honest,
        fault: Fault::Ghost,
    };
    let of = bvh2();
    for purpose in [RayPurpose::Eye, RayPurpose::Shadow] {
        let set = rays(purpose);
        let both: [&dyn Accelerator; 2] = [&*honest, &liar];
        let answers = both.map(|a| measure::answers(a, &set)).to_vec();
        let asked = Answers {
            oracle: Oracle::new(&scene),
            entrants: &entrants(&of, &both),
            set: &set,
            by_method: &answers,
        };
        let all: Vec<usize> = (0..set.rays.len()).collect();
        let none = BTreeSet::new();
        let among_named = asked.truths(&all, 0, &none);
        assert_eq!(among_named, asked.truths(&all, all.len(), &none));
    }
}

#[test]
fn single_precision_beside_exact_methods_is_disputed_only_where_it_must_be_wrong() {
    let scene = block();
    let honest = AcceleratorKind::Bvh2.build(&scene);
    let exact = bvh2();
    let loose = Contestant {
        owes_exact: false,
        ..bvh2()
    };
    let set = rays(RayPurpose::Eye);
    let hits = set.rays.iter().filter(|r| honest.any_hit(r)).count();
    for (fault, disputed) in [(Fault::WrongDepth, 0), (Fault::Hole, hits)] {
        let liar = Liar {
            honest: &*honest,
            fault,
        };
        let both: [(&Contestant, &dyn Accelerator); 2] = [(&exact, &*honest), (&loose, &liar)];
        let both = both.map(|(contestant, accelerator)| Entrant {
            contestant,
            accelerator,
        });
        let answers = both.map(|e| measure::answers(e.accelerator, &set)).to_vec();
        let judged = Judged::of(&scene, &both, &set, &answers);
        assert_eq!(judged.disputed, disputed, "{fault:?}");
        assert_eq!(judged.sampled, 40 - disputed);
        let wrong: Vec<_> = judged.mistakes.iter().map(|m| m.faults.total()).collect();
        assert_eq!(wrong, [0, disputed as u64]);
    }
}

#[test]
fn who_promises_no_bits_is_held_to_depths_only() {
    let scene = block();
    let honest = AcceleratorKind::Bvh2.build(&scene);
    let loose = Contestant {
        owes_exact: false,
        ..bvh2()
    };
    let set = rays(RayPurpose::Eye);
    for (fault, is_forgiven) in [(Fault::WrongDepth, true), (Fault::Hole, false)] {
        let liar = Liar {
            honest: &*honest,
            fault,
        };
        let found = report(&scene, &loose, &[&*honest, &liar], &set);
        assert!(found.disputed > 5);
        let wrong = found.methods[1].mistakes.faults.total();
        assert_eq!(wrong == 0, is_forgiven, "{fault:?}");
        let ulps = found.pairs[0].ulps.map(|u| u.largest);
        assert_eq!(ulps, is_forgiven.then_some(1.0));
    }
}
