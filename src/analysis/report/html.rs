//! The page of a report: style, script, charts and pictures are all within it.

use std::fmt::Write;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;

use super::{Chart, PicturePair, Report, Section, Table};
use crate::picture::{Raster, ldr};

/// Colours and type, for light and dark pages and for paper.
const STYLE: &str = include_str!("page.css");

/// Sorts tables and moves sliders.
const SCRIPT: &str = include_str!("page.js");

pub(super) fn page(report: &Report) -> String {
    let mut body = String::new();
    for section in &report.sections {
        write_section(section, &mut body);
    }
    let mut facts = String::new();
    for (name, value) in report.provenance.facts() {
        let _ = writeln!(
            facts,
            "<dt>{}</dt><dd>{}</dd>",
            escaped(name),
            escaped(value)
        );
    }
    let title = escaped(&report.title);
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
        <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
        <meta name=\"color-scheme\" content=\"light dark\">\n<link rel=\"icon\" href=\"data:,\">\n\
        <title>{title}</title>\n<style>\n{STYLE}</style>\n</head>\n<body>\n<main>\n<h1>{title}</h1>\n{body}\
        <h2>How it was measured</h2>\n<dl>\n{facts}</dl>\n\
        <p class=\"files\">All numbers: <a href=\"report.json\">report.json</a></p>\n\
        </main>\n<script>\n{SCRIPT}</script>\n</body>\n</html>\n"
    )
}

fn write_section(section: &Section, out: &mut String) {
    let _ = match section {
        Section::Verdict(tone, text) => writeln!(
            out,
            "<p class=\"verdict {}\">{}</p>",
            tone.name(),
            escaped(text)
        ),
        Section::Heading(text) => writeln!(out, "<h2>{}</h2>", escaped(text)),
        Section::Paragraph(text) => writeln!(out, "<p>{}</p>", escaped(text)),
        Section::Table(table) => writeln!(out, "{}", table_html(table)),
        Section::Chart(chart) => writeln!(out, "{}", chart_html(chart)),
        Section::Picture(picture) => writeln!(
            out,
            "<figure><img src=\"{}\" alt=\"{title}\"><figcaption>{title} {}</figcaption></figure>",
            data_url(&picture.raster),
            links(&picture.name, &["png"]),
            title = escaped(&picture.title)
        ),
        Section::Pair(pair) => writeln!(out, "{}", pair_html(pair)),
        Section::Layers(layers) => writeln!(
            out,
            "<p class=\"files\">{} {}</p>",
            escaped(&layers.title),
            links(&layers.name, &["exr"])
        ),
    };
}

fn table_html(table: &Table) -> String {
    let mut out = format!(
        "<div class=\"table\"><table id=\"{}\"><caption>{} {}</caption>\n<thead><tr>",
        table.name,
        escaped(&table.title),
        links(&table.name, &["csv"])
    );
    // A column is at the right if all its cells are.
    let is_number =
        |c: usize| !table.rows.is_empty() && table.rows.iter().all(|r| r[c].is_number());
    for (c, column) in table.columns.iter().enumerate() {
        let class = if is_number(c) { " class=\"n\"" } else { "" };
        let _ = write!(
            out,
            "<th{class} scope=\"col\"><button type=\"button\">{}</button></th>",
            escaped(column)
        );
    }
    out += "</tr></thead>\n<tbody>\n";
    for row in &table.rows {
        out += "<tr>";
        for (c, cell) in row.iter().enumerate() {
            let class = if is_number(c) { " class=\"n\"" } else { "" };
            let _ = write!(
                out,
                "<td{class} data-v=\"{}\">{}</td>",
                escaped(&cell.exact()),
                escaped(&cell.shown())
            );
        }
        out += "</tr>\n";
    }
    out + "</tbody></table></div>"
}

fn chart_html(chart: &Chart) -> String {
    let title = escaped(&chart.title);
    let svg = chart.inline_svg();
    let svg = svg.replacen(
        "<svg ",
        &format!("<svg role=\"img\" aria-label=\"{title}\" "),
        1,
    );
    format!(
        "<figure class=\"chart\" id=\"{}\">{svg}<figcaption>{}</figcaption></figure>",
        chart.name,
        links(&chart.name, &["svg", "png", "csv"])
    )
}

fn pair_html(pair: &PicturePair) -> String {
    let [left, right] = [&pair.left, &pair.right].map(|(words, raster)| {
        format!(
            "<img src=\"{}\" alt=\"{}\">",
            data_url(raster),
            escaped(words)
        )
    });
    let [left_words, right_words] = [&pair.left.0, &pair.right.0].map(|w| escaped(w));
    let name = &pair.name;
    format!(
        "<figure class=\"pair\" id=\"{name}\"><div class=\"stack\">{right}<div class=\"top\">{left}</div></div>\n\
        <div class=\"slide\"><span>{left_words}</span><input type=\"range\" min=\"0\" max=\"100\" value=\"50\" \
        aria-label=\"{left_words} or {right_words}\"><span>{right_words}</span></div>\n\
        <figcaption>{} <a href=\"{name}-left.png\">left</a> <a href=\"{name}-right.png\">right</a></figcaption></figure>",
        escaped(&pair.title)
    )
}

/// Links to the files beside the page.
fn links(name: &str, endings: &[&str]) -> String {
    let link = |ending: &&str| format!("<a href=\"{name}.{ending}\">{ending}</a>");
    endings.iter().map(link).collect::<Vec<_>>().join(" ")
}

fn data_url(raster: &Raster) -> String {
    // Only a wrong number of pixels is an error, and the file of the same picture says so.
    let bytes = ldr::png_bytes(raster).unwrap_or_default();
    format!("data:image/png;base64,{}", STANDARD.encode(bytes))
}

/// Text that no reader takes for markup.
fn escaped(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
        .replace('"', "&quot;")
}
