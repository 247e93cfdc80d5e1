//! Walks through the text of a study and converts its numbers.

use super::super::error::{Problems, Source, StudyErrors};
use super::super::place::place_of;
use super::super::value_edit::append;
use super::entry::{Before, Entry, Facts, Refused, Subject, unit_named};
use super::scale::{Conversion, Measured, Scale};
use crate::ask::six_digits;
use crate::model::{Axis, MassUnit};
use hardpoint_study_file::dimension::{Dimension, Powers, Role, dimension, place_of_key};
use hardpoint_study_file::schema::Root;
use std::sync::Arc;
use toml_edit::{Array, DocumentMut, Item, Table, TableLike, Value};

/// The number of a value, with or without a decimal point.
pub(super) fn number(value: &Value) -> Option<f64> {
    value
        .as_float()
        .or_else(|| value.as_integer().map(|whole| whole as f64))
}

/// Keys whose texts are names of results.
const NAMES: [&str; 6] = [
    "outputs.characteristics[]",
    "optimise.front[]",
    "optimise.targets[].characteristic",
    "optimise.targets[].figure",
    "optimise.constraints[].characteristic",
    "tolerance.bands[].characteristic",
];

/// Position in the text.
struct At {
    /// Position of the key. `[]` marks an element of a list, and `{}` marks a name that the study chooses.
    place: String,
    /// Keys and indices from the root.
    path: Vec<String>,
}

impl At {
    fn key(&self, root: Root, key: &str) -> At {
        At {
            place: place_of_key(root, &self.place, key),
            path: self.and(key),
        }
    }

    fn index(&self, index: usize) -> At {
        At {
            place: format!("{}[]", self.place),
            path: self.and(&index.to_string()),
        }
    }

    fn and(&self, step: &str) -> Vec<String> {
        let steps = self.path.iter().cloned();
        steps.chain([step.to_owned()]).collect()
    }
}

/// Conversion of the text of one study.
pub(super) struct Walk<'a> {
    root: Root,
    subject: Subject<'a>,
    /// Conversions of the front and the rear study of a car. For a single study, both are equal.
    ends: [Conversion; 2],
}

impl<'a> Walk<'a> {
    pub(super) fn new(root: Root, subject: Subject<'a>, ends: [Conversion; 2]) -> Self {
        Walk {
            root,
            subject,
            ends,
        }
    }

    /// Returns the same conversion, but with the masses of the text converted from unit `from` to unit `to`.
    pub(super) fn with_masses(self, from: MassUnit, to: MassUnit) -> Self {
        let ends = self.ends.map(|end| end.with_masses(from, to));
        Walk { ends, ..self }
    }

    /// Returns the converted text. `finish` makes further changes.
    pub(super) fn text(
        &self,
        source: &Arc<Source>,
        finish: impl FnOnce(&mut Table),
    ) -> Result<String, StudyErrors> {
        let mut problems = Problems::new(source.clone());
        let parsed = source.text.parse::<DocumentMut>();
        let mut document = match parsed {
            Ok(document) => document,
            Err(error) => {
                problems.add(0..0, format!("not valid TOML: {}", error.message()));
                return problems.finish(None);
            }
        };
        let before = Item::Table(document.as_table().clone());
        let mut pass = Pass {
            root: self.root,
            facts: Facts {
                subject: self.subject,
                ends: self.ends,
                before: &before,
            },
            text: &source.text,
            trails: self.subject.trails(),
            problems,
        };
        let at = At {
            place: String::new(),
            path: Vec::new(),
        };
        pass.table(document.as_table_mut(), &at, Before::default(), None);
        finish(document.as_table_mut());
        pass.problems.finish(Some(document.to_string()))
    }
}

/// One pass through the text of a study, which converts its numbers.
struct Pass<'a> {
    root: Root,
    facts: Facts<'a>,
    /// Trails of the study's tests. A trail is the distance from the contact point back to the side force.
    trails: Vec<f64>,
    text: &'a str,
    problems: Problems,
}

impl Pass<'_> {
    fn refuse(&mut self, path: &[String], reason: &str) {
        let steps: Vec<&str> = path.iter().map(String::as_str).collect();
        let message = format!("cannot be converted: {reason}");
        self.problems.add(place_of(self.text, &steps), message);
    }

    /// Converts a table. An entry within another entry, such as a region, uses the axes of the outer entry.
    fn table(&mut self, table: &mut dyn TableLike, at: &At, before: Before, outer: Option<Entry>) {
        let entry = match self.facts.entry(&at.place, table, before) {
            Ok(entry) => entry.or(outer),
            Err(Refused { key, reason }) => {
                let mut path = at.path.clone();
                path.push(key.to_owned());
                return self.refuse(&path, &reason);
            }
        };
        let moves_points = self.facts.ends.iter().any(Conversion::moves_points);
        if at.place == "sweep" && table.contains_key("designs") && moves_points {
            let reason = "the file of designs has coordinates in the old units and axes; write the variables into the study";
            self.refuse(&at.and("designs"), reason);
        }
        let has_rows = table.get("combine").and_then(Item::as_str) == Some("rows");
        let rack = table.get("rack").and_then(Item::as_table_like);
        if has_rows && rack.is_some() && along_y(&self.facts.ends[0]).reverses() {
            let reason = "the direction of the rack changes, so a range would reverse the order of the rows; write its \
                 values as a list";
            self.refuse(&at.and("rack"), reason);
        }
        let keys: Vec<String> = table.iter().map(|(key, _)| key.to_owned()).collect();
        for key in &keys {
            if let Some(item) = table.get_mut(key) {
                self.item(item, &at.key(self.root, key), entry);
            }
        }
        if entry.is_some_and(|entry| entry.value.reverses()) && at.place.ends_with("[]") {
            exchange_limits(table);
        }
    }

    fn item(&mut self, item: &mut Item, at: &At, entry: Option<Entry>) {
        if let Some(dimension) = dimension(self.root, &at.place) {
            match item {
                Item::Value(value) => self.number(value, dimension, at, entry),
                Item::Table(range) => self.range(range, dimension, entry),
                _ => {}
            }
            return;
        }
        match item {
            Item::Table(table) => self.table(table, at, Before::default(), entry),
            Item::Value(value) => self.value(value, at, Before::default(), entry),
            Item::ArrayOfTables(tables) => {
                let mut before = Before::default();
                for (k, table) in tables.iter_mut().enumerate() {
                    let axles = Facts::axles(table);
                    self.table(table, &at.index(k), before, entry);
                    before = after(before, &axles);
                }
            }
            Item::None => {}
        }
    }

    fn value(&mut self, value: &mut Value, at: &At, before: Before, entry: Option<Entry>) {
        match value {
            Value::InlineTable(table) => self.table(table, at, before, entry),
            Value::Array(list) => {
                let mut before = Before::default();
                for (k, element) in list.iter_mut().enumerate() {
                    let axles = element
                        .as_inline_table()
                        .map_or_else(Vec::new, |own| Facts::axles(own));
                    self.value(element, &at.index(k), before, entry);
                    before = after(before, &axles);
                }
            }
            Value::String(name) if NAMES.contains(&&*at.place) => {
                let conversion = &self.facts.ends[0];
                let new = renamed(name.value(), conversion, &self.trails);
                if new != *name.value() {
                    put(value, new.into());
                }
            }
            _ => {}
        }
    }

    /// Converts a value with a dimension.
    fn number(&mut self, value: &mut Value, of: Dimension, at: &At, entry: Option<Entry>) {
        if let Value::InlineTable(range) = value {
            return self.range(range, of, entry);
        }
        let conversion = entry.map_or(self.facts.ends[0], |entry| entry.conversion);
        let with = |powers: Powers| Measured::plain(powers);
        match of {
            Dimension::Plain(powers) => every(value, &conversion, with(powers)),
            Dimension::AlongY => every(value, &conversion, along_y(&conversion)),
            Dimension::Vector(powers) => vectors(value, &conversion, &|axis| {
                with(powers).signed(conversion.sign(axis))
            }),
            Dimension::Moment => vectors(value, &conversion, &|axis| {
                with(Powers::TORQUE).signed(conversion.turn_sign(axis))
            }),
            Dimension::DirectionForY => vectors(value, &conversion, &|axis| {
                let sign = conversion.sign(axis) * conversion.sign(Axis::Y);
                with(Powers::NONE).signed(sign)
            }),
            Dimension::Bushing { by_deflection } => {
                let along = Powers {
                    length: -by_deflection,
                    ..Powers::FORCE
                };
                each(value, &conversion, |k| {
                    with(if k < 3 { along } else { Powers::TORQUE })
                });
            }
            Dimension::Pairs(pair) => curve(value, &conversion, pair.map(with)),
            Dimension::ByTwoLengths => each(value, &conversion, |k| {
                const BY: [i32; 6] = [0, 1, 1, 2, 2, 2];
                with(Powers {
                    length: -BY.get(k).unwrap_or(&0),
                    ..Powers::NONE
                })
            }),
            Dimension::OfEntry(Role::ByKey) => self.by_key(value, at),
            Dimension::OfEntry(role) => match entry {
                Some(entry) => of_entry(value, role, &entry),
                None => self.refuse(&at.path, "its quantity is not known"),
            },
        }
    }

    /// Converts a value whose key determines its quantity.
    fn by_key(&mut self, value: &mut Value, at: &At) {
        let name = at.path.last().map_or("", |name| name);
        let unit = match self.facts.subject {
            Subject::Study(study) => unit_named(study, name),
            Subject::Car(_) => None,
        };
        match unit {
            Some(unit) => every(value, &self.facts.ends[0], Measured::printed(unit)),
            None => self.refuse(&at.path, &format!("the unit of {name:?} is not known")),
        }
    }

    /// Converts the ends of a range `{ from, to, steps }` to the new units and axes. If the sign of the axis changes, the ends
    /// change places, so `from` remains the lower end.
    fn range(&mut self, range: &mut dyn TableLike, of: Dimension, entry: Option<Entry>) {
        let conversion = entry.map_or(self.facts.ends[0], |entry| entry.conversion);
        let own = match of {
            Dimension::Plain(powers) => Measured::plain(powers),
            Dimension::AlongY => along_y(&conversion),
            _ => return,
        };
        let ends = ["from", "to"];
        let numbers = ends.map(|key| range.get(key)?.as_value().and_then(number));
        for key in ends {
            if let Some(value) = range.get_mut(key).and_then(Item::as_value_mut) {
                every(value, &conversion, own);
            }
        }
        if let ([Some(_), Some(_)], true) = (numbers, own.reverses()) {
            let values = ends.map(|key| range.get(key)?.as_value().cloned());
            let [from, to] = values;
            for (key, new) in ends.into_iter().zip([to, from]) {
                if let (Some(value), Some(new)) =
                    (range.get_mut(key).and_then(Item::as_value_mut), new)
                {
                    put(value, new);
                }
            }
        }
    }
}

fn along_y(conversion: &Conversion) -> Measured {
    Measured::plain(Powers::LENGTH).signed(conversion.sign(Axis::Y))
}

fn after(mut before: Before, axles: &[usize]) -> Before {
    before.all += 1;
    for end in axles {
        before.of_axle[*end] += 1;
    }
    before
}

/// Replaces a value. Keeps the spaces and comments around it.
fn put(place: &mut Value, mut new: Value) {
    *new.decor_mut() = place.decor().clone();
    *place = new;
}

/// Converts one number. A number that does not change keeps its written form.
fn one(value: &mut Value, conversion: &Conversion, of: Measured) {
    let Some(old) = number(value) else {
        return;
    };
    let size = conversion.scaled(old, of.scale);
    // Zero has no sign.
    if size == old && of.reverses() && old != 0.0 {
        put(value, negated(value));
    } else if size != old {
        let new = of.sign * conversion.rounded(old, of.scale);
        put(value, new.into());
    }
}

/// The number with the opposite sign, and with the same digits as in the text: 80.50 becomes -80.50.
fn negated(value: &Value) -> Value {
    let text = match value {
        Value::Float(number) => number.display_repr(),
        Value::Integer(number) => number.display_repr(),
        _ => return value.clone(),
    };
    let positive = text.trim_start_matches(['-', '+']);
    let new = if text.starts_with('-') {
        positive.parse()
    } else {
        format!("-{positive}").parse()
    };
    // A whole number may also be written in hexadecimal digits, which cannot have a sign.
    new.unwrap_or_else(|_| (-number(value).unwrap_or_default()).into())
}

/// Converts a number, or every number of a list.
fn every(value: &mut Value, conversion: &Conversion, of: Measured) {
    match value {
        Value::Array(list) => list
            .iter_mut()
            .for_each(|element| every(element, conversion, of)),
        _ => one(value, conversion, of),
    }
}

/// Converts the numbers of a list. The index of a number determines its unit.
fn each(value: &mut Value, conversion: &Conversion, of: impl Fn(usize) -> Measured) {
    let list = value.as_array_mut().into_iter();
    for (k, element) in list.flat_map(Array::iter_mut).enumerate() {
        one(element, conversion, of(k));
    }
}

/// Converts `[x, y, z]`, or a list of such vectors.
fn vectors(value: &mut Value, conversion: &Conversion, of: &impl Fn(Axis) -> Measured) {
    let Value::Array(list) = value else {
        return;
    };
    if list.iter().any(Value::is_array) {
        return list
            .iter_mut()
            .for_each(|vector| vectors(vector, conversion, of));
    }
    for (axis, element) in Axis::ALL.into_iter().zip(list.iter_mut()) {
        one(element, conversion, of(axis));
    }
}

/// Converts a list of pairs.
fn curve(value: &mut Value, conversion: &Conversion, of: [Measured; 2]) {
    let list = value.as_array_mut().into_iter();
    for pair in list.flat_map(Array::iter_mut) {
        each(pair, conversion, |k| of[k.min(1)]);
    }
    if let (Value::Array(list), true) = (value, of[0].reverses()) {
        reverse(list);
    }
}

/// Reverses the elements of a list. Keeps the spaces and comments.
fn reverse(list: &mut Array) {
    let values: Vec<Value> = list.iter().cloned().collect();
    for (place, value) in list.iter_mut().zip(values.into_iter().rev()) {
        put(place, value);
    }
}

/// Converts a number, or a curve of limits.
fn limit(value: &mut Value, entry: &Entry) {
    match value {
        Value::Array(_) => curve(value, &entry.conversion, [entry.drive, entry.value]),
        _ => one(value, &entry.conversion, entry.value),
    }
}

/// Converts a value whose entry determines its quantity.
fn of_entry(value: &mut Value, role: Role, entry: &Entry) {
    let Entry {
        conversion,
        value: own,
        drive,
    } = entry;
    match role {
        Role::Drive | Role::DrivePolynomial => every(value, conversion, *drive),
        Role::Value => every(value, conversion, *own),
        Role::Size => every(value, conversion, own.signed(1.0)),
        Role::Curve => curve(value, conversion, [*drive, *own]),
        Role::AtLeast | Role::AtMost => limit(value, entry),
        Role::Between => {
            if let Value::Array(list) = value {
                list.iter_mut().for_each(|end| limit(end, entry));
                if own.reverses() {
                    reverse(list);
                }
            }
        }
        Role::ByKey => {}
    }
}

/// Exchanges the lower and the upper limit of an entry.
fn exchange_limits(table: &mut dyn TableLike) {
    const LIMITS: [&str; 2] = ["at_least", "at_most"];
    let [lower, upper] = LIMITS.map(|key| table.get(key)?.as_value().cloned());
    for (key, new) in LIMITS.into_iter().zip([upper, lower]) {
        let Some(new) = new else {
            table.remove(key);
            continue;
        };
        if !table.contains_key(key) {
            append(table, key, new);
        } else if let Some(old) = table.get_mut(key).and_then(Item::as_value_mut) {
            put(old, new);
        }
    }
}

/// Name of a result in the new units. The name of a test result can change, because it contains the trail of the test.
/// `trails` lists the trail of each test of the study.
fn renamed(name: &str, conversion: &Conversion, trails: &[f64]) -> String {
    const TRAIL: &str = "_trail_";
    let Some((stem, rest)) = name.split_once(TRAIL) else {
        return name.to_owned();
    };
    let (trail, tail) = match rest.split_once('_') {
        Some((trail, tail)) => (trail, format!("_{tail}")),
        None => (rest, String::new()),
    };
    match trail.parse() {
        Ok(trail) => {
            // The name has fewer digits than the trail of the test, so `trails` gives the exact trail.
            let mut all = trails.iter().copied();
            let exact = all.find(|own| six_digits(*own) == trail).unwrap_or(trail);
            let new = conversion.scaled(exact, Scale::Powers(Powers::LENGTH));
            format!("{stem}{TRAIL}{}{tail}", six_digits(new))
        }
        Err(_) => name.to_owned(),
    }
}
