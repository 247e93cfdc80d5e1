//! Tuned rates of elastic parts, as changes of the study's text.

use crate::report::brief;
use crate::study::{PathStep, Study, ValueEdit};
use serde_json::Value;

/// Names of the directions of a bushing's six rates.
const AXES: [&str; 6] = ["x", "y", "z", "about x", "about y", "about z"];

/// Tuned rates, as changes of a study's texts.
#[derive(Default)]
pub(super) struct TunedRates {
    pub edits: Vec<ValueEdit>,
    /// Present value that each edit replaces. Null if the text does not have the value yet.
    pub origins: Vec<Value>,
    /// Each changed rate in words: part, present rate, tuned rate. If the text has no present rate, the second text is empty.
    pub words: Vec<[String; 3]>,
}

/// Changes that set the tuned rates in a study's text: rates of bushings, links, springs, the anti-roll bar and the steering.
pub(super) fn rate_edits(study: &Study, text: &str, tuned: &Study) -> TunedRates {
    let parsed = |text: &str| {
        let document: toml::Table = text.parse().unwrap_or_default();
        serde_json::to_value(document).unwrap_or_default()
    };
    let then = study.with_rates_of(text.to_owned(), tuned);
    let mut rates = TunedRates::default();
    rates.collect(&mut Vec::new(), &parsed(text), &parsed(&then));
    rates
}

impl TunedRates {
    /// Adds an edit for each value of `then` that differs from the value in `now`. `path` has the keys that lead to
    /// both values in the study.
    fn collect(&mut self, path: &mut Vec<String>, now: &Value, then: &Value) {
        if now == then {
            return;
        }
        if let Some(table) = then.as_object() {
            for (key, value) in table {
                path.push(key.clone());
                self.collect(path, &now[key], value);
                path.pop();
            }
            return;
        }
        let name = match path.as_slice() {
            [section, part @ ..] if section == "bushings" || section == "links" => part,
            all => all,
        };
        self.words.extend(differences(&name.join(" "), now, then));
        self.origins.push(now.clone());
        self.edits.push(ValueEdit {
            path: path.iter().cloned().map(PathStep::Key).collect(),
            value: Some(then.clone()),
        });
    }
}

/// Numbers that differ in two values of the same key. Each has its name, its old and its new number. The value is a number, or a
/// list of numbers such as the rates of a bushing.
fn differences(name: &str, old: &Value, new: &Value) -> Vec<[String; 3]> {
    let shown = |value: &Value| value.as_f64().map_or_else(String::new, brief);
    let Some(list) = new.as_array() else {
        return vec![[name.to_owned(), shown(old), shown(new)]];
    };
    let pairs = list.iter().enumerate().filter(|(k, new)| old[*k] != **new);
    pairs
        .map(|(k, new)| {
            let axis = AXES.get(k).copied().unwrap_or_default();
            [format!("{name} {axis}"), shown(&old[k]), shown(new)]
        })
        .collect()
}
