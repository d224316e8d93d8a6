//! The order of an EXR file's attributes.
//!
//! The crate that writes EXR keeps attributes in a hash map and so writes them in another order in every run. OpenEXR's own
//! library writes them sorted by name. Sorting them afterwards makes equal pictures equal files; the header keeps its size, so
//! that no offset changes.

use std::fs::File;
use std::io::{self, BufRead, BufReader, Error, ErrorKind, Read, Seek, SeekFrom, Write};

/// Length of the magic number and the version, after which the first header starts.
const PREAMBLE: u64 = 8;

/// Sorts the attributes of a single-part EXR file by name, in place.
///
/// # Errors
/// Errors of the system, and `InvalidData` where the header is not one.
pub(super) fn sort_attributes(file: &mut File) -> io::Result<()> {
    file.seek(SeekFrom::Start(PREAMBLE))?;
    let mut attributes = read_attributes(&mut BufReader::new(&mut *file))?;
    attributes.sort();
    file.seek(SeekFrom::Start(PREAMBLE))?;
    file.write_all(&attributes.concat())
}

/// The attributes up to the empty name that ends a header: name, type, size and value, as one piece each.
fn read_attributes(input: &mut impl BufRead) -> io::Result<Vec<Vec<u8>>> {
    let mut attributes = Vec::new();
    loop {
        let mut bytes = Vec::new();
        input.read_until(0, &mut bytes)?;
        if bytes == [0] {
            return Ok(attributes);
        }
        input.read_until(0, &mut bytes)?;
        let mut size = [0; 4];
        input.read_exact(&mut size)?;
        bytes.extend(size);
        let size = u64::from(u32::from_le_bytes(size));
        let expected = bytes.len() as u64 + size;
        input.take(size).read_to_end(&mut bytes)?;
        if bytes.len() as u64 != expected {
            return Err(Error::new(ErrorKind::InvalidData, "header ends too early"));
        }
        attributes.push(bytes);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sorted(content: &[u8]) -> io::Result<Vec<u8>> {
        let mut file = tempfile::tempfile()?;
        file.write_all(content)?;
        sort_attributes(&mut file)?;
        let mut result = Vec::new();
        file.seek(SeekFrom::Start(0))?;
        file.read_to_end(&mut result)?;
        Ok(result)
    }

    #[test]
    fn attributes_are_sorted_and_all_else_stays() {
        let before = b"magicver\
            b\0int\0\x04\0\0\0\x00\x00\x00\x07\
            ab\0string\0\x02\0\0\0xy\
            a\0string\0\0\0\0\0\
            \0the rest";
        let after = b"magicver\
            a\0string\0\0\0\0\0\
            ab\0string\0\x02\0\0\0xy\
            b\0int\0\x04\0\0\0\x00\x00\x00\x07\
            \0the rest";
        assert_eq!(sorted(before).unwrap(), after);
    }

    #[test]
    fn a_header_that_ends_too_early_is_an_error() {
        let whole = b"magicverb\0int\0\x04\0\0\0\x00\x00\x00\x07\0";
        for length in 8..whole.len() {
            assert!(sorted(&whole[..length]).is_err(), "{length} bytes");
        }
        assert!(sorted(whole).is_ok());
    }
}
