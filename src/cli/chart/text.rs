//! What a chart found, for a terminal.

use std::fmt::Write;

use super::page::ChartPage;
use super::rays::{nanosecond_ends, nanoseconds};

impl ChartPage<'_> {
    /// For a terminal: a line a method, and a line a picture.
    pub(super) fn text(&self) -> String {
        let (_, verdict) = self.verdict();
        let mut out = format!(
            "{}\ncamera: {}\n",
            crate::cli::render::describe(self.scene),
            self.camera_flags
        );
        let rays = &self.points.rays.points;
        if !rays.is_empty() {
            let _ = writeln!(
                out,
                "\n{:<22}{:>18}{:>10}{:>14}{:>14}{:>14}",
                "rays", "ns/ray", "build s", "wrong/edges", "wrong/view", "depth error"
            );
        }
        for p in rays {
            let time = nanoseconds(p.speed.rays_per_second.median);
            let [low, high] = nanosecond_ends(p);
            let _ = writeln!(
                out,
                "{:<22}{:>18}{:>10.3}{:>14}{:>14}{:>14}",
                p.method.name(),
                format!("{time:.1} ± {:.1}", (high - low) / 2.0),
                p.build.seconds,
                share(p.edges.rate.rate),
                share(p.view.rate.rate),
                share(p.view.depth.rms),
            );
        }
        let pictures = &self.points.pictures.points;
        if !pictures.is_empty() {
            let _ = writeln!(
                out,
                "\n{:<22}{:>9}{:>18}{:>12}{:>12}{:>10}",
                "pictures", "samples", "s", "relMSE", "RMSE", "FLIP"
            );
        }
        for p in pictures {
            let [low, high] = [p.seconds.low, p.seconds.high];
            let _ = writeln!(
                out,
                "{:<22}{:>9}{:>18}{:>12.3e}{:>12.3e}{:>10.4}",
                p.name(),
                p.samples,
                format!("{:.3} ± {:.3}", p.seconds.median, (high - low) / 2.0),
                p.rel_mse,
                p.rmse,
                p.flip,
            );
        }
        let coarse = &self.points.pictures.coarse;
        if !coarse.is_empty() {
            let _ = writeln!(
                out,
                "\n{:<22}{:>12}{:>12}{:>14}{:>14}{:>12}",
                "simplified", "triangles", "kept", "error pixels", "depth error", "in one"
            );
        }
        for c in coarse {
            let _ = writeln!(
                out,
                "{:<22}{:>12}{:>12}{:>14.3}{:>14}{:>12}",
                format!("lod {}", c.budget),
                c.detail.triangles(),
                c.detail.kept(),
                c.detail.error(),
                share(c.depth.rms),
                c.in_one,
            );
        }
        let _ = write!(out, "\n{verdict}");
        out
    }
}

/// 0, or a number in few digits.
fn share(x: f64) -> String {
    if x > 0.0 {
        format!("{x:.2e}")
    } else {
        "0".to_owned()
    }
}
