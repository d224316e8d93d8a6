//! `bspray compare --replay`: the rays of a file, one by one, as every structure and exact arithmetic answer them.

use std::fmt::Write;
use std::path::Path;

use bspray::accel::{BuildOptions, Hit};
use bspray::analysis::{Built, Contestant, Entrant, NamedRays, Replayed, Said, replay};
use bspray::render::Answer;
use bspray::scene::Scene;
use serde_json::{Value, json};

use super::report::{answer, ray_json};
use crate::cli::{Done, output};

/// Asks and tells.
pub(super) fn run(
    scene: &Scene,
    contestants: &[Contestant],
    build: &BuildOptions,
    (path, rays): (&Path, &NamedRays),
    as_json: bool,
) -> anyhow::Result<Done> {
    let built: Result<Vec<Built>, _> = contestants.iter().map(|c| c.build(scene, build)).collect();
    let built = built?;
    let entrants: Vec<Entrant> = contestants
        .iter()
        .zip(&built)
        .map(|(contestant, built)| Entrant {
            contestant,
            accelerator: &*built.accelerator,
        })
        .collect();
    let replayed = replay(scene, &entrants, &rays.set);
    let names: Vec<&str> = contestants.iter().map(|c| &*c.name).collect();
    output::result(&if as_json {
        let purpose = rays.set.purpose;
        let rays: Vec<_> = replayed.iter().map(|r| one(r, &names)).collect();
        let report = json!({
            "file": path.to_string_lossy(),
            "kind": purpose.name(),
            "query": purpose.query().name(),
            "rays": rays,
        });
        format!("{report:#}")
    } else {
        let mut out = format!(
            "{}: {} {} rays, {}\n",
            path.display(),
            replayed.len(),
            rays.set.purpose.name(),
            rays.set.purpose.query().name()
        );
        for (index, ray) in replayed.iter().enumerate() {
            words(index, ray, &names, &mut out);
        }
        out + &summary(&replayed, &names)
    })?;
    let is_first_right = replayed.iter().all(|r| r.said[0].fault.is_none());
    Ok(if is_first_right {
        Done::Completely
    } else {
        Done::FirstIsWrong
    })
}

fn words(index: usize, replayed: &Replayed, names: &[&str], out: &mut String) {
    let ray = &replayed.ray;
    let [o, d] = [ray.origin, ray.direction].map(|v| format!("{},{},{}", v.x, v.y, v.z));
    let _ = writeln!(
        out,
        "\nray {index}: from {o} towards {d}, t from {} to {}",
        ray.interval.min, ray.interval.max
    );
    let _ = writeln!(out, "  {:<14}{}", "truth", answer_words(replayed.truth));
    for (said, name) in replayed.said.iter().zip(names) {
        let _ = writeln!(
            out,
            "  {name:<14}{:<58}{}",
            answer_words(said.answer),
            verdict(said)
        );
    }
}

fn verdict(said: &Said) -> String {
    match said.fault {
        Some(fault) => format!("WRONG: {}", fault.name(false)),
        None if said.is_unresolved => "unresolved (tie)".to_owned(),
        None => "right".to_owned(),
    }
}

fn answer_words(answer: Answer) -> String {
    match answer {
        Answer::Any(true) => "something is hit".to_owned(),
        Answer::Any(false) | Answer::Closest(None) => "nothing is hit".to_owned(),
        Answer::Closest(Some(Hit {
            t,
            instance,
            triangle,
        })) => format!(
            "t {t} (0x{:08x}), instance {instance}, triangle {triangle}",
            t.to_bits()
        ),
    }
}

fn summary(replayed: &[Replayed], names: &[&str]) -> String {
    let mut out = "\n".to_owned();
    for (m, name) in names.iter().enumerate() {
        let wrong = replayed.iter().filter(|r| r.said[m].fault.is_some());
        let _ = writeln!(
            out,
            "{name:<16}wrong about {} of {}",
            wrong.count(),
            replayed.len()
        );
    }
    out
}

fn one(replayed: &Replayed, names: &[&str]) -> Value {
    let said = names.iter().zip(&replayed.said).map(|(name, said)| {
        json!({
            "kind": name,
            "answer": answer(&said.answer),
            "wrong": said.fault.map(|f| f.name(false)),
            "unresolved": said.is_unresolved,
        })
    });
    let said: Vec<_> = said.collect();
    let mut value = ray_json(&replayed.ray);
    value["truth"] = answer(&replayed.truth);
    value["answers"] = json!(said);
    value
}
