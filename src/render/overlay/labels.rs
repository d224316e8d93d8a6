//! Where names of objects go: next to their screen extents, inside the picture, and never over one another.

use crate::accel::extents::ScreenExtent;

/// Share of the picture that names may hide, all together. Where they would hide more, the names of the smallest objects are left out.
const MOST_HIDDEN: f64 = 0.0625;

/// A rectangle, given by its left, top, right and bottom edges, in pixels from the picture's top left corner.
pub(super) type Frame = [i64; 4];

fn overlap(a: &Frame, b: &Frame) -> bool {
    a[0] < b[2] && b[0] < a[2] && a[1] < b[3] && b[1] < a[3]
}

/// Places names, given with their extents and their sizes in pixels. Those of the largest extents come first, in the order given among equals. `taken` are places where
/// no name may go. Names for which there is no place get none.
pub(super) fn place(
    picture: (u32, u32),
    taken: &[Frame],
    names: &[(ScreenExtent, (u32, u32))],
) -> Vec<Option<Frame>> {
    let mut order: Vec<usize> = (0..names.len()).collect();
    order.sort_by_key(|&i| std::cmp::Reverse(names[i].0.area()));
    let mut taken = taken.to_vec();
    let mut places = vec![None; names.len()];
    let mut left = MOST_HIDDEN * f64::from(picture.0) * f64::from(picture.1);
    for index in order {
        let (extent, size) = &names[index];
        left -= f64::from(size.0) * f64::from(size.1);
        if left < 0.0 {
            break;
        }
        let free = |frame: &Frame| {
            let picture = [0, 0, i64::from(picture.0), i64::from(picture.1)];
            let is_inside =
                frame[0] >= 0 && frame[1] >= 0 && frame[2] <= picture[2] && frame[3] <= picture[3];
            is_inside && !taken.iter().any(|other| overlap(frame, other))
        };
        let found = candidates(extent, *size, picture.0).into_iter().find(free);
        taken.extend(found);
        places[index] = found;
    }
    places
}

/// Places for a name, the best first: on the extent's top edge, in its upper corners, below it, in its lower corners; at its left end and at its right end.
fn candidates(extent: &ScreenExtent, (width, height): (u32, u32), columns: u32) -> [Frame; 8] {
    let [width, height] = [width, height].map(i64::from);
    let [left, top] = [extent.left, extent.top].map(i64::from);
    let [right, bottom] = [extent.right, extent.bottom].map(|last| i64::from(last) + 1);
    // A narrow object at the picture's right border has its name shifted inwards.
    let most = (i64::from(columns) - width).max(0);
    let [left, right] = [left.min(most), (right - width).max(0)];
    [
        (left, top - height),
        (left, top),
        (right, top - height),
        (right, top),
        (left, bottom),
        (left, bottom - height),
        (right, bottom),
        (right, bottom - height),
    ]
    .map(|(x, y)| [x, y, x + width, y + height])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn extent([left, top, right, bottom]: [u32; 4]) -> ScreenExtent {
        ScreenExtent {
            left,
            right,
            top,
            bottom,
        }
    }

    #[test]
    fn a_name_sits_on_its_extent_or_within_where_there_is_no_room_above() {
        let names = [
            (extent([30, 50, 90, 99]), (40, 10)),
            (extent([0, 0, 199, 149]), (40, 10)),
            (extent([190, 80, 199, 90]), (40, 10)),
        ];
        let found = place((200, 150), &[], &names);
        let want = [[30, 40, 70, 50], [0, 0, 40, 10], [160, 70, 200, 80]];
        assert_eq!(found, want.map(Some));
        // A legend in the upper left corner.
        let found = place((200, 150), &[[0, 0, 60, 45]], &names);
        let want = [[30, 50, 70, 60], [160, 0, 200, 10], [160, 70, 200, 80]];
        assert_eq!(found, want.map(Some));
    }

    #[test]
    fn names_of_many_objects_neither_overlap_nor_hide_the_picture() {
        let size = (320, 240);
        let mut state = 7_u32;
        let mut random = |end: u32| {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 16) % end
        };
        let names: Vec<_> = (0..500)
            .map(|_| {
                let (x, y) = (random(300), random(220));
                let (right, bottom) = (x + random(320 - x), y + random(240 - y));
                (extent([x, y, right, bottom]), (8 * (1 + random(6)), 18))
            })
            .collect();
        let places = place(size, &[], &names);
        let found: Vec<&Frame> = places.iter().flatten().collect();
        assert!(found.len() > 10);
        let area: i64 = found.iter().map(|f| (f[2] - f[0]) * (f[3] - f[1])).sum();
        assert!(area <= 320 * 240 / 16);
        for (i, a) in found.iter().enumerate() {
            assert!(
                a[0] >= 0 && a[1] >= 0 && a[2] <= 320 && a[3] <= 240,
                "{a:?}"
            );
            assert!(found[..i].iter().all(|b| !overlap(a, b)), "{a:?}");
        }
        // The largest has its name.
        let largest = (0..500).max_by_key(|&i| (names[i].0.area(), std::cmp::Reverse(i)));
        assert!(places[largest.unwrap()].is_some());
        // A name that is larger than the picture.
        let huge = [(extent([0, 0, 9, 9]), (400, 18))];
        assert_eq!(place(size, &[], &huge), [None]);
    }
}
