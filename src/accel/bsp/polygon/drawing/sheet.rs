//! The few shapes of SVG that drawings are made of, as text. Lengths in pixels, y downwards.

use std::fmt::Write;

use glam::DVec2;

/// A drawing in the making: later shapes cover earlier ones.
#[derive(Default)]
pub(super) struct Sheet {
    body: String,
}

/// Text as XML has it; what XML has no place for becomes a space.
fn escaped(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\u{fffe}' | '\u{ffff}' => out.push(' '),
            c if c.is_control() => out.push(' '),
            c => out.push(c),
        }
    }
    out
}

// Writing to a string cannot fail.
impl Sheet {
    /// Shapes of this class follow, up to the next group.
    pub(super) fn group(&mut self, class: &str, shapes: impl FnOnce(&mut Self)) {
        let _ = writeln!(self.body, "<g class=\"{class}\">");
        shapes(self);
        self.body.push_str("</g>\n");
    }

    pub(super) fn line(&mut self, class: &str, from: DVec2, to: DVec2) {
        let (x1, y1, x2, y2) = (from.x, from.y, to.x, to.y);
        let _ = writeln!(
            self.body,
            "<line class=\"{class}\" x1=\"{x1:.1}\" y1=\"{y1:.1}\" x2=\"{x2:.1}\" y2=\"{y2:.1}\"/>"
        );
    }

    /// A rectangle with round corners around a centre.
    pub(super) fn rectangle(&mut self, class: &str, center: DVec2, size: DVec2, fill: &str) {
        let (corner, radius) = (center - size / 2.0, size.min_element().min(12.0) / 2.0);
        let _ = writeln!(
            self.body,
            "<rect class=\"{class}\" x=\"{:.1}\" y=\"{:.1}\" width=\"{:.1}\" height=\"{:.1}\" rx=\"{radius:.1}\" fill=\"{fill}\"/>",
            corner.x, corner.y, size.x, size.y
        );
    }

    pub(super) fn polygon(&mut self, class: &str, points: &[DVec2], fill: &str) {
        let points: Vec<String> = points
            .iter()
            .map(|p| format!("{:.1},{:.1}", p.x, p.y))
            .collect();
        let _ = writeln!(
            self.body,
            "<polygon class=\"{class}\" points=\"{}\" fill=\"{fill}\"/>",
            points.join(" ")
        );
    }

    /// Text whose middle is at `at`; the class says how it is aligned.
    pub(super) fn text(&mut self, class: &str, at: DVec2, text: &str) {
        let _ = writeln!(
            self.body,
            "<text class=\"{class}\" x=\"{:.1}\" y=\"{:.1}\">{}</text>",
            at.x,
            at.y,
            escaped(text)
        );
    }

    /// The file. `style` is in CSS, beside what all drawings share.
    pub(super) fn finish(self, size: DVec2, title: &str, style: &str) -> String {
        let (width, height) = (size.x.ceil(), size.y.ceil());
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" viewBox=\"0 0 {width} {height}\">\n\
             <title>{}</title>\n\
             <style>\n\
             text {{ font-family: Helvetica, Arial, 'DejaVu Sans', sans-serif; font-size: 14px; fill: #1a1a1a; \
             text-anchor: middle; dominant-baseline: central }}\n\
             text.head {{ font-size: 16px; font-weight: bold; text-anchor: start }}\n\
             text.note {{ font-size: 13px; fill: #444; text-anchor: start }}\n\
             {style}</style>\n\
             <rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n{}</svg>\n",
            escaped(title),
            self.body
        )
    }
}

/// Width of a text of 14 pixels, somewhat more than fonts have it.
pub(super) fn text_width(text: &str) -> f64 {
    8.4 * text.chars().count() as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_cannot_break_the_file() {
        let mut sheet = Sheet::default();
        sheet.text("note", DVec2::new(1.0, 2.0), "a<b> & \"c\"\u{7}");
        let svg = sheet.finish(DVec2::new(9.5, 8.0), "</title>", "");
        assert!(svg.contains(">a&lt;b&gt; &amp; &quot;c&quot; </text>"));
        assert!(
            svg.contains("<title>&lt;/title&gt;</title>") && svg.contains("viewBox=\"0 0 10 8\"")
        );
    }
}
