//! The binary container of glTF (specification, section 4.4): a header, a chunk of JSON, a chunk of data.

/// A GLB of a JSON text and the buffer that it calls its first.
pub(in super::super) fn glb(json: &str, mut data: Vec<u8>) -> Vec<u8> {
    // A chunk's length is a multiple of four; spaces fill up JSON, zeros data.
    let json_length = json.len().next_multiple_of(4);
    data.resize(data.len().next_multiple_of(4), 0);
    let mut glb = Vec::new();
    glb.extend(b"glTF");
    glb.extend(2_u32.to_le_bytes());
    glb.extend(((12 + 8 + json_length + 8 + data.len()) as u32).to_le_bytes());
    glb.extend((json_length as u32).to_le_bytes());
    glb.extend(b"JSON");
    glb.extend(json.bytes());
    glb.resize(12 + 8 + json_length, b' ');
    glb.extend((data.len() as u32).to_le_bytes());
    glb.extend(b"BIN\0");
    glb.extend(data);
    glb
}
