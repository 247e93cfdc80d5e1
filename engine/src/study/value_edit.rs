//! Changes of single values in a study's text. Comments are kept.

use crate::sorting::sort_by_key;
use serde::{Deserialize, Serialize};
use serde_json::Value as Json;
use toml_edit::{Array, ArrayOfTables, DocumentMut, InlineTable, Item, Table, TableLike, Value};

/// One change of a study's text.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ValueEdit {
    /// Keys and indices from the root, for example `["optimise", "targets", 0, "tolerance"]`.
    pub path: Vec<PathStep>,
    /// New value. `None` removes the key or the entry. An index one past the last entry adds an entry.
    pub value: Option<Json>,
}

/// Part of the path to a value of a study file: a key, or the index of an entry of a list.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum PathStep {
    /// Entry of a list, counted from 0.
    Place(usize),
    /// Key of a table.
    Key(String),
}

/// Returns the text after all changes, made in order. Keeps the comments and line breaks around them.
pub fn edited_text(text: &str, edits: &[ValueEdit]) -> Result<String, String> {
    let mut document: DocumentMut = text.parse().map_err(|e| format!("not TOML: {e}"))?;
    for edit in edits {
        apply(document.as_table_mut(), edit)?;
    }
    Ok(document.to_string())
}

/// A table or a list inside a study.
enum Node<'a> {
    Table(&'a mut dyn TableLike),
    Tables(&'a mut ArrayOfTables),
    List(&'a mut Array),
}

fn apply(root: &mut Table, edit: &ValueEdit) -> Result<(), String> {
    let missing = || format!("the study has no {}", described(&edit.path));
    let (last, way) = edit.path.split_last().ok_or("an edit has no path")?;
    let mut node = Node::Table(root);
    for step in way {
        node = inside(node, step).ok_or_else(missing)?;
    }
    match (node, last) {
        (Node::Table(table), PathStep::Key(key)) => set_key(table, key, edit.value.as_ref()),
        (Node::List(list), PathStep::Place(at)) => set_entry(list, *at, edit.value.as_ref()),
        (Node::Tables(tables), PathStep::Place(at)) => set_table(tables, *at, edit.value.as_ref()),
        _ => None,
    }
    .ok_or_else(missing)
}

/// Describes a path, for example `optimise.targets[0].tolerance`.
fn described(path: &[PathStep]) -> String {
    let mut words = String::new();
    for step in path {
        match step {
            PathStep::Place(at) => words += &format!("[{at}]"),
            PathStep::Key(key) if words.is_empty() => words += key,
            PathStep::Key(key) => words += &format!(".{key}"),
        }
    }
    words
}

fn inside<'a>(node: Node<'a>, step: &PathStep) -> Option<Node<'a>> {
    match (node, step) {
        (Node::Table(table), PathStep::Key(key)) => {
            if !table.contains_key(key) {
                table.insert(key, Item::Table(Table::new()));
            }
            of_item(table.get_mut(key)?)
        }
        (Node::Tables(tables), PathStep::Place(at)) => Some(Node::Table(tables.get_mut(*at)?)),
        (Node::List(list), PathStep::Place(at)) => of_value(list.get_mut(*at)?),
        _ => None,
    }
}

fn of_item(item: &mut Item) -> Option<Node<'_>> {
    match item {
        Item::Table(table) => Some(Node::Table(table)),
        Item::ArrayOfTables(tables) => Some(Node::Tables(tables)),
        Item::Value(value) => of_value(value),
        Item::None => None,
    }
}

fn of_value(value: &mut Value) -> Option<Node<'_>> {
    match value {
        Value::InlineTable(table) => Some(Node::Table(table)),
        Value::Array(list) => Some(Node::List(list)),
        _ => None,
    }
}

fn set_key(table: &mut dyn TableLike, key: &str, value: Option<&Json>) -> Option<()> {
    let Some(value) = value else {
        return table.remove(key).map(drop);
    };
    if let Some(Item::Value(old)) = table.get_mut(key) {
        return replace(old, value);
    }
    append(table, key, written(value)?);
    Some(())
}

/// Adds a key at the end of a table. Keeps a comment behind the value.
pub(super) fn append(table: &mut dyn TableLike, key: &str, mut new: Value) {
    // The space before the closing brace of an inline table belongs to its last value.
    let mut end = None;
    if let Some((_, Item::Value(last))) = table.iter_mut().last()
        && let Some(suffix) = last.decor().suffix().and_then(|s| s.as_str())
        && suffix.trim().is_empty()
    {
        end = Some(suffix.to_owned());
        last.decor_mut().set_suffix("");
    }
    let suffix = new.decor().suffix().and_then(|own| own.as_str());
    let is_blank = suffix.is_none_or(|own| own.trim().is_empty());
    new.decor_mut().set_prefix(" ");
    if is_blank {
        new.decor_mut().set_suffix(end.unwrap_or_default());
    }
    table.insert(key, Item::Value(new));
}

/// Replaces a value. If the old and the new value have the same structure, also keeps the spaces and line breaks inside the
/// value.
fn replace(old: &mut Value, new: &Json) -> Option<()> {
    match (&mut *old, new) {
        (Value::Array(list), Json::Array(values)) if list.len() == values.len() => {
            let mut pairs = list.iter_mut().zip(values);
            return pairs.try_for_each(|(old, new)| replace(old, new));
        }
        (Value::Float(float), Json::Number(number)) => {
            let number = number.as_f64()?;
            if float.value().to_bits() == number.to_bits() {
                return Some(());
            }
        }
        _ => {}
    }
    let decor = old.decor().clone();
    let is_float = old.is_float();
    *old = match new.as_f64() {
        Some(number) if is_float => number.into(),
        _ => written(new)?,
    };
    *old.decor_mut() = decor;
    Some(())
}

/// Changes, removes or adds an entry of a list. A comment behind an entry, on the same line, is removed with this entry.
/// Comments above the first entry may refer to the whole list, so they are kept.
fn set_entry(list: &mut Array, at: usize, value: Option<&Json>) -> Option<()> {
    match value {
        Some(value) if at < list.len() => replace(list.get_mut(at)?, value),
        Some(value) if at == list.len() => {
            let mut new = written(value)?;
            new.decor_mut().set_prefix(place_for_more(list));
            list.push_formatted(new);
            Some(())
        }
        Some(_) => None,
        None if at < list.len() => {
            let before = prefix(list.get(at)?);
            let kept = before.split('\n').next().unwrap_or("").to_owned();
            let without_own = |text: &str| match text.find('\n') {
                Some(end) => format!("{kept}{}", &text[end..]),
                None if kept.trim().is_empty() => text.to_owned(),
                None => format!("{kept}\n{text}"),
            };
            match list.get_mut(at + 1) {
                Some(next) => {
                    let own = without_own(&prefix(next));
                    let next_prefix = match at {
                        0 if before.contains('#') => format!("{}{own}", before.trim_end()),
                        _ => own,
                    };
                    next.decor_mut().set_prefix(next_prefix);
                }
                None => {
                    let end = without_own(list.trailing().as_str().unwrap_or(""));
                    list.set_trailing(end);
                }
            }
            list.remove(at);
            Some(())
        }
        None => None,
    }
}

/// Spaces and comments before an added entry. A comment behind the previous last entry remains with that entry.
fn place_for_more(list: &mut Array) -> String {
    let Some(last) = list.len().checked_sub(1).and_then(|k| list.get_mut(k)) else {
        return String::new();
    };
    let own = prefix(last);
    let Some(start) = own.rfind('\n') else {
        return " ".to_owned();
    };
    let indent = own[start..].to_owned();
    // Without a trailing comma, the text after the last entry belongs to this entry.
    let after = last.decor().suffix().and_then(|s| s.as_str());
    let after = after.unwrap_or("").to_owned();
    last.decor_mut().set_suffix("");
    let end = format!("{after}{}", list.trailing().as_str().unwrap_or(""));
    list.set_trailing_comma(true);
    list.set_trailing("\n");
    format!("{}{indent}", end.trim_end())
}

fn prefix(value: &Value) -> String {
    let prefix = value.decor().prefix().and_then(|p| p.as_str());
    prefix.unwrap_or("").to_owned()
}

/// Changes, removes or adds a `[[table]]`. Comments above the first table may refer to all tables, so they are kept.
fn set_table(tables: &mut ArrayOfTables, at: usize, value: Option<&Json>) -> Option<()> {
    match value {
        None if at < tables.len() => {
            let above = |table: &Table| {
                let prefix = table.decor().prefix().and_then(|own| own.as_str());
                prefix.unwrap_or("").to_owned()
            };
            let removed = above(tables.get(at)?);
            tables.remove(at);
            if at == 0
                && removed.contains('#')
                && let Some(next) = tables.get_mut(0)
            {
                let own = above(next);
                let both = format!("{}\n{}", removed.trim_end(), own.trim_start_matches('\n'));
                next.decor_mut().set_prefix(both);
            }
            Some(())
        }
        None => None,
        Some(value) => {
            let mut table = Table::new();
            for (key, value) in in_usual_order(value.as_object()?) {
                table.insert(key, Item::Value(written(value)?));
            }
            if at < tables.len() {
                *tables.get_mut(at)? = table;
                return Some(());
            }
            (at == tables.len()).then(|| {
                table.decor_mut().set_prefix("\n");
                tables.push(table);
            })
        }
    }
}

/// Writes each entry of a list on its own line.
fn in_lines(list: &mut Array) {
    for entry in list.iter_mut() {
        entry.decor_mut().set_prefix("\n  ");
    }
    list.set_trailing_comma(true);
    list.set_trailing("\n");
}

/// Entries of a table. The keys that identify the subject of the table come first.
fn in_usual_order(values: &serde_json::Map<String, Json>) -> Vec<(&String, &Json)> {
    const FIRST: [&str; 9] = [
        "axle",
        "hardpoint",
        "characteristic",
        "members",
        "length",
        "articulation",
        "side",
        "over",
        "axis",
    ];
    let mut entries: Vec<_> = values.iter().collect();
    let rank = |key: &str| FIRST.iter().position(|first| *first == key);
    sort_by_key(&mut entries, |(key, _)| rank(key).unwrap_or(FIRST.len()));
    entries
}

/// Writes a value in the form of a study. `None` for a missing value.
fn written(value: &Json) -> Option<Value> {
    Some(match value {
        Json::Null => return None,
        Json::Bool(is) => (*is).into(),
        Json::String(text) => text.as_str().into(),
        Json::Number(number) => match number.as_i64() {
            Some(whole) => whole.into(),
            None => number.as_f64()?.into(),
        },
        Json::Array(values) => {
            let mut list: Array = values.iter().map(written).collect::<Option<_>>()?;
            if !list.is_empty() && values.iter().all(Json::is_object) {
                in_lines(&mut list);
            }
            Value::Array(list)
        }
        Json::Object(values) => {
            let mut table = InlineTable::new();
            for (key, value) in in_usual_order(values) {
                table.insert(key, written(value)?);
            }
            Value::InlineTable(table)
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "# head\n[motion]\ntravel = { from = -60.0, to = 60.0, steps = 31 } # travel\n\n[optimise]\ntargets = [\n  \
        { characteristic = \"toe\", points = [[-60.0, -0.1], [60.0, -0.1]], tolerance = 0.01 },\n  \
        { characteristic = \"bump_steer\", at = 0.0, value = 0.0, tolerance = 0.5 },      # degrees per mm\n  \
        { characteristic = \"caster\", at = 0.0, value = 5.0, tolerance = 0.1 },   # degrees\n]\n";

    fn edited(edits: Json) -> String {
        let edits: Vec<ValueEdit> = serde_json::from_value(edits).unwrap();
        edited_text(TEXT, &edits).unwrap()
    }

    #[test]
    fn a_value_changes_and_everything_around_it_stays() {
        let new = edited(serde_json::json!([
            {"path": ["optimise", "targets", 0, "points"], "value": [[-60, -0.1], [60, 0.2]]},
            {"path": ["motion", "travel", "to"], "value": 70},
        ]));
        let expected = TEXT
            .replace("[60.0, -0.1]", "[60.0, 0.2]")
            .replace("to = 60.0", "to = 70.0");
        assert_eq!(new, expected);
    }

    #[test]
    fn entries_of_a_new_list_have_their_own_lines() {
        let constraint = serde_json::json!({"clearance": 5, "members": ["tie_rod", "spring"]});
        let new = edited(serde_json::json!([
            {"path": ["optimise", "constraints"], "value": [constraint]},
            {"path": ["optimise", "constraints", 1], "value": {"kept": true, "length": "strut"}},
        ]));
        let expected = "constraints = [\n  { members = [\"tie_rod\", \"spring\"], clearance = 5 },\n  \
                        { length = \"strut\", kept = true },\n]";
        assert!(new.contains(expected), "{new}");
    }

    #[test]
    fn a_removed_entry_takes_its_own_comment_with_it() {
        let new = edited(serde_json::json!([{"path": ["optimise", "targets", 1], "value": null}]));
        assert!(
            !new.contains("bump_steer") && !new.contains("degrees per mm"),
            "{new}"
        );
        assert!(
            new.contains("# degrees\n]") && new.contains("# travel"),
            "{new}"
        );
        let new = edited(serde_json::json!([{"path": ["optimise", "targets", 2], "value": null}]));
        assert!(
            new.contains("# degrees per mm\n]") && !new.contains("# degrees\n"),
            "{new}"
        );
    }

    #[test]
    fn an_added_entry_stands_on_a_line_of_its_own_behind_the_comments() {
        let target = serde_json::json!({"characteristic": "camber", "between": [-1.5, 0.5], "tolerance": 0.1});
        let new =
            edited(serde_json::json!([{"path": ["optimise", "targets", 3], "value": target}]));
        let tail = "# degrees\n  { characteristic = \"camber\", between = [-1.5, 0.5], tolerance = 0.1 },\n]\n";
        assert!(new.ends_with(tail), "{new}");
        assert!(
            new.starts_with(TEXT.strip_suffix("\n]\n").unwrap()),
            "{new}"
        );
    }

    #[test]
    fn edits_and_their_inverses_give_the_text_again() {
        let there = serde_json::json!([
            {"path": ["optimise", "targets", 1, "weight"], "value": 0.5},
            {"path": ["optimise", "targets", 1, "tolerance"], "value": 0.25},
            {"path": ["optimise", "targets", 1, "weight"], "value": null},
            {"path": ["optimise", "targets", 1, "tolerance"], "value": 0.5},
        ]);
        let again: toml::Table = edited(there).parse().unwrap();
        assert_eq!(again, TEXT.parse().unwrap());
    }

    #[test]
    fn a_path_that_leads_nowhere_is_named() {
        let edit = ValueEdit {
            path: vec![
                PathStep::Key("optimise".into()),
                PathStep::Key("targets".into()),
                PathStep::Place(7),
                PathStep::Key("tolerance".into()),
            ],
            value: Some(1.into()),
        };
        let error = edited_text(TEXT, &[edit]).unwrap_err();
        assert_eq!(error, "the study has no optimise.targets[7].tolerance");
    }
}
