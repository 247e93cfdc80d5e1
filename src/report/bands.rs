//! Bands of tolerances: in words, and with the share of builds within them.

use super::shortest;
use super::tolerance_summary::ValueRecord;
use crate::study::{AxleSite, Band};
use serde::{Deserialize, Serialize};

/// A band with its yield.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct BandRecord {
    /// Band in words.
    pub band: String,
    /// Share of builds within the band.
    pub kept: f64,
    /// Share of builds within the band, according to the first-order estimate.
    pub kept_linear: f64,
    /// Column of the output that the band limits.
    #[serde(default)]
    pub output: String,
    /// Position on the motion at which the band applies. `None` if it applies everywhere.
    #[serde(default)]
    pub at: Option<f64>,
    /// For an axle: column of the motion to which `at` refers.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub over: Option<String>,
    /// Lowest and highest value in the column's unit. `None` without a limit.
    #[serde(default)]
    pub low: Option<f64>,
    #[serde(default)]
    pub high: Option<f64>,
}

impl BandRecord {
    /// Value that the band limits. If there are several values, it is the value whose 1 % or 99 % percentile has the smallest
    /// margin to a limit.
    pub fn worst_value<'v>(&self, values: &'v [ValueRecord]) -> Option<&'v ValueRecord> {
        if self.over.is_some() {
            return None;
        }
        let is_at = |value: &&ValueRecord| match (self.at, value.travel) {
            (Some(at), Some(travel)) => (at - travel).abs() <= 1e-9 * at.abs().max(1.0),
            (at, _) => at.is_none(),
        };
        let own = values
            .iter()
            .filter(|v| v.output == self.output)
            .filter(is_at);
        let margin = |value: &ValueRecord| {
            let below = self.low.zip(value.percentiles[1]).map(|(low, p)| p - low);
            let above = self
                .high
                .zip(value.percentiles[5])
                .map(|(high, p)| high - p);
            let margins = below.into_iter().chain(above);
            margins.fold(f64::INFINITY, f64::min)
        };
        own.min_by(|a, b| margin(a).total_cmp(&margin(b)))
    }
}

/// Lowest and highest printed value of a band. `None` without a limit.
pub(super) fn limits_of(band: &Band) -> [Option<f64>; 2] {
    let printed = |v: &f64| {
        // A limit is shown as in the study file, without the rounding errors of the conversion to radians.
        let printed = v * band.of.factor();
        printed.is_finite().then(|| (printed * 1e9).round() / 1e9)
    };
    let [low, high] = [&band.between[0], &band.between[1]].map(printed);
    if band.of.factor() < 0.0 {
        [high, low]
    } else {
        [low, high]
    }
}

/// Band in the words of the study file.
pub(super) fn in_words(band: &Band) -> String {
    let column = &band.of.column;
    let [low, high] = band.between.map(|v| {
        let printed = v * band.of.factor();
        // A limit is shown as in the study file, without the rounding errors of the conversion to radians.
        (printed * 1e9).round() / 1e9
    });
    let wanted = match (low.is_finite(), high.is_finite()) {
        (true, true) => format!("{} to {}", shortest(low), shortest(high)),
        (true, false) => format!("at least {}", shortest(low)),
        _ => format!("at most {}", shortest(high)),
    };
    let held = band.site.as_ref().map_or(String::new(), AxleSite::in_words);
    let over = band.site.as_ref().map(|site| site.over.key());
    match (band.at, over) {
        (Some(at), None) => format!("{column} at {}: {wanted}", shortest(at)),
        (Some(at), Some(over)) => format!("{column} at {over} {}{held}: {wanted}", shortest(at)),
        (None, Some(over)) => format!("{column} over {over}{held}: {wanted}"),
        (None, None) => format!("{column}: {wanted}"),
    }
}
