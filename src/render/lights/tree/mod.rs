//! Which emitter light is asked of, by where it is needed: a tree over all of them, whose nodes know where their emitters are, how much light they send and which way they face.
//!
//! Conty Estévez and Kulla 2018, "Importance Sampling of Many Lights with Adaptive Tree Splitting", in the form of pbrt-v4 (Pharr, Jakob and Humphreys 2023, section 12.6.3): at every node the
//! choice goes by how much light could arrive from either side. Here that is no bound but an estimate, which tells near nodes apart better; and emitters send light from both sides, so which
//! way they face is a cone of lines. Nobody is left out: what can bring little is chosen seldom.

mod group;

use std::f32::consts::FRAC_PI_2;

use glam::Vec3;

pub(super) use self::group::Source;
use self::group::{Group, divide};
use super::Receiver;

/// Least cosine that a node and a receiver are thought to face each other with: what is known of both is rough, and shading normals differ from the receiver's.
const LEAST_COSINE: f32 = 0.02;

/// Least chance of either side of a node.
const LEAST_SHARE: f32 = 1e-6;

/// The greatest number below 1.
const BELOW_ONE: f64 = 1.0 - f64::EPSILON / 2.0;

/// A tree over all emitters of a scene.
#[derive(Debug, Default)]
pub(super) struct Tree {
    /// The root first, the two sides of a node next to each other.
    nodes: Vec<Node>,
    /// The numbers of the emitters, those of a leaf next to each other.
    order: Vec<u32>,
    /// For each place in that order, the power up to it, as a share of its leaf's.
    cumulative: Vec<f64>,
    /// The place in that order of each emitter, and its leaf.
    places: Vec<(u32, u32)>,
}

#[derive(Clone, Copy, Debug)]
struct Node {
    reach: Reach,
    /// 0 for the root, which has none.
    parent: u32,
    /// Of a leaf, its first place in the order; else the first of its sides.
    first: u32,
    /// Emitters of a leaf; 0 for others.
    count: u32,
}

/// Where a node's light comes from.
#[derive(Clone, Copy, Debug)]
struct Reach {
    /// The sphere around its box.
    center: Vec3,
    radius: f32,
    /// Half the edges of the box.
    half: Vec3,
    /// Around which line the normals lie, and how far from it at most.
    axis: Vec3,
    cosine: f32,
    sine: f32,
    power: f32,
}

impl Tree {
    /// With emitters close to each other side by side.
    pub(super) fn new(sources: &[Source]) -> Self {
        Self::build(sources, |group| group.is_compact())
    }

    /// All are chosen by their power, wherever light is needed.
    pub(super) fn by_power(sources: &[Source]) -> Self {
        Self::build(sources, |_| true)
    }

    fn build(sources: &[Source], is_leaf: impl Fn(&Group) -> bool) -> Self {
        let mut tree = Self {
            order: (0..sources.len() as u32).collect(),
            ..Self::default()
        };
        if sources.is_empty() {
            return tree;
        }
        let all = Group::over(sources, &tree.order);
        tree.nodes.push(Node::of(&all, 0));
        let mut open = vec![(0, 0..sources.len(), all)];
        while let Some((node, places, group)) = open.pop() {
            if places.len() == 1 || is_leaf(&group) {
                tree.nodes[node].first = places.start as u32;
                tree.nodes[node].count = places.len() as u32;
                continue;
            }
            let first = tree.nodes.len();
            tree.nodes[node].first = first as u32;
            let (count, sides) = divide(sources, &mut tree.order[places.clone()]);
            let middle = places.start + count;
            tree.nodes
                .extend(sides.iter().map(|side| Node::of(side, node as u32)));
            let places = [places.start..middle, middle..places.end];
            let below = (first..).zip(places).zip(sides);
            open.extend(below.map(|((node, places), side)| (node, places, side)));
        }
        tree.cumulative = vec![0.0; sources.len()];
        tree.places = vec![(0, 0); sources.len()];
        for (number, node) in tree.nodes.iter().enumerate().filter(|(_, n)| n.count > 0) {
            let places = node.first as usize..(node.first + node.count) as usize;
            let power = |place: usize| sources[tree.order[place] as usize].power;
            let total: f64 = places.clone().map(power).sum();
            let mut sum = 0.0;
            for place in places.clone() {
                sum += power(place);
                tree.cumulative[place] = if total > 0.0 {
                    sum / total
                } else {
                    (place - places.start + 1) as f64 / f64::from(node.count)
                };
                tree.places[tree.order[place] as usize] = (place as u32, number as u32);
            }
        }
        tree
    }

    /// An emitter, chosen for a receiver with a number, and the chance that it had. There must be one.
    pub(super) fn choose(&self, receiver: &Receiver, choice: f32) -> (usize, f32) {
        let mut choice = f64::from(choice);
        let (mut node, mut chance) = (&self.nodes[0], 1.0_f32);
        while node.count == 0 {
            let share = self.first_share(node, receiver);
            let (side, of_side) = match choice < f64::from(share) {
                true => (0, share),
                false => (1, 1.0 - share),
            };
            let before = f64::from(share) * f64::from(side);
            choice = ((choice - before) / f64::from(of_side)).clamp(0.0, BELOW_ONE);
            chance *= of_side;
            node = &self.nodes[(node.first + side) as usize];
        }
        let (first, count) = (node.first as usize, node.count as usize);
        let within = self.cumulative[first..first + count].partition_point(|&c| c <= choice);
        let place = first + within.min(count - 1);
        (
            self.order[place] as usize,
            chance * self.share_of_leaf(node, place),
        )
    }

    /// The chance with which [`Tree::choose`] chooses an emitter.
    pub(super) fn chance(&self, emitter: usize, receiver: &Receiver) -> f32 {
        let (place, leaf) = self.places[emitter];
        let mut number = leaf;
        let mut chance = self.share_of_leaf(&self.nodes[number as usize], place as usize);
        while number > 0 {
            let parent = &self.nodes[self.nodes[number as usize].parent as usize];
            let share = self.first_share(parent, receiver);
            chance *= if number == parent.first {
                share
            } else {
                1.0 - share
            };
            number = self.nodes[number as usize].parent;
        }
        chance
    }

    fn share_of_leaf(&self, leaf: &Node, place: usize) -> f32 {
        let before = match place == leaf.first as usize {
            true => 0.0,
            false => self.cumulative[place - 1],
        };
        (self.cumulative[place] - before) as f32
    }

    /// The chance of the first side of a node.
    #[inline]
    fn first_share(&self, node: &Node, receiver: &Receiver) -> f32 {
        let first = node.first as usize;
        let [a, b] = [first, first + 1].map(|side| self.nodes[side].reach.light_at(receiver));
        let share = a / (a + b);
        match share.is_finite() {
            true => share.clamp(LEAST_SHARE, 1.0 - LEAST_SHARE),
            // Nothing from either, or more than a number holds.
            false => 0.5,
        }
    }
}

impl Node {
    fn of(group: &Group, parent: u32) -> Self {
        Self {
            reach: Reach::of(group),
            parent,
            first: 0,
            count: 0,
        }
    }
}

impl Reach {
    fn of(group: &Group) -> Self {
        // Without a normal, all lines.
        let angle = if group.angle < 0.0 {
            FRAC_PI_2
        } else {
            group.angle
        };
        let (sine, cosine) = libm::sincosf(angle);
        Self {
            center: group.bounds.center(),
            radius: group.bounds.diagonal() / 2.0,
            half: group.bounds.extent() / 2.0,
            axis: group.axis,
            cosine,
            sine,
            power: group.power as f32,
        }
    }

    /// The share of the box that is before the receiver; all for one without a normal.
    #[inline(always)]
    fn above(&self, receiver: &Receiver) -> f32 {
        let height = (self.center - receiver.position).dot(receiver.normal);
        let reach = self.half.dot(receiver.normal.abs());
        let share = (height + reach) / (2.0 * reach);
        // No number for a point in the receiver's plane.
        if share < 1.0 { share.max(0.0) } else { 1.0 }
    }

    /// About how much light arrives at a receiver. From nearby, emitters are in other directions than the middle of the sphere is: half of the sine of the angle under which that is seen
    /// is added to cosines.
    #[inline(always)]
    fn light_at(&self, receiver: &Receiver) -> f32 {
        let away = receiver.position - self.center;
        let (squared, least) = (away.length_squared(), self.radius * self.radius);
        let near = 1.0 / squared.max(least);
        let inverse = near.sqrt();
        let spread = match squared < least {
            // Among them: they may be anywhere.
            true => 2.0,
            false => 0.5 * self.radius * inverse,
        };
        let facing = away.dot(self.axis).abs() * inverse;
        let facing = if facing < self.cosine {
            facing * self.cosine + (1.0 - facing * facing).sqrt() * self.sine
        } else {
            1.0
        };
        let arriving = if receiver.normal == Vec3::ZERO {
            1.0
        } else {
            (spread - away.dot(receiver.normal) * inverse) * self.above(receiver)
        };
        let share = |cosine: f32| cosine.clamp(LEAST_COSINE, 1.0);
        self.power * near * share(facing + spread) * share(arriving)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec2;

    /// A number without order, 0 to 1.
    pub(super) fn part(i: u32, factor: u32) -> f32 {
        (i.wrapping_mul(factor) % 9973) as f32 / 9973.0
    }

    pub(super) fn direction(i: u32) -> Vec3 {
        let z = 2.0 * part(i, 7919) - 1.0;
        let around = Vec2::from_angle(7.0 * part(i, 131)) * (1.0 - z * z).sqrt();
        around.extend(z)
    }

    /// Small emitters all over a wide hall, of very different powers, each facing some way.
    fn hall(count: u32) -> Vec<Source> {
        let source = |i: u32| {
            let place = Vec3::new(part(i, 2903), 0.1 * part(i, 31), part(i, 4001)) * 100.0;
            Source {
                bounds: [place, place + direction(i + 7).abs() * 0.3]
                    .into_iter()
                    .collect(),
                normal: if i % 50 == 3 {
                    Vec3::ZERO
                } else {
                    direction(i)
                },
                power: f64::from(part(i, 57) * part(i, 57)) * 9.0,
            }
        };
        (0..count).map(source).collect()
    }

    fn receivers() -> impl Iterator<Item = Receiver> {
        (0..60).map(|i| Receiver {
            position: Vec3::new(part(i, 17), 0.2 * part(i, 29) - 0.05, part(i, 41)) * 110.0,
            normal: if i % 7 == 0 {
                Vec3::ZERO
            } else {
                direction(3 * i)
            },
        })
    }

    #[test]
    fn chances_are_those_of_the_choices_and_sum_to_one() {
        for count in [1, 4, 5, 300] {
            let sources = hall(count);
            for tree in [Tree::new(&sources), Tree::by_power(&sources)] {
                for receiver in receivers() {
                    let chances = (0..count as usize).map(|e| tree.chance(e, &receiver));
                    let chances: Vec<f32> = chances.collect();
                    let sum: f32 = chances.iter().sum();
                    assert!((sum - 1.0).abs() < 1e-4, "{sum}");
                    let mut found = vec![0.0_f32; count as usize];
                    let n = 20_000;
                    for i in 0..n {
                        let (chosen, chance) = tree.choose(&receiver, (i as f32 + 0.5) / n as f32);
                        assert!((chance / chances[chosen] - 1.0).abs() < 1e-5);
                        found[chosen] += 1.0 / n as f32;
                    }
                    for (found, chance) in found.iter().zip(&chances) {
                        assert!((found - chance).abs() < 2e-4, "{found} for {chance}");
                    }
                }
            }
        }
    }

    #[test]
    fn no_emitter_has_no_chance() {
        let sources = hall(1000);
        let tree = Tree::new(&sources);
        for receiver in receivers() {
            for (emitter, source) in sources.iter().enumerate() {
                let chance = tree.chance(emitter, &receiver);
                assert!(chance > 0.0 || source.power == 0.0, "{source:?}");
            }
        }
    }

    /// Light that arrives from an emitter in the middle of its box.
    fn light(source: &Source, receiver: &Receiver) -> f64 {
        let way = source.bounds.center() - receiver.position;
        let direction = way.normalize();
        let facing = direction.dot(source.normal).abs();
        let arriving = match receiver.normal == Vec3::ZERO {
            true => 1.0,
            false => direction.dot(receiver.normal).max(0.0),
        };
        source.power * f64::from(facing * arriving / way.length_squared())
    }

    #[test]
    fn of_many_emitters_those_that_reach_a_place_are_chosen() {
        let sources = hall(1000);
        let (tree, plain) = (Tree::new(&sources), Tree::by_power(&sources));
        let (mut ours, mut theirs) = (0.0, 0.0);
        for receiver in receivers() {
            let lights: Vec<f64> = sources.iter().map(|s| light(s, &receiver)).collect();
            let all: f64 = lights.iter().sum();
            if all == 0.0 {
                // From below the hall, looking down.
                continue;
            }
            // The variance of one choice, over the square of what arrives.
            let variance = |tree: &Tree| {
                let second = lights.iter().enumerate().filter(|(_, l)| **l > 0.0);
                let second = second.map(|(e, l)| l * l / f64::from(tree.chance(e, &receiver)));
                second.sum::<f64>() / (all * all) - 1.0
            };
            ours += variance(&tree);
            theirs += variance(&plain);
        }
        assert!(ours * 20.0 < theirs, "{ours} {theirs}");
    }

    #[test]
    fn emitters_at_one_place_and_of_no_power_are_survived() {
        let source = Source {
            bounds: [Vec3::ONE].into_iter().collect(),
            normal: Vec3::ZERO,
            power: 0.0,
        };
        let tree = Tree::build(&[source; 33], |_| false);
        assert!(tree.nodes.len() == 65 && Tree::new(&[source; 33]).nodes.len() == 1);
        for position in [Vec3::ONE, Vec3::ZERO] {
            let receiver = Receiver {
                position,
                normal: Vec3::Y,
            };
            let chances = (0..33).map(|emitter| tree.chance(emitter, &receiver));
            assert!((chances.sum::<f32>() - 1.0).abs() < 1e-5);
            for choice in [0.0, 0.3, 0.999_999_9] {
                let (chosen, chance) = tree.choose(&receiver, choice);
                assert_eq!(chance, tree.chance(chosen, &receiver));
            }
        }
    }
}
