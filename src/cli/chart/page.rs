//! Speed against accuracy, as a page: the verdict, and how it was measured.

use std::fmt::Write;
use std::path::{Path, PathBuf};

use bspray::analysis::chart::{ChartOptions, ChartPoints, RayPoint};
use bspray::analysis::report::{Provenance, Report, Section, Tone};
use bspray::scene::Scene;

use super::rays::nanoseconds;
use crate::cli::metadata::command_line;

/// Everything that is told of a chart.
pub(super) struct ChartPage<'a> {
    pub(super) models: &'a [PathBuf],
    pub(super) scene: &'a Scene,
    pub(super) camera_flags: &'a str,
    pub(super) max_depth: u32,
    pub(super) options: &'a ChartOptions,
    /// Embree's library, if there is one.
    pub(super) embree: Option<&'a Path>,
    pub(super) threads: usize,
    pub(super) points: &'a ChartPoints,
    /// Structures that were left out, with the reasons.
    pub(super) left_out: &'a [String],
}

/// A chart's name, its title, and what its values are.
pub(super) type Words = [&'static str; 3];

/// A value, and where it lies.
pub(super) type Measure<'a, P> = &'a dyn Fn(&P) -> (f64, Option<[f64; 2]>);

impl ChartPage<'_> {
    /// The page.
    pub(super) fn report(&self) -> Report {
        let names: Vec<_> = self
            .models
            .iter()
            .map(|m| m.file_name().unwrap_or(m.as_os_str()).to_string_lossy())
            .collect();
        let title = format!("Speed against accuracy for {}", names.join(", "));
        let mut page = Report::new(&title, self.provenance());
        let (tone, words) = self.verdict();
        page.push(Section::Verdict(tone, words));
        let scene = crate::cli::render::describe(self.scene);
        let left_out = self.left_out.iter().map(|words| format!(". {words}"));
        page.push(Section::Paragraph(scene + &left_out.collect::<String>()));
        if !self.points.rays.points.is_empty() {
            self.push_rays(&mut page);
        }
        if !self.points.pictures.points.is_empty() {
            self.push_pictures(&mut page);
        }
        page
    }

    fn provenance(&self) -> Provenance {
        let options = self.options;
        let models: Vec<_> = self.models.iter().map(|m| m.to_string_lossy()).collect();
        let mut provenance = Provenance::of_run(&command_line())
            .with("models", &models.join(", "))
            .with("camera", self.camera_flags)
            .with(
                "resolution (pixels)",
                &format!("{}x{}", options.size.0, options.size.1),
            )
            .with("seed", &options.seed.to_string())
            .with("repetitions", &options.repetitions.to_string())
            .with("threads that build and render", &self.threads.to_string())
            .with("threads that trace timed rays", "1")
            .with(
                "instructions of bsp",
                options.build.instructions.name_in_use(),
            );
        if let Some(embree) = &options.embree {
            let words = format!("chosen by the library, Embree {}", embree.version());
            provenance = provenance.with("instructions of embree", &words);
        }
        provenance
    }

    pub(super) fn verdict(&self) -> (Tone, String) {
        let rays = &self.points.rays;
        let [asked, judged] = rays.judged;
        if !self.points.is_right() {
            let words = format!(
                "An exact method, or the reference, was wrong: of {judged} answers of the reference that were judged, {} were.",
                rays.reference_wrong
            );
            return (Tone::Bad, words);
        }
        let wrong = |p: &&RayPoint| p.view.rate.rate + p.edges.rate.rate > 0.0;
        let mut words = if rays.points.is_empty() {
            String::new()
        } else {
            let others = rays.points.iter().filter(|p| !p.method.is_exact());
            let failing: Vec<_> = others.clone().filter(wrong).collect();
            let worst = failing.iter().max_by(|a, b| {
                let rate = |p: &RayPoint| p.edges.rate.rate.max(p.view.rate.rate);
                rate(a).total_cmp(&rate(b))
            });
            let others = match worst {
                None => "no other method was wrong here".to_owned(),
                Some(p) => format!(
                    "of {} others {} were, {} the most often: about {} of rays at edges, and {} of those of the view",
                    others.count(),
                    failing.len(),
                    p.method,
                    percent(p.edges.rate.rate),
                    percent(p.view.rate.rate)
                ),
            };
            format!(
                "No exact method was wrong about any of {asked} rays, of which {judged} were judged by every triangle; {others}."
            )
        };
        let fastest = |is_exact: bool| {
            let of = rays
                .points
                .iter()
                .filter(|p| p.method.is_exact() == is_exact);
            of.max_by(|a, b| {
                let speed = |p: &RayPoint| p.speed.rays_per_second.median;
                speed(a).total_cmp(&speed(b))
            })
        };
        if let Some(exact) = fastest(true) {
            let time = |p: &RayPoint| nanoseconds(p.speed.rays_per_second.median);
            let _ = write!(
                words,
                " The fastest exact method is {}, at {:.0} ns a ray",
                exact.method,
                time(exact)
            );
            match fastest(false) {
                Some(other) => {
                    let _ = write!(
                        words,
                        "; the fastest other is {}, at {:.0} ns.",
                        other.method,
                        time(other)
                    );
                }
                None => words.push('.'),
            }
        }
        (Tone::Good, words.trim().to_owned())
    }
}

/// A share in percent, with two digits that are not zero.
fn percent(share: f64) -> String {
    if share <= 0.0 {
        return "none".to_owned();
    }
    let percent = 100.0 * share;
    let decimals = (1.0 - libm::log10(percent).floor()).clamp(0.0, 9.0) as usize;
    format!("{percent:.decimals$} %")
}

#[cfg(test)]
mod tests {
    use super::percent;

    #[test]
    fn small_shares_are_not_none() {
        let shares = [0.0, 1.41e-5, 0.122, 1.0].map(percent);
        assert_eq!(shares, ["none", "0.0014 %", "12 %", "100 %"]);
    }
}
