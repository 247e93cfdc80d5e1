//! A cell of a table, with its text for people and its value for programs.

use super::super::figure::{brief, figure, figures, with_decimals};
use super::super::shortest;
use super::super::text::printable;
use serde_json::Value;

/// A cell of a table.
#[derive(Clone, Debug, PartialEq)]
pub struct Cell {
    shown: String,
    pub(super) data: Value,
}

impl Cell {
    /// Cell with a number. People see six digits, and 0 for a rounding error in this unit.
    pub fn figure(value: f64, unit: &str) -> Self {
        Cell::shown(value, figure(value, unit))
    }

    /// Cells with numbers in `unit` that people compare side by side. They have the decimals of the largest number.
    pub fn figures<const N: usize>(
        values: [Option<f64>; N],
        unit: &str,
    ) -> impl Iterator<Item = Self> {
        let cells = values.into_iter().zip(figures(values, unit));
        cells.map(|(value, text)| Cell::by(value, |_| text))
    }

    /// Cell with a number for programs and this text for people.
    pub fn shown(value: f64, text: impl Into<String>) -> Self {
        Cell {
            shown: text.into(),
            data: Value::from(value + 0.0),
        }
    }

    /// Cell with a number for programs. `show` makes the text for people. Empty without a value.
    pub fn by<T: Into<String>>(value: impl Into<Option<f64>>, show: impl FnOnce(f64) -> T) -> Self {
        let value = value.into();
        value.map(|value| Cell::shown(value, show(value))).into()
    }

    /// Cell with the same text as the cell above it. In text output, the cell is empty.
    pub fn repeated(text: &str) -> Self {
        Cell {
            shown: String::new(),
            data: Value::from(text),
        }
    }

    /// Cell with `data` for programs and words for people.
    pub fn in_words(data: impl Into<Value>, words: &str) -> Self {
        Cell {
            shown: words.to_owned(),
            data: data.into(),
        }
    }

    /// Cell with a measured number. People and programs get the same number of decimals.
    pub fn rounded(value: f64, decimals: usize) -> Self {
        let text = with_decimals(value, decimals);
        Cell::shown(text.parse().unwrap_or(value), text)
    }

    /// Text of the cell for people.
    pub fn text(&self) -> &str {
        &self.shown
    }

    /// Number in the cell, if it has one.
    pub fn number(&self) -> Option<f64> {
        self.data.as_f64()
    }

    /// True if the cell is aligned like a number.
    pub fn is_number(&self) -> bool {
        self.data.is_number()
            || self
                .shown
                .starts_with(|c: char| c.is_ascii_digit() || "+-".contains(c))
    }

    /// Text of the cell for a CSV file.
    pub(super) fn csv(&self) -> String {
        match &self.data {
            Value::Null => String::new(),
            Value::String(text) => printable(text),
            Value::Number(number) => match number.as_f64().filter(|_| number.is_f64()) {
                Some(value) => shortest(value),
                None => number.to_string(),
            },
            other => other.to_string(),
        }
    }
}

impl From<f64> for Cell {
    fn from(value: f64) -> Self {
        Cell::shown(value, brief(value))
    }
}

impl From<bool> for Cell {
    fn from(value: bool) -> Self {
        Cell {
            shown: if value { "yes" } else { "no" }.to_owned(),
            data: value.into(),
        }
    }
}

impl From<String> for Cell {
    fn from(text: String) -> Self {
        Cell {
            data: if text.is_empty() {
                Value::Null
            } else {
                Value::from(text.as_str())
            },
            shown: text,
        }
    }
}

impl From<&str> for Cell {
    fn from(text: &str) -> Self {
        text.to_owned().into()
    }
}

macro_rules! whole_numbers {
    ($($kind:ty),*) => {$(
        impl From<$kind> for Cell {
            fn from(value: $kind) -> Self {
                Cell { shown: value.to_string(), data: value.into() }
            }
        }
    )*};
}
whole_numbers!(u32, u64, usize);

impl<T: Into<Cell>> From<Option<T>> for Cell {
    fn from(value: Option<T>) -> Self {
        value.map_or_else(|| Cell::from(""), Into::into)
    }
}
