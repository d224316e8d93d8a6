//! Numbers in OBJ and MTL: which of them a parser will take, and what the others mean.
//!
//! `tobj` gives up on a whole file for one number that Rust cannot parse. The check here is lexical and about five times
//! as fast as parsing, which then happens once, in `tobj`.

use super::text::{is_blank, tokens};

/// How many numbers a text holds, if it holds nothing but plain decimal numbers.
///
/// Plain: an optional sign, digits with an optional point, an optional exponent. Everything that this accepts, `f32`'s
/// parser accepts.
pub(super) fn count_plain(mut text: &[u8]) -> Option<usize> {
    let mut count = 0;
    loop {
        while let [blank, rest @ ..] = text
            && is_blank(*blank)
        {
            text = rest;
        }
        if text.is_empty() {
            return Some(count);
        }
        text = behind_sign(text);
        let whole = behind_digits(text);
        let mut has_digits = whole.len() < text.len();
        text = whole;
        if let [b'.', rest @ ..] = text {
            text = behind_digits(rest);
            has_digits |= text.len() < rest.len();
        }
        if !has_digits {
            return None;
        }
        if let [b'e' | b'E', rest @ ..] = text {
            let digits = behind_sign(rest);
            text = behind_digits(digits);
            if text.len() == digits.len() {
                return None;
            }
        }
        if text.first().is_some_and(|&b| !is_blank(b)) {
            return None;
        }
        count += 1;
    }
}

fn behind_sign(text: &[u8]) -> &[u8] {
    match text {
        [b'+' | b'-', rest @ ..] => rest,
        _ => text,
    }
}

fn behind_digits(mut text: &[u8]) -> &[u8] {
    while let [b'0'..=b'9', rest @ ..] = text {
        text = rest;
    }
    text
}

/// The numbers of a statement up to its comment; `None` for each token that is no number.
pub(super) fn parsed(text: &[u8]) -> impl Iterator<Item = Option<f32>> {
    tokens(text).map(parse)
}

/// A token as a number, also as C libraries of old write those that are none (`1.#QNAN`, `-1.#INF`), or with a comment
/// that touches it.
pub(super) fn parse(token: &[u8]) -> Option<f32> {
    let token = std::str::from_utf8(token).ok()?;
    if let Ok(value) = token.parse() {
        return Some(value);
    }
    let (number, mark) = token.split_once('#')?;
    let value: f32 = number.parse().ok()?;
    Some(match mark {
        "INF" | "INF00" => value * f32::INFINITY,
        m if m.starts_with("QNAN") || m.starts_with("SNAN") || m.starts_with("IND") => f32::NAN,
        _ => value,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn plain_numbers_are_those_that_rust_parses() {
        for token in [
            "1", "-1.", "+.5", "1e5", "1.e+05", "-.5E-3", "1e400", "", ".", "+", "-.", "1e", "1e+",
            "3.1+e2", "1,5", "1f", "0x10", "--1", "1.2.3", "e5",
        ] {
            let plain = count_plain(token.as_bytes()) == Some(1);
            assert_eq!(plain, token.parse::<f32>().is_ok(), "{token:?}");
        }
        assert_eq!(count_plain(b"  1\t2 3 \r"), Some(3));
        assert_eq!(count_plain(b"1 2 # 3"), None);
    }

    #[test]
    fn numbers_that_are_none_keep_their_meaning() {
        assert!(parse(b"-1.#IND").unwrap().is_nan());
        assert!(parse(b"1.#QNAN0").unwrap().is_nan());
        assert_eq!(parse(b"-1.#INF"), Some(f32::NEG_INFINITY));
        assert_eq!(parse(b"2.5#note"), Some(2.5));
        assert_eq!(parse(b"3.1+e2"), None);
        assert_eq!(parse(b"inf"), Some(f32::INFINITY));
    }
}
