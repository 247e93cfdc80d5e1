//! Points in JSON or YAML: a map from names to coordinates with any nesting.
//!
//! The following three texts give the same point: `{"LCA front": [1, 2, 3]}`, `{"lower arm": {"front": {"x": 1, "y": 2, "z": 3}}}`
//! and `[{"name": "LCA front", "x": 1, "y": 2, "z": 3}]`. The name of a point consists of the keys that lead to three numbers. A
//! key that is a wheel or an axle (`left`, `FL`, `front_axle`) applies to all points below it. In a table with x, y and z, the
//! entries `side`, `corner` and `axle` give the wheel and the axle. The entry `unit` gives the unit of lengths. The importer skips
//! keys with unknown words, such as a car's name, lists of other lengths, texts and truth values. A single number is a value with
//! a name. [`chrono`] reads suspensions of Project Chrono.

use super::angle_unit::AngleUnit;
use super::axes::Declared;
use super::figure_names::figure;
use super::names::{KNOWN_MARKS, Words, cut, marks_of, marks_of_entry, marks_of_title, side_of};
use super::roles::{self, Letters};
use super::table::{Figure, Marks, NamedPoint, PointTable, StatedMarks};
use super::unit::{FileUnit, KNOWN_UNITS};
use super::{chrono, hub_face};
use crate::model::Topology;
use serde::de::{Deserialize, Deserializer, MapAccess, SeqAccess, Visitor};
use std::fmt;

/// Largest number of points in a file.
const MOST_POINTS: usize = 50_000;

/// A value with its keys as written, including repeated keys.
#[derive(Debug, PartialEq)]
pub(super) enum Node {
    Number(f64),
    Text(String),
    Truth(bool),
    List(Vec<Node>),
    Table(Vec<(String, Node)>),
    Other,
}

impl<'de> Deserialize<'de> for Node {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Any;
        impl<'de> Visitor<'de> for Any {
            type Value = Node;

            fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
                f.write_str("a value")
            }

            fn visit_bool<E>(self, truth: bool) -> Result<Node, E> {
                Ok(Node::Truth(truth))
            }

            fn visit_unit<E>(self) -> Result<Node, E> {
                Ok(Node::Other)
            }

            fn visit_i64<E>(self, number: i64) -> Result<Node, E> {
                Ok(Node::Number(number as f64))
            }

            fn visit_u64<E>(self, number: u64) -> Result<Node, E> {
                Ok(Node::Number(number as f64))
            }

            fn visit_f64<E>(self, number: f64) -> Result<Node, E> {
                Ok(Node::Number(number))
            }

            fn visit_str<E>(self, text: &str) -> Result<Node, E> {
                Ok(Node::Text(text.to_owned()))
            }

            fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<Node, A::Error> {
                let mut nodes = Vec::new();
                while let Some(node) = list.next_element()? {
                    nodes.push(node);
                }
                Ok(Node::List(nodes))
            }

            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Node, A::Error> {
                let mut entries = Vec::new();
                while let Some(entry) = map.next_entry()? {
                    entries.push(entry);
                }
                Ok(Node::Table(entries))
            }
        }
        deserializer.deserialize_any(Any)
    }
}

/// True if a text begins like JSON. It may have comments before the first bracket.
pub(super) fn is_json(text: &str) -> bool {
    let text = text.trim_start_matches('\u{feff}').trim_start();
    let begins = |text: &str| text.trim_start().starts_with(['{', '[']);
    begins(text) || (text.starts_with('/') && begins(&without_comments(text)))
}

/// Parses a JSON text. It treats comments as blanks, because Project Chrono writes comments.
pub(super) fn of_json(text: &str) -> Result<Node, String> {
    let text = without_comments(text.trim_start_matches('\u{feff}'));
    serde_json::from_str(&text).map_err(|error| format!("not JSON: {error}"))
}

/// Replaces `// ...` and `/* ... */` outside of strings by blanks. The line numbers do not change.
fn without_comments(text: &str) -> String {
    let mut plain = String::with_capacity(text.len());
    let mut chars = text.chars().peekable();
    let mut in_string = false;
    while let Some(c) = chars.next() {
        if in_string {
            plain.push(c);
            if c == '\\' {
                plain.extend(chars.next());
            }
            in_string = c != '"';
            continue;
        }
        match (c, chars.peek()) {
            ('/', Some('/')) => while chars.next_if(|c| *c != '\n').is_some() {},
            ('/', Some('*')) => {
                chars.next();
                let mut before = ' ';
                for c in chars.by_ref() {
                    if c == '\n' {
                        plain.push('\n');
                    }
                    if before == '*' && c == '/' {
                        break;
                    }
                    before = c;
                }
                plain.push(' ');
            }
            _ => {
                in_string = c == '"';
                plain.push(c);
            }
        }
    }
    plain
}

/// Points of a map. `None` if it has no points. Refuses unknown units and contradictions.
pub(super) fn points_of(root: &Node) -> Result<Option<PointTable>, String> {
    if let Some(table) = chrono::points_of(root)? {
        return Ok(Some(table));
    }
    let mut reader = Reader::default();
    reader.visit(root, &mut Vec::new())?;
    let mut table = reader.table;
    hub_face::to_wheel_centres(&mut table)?;
    Ok((!table.points.is_empty()).then_some(table))
}

/// Splits the keys that lead to a value into two results: the name of the value, and the wheel and axle that the keys state.
///
/// A key that only names a wheel or an axle applies to everything below it. The key "front" also does, if it comes before all
/// keys that name a hardpoint. Keys with unknown words ("MyCar", "baja_2021") describe the surroundings and are skipped, except
/// for the last key.
fn meaning(keys: &[&str]) -> (String, Marks) {
    let mut marks = Marks::default();
    let mut parts: Vec<&str> = Vec::new();
    for (place, key) in keys.iter().enumerate() {
        let is_last = place + 1 == keys.len();
        let only_side = match cut(key).as_slice() {
            [word] => marks_of(word),
            _ => Marks::default(),
        };
        if !only_side.is_empty() && (!is_last || !parts.is_empty()) {
            // In `{"LCA": {"R": ...}}`, the words around "R" decide what "R" means.
            if key.len() > 1 || !is_last {
                marks = only_side.or(marks);
                continue;
            }
        }
        if !is_last {
            let title = marks_of_title(key).filter(|_| parts.is_empty());
            if let Some(title) = title {
                marks = title.or(marks);
                continue;
            }
            let words = Words::spelt(&cut(key));
            if words.unknown > 0 || words.is_empty() {
                continue;
            }
        }
        parts.push(key);
    }
    (parts.join(" "), marks)
}

#[derive(Default)]
struct Reader {
    table: PointTable,
}

impl Reader {
    fn visit<'n>(&mut self, node: &'n Node, keys: &mut Vec<&'n str>) -> Result<(), String> {
        if let Some(position) = position(node) {
            return self.point(Ok(position), keys, StatedMarks::default());
        }
        match node {
            Node::Number(number) => {
                let (read_as, marks) = meaning(keys);
                self.table.figures.push(Figure {
                    name: keys.join(" "),
                    read_as,
                    value: *number,
                    marks,
                    remark: String::new(),
                    place: place(keys),
                });
            }
            Node::Text(text) => self.word(text, keys)?,
            Node::List(nodes) => {
                if let Some(reason) = fault(nodes).filter(|_| names_hardpoint(keys)) {
                    return self.point(Err(reason), keys, StatedMarks::default());
                }
                if nodes.iter().any(|node| matches!(node, Node::Number(_))) {
                    self.value_missing(keys, "a list");
                }
                for node in nodes {
                    // A number in a list that is not a point has no name, so it is skipped.
                    if !matches!(node, Node::Number(_)) {
                        self.visit(node, keys)?;
                    }
                }
            }
            Node::Table(entries) => {
                let name = entries.iter().find_map(|(key, node)| match node {
                    Node::Text(name) if key.eq_ignore_ascii_case("name") => Some(name.as_str()),
                    _ => None,
                });
                let above = keys.len();
                keys.extend(name);
                let position = Self::coordinates(entries, name.is_some(), keys);
                if let Some(position) = position {
                    let marks = self.remarks(entries, keys)?;
                    self.point(position, keys, marks)?;
                    keys.truncate(above);
                    return Ok(());
                }
                keys.truncate(above);
                for (key, node) in entries {
                    keys.push(key);
                    self.visit(node, keys)?;
                    keys.pop();
                }
            }
            Node::Truth(_) | Node::Other => (),
        }
        Ok(())
    }

    /// Coordinates of a table with entries x, y and z, or the reason why they cannot be read. `None` if the table is not a
    /// point: it must have a name, or no numbers, lists and tables besides x, y and z.
    fn coordinates(
        entries: &[(String, Node)],
        is_named: bool,
        keys: &[&str],
    ) -> Option<Result<[f64; 3], String>> {
        let is_remark = |(key, node): &(String, Node)| {
            is_any(key, &["x", "y", "z"])
                || matches!(node, Node::Text(_) | Node::Truth(_) | Node::Other)
        };
        let three = three(entries).filter(|_| is_named || entries.iter().all(is_remark))?;
        if let Some(position) = numbers(three) {
            return Some(Ok(position));
        }
        let reason = fault(three)?;
        names_hardpoint(keys).then_some(Err(reason))
    }

    /// Wheel and axle in the entries of a point. Also reads the unit of lengths.
    fn remarks<'n>(
        &mut self,
        entries: &'n [(String, Node)],
        keys: &mut Vec<&'n str>,
    ) -> Result<StatedMarks, String> {
        let mut stated = StatedMarks::default();
        for (key, node) in entries {
            let Node::Text(text) = node else {
                continue;
            };
            keys.push(key);
            if is_any(key, &["side", "corner", "axle"]) {
                let found = marks_of_entry(text).ok_or_else(|| {
                    format!("{}: expected {KNOWN_MARKS}, found {text:?}", place(keys))
                })?;
                stated.add(found);
            } else if names_unit(keys) {
                self.word(text, keys)?;
            }
            keys.pop();
        }
        Ok(stated)
    }

    /// Adds a point. `keys` lead to the point in the file. `stated` has the wheel and the axle from the entries of the point.
    fn point(
        &mut self,
        position: Result<[f64; 3], String>,
        keys: &[&str],
        stated: StatedMarks,
    ) -> Result<(), String> {
        let points = &mut self.table.points;
        if points.len() == MOST_POINTS {
            return Err(format!("it has more than {MOST_POINTS} points"));
        }
        let is_side = |key: &&&str| side_of(key).is_some();
        let words: Vec<&str> = keys.iter().filter(|key| !is_side(key)).copied().collect();
        let (read_as, of_keys) = meaning(keys);
        let mut marks = stated.marks.or(of_keys);
        if stated.mirrored {
            marks.side = None;
        }
        points.push(NamedPoint {
            name: words.join(" "),
            read_as,
            marks,
            mirrored: stated.mirrored,
            position: position.map_err(|reason| format!("{}: {reason}", place(keys))),
            has_number: true,
            body: None,
            place: place(keys),
        });
        Ok(())
    }

    /// Reads a unit of lengths, a unit of angles, or the axes from a text. The `keys` of the text show which of them it states.
    fn word(&mut self, text: &str, keys: &[&str]) -> Result<(), String> {
        match keys.last().map(|key| key.to_ascii_lowercase()).as_deref() {
            _ if names_unit(keys) => {
                let unit = FileUnit::named(text.trim()).ok_or_else(|| {
                    format!("{}: expected {KNOWN_UNITS}, found {text:?}", place(keys))
                })?;
                self.table.state_unit(unit, &place(keys))?;
            }
            _ if names_angle_unit(keys) => {
                let unit = AngleUnit::named(text.trim()).ok_or_else(|| {
                    format!("{}: expected deg or rad, found {text:?}", place(keys))
                })?;
                self.table.angle_unit = Some(unit);
            }
            Some("frame") => {
                let declared = Declared::named(text).unwrap_or_else(|| in_words(text));
                if declared.is_empty() {
                    return Err(format!(
                        "{}: the frame is {text:?}; expected iso8855, sae_j670, x_rear or the \
                         directions of x, y and z",
                        place(keys)
                    ));
                }
                self.table.declare(declared, &place(keys))?;
            }
            Some("axes" | "coordinates" | "coordinate_system" | "convention") => {
                self.table.declare(in_words(text), &place(keys))?;
            }
            _ => self.value_missing(keys, &format!("{text:?}")),
        }
        Ok(())
    }

    /// Lists a value of the wheel that is not a number, and does nothing for other names.
    fn value_missing(&mut self, keys: &[&str], found: &str) {
        let (read_as, _) = meaning(keys);
        if figure(&read_as).is_some() {
            self.table.left_out.push(format!(
                "{}: expected one number, found {found}",
                place(keys)
            ));
        }
    }
}

/// True if keys name a hardpoint of any topology.
fn names_hardpoint(keys: &[&str]) -> bool {
    let (name, _) = meaning(keys);
    let mut topologies = Topology::ALL.iter();
    topologies.any(|topology| roles::read(&name, topology, Letters::default()).is_some())
}

/// Returns the reason why three values are not coordinates. `None` if all are numbers, or if they are not three single values.
fn fault<'n>(values: impl IntoIterator<Item = &'n Node>) -> Option<String> {
    let values: Vec<&Node> = values.into_iter().collect();
    let is_single = |node: &&Node| !matches!(node, Node::List(_) | Node::Table(_));
    if values.len() != 3 || !values.iter().all(is_single) {
        return None;
    }
    let wrong = values
        .into_iter()
        .find(|node| !matches!(node, Node::Number(_)))?;
    Some(match wrong {
        Node::Text(text) => format!("expected three numbers, found {text:?}"),
        _ => "expected three numbers, found a value that is not a number".to_owned(),
    })
}

/// True if keys name the unit of angles: "angle_unit", "units.angle", "angles".
fn names_angle_unit(keys: &[&str]) -> bool {
    let own = keys.last().map(|key| cut(key)).unwrap_or_default();
    own.iter()
        .all(|word| ["unit", "units", "angle", "angles", "angular"].contains(&word.as_str()))
        && own.iter().any(|word| word.starts_with("ang"))
}

/// True if keys name the unit of lengths: "unit", "length_unit", "units.length".
fn names_unit(keys: &[&str]) -> bool {
    const LENGTH: &str =
        "unit units length lengths coordinate coordinates distance dimensions position";
    let words: Vec<String> = keys.last().map(|key| cut(key)).unwrap_or_default();
    let above = keys.iter().rev().nth(1).map(|key| cut(key));
    let is_unit = |words: &[String]| words.iter().any(|word| word == "unit" || word == "units");
    (is_unit(&words) || above.is_some_and(|words| is_unit(&words)))
        && words
            .iter()
            .all(|word| LENGTH.split(' ').any(|known| known == word))
}

/// Directions of the axes in a text whose key is about axes.
fn in_words(text: &str) -> Declared {
    Declared::in_text(&format!("axes: {text}"))
}

/// Location of an entry in the file, for messages: the keys that lead to the entry.
pub(super) fn place(keys: &[&str]) -> String {
    match keys {
        [] => "the outermost list".to_owned(),
        keys => format!("key {:?}", keys.join(".")),
    }
}

/// Three numbers, from a list of three or from exactly x, y and z.
pub(super) fn position(node: &Node) -> Option<[f64; 3]> {
    match node {
        Node::List(nodes) => match nodes[..] {
            [Node::Number(x), Node::Number(y), Node::Number(z)] => Some([x, y, z]),
            _ => None,
        },
        Node::Table(entries) if entries.len() == 3 => three(entries).and_then(numbers),
        _ => None,
    }
}

/// Values of x, y and z. `None` if one of these keys is missing or repeated.
fn three(entries: &[(String, Node)]) -> Option<[&Node; 3]> {
    let value = |axis: &str| {
        let mut found = entries.iter().filter(|(key, _)| is_any(key, &[axis]));
        match (found.next(), found.next()) {
            (Some((_, node)), None) => Some(node),
            _ => None,
        }
    };
    Some([value("x")?, value("y")?, value("z")?])
}

/// Three values as numbers. `None` if one is not a number.
fn numbers(three: [&Node; 3]) -> Option<[f64; 3]> {
    match three {
        [Node::Number(x), Node::Number(y), Node::Number(z)] => Some([*x, *y, *z]),
        _ => None,
    }
}

/// True if a key is one of these words, in any case.
fn is_any(key: &str, words: &[&str]) -> bool {
    words.iter().any(|word| key.eq_ignore_ascii_case(word))
}

#[cfg(test)]
mod tests;
