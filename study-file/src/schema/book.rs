//! Writes the schema from the recorded requests of the study parser and from the manual.

use super::source::{Kind, Place, key_path};
use super::{Allowed, Root};
use serde_json::{Map, Value, json};
use std::collections::{BTreeMap, BTreeSet};

/// Reads the description of each key from the manual, by section and name.
pub(super) fn manual(root: Root) -> BTreeMap<(String, String), String> {
    let mut descriptions = BTreeMap::new();
    for section in root.manual().split("\n## ").skip(1) {
        let (name, rows) = section.split_once('\n').unwrap_or((section, ""));
        let (name, sibling) = name.split_once(" (and ").unwrap_or((name, ""));
        let name = name.split(" (").next().unwrap_or(name);
        // A heading such as `gg_map.ax (and ay)` stands for both keys.
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
                    descriptions.insert((table.to_owned(), key.to_owned()), (*what).to_owned());
                }
            }
        }
    }
    descriptions
}

/// Note in the manual for keys of car studies. A study of one wheel or an axle must not contain these keys. Its parser knows
/// them only to refuse them with an explanation.
const OF_CARS: &str = "only in the [study of a car](car.md)";

/// All information about the keys that is needed to write the schema.
pub(super) struct Book {
    pub(super) root: Root,
    pub(super) places: BTreeMap<String, Place>,
    pub(super) needed: BTreeSet<String>,
    pub(super) manual: BTreeMap<(String, String), String>,
    pub(super) allowed: fn(Root, &str) -> Option<Allowed>,
}

impl Book {
    pub(super) fn of(&self, path: &str) -> Value {
        let Some(place) = self.places.get(path) else {
            return json!({});
        };
        let kinds = place.kinds.iter().map(|kind| match kind {
            Kind::Number => json!({ "type": "number" }),
            Kind::Whole => json!({ "type": "integer" }),
            Kind::Truth => json!({ "type": "boolean" }),
            Kind::Text => match (self.allowed)(self.root, path) {
                Some(allowed) => text(&allowed),
                None => json!({ "type": "string" }),
            },
            Kind::List => json!({ "type": "array", "items": self.of(&format!("{path}[]")) }),
            Kind::Names => {
                let value = self.of(&format!("{path}{{}}"));
                match (self.allowed)(self.root, path) {
                    Some(allowed) => {
                        let named = allowed.names.into_iter().map(|name| (name, value.clone()));
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
            let description =
                |section: &str| self.manual.get(&(section.to_owned(), (*key).to_owned()));
            // The manual describes the keys of ranges only once.
            let description = description(&section).or_else(|| description("motion.travel"));
            if self.root == Root::Suspension
                && description.is_some_and(|description| description.contains(OF_CARS))
            {
                continue;
            }
            if let (Some(description), Value::Object(value)) = (description, &mut value) {
                value.insert("description".to_owned(), json!(description));
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
        // Draft 4 does not allow an empty list of required keys.
        if !needed.is_empty() {
            table["required"] = json!(needed);
        }
        table
    }
}

/// Schema of a text with limited values.
fn text(allowed: &Allowed) -> Value {
    let names = json!({ "type": "string", "enum": allowed.names });
    match &allowed.pattern {
        None => names,
        Some(pattern) => json!({ "anyOf": [names, { "type": "string", "pattern": pattern }] }),
    }
}
