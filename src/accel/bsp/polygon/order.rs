//! Which polygon of a cell is inserted next: its plane divides the cell.

use glam::DVec3;

use super::super::options::BspOrder;
use super::fragment::Fragment;
use crate::geometry::exact::ExactPlane;

/// Candidates that an order looks at in each cell. More: slower builds of somewhat better trees.
pub const CANDIDATES: usize = 12;

/// Fragments of a cell on which a candidate is judged, spread evenly over the cell. More: as [`CANDIDATES`].
pub const SAMPLE: usize = 64;

/// Chooses; nothing depends on anything but the cell and the seed.
pub(super) struct Chooser<'a> {
    pub(super) order: BspOrder,
    pub(super) seed: u64,
    pub(super) planes: &'a [ExactPlane],
    /// By polygon.
    pub(super) plane_of: &'a [u32],
    /// By polygon: its area in the input.
    pub(super) areas: &'a [f64],
}

/// SplitMix64's finalizer (Steele, Lea, Flood 2014).
fn scramble(x: u64) -> u64 {
    let z = x.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let z = (z ^ z >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let z = (z ^ z >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ z >> 31
}

impl Chooser<'_> {
    /// The place in the cell of the fragment whose plane comes next. The cell holds at least one; its fragments are in the order of polygons.
    pub(super) fn choose(&self, cell: &[Fragment]) -> usize {
        let least_by = |value: &dyn Fn(&Fragment) -> u64| {
            let places = 0..cell.len();
            places.min_by_key(|&i| value(&cell[i])).unwrap_or(0)
        };
        match self.order {
            BspOrder::File => least_by(&|f| u64::from(f.polygon)),
            BspOrder::Random => least_by(&|f| scramble(self.seed ^ scramble(u64::from(f.polygon)))),
            BspOrder::Largest => {
                // The greater the area, the greater its bits.
                least_by(&|f| u64::MAX - self.areas[f.polygon as usize].to_bits())
            }
            BspOrder::FewestSplits | BspOrder::Balanced | BspOrder::Sah => self.candidate(cell),
        }
    }

    fn candidate(&self, cell: &[Fragment]) -> usize {
        let n = cell.len();
        if n < 3 {
            return 0;
        }
        let spread = |count: usize, salt: u64| {
            let count = count.min(n);
            (0..count).map(move |i| {
                let (low, high) = (i * n / count, (i + 1) * n / count);
                low + (scramble(salt ^ i as u64) % (high - low).max(1) as u64) as usize
            })
        };
        let salt = scramble(self.seed ^ u64::from(cell[0].polygon) ^ (n as u64) << 32);
        let sample: Vec<&Fragment> = spread(SAMPLE, salt).map(|i| &cell[i]).collect();
        let mut best = (f64::INFINITY, 0);
        for place in spread(CANDIDATES, salt ^ 1) {
            let plane = &self.planes[self.plane_of[cell[place].polygon as usize] as usize];
            let score = self.score(plane, &sample);
            if score < best.0 {
                best = (score, place);
            }
        }
        best.1
    }

    /// The less, the better. Sides from rounded corners: a doubtful one may be counted wrongly, which costs nothing but a choice.
    fn score(&self, plane: &ExactPlane, sample: &[&Fragment]) -> f64 {
        let (normal, _) = plane.normal();
        let through = plane.points()[0].as_dvec3();
        let mut counts = [0.0_f64; 2];
        let mut boxes = [(DVec3::INFINITY, DVec3::NEG_INFINITY); 2];
        let mut splits = 0.0;
        for fragment in sample {
            let mut touches = [false; 2];
            for corner in fragment.corners() {
                let point = corner.position.point;
                let height = normal.dot(point - through);
                let slack = 1e-12 * (point - through).abs().max_element();
                if height.abs() > slack {
                    let side = usize::from(height > 0.0);
                    touches[side] = true;
                    boxes[side] = (boxes[side].0.min(point), boxes[side].1.max(point));
                }
            }
            counts[0] += f64::from(u8::from(touches[0]));
            counts[1] += f64::from(u8::from(touches[1]));
            splits += f64::from(u8::from(touches[0] && touches[1]));
        }
        let uneven = (counts[0] - counts[1]).abs();
        match self.order {
            BspOrder::FewestSplits => splits + uneven / (4.0 * SAMPLE as f64),
            BspOrder::Balanced => uneven + 0.5 * splits,
            _ => {
                let surface = |(min, max): (DVec3, DVec3)| {
                    let e = (max - min).max(DVec3::ZERO);
                    e.x * e.y + e.y * e.z + e.z * e.x
                };
                let cost = |side: usize| surface(boxes[side]) * (1.0 + counts[side]);
                cost(0) + cost(1)
            }
        }
    }
}
