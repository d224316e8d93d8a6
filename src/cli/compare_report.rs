//! What a comparison found, as tables of at most 100 columns, and JSON.

use std::fmt::Write;
use std::path::PathBuf;

use bspray::analysis::{
    CompareOptions, Comparison, Fault, Faults, MethodOnSet, SetReport, Spread, WrongRay,
};
use bspray::geometry::Ray;
use bspray::render::Answer;
use bspray::scene::Scene;
use serde_json::{Value, json};

use super::numbers::{number, numbers};

/// Everything that is told about a comparison.
pub(super) struct CompareReport<'a> {
    pub(super) models: &'a [PathBuf],
    pub(super) scene: &'a Scene,
    pub(super) camera_flags: &'a str,
    pub(super) options: &'a CompareOptions,
    pub(super) threads: usize,
    pub(super) comparison: &'a Comparison,
}

impl CompareReport<'_> {
    /// A table of the structures, one for each kind of rays, and the oracle's verdict.
    pub(super) fn table(&self) -> String {
        let (options, threads) = (self.options, self.threads);
        let mut out = format!(
            "{}\ncamera: {}\nseed {}, {} repetitions; built with {threads} thread{}, rays timed on one\n\n",
            super::render::describe(self.scene),
            self.camera_flags,
            options.seed,
            options.repetitions,
            if threads == 1 { "" } else { "s" },
        );
        let _ = writeln!(
            out,
            "{:<14}{:>12}{:>16}{:>12}{:>12}{:>8}",
            "structure", "build s", "bytes", "bytes/tri", "nodes", "depth"
        );
        for method in &self.comparison.methods {
            let size = method.size;
            let _ = writeln!(
                out,
                "{:<14}{:>12.6}{:>16}{:>12.1}{:>12}{:>8}",
                method.kind.name(),
                method.build_seconds,
                size.bytes,
                size.bytes as f64 / size.triangles.max(1) as f64,
                size.nodes,
                size.depth,
            );
        }
        for set in &self.comparison.sets {
            self.set(set, &mut out);
        }
        self.verdict(&mut out);
        out
    }

    fn set(&self, set: &SetReport, out: &mut String) {
        let (name, query) = (set.purpose.name(), set.purpose.query().name());
        if set.rays == 0 {
            let _ = writeln!(out, "\n{name}: no rays");
            return;
        }
        let share = 100.0 * set.hits as f64 / set.rays as f64;
        let _ = writeln!(
            out,
            "\n{name}: {} rays, {query}; {share:.0} % hit",
            set.rays
        );
        let first = self.comparison.methods[0].kind.name();
        let _ = writeln!(
            out,
            "{:<14}{:>16}{:>19}{:>12}{:>12}{:>13}{:>8}",
            "",
            "Mrays/s",
            format!("x {first}"),
            "nodes/ray",
            "leaves/ray",
            "tris/ray",
            "wrong"
        );
        for (built, method) in self.comparison.methods.iter().zip(&set.methods) {
            let speed = |spread: fn(&bspray::analysis::Speed) -> Spread, unit: f64| {
                let spread = method.speed.as_ref().map(spread);
                spread.map_or("-".to_owned(), |s| {
                    format!("{:.3} ± {:.3}", s.median / unit, s.half_width() / unit)
                })
            };
            let [nodes, leaves, triangles] = per_ray(set, method);
            let _ = writeln!(
                out,
                "{:<14}{:>16}{:>19}{nodes:>12.2}{leaves:>12.2}{triangles:>13.2}{:>8}",
                built.kind.name(),
                speed(|s| s.rays_per_second, 1e6),
                speed(|s| s.ratio_to_first, 1.0),
                method.faults.total()
            );
        }
    }

    /// What was looked at, and who was wrong about what.
    fn verdict(&self, out: &mut String) {
        let sets = &self.comparison.sets;
        let sum = |count: fn(&SetReport) -> usize| sets.iter().map(count).sum::<usize>();
        let _ = writeln!(
            out,
            "\n{} of {} rays have answers that differ; {} others were checked against every triangle",
            sum(|s| s.disagreements),
            sum(|s| s.rays),
            sum(|s| s.sampled)
        );
        let among_named = sum(|s| s.decided_among_named);
        if among_named > 0 {
            let _ = writeln!(
                out,
                "{among_named} of the differing were decided among the triangles that a structure named"
            );
        }
        for (m, method) in self.comparison.methods.iter().enumerate() {
            let name = method.kind.name();
            let faults = sets.iter().filter_map(|set| {
                let words = in_words(&set.methods[m].faults)?;
                Some(format!("{words} in {} rays", set.purpose.name()))
            });
            let faults: Vec<_> = faults.collect();
            let words = if faults.is_empty() {
                "nothing wrong".to_owned()
            } else {
                format!("WRONG, by exact arithmetic: {}", faults.join("; "))
            };
            let _ = writeln!(out, "{name:<14}{words}");
        }
    }

    /// One JSON object.
    pub(super) fn json(&self) -> String {
        let options = self.options;
        let names: Vec<_> = options.kinds.iter().map(|k| k.name()).collect();
        let structures = self.comparison.methods.iter().map(|method| {
            let size = method.size;
            json!({
                "kind": method.kind.name(),
                "build_seconds": method.build_seconds,
                "triangles": size.triangles,
                "placements": size.placements,
                "nodes": size.nodes,
                "depth_levels": size.depth,
                "bytes": size.bytes,
                "bytes_per_triangle": size.bytes as f64 / size.triangles.max(1) as f64,
            })
        });
        let sets = self.comparison.sets.iter().map(|set| {
            let methods = names.iter().zip(&set.methods);
            json!({
                "kind": set.purpose.name(),
                "query": set.purpose.query().name(),
                "rays": set.rays,
                "hits": set.hits,
                "disagreements": set.disagreements,
                "disagreements_decided_among_named": set.decided_among_named,
                "others_checked_against_every_triangle": set.sampled,
                "structures": methods.map(|(name, m)| on_set(name, set, m)).collect::<Vec<_>>(),
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
            "structures": structures.collect::<Vec<_>>(),
            "rays": sets.collect::<Vec<_>>(),
            "first_is_right": self.comparison.is_first_right(),
        });
        format!("{report:#}")
    }
}

/// Mean nodes, leaves and triangle tests of a ray.
pub(super) fn per_ray(set: &SetReport, method: &MethodOnSet) -> [f64; 3] {
    let steps = method.steps;
    [steps.nodes, steps.leaves, steps.primitives].map(|n| n as f64 / set.rays.max(1) as f64)
}

/// Such as "2 holes, 1 ghost"; `None` without faults.
fn in_words(faults: &Faults) -> Option<String> {
    let words: Vec<_> = Fault::ALL
        .into_iter()
        .filter(|&f| faults.count(f) > 0)
        .map(|f| format!("{} {}", faults.count(f), f.name(faults.count(f) > 1)))
        .collect();
    (!words.is_empty()).then(|| words.join(", "))
}

fn on_set(name: &str, set: &SetReport, method: &MethodOnSet) -> Value {
    let [nodes, leaves, triangles] = per_ray(set, method);
    let faults = method.faults;
    json!({
        "kind": name,
        "rays_per_second": method.speed.map(|s| spread(s.rays_per_second)),
        "speed_ratio_to_first": method.speed.map(|s| spread(s.ratio_to_first)),
        "nodes_per_ray": nodes,
        "leaves_per_ray": leaves,
        "triangle_tests_per_ray": triangles,
        "wrong": {
            "total": faults.total(),
            "holes": faults.count(Fault::Hole),
            "ghosts": faults.count(Fault::Ghost),
            "wrong_depths": faults.count(Fault::WrongDepth),
            "wrong_names": faults.count(Fault::WrongName),
        },
    })
}

fn wrong_ray(wrong: &WrongRay, names: &[&str]) -> Value {
    let Ray {
        origin,
        direction,
        interval,
        ..
    } = wrong.ray;
    let answers = names.iter().zip(&wrong.answers);
    json!({
        "origin": numbers(origin.to_array()),
        "direction": numbers(direction.to_array()),
        "interval": numbers([interval.min, interval.max]),
        "truth": answer(&wrong.truth),
        "answers": answers.map(|(name, a)| json!({ "kind": name, "answer": answer(a) })).collect::<Vec<_>>(),
    })
}

fn answer(answer: &Answer) -> Value {
    match answer {
        Answer::Any(hit) => json!(hit),
        Answer::Closest(hit) => hit.map_or(
            Value::Null,
            |h| json!({ "t": number(h.t), "instance": h.instance, "triangle": h.triangle }),
        ),
    }
}

/// Median and quartiles.
pub(super) fn spread(s: Spread) -> Value {
    json!({ "median": s.median, "first_quartile": s.lower, "third_quartile": s.upper })
}
