//! A fake display server: what is sent to it is the picture, and a server that is not there or goes away harms nothing.

use std::io::Read;
use std::net::TcpListener;

use bspray::picture::{Samples, exr};

use super::run::{bspray, model};

/// Takes numbers and texts off the front of a packet.
struct Reader<'a>(&'a [u8]);

impl Reader<'_> {
    fn take<const N: usize>(&mut self) -> [u8; N] {
        let (front, rest) = self.0.split_first_chunk::<N>().expect("more bytes");
        self.0 = rest;
        *front
    }

    fn number(&mut self) -> u32 {
        u32::from_le_bytes(self.take())
    }

    fn text(&mut self) -> String {
        let end = self.0.iter().position(|&b| b == 0).expect("an end");
        let text = String::from_utf8(self.0[..end].to_vec()).expect("UTF-8");
        self.0 = &self.0[end + 1..];
        text
    }

    fn channels(&mut self) -> Vec<String> {
        (0..self.number()).map(|_| self.text()).collect()
    }
}

/// The image that the packets of one connection make, with its name, width and height, and how often it was updated.
fn decode(mut bytes: &[u8]) -> (String, [usize; 2], Vec<[f32; 3]>, usize) {
    let mut image = Vec::new();
    let (mut name, mut size, mut updates) = (String::new(), [0, 0], 0);
    while !bytes.is_empty() {
        let length = Reader(bytes).number() as usize;
        let mut packet = Reader(&bytes[4..length]);
        bytes = &bytes[length..];
        let [kind, grabs_focus] = packet.take();
        assert_eq!(grabs_focus, 0);
        let of = packet.text();
        match kind {
            4 => {
                name = of;
                size = [packet.number() as usize, packet.number() as usize];
                assert_eq!(packet.channels(), ["R", "G", "B"]);
                image = vec![[0.0; 3]; size[0] * size[1]];
            }
            6 => {
                assert_eq!(of, name);
                assert_eq!(packet.channels(), ["R", "G", "B"]);
                let [x, y, width, height] = [(); 4].map(|()| packet.number() as usize);
                let [offsets, strides] =
                    [(); 2].map(|()| [(); 3].map(|()| u64::from_le_bytes(packet.take()) as usize));
                let values: Vec<f32> = packet
                    .0
                    .as_chunks()
                    .0
                    .iter()
                    .map(|b| f32::from_le_bytes(*b))
                    .collect();
                assert_eq!(values.len(), width * height * 3);
                for i in 0..width * height {
                    let place = (y + i / width) * size[0] + x + i % width;
                    image[place] = [0, 1, 2].map(|c| values[offsets[c] + i * strides[c]]);
                }
                updates += 1;
            }
            other => panic!("what is {other}?"),
        }
    }
    (name, size, image, updates)
}

#[test]
fn a_display_server_gets_the_picture() {
    let folder = tempfile::tempdir().unwrap();
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let address = listener.local_addr().unwrap().to_string();
    let server = std::thread::spawn(move || {
        let mut bytes = Vec::new();
        listener
            .accept()
            .unwrap()
            .0
            .read_to_end(&mut bytes)
            .unwrap();
        bytes
    });
    let cornell = model("cornell-box.obj");
    let args = [
        "render",
        &cornell,
        "-o",
        "a.exr",
        "--resolution=60x100",
        "--spp=4",
        "--pixelbounds=3,57,10,97",
    ];
    let display = ["--display-server", &address];
    let ran = bspray(folder.path(), &[&args[..], &display].concat());
    assert_eq!(ran.code, Some(0), "{ran:?}");
    let (name, size, image, updates) = decode(&server.join().unwrap());
    assert_eq!((name.as_str(), size), ("a.exr", [60, 100]));
    // Two bands of rows each time.
    assert!(updates >= 2 && updates % 2 == 0, "{updates}");
    let picture = exr::read(&folder.path().join("a.exr")).unwrap();
    let mut brightest = 0.0_f32;
    for (axis, channel) in ["R", "G", "B"].into_iter().enumerate() {
        let Some(Samples::F32(values)) = picture.channel(channel) else {
            panic!("{channel}");
        };
        // Nothing is behind this scene's surfaces but black.
        for (i, value) in values.iter().enumerate() {
            let (x, y) = (3 + i % 54, 10 + i / 54);
            let shown = image[y * 60 + x][axis];
            assert_eq!(shown.to_bits(), value.to_bits(), "{x} {y}");
            brightest = brightest.max(*value);
        }
    }
    assert!(brightest > 0.1 && image[0].map(f32::to_bits) == [0; 3]);
}

#[test]
fn a_server_that_is_not_there_is_an_error_and_one_that_leaves_a_note() {
    let folder = tempfile::tempdir().unwrap();
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let address = listener.local_addr().unwrap().to_string();
    let block = model("lecture-block.obj");
    let args = [
        "render",
        &block,
        "-o",
        "a.png",
        "--resolution=300x300",
        "--spp=16",
        "--display-server",
        &address,
    ];
    let server = std::thread::spawn(move || drop(listener.accept().unwrap().0));
    let ran = bspray(folder.path(), &args);
    server.join().unwrap();
    assert_eq!(ran.code, Some(0), "{ran:?}");
    let notes = ran.stderr.matches("the display server").count();
    assert!(
        notes == 1 && folder.path().join("a.png").exists(),
        "{ran:?}"
    );
    // The listener is gone with its thread.
    let ran = bspray(folder.path(), &args);
    assert_eq!(ran.code, Some(1), "{ran:?}");
    assert!(
        ran.stderr.lines().count() == 1 && ran.stderr.contains(&address),
        "{ran:?}"
    );
    let ran = bspray(
        folder.path(),
        &["render", &block, "--display-server", "nowhere"],
    );
    assert_eq!(ran.code, Some(2), "{ran:?}");
}
