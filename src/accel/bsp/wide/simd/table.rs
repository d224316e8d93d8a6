//! Rays turned from one record each to rows of each coordinate.

use super::super::node::WIDTH;
use super::bundle::{Frame, Given};
use super::kernel::Lanes;
use crate::geometry::Ray;

/// Rays of a group at most: those of a tile of 8 x 8 pixels, and the bits of a mask.
pub(in super::super) const GROUP: usize = 64;

/// The rays' places in the group: as if they came row by row from a tile of 8 x 8 pixels, those of 4 x 2 pixels come together.
const ORDER: [u8; GROUP] = {
    let mut order = [0; GROUP];
    let mut place = 0;
    while place < GROUP {
        let (column, row) = (place & 3 | place >> 1 & 4, place >> 2 & 1 | place >> 3 & 6);
        order[place] = (row * 8 + column) as u8;
        place += 1;
    }
    order
};

/// Rays by place: a row for each coordinate of origins, directions, intervals.
#[derive(Clone)]
pub(super) struct Table {
    rows: [[f32; GROUP]; 8],
    /// Which rays they are, in the order they were given.
    pub(super) rays: [u8; GROUP],
    pub(super) count: usize,
    /// The places of rays that continue behind a hit.
    pub(super) behind: u64,
}

impl Table {
    const EMPTY: Self = Self {
        rows: [[0.0; GROUP]; 8],
        rays: [0; GROUP],
        count: 0,
        behind: 0,
    };

    /// Of up to [`GROUP`] rays, one at least.
    #[inline(always)]
    pub(super) fn of(rays: &[Ray]) -> Self {
        let mut table = Self::EMPTY;
        if let Ok(rays) = <&[Ray; GROUP]>::try_from(rays) {
            for (place, index) in ORDER.into_iter().enumerate() {
                table.put(place, index, &rays[usize::from(index) % GROUP]);
            }
            table.count = GROUP;
            return table;
        }
        for index in ORDER {
            if let Some(ray) = rays.get(usize::from(index)) {
                table.put(table.count, index, ray);
                table.count += 1;
            }
        }
        table.fill();
        table
    }

    #[inline(always)]
    fn put(&mut self, place: usize, index: u8, ray: &Ray) {
        let (o, d) = (ray.origin, ray.direction);
        let row = [
            o.x,
            o.y,
            o.z,
            d.x,
            d.y,
            d.z,
            ray.interval.min,
            ray.interval.max,
        ];
        for (values, value) in self.rows.iter_mut().zip(row) {
            values[place] = value;
        }
        self.rays[place] = index;
        self.behind |= u64::from(ray.behind.is_some()) << place;
    }

    /// The rays of these places alone.
    #[inline(never)]
    pub(super) fn only(&self, mut places: u64) -> Self {
        let mut table = Self::EMPTY;
        while places != 0 {
            let from = places.trailing_zeros() as usize;
            places &= places - 1;
            for (row, own) in self.rows.iter().zip(&mut table.rows) {
                own[table.count] = row[from];
            }
            table.rays[table.count] = self.rays[from];
            table.count += 1;
        }
        table.fill();
        table
    }

    /// Copies of the last ray fill the places up to the next vector's end.
    #[inline(always)]
    fn fill(&mut self) {
        let end = self.count.next_multiple_of(WIDTH);
        if self.count < end {
            for row in &mut self.rows {
                let last = row[self.count - 1];
                row[self.count..end].fill(last);
            }
        }
    }

    /// As many places as there are lanes, from this on; coordinates in the order of these axes.
    ///
    /// # Safety
    /// As for [`Lanes`].
    #[inline(always)]
    pub(super) unsafe fn load<L: Lanes>(&self, place: usize, axes: [usize; 3]) -> Given<L> {
        assert!(place + WIDTH <= GROUP && axes[0] < 3 && axes[1] < 3 && axes[2] < 3);
        // SAFETY: the caller's promise.
        unsafe {
            Given {
                origin: [
                    L::load(self.rows[axes[0]].as_ptr().add(place)),
                    L::load(self.rows[axes[1]].as_ptr().add(place)),
                    L::load(self.rows[axes[2]].as_ptr().add(place)),
                ],
                direction: [
                    L::load(self.rows[3 + axes[0]].as_ptr().add(place)),
                    L::load(self.rows[3 + axes[1]].as_ptr().add(place)),
                    L::load(self.rows[3 + axes[2]].as_ptr().add(place)),
                ],
                interval: [
                    L::load(self.rows[6].as_ptr().add(place)),
                    L::load(self.rows[7].as_ptr().add(place)),
                ],
            }
        }
    }

    /// Whether slopes lie so far apart, by more than `most`, that the rays make no group: a quick answer from three of them. The rays of these places are
    /// in the frame.
    #[inline(always)]
    pub(super) fn is_wide(&self, places: u64, frame: &Frame, most: f32) -> bool {
        let rest = places & (places - 1);
        let upper = places >> (GROUP / 2) << (GROUP / 2);
        let middle = if upper == 0 { rest } else { upper };
        let first = self.slopes(places.trailing_zeros() as usize, frame);
        let middle = self.slopes(middle.trailing_zeros() as usize, frame);
        let last = self.slopes(GROUP - 1 - places.leading_zeros() as usize, frame);
        let apart = (first[0] - middle[0])
            .abs()
            .max((first[1] - middle[1]).abs())
            .max((first[0] - last[0]).abs())
            .max((first[1] - last[1]).abs());
        apart > most
    }

    /// The slopes x / z and y / z of a direction in the frame.
    #[inline(always)]
    fn slopes(&self, place: usize, frame: &Frame) -> [f32; 2] {
        let [x, y, z] = frame.axes;
        let z = self.rows[3 + z][place];
        [self.rows[3 + x][place] / z, self.rows[3 + y][place] / z]
    }

    /// A bit for each place with a ray.
    #[inline(always)]
    pub(super) fn places(&self) -> u64 {
        u64::MAX >> (GROUP - self.count)
    }
}
