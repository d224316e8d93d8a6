//! From the bytes of an OBJ or MTL file to its logical lines.
//!
//! The formats name no encoding and no line end. Files in the wild begin with a byte order mark, end their lines in
//! CR LF, LF or CR, continue them with a backslash, and name their parts in UTF-8 or Latin-1.

use std::borrow::Cow;
use std::io::BufRead;
use std::ops::Range;

/// The file's bytes without byte order mark, with every line ended by LF or CR LF. UTF-16 (with a mark) becomes UTF-8.
pub(super) fn with_plain_line_ends(bytes: &[u8]) -> Cow<'_, [u8]> {
    let decode = |value: fn([u8; 2]) -> u16| {
        let units: Vec<u16> = bytes[2..]
            .chunks_exact(2)
            .map(|c| value([c[0], c[1]]))
            .collect();
        Cow::Owned(String::from_utf16_lossy(&units).into_bytes())
    };
    let mut text = match bytes {
        [0xef, 0xbb, 0xbf, rest @ ..] => Cow::Borrowed(rest),
        [0xff, 0xfe, ..] => decode(u16::from_le_bytes),
        [0xfe, 0xff, ..] => decode(u16::from_be_bytes),
        _ => Cow::Borrowed(bytes),
    };
    let is_lone = |text: &[u8], i: usize| text[i] == b'\r' && text.get(i + 1) != Some(&b'\n');
    if text.contains(&b'\r') && (0..text.len()).any(|i| is_lone(&text, i)) {
        let text = text.to_mut();
        for i in 0..text.len() {
            if is_lone(text, i) {
                text[i] = b'\n';
            }
        }
    }
    text
}

/// Bytes as text: UTF-8 if they are, else Latin-1 (every byte a character).
pub(super) fn decoded(bytes: &[u8]) -> Cow<'_, str> {
    match std::str::from_utf8(bytes) {
        Ok(text) => Cow::Borrowed(text),
        Err(_) => Cow::Owned(bytes.iter().map(|&b| char::from(b)).collect()),
    }
}

/// What separates tokens inside a line.
pub(super) const fn is_blank(byte: u8) -> bool {
    matches!(byte, b' ' | b'\t' | b'\r' | 0x0b | 0x0c)
}

/// A logical line.
pub(super) struct Line<'a> {
    /// Number of the line, or of its first one if it is continued, from 1.
    pub(super) number: usize,
    /// What it says, without line end; continuations are joined by a blank.
    pub(super) text: Cow<'a, [u8]>,
    /// Where it stands with its line feed, or `None` if it does not stand there in one line with a line feed.
    pub(super) span: Option<Range<usize>>,
}

/// The logical lines of a text whose line ends are plain.
pub(super) struct Lines<'a> {
    source: &'a [u8],
    next: usize,
    lines_read: usize,
}

impl<'a> Lines<'a> {
    pub(super) fn new(source: &'a [u8]) -> Self {
        Self {
            source,
            next: 0,
            lines_read: 0,
        }
    }

    /// The next physical line without its line feed, and whether it has one.
    fn physical(&mut self) -> (&'a [u8], bool) {
        let rest = &self.source[self.next..];
        self.lines_read += 1;
        // The standard library's fast search for a byte; reading from a slice cannot fail.
        let length = (&mut &*rest).skip_until(b'\n').unwrap_or(rest.len());
        self.next += length;
        match rest[..length] {
            [ref line @ .., b'\n'] => (line, true),
            ref line => (line, false),
        }
    }
}

impl<'a> Iterator for Lines<'a> {
    type Item = Line<'a>;

    fn next(&mut self) -> Option<Line<'a>> {
        if self.next == self.source.len() {
            return None;
        }
        let start = self.next;
        let (first, has_line_feed) = self.physical();
        let number = self.lines_read;
        let Some(mut text) = continued(first) else {
            return Some(Line {
                number,
                text: Cow::Borrowed(first),
                span: has_line_feed.then_some(start..self.next),
            });
        };
        let mut joined = Vec::new();
        loop {
            joined.extend_from_slice(text);
            joined.push(b' ');
            if self.next == self.source.len() {
                break;
            }
            let (line, _) = self.physical();
            match continued(line) {
                Some(part) => text = part,
                None => {
                    joined.extend_from_slice(line);
                    break;
                }
            }
        }
        Some(Line {
            number,
            text: Cow::Owned(joined),
            span: None,
        })
    }
}

/// The line without its backslash, if it has one at its end. A comment is not continued: paths of Windows end like this.
fn continued(line: &[u8]) -> Option<&[u8]> {
    let end = line.iter().rposition(|&b| !is_blank(b))?;
    if line[end] != b'\\' {
        return None;
    }
    let is_comment = line.iter().find(|&&b| !is_blank(b)) == Some(&b'#');
    (!is_comment).then_some(&line[..end])
}

/// The line's keyword, and what follows it, without blanks around. The keyword is empty on an empty line.
pub(super) fn keyword(line: &[u8]) -> (&[u8], &[u8]) {
    let line = trimmed(line);
    let end = line.iter().position(|&b| is_blank(b)).unwrap_or(line.len());
    (&line[..end], trimmed(&line[end..]))
}

/// Without blanks around.
pub(super) fn trimmed(mut text: &[u8]) -> &[u8] {
    while let [first, rest @ ..] = text
        && is_blank(*first)
    {
        text = rest;
    }
    while let [rest @ .., last] = text
        && is_blank(*last)
    {
        text = rest;
    }
    text
}

/// The tokens of a statement, up to a comment: a token that starts with `#`.
pub(super) fn tokens(text: &[u8]) -> impl Iterator<Item = &[u8]> {
    text.split(|&b| is_blank(b))
        .filter(|t| !t.is_empty())
        .take_while(|t| t[0] != b'#')
}

/// The text before a comment, or `None` if there is no comment.
pub(super) fn before_comment(text: &str) -> Option<&str> {
    let at = text
        .match_indices('#')
        .find(|(i, _)| text[..*i].ends_with([' ', '\t']))?
        .0;
    Some(text[..at].trim_end())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lines(source: &[u8]) -> Vec<(usize, String, bool)> {
        Lines::new(source)
            .map(|l| (l.number, decoded(&l.text).into_owned(), l.span.is_some()))
            .collect()
    }

    #[test]
    fn continued_lines_are_one_line_with_the_first_one_s_number() {
        let found = lines(b"a\nf 1 \\\r\n 2 \\\n3\nb \\");
        let expected = [(1, "a", true), (2, "f 1   2  3", false), (5, "b  ", false)];
        assert_eq!(found, expected.map(|(n, t, v)| (n, t.to_owned(), v)));
    }

    #[test]
    fn a_comment_does_not_swallow_the_next_line() {
        assert_eq!(lines(b"# c:\\\nv 1 2 3").len(), 2);
    }

    #[test]
    fn every_line_end_and_mark_is_read() {
        assert_eq!(
            &*with_plain_line_ends(b"\xef\xbb\xbfa\rb\r\nc\r"),
            b"a\nb\r\nc\n"
        );
        assert_eq!(&*with_plain_line_ends(b"\xff\xfev\0\n\0"), b"v\n");
        assert_eq!(&*with_plain_line_ends(b"\xfe\xff\0v"), b"v");
    }

    #[test]
    fn bytes_that_are_no_utf8_are_latin_1() {
        assert_eq!(decoded(b"caf\xe9"), "caf\u{e9}");
        assert_eq!(decoded("caf\u{e9}".as_bytes()), "caf\u{e9}");
    }

    #[test]
    fn a_comment_starts_at_a_token() {
        assert_eq!(tokens(b" 1 2\t# 3 4").count(), 2);
        assert_eq!(before_comment("Material #25"), Some("Material"));
        assert_eq!(before_comment("Material_#25"), None);
    }
}
