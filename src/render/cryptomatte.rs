//! Cryptomatte: which objects and materials a pixel shows, and how much of it each covers, as channels from which compositors cut mattes with soft edges.
//!
//! Friedman and Jones, "Fully Automatic ID Mattes with Support for Motion Blur and Transparency" (SIGGRAPH 2015 posters), and Psyop's
//! Cryptomatte Specification 1.2. An id is the MurmurHash3 of a name, kept from being infinite, NaN or subnormal, and stored as the float of these
//! bits; what has one name has one id. A pixel has the six ids of the greatest coverage. Coverage is the share of the pixel's samples, which the pixel filter
//! has placed, so that each counts the same; surfaces with alpha share a sample.

use std::collections::BTreeMap;

use super::film::Film;
use super::tracer::Covered;
use crate::picture::{Attribute, Channel, Picture, Samples};
use crate::scene::Scene;

/// Ids of a pixel that are written: three layers of two, as many as all programs write.
const RANKS: usize = 6;

/// Channels of a layer: an id and its coverage, twice. Upper case: some programs look for nothing else.
const CHANNELS: [&str; 4] = ["R", "G", "B", "A"];

/// What mattes can be cut by.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MatteKind {
    /// Instances, by their names.
    Object,
    /// Materials, by their names.
    Material,
}

impl MatteKind {
    /// Every kind.
    pub const ALL: [Self; 2] = [Self::Object, Self::Material];

    /// Name of its layers in a file, which numbers from `00` follow.
    pub const fn layer(self) -> &'static str {
        match self {
            Self::Object => "CryptoObject",
            Self::Material => "CryptoMaterial",
        }
    }

    fn names(self, scene: &Scene) -> Vec<&str> {
        match self {
            Self::Object => scene.instances.iter().map(|i| i.name.as_str()).collect(),
            Self::Material => scene.materials.iter().map(|m| m.name.as_str()).collect(),
        }
    }
}

/// The ids of all instances and of all materials, in their order.
pub(super) struct MatteIds([Vec<u32>; 2]);

impl MatteIds {
    pub(super) fn of(scene: &Scene) -> Self {
        Self(MatteKind::ALL.map(|kind| kind.names(scene).into_iter().map(matte_id).collect()))
    }
}

/// An id in a pixel.
#[derive(Clone, Copy, Debug)]
struct Entry {
    id: u32,
    /// Sum over the samples.
    coverage: f32,
    /// Index of the pixel's next entry, or [`END`].
    next: u32,
}

/// The index of no entry.
const END: u32 = u32::MAX;

/// What covers the pixels of a tile: of each pixel a list, all of them in one place, since most have one entry.
#[derive(Clone, Debug, Default)]
struct MatteSums {
    first: Vec<u32>,
    entries: Vec<Entry>,
}

impl MatteSums {
    fn add(&mut self, pixel: usize, id: u32, coverage: f32) {
        let mut at = self.first[pixel];
        while at != END {
            let entry = &mut self.entries[at as usize];
            if entry.id == id {
                entry.coverage += coverage;
                return;
            }
            at = entry.next;
        }
        let next = std::mem::replace(&mut self.first[pixel], self.entries.len() as u32);
        self.entries.push(Entry { id, coverage, next });
    }

    fn entries(&self, pixel: usize) -> impl Iterator<Item = (u32, f32)> {
        let entry = |at: u32| (at != END).then(|| &self.entries[at as usize]);
        std::iter::successors(entry(self.first[pixel]), move |e| entry(e.next))
            .map(|e| (e.id, e.coverage))
    }
}

/// What covers the pixels of a tile, by either kind.
#[derive(Clone, Debug, Default)]
pub(super) struct TileMattes([MatteSums; 2]);

impl TileMattes {
    /// For so many pixels.
    pub(super) fn new(pixels: usize) -> Self {
        Self(std::array::from_fn(|_| MatteSums {
            first: vec![END; pixels],
            entries: Vec::new(),
        }))
    }

    /// Adds the surfaces that a sample of a pixel met, and empties the list. What is missing to the sample's `alpha`, where one surface stood for all behind it, is the last one's.
    pub(super) fn add(
        &mut self,
        pixel: usize,
        ids: &MatteIds,
        covered: &mut Vec<Covered>,
        alpha: f32,
    ) {
        let sum: f32 = covered.iter().map(|c| c.share).sum();
        if let Some(last) = covered.last_mut() {
            last.share += (alpha - sum).max(0.0);
        }
        for covered in covered.drain(..) {
            let [objects, materials] = &ids.0;
            let found = [
                objects[covered.instance as usize],
                materials[covered.material as usize],
            ];
            for (sums, id) in self.0.iter_mut().zip(found) {
                sums.add(pixel, id, covered.share);
            }
        }
    }

    /// The ids of the greatest coverage in a pixel of so many samples, the greatest first, the lesser id of two equals; then nothing.
    pub(super) fn ranks(&self, kind: MatteKind, pixel: usize, samples: u32) -> [(u32, f32); RANKS] {
        let mut found: Vec<_> = self.0[kind as usize].entries(pixel).collect();
        found.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
        let mut ranks = [(0, 0.0); RANKS];
        for (rank, (id, coverage)) in ranks.iter_mut().zip(found) {
            *rank = (id, (coverage / samples.max(1) as f32).min(1.0));
        }
        ranks
    }
}

/// The picture with the mattes of a film that was rendered with layers: six ids and coverages of each kind, and the names behind the ids as attributes. Files of
/// Cryptomatte must have no other pixel filter over them, and no lossy compression.
#[must_use]
pub fn add_mattes(picture: Picture, film: &Film, scene: &Scene) -> Picture {
    MatteKind::ALL.into_iter().fold(picture, |picture, kind| {
        let pixels = film.map(|pixel| pixel.matte_ranks(kind));
        let mut picture = picture;
        for rank in 0..RANKS {
            let layer = format!("{}{:02}", kind.layer(), rank / 2);
            let [id, coverage] = [0, 1].map(|c| format!("{layer}.{}", CHANNELS[rank % 2 * 2 + c]));
            let ids = pixels.iter().map(|p| f32::from_bits(p[rank].0)).collect();
            let coverages = pixels.iter().map(|p| p[rank].1).collect();
            picture = picture
                .with_channel(Channel::new(id, Samples::F32(ids)))
                .with_channel(Channel::new(coverage, Samples::F32(coverages)));
        }
        let text = |t: &str| Attribute::Text(t.to_owned());
        let key = format!("cryptomatte/{}", layer_key(kind.layer()));
        picture
            .with_attribute(format!("{key}/name"), text(kind.layer()))
            .with_attribute(format!("{key}/hash"), text("MurmurHash3_32"))
            .with_attribute(format!("{key}/conversion"), text("uint32_to_float32"))
            .with_attribute(
                format!("{key}/manifest"),
                Attribute::Text(manifest(&kind.names(scene))),
            )
    })
}

/// The names with their ids in eight hexadecimal digits, as a JSON object, sorted.
fn manifest(names: &[&str]) -> String {
    let names: BTreeMap<_, _> = names
        .iter()
        .map(|name| (*name, format!("{:08x}", matte_id(name))))
        .collect();
    serde_json::json!(names).to_string()
}

/// What the attributes of a layer of that name have in common: seven digits of its id.
fn layer_key(name: &str) -> String {
    let mut digits = format!("{:08x}", matte_id(name));
    digits.truncate(7);
    digits
}

/// The bits of the float that stands for a name: its hash, with a bit of the exponent changed if it would not be a normal number.
pub fn matte_id(name: &str) -> u32 {
    let hash = murmur3(name.as_bytes());
    match hash >> 23 & 0xff {
        0 | 0xff => hash ^ 1 << 23,
        _ => hash,
    }
}

/// MurmurHash3_x86_32 with seed 0 (Appleby 2011, public domain).
fn murmur3(bytes: &[u8]) -> u32 {
    let mixed = |k: u32| {
        k.wrapping_mul(0xcc9e_2d51)
            .rotate_left(15)
            .wrapping_mul(0x1b87_3593)
    };
    let (words, rest) = bytes.as_chunks::<4>();
    let mut hash = 0_u32;
    for word in words {
        hash ^= mixed(u32::from_le_bytes(*word));
        hash = hash
            .rotate_left(13)
            .wrapping_mul(5)
            .wrapping_add(0xe654_6b64);
    }
    let tail = rest.iter().rev().fold(0, |k, &b| k << 8 | u32::from(b));
    hash ^= mixed(tail) ^ bytes.len() as u32;
    hash = (hash ^ hash >> 16).wrapping_mul(0x85eb_ca6b);
    hash = (hash ^ hash >> 13).wrapping_mul(0xc2b2_ae35);
    hash ^ hash >> 16
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hashes_are_the_published_ones() {
        // From the tests of the Python package mmh3 and of SMHasher's users.
        for (text, want) in [
            ("", 0),
            ("foo", 0xf6a5_c420),
            ("hello", 0x248b_fa47),
            ("hello, world", 0x149b_bb7f),
            ("The quick brown fox jumps over the lazy dog", 0x2e4f_f723),
        ] {
            assert_eq!(murmur3(text.as_bytes()), want, "{text}");
        }
        // From Blender's tests of its Cryptomatte.
        assert_eq!(layer_key("ViewLayer.CryptoMaterial"), "c7dbf5e");
        assert_eq!(layer_key("𝖚𝖓𝖎𝖈𝖔𝖉𝖊.CryptoMaterial"), "b990b65");
    }

    #[test]
    fn ids_are_normal_floats() {
        assert_eq!(matte_id(""), 1 << 23);
        let changed = (0..200_000).map(|i| i.to_string()).filter(|name| {
            assert!(f32::from_bits(matte_id(name)).is_normal(), "{name}");
            matte_id(name) != murmur3(name.as_bytes())
        });
        // 2 of 256 exponents: 1562 and a half, give or take 39.
        let changed = changed.count();
        assert!((1400..1730).contains(&changed), "{changed}");
    }

    #[test]
    fn ranks_are_sorted_and_alpha_is_covered() {
        let ids = MatteIds([(10..20).collect(), vec![7]]);
        let mut mattes = TileMattes::new(3);
        let mut add = |pixel, shares: &[(u32, f32)], alpha| {
            let covered = |&(instance, share)| Covered {
                instance,
                material: 0,
                share,
            };
            let mut list = shares.iter().map(covered).collect();
            mattes.add(pixel, &ids, &mut list, alpha);
            assert!(list.is_empty());
        };
        add(1, &[(4, 0.25), (9, 0.25), (2, 0.25)], 1.0);
        add(1, &[(9, 0.5)], 0.5);
        add(
            2,
            &[
                (0, 0.1),
                (1, 0.2),
                (2, 0.1),
                (3, 0.1),
                (4, 0.1),
                (5, 0.1),
                (6, 0.3),
            ],
            1.0,
        );
        let ranks = |pixel, kind| mattes.ranks(kind, pixel, 2);
        let nothing = (0, 0.0);
        assert_eq!(ranks(0, MatteKind::Object), [nothing; RANKS]);
        let want = [
            (19, 0.375),
            (12, 0.25),
            (14, 0.125),
            nothing,
            nothing,
            nothing,
        ];
        assert_eq!(ranks(1, MatteKind::Object), want);
        assert_eq!(ranks(1, MatteKind::Material)[..2], [(7, 0.75), nothing]);
        let six = ranks(2, MatteKind::Object).map(|r| r.0);
        assert_eq!(six, [16, 11, 10, 12, 13, 14]);
    }

    #[test]
    fn a_manifest_is_json_with_every_name_once() {
        let text = manifest(&["b", "a \"quoted\"", "b", "ä"]);
        let found: BTreeMap<String, String> = serde_json::from_str(&text).expect("it is JSON");
        let names: Vec<_> = found.keys().map(String::as_str).collect();
        assert_eq!(names, ["a \"quoted\"", "b", "ä"]);
        assert_eq!(found["b"], format!("{:08x}", matte_id("b")));
    }
}
