//! What a comparison found, as JSON; and what all forms of it share.

use std::path::PathBuf;

use bspray::analysis::accuracy::Trouble;
use bspray::analysis::{
    Agreement, CompareOptions, Comparison, Distances, Fault, MethodOnSet, Mistakes, PairReport,
    SetReport, WrongRay,
};
use bspray::geometry::Ray;
use bspray::render::Answer;
use bspray::scene::Scene;
use serde_json::{Value, json};

use crate::cli::numbers::{estimate, number, numbers, ratio};

/// Everything that is told about a comparison.
pub(super) struct CompareReport<'a> {
    pub(super) models: &'a [PathBuf],
    pub(super) scene: &'a Scene,
    pub(super) camera_flags: &'a str,
    pub(super) options: &'a CompareOptions,
    pub(super) threads: usize,
    pub(super) comparison: &'a Comparison,
    /// Methods that were left out, with the reasons.
    pub(super) left_out: &'a [String],
}

impl<'a> CompareReport<'a> {
    /// Names of the methods.
    pub(super) fn names(&self) -> Vec<&'a str> {
        let methods = self.comparison.methods.iter();
        methods.map(|m| &*m.contestant.name).collect()
    }

    /// The methods in groups, by their places: those of a group give the same answer, bit for bit, to every ray.
    pub(super) fn alike(&self) -> Vec<Vec<usize>> {
        let differ = |a: usize, b: usize| {
            let mut pairs = self.sets().flat_map(|set| &set.pairs);
            pairs.any(|pair| pair.methods == [a, b] && pair.different() > 0)
        };
        let mut groups: Vec<Vec<usize>> = Vec::new();
        for method in 0..self.comparison.methods.len() {
            match groups.iter_mut().find(|group| !differ(group[0], method)) {
                Some(group) => group.push(method),
                None => groups.push(vec![method]),
            }
        }
        groups
    }

    /// Each two methods of different groups, the first of each, on each set that has rays.
    pub(super) fn unlike_pairs(&self) -> Vec<(&'a SetReport, &'a PairReport)> {
        let firsts: Vec<usize> = self.alike().iter().map(|group| group[0]).collect();
        let is_shown = |pair: &&PairReport| pair.methods.iter().all(|m| firsts.contains(m));
        let of_set = |set: &'a SetReport| {
            let pairs = set.pairs.iter().filter(is_shown);
            pairs.map(move |pair| (set, pair)).collect::<Vec<_>>()
        };
        self.sets().flat_map(of_set).collect()
    }

    /// What the methods of a group are called, with commas between.
    pub(super) fn group_words(&self, group: &[usize]) -> String {
        let names = self.names();
        let of_group: Vec<_> = group.iter().map(|&m| names[m]).collect();
        of_group.join(", ")
    }

    /// Sets that have rays.
    pub(super) fn sets(&self) -> impl Iterator<Item = &'a SetReport> {
        self.comparison.sets.iter().filter(|set| set.rays > 0)
    }

    /// One JSON object.
    pub(super) fn json(&self) -> String {
        let options = self.options;
        let names = self.names();
        let structures = self.comparison.methods.iter().map(|method| {
            let size = method.size;
            json!({
                "kind": method.contestant.name,
                "owes_exact": method.contestant.owes_exact,
                "build_seconds": method.cost.seconds,
                "build_peak_bytes": method.cost.peak_bytes,
                "triangles": size.triangles,
                "placements": size.placements,
                "nodes": method.contestant.counts_steps().then_some(size.nodes),
                "depth_levels": method.contestant.counts_steps().then_some(size.depth),
                "bytes": size.bytes,
                "bytes_per_triangle": size.bytes as f64 / size.triangles.max(1) as f64,
            })
        });
        let sets = self.comparison.sets.iter().map(|set| {
            let methods = names.iter().zip(&set.methods);
            json!({
                "name": set.name,
                "kind": set.purpose.name(),
                "query": set.purpose.query().name(),
                "rays": set.rays,
                "hits": set.hits,
                "disputed": set.disputed,
                "disputed_decided_among_named": set.decided_among_named,
                "others_checked_against_every_triangle": set.sampled,
                "structures": methods.map(|(name, m)| on_set(name, set, m)).collect::<Vec<_>>(),
                "pairs": set.pairs.iter().map(|p| pair(p, &names)).collect::<Vec<_>>(),
                "wrong_rays": set.wrong.iter().map(|w| wrong_ray(w, &names)).collect::<Vec<_>>(),
            })
        });
        let report = json!({
            "program": "bspray",
            "version": env!("CARGO_PKG_VERSION"),
            "models": self.models.iter().map(|m| m.to_string_lossy()).collect::<Vec<_>>(),
            "triangles_placed": self.scene.placed_triangles(),
            "camera": self.camera_flags,
            "resolution_pixels": [options.size.0, options.size.1],
            "seed": options.seed,
            "repetitions": options.repetitions,
            "bsp_quality": options.build.quality.name(),
            "bsp_axes": options.build.axes.name(),
            "bsp_instructions": options.build.instructions.name(),
            "bsp_order": options.build.order.name(),
            "bsp_merges_coplanar": options.build.merges_coplanar,
            "build_threads": self.threads,
            "trace_threads": 1,
            "left_out": self.left_out,
            "structures": structures.collect::<Vec<_>>(),
            "rays": sets.collect::<Vec<_>>(),
            "first_is_right": self.comparison.is_first_right(),
        });
        format!("{report:#}")
    }
}

/// Mean nodes, leaves and triangle tests of a ray, of a method that tells them.
pub(super) fn per_ray(set: &SetReport, method: &MethodOnSet) -> [Option<f64>; 3] {
    let steps = method.steps.map(|s| [s.nodes, s.leaves, s.primitives]);
    [0, 1, 2].map(|kind| Some(steps?[kind] as f64 / set.rays.max(1) as f64))
}

fn on_set(name: &str, set: &SetReport, method: &MethodOnSet) -> Value {
    let [nodes, leaves, triangles] = per_ray(set, method);
    let mistakes = method.mistakes;
    let faults = mistakes.faults;
    json!({
        "kind": name,
        "rays_per_second": method.speed.map(|s| estimate(s.rays_per_second)),
        "speed_ratio_to_first": method.speed.map(|s| ratio(s.ratio_to_first)),
        "nodes_per_ray": nodes,
        "leaves_per_ray": leaves,
        "triangle_tests_per_ray": triangles,
        "wrong": {
            "total": faults.total(),
            "holes": faults.count(Fault::Hole),
            "ghosts": faults.count(Fault::Ghost),
            "wrong_depths": faults.count(Fault::WrongDepth),
            "wrong_names": faults.count(Fault::WrongName),
            "by_triangle_test": mistakes.by_test,
            "by_traversal": mistakes.by_traversal,
            "explained_by": explained(&mistakes),
        },
        "unresolved": mistakes.unresolved,
    })
}

/// How many wrong answers each cause explains, of those that there are.
fn explained(mistakes: &Mistakes) -> Value {
    let counts = Trouble::ALL.into_iter().zip(mistakes.troubles);
    let counts = counts.filter(|(_, count)| *count > 0);
    counts
        .map(|(trouble, count)| (trouble.name().to_owned(), json!(count)))
        .collect::<serde_json::Map<_, _>>()
        .into()
}

fn pair(pair: &PairReport, names: &[&str]) -> Value {
    let distances = |d: Option<Distances>| d.map(|d| [d.median, d.largest]);
    json!({
        "kinds": pair.methods.map(|m| names[m]),
        "same": pair.count(Agreement::Same),
        "ties": pair.count(Agreement::Tie),
        "other_depths": pair.count(Agreement::OtherDepth),
        "hits_against_misses": pair.count(Agreement::HitAgainstMiss),
        "ulps_median_and_largest": distances(pair.ulps),
        "model_units_median_and_largest": distances(pair.lengths),
        "degrees_of_normals_median_and_largest": distances(pair.turns),
    })
}

fn wrong_ray(wrong: &WrongRay, names: &[&str]) -> Value {
    let answers = names.iter().zip(wrong.answers.iter().zip(&wrong.faults));
    let answers = answers.map(|(name, (a, fault))| {
        json!({ "kind": name, "answer": answer(a), "wrong": fault.map(|f| f.name(false)) })
    });
    let answers: Vec<_> = answers.collect();
    let mut value = ray_json(&wrong.ray);
    value["truth"] = answer(&wrong.truth);
    value["answers"] = json!(answers);
    value
}

/// Where a ray runs.
pub(super) fn ray_json(ray: &Ray) -> Value {
    json!({
        "origin": numbers(ray.origin.to_array()),
        "direction": numbers(ray.direction.to_array()),
        "interval": numbers([ray.interval.min, ray.interval.max]),
    })
}

/// What a ray met.
pub(super) fn answer(answer: &Answer) -> Value {
    match answer {
        Answer::Any(hit) => json!(hit),
        Answer::Closest(hit) => hit.map_or(
            Value::Null,
            |h| json!({ "t": number(h.t), "instance": h.instance, "triangle": h.triangle }),
        ),
    }
}
