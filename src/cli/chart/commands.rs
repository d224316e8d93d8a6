//! The commands that measure a chart's points again, each in the row of its point.

use std::fmt::Write;

use bspray::accel::BuildOptions;
use bspray::analysis::chart::{ChartMethod, PicturePoint, RayPoint};

use super::page::ChartPage;
use crate::cli::metadata::quoted;

impl ChartPage<'_> {
    /// The command that measures a method on rays again.
    pub(super) fn ray_command(&self, p: &RayPoint) -> String {
        self.chart_command(&p.method, 0)
    }

    /// The command that renders a picture again, as an EXR file; or, where `render` has not the method, measures it again.
    pub(super) fn picture_command(&self, p: &PicturePoint) -> String {
        let options = self.options;
        let lod = p.budget.map(|pixels| format!(" --lod {pixels}"));
        let lod = lod.unwrap_or_default();
        let Some(arguments) = p.method.arguments(&options.build) else {
            return self.chart_command(&p.method, p.samples) + &lod;
        };
        format!(
            "bspray render {} {arguments}{}{lod} --integrator path --max-depth {} --resolution {}x{} --spp {} --seed {}{} -o picture.exr",
            self.model_words(),
            build_words(&options.build),
            self.max_depth,
            options.size.0,
            options.size.1,
            p.samples,
            options.seed,
            self.camera_words(),
        )
    }

    fn chart_command(&self, method: &ChartMethod, samples: u32) -> String {
        let options = self.options;
        let mut words = format!(
            "bspray chart {} --method {method} --samples {samples}",
            self.model_words()
        );
        if let (Some(_), Some(path)) = (method.needs_embree(), self.embree) {
            let _ = write!(words, " --embree {}", quoted(&path.to_string_lossy()));
        }
        let quality = options.build.quality;
        if quality != BuildOptions::default().quality {
            let _ = write!(words, " --bsp-quality {quality}");
        }
        if samples > 0 {
            let _ = write!(words, " --max-depth {}", self.max_depth);
        }
        let _ = write!(
            words,
            "{} --resolution {}x{} --max-rays {} --repetitions {} --seed {}{}",
            build_words(&options.build),
            options.size.0,
            options.size.1,
            options.most_rays,
            options.repetitions,
            options.seed,
            self.camera_words(),
        );
        words
    }

    fn model_words(&self) -> String {
        let models = self.models.iter();
        let words: Vec<_> = models.map(|m| quoted(&m.to_string_lossy())).collect();
        words.join(" ")
    }

    fn camera_words(&self) -> String {
        if self.camera_flags.is_empty() {
            String::new()
        } else {
            format!(" {}", self.camera_flags)
        }
    }
}

/// What else a BSP is built with, where it is not the usual.
fn build_words(build: &BuildOptions) -> String {
    let usual = BuildOptions::default();
    let mut words = String::new();
    if build.axes != usual.axes {
        let _ = write!(words, " --bsp-axes {}", build.axes);
    }
    if build.instructions != usual.instructions {
        let _ = write!(words, " --bsp-instructions {}", build.instructions);
    }
    if build.order != usual.order {
        let _ = write!(words, " --bsp-order {}", build.order);
    }
    if build.merges_coplanar {
        words += " --bsp-merge";
    }
    words
}

#[cfg(test)]
mod tests {
    use super::*;
    use bspray::accel::{BspAxes, BspOrder};

    #[test]
    fn only_unusual_builds_need_words() {
        let usual = BuildOptions::default();
        assert_eq!(build_words(&usual), "");
        let other = BuildOptions {
            axes: BspAxes::Space,
            order: BspOrder::File,
            merges_coplanar: true,
            ..usual
        };
        let words = " --bsp-axes space --bsp-order file --bsp-merge";
        assert_eq!(build_words(&other), words);
    }
}
