//! A GLB of which the lengths of chunks are made right, so that changes reach what is behind them.
#![no_main]

use libfuzzer_sys::fuzz_target;

#[path = "folder.rs"]
mod folder;
#[path = "../../support/import_contract.rs"]
mod import_contract;

/// Bytes before the JSON: the file's header and the chunk's.
const HEADER: usize = 20;

fuzz_target!(init: folder::init(), |bytes: &[u8]| {
    let Some(body) = bytes.get(HEADER..) else {
        return;
    };
    // The binary chunk's header: its length, then its kind.
    let binary = body.windows(8).position(|w| w[4..] == *b"BIN\0");
    let json = &body[..binary.unwrap_or(body.len())];
    let binary = binary.map(|at| &body[at + 8..]);
    let mut chunks = Vec::new();
    for (kind, data) in [(b"JSON", Some(json)), (b"BIN\0", binary)] {
        let Some(data) = data else { continue };
        chunks.extend((data.len() as u32).to_le_bytes());
        chunks.extend(kind);
        chunks.extend(data);
    }
    let length = 12 + chunks.len() as u32;
    let glb = [b"glTF\x02\0\0\0", &length.to_le_bytes()[..], &chunks].concat();
    let file = folder::write("model.glb", &glb);
    let _ = import_contract::load_checked(&file, &folder::options(bytes));
});
