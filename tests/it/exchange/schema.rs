//! Tests of the schema that editors use to check studies: the schema and the program accept the same keys and types.

use hardpoint::study::{CarStudy, Study, schema};
use serde_json::Value;
use std::path::Path;

/// Checks a value against the keywords of JSON schema that the program's schema uses: type, properties, required,
/// additionalProperties, items, anyOf, enum.
fn is_valid(schema: &Value, value: &Value) -> bool {
    if let Some(any) = schema.get("anyOf") {
        return any
            .as_array()
            .unwrap()
            .iter()
            .any(|schema| is_valid(schema, value));
    }
    if schema
        .get("enum")
        .is_some_and(|names| !names.as_array().unwrap().contains(value))
    {
        return false;
    }
    match (schema["type"].as_str().unwrap(), value) {
        ("number", Value::Number(_))
        | ("boolean", Value::Bool(_))
        | ("string", Value::String(_)) => true,
        ("integer", Value::Number(number)) => number.is_i64() || number.is_u64(),
        ("array", Value::Array(items)) => items.iter().all(|item| is_valid(&schema["items"], item)),
        ("object", Value::Object(table)) => {
            let none = serde_json::Map::new();
            let properties = schema
                .get("properties")
                .map_or(&none, |p| p.as_object().unwrap());
            let required = schema
                .get("required")
                .and_then(Value::as_array)
                .into_iter()
                .flatten();
            let has_all = required
                .into_iter()
                .all(|key| table.contains_key(key.as_str().unwrap()));
            has_all
                && table.iter().all(|(key, value)| match properties.get(key) {
                    Some(schema) => is_valid(schema, value),
                    None => match &schema["additionalProperties"] {
                        Value::Bool(allowed) => *allowed,
                        schema => is_valid(schema, value),
                    },
                })
        }
        _ => false,
    }
}

fn as_json(text: &str) -> Value {
    let table: toml::Table = text.parse().unwrap();
    serde_json::to_value(table).unwrap()
}

/// Faulty variants of a study. For each value, one variant has a wrong type. For each table, one variant has an unknown
/// key.
fn broken(value: &toml::Value) -> Vec<toml::Value> {
    match value {
        toml::Value::Table(table) => {
            let mut all = Vec::new();
            let mut unknown = table.clone();
            unknown.insert("no_such_key".to_owned(), 1.into());
            all.push(toml::Value::Table(unknown));
            for (key, inner) in table {
                // This key accepts two types, true and a list, so a changed type is no mistake.
                if key == "sensitivities" {
                    continue;
                }
                for changed in broken(inner) {
                    let mut table = table.clone();
                    table.insert(key.clone(), changed);
                    all.push(toml::Value::Table(table));
                }
            }
            all
        }
        toml::Value::Array(items) => {
            let mut all = vec![true.into()];
            let first = items.iter().take(1).flat_map(broken);
            all.extend(first.map(|changed| {
                let mut items = items.clone();
                items[0] = changed;
                toml::Value::Array(items)
            }));
            all
        }
        toml::Value::Boolean(_) => vec!["text".into()],
        _ => vec![true.into()],
    }
}

/// Returns true if the program refuses the text as the study of a car whose axles are in `directory`.
fn refuses_car(text: &str, directory: &Path) -> bool {
    let own = tempfile::tempdir().unwrap();
    for name in ["car", "formula_student_car"] {
        for end in ["front", "rear"] {
            let axle = format!("{name}_{end}.toml");
            std::fs::copy(directory.join(&axle), own.path().join(&axle)).unwrap();
        }
    }
    let path = own.path().join("car.toml");
    std::fs::write(&path, text).unwrap();
    CarStudy::read(&path, &[]).is_err()
}

#[test]
fn the_schema_takes_every_sample_and_refuses_what_the_reader_refuses() {
    let schema = schema();
    let directory = crate::support::studies();
    let mut count = 0;
    for entry in std::fs::read_dir(directory).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_none_or(|extension| extension != "toml") {
            continue;
        }
        let text = std::fs::read_to_string(&path).unwrap();
        assert!(is_valid(&schema, &as_json(&text)), "{}", path.display());
        let is_car = text.contains("\n[car]\n");
        for changed in broken(&text.parse::<toml::Table>().unwrap().into()) {
            count += 1;
            let text = toml::to_string(&changed).unwrap();
            let is_refused = if is_car {
                refuses_car(&text, directory)
            } else {
                Study::from_text("broken.toml", &text, directory).is_err()
            };
            let by_schema = is_valid(&schema, &as_json(&text));
            // The schema does not restrict the names of hardpoints, so it accepts an unknown key there.
            let is_name = text.contains("no_such_key = 1") && by_schema && !is_car;
            assert!(is_refused && (!by_schema || is_name), "{by_schema}: {text}");
        }
    }
    assert!(count > 100, "{count}");
}

/// The schema accepts a whole number in decimal form (such as 3.0) exactly where the program accepts it.
#[test]
fn a_decimal_is_whole_to_the_schema_where_it_is_to_the_reader() {
    let schema = schema();
    assert_eq!(schema["$schema"], "http://json-schema.org/draft-04/schema#");
    let text = "[suspension]\ntopology = \"macpherson\"\nhardpoints = {}\n[motion]\ntravel = { from = -1.0, to = 1.0, steps = S }\n";
    for (steps, taken) in [("8", true), ("8.0", false)] {
        let text = text.replace('S', steps);
        assert_eq!(is_valid(&schema, &as_json(&text)), taken, "{steps}");
        let said = Study::from_text("study.toml", &text, Path::new("")).unwrap_err();
        let by_reader = said
            .all()
            .iter()
            .any(|e| e.path().is_some_and(|p| p.contains("steps")));
        let worded = said.to_string().contains("8.0") || by_reader;
        assert_eq!(worded, !taken, "{said}");
    }
}

#[test]
fn keys_that_are_needed_are_those_the_reader_needs() {
    let schema = schema();
    let without = |key: &str| {
        let text =
            "[suspension]\ntopology = \"macpherson\"\nhardpoints = {}\n[motion]\ntravel = 0.0\n";
        let lines = text.lines().filter(|line| !line.starts_with(key));
        lines.collect::<Vec<_>>().join("\n")
    };
    assert!(is_valid(&schema, &as_json(&without("nothing"))));
    for key in ["topology", "hardpoints"] {
        assert!(!is_valid(&schema, &as_json(&without(key))), "{key}");
    }
}
