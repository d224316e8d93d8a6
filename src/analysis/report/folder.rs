//! A report as a folder of files, each complete or not there.

use std::io::Write;
use std::path::Path;

use super::{Chart, Report, Section, Table};
use crate::picture::exr::write as write_exr;
use crate::picture::{PictureError, ldr, replace_file};

impl Report {
    /// Writes all files into a folder, which is made if need be; `report.html` comes last. Files of those names are replaced, others stay.
    ///
    /// # Errors
    /// What the system says of the folder or of a file.
    pub fn write(&self, folder: &Path) -> Result<(), PictureError> {
        std::fs::create_dir_all(folder).map_err(|e| PictureError::io(folder, e))?;
        let path = |name: &str, ending: &str| folder.join(format!("{name}{ending}"));
        for section in &self.sections {
            match section {
                Section::Verdict(..) | Section::Heading(_) | Section::Paragraph(_) => {}
                Section::Table(table) => csv(folder, table)?,
                Section::Chart(chart) => files_of_chart(folder, chart)?,
                Section::Picture(picture) => {
                    ldr::write(&path(&picture.name, ".png"), &picture.raster)?;
                }
                Section::Pair(pair) => {
                    ldr::write(&path(&pair.name, "-left.png"), &pair.left.1)?;
                    ldr::write(&path(&pair.name, "-right.png"), &pair.right.1)?;
                }
                Section::Layers(layers) => {
                    write_exr(&path(&layers.name, ".exr"), &layers.picture)?;
                }
            }
        }
        text(&folder.join("report.json"), &format!("{:#}\n", self.json()))?;
        text(&folder.join("report.html"), &self.html())
    }
}

fn files_of_chart(folder: &Path, chart: &Chart) -> Result<(), PictureError> {
    csv(folder, &chart.table())?;
    text(&folder.join(format!("{}.svg", chart.name)), &chart.svg())?;
    ldr::write(&folder.join(format!("{}.png", chart.name)), &chart.raster())
}

fn csv(folder: &Path, table: &Table) -> Result<(), PictureError> {
    text(&folder.join(format!("{}.csv", table.name)), &table.csv())
}

fn text(path: &Path, text: &str) -> Result<(), PictureError> {
    let write = |file: &mut std::fs::File| file.write_all(text.as_bytes());
    replace_file(path, write).map_err(|e: std::io::Error| PictureError::io(path, e))
}
