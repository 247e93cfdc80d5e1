//! Parses a text into the file as written. Rewrites the parser's messages in plain words.

use crate::car_file::CarFile;
use crate::error::{Source, StudyError, StudyErrors};
use crate::file::File;
use crate::names::nearest;
use crate::schema::{self, Root};
use crate::source::advice;
use crate::syntax;
use crate::value::Number;
use serde::de::DeserializeOwned;
use serde::de::value::MapDeserializer;
use std::cmp::Reverse;
use std::ops::Range;
use std::sync::Arc;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// Reads the text of a study.
pub fn parse(source: &Arc<Source>) -> Result<File, StudyErrors> {
    parse_as(source)
}

/// Reads the text of a car's study. This function is in this crate, because this crate is compiled without optimisation. The
/// many small functions that it uses then compile fast.
pub fn parse_car(source: &Arc<Source>) -> Result<CarFile, StudyErrors> {
    parse_as(source)
}

/// Position of `[car]` in a text, if the text is the study of a car.
pub fn car_section(text: &str) -> Option<Range<usize>> {
    let root = DeTable::parse(text).ok()?;
    let (key, _) = root.get_ref().get_key_value("car")?;
    Some(key.span())
}

/// Reads the text of a study with this root type.
fn parse_as<T: DeserializeOwned>(source: &Arc<Source>) -> Result<T, StudyErrors> {
    let text = &source.text;
    if text.trim_start_matches('\u{feff}').trim().is_empty() {
        return Err(StudyError::of_file(&source.name, "the file is empty").into());
    }
    let root = DeTable::parse(text).map_err(|error| {
        let message = format!("not valid TOML: {}", error.message().replace('\n', "; "));
        let place = error.span();
        let mut parsed = StudyError::new(source.clone(), place.clone(), message);
        let cause = || syntax::cause(text, error.message(), place?);
        if let Some(help) = advice(&source.name).map(str::to_owned).or_else(cause) {
            parsed.help(help);
        }
        parsed
    })?;
    let file = toml::from_str(text).map_err(|error| {
        if let Some(unknown) = unknown_section::<T>(source, root.get_ref()) {
            return unknown;
        }
        // A section that is completely missing has no position.
        let span = error.span().filter(|span| *span != root.span());
        let place = span.clone().and_then(|span| text.get(span)).unwrap_or("");
        let key = span
            .as_ref()
            .and_then(|span| KeyPlaces::of(text).key_at(span.start));
        let replaced = replaced_key(root.get_ref(), text, key.as_deref(), error.message());
        let (message, help) = match replaced {
            Some(message) => (message, None),
            None => in_plain_words(error.message(), place, kind_of(root.get_ref())),
        };
        let mut error = StudyError::new(source.clone(), span, message);
        error.key_named(key);
        if let Some(help) = help {
            error.help(help);
        }
        error
    })?;
    Ok(file)
}

/// Kind of study with these sections.
fn kind_of(root: &DeTable) -> Root {
    if root.get("car").is_some() {
        Root::Car
    } else {
        Root::Suspension
    }
}

/// Error about the first section or key at the top of the file that is unknown. A misspelt section often causes another error, such
/// as a missing section, so this error has priority. `None` if all sections are known.
fn unknown_section<T: DeserializeOwned>(
    source: &Arc<Source>,
    root: &DeTable,
) -> Option<StudyError> {
    // A table with this key alone: the type refuses the key if it is unknown, and otherwise the number.
    let refused = |name: &str| {
        let alone = MapDeserializer::<_, serde::de::value::Error>::new(std::iter::once((name, 0)));
        let message = T::deserialize(alone).err()?.to_string();
        message
            .starts_with(&format!("unknown field `{name}`"))
            .then_some(message)
    };
    let unknown = root.iter().filter_map(|(key, value)| {
        let message = refused(key.get_ref())?;
        Some((key, value, message))
    });
    let (key, value, message) = unknown.min_by_key(|(key, ..)| key.span().start)?;
    let (name, known) = unknown_and_known(&message)?;
    let is_section = matches!(value.get_ref(), DeValue::Table(_) | DeValue::Array(_));
    let what = if is_section {
        format!("section [{name}]")
    } else {
        format!("key \"{name}\"")
    };
    let message = format!("unknown {what}; known here: {}", known.join(", "));
    let mut error = StudyError::new(source.clone(), Some(key.span()), message);
    error.key_named(Some(name.to_owned()));
    if let Some(help) = section_meant(name, &known, kind_of(root)) {
        error.help(help);
    }
    Some(error)
}

/// Help for an unknown section: the section or the key that the user probably meant.
fn section_meant(name: &str, known: &[&str], kind: Root) -> Option<String> {
    let is_known = |section: &&str| known.contains(&section.split('.').next().unwrap_or(""));
    if CAR_SECTIONS.contains(&name) && kind == Root::Suspension {
        return Some(format!(
            "[{name}] is a section of the study of a car, which also has a section [car]: `hardpoint new car` prints such a study"
        ));
    }
    let plain = name.to_lowercase().replace('-', "_");
    let usual = SECTIONS.iter().find(|(usual, _)| *usual == plain);
    let usual = usual.map(|(_, own)| *own).filter(is_known);
    let near = usual.or_else(|| nearest(name, known.iter().copied()));
    near.map(|near| format!("did you mean [{near}]?"))
        .or_else(|| section_of_key(&plain, kind))
}

/// Help for an unknown key that other sections of the study have.
fn section_of_key(name: &str, kind: Root) -> Option<String> {
    let keys = schema::keys(kind);
    let own = keys
        .iter()
        .filter(|(section, key)| key == name && !section.contains('.'));
    let sections: Vec<String> = own.map(|(section, _)| format!("[{section}]")).collect();
    (!sections.is_empty()).then(|| format!("\"{name}\" is a key of {}", sections.join(" and ")))
}

/// Explains a key that this version or this kind of study replaces by another key. `None` for other messages.
fn replaced_key(root: &DeTable, text: &str, key: Option<&str>, message: &str) -> Option<String> {
    if root.get("car").is_some() && message.starts_with("unknown field `relative`") {
        return Some(
            "the study of a car has the key \"percent\" instead of \"relative\": write percent = 30.0 instead of \
             relative = 0.3"
                .to_owned(),
        );
    }
    if key != Some("setup.ride_height") || !message.starts_with("unknown field `ride_height`") {
        return None;
    }
    let DeValue::Table(section) = root.get("setup")?.get_ref() else {
        return None;
    };
    let written = text.get(section.get("ride_height")?.span())?;
    // Underscores in numbers, as in 1_000.0, are valid in TOML only.
    let number = Number::parsed(&written.replace('_', "")).ok();
    Some(match number {
        Some(travel) => format!(
            "until version 0.1, ride_height was the wheel travel: write travel = {:?} or ride_height_change = {:?}",
            travel,
            0.0 - travel
        ),
        None => "until version 0.1, ride_height was the wheel travel: write travel or ride_height_change, which has the \
                 opposite sign"
            .to_owned(),
    })
}

/// Keys and values of a text: the byte range of each, and the path of its key.
///
/// They are in the order of their beginnings. A key or value comes after the value that contains it. So the last range with a
/// byte is the smallest one.
#[derive(Default)]
pub(crate) struct KeyPlaces(Vec<(Range<usize>, String)>);

impl KeyPlaces {
    /// Reads a text. The list is empty if the text is not valid TOML.
    pub(crate) fn of(text: &str) -> Self {
        let mut places = KeyPlaces::default();
        if let Ok(root) = DeTable::parse(text) {
            places.add_table(root.get_ref(), "");
        }
        // Contained ranges were added first.
        places.0.reverse();
        places
            .0
            .sort_by_key(|(place, _)| (place.start, Reverse(place.end)));
        places
    }

    /// Path of the key whose name or value is at this byte, such as `optimise.variables[0].range`. `None` if there is no key.
    pub(crate) fn key_at(&self, at: usize) -> Option<String> {
        let begun = self.0.partition_point(|(place, _)| place.start <= at);
        let mut begun = self.0[..begun].iter().rev();
        let found = begun.find(|(place, _)| place.contains(&at));
        found.map(|(_, path)| path.clone())
    }

    fn add_table(&mut self, table: &DeTable, path: &str) {
        for (key, value) in table {
            let dot = if path.is_empty() { "" } else { "." };
            let path = format!("{path}{dot}{}", key.get_ref());
            self.add_value(value, &path);
            self.0.push((key.span(), path));
        }
    }

    fn add_value(&mut self, value: &Spanned<DeValue>, path: &str) {
        match value.get_ref() {
            DeValue::Table(table) => self.add_table(table, path),
            // The excerpt shows the faulty number of a list, so a list of numbers needs no index. Tables in a list need
            // their index.
            DeValue::Array(array) => {
                for (i, element) in array.iter().enumerate() {
                    match element.get_ref() {
                        DeValue::Table(_) => self.add_value(element, &format!("{path}[{i}]")),
                        DeValue::Array(_) => self.add_value(element, path),
                        _ => {}
                    }
                }
            }
            _ => {}
        }
        self.0.push((value.span(), path.to_owned()));
    }
}

/// Sections that only the study of a car has.
const CAR_SECTIONS: [&str; 2] = ["cases", "gg_map"];

/// Usual names of sections that do not resemble the names in this program, each with the corresponding section of this program.
const SECTIONS: [(&str, &str); 17] = [
    ("hardpoint", "suspension.hardpoints"),
    ("hardpoints", "suspension.hardpoints"),
    ("points", "suspension.hardpoints"),
    ("coordinates", "suspension.hardpoints"),
    ("geometry", "suspension.hardpoints"),
    ("optimisation", "optimise"),
    ("optimization", "optimise"),
    ("optimizer", "optimise"),
    ("tuning", "optimise"),
    ("objectives", "optimise"),
    ("scatter", "tolerance"),
    ("tires", "tyre"),
    ("stabilizer", "anti_roll_bar"),
    ("stabiliser", "anti_roll_bar"),
    ("sway_bar", "anti_roll_bar"),
    ("travel", "motion"),
    ("bushes", "bushings"),
];

/// Name of the unknown key in a message of serde, and the known keys.
fn unknown_and_known(message: &str) -> Option<(&str, Vec<&str>)> {
    let rest = message.strip_prefix("unknown field `")?;
    let (name, candidates) = rest.split_once("`, ").unwrap_or((rest, ""));
    Some((name, candidates.split('`').skip(1).step_by(2).collect()))
}

/// Rewrites a serde message in plain words, and adds help if possible. `place` is the text to which the message
/// refers, `kind` the kind of the study.
fn in_plain_words(message: &str, place: &str, kind: Root) -> (String, Option<String>) {
    // The parser presents dates as tables with a key of this kind.
    if message.contains("$__toml_private") {
        return ("a date is not expected here".to_owned(), None);
    }
    if let Some((name, known)) = unknown_and_known(message) {
        let message = format!("unknown key \"{name}\"; known here: {}", known.join(", "));
        let near = nearest(name, known).map(|near| format!("did you mean \"{near}\"?"));
        return (message, near.or_else(|| section_of_key(name, kind)));
    }
    if let Some(rest) = message.strip_prefix("missing field `") {
        let name = rest.trim_end_matches('`');
        let what = match name {
            "suspension" | "motion" => format!("the section [{name}] is missing"),
            "hardpoints" => "the section [suspension.hardpoints] is missing".to_owned(),
            _ => format!("the key \"{name}\" is missing"),
        };
        return (what, None);
    }
    let mismatch = ["invalid type: ", "invalid value: "]
        .iter()
        .find_map(|prefix| message.strip_prefix(prefix))
        .and_then(|rest| rest.rsplit_once(", expected "));
    if let Some((found, expected)) = mismatch {
        let message = format!(
            "expected {}, found {}",
            expected_kind(expected),
            value(found, place)
        );
        return (message, None);
    }
    (message.trim().replace('\n', "; "), None)
}

/// Describes in words the kind of value that serde expected.
fn expected_kind(expected: &str) -> &str {
    match expected {
        "i64" => "a whole number",
        "a string" => "a text in quotes",
        "a boolean" => "true or false",
        "a sequence" => "a list",
        "a map" => "a table",
        _ if expected.starts_with("struct ") => "a table",
        other => other,
    }
}

fn is_number(text: &str) -> bool {
    let word = text.trim_start_matches(['+', '-']);
    let starts = word.starts_with(|c: char| c.is_ascii_digit()) || ["nan", "inf"].contains(&word);
    starts
        && word
            .chars()
            .all(|c| c.is_ascii_alphanumeric() || "._+-".contains(c))
}

/// Describes in words the value that serde found. `place` is the text of the value in the file.
fn value(found: &str, place: &str) -> String {
    let quoted = |prefix: &str| Some(found.strip_prefix(prefix)?.trim_matches('`'));
    match found {
        "sequence" => "a list".to_owned(),
        "map" if place.starts_with(|c: char| c.is_ascii_digit()) => format!("the date {place}"),
        "map" => "a table".to_owned(),
        // The value is shown as written.
        _ if quoted("integer ").or(quoted("floating point ")).is_some() && is_number(place) => {
            place.to_owned()
        }
        _ => quoted("integer ")
            .or(quoted("floating point "))
            .or(quoted("boolean "))
            .map(str::to_owned)
            .or(found
                .strip_prefix("string ")
                .map(|text| format!("the text {text}")))
            .unwrap_or_else(|| found.to_owned()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_byte_has_the_path_of_its_innermost_key() {
        let text = "[motion]\nrack = [1.0, 2.0]\n[[optimise.targets]]\npoints = [[0.0, 1.0]]\n\
                    [sweep]\nvariables = [{ axis = \"x\" }, { range = [0.0, 1.0] }]\n";
        let places = KeyPlaces::of(text);
        for (written, path) in [
            ("rack", "motion.rack"),
            ("2.0", "motion.rack"),
            ("[0.0, 1.0]]", "optimise.targets[0].points"),
            ("axis", "sweep.variables[0].axis"),
            ("range", "sweep.variables[1].range"),
            ("{ range", "sweep.variables[1]"),
        ] {
            let at = text.find(written).unwrap();
            assert_eq!(places.key_at(at).as_deref(), Some(path), "{written}");
        }
        assert_eq!(places.key_at(text.len() + 1), None);
        assert_eq!(KeyPlaces::of("not = [valid").key_at(0), None);
    }
}
