//! Reports: one page that opens without a network, and every number beside it as CSV and JSON.
//!
//! A report is a list of sections. [`Report::write`] makes a folder of `report.html`, `report.json`, a CSV file for each table and chart, SVG and
//! PNG for each chart, PNG for each picture and EXR for layers.
//!
//! ```
//! use bspray::analysis::report::{Axis, Chart, LineChart, Plot, Point, Provenance, Report, Scale, Section, Series, Table, Tone};
//!
//! let mut table = Table::new("failures", "Failures by scale", &["scale", "rate"]);
//! table.push(vec![1e3.into(), 0.0.into()]);
//! let line = Series {
//!     name: "bsp".into(),
//!     points: vec![Point { x: 1e3, y: 0.25, across: None, interval: Some([0.2, 0.3]), label: String::new() }],
//!     is_line: true,
//! };
//! let plot = Plot::Lines(LineChart {
//!     x: Axis::new("scale", Scale::Log),
//!     y: Axis::new("rate", Scale::Linear),
//!     series: vec![line],
//!     has_front: false,
//! });
//! let mut report = Report::new("An example", Provenance::of_run("bspray example"));
//! report.push(Section::Verdict(Tone::Good, "Nothing failed.".into()));
//! report.push(Section::Table(table));
//! report.push(Section::Chart(Chart { name: "rate".into(), title: "Rate".into(), plot }));
//! let folder = tempfile::tempdir()?;
//! report.write(folder.path())?;
//! assert!(folder.path().join("report.html").is_file() && folder.path().join("rate.svg").is_file());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod charts;
mod folder;
mod html;
mod pictures;
mod provenance;
mod table;

use serde_json::{Map, Value, json};

pub use charts::{Axis, Chart, DotChart, HeatChart, LineChart, Plot, Point, Scale, Series};
pub use pictures::{Layers, PicturePair, ShownPicture};
pub use provenance::Provenance;
pub use table::{Cell, Table};

/// How a verdict is meant.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Tone {
    /// As it should be.
    Good,
    /// Something to look at.
    Mixed,
    /// Something is wrong.
    Bad,
}

impl Tone {
    /// The name in the page and in JSON.
    pub fn name(self) -> &'static str {
        match self {
            Self::Good => "good",
            Self::Mixed => "mixed",
            Self::Bad => "bad",
        }
    }
}

/// A part of a report.
#[derive(Clone, Debug)]
pub enum Section {
    /// The outcome in plain words; it belongs first.
    Verdict(Tone, String),
    /// A heading.
    Heading(String),
    /// Words.
    Paragraph(String),
    /// A table, which sorts at a click on a head.
    Table(Table),
    /// A chart.
    Chart(Chart),
    /// A picture, such as a heat map.
    Picture(ShownPicture),
    /// Two pictures over one another, with a slider between them.
    Pair(PicturePair),
    /// Layers of measurements as an EXR file, which the page names.
    Layers(Layers),
}

impl Section {
    /// The stem of the section's files.
    fn name(&self) -> Option<&str> {
        match self {
            Self::Verdict(..) | Self::Heading(_) | Self::Paragraph(_) => None,
            Self::Table(table) => Some(&table.name),
            Self::Chart(chart) => Some(&chart.name),
            Self::Picture(picture) => Some(&picture.name),
            Self::Pair(pair) => Some(&pair.name),
            Self::Layers(layers) => Some(&layers.name),
        }
    }
}

/// A report.
#[derive(Clone, Debug)]
pub struct Report {
    title: String,
    provenance: Provenance,
    sections: Vec<Section>,
}

impl Report {
    /// A report without sections.
    pub fn new(title: &str, provenance: Provenance) -> Self {
        Self {
            title: title.to_owned(),
            provenance,
            sections: Vec::new(),
        }
    }

    /// Adds a section.
    ///
    /// # Panics
    /// If its name is no stem of a file, or another section's.
    pub fn push(&mut self, section: Section) {
        if let Some(name) = section.name() {
            let is_plain = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '-';
            assert!(
                !name.is_empty() && name != "report" && name.chars().all(is_plain),
                "{name:?}: names have lower-case letters, digits and hyphens"
            );
            let is_taken = self.sections.iter().any(|s| s.name() == Some(name));
            assert!(!is_taken, "{name:?} is there twice");
        }
        self.sections.push(section);
    }

    /// The page: one file, without references to others that it needs.
    pub fn html(&self) -> String {
        html::page(self)
    }

    /// Everything in words and numbers: verdicts, paragraphs, tables, the charts' numbers, and where they come from.
    pub fn json(&self) -> Value {
        let mut tables = Map::new();
        let mut words = Vec::new();
        for section in &self.sections {
            match section {
                Section::Verdict(tone, text) => {
                    words.push(json!({ "verdict": text, "tone": tone.name() }));
                }
                Section::Heading(text) => words.push(json!({ "heading": text })),
                Section::Paragraph(text) => words.push(json!({ "paragraph": text })),
                Section::Table(table) => {
                    tables.insert(table.name.clone(), table.json());
                }
                Section::Chart(chart) => {
                    tables.insert(chart.name.clone(), chart.table().json());
                }
                Section::Picture(_) | Section::Pair(_) | Section::Layers(_) => {}
            }
        }
        json!({ "title": self.title, "words": words, "tables": tables, "provenance": self.provenance.json() })
    }
}

#[cfg(test)]
mod tests;
