//! The cleaned text that `tobj` reads: a list of pieces of the file as it is and of text of our own.
//!
//! A clean file is passed through in a few large pieces, without a copy. Only lines that need mending are written anew.

use std::io::{BufRead, Read, Result};
use std::ops::Range;

/// A stretch of the file, or of our own text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Piece {
    /// Of the file.
    Source(Range<usize>),
    /// Of the text written by us.
    Own(Range<usize>),
}

/// Pieces in the order in which they are read. Neighbours that touch are joined.
#[derive(Clone, Debug, Default)]
pub(super) struct Pieces(Vec<Piece>);

impl Pieces {
    pub(super) fn push(&mut self, piece: Piece) {
        match (self.0.last_mut(), &piece) {
            (Some(Piece::Source(last)), Piece::Source(next))
            | (Some(Piece::Own(last)), Piece::Own(next))
                if last.end == next.start =>
            {
                last.end = next.end;
            }
            _ => self.0.push(piece),
        }
    }

    pub(super) fn append(&mut self, other: Pieces) {
        other.0.into_iter().for_each(|p| self.push(p));
    }
}

/// What pieces are stretches of.
pub(super) struct Store<'a> {
    source: &'a [u8],
    own: Vec<u8>,
}

impl<'a> Store<'a> {
    pub(super) fn new(source: &'a [u8]) -> Self {
        Self {
            source,
            own: Vec::new(),
        }
    }

    /// Writes text of our own.
    pub(super) fn write(&mut self, write: impl FnOnce(&mut Vec<u8>)) -> Piece {
        let start = self.own.len();
        write(&mut self.own);
        Piece::Own(start..self.own.len())
    }

    fn bytes(&self, piece: &Piece) -> &[u8] {
        match piece {
            Piece::Source(range) => &self.source[range.clone()],
            Piece::Own(range) => &self.own[range.clone()],
        }
    }

    /// The text of pieces, to be written anew.
    pub(super) fn copy(&self, pieces: &Pieces) -> Vec<u8> {
        pieces
            .0
            .iter()
            .flat_map(|p| self.bytes(p))
            .copied()
            .collect()
    }

    /// A reader of pieces.
    pub(super) fn reader<'r>(&'r self, pieces: &'r Pieces) -> impl BufRead + 'r {
        Reader {
            store: self,
            pieces: &pieces.0,
            rest: &[],
        }
    }
}

struct Reader<'a> {
    store: &'a Store<'a>,
    pieces: &'a [Piece],
    rest: &'a [u8],
}

impl Read for Reader<'_> {
    fn read(&mut self, into: &mut [u8]) -> Result<usize> {
        let length = self.fill_buf()?.read(into)?;
        self.consume(length);
        Ok(length)
    }
}

impl BufRead for Reader<'_> {
    fn fill_buf(&mut self) -> Result<&[u8]> {
        while self.rest.is_empty()
            && let [first, later @ ..] = self.pieces
        {
            self.rest = self.store.bytes(first);
            self.pieces = later;
        }
        Ok(self.rest)
    }

    fn consume(&mut self, amount: usize) {
        self.rest = &self.rest[amount..];
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn touching_pieces_join_and_read_in_order() {
        let mut store = Store::new(b"ab\ncd\nef\n");
        let mut pieces = Pieces::default();
        pieces.push(Piece::Source(0..3));
        pieces.push(Piece::Source(3..6));
        let own = store.write(|t| t.extend_from_slice(b"x\n"));
        pieces.push(own);
        pieces.push(Piece::Source(6..9));
        assert_eq!(pieces.0.len(), 3);
        let lines: Vec<String> = store.reader(&pieces).lines().map(Result::unwrap).collect();
        assert_eq!(lines, ["ab", "cd", "x", "ef"]);
        assert_eq!(store.copy(&pieces), b"ab\ncd\nx\nef\n");
    }
}
