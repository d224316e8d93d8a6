//! Sets of triangles whose structure is built when the first ray enters them: a mesh that no ray meets costs a copy of its corners.
//!
//! The thread whose ray comes first builds, alone, since it holds a lock (see the note in `bsp/wide/treelet`); others that come meanwhile wait.

use std::sync::{Mutex, OnceLock, PoisonError};

use super::TraceSet;
use super::bake::{Baked, Placement, TriangleSet};
use super::counters::{BuildStats, Counter};
use super::hit::{Hit, Nearest};
use super::instances::{Instances, Top};
use crate::geometry::Ray;

/// A set under a structure that is built when it is needed.
pub(super) struct LazySet<S, F> {
    built: OnceLock<S>,
    /// Nothing once somebody builds.
    waiting: Mutex<Option<(TriangleSet, F)>>,
}

impl<S: TraceSet, F: Fn(TriangleSet) -> S + Send> LazySet<S, F> {
    /// Waits for a ray.
    pub(super) fn waiting(set: TriangleSet, build: F) -> Self {
        Self {
            built: OnceLock::new(),
            waiting: Mutex::new(Some((set, build))),
        }
    }

    /// Waits for nothing.
    pub(super) fn ready(set: S) -> Self {
        Self {
            built: OnceLock::from(set),
            waiting: Mutex::new(None),
        }
    }

    #[inline(always)]
    fn get(&self) -> &S {
        match self.built.get() {
            Some(set) => set,
            None => self.build(),
        }
    }

    #[cold]
    fn build(&self) -> &S {
        self.built.get_or_init(|| {
            let (set, build) = self.take().expect("nobody else builds it");
            build(set)
        })
    }

    fn take(&self) -> Option<(TriangleSet, F)> {
        let waiting = self.waiting.lock();
        // Nothing that is done under this lock can fail half-way.
        waiting.unwrap_or_else(PoisonError::into_inner).take()
    }
}

/// An accelerator whose sets are built by `later` when a ray enters them; that in world space, which some ray will enter, by `world` at once.
pub(super) fn instances<S, F, T>(
    baked: Baked,
    world: impl Fn(TriangleSet) -> S,
    later: F,
    build_top: impl Fn(&[Placement]) -> T,
) -> Instances<LazySet<S, F>, T>
where
    S: TraceSet,
    F: Fn(TriangleSet) -> S + Copy + Send,
    T: Top,
{
    let mut placements = baked.placements.iter();
    let in_world = placements.find(|p| p.instance.is_none()).map(|p| p.set);
    let mut number = 0;
    let set = |set| {
        number += 1;
        if in_world == Some(number - 1) {
            LazySet::ready(world(set))
        } else {
            LazySet::waiting(set, later)
        }
    };
    Instances::build(baked, set, build_top)
}

impl<S: TraceSet, F: Fn(TriangleSet) -> S + Send> TraceSet for LazySet<S, F> {
    fn closest<C: Counter>(
        &self,
        ray: &Ray,
        instance: Option<u32>,
        nearest: &mut Nearest,
        counter: &mut C,
    ) {
        self.get().closest(ray, instance, nearest, counter);
    }

    fn any<C: Counter>(&self, ray: &Ray, counter: &mut C) -> bool {
        self.get().any(ray, counter)
    }

    fn stats(&self) -> BuildStats {
        if let Some(set) = self.built.get() {
            return set.stats();
        }
        let waiting = self.waiting.lock().unwrap_or_else(PoisonError::into_inner);
        match &*waiting {
            Some((set, _)) => BuildStats {
                triangles: set.len() as u64,
                unbuilt_triangles: set.len() as u64,
                bytes: size_of_val(&**set) as u64,
                ..BuildStats::default()
            },
            None => {
                drop(waiting);
                self.get().stats()
            }
        }
    }

    fn closest_alone<C: Counter>(&self, ray: &Ray, counter: &mut C) -> Option<Hit> {
        self.get().closest_alone(ray, counter)
    }

    fn any_alone<C: Counter>(&self, ray: &Ray, counter: &mut C) -> bool {
        self.get().any_alone(ray, counter)
    }

    fn closest_alone_batch(&self, rays: &[Ray], hits: &mut [Option<Hit>]) {
        self.get().closest_alone_batch(rays, hits);
    }

    fn any_alone_batch(&self, rays: &[Ray], hits: &mut [bool]) {
        self.get().any_alone_batch(rays, hits);
    }
}
