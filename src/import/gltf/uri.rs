//! URIs of buffers and images: `data:` URIs and files beside the model (RFC 2397, RFC 3986).

use std::collections::BTreeSet;
use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use base64::Engine;
use base64::alphabet::STANDARD;
use base64::engine::DecodePaddingMode;
use base64::engine::general_purpose::{GeneralPurpose, GeneralPurposeConfig};
use percent_encoding::percent_decode_str;

/// Exporters leave the padding out, or the last bits set: the bytes are clear all the same.
const BASE64: GeneralPurpose = GeneralPurpose::new(
    &STANDARD,
    GeneralPurposeConfig::new()
        .with_decode_padding_mode(DecodePaddingMode::Indifferent)
        .with_decode_allow_trailing_bits(true),
);

/// Where a URI leads.
#[derive(Debug, PartialEq, Eq)]
pub(super) enum Target {
    /// Into the URI itself.
    Data(Vec<u8>),
    /// To the first of these paths that is a file.
    Files(Vec<PathBuf>),
}

/// Finds out where a URI of the model `file` leads; nothing outside the URI is read.
pub(super) fn resolve(file: &Path, uri: &str) -> Result<Target, String> {
    if is_data(uri) {
        return decode_data(&uri[5..]).map(Target::Data);
    }
    let scheme = uri.split_once(':').map(|(s, _)| s).filter(|s| {
        s.starts_with(|c: char| c.is_ascii_alphabetic())
            && s.chars()
                .all(|c| c.is_ascii_alphanumeric() || "+-.".contains(c))
    });
    let way_out =
        "only data URIs and paths relative to the model are read: put the file beside the model";
    match scheme {
        Some(drive) if drive.len() == 1 => {
            return Err(format!("{:?} is an absolute path; {way_out}", brief(uri)));
        }
        Some(_) => return Err(format!("{:?} has a scheme; {way_out}", brief(uri))),
        None if uri.starts_with(['/', '\\']) => {
            return Err(format!("{:?} is an absolute path; {way_out}", brief(uri)));
        }
        None => {}
    }
    if uri.is_empty() {
        return Err("its URI is empty".to_owned());
    }
    let directory = file.parent().unwrap_or(Path::new(""));
    // Exporters disagree on escapes and on backslashes. As the specification has it comes first.
    let decoded = path_of(percent_decode_str(uri).collect());
    let mut paths = vec![directory.join(decoded), directory.join(uri)];
    if uri.contains('\\') {
        paths.push(directory.join(uri.replace('\\', "/")));
    }
    paths.dedup();
    Ok(Target::Files(paths))
}

/// The bytes to which a URI of the model `file` leads, of a file at most `limit` of them. `charge` is asked for their number before.
pub(super) fn read(
    file: &Path,
    uri: &str,
    files: &Files,
    limit: u64,
    charge: impl Fn(u64) -> Result<(), String>,
) -> Result<Vec<u8>, String> {
    if is_data(uri) {
        charge(uri.len() as u64)?;
    }
    match resolve(file, uri)? {
        Target::Data(bytes) => Ok(bytes),
        Target::Files(paths) => files.read_first(&paths, limit, charge),
    }
}

fn is_data(uri: &str) -> bool {
    let scheme = uri.get(..5);
    scheme.is_some_and(|s| s.eq_ignore_ascii_case("data:"))
}

/// Reads files, and remembers which; several threads may ask.
#[derive(Debug, Default)]
pub(super) struct Files {
    // Sorted, since threads come in no order.
    found: Mutex<BTreeSet<PathBuf>>,
}

impl Files {
    /// Reads the first of `paths` that is a file, at most `limit` bytes of it.
    ///
    /// The error is that of the first path. `charge` is asked for their number before they are read. Devices and pipes, which have no end, are not files here.
    pub(super) fn read_first(
        &self,
        paths: &[PathBuf],
        limit: u64,
        charge: impl FnOnce(u64) -> Result<(), String>,
    ) -> Result<Vec<u8>, String> {
        let path = self.find_first(paths)?;
        let wrong = |e: std::io::Error| format!("cannot read {:?}: {e}", path.display());
        let file = File::open(path).map_err(wrong)?;
        let length = file.metadata().map_err(wrong)?.len().min(limit);
        charge(length)?;
        let mut bytes = Vec::new();
        // A file with holes may claim more than there is memory.
        let reserved = bytes.try_reserve_exact(usize::try_from(length).unwrap_or(usize::MAX));
        reserved.map_err(|e| format!("cannot read {:?}: {e}", path.display()))?;
        file.take(length).read_to_end(&mut bytes).map_err(wrong)?;
        Ok(bytes)
    }

    /// The first of `paths` that is a file.
    pub(super) fn find_first<'p>(&self, paths: &'p [PathBuf]) -> Result<&'p PathBuf, String> {
        let path = find_first(paths)?;
        let mut found = self.found.lock().unwrap_or_else(PoisonError::into_inner);
        found.insert(path.clone());
        Ok(path)
    }

    /// The files that were read or found.
    pub(super) fn into_paths(self) -> BTreeSet<PathBuf> {
        let found = self.found.into_inner();
        found.unwrap_or_else(PoisonError::into_inner)
    }
}

fn find_first(paths: &[PathBuf]) -> Result<&PathBuf, String> {
    let mut first_error = None;
    for path in paths {
        match std::fs::metadata(path) {
            Ok(metadata) if metadata.is_file() => return Ok(path),
            Ok(_) => first_error.get_or_insert(format!("{:?} is not a file", path.display())),
            Err(e) => first_error.get_or_insert(format!("cannot read {:?}: {e}", path.display())),
        };
    }
    Err(first_error.unwrap_or_else(|| "has no path".to_owned()))
}

/// A URI short enough for a message.
pub(super) fn brief(uri: &str) -> String {
    match uri.char_indices().nth(60) {
        Some((end, _)) => format!("{}...", &uri[..end]),
        None => uri.to_owned(),
    }
}

/// What follows `data:`.
fn decode_data(rest: &str) -> Result<Vec<u8>, String> {
    let Some((media_type, data)) = rest.split_once(',') else {
        return Err("its data URI has no comma before the data".to_owned());
    };
    let is_base64 = media_type
        .rsplit(';')
        .next()
        .is_some_and(|s| s.trim().eq_ignore_ascii_case("base64"));
    if !is_base64 {
        return Ok(percent_decode_str(data).collect());
    }
    let has_escapes = data.bytes().any(|b| b == b'%' || b.is_ascii_whitespace());
    let decoded = if has_escapes {
        let plain: Vec<u8> = percent_decode_str(data)
            .filter(|b| !b.is_ascii_whitespace())
            .collect();
        BASE64.decode(plain)
    } else {
        BASE64.decode(data)
    };
    decoded.map_err(|e| format!("its data URI is not base64: {e}"))
}

#[cfg(unix)]
fn path_of(bytes: Vec<u8>) -> PathBuf {
    use std::os::unix::ffi::OsStringExt;
    std::ffi::OsString::from_vec(bytes).into()
}

#[cfg(not(unix))]
fn path_of(bytes: Vec<u8>) -> PathBuf {
    String::from_utf8_lossy(&bytes).into_owned().into()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn target(uri: &str) -> Result<Target, String> {
        resolve(Path::new("dir/model.gltf"), uri)
    }

    #[test]
    fn data_uris_are_decoded() {
        let text = |s: &str| Ok(Target::Data(s.as_bytes().to_vec()));
        assert_eq!(target("data:;base64,YWJjZA=="), text("abcd"));
        assert_eq!(
            target("DATA:application/octet-stream;BASE64,YWJjZA"),
            text("abcd")
        );
        assert_eq!(target("data:;base64,YWJj%5AA%3D%3D\n"), text("abcd"));
        assert_eq!(target("data:text/plain,a%20b"), text("a b"));
        assert!(target("data:;base64").is_err());
        assert!(target("data:;base64,?").is_err());
    }

    #[test]
    fn files_lie_beside_the_model() {
        let paths = |uri| match target(uri) {
            Ok(Target::Files(paths)) => paths,
            other => panic!("{uri}: {other:?}"),
        };
        assert_eq!(paths("a%20b.bin")[0], Path::new("dir/a b.bin"));
        assert_eq!(paths("a%20b.bin")[1], Path::new("dir/a%20b.bin"));
        assert_eq!(paths("../x.bin"), [Path::new("dir/../x.bin")]);
        assert_eq!(paths("t\\x.png")[1], Path::new("dir/t/x.png"));
        assert_eq!(paths("%FF.png").len(), 2);
        for uri in [
            "http://x/y.bin",
            "file:///etc/passwd",
            "/etc/passwd",
            "C:/x.bin",
            "\\\\host\\x",
            "",
        ] {
            assert!(target(uri).is_err(), "{uri}");
        }
    }

    #[test]
    fn devices_and_directories_are_not_files() {
        let error = Files::default()
            .read_first(&[PathBuf::from("/")], 10, |_| Ok(()))
            .expect_err("a directory");
        assert!(error.contains("not a file"), "{error}");
        #[cfg(unix)]
        assert!(
            Files::default()
                .read_first(&[PathBuf::from("/dev/zero")], 10, |_| Ok(()))
                .is_err()
        );
    }
}
