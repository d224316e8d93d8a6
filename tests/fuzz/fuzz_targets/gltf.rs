//! The bytes as they are: JSON or GLB.
#![no_main]

use libfuzzer_sys::fuzz_target;

#[path = "folder.rs"]
mod folder;
#[path = "../../support/import_contract.rs"]
mod import_contract;

fuzz_target!(init: folder::init(), |bytes: &[u8]| {
    let file = folder::write("model.gltf", bytes);
    let _ = import_contract::load_checked(&file, &folder::options(bytes));
});
