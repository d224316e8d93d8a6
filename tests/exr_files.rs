//! EXR files: what is written comes back bit for bit, what cannot be written or read is an error, never a panic.
#![allow(
    clippy::unwrap_used,
    clippy::float_cmp,
    reason = "helpers of tests may fail them; values are compared that must come back as they are"
)]

use std::fs;
use std::path::PathBuf;

use bspray::picture::{Attribute, Channel, Picture, PictureError, Samples, Window, attribute, exr};

/// Bits of every value, so that NaN can be compared.
fn bits(samples: &Samples) -> Vec<u32> {
    match samples {
        Samples::F16(values) | Samples::F32(values) => values.iter().map(|v| v.to_bits()).collect(),
        Samples::U32(values) => values.clone(),
    }
}

struct Folder(tempfile::TempDir);

impl Folder {
    fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn round_trip(&self, picture: &Picture) -> Picture {
        let path = self.path("round_trip.exr");
        exr::write(&path, picture).unwrap();
        exr::read(&path).unwrap()
    }
}

/// 7 x 37 pixels (three blocks, the last one short) of a crop, with all types and attributes.
fn everything() -> Picture {
    let window = Window {
        x: 100,
        y: -5,
        width: 7,
        height: 37,
    };
    let count = 7 * 37;
    let mut floats: Vec<f32> = (0..count).map(|i| (i as f32 - 100.0) * 0.1).collect();
    floats[..6].copy_from_slice(&[
        f32::from_bits(0x7fc1_2345),
        f32::from_bits(0xff80_0001),
        f32::INFINITY,
        f32::NEG_INFINITY,
        -0.0,
        f32::from_bits(1),
    ]);
    let halves = (0..count).map(|i| i as f32 / 8.0).collect();
    let numbers = (0..count).map(|i| u32::MAX - i).collect();
    let matrix = std::array::from_fn(|i| i as f32 + 0.5);
    Picture::new(640, 480)
        .with_window(window)
        .with_channel(Channel::new("Z", Samples::F32(floats)))
        .with_channel(Channel::new("R", Samples::F16(halves)))
        .with_channel(Channel::new("object.id", Samples::U32(numbers)))
        .with_attribute(attribute::SOFTWARE, Attribute::Text("bspray".into()))
        .with_attribute(attribute::COMMENTS, Attribute::Text("two\nlines".into()))
        .with_attribute(attribute::WORLD_TO_CAMERA, Attribute::M44(matrix))
        .with_attribute(attribute::WORLD_TO_NDC, Attribute::M44(matrix.map(|v| -v)))
        .with_attribute("bspray/matrix", Attribute::M44(matrix))
        .with_attribute("bspray/samples", Attribute::Int(-64))
        .with_attribute("bspray/seconds", Attribute::Float(1.25))
        .with_attribute(
            "bspray/an attribute of a name longer than thirty-one bytes",
            Attribute::Text(String::new()),
        )
}

#[test]
fn everything_comes_back_bit_for_bit() {
    let picture = everything();
    let back = Folder::new().round_trip(&picture);
    assert_eq!(
        (back.display, back.window),
        (picture.display, picture.window)
    );
    assert_eq!(back.attributes, picture.attributes);
    let names: Vec<&str> = back.channels.iter().map(|c| c.name.as_str()).collect();
    assert_eq!(names, ["R", "Z", "object.id"]);
    for channel in &picture.channels {
        let samples = back.channel(&channel.name).unwrap();
        assert_eq!(
            std::mem::discriminant(samples),
            std::mem::discriminant(&channel.samples)
        );
        assert_eq!(bits(samples), bits(&channel.samples), "{}", channel.name);
    }
}

#[test]
fn one_pixel_and_long_names_come_back() {
    let name = "x".repeat(60);
    let longest = "y".repeat(255);
    let picture = Picture::new(1, 1)
        .with_channel(Channel::new(name, Samples::F32(vec![0.1])))
        .with_channel(Channel::new(longest, Samples::U32(vec![3])));
    assert_eq!(Folder::new().round_trip(&picture), picture);
}

#[test]
fn halves_are_rounded_and_stay_finite() {
    let values = vec![0.1, 70_000.0, -1e30, f32::INFINITY, f32::NAN, 65_519.0];
    let picture = Picture::new(6, 1).with_channel(Channel::new("R", Samples::F16(values)));
    let back = Folder::new().round_trip(&picture);
    let Some(Samples::F16(values)) = back.channel("R") else {
        panic!("halves")
    };
    assert_eq!(
        values[..4],
        [0.099_975_586, 65_504.0, -65_504.0, f32::INFINITY]
    );
    assert!(values[4].is_nan());
    assert_eq!(values[5], 65_504.0);
}

#[test]
fn text_beyond_ascii_is_escaped() {
    let picture = Picture::new(1, 1)
        .with_channel(Channel::new("caf\u{e9}.R", Samples::F32(vec![0.0])))
        .with_attribute("manifest", Attribute::Text("{\"\u{4e2d}\":1}".into()))
        .with_attribute(attribute::OWNER, Attribute::Text("a\u{0}\u{1f980}".into()));
    let back = Folder::new().round_trip(&picture);
    assert_eq!(back.channels[0].name, r"caf\u00e9.R");
    let text = |name| back.attributes[name].clone();
    assert_eq!(text("manifest"), Attribute::Text(r#"{"\u4e2d":1}"#.into()));
    assert_eq!(
        text("owner"),
        Attribute::Text(r"a\u0000\ud83e\udd80".into())
    );
}

#[test]
fn equal_pictures_are_equal_files_for_any_number_of_threads() {
    let folder = Folder::new();
    let bytes = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
        let path = folder.path("same.exr");
        pool.build()
            .unwrap()
            .install(|| exr::write(&path, &everything()).unwrap());
        fs::read(&path).unwrap()
    };
    let first = bytes(1);
    assert!((2..6).all(|threads| bytes(threads) == first));
}

#[test]
fn pictures_that_cannot_be_written_are_invalid_and_leave_no_file() {
    let one = |name: &str, values: Vec<f32>| Channel::new(name, Samples::F32(values));
    let good = Picture::new(2, 1).with_channel(one("Z", vec![1.0, 2.0]));
    let far = Window {
        x: i32::MAX - 1,
        y: 0,
        width: 2,
        height: 1,
    };
    let cases = [
        ("twice", good.clone().with_channel(one("Z", vec![1.0, 2.0]))),
        (
            "3 values for 2 x 1",
            Picture::new(2, 1).with_channel(one("Z", vec![0.0; 3])),
        ),
        (
            "1 to 255",
            good.clone().with_channel(one("", vec![1.0, 2.0])),
        ),
        (
            "1 to 255",
            good.clone()
                .with_channel(one(&"x".repeat(256), vec![1.0, 2.0])),
        ),
        ("at least one channel", Picture::new(2, 1)),
        (
            "at least one pixel",
            Picture::new(0, 1).with_channel(one("Z", vec![])),
        ),
        (
            "reserved",
            good.clone().with_attribute("channels", Attribute::Int(1)),
        ),
        (
            "reserved",
            good.clone().with_attribute("software", Attribute::Int(1)),
        ),
        ("window", good.clone().with_window(far)),
        ("empty", good.clone().with_attribute("", Attribute::Int(1))),
    ];
    let folder = Folder::new();
    for (words, picture) in cases {
        let error = exr::write(&folder.path("bad.exr"), &picture).unwrap_err();
        assert!(matches!(error, PictureError::Invalid { .. }), "{error}");
        let line = error.to_string();
        assert!(line.contains(words) && line.contains("bad.exr"), "{line}");
        assert!(!line.contains('\n'));
    }
    assert_eq!(folder.0.path().read_dir().unwrap().count(), 0);
}

#[test]
fn what_the_system_refuses_is_an_error_of_one_line() {
    let folder = Folder::new();
    let picture = Picture::new(1, 1).with_channel(Channel::new("Z", Samples::F32(vec![1.0])));
    let line = |error: PictureError| {
        assert!(matches!(error, PictureError::Io { .. }));
        error.to_string()
    };
    let missing = folder.path("no/such.exr");
    assert!(line(exr::write(&missing, &picture).unwrap_err()).contains("folder does not exist"));
    assert!(line(exr::read(&missing).unwrap_err()).contains("such.exr"));
    assert!(line(exr::write(folder.0.path(), &picture).unwrap_err()).contains("is a directory"));
    assert!(line(exr::read(folder.0.path()).unwrap_err()).contains("is a directory"));

    let kept = folder.path("kept.exr");
    fs::write(&kept, "old").unwrap();
    let mut permissions = fs::metadata(&kept).unwrap().permissions();
    permissions.set_readonly(true);
    fs::set_permissions(&kept, permissions).unwrap();
    assert!(line(exr::write(&kept, &picture).unwrap_err()).contains("read-only"));
    assert_eq!(fs::read(&kept).unwrap(), b"old");
}

#[test]
fn files_cut_off_anywhere_are_invalid() {
    let folder = Folder::new();
    let path = folder.path("whole.exr");
    exr::write(&path, &everything()).unwrap();
    let whole = fs::read(&path).unwrap();
    let cut = folder.path("cut.exr");
    for length in (0..whole.len()).step_by(5) {
        fs::write(&cut, &whole[..length]).unwrap();
        let error = exr::read(&cut).unwrap_err();
        assert!(
            matches!(error, PictureError::Invalid { .. }),
            "{length}: {error}"
        );
    }
}

#[test]
fn broken_files_never_panic() {
    let folder = Folder::new();
    let path = folder.path("whole.exr");
    exr::write(&path, &everything()).unwrap();
    let whole = fs::read(&path).unwrap();
    let broken = folder.path("broken.exr");
    // Every byte of the header and the tables, and some of the pixels.
    for position in (0..whole.len()).filter(|p| *p < 1600 || p % 7 == 0) {
        let mut bytes = whole.clone();
        bytes[position] ^= [0x01, 0x80, 0xff][position % 3];
        fs::write(&broken, &bytes).unwrap();
        // What counts is that it returns.
        let _ = exr::read(&broken);
    }
    let seed = 0x9e37_79b9_7f4a_7c15_u64;
    let mut state = seed;
    for length in 0..200 {
        let mut bytes = vec![0x76, 0x2f, 0x31, 0x01, 2, 0, 0, 0];
        bytes.extend((0..length).map(|_| {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1);
            (state >> 56) as u8
        }));
        fs::write(&broken, &bytes).unwrap();
        assert!(
            exr::read(&broken).is_err(),
            "seed {seed:#x}, length {length}"
        );
    }
}

#[test]
fn a_size_that_the_file_cannot_fill_asks_for_no_memory() {
    let folder = Folder::new();
    let path = folder.path("absurd.exr");
    exr::write(&path, &everything()).unwrap();
    let mut bytes = fs::read(&path).unwrap();
    let name = b"dataWindow\0box2i\0\x10\0\0\0";
    let start = bytes.windows(name.len()).position(|w| w == name).unwrap() + name.len();
    let corners = [0, 0, 1_000_000_000 - 1, 16 * 3 - 1];
    for (piece, corner) in bytes[start..start + 16].chunks_mut(4).zip(corners) {
        piece.copy_from_slice(&i32::to_le_bytes(corner));
    }
    fs::write(&path, &bytes).unwrap();
    let error = exr::read(&path).unwrap_err();
    assert!(matches!(error, PictureError::Unsupported { .. }), "{error}");
    assert!(error.to_string().contains("proportion"), "{error}");
}

/// Files of a kind that bspray does not write, made by the crate that it reads them with.
mod foreign {
    use super::{Attribute, Folder, Samples, Window, bits};
    use ::exr::prelude::{
        AnyChannel, AnyChannels, AttributeValue, Encoding, FlatSamples, Image, ImageAttributes,
        IntegerBounds, Layer, LayerAttributes, SmallVec, Text, WritableImage, f16,
    };

    fn layer(
        name: &str,
        origin: (i32, i32),
        size: (usize, usize),
        channel: &str,
        samples: FlatSamples,
    ) -> Layer<AnyChannels<FlatSamples>> {
        let mut attributes = LayerAttributes::named(name).with_position(origin.into());
        let value = AttributeValue::Text(Text::from(name));
        attributes.other.insert(Text::from("who"), value);
        let list = SmallVec::from_vec(vec![AnyChannel::new(channel, samples)]);
        // The crate's default: tiles with run-length encoding.
        Layer::new(
            size,
            attributes,
            Encoding::default(),
            AnyChannels::sort(list),
        )
    }

    #[test]
    fn parts_are_joined_over_their_common_window() {
        let folder = Folder::new();
        let display = IntegerBounds::new((10, 20), (64, 48));
        let halves = vec![f16::from_f32(1.5), f16::from_f32(2.5)];
        let layers = vec![
            layer("a", (10, 20), (2, 1), "R", FlatSamples::F16(halves)),
            layer("b", (11, 19), (1, 2), "b.id", FlatSamples::U32(vec![7, 8])),
        ];
        let path = folder.path("parts.exr");
        let image = Image::from_layers(ImageAttributes::new(display), layers);
        image.write().to_file(&path).unwrap();

        let picture = bspray::picture::exr::read(&path).unwrap();
        let window = Window {
            x: 0,
            y: -1,
            width: 2,
            height: 2,
        };
        assert_eq!((picture.display, picture.window), ((64, 48), window));
        let names: Vec<&str> = picture.channels.iter().map(|c| c.name.as_str()).collect();
        assert_eq!(names, ["a.R", "b.id"]);
        assert_eq!(
            picture.channels[0].samples,
            Samples::F16(vec![0.0, 0.0, 1.5, 2.5])
        );
        assert_eq!(picture.channels[1].samples, Samples::U32(vec![0, 7, 0, 8]));
        assert_eq!(picture.attributes["who"], Attribute::Text("a".into()));
    }

    #[test]
    fn tiles_are_read() {
        let folder = Folder::new();
        let path = folder.path("tiles.exr");
        let values: Vec<f32> = (0..150 * 70).map(|i| i as f32).collect();
        let samples = FlatSamples::F32(values.clone());
        let image = Image::from_layer(layer("", (0, 0), (150, 70), "Z", samples));
        image.write().to_file(&path).unwrap();
        let picture = bspray::picture::exr::read(&path).unwrap();
        assert_eq!(
            bits(&picture.channels[0].samples),
            bits(&Samples::F32(values))
        );
    }
}
