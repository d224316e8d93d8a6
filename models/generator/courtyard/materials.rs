//! The palette: warm plaster and stone, clay, oak, iron and bronze, glass, leaves.

use std::io;

use super::super::gltf::{Document, Material};
use super::textures;

/// The numbers of the materials.
pub(super) struct Materials {
    pub plaster: usize,
    pub dado: usize,
    pub stone: usize,
    pub paving: [usize; 3],
    pub inset: usize,
    pub terracotta: [usize; 3],
    pub clay: [usize; 4],
    pub earth: usize,
    pub oak: usize,
    pub shutter: usize,
    pub iron: usize,
    pub bronze: usize,
    pub steel: usize,
    pub glass: usize,
    pub water: usize,
    pub lamp: usize,
    pub pot: usize,
    pub glazed: usize,
    pub bark: usize,
    pub leaf: usize,
    pub dark_leaf: usize,
    pub cypress: usize,
    pub agave: usize,
    pub blossom: usize,
    pub fruit: usize,
}

impl Materials {
    pub(super) fn new(document: &mut Document) -> io::Result<Self> {
        let plaster = document.texture("plaster", &textures::plaster()?);
        let stone = document.texture("stone", &textures::stone()?);
        let wood = document.texture("wood", &textures::wood()?);
        let mut rough = |name, color, texture| {
            document.material(Material::new(name, color, 0.9).textured(texture))
        };
        Ok(Self {
            plaster: rough("plaster", [0.86, 0.64, 0.40], plaster),
            dado: rough("dado", [0.58, 0.27, 0.15], plaster),
            stone: rough("limestone", [0.80, 0.71, 0.56], stone),
            paving: [
                rough("paving", [0.66, 0.58, 0.45], stone),
                rough("paving, light", [0.72, 0.65, 0.52], stone),
                rough("paving, dark", [0.58, 0.50, 0.38], stone),
            ],
            terracotta: [
                rough("terracotta", [0.50, 0.22, 0.12], plaster),
                rough("terracotta, light", [0.57, 0.27, 0.15], plaster),
                rough("terracotta, dark", [0.42, 0.18, 0.10], plaster),
            ],
            earth: rough("grass", [0.20, 0.26, 0.09], plaster),
            oak: rough("oak", [0.30, 0.15, 0.07], wood),
            shutter: rough("shutter", [0.07, 0.21, 0.22], wood),
            bark: rough("bark", [0.22, 0.15, 0.10], wood),
            inset: document.material(Material::new("inset tile", [0.06, 0.12, 0.14], 0.25)),
            clay: [
                document.material(Material::new("clay", [0.53, 0.23, 0.12], 0.85)),
                document.material(Material::new("clay, light", [0.62, 0.32, 0.18], 0.85)),
                document.material(Material::new("clay, dark", [0.42, 0.17, 0.09], 0.85)),
                document.material(Material::new("clay, pale", [0.60, 0.40, 0.26], 0.85)),
            ],
            iron: document.material(Material::new("iron", [0.05, 0.05, 0.055], 0.5).metal()),
            bronze: document.material(Material::new("bronze", [0.62, 0.38, 0.16], 0.3).metal()),
            steel: document.material(Material::new("steel", [0.68, 0.69, 0.70], 0.05).metal()),
            glass: document.material(Material::new("glass", [0.72, 0.93, 0.89], 0.0).glass(
                1.5,
                0.4,
                [0.55, 0.88, 0.78],
                0.5,
            )),
            water: document.material(Material::new("water", [0.04, 0.20, 0.22], 0.02)),
            lamp: document.material(
                Material::new("lamp glass", [0.9, 0.7, 0.4], 0.4).emissive([1.0, 0.66, 0.30], 7.0),
            ),
            pot: document.material(Material::new("pot", [0.56, 0.25, 0.13], 0.8)),
            glazed: document.material(Material::new("glazed pot", [0.05, 0.22, 0.30], 0.15)),
            leaf: leaf(document, "leaf", [0.16, 0.30, 0.06]),
            dark_leaf: leaf(document, "citrus leaf", [0.09, 0.21, 0.05]),
            cypress: leaf(document, "cypress", [0.06, 0.13, 0.05]),
            agave: leaf(document, "agave", [0.22, 0.36, 0.25]),
            blossom: leaf(document, "bougainvillea", [0.66, 0.06, 0.26]),
            fruit: document.material(Material::new("orange", [0.86, 0.32, 0.03], 0.5)),
        })
    }
}

fn leaf(document: &mut Document, name: &'static str, color: [f32; 3]) -> usize {
    document.material(Material::new(name, color, 0.6).two_sided(true))
}
