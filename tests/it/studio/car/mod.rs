//! Tests of a car in the live page.

mod answers;
mod page;
mod saving;

use super::{Served, sample};
use serde_json::{Value, json};
use std::fs;
use std::path::PathBuf;

/// Starts the server for a sample car and its axles.
pub(super) fn served(name: &str, changed: impl Fn(&str, String) -> String) -> Served {
    let ends = ["_front", "_rear", ""];
    Served::of_files(ends.map(|end| {
        let file = format!("{name}{end}.toml");
        let text = changed(end, sample(&file));
        (file, text)
    }))
}

pub(super) fn as_it_is(_: &str, text: String) -> String {
    text
}

fn file(served: &Served, name: &str) -> PathBuf {
    served.folder.path().join(name)
}

fn read(served: &Served, name: &str) -> String {
    fs::read_to_string(file(served, name)).unwrap()
}

/// Characteristics that the page requests when it opens.
pub(super) fn asked(overview: &Value) -> Vec<Value> {
    let all = overview["characteristics"].as_array().unwrap().iter();
    let asked = all.filter(|c| c["asked"] == true && c["available"] == true);
    asked.map(|c| c["name"].clone()).collect()
}

pub(super) fn solve(served: &Served, of: &Value) -> Value {
    let names = asked(&served.overview());
    let message =
        json!({"of": of, "characteristics": names, "at": [1.0], "curves_rack": null, "over": 0});
    served.post("solve", &message).json()
}

/// Returns the design of the served study with coordinates changed, one for each entry of `moves`.
pub(super) fn moved(served: &Served, moves: &[(&str, usize, f64)]) -> Value {
    let overview = served.overview();
    let points = overview["points"].as_array().unwrap();
    let mut design = overview["design"].clone();
    for (name, axis, by) in moves {
        let place = points.iter().position(|p| p["name"] == *name).unwrap();
        let old = design[place][axis].as_f64().unwrap();
        design[place][axis] = json!(old + by);
    }
    json!({"digest": overview["digest"], "design": design})
}

fn save(served: &Served, of: &Value, anyway: bool) -> super::client::Answer {
    let message = json!({"of": of, "name": null, "anyway": anyway});
    served.post("save", &message)
}
