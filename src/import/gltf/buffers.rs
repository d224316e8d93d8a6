//! Buffers, each read when first needed.

use std::borrow::Cow;
use std::path::Path;
use std::sync::OnceLock;

use ::gltf::json::Root;

use super::uri::{self, Files};
use crate::import::budget::Budget;

/// The bytes of a file's buffers, or why they could not be had.
pub(super) struct Buffers<'a> {
    file: &'a Path,
    binary: Option<&'a [u8]>,
    slots: Vec<OnceLock<Result<Cow<'a, [u8]>, String>>>,
}

impl<'a> Buffers<'a> {
    pub(super) fn new(file: &'a Path, root: &Root, binary: Option<&'a [u8]>) -> Self {
        Self {
            file,
            binary,
            slots: root.buffers.iter().map(|_| OnceLock::new()).collect(),
        }
    }

    /// The bytes of buffer `index`, as many as its `byteLength` says.
    pub(super) fn get(
        &self,
        root: &Root,
        files: &Files,
        budget: &Budget,
        index: usize,
    ) -> Result<&[u8], String> {
        let Some(slot) = self.slots.get(index) else {
            let count = self.slots.len();
            return Err(format!("buffer {index} is not there: the file has {count}"));
        };
        slot.get_or_init(|| self.read(root, files, budget, index))
            .as_deref()
            .map_err(|cause| format!("buffer {index}: {cause}"))
    }

    fn read(
        &self,
        root: &Root,
        files: &Files,
        budget: &Budget,
        index: usize,
    ) -> Result<Cow<'a, [u8]>, String> {
        let buffer = &root.buffers[index];
        let claimed = buffer.byte_length.0;
        let bytes = match (&buffer.uri, self.binary) {
            (Some(uri), _) => {
                let charge = |bytes| budget.charge(bytes, || format!("buffer {index}"));
                Cow::Owned(uri::read(self.file, uri, files, claimed, charge)?)
            }
            (None, Some(binary)) if index == 0 => Cow::Borrowed(binary),
            (None, _)
                if buffer
                    .extensions
                    .as_ref()
                    .is_some_and(|e| !e.others.is_empty()) =>
            {
                return Err(
                    "has no data: it stands for what its buffer views hold compressed".to_owned(),
                );
            }
            (None, _) => return Err("has no URI, and the file no binary chunk for it".to_owned()),
        };
        let length = usize::try_from(claimed).ok().filter(|&n| n <= bytes.len());
        let Some(length) = length else {
            let found = bytes.len();
            return Err(format!(
                "truncated: has {found} bytes, its byteLength claims {claimed}"
            ));
        };
        // A GLB's binary chunk is padded, and files may go on behind the buffer.
        Ok(match bytes {
            Cow::Borrowed(bytes) => Cow::Borrowed(&bytes[..length]),
            Cow::Owned(mut bytes) => {
                bytes.truncate(length);
                Cow::Owned(bytes)
            }
        })
    }
}
