//! Small parsers of written files, independent of the program's code that reads files. Also studies for the tests.

use hardpoint::exchange::{Value, csv};
use hardpoint::model::{FrameConvention, LengthUnit, Side, Topology};
use hardpoint::study::Study;
use std::collections::BTreeMap;
use std::path::Path;

pub(super) fn sample(name: &str) -> Study {
    crate::support::study(name, &[])
}

pub(super) fn of_text(text: &str) -> Study {
    Study::from_text("s.toml", text, Path::new(".")).unwrap()
}

/// Cells of the rows of a worksheet, as text.
pub(super) fn cells(rows: &[Vec<Value>]) -> Vec<Vec<String>> {
    let text = String::from_utf8(csv(rows)).unwrap();
    let lines = text
        .lines()
        .map(|line| line.split(',').map(str::to_owned).collect());
    lines.collect()
}

pub(super) fn all_ways() -> impl Iterator<Item = (LengthUnit, FrameConvention, Side)> {
    let both = |unit| FrameConvention::ALL.map(|convention| (unit, convention));
    let pairs = LengthUnit::ALL.into_iter().flat_map(both);
    pairs.flat_map(|(unit, convention)| Side::ALL.map(|side| (unit, convention, side)))
}

/// Pairs of a drawing: a code, and the value on the line below.
pub(super) fn pairs(drawing: &[u8]) -> Vec<(u32, String)> {
    let text = std::str::from_utf8(drawing).unwrap();
    let lines: Vec<&str> = text.lines().collect();
    let (pairs, rest) = lines.as_chunks::<2>();
    assert!(rest.is_empty());
    let pair = |[code, value]: &[&str; 2]| (code.trim().parse().unwrap(), (*value).to_owned());
    pairs.iter().map(pair).collect()
}

/// Entity of a drawing: its kind, layer, coordinates by code, and text.
#[derive(Clone, Debug, Default)]
pub(super) struct Entity {
    pub(super) kind: String,
    pub(super) layer: String,
    numbers: BTreeMap<u32, f64>,
    pub(super) text: String,
}

impl Entity {
    pub(super) fn number(&self, code: u32) -> f64 {
        self.numbers[&code]
    }

    pub(super) fn place(&self, first: u32) -> [f64; 3] {
        [0, 10, 20].map(|axis| self.numbers[&(first + axis)])
    }
}

pub(super) fn entities(drawing: &[u8]) -> Vec<Entity> {
    let pairs = pairs(drawing);
    let begins = pairs.iter().position(|(_, value)| value == "ENTITIES");
    let mut entities: Vec<Entity> = Vec::new();
    for (code, value) in &pairs[begins.unwrap() + 1..] {
        match code {
            0 if value == "ENDSEC" => break,
            0 => entities.push(Entity {
                kind: value.clone(),
                ..Entity::default()
            }),
            8 => entities.last_mut().unwrap().layer.clone_from(value),
            1 => entities.last_mut().unwrap().text.clone_from(value),
            code => {
                let number = value.parse().unwrap();
                entities.last_mut().unwrap().numbers.insert(*code, number);
            }
        }
    }
    entities
}

pub(super) fn close(a: [f64; 3], b: [f64; 3], within: f64) -> bool {
    a.iter().zip(b).all(|(a, b)| (a - b).abs() <= within)
}

/// Template of a topology.
pub(super) fn template(topology: &str) -> &'static str {
    Topology::named(topology).unwrap().template
}
