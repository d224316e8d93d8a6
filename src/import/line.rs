//! Texts of files and of foreign crates, made fit for a line of a message.

/// Most characters of an element or a cause in a message: names and messages of parsers cite the file, which may hold a name of any length.
const MOST_CHARACTERS: usize = 400;

/// Characters kept at the end of a text that is too long: what to do about an error stands there.
const END: usize = 120;

/// The text in one line: control characters, with which a file could also write over the terminal, become blanks, and the middle
/// of a long text is left out.
pub(super) fn one_line(text: impl Into<String>) -> String {
    let mut text: String = text.into();
    if text.contains(is_unfit) {
        text = text.replace(is_unfit, " ");
    }
    // A character has at least one byte.
    if text.len() <= MOST_CHARACTERS {
        return text;
    }
    let place = |(place, _): (usize, char)| place;
    let start = text.char_indices().nth(MOST_CHARACTERS - END).map(place);
    let end = text.char_indices().rev().nth(END - 1).map(place);
    match (start, end) {
        (Some(start), Some(end)) if start < end => {
            format!("{} ... {}", &text[..start], &text[end..])
        }
        _ => text,
    }
}

/// Control characters, separators of lines and paragraphs, and marks that turn the direction of the text.
fn is_unfit(c: char) -> bool {
    c.is_control()
        || matches!(c, '\u{2028}' | '\u{2029}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn foreign_texts_become_one_line() {
        assert_eq!(one_line("a\nb\u{1b}[2J\u{2028}c\u{202e}d"), "a b [2J c d");
        assert_eq!(one_line("caf\u{e9} 17"), "caf\u{e9} 17");
    }

    #[test]
    fn the_middle_of_a_long_text_is_left_out() {
        let text = format!("begin {} end", "\u{e9}".repeat(100_000));
        let line = one_line(text);
        assert!(line.starts_with("begin ") && line.ends_with(" end"));
        assert_eq!(line.chars().count(), MOST_CHARACTERS + 5);
        let few = "\u{e9}".repeat(MOST_CHARACTERS - 1);
        assert_eq!(one_line(few.clone()), few);
    }
}
