//! Cells of a line of CSV.

use std::borrow::Cow;
use std::io::Write;

/// Appends a number to a line. Appends nothing for NaN, which marks a missing value.
pub fn append_number(value: f64, to: &mut Vec<u8>) {
    if !value.is_nan() {
        to.extend_from_slice(zmij::Buffer::new().format(value).as_bytes());
    }
}

/// Appends a whole number to a line.
pub fn append_whole(value: u64, to: &mut Vec<u8>) {
    write!(to, "{value}").expect("writing to memory does not fail");
}

/// Appends a text to a line, in quotes if necessary.
pub fn append_text(text: &str, to: &mut Vec<u8>) {
    if text.contains([',', '"', '\n']) {
        to.push(b'"');
        to.extend_from_slice(text.replace('"', "\"\"").as_bytes());
        to.push(b'"');
    } else {
        to.extend_from_slice(text.as_bytes());
    }
}

/// Removes the first cell of a line and the comma after it. Returns the cell.
pub(super) fn next_cell<'l>(rest: &mut &'l str) -> Option<Cow<'l, str>> {
    let Some(mut inside) = rest.strip_prefix('"') else {
        let (cell, after) = rest.split_once(',').unwrap_or((rest, ""));
        *rest = after;
        return Some(Cow::Borrowed(cell));
    };
    let mut cell = String::new();
    loop {
        let (part, after) = inside.split_once('"')?;
        cell += part;
        match after.strip_prefix('"') {
            Some(more) => {
                cell.push('"');
                inside = more;
            }
            None => {
                *rest = after.strip_prefix(',').unwrap_or(after);
                return Some(Cow::Owned(cell));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_come_back_as_they_were_written() {
        let texts = ["plain", "a, b", "\"quoted\"", "", "say \"no, no\"", "end"];
        let mut line = Vec::new();
        for (k, text) in texts.iter().enumerate() {
            if k > 0 {
                line.push(b',');
            }
            append_text(text, &mut line);
        }
        let line = String::from_utf8(line).unwrap();
        let mut rest = line.as_str();
        for text in texts {
            assert_eq!(next_cell(&mut rest).unwrap(), text);
        }
        assert_eq!(rest, "");
    }

    #[test]
    fn numbers_read_back_to_the_same_bits() {
        for value in [
            0.1 + 0.2,
            1e-7,
            5e-324,
            1.7976931348623157e308,
            -12345678.9,
            0.0,
            1e16,
        ] {
            let mut text = Vec::new();
            append_number(value, &mut text);
            let read: f64 = String::from_utf8(text).unwrap().parse().unwrap();
            assert_eq!(read.to_bits(), value.to_bits());
        }
        let mut none = Vec::new();
        append_number(f64::NAN, &mut none);
        assert!(none.is_empty());
    }
}
