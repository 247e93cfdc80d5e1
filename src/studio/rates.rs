//! Tuned rates of elastic parts, as changes of the study's text.

use crate::report::brief;
use crate::study::{PathStep, Study, ValueEdit};
use serde_json::Value;

/// Names of the axes of a bushing.
const AXES: [&str; 6] = ["x", "y", "z", "about x", "about y", "about z"];

/// Tuned rates, as changes of a study's texts.
#[derive(Default)]
pub(super) struct TunedRates {
    pub edits: Vec<ValueEdit>,
    /// Present value that each edit replaces.
    pub origins: Vec<Value>,
    /// Each changed number in words: part, present rate, tuned rate.
    pub words: Vec<[String; 3]>,
}

/// Changes that set the tuned rates in a study's text.
pub(super) fn rate_edits(study: &Study, text: &str, tuned: &Study) -> TunedRates {
    let parsed = |text: &str| {
        let document: toml::Table = text.parse().unwrap_or_default();
        serde_json::to_value(document).unwrap_or_default()
    };
    let [now, then] = [text.to_owned(), study.with_rates_of(text.to_owned(), tuned)];
    let [now, then] = [parsed(&now), parsed(&then)];
    let mut rates = TunedRates::default();
    for section in ["bushings", "links"] {
        let parts = then[section].as_object().into_iter().flatten();
        for (name, part) in parts {
            for (key, value) in part.as_object().into_iter().flatten() {
                let old = &now[section][name][key];
                if old == value {
                    continue;
                }
                let path = [section, name, key].map(|step| PathStep::Key(step.to_owned()));
                rates.origins.push(old.clone());
                rates.edits.push(ValueEdit {
                    path: path.into(),
                    value: Some(value.clone()),
                });
                let words = differences(&format!("{name} {key}"), old, value);
                rates.words.extend(words);
            }
        }
    }
    rates
}

/// Numbers of a key that differ, each with its name, old value and new value.
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
