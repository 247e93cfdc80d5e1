//! Reads YAML as a map, the input of `map`. It uses the events of the parser.
//!
//! It reads all of YAML 1.2 except aliases. An alias could expand to gigabytes, so it is refused with its line number. A plain
//! scalar that matches the core schema's decimal forms is a number. The importer skips null, true, false and empty scalars. Every
//! other scalar is text, also a quoted number. If a file has several documents, all are read.

use super::map::Node;
use saphyr_parser::{Event, Parser, ScalarStyle};
use std::path::Path;

/// Largest depth of nested lists and tables. Files of points need less than a tenth of this depth.
const DEEPEST: usize = 100;

/// True if the file name has the extension of a YAML file.
pub(super) fn is_named(path: &Path) -> bool {
    let extension = path.extension().and_then(|extension| extension.to_str());
    extension.is_some_and(|extension| {
        extension.eq_ignore_ascii_case("yaml") || extension.eq_ignore_ascii_case("yml")
    })
}

/// An incomplete list or table.
enum Open {
    List(Vec<Node>),
    /// A table with its entries so far, and the key whose value comes next.
    Table(Vec<(String, Node)>, Option<String>),
}

/// Reads a text. Returns its document, or a list of its documents if there are several.
pub(super) fn read(text: &str) -> Result<Node, String> {
    let mut documents = Vec::new();
    let mut open: Vec<Open> = Vec::new();
    for event in Parser::new_from_str(text) {
        let (event, span) = event.map_err(|error| {
            let (line, column) = (error.marker().line(), error.marker().col() + 1);
            format!("not YAML: line {line}, column {column}: {}", error.info())
        })?;
        let line = span.start.line();
        let complete = match event {
            Event::Scalar(text, style, ..) => scalar(&text, style),
            Event::SequenceStart(..) => {
                open.push(Open::List(Vec::new()));
                continue;
            }
            Event::MappingStart(..) => {
                open.push(Open::Table(Vec::new(), None));
                continue;
            }
            Event::SequenceEnd | Event::MappingEnd => match open.pop() {
                Some(Open::List(nodes)) => Node::List(nodes),
                Some(Open::Table(entries, _)) => Node::Table(entries),
                None => return Err(format!("not YAML: line {line}: an end without a start")),
            },
            Event::Alias(_) => {
                return Err(format!(
                    "line {line}: YAML alias *name is not supported; write the value"
                ));
            }
            Event::Nothing
            | Event::StreamStart
            | Event::StreamEnd
            | Event::DocumentStart(_)
            | Event::DocumentEnd => continue,
        };
        if open.len() > DEEPEST {
            return Err(format!("line {line}: nested deeper than {DEEPEST} levels"));
        }
        match open.last_mut() {
            None => documents.push(complete),
            Some(Open::List(nodes)) => nodes.push(complete),
            Some(Open::Table(entries, key)) => match key.take() {
                Some(key) => entries.push((key, complete)),
                None => *key = Some(key_of(complete, line)?),
            },
        }
    }
    Ok(match documents.len() {
        1 => documents.remove(0),
        _ => Node::List(documents),
    })
}

/// Text of a key. A numeric key keeps its digits as text.
fn key_of(node: Node, line: usize) -> Result<String, String> {
    match node {
        Node::Text(text) => Ok(text),
        Node::Number(number) => Ok(number.to_string()),
        Node::Truth(_) | Node::Other => Ok(String::new()),
        Node::List(_) | Node::Table(_) => Err(format!(
            "line {line}: a list or a map cannot be a key; expected the name of a point"
        )),
    }
}

fn scalar(text: &str, style: ScalarStyle) -> Node {
    if style != ScalarStyle::Plain {
        return Node::Text(text.to_owned());
    }
    // The standard library also parses `inf` and `nan`, but in these files they are words.
    let is_decimal = text.starts_with(|c: char| c.is_ascii_digit() || "+-.".contains(c))
        && text.ends_with(|c: char| c.is_ascii_digit() || c == '.');
    match text.parse::<f64>() {
        Ok(number) if is_decimal && number.is_finite() => Node::Number(number),
        _ if matches!(text, "" | "~" | "null" | "true" | "false") => Node::Other,
        _ => Node::Text(text.to_owned()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::exchange::map::of_json;

    #[test]
    fn a_map_is_the_same_in_yaml_and_in_json() {
        let block = "\
# a comment
units: millimeters
lower arm:
  front: {x: 1, y: 2.5, z: -3e1}
  rear: [1., +2, .5]
list:
  - name: 'a'
    at: [0, 1, 2]
  - \"1.5\"
nothing: ~
true: yes
";
        let json = r#"{"units": "millimeters",
            "lower arm": {"front": {"x": 1, "y": 2.5, "z": -30}, "rear": [1, 2, 0.5]},
            "list": [{"name": "a", "at": [0, 1, 2]}, "1.5"], "nothing": null, "": "yes"}"#;
        assert_eq!(read(block).unwrap(), of_json(json).unwrap());
        // JSON is valid YAML.
        assert_eq!(read(json).unwrap(), of_json(json).unwrap());
    }

    #[test]
    fn what_is_no_map_of_points_is_refused_with_its_line() {
        for (text, reason) in [
            ("a: &p [1, 2, 3]\nb: *p\n", "line 2: YAML alias"),
            ("a: [1, 2\nb: 3", "not YAML: line 2"),
            ("? [1, 2]\n: 3\n", "line 1: a list or a map cannot be a key"),
        ] {
            let message = read(text).unwrap_err();
            assert!(message.contains(reason), "{text:?}: {message}");
        }
        let deep = "[".repeat(100_000) + &"]".repeat(100_000);
        assert!(read(&deep).is_err());
        for word in [".inf", "nan", "1e999", "0x10", "1_000", "infinity"] {
            assert_eq!(read(word).unwrap(), Node::Text(word.to_owned()));
        }
    }
}
