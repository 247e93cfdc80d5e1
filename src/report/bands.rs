//! Bands (allowed ranges of outputs in a tolerance analysis) in words, and the share of builds within each band. A build is a
//! random sample of the manufactured suspension.

use super::figure::{as_written, to_digits};
use super::given_columns::GivenColumns;
use super::tolerance_summary::ValueRecord;
use super::{brief, figure};
use crate::model::Axis;
use crate::study::{AxleSite, AxleStudy, Band, Study};
use crate::tolerance::Problem;
use serde::{Deserialize, Serialize};

/// A band with its yield (share of builds within the band).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct BandRecord {
    /// Band in the words of the study file.
    pub band: String,
    /// Share of builds within the band, from 0 to 1.
    pub kept: f64,
    /// Share of builds within the band, according to the first-order estimate, from 0 to 1.
    pub kept_linear: f64,
    /// Column of the output that the band limits.
    #[serde(default)]
    pub output: String,
    /// Drive value at which the band applies. For an axle, `over` names the coordinate of this value. `None` if the band applies
    /// everywhere.
    #[serde(default)]
    pub at: Option<f64>,
    /// For an axle: column of the motion to which `at` refers.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub over: Option<String>,
    /// Lowest allowed value in the column's unit; `high` is the highest. `None` without a limit.
    #[serde(default)]
    pub low: Option<f64>,
    #[serde(default)]
    pub high: Option<f64>,
}

impl BandRecord {
    /// Value that the band limits. If there are several values, it is the value whose 1 % or 99 % percentile has the smallest
    /// margin to a limit. `None` if no value belongs to the band, and for a band with a column `over`.
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

/// Advice for a band that the nominal design misses.
pub(super) const CENTRE_FIRST: &str = "Tighter tolerances cannot give a high yield then. First move the nominal value into the band, for example with \
     `hardpoint optimise`, or change the band";

/// Sentence about a band that the nominal design misses. `value` is the text with the nominal value and its station.
pub(super) fn nominal_outside(band: &str, value: &str) -> String {
    format!("the nominal design is outside the band {band}; nominal: {value}. {CENTRE_FIRST}")
}

/// Sentences about the bands that the nominal design misses, with the value that is farthest outside. `nominal` has all values
/// of the nominal design.
pub(super) fn bands_missed(problem: &Problem, nominal: &[f64]) -> Vec<String> {
    let missed = problem.bands_missed(nominal).into_iter();
    let words = missed.map(|(number, [output, station])| {
        let band = &problem.tolerance.bands[number];
        let column = &problem.outputs()[output];
        let value = nominal[problem.cell(output, station)] * column.factor();
        let value = if value.is_finite() {
            figure(value, &column.unit)
        } else {
            "missing".to_owned()
        };
        let value = format!("{} {value}", column.name);
        let place = place_in_words(problem, station);
        nominal_outside(&in_words(band), &format!("{value} at {place}"))
    });
    words.collect()
}

/// Sentences about the bands of a study that its nominal design misses. Empty without tolerances, and if the nominal design cannot
/// be solved or aligned.
pub fn study_bands_missed(study: &Study) -> Vec<String> {
    let missed = || {
        let with_bands = study.tolerance.as_ref().filter(|t| !t.bands.is_empty());
        let problem = Problem::of(study, with_bands?).ok()?;
        let nominal = problem.drawn().ok()?;
        Some(bands_missed(&problem, &nominal))
    };
    missed().unwrap_or_default()
}

/// Coordinates of a station in words, as in `travel 5 mm`. For one wheel, a rack at 0 is left out.
fn place_in_words(problem: &Problem, station: usize) -> String {
    if let Some(AxleStudy { axle, plan, .. }) = problem.study.axle() {
        let columns = GivenColumns { plan, axle };
        let values = columns.values_anywhere(&problem.placements()[station]);
        let names = columns.names().into_iter().zip(values);
        let parts: Vec<String> = names
            .map(|(name, value)| format!("{name} {}", brief(value)))
            .collect();
        return parts.join(", ");
    }
    let (stations, wheel) = (problem.stations(), problem.study.wheel());
    let unit = wheel.length_unit.symbol();
    let travel = brief(stations.values()[stations.value_of(station)]);
    let rack = stations.racks[stations.rack_of(station)];
    if rack == 0.0 {
        return format!("travel {travel} {unit}");
    }
    let rack = brief(rack * wheel.frame.sign(Axis::Y));
    format!("travel {travel} {unit}, rack {rack} {unit}")
}

/// Lowest and highest printed value of a band. `None` without a limit.
pub(super) fn limits_of(band: &Band) -> [Option<f64>; 2] {
    let printed = |v: f64| {
        // A limit is shown as in the study file, without the rounding errors of the conversion to radians.
        let printed = v * band.of.factor();
        printed.is_finite().then(|| to_digits(printed, 12))
    };
    let [low, high] = band.between.map(printed);
    if band.of.factor() < 0.0 {
        [high, low]
    } else {
        [low, high]
    }
}

/// Band in the words of the study file.
pub(super) fn in_words(band: &Band) -> String {
    let column = &band.of.column;
    let wanted = match limits_of(band).map(|limit| limit.map(as_written)) {
        [Some(low), Some(high)] => format!("{low} to {high}"),
        [Some(low), None] => format!("at least {low}"),
        [None, Some(high)] => format!("at most {high}"),
        [None, None] => "any value".to_owned(),
    };
    let held = band.site.as_ref().map_or(String::new(), AxleSite::in_words);
    let over = band.site.as_ref().map(|site| site.over.key());
    match (band.at, over) {
        (Some(at), None) => format!("{column} at {}: {wanted}", as_written(at)),
        (Some(at), Some(over)) => format!("{column} at {over} {}{held}: {wanted}", as_written(at)),
        (None, Some(over)) => format!("{column} over {over}{held}: {wanted}"),
        (None, None) => format!("{column}: {wanted}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::characteristics::Characteristic;
    use crate::model::LengthUnit;
    use crate::study::TargetQuantity;

    /// Limits keep their digits, whatever their size.
    #[test]
    fn limits_are_shown_as_in_the_study() {
        let of = TargetQuantity::characteristic(Characteristic::BumpSteer, LengthUnit::Millimetre);
        for (limits, words) in [
            ([-0.018, -0.004], "-0.018 to -0.004"),
            ([-2e-10, 3e-10], "-2e-10 to 3e-10"),
            ([f64::NEG_INFINITY, 3.3], "at most 3.3"),
            ([0.15, f64::INFINITY], "at least 0.15"),
        ] {
            let band = Band {
                between: limits.map(|limit| of.from_printed(limit)),
                of: of.clone(),
                at: None,
                site: None,
            };
            assert_eq!(in_words(&band), format!("bump_steer_deg_per_mm: {words}"));
            let finite = limits.map(|limit| Some(limit).filter(|limit| limit.is_finite()));
            assert_eq!(limits_of(&band), finite);
        }
    }
}
