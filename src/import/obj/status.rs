//! The edges that a sweeping line crosses, in order. They come and go at any place: kept in blocks, so that no operation moves all.

/// Edges in a block of the status: a search costs its logarithm, an insertion its length.
const BLOCK: usize = 256;

/// The edges that cross the line, from left to right, each by its upper corner, in blocks.
#[derive(Debug, Default)]
pub(super) struct Status {
    blocks: Vec<Vec<u32>>,
}

/// A place between edges of the status: a block and a place in it.
pub(super) type Place = (usize, usize);

impl Status {
    /// The place before which all edges have `is_left`, and behind which none.
    pub(super) fn find(&self, is_left: impl Fn(u32) -> bool) -> Place {
        let is_before = |block: &Vec<u32>| block.last().is_some_and(|&edge| is_left(edge));
        let block = self.blocks.partition_point(is_before);
        let within = self.blocks.get(block);
        (
            block,
            within.map_or(0, |b| b.partition_point(|&edge| is_left(edge))),
        )
    }

    /// The edge before a place.
    pub(super) fn before(&self, (block, at): Place) -> Option<u32> {
        match at.checked_sub(1) {
            Some(at) => self.blocks.get(block)?.get(at).copied(),
            None => self.blocks.get(block.checked_sub(1)?)?.last().copied(),
        }
    }

    /// Puts an edge in at a place.
    pub(super) fn insert(&mut self, (block, at): Place, edge: u32) {
        if block == self.blocks.len() {
            // Behind all: at the end of the last block, if there is one.
            if let Some(last) = self.blocks.last_mut() {
                last.push(edge);
            } else {
                self.blocks.push(vec![edge]);
            }
        } else {
            self.blocks[block].insert(at, edge);
        }
        let block = block.min(self.blocks.len() - 1);
        if self.blocks[block].len() > BLOCK {
            let rest = self.blocks[block].split_off(BLOCK / 2);
            self.blocks.insert(block + 1, rest);
        }
    }

    /// Puts an edge in place of the one that ends there. `None` if another is there.
    pub(super) fn replace(&mut self, (block, at): Place, old: u32, new: u32) -> Option<()> {
        let edge = self.blocks.get_mut(block)?.get_mut(at)?;
        (*edge == old).then(|| *edge = new)
    }

    /// Takes out the edge that ends there. `None` if another is there.
    pub(super) fn remove(&mut self, (block, at): Place, old: u32) -> Option<()> {
        let edges = self.blocks.get_mut(block)?;
        if edges.get(at) != Some(&old) {
            return None;
        }
        edges.remove(at);
        if edges.is_empty() {
            self.blocks.remove(block);
        }
        Some(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn edges_come_and_go_in_order() {
        // Edges that are their own order; the numbers below 2000, scattered (7 has no factor of 2000).
        let mut status = Status::default();
        for edge in (0..2000).map(|i| i * 7 % 2000) {
            let place = status.find(|e| e < edge);
            status.insert(place, edge);
        }
        assert!(
            status
                .blocks
                .iter()
                .all(|b| !b.is_empty() && b.len() <= BLOCK)
        );
        assert_eq!(status.blocks.concat(), (0..2000).collect::<Vec<u32>>());
        for edge in (0..2000).map(|i| i * 3 % 2000) {
            let place = status.find(|e| e < edge);
            let before = status.before(place);
            assert_eq!(status.replace(place, edge + 1, 7), None);
            assert_eq!(status.replace(place, edge, edge), Some(()));
            assert_eq!(status.remove(place, edge + 1), None);
            assert_eq!(status.remove(place, edge), Some(()));
            assert_eq!(status.before(status.find(|e| e < edge)), before);
        }
        assert!(status.blocks.is_empty());
        let end = status.find(|_| true);
        assert_eq!((status.before(end), status.remove(end, 0)), (None, None));
    }
}
