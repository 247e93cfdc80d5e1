//! `--set path=value`: changes a study's text before it is read.
//!
//! A path consists of keys and of positions in lists (from 0), separated by dots: `optimise.variables.0.range`. A value that is
//! not valid TOML is a text, so `suspension.side=right` needs no quotes.

use crate::error::{StudyError, StudyErrors};
use toml_edit::{DocumentMut, Item, Key, Table, TableLike, Value};

/// Applies overrides to a text, in order. A text that is not valid TOML stays unchanged, because [`crate::parse`] reports this
/// error later.
pub fn apply(name: &str, text: &str, overrides: &[String]) -> Result<String, StudyErrors> {
    let Ok(mut document) = text.parse::<DocumentMut>() else {
        return Ok(text.to_owned());
    };
    for written in overrides {
        set(&mut document, written)
            .map_err(|reason| StudyError::of_file(name, format!("--set {written}: {reason}")))?;
    }
    Ok(document.to_string())
}

fn set(document: &mut DocumentMut, written: &str) -> Result<(), String> {
    let (path, value) = written
        .split_once('=')
        .ok_or("expected path=value, like motion.rack=5.0")?;
    let path = Key::parse(path.trim()).map_err(|_| {
        format!(
            "{path:?} is not a path; expected keys and positions separated by dots, like \
             motion.rack"
        )
    })?;
    let value = value.trim();
    let value: Value = value.parse().unwrap_or_else(|_| value.into());
    let [parents @ .., last] = path.as_slice() else {
        return Err("expected a path before =".to_owned());
    };
    let mut place = KeyPath::Item(document.as_item_mut());
    for key in parents {
        place = place.enter(key)?;
    }
    place.put(last, value)
}

/// Part of a study's TOML document that the keys of an override have reached so far.
enum KeyPath<'a> {
    Item(&'a mut Item),
    Table(&'a mut dyn TableLike),
    Value(&'a mut Value),
}

impl<'a> KeyPath<'a> {
    /// Enters the item with this key or index. Creates a missing section, but no missing element of a list.
    fn enter(self, key: &Key) -> Result<KeyPath<'a>, String> {
        match self {
            KeyPath::Item(Item::ArrayOfTables(tables)) => {
                let count = tables.len();
                let index = index(key, count)?;
                let table = tables
                    .get_mut(index)
                    .ok_or_else(|| no_element(key, count))?;
                Ok(KeyPath::Table(table))
            }
            KeyPath::Item(Item::Value(value)) => KeyPath::Value(value).enter(key),
            KeyPath::Item(item) => match item.as_table_like_mut() {
                Some(table) => KeyPath::Table(table).enter(key),
                None => Err(no_table(key)),
            },
            KeyPath::Value(Value::Array(array)) => {
                let count = array.len();
                let index = index(key, count)?;
                let value = array.get_mut(index).ok_or_else(|| no_element(key, count))?;
                Ok(KeyPath::Value(value))
            }
            KeyPath::Value(value) => match value.as_inline_table_mut() {
                Some(table) => KeyPath::Table(table).enter(key),
                None => Err(no_table(key)),
            },
            KeyPath::Table(table) => {
                let entry = table.entry(key.get());
                Ok(KeyPath::Item(
                    entry.or_insert_with(|| Item::Table(Table::new())),
                ))
            }
        }
    }

    /// Sets the value of a key or of an existing index. Keeps the comments around the old value.
    fn put(self, key: &Key, mut value: Value) -> Result<(), String> {
        let table: &mut dyn TableLike = match self {
            KeyPath::Item(Item::Value(inner)) => return KeyPath::Value(inner).put(key, value),
            KeyPath::Value(Value::Array(array)) => {
                let count = array.len();
                let index = index(key, count)?;
                let old = array.get_mut(index).ok_or_else(|| no_element(key, count))?;
                *value.decor_mut() = old.decor().clone();
                *old = value;
                return Ok(());
            }
            KeyPath::Item(item) => item.as_table_like_mut().ok_or_else(|| no_table(key))?,
            KeyPath::Value(inner) => inner.as_inline_table_mut().ok_or_else(|| no_table(key))?,
            KeyPath::Table(table) => table,
        };
        match table.get_mut(key.get()) {
            Some(item) => {
                if let Some(old) = item.as_value() {
                    *value.decor_mut() = old.decor().clone();
                }
                *item = Item::Value(value);
            }
            None => {
                table.insert(key.get(), Item::Value(value));
            }
        }
        Ok(())
    }
}

fn index(key: &Key, count: usize) -> Result<usize, String> {
    key.get().parse().map_err(|_| {
        format!(
            "{:?} is not a position in a list of {count}; positions count from 0",
            key.get()
        )
    })
}

fn no_element(key: &Key, count: usize) -> String {
    format!(
        "the list has {count} elements and none at {}; positions count from 0",
        key.get()
    )
}

fn no_table(key: &Key) -> String {
    format!(
        "the value that should have the key {:?} is not a table",
        key.get()
    )
}
