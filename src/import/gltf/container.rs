//! The outer layer: a GLB's chunks, or plain JSON.
//!
//! glTF 2.0 specification, section 4 (GLB File Format). The lengths are checked here: the crate `gltf` subtracts
//! without a check from the one in the header, and refuses files with chunks that it does not know, which the specification
//! allows.

use std::path::Path;

use super::notes::Notes;
use crate::import::ImportError;

const HEADER_LENGTH: usize = 12;
const CHUNK_HEADER_LENGTH: usize = 8;
const UTF8_MARK: &[u8] = b"\xEF\xBB\xBF";

/// The parts of a file, borrowed from its bytes.
#[derive(Debug)]
pub(super) struct Container<'a> {
    /// The JSON text, without byte order mark and padding.
    pub(super) json: &'a [u8],
    /// A GLB's binary chunk: the data of buffer 0.
    pub(super) binary: Option<&'a [u8]>,
}

/// Splits a file into its parts. Nothing is allocated, whatever the lengths claim.
pub(super) fn split<'a>(
    file: &Path,
    bytes: &'a [u8],
    notes: &mut Notes,
) -> Result<Container<'a>, ImportError> {
    if bytes.starts_with(b"glTF") {
        return split_glb(file, bytes, notes);
    }
    let json = trimmed(bytes);
    if json.first() == Some(&b'{') {
        return Ok(Container { json, binary: None });
    }
    let cause = match bytes.len() {
        0 => "is empty",
        _ => "begins neither with `glTF` (GLB) nor with `{` (JSON)",
    };
    Err(ImportError::invalid(file, "file", cause))
}

fn split_glb<'a>(
    file: &Path,
    bytes: &'a [u8],
    notes: &mut Notes,
) -> Result<Container<'a>, ImportError> {
    let header = |cause: String| ImportError::invalid(file, "GLB header", cause);
    if bytes.len() < HEADER_LENGTH {
        let cause = format!(
            "truncated: the file has {} bytes, the header alone {HEADER_LENGTH}",
            bytes.len()
        );
        return Err(header(cause));
    }
    let version = word(bytes, 4);
    if version != 2 {
        let cause = format!(
            "version {version} is not supported, only 2: convert the file, for example with gltf-pipeline"
        );
        return Err(ImportError::unsupported(file, "GLB header", cause));
    }
    let length = word(bytes, 8) as usize;
    if length < HEADER_LENGTH {
        return Err(header(format!("claims a length of {length} bytes")));
    }
    let Some(mut rest) = bytes.get(HEADER_LENGTH..length) else {
        let cause = format!(
            "truncated: claims {length} bytes, the file has {}",
            bytes.len()
        );
        return Err(header(cause));
    };
    if bytes.len() > length {
        let text = format!("{} bytes after the end are ignored", bytes.len() - length);
        notes.add("GLB", text);
    }

    let (mut json, mut binary) = (None, None);
    let mut chunk = 0;
    while !rest.is_empty() {
        let element = format!("GLB chunk {chunk}");
        if rest.len() < CHUNK_HEADER_LENGTH {
            let cause = format!(
                "truncated: {} bytes where a chunk's {CHUNK_HEADER_LENGTH}-byte header should be",
                rest.len()
            );
            return Err(ImportError::invalid(file, element, cause));
        }
        let (chunk_header, data) = rest.split_at(CHUNK_HEADER_LENGTH);
        let length = word(chunk_header, 0) as usize;
        let kind = &chunk_header[4..];
        let Some((data, behind)) = data.split_at_checked(length) else {
            let cause = format!(
                "truncated: the chunk {} claims {length} bytes, {} are left",
                kind.escape_ascii(),
                data.len()
            );
            return Err(ImportError::invalid(file, element, cause));
        };
        match (chunk, kind) {
            (0, b"JSON") => json = Some(trimmed(data)),
            (0, _) => break,
            (1, b"BIN\0") => binary = Some(data),
            // "Clients MUST ignore chunks with unknown types" (section 4.4.1).
            _ => {}
        }
        rest = behind;
        chunk += 1;
    }
    match json {
        Some(json) => Ok(Container { json, binary }),
        None => {
            let cause = "is not JSON, which must come first";
            Err(ImportError::invalid(file, "GLB chunk 0", cause))
        }
    }
}

/// Without byte order mark, and without the blanks (or, against the specification, zeros) that pad a chunk.
fn trimmed(json: &[u8]) -> &[u8] {
    let mut json = json.strip_prefix(UTF8_MARK).unwrap_or(json);
    while let [before @ .., 0] = json {
        json = before;
    }
    json.trim_ascii()
}

/// The little-endian number at `offset`, which the caller knows to be there.
fn word(bytes: &[u8], offset: usize) -> u32 {
    let mut word = [0; 4];
    word.copy_from_slice(&bytes[offset..offset + 4]);
    u32::from_le_bytes(word)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn glb(chunks: &[(&[u8; 4], &[u8])]) -> Vec<u8> {
        let mut bytes = b"glTF\x02\0\0\0\0\0\0\0".to_vec();
        for (kind, data) in chunks {
            bytes.extend((data.len() as u32).to_le_bytes());
            bytes.extend(*kind);
            bytes.extend(*data);
        }
        let length = (bytes.len() as u32).to_le_bytes();
        bytes[8..12].copy_from_slice(&length);
        bytes
    }

    fn error(bytes: &[u8]) -> String {
        split(
            Path::new("a.glb"),
            bytes,
            &mut Notes::new(Path::new("a.glb")),
        )
        .expect_err("broken")
        .to_string()
    }

    #[test]
    fn chunks_are_found_and_unknown_ones_ignored() {
        let bytes = glb(&[(b"JSON", b"{}  "), (b"BIN\0", b"1234"), (b"ABCD", b"xy")]);
        let mut notes = Notes::new(Path::new("a.glb"));
        let container = split(Path::new("a.glb"), &bytes, &mut notes).expect("good");
        assert_eq!(container.json, b"{}");
        assert_eq!(container.binary, Some(&b"1234"[..]));
        let json = split(Path::new("a.gltf"), b"\xEF\xBB\xBF\n{ }\n", &mut notes).expect("good");
        assert_eq!((json.json, json.binary), (&b"{ }"[..], None));
        assert!(notes.finish().is_empty());
    }

    #[test]
    fn broken_containers_are_named() {
        let mut version_1 = glb(&[(b"JSON", b"{}")]);
        version_1[4] = 1;
        assert!(error(&version_1).contains("version 1 is not supported"));
        let mut claim = glb(&[(b"JSON", b"{}")]);
        claim[8..12].fill(0xFF);
        assert!(error(&claim).contains("claims 4294967295 bytes, the file has 22"));
        claim[8..12].copy_from_slice(&[5, 0, 0, 0]);
        assert!(error(&claim).contains("claims a length of 5 bytes"));
        let mut chunk = glb(&[(b"JSON", b"{}")]);
        chunk[12..16].fill(0xFF);
        assert!(error(&chunk).contains("the chunk JSON claims 4294967295 bytes, 2 are left"));
        assert!(error(&glb(&[(b"BIN\0", b"{}")])).contains("is not JSON"));
        assert!(error(&glb(&[])).contains("is not JSON"));
        assert!(error(b"").contains("is empty"));
        assert!(error(b"glT").contains("begins neither"));
        assert!(error(b"glTF\x02\0").contains("truncated: the file has 6 bytes"));
    }
}
