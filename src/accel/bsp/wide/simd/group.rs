//! Groups of rays that go about the same way.
//!
//! Up to 64 rays that follow one another, with the same signs and the same largest axis. One test of a node tells which children the
//! shaft around the whole group meets; a child is entered by the rays whose own test says so. After Wald, Benthin, Slusallek,
//! Wagner, "Interactive Rendering with Coherent Ray Tracing", 2001, and Overbeck, Ramamoorthi, Mark, "Large Ray Packets for Real-time Whitted Ray
//! Tracing", 2008.

use std::mem::MaybeUninit;

use super::super::node::WIDTH;
use super::bundle::{Bundle, Frame, Given};
use super::kernel::Lanes;
use super::shaft::Shaft;
use super::table::{GROUP, Table};
use crate::geometry::Ray;
use crate::geometry::tolerance::{WALK_FARTHEST, WALK_LENGTHS};

/// Rays that make a group at least; fewer walk alone. With 4, scattered rays take up to twice as long; coherent ones hardly change.
const LEAST_GROUP: u32 = 8;

/// How far slopes of a group's rays may lie apart. With 0.25 shadows take up to 20 % longer, with 1 scattered rays up to 70 %.
const MOST_SPREAD: f32 = 0.5;

/// For each property a bit a place.
struct Traits {
    /// Whether directions point down along x, y, z.
    is_down: [u64; 3],
    /// Whether x is the largest axis; y.
    is_largest: [u64; 2],
    /// Whether the ray can walk in a group.
    usable: u64,
}

impl Traits {
    /// # Safety
    /// As for [`Lanes`].
    #[inline(always)]
    unsafe fn of<L: Lanes>(table: &Table, largest: f32) -> Self {
        let mut traits = Self {
            is_down: [0; 3],
            is_largest: [0; 2],
            usable: 0,
        };
        let mut place = 0;
        while place < GROUP {
            // SAFETY: the caller's promise; places are below `GROUP`.
            unsafe {
                let Given {
                    origin: [ox, oy, oz],
                    direction: [x, y, z],
                    interval: [min, max],
                } = table.load::<L>(place, [0, 1, 2]);
                for (axis, d) in [x, y, z].into_iter().enumerate() {
                    traits.is_down[axis] |= u64::from(d.signs()) << place;
                }
                let [x, y, z] = [x.abs(), y.abs(), z.abs()];
                traits.is_largest[0] |= u64::from(y.below(x) & z.below(x)) << place;
                traits.is_largest[1] |= u64::from(z.below(y)) << place;
                let length = x.add(y).add(z);
                let span = ox.abs().add(oy.abs()).add(oz.abs()).add(L::splat(largest));
                let usable = L::splat(*WALK_LENGTHS.start()).at_most(length)
                    & length.at_most(L::splat(*WALK_LENGTHS.end()))
                    & span.below(L::splat(WALK_FARTHEST))
                    & min.at_most(max);
                traits.usable |= u64::from(usable) << place;
            }
            place += WIDTH;
        }
        traits
    }

    /// The places whose rays have the same traits as that of the first of these, and their frame.
    #[inline(always)]
    fn alike(&self, places: u64) -> (u64, Frame) {
        let first = places.trailing_zeros();
        let mut alike = places;
        let mut has = |property: u64| {
            let has = property >> first & 1 != 0;
            alike &= if has { property } else { !property };
            has
        };
        let is_down = [
            has(self.is_down[0]),
            has(self.is_down[1]),
            has(self.is_down[2]),
        ];
        let axes = if has(self.is_largest[0]) {
            [1, 2, 0]
        } else if has(self.is_largest[1]) {
            [2, 0, 1]
        } else {
            [0, 1, 2]
        };
        let frame = Frame {
            axes,
            is_down: [is_down[axes[0]], is_down[axes[1]], is_down[axes[2]]],
        };
        (alike, frame)
    }
}

/// The vectors of a group.
pub(super) type Bundles<L> = [MaybeUninit<Bundle<L>>; GROUP / WIDTH];

/// Rays that walk together.
pub(super) struct Group<'a, L> {
    pub(super) frame: Frame,
    pub(super) shaft: Shaft<L>,
    pub(super) bundles: &'a mut [Bundle<L>],
}

impl<'a, L: Lanes> Group<'a, L> {
    /// `None` if the rays go too far apart.
    ///
    /// # Safety
    /// As for [`Lanes`].
    #[inline(always)]
    unsafe fn new(
        table: &Table,
        frame: Frame,
        largest: f32,
        space: &'a mut Bundles<L>,
    ) -> Option<Self> {
        let count = table.count.div_ceil(WIDTH);
        // SAFETY: the caller's promise; as many bundles were written.
        unsafe {
            for (index, bundle) in space.iter_mut().enumerate().take(count) {
                let given = table.load::<L>(index * WIDTH, frame.axes);
                bundle.write(Bundle::new(&given, &frame, largest));
            }
            let bundles =
                std::slice::from_raw_parts_mut(space.as_mut_ptr().cast::<Bundle<L>>(), count);
            let middle = (table.count / 2 / WIDTH, table.count / 2 % WIDTH);
            let shaft = Shaft::around(bundles, &frame, largest, middle);
            let is_narrow = shaft.spread[0] <= MOST_SPREAD && shaft.spread[1] <= MOST_SPREAD;
            is_narrow.then_some(Self {
                frame,
                shaft,
                bundles,
            })
        }
    }
}

/// What is done with the groups among some rays.
pub(super) trait Visit<L> {
    /// # Safety
    /// As for [`Lanes`].
    unsafe fn visit(&mut self, group: Group<'_, L>, table: &Table);
}

/// How many rays in equal steps through a group are looked at before anything is done for it, less one.
const STEPS: usize = 7;

/// Whether so few of the rays go about the same way as others nearby that sorting them would not pay: a quick answer from some of them.
#[inline(always)]
fn are_scattered(rays: &[Ray]) -> bool {
    let mut close = 0;
    let mut before = compass(&rays[0]);
    for step in 1..=STEPS {
        let [x, y, z] = compass(&rays[(rays.len() - 1) * step / STEPS]);
        let apart = (x - before[0]).abs() + (y - before[1]).abs() + (z - before[2]).abs();
        close += usize::from(apart < MOST_SPREAD);
        before = [x, y, z];
    }
    2 * close < STEPS
}

/// The direction, the magnitudes of its components adding up to 1.
#[inline(always)]
fn compass(ray: &Ray) -> [f32; 3] {
    let d = ray.direction;
    let scale = 1.0 / (d.x.abs() + d.y.abs() + d.z.abs());
    [d.x * scale, d.y * scale, d.z * scale]
}

/// Sorts rays into groups that `visitor` visits. A bit for each ray that is left: it walks alone.
///
/// # Safety
/// As for [`Lanes`].
#[inline(always)]
pub(super) unsafe fn visit_groups<L: Lanes>(
    rays: &[Ray],
    largest: f32,
    visitor: &mut impl Visit<L>,
) -> u64 {
    if rays.len() < LEAST_GROUP as usize || are_scattered(rays) {
        return u64::MAX;
    }
    let table = Table::of(rays);
    let mut space: Bundles<L> = [const { MaybeUninit::uninit() }; GROUP / WIDTH];
    // SAFETY: the caller's promise.
    unsafe {
        let traits = Traits::of::<L>(&table, largest);
        let mut waiting = traits.usable & table.places() & !table.behind;
        let mut alone = table.places() & !waiting;
        while waiting != 0 {
            let (alike, frame) = traits.alike(waiting);
            waiting &= !alike;
            let is_visited =
                if alike.count_ones() < LEAST_GROUP || table.is_wide(alike, &frame, MOST_SPREAD) {
                    false
                } else if alike == table.places() {
                    visit_group(&table, frame, largest, &mut space, visitor)
                } else {
                    visit_group(&table.only(alike), frame, largest, &mut space, visitor)
                };
            if !is_visited {
                alone |= alike;
            }
        }
        let mut rays = 0;
        while alone != 0 {
            let place = alone.trailing_zeros() as usize;
            alone &= alone - 1;
            rays |= 1 << table.rays[place];
        }
        rays
    }
}

/// # Safety
/// As for [`Lanes`].
#[inline(always)]
unsafe fn visit_group<L: Lanes>(
    table: &Table,
    frame: Frame,
    largest: f32,
    space: &mut Bundles<L>,
    visitor: &mut impl Visit<L>,
) -> bool {
    // SAFETY: the caller's promise.
    unsafe {
        let Some(group) = Group::new(table, frame, largest, space) else {
            return false;
        };
        visitor.visit(group, table);
    }
    true
}
