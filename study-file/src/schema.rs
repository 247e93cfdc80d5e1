//! The JSON schema of studies, for editors.
//!
//! The reader itself gives the schema. The program reads the types of [`file`](mod@crate::file) from a source that has no text.
//! The source notes the kind of value that each type asks for (a text, a list, a table with these keys), and returns a value of
//! this kind. If a type accepts any kind, the source offers every kind. It withholds each key to find out if the key is required.
//! So the schema has exactly the reader's keys, and no second list of them exists. The descriptions of keys come from `keys.md`,
//! which the manual (`docs/study.md`) contains.
//!
//! A study of one wheel or an axle and the study of a car are two kinds of file ([`Root`]). The schema covers both.
//!
//! Paths give the place in a study: `motion.travel`; `optimise.targets[]` for each element; `suspension.hardpoints{}` for each
//! value of a table whose keys are names.

use crate::car_file::CarFile;
use crate::file::File;
use serde::Deserialize;
use serde::de::value::StrDeserializer;
use serde::de::{DeserializeSeed, Deserializer, MapAccess, SeqAccess, Visitor};
use serde_json::{Map, Value, json};
use std::cell::RefCell;
use std::collections::{BTreeMap, BTreeSet};
use std::fmt;

/// Kind of a value.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Kind {
    Number,
    Whole,
    Truth,
    Text,
    List,
    /// A table whose keys are names.
    Names,
    /// A table with these keys.
    Table,
}

/// Kinds that are offered to a type that accepts any kind of value.
const OFFERS: [Kind; 5] = [
    Kind::Number,
    Kind::Truth,
    Kind::Text,
    Kind::List,
    Kind::Table,
];

/// Known properties of a place.
#[derive(Clone, Debug, Default)]
struct Place {
    kinds: BTreeSet<Kind>,
    keys: Vec<&'static str>,
    /// True if the type at this place accepts any kind of value.
    takes_any: bool,
}

/// Offers for one reading, and the notes from it.
#[derive(Debug, Default)]
struct Notes {
    places: BTreeMap<String, Place>,
    /// Kind offered at each place that accepts any kind. Without an entry it is a number.
    offers: BTreeMap<String, Kind>,
    /// Keys of tables whose type did not announce them.
    keys: BTreeMap<String, Vec<&'static str>>,
    /// Key that is withheld.
    withheld: Option<String>,
    /// Place of the refused offer.
    refused: Option<String>,
    /// True if the reading found new keys. Then the same offer may now succeed.
    has_learnt: bool,
}

/// Reason why a reading ended.
#[derive(Debug)]
enum Refusal {
    /// A key is unknown. The known keys are given.
    UnknownKey(&'static [&'static str]),
    /// Any other reason.
    Other,
}

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("not what was expected")
    }
}

impl std::error::Error for Refusal {}

impl serde::de::Error for Refusal {
    fn custom<T: fmt::Display>(_: T) -> Self {
        Refusal::Other
    }

    fn unknown_field(_: &str, expected: &'static [&'static str]) -> Self {
        Refusal::UnknownKey(expected)
    }
}

/// Source without text, at a place.
struct Source<'a> {
    notes: &'a RefCell<Notes>,
    path: String,
}

impl<'a> Source<'a> {
    fn note(&self, kind: Kind) {
        let mut notes = self.notes.borrow_mut();
        notes
            .places
            .entry(self.path.clone())
            .or_default()
            .kinds
            .insert(kind);
    }

    fn at(&self, path: String) -> Source<'a> {
        Source {
            notes: self.notes,
            path,
        }
    }

    fn keys(&self, keys: &[&'static str]) -> Keys<'a> {
        let withheld = self.notes.borrow().withheld.clone();
        let given = keys.iter().map(|key| (*key, key_path(&self.path, key)));
        let given = given.filter(|(_, path)| withheld.as_ref() != Some(path));
        Keys {
            notes: self.notes,
            left: given.collect(),
            value: String::new(),
        }
    }
}

/// Place of a key in the table at a place.
fn key_path(table: &str, key: &str) -> String {
    match table {
        "" => key.to_owned(),
        _ => format!("{table}.{key}"),
    }
}

/// Keys of a table, and the places of their values.
struct Keys<'a> {
    notes: &'a RefCell<Notes>,
    left: std::collections::VecDeque<(&'static str, String)>,
    value: String,
}

impl<'de> MapAccess<'de> for Keys<'_> {
    type Error = Refusal;

    fn next_key_seed<K: DeserializeSeed<'de>>(
        &mut self,
        seed: K,
    ) -> Result<Option<K::Value>, Refusal> {
        let Some((key, path)) = self.left.pop_front() else {
            return Ok(None);
        };
        self.value = path;
        seed.deserialize(Key(key)).map(Some)
    }

    fn next_value_seed<V: DeserializeSeed<'de>>(&mut self, seed: V) -> Result<V::Value, Refusal> {
        let path = std::mem::take(&mut self.value);
        seed.deserialize(Source {
            notes: self.notes,
            path,
        })
    }
}

/// A key of a table. Like a value, it can be read together with its place in the file.
struct Key(&'static str);

impl<'de> Deserializer<'de> for Key {
    type Error = Refusal;

    fn deserialize_any<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Refusal> {
        visitor.visit_borrowed_str(self.0)
    }

    fn deserialize_struct<V: Visitor<'de>>(
        self,
        _: &'static str,
        fields: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Refusal> {
        visitor.visit_map(Spanned {
            fields,
            next: 0,
            value: Some(self),
        })
    }

    serde::forward_to_deserialize_any! {
        bool i8 i16 i32 i64 u8 u16 u32 u64 f32 f64 char str string bytes byte_buf option unit unit_struct
        newtype_struct seq tuple tuple_struct map enum identifier ignored_any
    }
}

/// Name by which the type of such a value announces itself (crate `serde_spanned`).
const SPANNED: &str = "$__serde_spanned_private";

/// A value between its first and its last byte, in the form of the TOML reader.
struct Spanned<T> {
    fields: &'static [&'static str],
    next: usize,
    value: Option<T>,
}

impl<'de, T: Deserializer<'de, Error = Refusal>> MapAccess<'de> for Spanned<T> {
    type Error = Refusal;

    fn next_key_seed<K: DeserializeSeed<'de>>(
        &mut self,
        seed: K,
    ) -> Result<Option<K::Value>, Refusal> {
        let Some(field) = self.fields.get(self.next) else {
            return Ok(None);
        };
        self.next += 1;
        seed.deserialize(Key(field)).map(Some)
    }

    fn next_value_seed<V: DeserializeSeed<'de>>(&mut self, seed: V) -> Result<V::Value, Refusal> {
        match self.value.take() {
            Some(value) if self.next == self.fields.len() => seed.deserialize(value),
            value => {
                self.value = value;
                seed.deserialize(serde::de::value::UsizeDeserializer::new(0))
            }
        }
    }
}

/// A list of one element.
struct One<'a>(Option<Source<'a>>);

impl<'de> SeqAccess<'de> for One<'_> {
    type Error = Refusal;

    fn next_element_seed<T: DeserializeSeed<'de>>(
        &mut self,
        seed: T,
    ) -> Result<Option<T::Value>, Refusal> {
        let element = self.0.take();
        element.map(|source| seed.deserialize(source)).transpose()
    }
}

impl<'de> Deserializer<'de> for Source<'_> {
    type Error = Refusal;

    fn deserialize_any<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Refusal> {
        let path = self.path.clone();
        let offer = {
            let mut notes = self.notes.borrow_mut();
            notes.places.entry(path.clone()).or_default().takes_any = true;
            notes.offers.get(&path).copied().unwrap_or(Kind::Number)
        };
        let notes = self.notes;
        let keys = notes.borrow().keys.get(&path).cloned();
        let read = match offer {
            Kind::Number => visitor.visit_f64(1.0),
            Kind::Truth => visitor.visit_bool(true),
            Kind::Text => visitor.visit_str("text"),
            Kind::List => {
                let element = self.at(format!("{path}[]"));
                visitor.visit_seq(One(Some(element)))
            }
            _ => visitor.visit_map(self.keys(keys.as_deref().unwrap_or(&["a key nobody has"]))),
        };
        let mut notes = notes.borrow_mut();
        match &read {
            Ok(_) => {
                let place = notes.places.entry(path).or_default();
                place.kinds.insert(offer);
                if offer == Kind::Table {
                    place.keys = keys.unwrap_or_default();
                }
            }
            Err(Refusal::UnknownKey(known)) if offer == Kind::Table && keys.is_none() => {
                notes.keys.insert(path, known.to_vec());
                notes.has_learnt = true;
            }
            Err(_) if notes.refused.is_none() => notes.refused = Some(path),
            Err(_) => (),
        }
        read
    }

    fn deserialize_struct<V: Visitor<'de>>(
        self,
        name: &'static str,
        fields: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Refusal> {
        if name.starts_with(SPANNED) {
            return visitor.visit_map(Spanned {
                fields,
                next: 0,
                value: Some(self),
            });
        }
        self.note(Kind::Table);
        {
            let mut notes = self.notes.borrow_mut();
            notes.places.entry(self.path.clone()).or_default().keys = fields.to_vec();
        }
        visitor.visit_map(self.keys(fields))
    }

    fn deserialize_map<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Refusal> {
        self.note(Kind::Names);
        // A table with one key, which is a name.
        visitor.visit_map(Keys {
            notes: self.notes,
            left: [("name", format!("{}{{}}", self.path))].into(),
            value: String::new(),
        })
    }

    fn deserialize_seq<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Refusal> {
        self.note(Kind::List);
        let element = self.at(format!("{}[]", self.path));
        visitor.visit_seq(One(Some(element)))
    }

    fn deserialize_option<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Refusal> {
        visitor.visit_some(self)
    }

    fn deserialize_bool<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Refusal> {
        self.note(Kind::Truth);
        visitor.visit_bool(true)
    }

    fn deserialize_i64<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Refusal> {
        self.note(Kind::Whole);
        visitor.visit_i64(1)
    }

    fn deserialize_f64<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Refusal> {
        self.note(Kind::Number);
        visitor.visit_f64(1.0)
    }

    fn deserialize_string<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Refusal> {
        self.note(Kind::Text);
        StrDeserializer::new("text").deserialize_str(visitor)
    }

    serde::forward_to_deserialize_any! {
        i8 i16 i32 u8 u16 u32 u64 f32 char str bytes byte_buf unit unit_struct newtype_struct tuple
        tuple_struct enum identifier ignored_any
    }
}

/// Kind of study, distinguished by its sections.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Root {
    /// One wheel or an axle: `[suspension]` and `[motion]`.
    Suspension,
    /// A car: `[car]`.
    Car,
}

impl Root {
    /// All kinds of study.
    pub const ALL: [Root; 2] = [Root::Suspension, Root::Car];

    fn is_read(self, source: Source<'_>) -> bool {
        match self {
            Root::Suspension => File::deserialize(source).is_ok(),
            Root::Car => CarFile::deserialize(source).is_ok(),
        }
    }

    fn title(self) -> &'static str {
        match self {
            Root::Suspension => "A study of one wheel or an axle",
            Root::Car => "A study of a car",
        }
    }

    /// Tables of keys with their descriptions.
    fn manual(self) -> &'static str {
        match self {
            Root::Suspension => include_str!("../keys.md"),
            Root::Car => include_str!("../car_keys.md"),
        }
    }
}

/// Everything that the reader asks for, by place, and the keys that it requires.
fn places(root: Root) -> (BTreeMap<String, Place>, BTreeSet<String>) {
    let notes = RefCell::new(Notes::default());
    let read = || {
        notes.borrow_mut().refused = None;
        let source = Source {
            notes: &notes,
            path: String::new(),
        };
        root.is_read(source)
    };
    // After a refused offer the next kind is offered, until a reading succeeds.
    let settle = || {
        for _ in 0..1000 {
            if read() {
                return true;
            }
            let mut notes = notes.borrow_mut();
            if std::mem::take(&mut notes.has_learnt) {
                continue;
            }
            let Some(path) = notes.refused.clone() else {
                return false;
            };
            let offer = notes.offers.get(&path).copied().unwrap_or(Kind::Number);
            let mut next = OFFERS.iter().skip_while(|kind| **kind != offer);
            match next.nth(1) {
                Some(next) => drop(notes.offers.insert(path, *next)),
                None => return false,
            }
        }
        false
    };
    let comes_through = settle();
    debug_assert!(comes_through, "the reader's types can be read from nothing");
    // At each place that accepts any kind, all other kinds are offered, until nothing new appears.
    let mut tried = BTreeSet::new();
    loop {
        let open: Vec<(String, Kind)> = {
            let notes = notes.borrow();
            let any = notes.places.iter().filter(|(_, place)| place.takes_any);
            let all = any.flat_map(|(path, _)| OFFERS.map(|kind| (path.clone(), kind)));
            all.filter(|offer| !tried.contains(offer)).collect()
        };
        if open.is_empty() {
            break;
        }
        for (path, kind) in open {
            tried.insert((path.clone(), kind));
            let before = notes.borrow().offers.clone();
            notes.borrow_mut().offers.insert(path.clone(), kind);
            // The keys of a table are known after it was offered once.
            if !read() && std::mem::take(&mut notes.borrow_mut().has_learnt) {
                read();
            }
            notes.borrow_mut().offers = before;
        }
    }
    // This finds the required keys. At a place with several kinds, a table is offered.
    let mut needed = BTreeSet::new();
    let found = notes.borrow().places.clone();
    for (path, place) in &found {
        if !place.kinds.contains(&Kind::Table) {
            continue;
        }
        let before = notes.borrow().offers.clone();
        if place.takes_any {
            notes.borrow_mut().offers.insert(path.clone(), Kind::Table);
        }
        for key in &place.keys {
            let key = key_path(path, key);
            notes.borrow_mut().withheld = Some(key.clone());
            if !read() {
                needed.insert(key);
            }
        }
        notes.borrow_mut().withheld = None;
        notes.borrow_mut().offers = before;
    }
    (found, needed)
}

/// Description of each key, by section and name.
fn manual(root: Root) -> BTreeMap<(String, String), String> {
    let mut said = BTreeMap::new();
    for section in root.manual().split("\n## ").skip(1) {
        let (name, rows) = section.split_once('\n').unwrap_or((section, ""));
        let (name, sibling) = name.split_once(" (and ").unwrap_or((name, ""));
        let name = name.split(" (").next().unwrap_or(name);
        // `gg_map.ax (and ay)` describes both keys.
        let sibling = sibling
            .strip_suffix(')')
            .map(|sibling| match name.rsplit_once('.') {
                Some((table, _)) => format!("{table}.{sibling}"),
                None => sibling.to_owned(),
            });
        for row in rows.lines() {
            let cells: Vec<&str> = row
                .split(" | ")
                .map(|cell| cell.trim_matches([' ', '|']))
                .collect();
            let key = row.strip_prefix("| `").and_then(|row| row.split_once('`'));
            if let (Some((key, _)), Some(what)) = (key, cells.last()) {
                for table in [Some(name), sibling.as_deref()].into_iter().flatten() {
                    said.insert((table.to_owned(), key.to_owned()), (*what).to_owned());
                }
            }
        }
    }
    said
}

/// JSON schema (draft 4) of studies: keys, required keys, and types of values. In later drafts 8.0 is an integer, but not in
/// TOML. `names` returns the list of allowed names or table keys for a kind of study and a place, if there is one.
pub fn schema(names: fn(Root, &str) -> Option<Vec<String>>) -> Value {
    let kinds = Root::ALL.map(|root| {
        let (places, needed) = places(root);
        let book = Book {
            root,
            places,
            needed,
            manual: manual(root),
            names,
        };
        let mut study = book.of("");
        study["title"] = json!(root.title());
        study
    });
    json!({
        "$schema": "http://json-schema.org/draft-04/schema#",
        "title": "A study of hardpoint",
        "anyOf": kinds,
    })
}

/// Text in the manual for keys that the study of one wheel or an axle only knows in order to refuse them.
const OF_CARS: &str = "only in the [study of a car](car.md)";

/// All known facts, while the schema is written.
struct Book {
    root: Root,
    places: BTreeMap<String, Place>,
    needed: BTreeSet<String>,
    manual: BTreeMap<(String, String), String>,
    names: fn(Root, &str) -> Option<Vec<String>>,
}

impl Book {
    fn of(&self, path: &str) -> Value {
        let Some(place) = self.places.get(path) else {
            return json!({});
        };
        let kinds = place.kinds.iter().map(|kind| match kind {
            Kind::Number => json!({ "type": "number" }),
            Kind::Whole => json!({ "type": "integer" }),
            Kind::Truth => json!({ "type": "boolean" }),
            Kind::Text => match (self.names)(self.root, path) {
                Some(names) => json!({ "type": "string", "enum": names }),
                None => json!({ "type": "string" }),
            },
            Kind::List => json!({ "type": "array", "items": self.of(&format!("{path}[]")) }),
            Kind::Names => {
                let value = self.of(&format!("{path}{{}}"));
                match (self.names)(self.root, path) {
                    Some(names) => {
                        let named = names.into_iter().map(|name| (name, value.clone()));
                        let properties: Map<String, Value> = named.collect();
                        json!({ "type": "object", "properties": properties, "additionalProperties": false })
                    }
                    None => json!({ "type": "object", "additionalProperties": value }),
                }
            }
            Kind::Table => self.table(path, place),
        });
        let mut kinds: Vec<Value> = kinds.collect();
        match kinds.len() {
            1 => kinds.remove(0),
            _ => json!({ "anyOf": kinds }),
        }
    }

    fn table(&self, path: &str, place: &Place) -> Value {
        let section = path.replace("[]", "").replace("{}", ".NAME");
        let mut properties = Map::new();
        for key in &place.keys {
            let mut value = self.of(&key_path(path, key));
            let said = |section: &str| self.manual.get(&(section.to_owned(), (*key).to_owned()));
            // The manual describes ranges only once.
            let said = said(&section).or_else(|| said("motion.travel"));
            if self.root == Root::Suspension && said.is_some_and(|said| said.contains(OF_CARS)) {
                continue;
            }
            if let (Some(said), Value::Object(value)) = (said, &mut value) {
                value.insert("description".to_owned(), json!(said));
            }
            properties.insert((*key).to_owned(), value);
        }
        let is_needed = |key: &&&str| self.needed.contains(&key_path(path, key));
        let needed: Vec<_> = place.keys.iter().filter(is_needed).collect();
        let mut table = json!({
            "type": "object",
            "properties": properties,
            "additionalProperties": false,
        });
        // Draft 4 does not allow an empty list here.
        if !needed.is_empty() {
            table["required"] = json!(needed);
        }
        table
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_types_and_needs_are_those_of_the_reader() {
        let schema = schema(|_, _| None);
        let car = &schema["anyOf"][1];
        assert_eq!(car["required"], json!(["car"]));
        assert_eq!(
            car["properties"]["car"]["required"],
            json!(["front", "rear"])
        );
        let case = &car["properties"]["cases"]["items"];
        assert_eq!(case["required"], json!(["name"]));
        assert_eq!(
            case["properties"]["ay"]["description"],
            "acceleration to the left (a left turn), g"
        );
        // Keys that only a car has.
        let target = "/properties/optimise/properties/targets/items/properties";
        let offers = |kind: usize, key: &str| {
            let keys = schema["anyOf"][kind].pointer(target).unwrap();
            keys.get(key).is_some()
        };
        for key in ["case", "axle"] {
            assert!(offers(1, key) && !offers(0, key), "{key}");
        }
        let schema = &schema["anyOf"][0];
        let at = |pointer: &str| {
            schema
                .pointer(pointer)
                .unwrap_or_else(|| panic!("{pointer}: {schema:#}"))
        };
        assert_eq!(at("/required"), &json!(["suspension", "motion"]));
        assert_eq!(at("/additionalProperties"), &json!(false));
        assert_eq!(
            at("/properties/suspension/required"),
            &json!(["topology", "hardpoints"])
        );
        let coordinates = "/properties/suspension/properties/hardpoints/additionalProperties";
        assert_eq!(
            at(coordinates),
            &json!({ "type": "array", "items": { "type": "number" } })
        );
        let travel = at("/properties/motion/properties/travel/anyOf");
        assert_eq!(travel.as_array().unwrap().len(), 3, "{travel}");
        assert_eq!(travel[2]["required"], json!(["from", "to", "steps"]));
        assert_eq!(travel[2]["properties"]["steps"]["type"], "integer");
        let sensitivities = at("/properties/outputs/properties/sensitivities/anyOf");
        assert_eq!(sensitivities[0]["type"], "boolean");
        assert_eq!(sensitivities[1]["items"]["type"], "string");
        let tolerance = "/properties/optimise/properties/targets/items/properties/tolerance";
        assert_eq!(at(tolerance)["description"], "acceptable deviation");
    }
}
