//! The four sides of the court: walks under roofs to the north and the south, an open arcade to the west, a house to the east.

use super::super::gltf::Document;
use super::super::shapes::Shape;
use super::arcade::ArcadeParts;
use super::group::{Group, Pose};
use super::materials::Materials;
use super::plan::{ARCADE_DEPTH, ARCADE_TOP, BAY, HALF, ROOF_TOP, WALK};
use super::roof::Roofing;
use super::solids::block;
use super::stair::{RISE, STEPS, TREAD, WIDTH, stair};
use super::walls::{Opening, Windows, arched_door, wall};

/// How far eaves stand out.
const EAVES: f64 = 0.38;

/// Height of the walls of the north range and of the house.
const NORTH_HEIGHT: f64 = 7.3;
const EAST_HEIGHT: f64 = 6.7;

/// How thick house walls are.
const DEPTH: f64 = 0.4;

/// Height of the red band along the foot of walls.
const DADO: f64 = 0.95;

/// Where the stair begins.
pub(super) const STAIR_Z: f64 = 3.3;

fn put(
    document: &mut Document,
    group: &mut Group,
    name: &'static str,
    shape: &Shape,
    material: usize,
    pose: Pose,
) {
    let geometry = document.geometry(shape);
    let mesh = document.mesh_of(name, geometry, material);
    group.put(document, name, mesh, pose);
}

/// Everything that is built around the court.
pub(super) fn ranges(document: &mut Document, materials: &Materials) {
    let parts = ArcadeParts::new(document, materials);
    let roofing = Roofing::new(document, materials);
    let windows = Windows::new(document, materials, [0.40, 0.56]);
    north(document, materials, &parts, &roofing, &windows);
    south(document, materials, &parts, &roofing);
    west(document, materials, &parts, &roofing);
    east(document, materials, &roofing, &windows);
}

/// The roof of a walk, its eaves towards +z. The arcade's axis is z = 0.
fn walk_roof(
    document: &mut Document,
    materials: &Materials,
    roofing: &Roofing,
    seed: u64,
) -> Group {
    let eaves = ARCADE_DEPTH / 2.0 + EAVES;
    let (run, rise) = (WALK + eaves, ROOF_TOP - ARCADE_TOP - 0.02);
    let mut group = Group::new();
    let size = [2.0 * HALF + 0.5, run, rise];
    let slope = roofing.slope(document, materials, size, seed);
    let low = ARCADE_TOP + 0.02;
    group.add(document, "walk roof", slope, Pose::at([0.0, low, eaves]));
    // Rafters under the slab, their heads before the wall.
    let slope = libm::atan2(rise, run) * 180.0 / std::f64::consts::PI;
    let length = libm::sqrt(run * run + rise * rise);
    let rafter = block([-0.045, -0.21, -length + 0.1], [0.045, -0.091, 0.0], 0.0);
    let geometry = document.geometry(&rafter);
    let rafter = document.mesh_of("rafter", geometry, materials.oak);
    for i in 0..=20_u32 {
        let x = (f64::from(i) / 10.0 - 1.0) * (HALF - 0.02);
        let pose = Pose::at([x, low + 0.03, eaves - 0.06]).turned([1.0, 0.0, 0.0], slope);
        group.put(document, "rafter", rafter, pose);
    }
    group
}

fn north(
    document: &mut Document,
    materials: &Materials,
    parts: &ArcadeParts,
    roofing: &Roofing,
    windows: &Windows,
) {
    let mut group = parts.arcade(document);
    parts.put_pier(document, &mut group, [-HALF, 0.0]);
    parts.put_pier(document, &mut group, [HALF, 0.0]);
    let roof = walk_roof(document, materials, roofing, 21);
    group.add(document, "north roof", roof, Pose::at([0.0; 3]));

    // The wall behind, with the door in its middle and windows above the roof.
    let left = -HALF - 0.3;
    let (half, spring) = (0.82, 2.0);
    let door = Opening {
        low: [-left - half - 0.02, 0.0],
        high: [-left + half + 0.02, spring + half + 0.05],
    };
    let places = [-3.3, 0.0, 3.3].map(|x| [x - left, 6.25]);
    let mut openings = vec![door];
    openings.extend(places.map(|p| windows.opening(p)));
    let width = HALF * 2.0 + 0.3;
    let mut back = Group::new();
    let face = wall(width, NORTH_HEIGHT, DEPTH, &openings);
    put(
        document,
        &mut back,
        "north wall",
        &face,
        materials.plaster,
        Pose::at([0.0; 3]),
    );
    for (x, end) in [(0.0, door.low[0] - 0.16), (door.high[0] + 0.16, width)] {
        let dado = block([x, 0.0, -0.02], [end, DADO, 0.02], 0.012);
        put(
            document,
            &mut back,
            "dado",
            &dado,
            materials.dado,
            Pose::at([0.0; 3]),
        );
    }
    let angles = [[152.0, 160.0], [158.0, 118.0], [165.0, 150.0]];
    for (place, angles) in places.into_iter().zip(angles) {
        windows.put(document, &mut back, place, angles);
    }
    let door = arched_door(document, materials, half, spring);
    back.add(document, "north door", door, Pose::at([-left, 0.0, 0.0]));
    let coping = coping(document, materials, roofing, (width, 1), 22);
    let pose = Pose::at([width / 2.0, NORTH_HEIGHT, -DEPTH / 2.0]);
    back.add(document, "north coping", coping, pose);
    group.add(document, "north wall", back, Pose::at([left, 0.0, -WALK]));

    // The wall that closes the walk to the west.
    let mut end = Shape::default();
    let (depth, low) = (0.3, ARCADE_TOP);
    let outline = [[0.0, 0.0], [WALK, 0.0], [WALK, ROOF_TOP - 0.1], [0.0, low]];
    end.face(&outline.map(|[z, y]| [0.0, y, -z]));
    end.face(&[3, 2, 1, 0].map(|i: usize| [-depth, outline[i][1], -outline[i][0]]));
    let pose = Pose::at([-HALF + 0.1, 0.0, 0.0]);
    put(
        document,
        &mut group,
        "west end wall",
        &end,
        materials.plaster,
        pose,
    );
    group.finish(document, "north range", Pose::at([0.0, 0.0, -HALF]));
}

/// The top of a wall along x: tiles to the front, and to the back where one sees it.
fn coping(
    document: &mut Document,
    materials: &Materials,
    roofing: &Roofing,
    (width, sides): (f64, usize),
    seed: u64,
) -> Group {
    let mut group = Group::new();
    let both = [("front", seed, 0.0), ("back", seed + 100, 180.0)];
    for (name, seed, facing) in both.into_iter().take(sides) {
        let slope = roofing.slope(document, materials, [width, 0.36, 0.15], seed);
        let (sin, cos) = super::super::gltf::sin_cos(facing);
        let pose = Pose::at([0.36 * sin, 0.07, 0.36 * cos]).facing(facing);
        group.add(document, name, slope, pose);
    }
    let bed = block(
        [-width / 2.0, -0.01, -0.29],
        [width / 2.0, 0.06, 0.29],
        0.01,
    );
    put(
        document,
        &mut group,
        "coping bed",
        &bed,
        materials.stone,
        Pose::at([0.0; 3]),
    );
    group
}

fn south(document: &mut Document, materials: &Materials, parts: &ArcadeParts, roofing: &Roofing) {
    // Built as the north range, then turned: the walk lies at +z.
    let mut group = parts.arcade(document);
    parts.put_pier(document, &mut group, [-HALF, 0.0]);
    parts.put_pier(document, &mut group, [HALF, 0.0]);
    let roof = walk_roof(document, materials, roofing, 23);
    group.add(document, "south roof", roof, Pose::at([0.0; 3]));
    let beam = block([-HALF - 0.2, 4.85, -0.12], [HALF + 0.2, 5.1, 0.12], 0.02);
    put(
        document,
        &mut group,
        "ridge beam",
        &beam,
        materials.oak,
        Pose::at([0.0, 0.0, -WALK]),
    );
    let post = block([-0.11, 0.12, -0.11], [0.11, 4.85, 0.11], 0.02);
    let geometry = document.geometry(&post);
    let post = document.mesh_of("post", geometry, materials.oak);
    let foot = block([-0.19, 0.0, -0.19], [0.19, 0.14, 0.19], 0.02);
    let geometry = document.geometry(&foot);
    let foot = document.mesh_of("post foot", geometry, materials.stone);
    for x in [-HALF, -1.5 * BAY, 1.5 * BAY, HALF] {
        group.put(document, "post", post, Pose::at([x, 0.0, -WALK]));
        group.put(document, "post foot", foot, Pose::at([x, 0.0, -WALK]));
    }
    let pose = Pose::at([0.0, 0.0, HALF]).facing(180.0);
    group.finish(document, "south range", pose);
}

fn west(document: &mut Document, materials: &Materials, parts: &ArcadeParts, roofing: &Roofing) {
    let mut group = parts.arcade(document);
    let coping = coping(document, materials, roofing, (2.0 * HALF, 2), 24);
    let pose = Pose::at([0.0, ARCADE_TOP, 0.0]);
    group.add(document, "west coping", coping, pose);
    let pose = Pose::at([-HALF, 0.0, 0.0]).facing(90.0);
    group.finish(document, "west arcade", pose);
    // A garden wall beyond.
    let mut garden = Group::new();
    let face = block([-15.0, 0.0, -0.2], [15.0, 1.7, 0.2], 0.03);
    put(
        document,
        &mut garden,
        "garden wall",
        &face,
        materials.plaster,
        Pose::at([0.0; 3]),
    );
    let pose = Pose::at([-13.0, 0.0, 0.0]).facing(90.0);
    garden.finish(document, "garden wall", pose);
}

fn east(document: &mut Document, materials: &Materials, roofing: &Roofing, windows: &Windows) {
    // Along the wall, x runs from the north to the south.
    let start = -HALF - WALK;
    let width = 2.0 * (HALF + WALK);
    let along = |z: f64| z - start;
    let landing = RISE * f64::from(STEPS + 1);
    let (half, spring) = (0.52, 1.75);
    let door = along(STAIR_Z - TREAD * f64::from(STEPS) - 0.85);
    let mut openings = vec![Opening {
        low: [door - half - 0.02, landing],
        high: [door + half + 0.02, landing + spring + half + 0.05],
    }];
    let places = [[along(0.55), 5.0], [along(3.4), 5.0], [along(3.4), 2.0]];
    openings.extend(places.map(|p| windows.opening(p)));
    let mut house = Group::new();
    let face = wall(width, EAST_HEIGHT, DEPTH, &openings);
    put(
        document,
        &mut house,
        "east wall",
        &face,
        materials.plaster,
        Pose::at([0.0; 3]),
    );
    let dado = block([0.0, 0.0, -0.02], [width, DADO, 0.02], 0.012);
    put(
        document,
        &mut house,
        "dado",
        &dado,
        materials.dado,
        Pose::at([0.0; 3]),
    );
    for (place, angles) in places
        .into_iter()
        .zip([[155.0, 128.0], [160.0, 150.0], [112.0, 158.0]])
    {
        windows.put(document, &mut house, place, angles);
    }
    let leaf = arched_door(document, materials, half, spring);
    house.add(document, "upper door", leaf, Pose::at([door, landing, 0.0]));
    let coping = coping(document, materials, roofing, (width, 1), 25);
    let pose = Pose::at([width / 2.0, EAST_HEIGHT, -DEPTH / 2.0]);
    house.add(document, "east coping", coping, pose);
    let pose = Pose::at([HALF, 0.0, start]).facing(-90.0);
    house.finish(document, "east house", pose);
    let steps = stair(document, materials);
    steps.finish(document, "stair", Pose::at([HALF - WIDTH, 0.0, STAIR_Z]));
}
