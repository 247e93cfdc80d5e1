//! Artificial source of values for the study parser. It records the kind of value and the keys that each type requests.

use serde::de::value::StrDeserializer;
use serde::de::{DeserializeSeed, Deserializer, MapAccess, SeqAccess, Visitor};
use std::cell::RefCell;
use std::collections::{BTreeMap, BTreeSet};
use std::fmt;

/// Kind of a value.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Kind {
    Number,
    Whole,
    Truth,
    Text,
    List,
    /// A table whose keys are names.
    Names,
    /// A table with a fixed set of keys.
    Table,
}

/// Kinds that are offered to a type that accepts any kind of value.
pub(super) const OFFERS: [Kind; 5] = [
    Kind::Number,
    Kind::Truth,
    Kind::Text,
    Kind::List,
    Kind::Table,
];

/// Known properties of the value at a path.
#[derive(Clone, Debug, Default)]
pub(super) struct Place {
    pub(super) kinds: BTreeSet<Kind>,
    pub(super) keys: Vec<&'static str>,
    /// True if the type at this path accepts any kind of value.
    pub(super) takes_any: bool,
}

/// Offers for one run of the study parser, and the records of this run.
#[derive(Debug, Default)]
pub(super) struct Notes {
    pub(super) places: BTreeMap<String, Place>,
    /// Kind offered at each path that accepts any kind. At a path without a kind here, the source offers a number.
    pub(super) offers: BTreeMap<String, Kind>,
    /// Keys of tables whose type does not list its keys in advance. The keys come from the type's error about an unknown key.
    keys: BTreeMap<String, Vec<&'static str>>,
    /// Key that is withheld in this run.
    pub(super) withheld: Option<String>,
    /// Path of the refused offer.
    pub(super) refused: Option<String>,
    /// True if the run found new keys. Then the same offer may now succeed.
    pub(super) has_learnt: bool,
}

/// Reason why a run of the study parser ended.
#[derive(Debug)]
pub(super) enum Refusal {
    /// A key is unknown. The known keys are given.
    UnknownKey(&'static [&'static str]),
    /// Any other reason.
    Other,
}

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("not as expected")
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

/// Source without text, at a path.
pub(super) struct Source<'a> {
    pub(super) notes: &'a RefCell<Notes>,
    pub(super) path: String,
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

/// Path of a key in the table at a path.
pub(crate) fn key_path(table: &str, key: &str) -> String {
    match table {
        "" => key.to_owned(),
        _ => format!("{table}.{key}"),
    }
}

/// Keys of a table, and the paths of their values.
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

/// A key of a table. Types can read the key alone, or the key with its position in the file.
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

/// Name by which the crate `serde_spanned` requests a value together with its position.
const SPANNED: &str = "$__serde_spanned_private";

/// A value with the positions of its first and its last byte, as the TOML parser delivers it.
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
            _ => visitor.visit_map(self.keys(keys.as_deref().unwrap_or(&["an unknown key"]))),
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
