//! Words beside the points of a chart: each where it covers neither a mark nor other words, as near to its point as can be.

use super::draw::{CHARACTER, LINE};

/// Half the width and height that a mark keeps free, in units.
const MARK: i32 = 6;

/// Distance of words from the middle of their mark, in units.
const GAP: i32 = 8;

/// Steps that are tried above and below a point, each half a line.
const TRIES: i32 = 40;

/// What is taken, in units, y downwards.
#[derive(Clone, Copy, Debug)]
struct Taken {
    left: i32,
    right: i32,
    top: i32,
    bottom: i32,
}

impl Taken {
    fn meets(&self, other: &Self) -> bool {
        self.left < other.right
            && other.left < self.right
            && self.top < other.bottom
            && other.top < self.bottom
    }

    fn holds(&self, other: &Self) -> bool {
        self.left <= other.left
            && other.right <= self.right
            && self.top <= other.top
            && other.bottom <= self.bottom
    }
}

/// Where words go, in units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Place {
    /// The end of the words that is next to the point.
    pub(super) x: i32,
    /// The bottom of their line.
    pub(super) bottom: i32,
    /// At the point's left.
    pub(super) is_left: bool,
    /// So far from the point that a line must lead to it.
    pub(super) is_far: bool,
}

/// The words of one chart.
pub(super) struct Labels {
    room: Taken,
    taken: Vec<Taken>,
}

impl Labels {
    /// Within so much room (left, right, top, bottom), around marks at these heights, each from one end of its interval to the other.
    pub(super) fn new(
        [left, right, top, bottom]: [i32; 4],
        marks: impl Iterator<Item = ([i32; 2], i32)>,
    ) -> Self {
        let mark = |([from, to], y): ([i32; 2], i32)| Taken {
            left: from - MARK,
            right: to + MARK,
            top: y - MARK,
            bottom: y + MARK,
        };
        Self {
            room: Taken {
                left,
                right,
                top,
                bottom,
            },
            taken: marks.map(mark).collect(),
        }
    }

    /// Takes a place for words beside a point: at its right, at its left, then further and further above and below. Where nothing is free they cover something.
    pub(super) fn place(&mut self, (x, y): (i32, i32), text: &str) -> Place {
        let width = CHARACTER * text.chars().count() as i32;
        let at = |step: i32, is_left: bool| {
            let bottom = y + LINE / 2 + step * LINE / 2;
            let left = if is_left { x - GAP - width } else { x + GAP };
            Taken {
                left,
                right: left + width,
                top: bottom - LINE,
                bottom,
            }
        };
        let is_free = |(step, is_left): &(i32, bool)| {
            let wanted = at(*step, *is_left);
            self.room.holds(&wanted) && !self.taken.iter().any(|t| t.meets(&wanted))
        };
        let steps = (0..TRIES).flat_map(|i| if i == 0 { vec![0] } else { vec![-i, i] });
        let mut tried = steps.flat_map(|step| [(step, false), (step, true)]);
        let (step, is_left) = tried
            .find(is_free)
            .unwrap_or((0, x + GAP + width > self.room.right));
        let taken = at(step, is_left);
        self.taken.push(taken);
        Place {
            x: if is_left { taken.right } else { taken.left },
            bottom: taken.bottom,
            is_left,
            is_far: step.abs() > 2,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_cover_neither_marks_nor_one_another() {
        // Twelve points in a place of one label, near the right end.
        let points: Vec<(i32, i32)> = (0..12).map(|i| (700 + i % 4, 300 + i / 4)).collect();
        let room = [74, 760, 60, 380];
        let marks = points.iter().map(|&(x, y)| ([x - 9, x + 3], y));
        let mut labels = Labels::new(room, marks);
        let marks = labels.taken.clone();
        for &point in &points {
            let place = labels.place(point, "bvh2:watertight");
            assert!(place.is_left, "there is no room at the right");
        }
        for (i, a) in labels.taken.iter().enumerate().skip(marks.len()) {
            assert!(labels.room.holds(a), "{a:?}");
            assert!(labels.taken[..i].iter().all(|b| !a.meets(b)), "{a:?}");
        }
    }

    #[test]
    fn a_lone_point_has_its_words_at_its_right() {
        let mut labels = Labels::new([0, 760, 0, 400], [([100, 100], 200)].into_iter());
        let place = labels.place((100, 200), "bsp");
        let want = Place {
            x: 108,
            bottom: 208,
            is_left: false,
            is_far: false,
        };
        assert_eq!(place, want);
    }
}
