//! The statement `f`: corners `v`, `v/vt`, `v//vn` and `v/vt/vn`, counted from 1, or backwards from -1.

use std::io::Write;

use super::attributes::Counts;
use super::text::is_blank;

/// An index that is not given.
pub(super) const ABSENT: i64 = i64::MIN;

/// A corner as the file writes it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Corner {
    pub(super) v: i64,
    pub(super) vt: i64,
    pub(super) vn: i64,
}

/// A face whose corners could be read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Syntax {
    /// Whether it holds nothing but corners that `tobj` reads as we do.
    pub(super) is_plain: bool,
}

/// Reads the corners of a face into `corners`, up to a comment. `None` if one of them is not made of integers.
pub(super) fn parse(mut text: &[u8], corners: &mut Vec<Corner>) -> Option<Syntax> {
    corners.clear();
    let mut is_plain = true;
    loop {
        match text {
            [] => return Some(Syntax { is_plain }),
            [b'#', ..] => return Some(Syntax { is_plain: false }),
            [blank, rest @ ..] if is_blank(*blank) => {
                text = rest;
                continue;
            }
            _ => {}
        }
        let v = integer(&mut text)?;
        let (mut vt, mut vn) = (ABSENT, ABSENT);
        if let [b'/', rest @ ..] = text {
            text = rest;
            vt = optional_integer(&mut text)?;
            if let [b'/', rest @ ..] = text {
                text = rest;
                vn = optional_integer(&mut text)?;
            }
        }
        match text {
            [] => {}
            [b'#', ..] => is_plain = false,
            [blank, ..] if is_blank(*blank) => {}
            _ => return None,
        }
        corners.push(Corner { v, vt, vn });
    }
}

fn optional_integer(text: &mut &[u8]) -> Option<i64> {
    match text {
        [b'+' | b'-' | b'0'..=b'9', ..] => integer(text),
        _ => Some(ABSENT),
    }
}

/// An integer; one beyond 10^17 becomes some other that is as far out of range.
#[inline]
fn integer(text: &mut &[u8]) -> Option<i64> {
    let mut rest = *text;
    let is_negative = matches!(rest, [b'-', ..]);
    if let [b'+' | b'-', digits @ ..] = rest {
        rest = digits;
    }
    let digits = rest.len();
    let mut value = 0_i64;
    while let [digit @ b'0'..=b'9', behind @ ..] = rest {
        value = (value * 10 + i64::from(digit - b'0')).min(i64::MAX / 16);
        rest = behind;
    }
    *text = rest;
    (rest.len() < digits).then_some(if is_negative { -value } else { value })
}

/// An index as counted from 1, or `None` for 0 and for one that counts back beyond the first.
pub(super) fn from_start(index: i64, count: usize) -> Option<usize> {
    let index = if index < 0 {
        count as i64 + 1 + index
    } else {
        index
    };
    usize::try_from(index).ok().filter(|&i| i > 0)
}

/// Whether fewer than three different positions are among the corners.
pub(super) fn has_too_few_corners(corners: &[Corner]) -> bool {
    if let [a, b, c] = corners {
        return a.v == b.v || b.v == c.v || a.v == c.v;
    }
    let Some(first) = corners.first() else {
        return true;
    };
    let Some(second) = corners.iter().find(|c| c.v != first.v) else {
        return true;
    };
    !corners.iter().any(|c| c.v != first.v && c.v != second.v)
}

/// Writes a face statement.
pub(super) fn write(out: &mut Vec<u8>, corners: &[Corner]) {
    out.push(b'f');
    for corner in corners {
        // Writing to a vector cannot fail.
        let _ = match (corner.vt, corner.vn) {
            (ABSENT, ABSENT) => write!(out, " {}", corner.v),
            (vt, ABSENT) => write!(out, " {}/{vt}", corner.v),
            (ABSENT, vn) => write!(out, " {}//{vn}", corner.v),
            (vt, vn) => write!(out, " {}/{vt}/{vn}", corner.v),
        };
    }
    out.push(b'\n');
}

/// The indices that stand for "none" once faces are aligned.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pads {
    /// Of a zero texture coordinate.
    pub(super) vt: usize,
    /// Of a zero normal.
    pub(super) vn: usize,
}

/// The face statements of an object again, such that either all corners have texture coordinates or none has, and the same
/// for normals. Indices beyond `counts` (those of the file) count as absent.
///
/// `tobj` pairs the lists by position and misplaces them without an error otherwise.
pub(super) fn aligned(text: &[u8], counts: Counts, pads: Pads) -> Vec<u8> {
    let in_range = |index: i64, count: usize| if index > count as i64 { ABSENT } else { index };
    let mut corners = Vec::new();
    let mut each_face = |visit: &mut dyn FnMut(&mut [Corner])| {
        for line in text.split(|&b| b == b'\n').filter(|l| !l.is_empty()) {
            let corners_of_line =
                &line[line.iter().position(|&b| b == b'f').map_or(0, |f| f + 1)..];
            if parse(corners_of_line, &mut corners).is_some() {
                for corner in &mut corners {
                    corner.vt = in_range(corner.vt, counts.vt);
                    corner.vn = in_range(corner.vn, counts.vn);
                }
                visit(&mut corners);
            }
        }
    };
    let (mut any_vt, mut any_vn) = (false, false);
    each_face(&mut |corners| {
        any_vt |= corners.iter().any(|c| c.vt != ABSENT);
        any_vn |= corners.iter().any(|c| c.vn != ABSENT);
    });
    let mut out = Vec::with_capacity(text.len() * 5 / 4);
    each_face(&mut |corners| {
        for corner in corners.iter_mut() {
            if any_vt && corner.vt == ABSENT {
                corner.vt = pads.vt as i64;
            }
            if any_vn && corner.vn == ABSENT {
                corner.vn = pads.vn as i64;
            }
        }
        write(&mut out, corners);
    });
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    type Indices = Vec<(i64, i64, i64)>;

    fn read(text: &str) -> Option<(Indices, bool)> {
        let mut corners = Vec::new();
        let syntax = parse(text.as_bytes(), &mut corners)?;
        Some((
            corners.iter().map(|c| (c.v, c.vt, c.vn)).collect(),
            syntax.is_plain,
        ))
    }

    #[test]
    fn every_form_of_corner_is_read() {
        let a = ABSENT;
        assert_eq!(
            read(" 1 2/3\t4//5 +6/7/8 9/ 1/2/ "),
            Some((
                vec![
                    (1, a, a),
                    (2, 3, a),
                    (4, a, 5),
                    (6, 7, 8),
                    (9, a, a),
                    (1, 2, a)
                ],
                true
            ))
        );
        assert_eq!(
            read("1 2 3 # x"),
            Some((vec![(1, a, a), (2, a, a), (3, a, a)], false))
        );
        assert_eq!(read("1 2 -3#x").map(|r| r.1), Some(false));
        for broken in ["1 2 x", "1/2/3/4", "1.0 2 3", "/1", "1 - 2"] {
            assert_eq!(read(broken), None, "{broken}");
        }
    }

    #[test]
    fn backward_indices_count_from_the_end() {
        assert_eq!(
            [1, -1, -4, -5, 0].map(|i| from_start(i, 4)),
            [Some(1), Some(4), Some(1), None, None]
        );
        assert_eq!(from_start(i64::MAX / 16, 4), Some((i64::MAX / 16) as usize));
        assert_eq!(
            read("99999999999999999999999 1 2").map(|r| r.0[0].0),
            Some(i64::MAX / 16)
        );
    }

    #[test]
    fn corners_are_told_apart_by_position() {
        let few = |text: &str| {
            let mut corners = Vec::new();
            parse(text.as_bytes(), &mut corners);
            has_too_few_corners(&corners)
        };
        assert!(few("") && few("1") && few("1 2") && few("1/1 1/2 2") && few("1 2 1 2 1"));
        assert!(!few("1 2 3") && !few("1 1 2 2 3"));
    }

    #[test]
    fn mixed_corners_are_aligned() {
        let counts = Counts { v: 9, vt: 2, vn: 0 };
        let text = aligned(
            b"f 1 2 3\n f 1/1 2/2 3/9\r\nf 4//1 5 6\n",
            counts,
            Pads { vt: 3, vn: 1 },
        );
        assert_eq!(
            String::from_utf8(text).unwrap(),
            "f 1/3 2/3 3/3\nf 1/1 2/2 3/3\nf 4/3 5/3 6/3\n"
        );
    }
}
