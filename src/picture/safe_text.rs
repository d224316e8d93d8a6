//! Texts for formats that hold bytes of no declared encoding.

/// Escapes what is not ASCII, and control characters other than line break and tab, as JSON does: `é` becomes `\u00e9`.
///
/// A JSON text stays one and means the same. Backslashes stay as they are, so that the way back is the reader's: only one who
/// knows that the text is JSON can tell an escape from the same six characters.
pub(super) fn ascii(text: &str) -> String {
    let mut safe = String::with_capacity(text.len());
    let mut units = [0; 2];
    for c in text.chars() {
        if matches!(c, ' '..='~' | '\n' | '\t') {
            safe.push(c);
        } else {
            for unit in c.encode_utf16(&mut units) {
                safe.push_str(&format!("\\u{unit:04x}"));
            }
        }
    }
    safe
}

/// A text from bytes: UTF-8, as programs write today, or else Latin-1, as they did.
pub(super) fn from_bytes(bytes: &[u8]) -> String {
    match std::str::from_utf8(bytes) {
        Ok(text) => text.to_owned(),
        Err(_) => bytes.iter().map(|&byte| char::from(byte)).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn json_means_the_same_after_escaping() {
        let json = "{\"caf\u{e9} \u{4e2d} \u{1f980}\\n\": \"\u{7f}\"}";
        let safe = ascii(json);
        assert!(safe.is_ascii());
        assert_eq!(safe, r#"{"caf\u00e9 \u4e2d \ud83e\udd80\n": "\u007f"}"#);
        let parse = |text: &str| serde_json::from_str::<serde_json::Value>(text).unwrap();
        assert_eq!(parse(&safe), parse(json));
    }

    #[test]
    fn both_encodings_are_read() {
        assert_eq!(from_bytes("caf\u{e9}".as_bytes()), "caf\u{e9}");
        assert_eq!(from_bytes(b"caf\xe9"), "caf\u{e9}");
    }
}
