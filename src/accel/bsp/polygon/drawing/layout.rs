//! Where the nodes of a drawn tree stand: as close as their widths allow, parents over the middle of their children, and equal subtrees drawn equally.
//!
//! After Reingold and Tilford 1981, "Tidier Drawings of Trees": a subtree is laid out once, and moved as a whole until its outline is clear of its sibling's.

/// A node to be placed.
pub(super) struct Item {
    /// In pixels.
    pub(super) width: f64,
    /// What is behind and what is in front: numbers greater than the item's own.
    pub(super) children: [Option<usize>; 2],
}

/// Free room between neighbours, in pixels.
const GAP: f64 = 14.0;

/// How far an only child stands beside its parent, in pixels: on its side, so that it is seen which of the two it is.
const ASIDE: f64 = 26.0;

/// Left and right end on each level below an item, itself first, from its middle.
type Outline = Vec<(f64, f64)>;

/// The middles of the items, in pixels from the left end of the drawing, and its width. The first item is the root, and children come after their parents.
pub(super) fn place(items: &[Item]) -> (Vec<f64>, f64) {
    let mut outlines: Vec<Outline> = items.iter().map(|_| Vec::new()).collect();
    let mut shifts = vec![0.0; items.len()];
    for number in (0..items.len()).rev() {
        let item = &items[number];
        let mut outline = vec![(-item.width / 2.0, item.width / 2.0)];
        let moved = match item.children {
            [Some(left), Some(right)] => {
                let pairs = outlines[left].iter().zip(&outlines[right]);
                let apart = pairs.map(|(l, r)| l.1 - r.0 + GAP).fold(0.0_f64, f64::max);
                vec![(left, -apart / 2.0), (right, apart / 2.0)]
            }
            [Some(left), None] => vec![(left, -ASIDE)],
            [None, Some(right)] => vec![(right, ASIDE)],
            [None, None] => Vec::new(),
        };
        for (child, shift) in moved {
            shifts[child] = shift;
            for (level, (left, right)) in
                std::mem::take(&mut outlines[child]).into_iter().enumerate()
            {
                let (left, right) = (left + shift, right + shift);
                match outline.get_mut(level + 1) {
                    Some(ends) => *ends = (ends.0.min(left), ends.1.max(right)),
                    None => outline.push((left, right)),
                }
            }
        }
        outlines[number] = outline;
    }
    let ends = outlines.first().into_iter().flatten();
    let (left, right) = ends.fold((0.0_f64, 0.0_f64), |(a, b), &(l, r)| (a.min(l), b.max(r)));
    let mut middles = vec![-left; items.len()];
    for (number, item) in items.iter().enumerate() {
        for child in item.children.into_iter().flatten() {
            middles[child] = middles[number] + shifts[child];
        }
    }
    (middles, right - left)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn item(width: f64, children: [Option<usize>; 2]) -> Item {
        Item { width, children }
    }

    #[test]
    fn nothing_overlaps_and_parents_stand_over_the_middle() {
        // The right subtree is narrow above and wide below.
        let items = [
            item(40.0, [Some(1), Some(2)]),
            item(30.0, [None, Some(3)]),
            item(20.0, [Some(4), Some(5)]),
            item(90.0, [None, None]),
            item(70.0, [None, None]),
            item(50.0, [None, None]),
        ];
        let (x, width) = place(&items);
        assert!((x[0] - (x[1] + x[2]) / 2.0).abs() < 1e-9);
        assert!((x[3] - x[1] - ASIDE).abs() < 1e-9);
        for [a, b] in [[1, 2], [3, 4], [4, 5]] {
            assert!(x[b] - x[a] >= (items[a].width + items[b].width) / 2.0 + GAP - 1e-9);
        }
        let fits = |(x, i): (&f64, &Item)| x - i.width / 2.0 >= 0.0 && x + i.width / 2.0 <= width;
        assert!(x.iter().zip(&items).all(fits));
    }
}
