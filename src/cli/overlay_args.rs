//! Arguments for what is drawn over a picture, and words about it.

use anyhow::bail;
use bspray::accel::extents::{ExtentSphere, View};
use bspray::render::{Overlay, OverlayOptions, OverlayReport, PixelRect, Stage};
use clap::{Args, ValueEnum};

use super::UsageError;

/// What is drawn over the picture.
#[derive(Args, Debug)]
pub(super) struct OverlayArgs {
    /// Draw over the picture: extents, edges, or both with a comma between; .exr files get it as the layer `overlay`
    #[arg(
        long,
        value_enum,
        value_name = "LIST",
        value_delimiter = ',',
        help_heading = "Display"
    )]
    overlay: Vec<OverlayName>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum OverlayName {
    /// Each object's screen extent with its name, and the outlines of its box and sphere in world space
    Extents,
    /// The visible edges of all triangles
    Edges,
}

impl OverlayArgs {
    /// Whether extents are drawn.
    pub(super) fn shows_extents(&self) -> bool {
        self.overlay.contains(&OverlayName::Extents)
    }

    /// Refuses to draw where there is no picture.
    ///
    /// # Errors
    /// An overlay beside `--pixel`.
    pub(super) fn check(&self, is_report: bool) -> anyhow::Result<()> {
        if is_report && self.is_wanted() {
            let words = "--pixel prints a report and writes no picture: leave --overlay out";
            bail!(UsageError(words.to_owned()));
        }
        Ok(())
    }

    /// Whether anything is to be drawn.
    pub(super) fn is_wanted(&self) -> bool {
        !self.overlay.is_empty()
    }

    /// Draws what was asked for; `None` if that is nothing.
    pub(super) fn draw(
        &self,
        stage: &Stage,
        view: &View,
        window: PixelRect,
        sphere: ExtentSphere,
    ) -> Option<Overlay> {
        let options = OverlayOptions {
            extents: self.shows_extents(),
            sphere,
            edges: self.overlay.contains(&OverlayName::Edges),
        };
        let is_wanted = !self.overlay.is_empty();
        is_wanted.then(|| Overlay::draw(stage, view, window, &options))
    }

    /// What there is to say of the extents that were drawn.
    pub(super) fn note(&self, report: &OverlayReport) -> Option<String> {
        self.shows_extents().then(|| describe(report))
    }
}

fn describe(report: &OverlayReport) -> String {
    let OverlayReport {
        objects,
        on_picture,
        named,
        without_screen_extent,
    } = *report;
    let noun = if objects == 1 { "object" } else { "objects" };
    let mut line =
        format!("overlay: extents of {objects} {noun}, {on_picture} of them in the picture");
    if named == on_picture {
        line += ", all named";
    } else {
        line += &format!(", {named} named: there is no room for the names of the others");
    }
    if without_screen_extent > 0 {
        line += &format!(
            "; {without_screen_extent} have no screen extent: their placement is too skewed or too large"
        );
    }
    line
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_note_tells_of_names_and_extents_that_are_missing() {
        let report = OverlayReport {
            objects: 14,
            on_picture: 12,
            named: 12,
            without_screen_extent: 0,
        };
        let want = "overlay: extents of 14 objects, 12 of them in the picture, all named";
        assert_eq!(describe(&report), want);
        let report = OverlayReport {
            named: 3,
            without_screen_extent: 2,
            ..report
        };
        let line = describe(&report);
        assert!(
            line.contains(", 3 named: there is no room for the names of the others; 2 have no")
        );
    }
}
