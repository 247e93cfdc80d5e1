//! The JSON schema of studies, for editors.
//!
//! The schema is derived from the study parser: serde's code for the types of [`file`](mod@crate::file) and
//! [`car_file`](crate::car_file). The program runs this parser on an artificial source without text. The source records the
//! kind of value that each type requests: a text, a list, or a table with certain keys. It returns a value of this kind. If a
//! type accepts any kind, the source offers every kind. The source also leaves out each key once, to find out whether the key
//! is required. So the schema has exactly the keys that the parser accepts, and no second list of them exists. The descriptions
//! of keys come from `keys.md`, which the manual (`docs/study.md`) contains, and from `car_keys.md`.
//!
//! A study of one wheel or an axle and the study of a car are two kinds of file ([`Root`]). The schema covers both.
//!
//! A place in a study is written as a path: `motion.travel`; `optimise.targets[]` for each element; `suspension.hardpoints{}`
//! for each value of a table whose keys are names.

mod book;
mod source;
#[cfg(test)]
mod tests;

use crate::car_file::CarFile;
use crate::file::File;
use book::{Book, manual};
use serde::Deserialize;
use serde_json::{Value, json};
pub(crate) use source::key_path;
use source::{Kind, Notes, OFFERS, Place, Source};
use std::cell::RefCell;
use std::collections::{BTreeMap, BTreeSet};

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

    /// Text of the manual with tables of keys and their descriptions.
    fn manual(self) -> &'static str {
        match self {
            Root::Suspension => include_str!("../keys.md"),
            Root::Car => include_str!("../car_keys.md"),
        }
    }
}

/// Permitted values of a text, or permitted keys of a table.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Allowed {
    /// Complete names.
    pub names: Vec<String>,
    /// Regular expression (ECMA 262) of further values.
    pub pattern: Option<String>,
}

/// Runs of the study parser on the artificial source, and their records.
struct Probe {
    root: Root,
    notes: RefCell<Notes>,
}

impl Probe {
    /// Runs the study parser once. Returns true if it accepts the offered values.
    fn read(&self) -> bool {
        self.notes.borrow_mut().refused = None;
        let source = Source {
            notes: &self.notes,
            path: String::new(),
        };
        self.root.is_read(source)
    }

    /// Runs the study parser until it accepts the offered values. After each refused value, it offers the next kind at this path.
    /// Returns false if the parser refuses all kinds.
    fn settle(&self) -> bool {
        for _ in 0..1000 {
            if self.read() {
                return true;
            }
            let mut notes = self.notes.borrow_mut();
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
    }

    /// Offers all other kinds at each path that accepts any kind, until no new path appears.
    fn offer_every_kind(&self) {
        let mut tried = BTreeSet::new();
        loop {
            let open: Vec<(String, Kind)> = {
                let notes = self.notes.borrow();
                let any = notes.places.iter().filter(|(_, place)| place.takes_any);
                let all = any.flat_map(|(path, _)| OFFERS.map(|kind| (path.clone(), kind)));
                all.filter(|offer| !tried.contains(offer)).collect()
            };
            if open.is_empty() {
                break;
            }
            for (path, kind) in open {
                tried.insert((path.clone(), kind));
                let before = self.notes.borrow().offers.clone();
                self.notes.borrow_mut().offers.insert(path.clone(), kind);
                // The keys of a table become known when this function offers the table for the first time.
                if !self.read() && std::mem::take(&mut self.notes.borrow_mut().has_learnt) {
                    self.read();
                }
                self.notes.borrow_mut().offers = before;
            }
        }
    }

    /// Keys that the study parser requires. Withholds each key of each table once, to find out whether the parser then fails.
    fn required(&self, places: &BTreeMap<String, Place>) -> BTreeSet<String> {
        let notes = &self.notes;
        let mut needed = BTreeSet::new();
        for (path, place) in places {
            if !place.kinds.contains(&Kind::Table) {
                continue;
            }
            let before = notes.borrow().offers.clone();
            // At a path that accepts several kinds, the source offers a table.
            if place.takes_any {
                notes.borrow_mut().offers.insert(path.clone(), Kind::Table);
            }
            for key in &place.keys {
                let key = key_path(path, key);
                notes.borrow_mut().withheld = Some(key.clone());
                if !self.read() {
                    needed.insert(key);
                }
            }
            notes.borrow_mut().withheld = None;
            notes.borrow_mut().offers = before;
        }
        needed
    }
}

/// Values that the study parser requests, by path, and the keys that it requires.
fn places(root: Root) -> (BTreeMap<String, Place>, BTreeSet<String>) {
    let probe = Probe {
        root,
        notes: RefCell::default(),
    };
    let comes_through = probe.settle();
    debug_assert!(comes_through, "the types of the reader have a schema");
    probe.offer_every_kind();
    let found = probe.notes.borrow().places.clone();
    let needed = probe.required(&found);
    (found, needed)
}

/// Paths at which the study parser accepts a number that is not a count.
#[cfg(test)]
pub(crate) fn number_places(root: Root) -> Vec<String> {
    let (places, _) = places(root);
    let is_number = |place: &Place| place.kinds.contains(&Kind::Number);
    let numbers = places.into_iter().filter(|(_, place)| is_number(place));
    numbers.map(|(path, _)| path).collect()
}

/// Sections and names of the keys of a study, in the order of their names.
pub fn keys(root: Root) -> Vec<(String, String)> {
    book::manual(root).into_keys().collect()
}

/// JSON schema (draft 4) of studies: keys, required keys, and types of values. Later drafts count 8.0 as an integer, but TOML
/// does not. `allowed` returns the permitted texts or keys for a kind of study and a path. It returns `None` if any text or
/// key is permitted.
pub fn schema(allowed: fn(Root, &str) -> Option<Allowed>) -> Value {
    let kinds = Root::ALL.map(|root| {
        let (places, needed) = places(root);
        let book = Book {
            root,
            places,
            needed,
            manual: manual(root),
            allowed,
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
