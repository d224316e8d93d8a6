//! Tables of typed columns: in the page, as CSV and as JSON.

use std::fmt::Write;

use serde_json::{Map, Value, json};

/// A value of a table.
#[derive(Clone, Debug, PartialEq)]
pub enum Cell {
    /// Words.
    Text(String),
    /// A whole number.
    Count(u64),
    /// A number; the page rounds it, CSV and JSON have all digits.
    Real(f64),
    /// Nothing is known.
    Missing,
}

impl From<&str> for Cell {
    fn from(text: &str) -> Self {
        Self::Text(text.to_owned())
    }
}

impl From<u64> for Cell {
    fn from(count: u64) -> Self {
        Self::Count(count)
    }
}

impl From<usize> for Cell {
    fn from(count: usize) -> Self {
        Self::Count(count as u64)
    }
}

impl From<f64> for Cell {
    fn from(number: f64) -> Self {
        Self::Real(number)
    }
}

impl<T: Into<Cell>> From<Option<T>> for Cell {
    fn from(value: Option<T>) -> Self {
        value.map_or(Self::Missing, Into::into)
    }
}

impl Cell {
    /// As people read it: four significant digits of a number that is not whole.
    pub(super) fn shown(&self) -> String {
        match self {
            Self::Text(text) => text.clone(),
            Self::Count(count) => count.to_string(),
            Self::Real(number) => shown(*number),
            Self::Missing => "–".to_owned(),
        }
    }

    /// With all digits.
    pub(super) fn exact(&self) -> String {
        match self {
            Self::Text(text) => text.clone(),
            Self::Count(count) => count.to_string(),
            Self::Real(number) => number.to_string(),
            Self::Missing => String::new(),
        }
    }

    pub(super) fn json(&self) -> Value {
        match self {
            Self::Text(text) => json!(text),
            Self::Count(count) => json!(count),
            Self::Real(number) if number.is_finite() => json!(number),
            Self::Real(number) => json!(number.to_string()),
            Self::Missing => Value::Null,
        }
    }

    /// Whether it stands at the right of its column.
    pub(super) fn is_number(&self) -> bool {
        matches!(self, Self::Count(_) | Self::Real(_) | Self::Missing)
    }
}

/// A number with four significant digits, in plain digits where these are few.
pub(super) fn shown(x: f64) -> String {
    let magnitude = x.abs();
    if !x.is_finite() || magnitude.fract() <= 0.0 && magnitude < 1e7 {
        return format!("{x}");
    }
    if !(1e-4..1e7).contains(&magnitude) {
        return format!("{x:.3e}");
    }
    let before = libm::log10(magnitude).floor() as i32;
    format!("{x:.*}", (3 - before).max(0) as usize)
}

/// A table with a name, which is the stem of its file's.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Table {
    /// Lower-case letters, digits and hyphens, different from all names of the report.
    pub name: String,
    /// What it shows, in a line.
    pub title: String,
    /// Heads of the columns, with their units: `build (s)`.
    pub columns: Vec<String>,
    /// A cell for each column.
    pub rows: Vec<Vec<Cell>>,
}

impl Table {
    /// A table without rows.
    pub fn new(name: &str, title: &str, columns: &[&str]) -> Self {
        Self {
            name: name.to_owned(),
            title: title.to_owned(),
            columns: columns.iter().map(|&c| c.to_owned()).collect(),
            rows: Vec::new(),
        }
    }

    /// Adds a row.
    ///
    /// # Panics
    /// If it has not a cell for each column.
    pub fn push(&mut self, row: Vec<Cell>) {
        assert_eq!(row.len(), self.columns.len(), "a cell for each column");
        self.rows.push(row);
    }

    /// The table as RFC 4180 has it.
    pub fn csv(&self) -> String {
        let mut out = String::new();
        let heads = self.columns.iter().map(|c| field(c));
        let _ = writeln!(out, "{}", heads.collect::<Vec<_>>().join(","));
        for row in &self.rows {
            let fields = row.iter().map(|cell| field(&cell.exact()));
            let _ = writeln!(out, "{}", fields.collect::<Vec<_>>().join(","));
        }
        out
    }

    /// Rows as objects whose keys are the columns' heads.
    pub fn json(&self) -> Value {
        let row = |row: &Vec<Cell>| {
            let cells = self.columns.iter().cloned().zip(row.iter().map(Cell::json));
            Value::Object(cells.collect::<Map<_, _>>())
        };
        json!({ "title": self.title, "rows": self.rows.iter().map(row).collect::<Vec<_>>() })
    }
}

/// Quoted where it must be.
fn field(text: &str) -> String {
    if text.contains([',', '"', '\n', '\r']) {
        format!("\"{}\"", text.replace('"', "\"\""))
    } else {
        text.to_owned()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_rounded_for_people_and_whole_in_files() {
        for (x, expected) in [
            (0.0, "0"),
            (12.0, "12"),
            (1.234_567, "1.235"),
            (0.001_234_56, "0.001235"),
            (-123.456, "-123.5"),
            (12_345.6, "12346"),
            (1.5e9, "1.500e9"),
            (2.5e-7, "2.500e-7"),
            (f64::INFINITY, "inf"),
        ] {
            assert_eq!(shown(x), expected);
        }
        let mut table = Table::new("t", "T", &["name, or so", "x (s)", "n"]);
        table.push(vec!["a \"b\"".into(), (1.0 / 3.0).into(), 7_u64.into()]);
        table.push(vec!["c".into(), f64::NAN.into(), None::<u64>.into()]);
        assert_eq!(
            table.csv(),
            "\"name, or so\",x (s),n\n\"a \"\"b\"\"\",0.3333333333333333,7\nc,NaN,\n"
        );
        let rows = &table.json()["rows"];
        assert_eq!(rows[0]["x (s)"], 1.0 / 3.0);
        assert_eq!(rows[1]["x (s)"], "NaN");
        assert_eq!(rows[1]["n"], Value::Null);
    }
}
