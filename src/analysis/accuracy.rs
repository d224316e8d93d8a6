//! Whether answers are true, by exact arithmetic: what a ray hits is decided from the `f32` inputs without rounding, and no method has a vote.

use rayon::prelude::*;

use super::view_rays::Query;
use crate::accel::{Hit, TestSpaces};
use crate::geometry::{Ray, Triangle, exact};
use crate::render::Answer;
use crate::scene::Scene;

/// How an answer is wrong.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Fault {
    /// Something is hit, and the answer is nothing.
    Hole,
    /// Nothing is hit, and the answer is a hit.
    Ghost,
    /// The nearest hit is elsewhere on the ray.
    WrongDepth,
    /// A hit just there, of a triangle that is not hit there, or that is not the first by name among those that are.
    WrongName,
}

impl Fault {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Hole, Self::Ghost, Self::WrongDepth, Self::WrongName];

    /// The name of one or several in reports.
    pub const fn name(self, is_plural: bool) -> &'static str {
        match (self, is_plural) {
            (Self::Hole, false) => "hole",
            (Self::Hole, true) => "holes",
            (Self::Ghost, false) => "ghost",
            (Self::Ghost, true) => "ghosts",
            (Self::WrongDepth, false) => "wrong depth",
            (Self::WrongDepth, true) => "wrong depths",
            (Self::WrongName, false) => "wrong name",
            (Self::WrongName, true) => "wrong names",
        }
    }
}

/// Wrong answers, counted by their kind.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Faults([u64; 4]);

impl Faults {
    /// Counts one more.
    pub fn add(&mut self, fault: Fault) {
        self.0[fault as usize] += 1;
    }

    /// How many of a kind.
    pub fn count(&self, fault: Fault) -> u64 {
        self.0[fault as usize]
    }

    /// All of them.
    pub fn total(&self) -> u64 {
        self.0.iter().sum()
    }
}

/// What is wrong with an answer, given the true one to the same question; `None` if nothing is. Depths are compared bit for bit: the
/// true one, rounded once, is what everybody owes.
pub fn judge(truth: Answer, answer: Answer) -> Option<Fault> {
    let nearest = |answer| match answer {
        Answer::Closest(hit) => hit.map(|h| (h.t.to_bits(), Some((h.instance, h.triangle)))),
        Answer::Any(hit) => hit.then_some((0, None)),
    };
    match (nearest(truth), nearest(answer)) {
        (None, None) => None,
        (Some(_), None) => Some(Fault::Hole),
        (None, Some(_)) => Some(Fault::Ghost),
        (Some((t, _)), Some((s, _))) if t != s => Some(Fault::WrongDepth),
        (Some((_, name)), Some((_, other))) => (name != other).then_some(Fault::WrongName),
    }
}

/// Decides what rays hit.
pub struct Oracle<'a> {
    scene: &'a Scene,
    spaces: TestSpaces,
}

impl<'a> Oracle<'a> {
    /// The oracle of a scene.
    pub fn new(scene: &'a Scene) -> Self {
        Self {
            scene,
            spaces: TestSpaces::of(scene),
        }
    }

    /// The true answer, by every triangle of the scene, with the threads of the rayon pool in which it is called.
    pub fn truth(&self, ray: &Ray, query: Query) -> Answer {
        let names = (0..self.scene.instances.len() as u32).into_par_iter();
        let hits = names.flat_map(|instance| {
            let count = self.scene.mesh_of(instance).triangles.len() as u32;
            (0..count)
                .into_par_iter()
                .with_min_len(1024)
                .filter_map(move |triangle| self.hit(ray, instance, triangle))
        });
        match query {
            Query::Closest => Answer::Closest(hits.min_by(order)),
            Query::Any => Answer::Any(hits.find_any(|_| true).is_some()),
        }
    }

    /// The true answer if the ray hits nothing but some of the triangles that `named` names; what it says of where does not count.
    pub fn truth_among(&self, ray: &Ray, query: Query, named: &[Hit]) -> Answer {
        let of = |h: &Hit| self.hit(ray, h.instance, h.triangle);
        let nearest = named.iter().filter_map(of).min_by(order);
        match query {
            Query::Closest => Answer::Closest(nearest),
            Query::Any => Answer::Any(nearest.is_some()),
        }
    }

    fn hit(&self, ray: &Ray, instance: u32, triangle: u32) -> Option<Hit> {
        let t = self.hit_of(ray, instance, triangle)?;
        Some(Hit {
            t,
            instance,
            triangle,
        })
    }

    /// Where the ray truly hits the triangle of that name; a name that nobody has is not hit.
    pub fn hit_of(&self, ray: &Ray, instance: u32, triangle: u32) -> Option<f32> {
        let (ray, tested) = self.tested(ray, instance, triangle)?;
        exact_hit(&ray, &tested)
    }

    /// The ray and the triangle of that name in the space in which they are tested.
    pub(super) fn tested(
        &self,
        ray: &Ray,
        instance: u32,
        triangle: u32,
    ) -> Option<(Ray, Triangle)> {
        let placed = self.scene.instances.get(instance as usize)?;
        let count = self.scene.meshes[placed.mesh as usize].triangles.len();
        ((triangle as usize) < count).then(|| self.spaces.test(self.scene, ray, instance, triangle))
    }
}

/// Where a ray hits a triangle of the same space.
pub(super) fn exact_hit(ray: &Ray, triangle: &Triangle) -> Option<f32> {
    // The same in two steps: integers are needed for few, and cost a hundred times as much.
    exact::meets(ray, triangle).then_some(())?;
    exact::intersect(ray, triangle)
}

/// The order in which hits win.
fn order(a: &Hit, b: &Hit) -> std::cmp::Ordering {
    a.t.total_cmp(&b.t)
        .then((a.instance, a.triangle).cmp(&(b.instance, b.triangle)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accel::AcceleratorKind;
    use glam::Vec3;

    fn at(t: f32, triangle: u32) -> Answer {
        Answer::Closest(Some(Hit {
            t,
            instance: 0,
            triangle,
        }))
    }

    #[test]
    fn each_fault_is_told_from_the_others() {
        let nothing = Answer::Closest(None);
        assert_eq!(judge(at(2.0, 7), at(2.0, 7)), None);
        assert_eq!(judge(nothing, nothing), None);
        assert_eq!(judge(at(2.0, 7), nothing), Some(Fault::Hole));
        assert_eq!(judge(nothing, at(2.0, 7)), Some(Fault::Ghost));
        let next = at(2.0_f32.next_up(), 7);
        assert_eq!(judge(at(2.0, 7), next), Some(Fault::WrongDepth));
        assert_eq!(judge(at(2.0, 7), at(2.0, 8)), Some(Fault::WrongName));
        let any = |truth, answer| judge(Answer::Any(truth), Answer::Any(answer));
        assert_eq!(any(true, false), Some(Fault::Hole));
        assert_eq!(any(false, true), Some(Fault::Ghost));
        assert!(any(true, true).is_none() && any(false, false).is_none());
    }

    #[test]
    fn faults_are_counted_by_kind() {
        let mut faults = Faults::default();
        for fault in [Fault::Ghost, Fault::WrongName, Fault::Ghost] {
            faults.add(fault);
        }
        assert_eq!(
            Fault::ALL.map(|f| faults.count(f)),
            [0, 2, 0, 1],
            "{faults:?}"
        );
        assert_eq!(faults.total(), 3);
    }

    #[test]
    fn the_oracle_and_brute_force_agree_also_on_edges_and_instances() {
        let scene = crate::import::load(&["models/lecture-objects.gltf".into()]).unwrap();
        let (oracle, linear) = (Oracle::new(&scene), AcceleratorKind::Linear.build(&scene));
        let center = scene.bounds().center();
        for i in 0..60_u8 {
            let place = f32::from(i);
            let origin = center + Vec3::new(place - 30.0, 20.0, 5.0 - place * 0.3);
            let ray = Ray::new(origin, center - origin + Vec3::new(0.0, -4.0, place * 0.2));
            let truth = oracle.truth(&ray, Query::Closest);
            let hit = linear.closest_hit(&ray);
            assert_eq!(judge(truth, Answer::Closest(hit)), None, "{ray:?}");
            let any = oracle.truth(&ray, Query::Any);
            assert_eq!(judge(any, Answer::Any(hit.is_some())), None);
            if let Some(hit) = hit {
                // What is said of the place does not count, and nor does a name that is nobody's.
                let rumours = [
                    Hit { t: -3.0, ..hit },
                    Hit {
                        instance: 999,
                        ..hit
                    },
                ];
                assert_eq!(oracle.truth_among(&ray, Query::Closest, &rumours), truth);
                let nobody = oracle.truth_among(&ray, Query::Any, &rumours[1..]);
                assert_eq!(nobody, Answer::Any(false));
            }
        }
    }
}
