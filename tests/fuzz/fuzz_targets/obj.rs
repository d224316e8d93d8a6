//! An OBJ file; behind a line `#mtl` its MTL file `a.mtl`. Beside them lies an image `a.png`.
#![no_main]

use libfuzzer_sys::fuzz_target;

#[path = "folder.rs"]
mod folder;
#[path = "../../support/import_contract.rs"]
mod import_contract;

const MARK: &[u8] = b"\n#mtl\n";

/// One grey pixel.
const PNG: &[u8] = b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR\0\0\0\x01\0\0\0\x01\x08\0\0\0\0\x3a\x7e\x9b\x55\0\0\0\nIDAT\x78\x9c\x63\x68\0\0\0\x82\0\x81\x77\xcd\x72\xb6\0\0\0\0IEND\xae\x42\x60\x82";

fuzz_target!(init: folder::init(), |bytes: &[u8]| {
    let mark = bytes.windows(MARK.len()).position(|w| w == MARK);
    let (obj, mtl) = bytes.split_at(mark.unwrap_or(bytes.len()));
    folder::write("a.png", PNG);
    folder::write("a.mtl", mtl);
    let obj = [b"mtllib a.mtl\n", obj].concat();
    let file = folder::write("model.obj", &obj);
    let _ = import_contract::load_checked(&file, &folder::options(bytes));
});
