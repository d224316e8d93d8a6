//! Which structures are measured where none is named: all whose work ends soon, by counts and not by a clock.

use crate::accel::AcceleratorKind;
use crate::scene::Scene;

/// Most triangles that the polygon BSP is built from unasked, in all builds together. It took 6 s for 69,451 on a busy machine of two cores; its build has no limit, and
/// grows faster than the model.
const MOST_POLYGON_TRIANGLES: u64 = 100_000;

/// Most triangles, or objects, that a loop over all of them may test in one pass over the rays of a kind: most of a second.
const MOST_LOOP_TESTS: u64 = 100_000_000;

/// How much there is to do.
#[derive(Clone, Copy, Debug)]
pub struct Work {
    /// Triangles of all meshes.
    triangles: u64,
    /// The same, counted as often as they are placed.
    placed_triangles: u64,
    /// Instances.
    objects: u64,
    /// Most rays of a kind.
    rays: u64,
    /// How often a structure is built.
    builds: u64,
}

impl Work {
    /// So many rays of each kind in the scene, and so many builds of each structure.
    pub fn of(scene: &Scene, rays: usize, builds: usize) -> Self {
        Self {
            triangles: scene.meshes.iter().map(|m| m.triangles.len() as u64).sum(),
            placed_triangles: scene.placed_triangles(),
            objects: scene.instances.len() as u64,
            rays: rays as u64,
            builds: builds as u64,
        }
    }

    /// Instances of the scene.
    pub(super) fn objects(&self) -> u64 {
        self.objects
    }

    /// Why a structure is not taken unasked; `None` if it is.
    pub fn too_much_for(&self, kind: AcceleratorKind) -> Option<String> {
        let (rays, most) = (self.rays, MOST_LOOP_TESTS / 1_000_000);
        let is_long = |count: u64| count.saturating_mul(rays) > MOST_LOOP_TESTS;
        let built = self.triangles.saturating_mul(self.builds);
        match kind {
            AcceleratorKind::BspPolygon if built > MOST_POLYGON_TRIANGLES => Some(format!(
                "its build may take very long: {} triangles{} are more than {MOST_POLYGON_TRIANGLES}",
                self.triangles,
                if self.builds > 1 {
                    format!(" for each of {} builds", self.builds)
                } else {
                    String::new()
                }
            )),
            AcceleratorKind::Linear if is_long(self.placed_triangles) => Some(format!(
                "{} triangles for each of {rays} rays are more than {most} million tests",
                self.placed_triangles
            )),
            AcceleratorKind::Extents if is_long(self.objects) => Some(format!(
                "{} objects for each of {rays} rays are more than {most} million tests",
                self.objects
            )),
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::Contestant;

    #[test]
    fn what_would_not_end_soon_is_left_out_with_its_reason() {
        let names = |work: Work| {
            let (taken, left_out) = Contestant::defaults(&work);
            assert_eq!(taken.len() + left_out.len(), AcceleratorKind::ALL.len());
            let names: Vec<_> = taken.iter().map(|c| c.name.clone()).collect();
            (names.join(" "), left_out.join("\n"))
        };
        let small = Work {
            triangles: 36,
            placed_triangles: 36,
            objects: 1,
            rays: 200_000,
            builds: 1,
        };
        let all = "bsp bsp-polygon bvh2 cwbvh extents linear";
        assert_eq!(names(small), (all.to_owned(), String::new()));
        let scan = Work {
            placed_triangles: 69_451,
            triangles: 69_451,
            ..small
        };
        let (taken, left_out) = names(scan);
        assert_eq!(taken, "bsp bsp-polygon bvh2 cwbvh extents");
        assert!(left_out.starts_with("linear is left out: 69451 triangles for each of 200000"));
        let often = Work { builds: 4, ..scan };
        let (taken, left_out) = names(often);
        assert_eq!(taken, "bsp bvh2 cwbvh extents");
        assert!(left_out.contains("69451 triangles for each of 4 builds are more than 100000"));
        let forest = Work {
            placed_triangles: u64::MAX,
            triangles: 100_001,
            objects: 10_000,
            ..small
        };
        let (taken, left_out) = names(forest);
        assert_eq!(taken, "bsp bvh2 cwbvh");
        assert_eq!(left_out.lines().count(), 3);
        assert!(left_out.contains("--accel can name it"));
    }
}
