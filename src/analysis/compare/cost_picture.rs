//! What each method spends on each pixel of a picture, and where their answers differ: one eye ray through each pixel's centre.

use rayon::prelude::*;

use super::contestant::Entrant;
use super::pairs::Agreement;
use crate::accel::TraceCounters;
use crate::picture::{Channel, Picture, Raster, Samples, palette};
use crate::render::{Answer, MOST_STEPS};
use crate::scene::CameraFrame;

/// Colours of [`Agreement`]: black, blue, orange and red, told apart by all eyes. Linear.
const AGREEMENT_COLORS: [[f32; 3]; 4] = [
    [0.0, 0.0, 0.0],
    [0.03, 0.25, 0.9],
    [0.9, 0.45, 0.02],
    [0.9, 0.02, 0.02],
];

/// The costs of all methods, row by row from the top.
#[derive(Clone, Debug)]
pub struct CostPictures {
    /// Columns and rows.
    pub size: (u32, u32),
    /// For each method that counts its steps its name, and the steps of each pixel: inner nodes, leaves, triangle tests, tests of extents.
    methods: Vec<(String, Vec<[u32; 4]>)>,
    /// For each pixel the worst agreement of any method with the first.
    agreements: Vec<Agreement>,
}

impl CostPictures {
    /// With the threads of the rayon pool in which it is called.
    pub(super) fn of(entrants: &[Entrant], camera: &CameraFrame, size: (u32, u32)) -> Self {
        let rays = (0..size.1).into_par_iter().flat_map_iter(|y| {
            (0..size.0)
                .map(move |x| camera.ray(f64::from(x) + 0.5, f64::from(y) + 0.5, Some((x, y))))
        });
        let rays: Vec<_> = rays.collect();
        let mut first = Vec::new();
        let mut agreements = vec![Agreement::Same; rays.len()];
        let mut methods = Vec::new();
        for (index, entrant) in entrants.iter().enumerate() {
            let trace = |ray| {
                let mut c = TraceCounters::default();
                let hit = entrant.accelerator.closest_hit_counted(ray, &mut c);
                let steps = [c.nodes, c.leaves, c.primitives, c.extents];
                let steps = steps.map(|n| u32::try_from(n).unwrap_or(u32::MAX));
                (steps, Answer::Closest(hit))
            };
            let (steps, answers): (Vec<_>, Vec<_>) = rays.par_iter().map(trace).unzip();
            if index == 0 {
                first = answers;
            } else {
                let is_exact = [entrants[0], *entrant]
                    .iter()
                    .all(|e| e.contestant.owes_exact);
                let agreement = if is_exact {
                    Agreement::of
                } else {
                    Agreement::in_single_precision
                };
                for (worst, (a, b)) in agreements.iter_mut().zip(first.iter().zip(answers)) {
                    *worst = agreement(*a, b).max(*worst);
                }
            }
            if entrant.contestant.counts_steps() {
                methods.push((entrant.contestant.name.clone(), steps));
            }
        }
        Self {
            size,
            methods,
            agreements,
        }
    }

    /// The layers of an EXR file: `cost.METHOD.nodes`, `.leaves`, `.prims` and, where there are any, `.extents`; of all but the first `difference.METHOD`, the sum of these
    /// less that of the first; `disagreement`, the place in [`Agreement::ALL`].
    pub fn picture(&self) -> Picture {
        let mut picture = Picture::new(self.size.0, self.size.1);
        let mut first: Option<Vec<u64>> = None;
        for (name, steps) in &self.methods {
            for (kind, part) in ["nodes", "leaves", "prims", "extents"].iter().enumerate() {
                let values: Vec<u32> = steps.iter().map(|s| s[kind]).collect();
                if kind < 3 || values.iter().any(|&v| v > 0) {
                    let channel = format!("cost.{name}.{part}");
                    picture = picture.with_channel(Channel::new(channel, Samples::U32(values)));
                }
            }
            let totals: Vec<u64> = steps.iter().map(total).collect();
            if let Some(first) = &first {
                let values = totals.iter().zip(first);
                let values = values.map(|(&n, &of_first)| (n as f64 - of_first as f64) as f32);
                let channel = format!("difference.{name}");
                let samples = Samples::F32(values.collect());
                picture = picture.with_channel(Channel::new(channel, samples));
            } else {
                first = Some(totals);
            }
        }
        let classes = self.agreements.iter().map(|&a| a as u32).collect();
        picture.with_channel(Channel::new("disagreement", Samples::U32(classes)))
    }

    /// The names of the methods that count their steps.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.methods.iter().map(|(name, _)| name.as_str())
    }

    /// Mean steps of a pixel.
    pub fn mean(&self, method: usize) -> f64 {
        let steps = &self.methods[method].1;
        steps.iter().map(total).sum::<u64>() as f64 / steps.len().max(1) as f64
    }

    /// A method's steps in the colours of the integrator `cost`: violet for 1, yellow for [`MOST_STEPS`], by the logarithm.
    pub fn heat_map(&self, method: usize) -> Raster {
        let color = |steps: &[u32; 4]| {
            let steps = total(steps).max(1) as f32;
            palette::ramp(libm::log2f(steps) / libm::log2f(MOST_STEPS as f32))
        };
        let pixels: Vec<_> = self.methods[method].1.iter().map(color).collect();
        Raster::from_rgb(self.size.0, self.size.1, &pixels)
    }

    /// How many pixels are of a kind.
    pub fn count(&self, agreement: Agreement) -> usize {
        self.agreements.iter().filter(|&&a| a == agreement).count()
    }

    /// Where the methods differ: black where they do not, blue for ties, orange for other depths and red for a hit against nothing. Pixels around are marked too, so that
    /// single ones are seen.
    pub fn agreement_map(&self) -> Raster {
        let (width, height) = (self.size.0 as usize, self.size.1 as usize);
        let worst_around = |i: usize| {
            let (x, y) = (i % width, i / width);
            let rows = y.saturating_sub(1)..(y + 2).min(height);
            rows.flat_map(|y| (x.saturating_sub(1)..(x + 2).min(width)).map(move |x| (x, y)))
                .map(|(x, y)| self.agreements[y * width + x])
                .max()
                .unwrap_or_default()
        };
        let pixels: Vec<_> = (0..width * height)
            .map(|i| AGREEMENT_COLORS[worst_around(i) as usize])
            .collect();
        Raster::from_rgb(self.size.0, self.size.1, &pixels)
    }
}

fn total(steps: &[u32; 4]) -> u64 {
    steps.iter().map(|&n| u64::from(n)).sum()
}

#[cfg(test)]
mod tests {
    use super::super::contestant::Contestant;
    use super::*;
    use crate::accel::AcceleratorKind;
    use crate::render::{CameraWishes, frame_scene};
    use glam::Vec3;

    #[test]
    fn layers_hold_what_each_pixel_costs() {
        let scene = crate::import::load(&["models/lecture-block.obj".into()]).unwrap();
        let wishes = CameraWishes::default();
        let frame = frame_scene(&scene, &wishes, Vec3::Y, 1.5)
            .frame(12, 8)
            .unwrap();
        let contestants = [AcceleratorKind::Linear, AcceleratorKind::Bvh2];
        let contestants = contestants.map(Contestant::structure);
        let built = contestants
            .clone()
            .map(|c| c.build(&scene, &Default::default()).unwrap().accelerator);
        let entrants = [0, 1].map(|i| Entrant {
            contestant: &contestants[i],
            accelerator: &*built[i],
        });
        let costs = CostPictures::of(&entrants, &frame, (12, 8));
        let picture = costs.picture();
        let names: Vec<_> = picture.channels.iter().map(|c| c.name.as_str()).collect();
        assert_eq!(
            names,
            [
                "cost.linear.nodes",
                "cost.linear.leaves",
                "cost.linear.prims",
                "cost.bvh2.nodes",
                "cost.bvh2.leaves",
                "cost.bvh2.prims",
                "difference.bvh2",
                "disagreement"
            ]
        );
        let prims = picture.channel("cost.linear.prims").unwrap();
        assert_eq!(*prims, Samples::U32(vec![20; 96]));
        assert_eq!(costs.mean(0), 20.0);
        let Some(Samples::F32(difference)) = picture.channel("difference.bvh2") else {
            panic!("{names:?}");
        };
        let mean = difference.iter().map(|&d| f64::from(d)).sum::<f64>() / 96.0;
        assert!((mean - (costs.mean(1) - 20.0)).abs() < 1e-9);
        assert_eq!(costs.count(Agreement::Same), 96);
        let sizes = [costs.heat_map(1), costs.agreement_map()].map(|r| r.pixels.len());
        assert_eq!(sizes, [96, 96]);
    }

    #[test]
    fn the_worst_disagreement_of_a_pixel_counts_and_is_seen() {
        let mut costs = CostPictures {
            size: (9, 4),
            methods: Vec::new(),
            agreements: vec![Agreement::Same; 36],
        };
        costs.agreements[10] = Agreement::Tie;
        costs.agreements[11] = Agreement::HitAgainstMiss;
        let classes = costs.picture();
        let Some(Samples::U32(classes)) = classes.channel("disagreement") else {
            panic!("no classes");
        };
        assert_eq!(classes[9..12], [0, 1, 3]);
        assert_eq!(costs.count(Agreement::Same), 34);
    }
}
