//! Results of a tolerance analysis, as tables and files. A build is a random sample of the manufactured suspension; a contributor
//! is a scattering part: a point, a length, a jig or a rate.

mod values;

use super::bands::{BandRecord, bands_missed, in_words, limits_of};
use super::figure::with_decimals;
use super::files::csv_of_rows;
use super::given_columns::GivenColumns;
use super::table::{Cell, Column, Table};
use super::text::counted;
use super::{brief, optional};
use crate::assembly::AssemblyError;
use crate::model::Side;
use crate::study::AxleStudy;
use crate::tolerance::{Expansion, MonteCarlo, PERCENTILES, Problem, Yields};
use serde::{Deserialize, Serialize};
pub use values::ValueRecord;
use values::values;
pub(super) use values::{HistogramRecord, LinearResult};

/// Explains the rows of [`ToleranceSummary::values_table`].
pub const VALUES_NOTE: &str = "Each output has a row in the design position, and a row where its sigma is largest. \
     tolerance.csv has all positions.";

/// Results of `hardpoint tolerance`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ToleranceSummary {
    /// Name of the study.
    pub study: String,
    /// Number of builds.
    pub builds: u64,
    /// Seed of the random builds.
    pub seed: u32,
    /// True if the adjustments of `[setup]` set toe and camber again after assembly.
    pub aligned: bool,
    /// Number of builds that could not be assembled.
    pub rejected: u64,
    /// Number of rejected builds for each reason, with the first build rejected for this reason.
    pub rejects: Vec<RejectRecord>,
    /// Number of builds that have no pose somewhere in the motion.
    pub incomplete: u64,
    /// Number of the first build that has no pose somewhere in the motion.
    pub first_incomplete: Option<u64>,
    /// For an axle: columns of the coordinates that give the position of a value on the motion.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub places: Vec<String>,
    /// Scatter of all outputs at all positions.
    pub values: Vec<ValueRecord>,
    /// Bands (allowed ranges of outputs), with their yields (shares of builds within the bands).
    pub bands: Vec<BandRecord>,
    /// Sentences about the bands that the nominal design misses.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub nominal_outside: Vec<String>,
    /// Fraction of the builds within all bands. `None` without bands.
    pub yield_of_all: Option<f64>,
    /// Fraction of the builds within all bands, according to the first-order estimate.
    pub yield_of_all_linear: Option<f64>,
    /// Contributors, sorted by the yield gained by halving their tolerance, largest first. Empty without bands.
    pub ranking: Vec<RankingRecord>,
}

/// A reason for rejected builds.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RejectRecord {
    /// Short name of the reason.
    pub reason: String,
    /// Number of builds rejected for this reason.
    pub builds: u64,
    /// Number of the first build that was rejected for this reason.
    pub first: u64,
    /// Explanation of this first rejection, in words.
    pub what: String,
}

/// Effect of a contributor on the yield.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RankingRecord {
    /// Name of the contributor.
    pub contributor: String,
    /// Largest share of this contributor in the variance of an output that has a band (allowed range).
    pub share: f64,
    /// Output in whose variance the contributor has this share.
    #[serde(default)]
    pub output: String,
    /// Predicted yield if the tolerance of this contributor is halved.
    pub yield_halved: f64,
    /// Predicted yield if the tolerance of this contributor is doubled.
    pub yield_doubled: f64,
    /// True if the tolerance can be relaxed: doubling it reduces the yield very little.
    pub may_be_looser: bool,
}

/// Reason for a rejected build. For an axle it names the wheel.
pub fn rejected(side: Option<Side>, why: &AssemblyError) -> String {
    match side {
        None => why.to_string(),
        Some(side) => side.about(why),
    }
}

impl ToleranceSummary {
    /// Summarises the first-order estimate, the Monte Carlo builds and the yields. `drawn` has all values of the nominal design, in
    /// the kernel's units.
    pub fn of(
        problem: &Problem,
        drawn: &[f64],
        expansion: &Expansion,
        builds: &MonteCarlo,
        yields: Option<&Yields>,
    ) -> Self {
        let tolerance = problem.tolerance;
        let contributor = |number: usize| tolerance.scatter[number].name.clone();
        let all_values = values(problem, drawn, expansion, builds);
        let most_affected = |number: usize| {
            let cells = problem.cells_of_bands().flatten();
            let shares = cells.filter_map(|cell| Some((all_values[cell].shares[number]?, cell)));
            let most = shares.max_by(|a, b| a.0.total_cmp(&b.0));
            most.map_or_else(String::new, |(_, cell)| all_values[cell].output.clone())
        };
        let ranking = yields.map_or_else(Vec::new, |yields| {
            let ranking = yields.ranking.iter();
            ranking
                .map(|r| RankingRecord {
                    contributor: contributor(r.contributor),
                    share: r.share,
                    output: most_affected(r.contributor),
                    yield_halved: r.halved,
                    yield_doubled: r.doubled,
                    may_be_looser: r.may_be_looser,
                })
                .collect()
        });
        let mut summary = ToleranceSummary {
            study: problem.study.name.clone(),
            builds: builds.builds,
            seed: tolerance.seed,
            aligned: tolerance.aligned,
            rejected: builds.rejected(),
            rejects: builds
                .rejects
                .iter()
                .map(|(word, rejected)| RejectRecord {
                    reason: (*word).to_owned(),
                    builds: rejected.builds,
                    first: rejected.first,
                    what: self::rejected(rejected.side, &rejected.why),
                })
                .collect(),
            incomplete: builds.incomplete,
            first_incomplete: builds.first_incomplete,
            places: places(problem),
            values: all_values,
            bands: yields.map_or_else(Vec::new, |yields| {
                let bands = tolerance.bands.iter().zip(&yields.bands);
                bands
                    .map(|(band, of)| BandRecord {
                        band: in_words(band),
                        kept: of.monte_carlo,
                        kept_linear: of.linear,
                        output: band.of.column.clone(),
                        at: band.at,
                        over: band.site.as_ref().map(|site| site.over.key().to_owned()),
                        low: limits_of(band)[0],
                        high: limits_of(band)[1],
                    })
                    .collect()
            }),
            nominal_outside: bands_missed(problem, drawn),
            yield_of_all: yields.map(|y| y.all.monte_carlo),
            yield_of_all_linear: yields.map(|y| y.all.linear),
            ranking,
        };
        summary.keep_drawn_histograms();
        summary
    }

    /// Removes the histograms of values, except those that the page shows with a band.
    fn keep_drawn_histograms(&mut self) {
        let bands = self.bands.iter();
        let drawn: Vec<ValueRecord> = bands
            .filter_map(|band| band.worst_value(&self.values).cloned())
            .collect();
        for value in &mut self.values {
            if !drawn.contains(value) {
                value.histogram = None;
            }
        }
    }

    /// Share of builds within all bands, in words. `None` without bands.
    pub fn kept_in_words(&self) -> Option<String> {
        self.yield_of_all.map(percent)
    }

    /// Line that describes the tolerance analysis.
    pub fn headline(&self) -> String {
        let aligned = if self.aligned {
            ", aligned"
        } else {
            ", as assembled"
        };
        let mut line = format!("{}{aligned}", counted(self.builds, "build"));
        if let Some(kept) = self.kept_in_words() {
            line += &format!(", {kept} in all bands");
        }
        line
    }

    /// Sentences about builds that were rejected or have no pose at some station.
    pub fn failures(&self) -> Vec<String> {
        let mut lines: Vec<String> = self
            .rejects
            .iter()
            .map(|r| {
                format!(
                    "{} rejected, first build {}: {}",
                    counted(r.builds, "build"),
                    r.first,
                    r.what
                )
            })
            .collect();
        if let Some(first) = self.first_incomplete {
            lines.push(format!(
                "{} cannot be solved at one or more stations and {} no values there (first: build {first})",
                counted(self.incomplete, "build"),
                if self.incomplete == 1 { "has" } else { "have" }
            ));
        }
        lines
    }

    /// Table of every output at the design position, and at the position with the largest sigma. `length` is the symbol of the
    /// length unit.
    pub fn values_table(&self, length: &str) -> Table {
        let rack_moves = self.values.iter().any(|v| v.rack != self.values[0].rack);
        let mut header = vec![Column::from("output")];
        if self.places.is_empty() {
            header.push(Column::named(format!("travel {length}"), "travel"));
            header.extend(rack_moves.then(|| Column::named(format!("rack {length}"), "rack")));
        } else {
            header.extend(self.places.iter().cloned().map(Column::from));
        }
        let keys = header.len();
        let numbers = ["nominal", "mean", "sigma", "linear", "p5", "p95"];
        header.extend(numbers.map(Column::from));
        header.extend([
            Column::from("linear holds"),
            Column::for_programs("because"),
        ]);
        let mut table = Table::with_columns(header).keyed(keys);
        let mut outputs: Vec<&str> = Vec::new();
        for value in &self.values {
            if !outputs.contains(&&*value.output) {
                outputs.push(&value.output);
            }
        }
        for output in outputs {
            let of_output = || self.values.iter().filter(|v| v.output == output);
            let rest = of_output().find(|v| v.at_rest);
            let wide = of_output()
                .max_by(|a, b| a.sigma.unwrap_or(0.0).total_cmp(&b.sigma.unwrap_or(0.0)));
            let mut shown: Vec<&ValueRecord> = rest.into_iter().collect();
            shown.extend(wide.filter(|wide| !wide.at_rest));
            for value in shown {
                let linear = value.linear_result();
                let words = linear.in_words();
                // Numbers from builds, and the linear sigma, are rounded to the reliable digits of sigma.
                let digits = value
                    .sigma_error
                    .filter(|error| *error > 0.0 && words != "does not scatter");
                let decimals =
                    digits.map(|error| (-error.log10()).ceil().clamp(0.0, 12.0) as usize);
                let figure = |v: Option<f64>| Cell::from(v.map(|v| Cell::figure(v, &value.unit)));
                let sampled = |v: Option<f64>| match decimals {
                    Some(decimals) => Cell::by(v, |v| with_decimals(v, decimals)),
                    None => figure(v),
                };
                let numbers = [
                    figure(value.nominal),
                    sampled(value.mean),
                    sampled(value.sigma),
                    sampled(value.sigma_linear),
                    sampled(value.percentiles[2]),
                    sampled(value.percentiles[4]),
                ];
                let holds = Cell::in_words(linear.holds, words);
                let head = [Cell::from(output)].into_iter();
                let places = value.travel.into_iter();
                let places = places.chain(value.rack.filter(|_| rack_moves));
                let places = places.chain(value.place.iter().copied()).map(Cell::from);
                let cells = head.chain(places).chain(numbers);
                table.push_row(cells.chain([holds, linear.because().into()]));
            }
        }
        table
    }

    /// Names of the columns that give the position of a value on the motion. `length` is the symbol of the length unit.
    fn place_columns(&self, length: &str) -> Vec<String> {
        if self.places.is_empty() {
            vec![format!("travel_{length}"), format!("rack_{length}")]
        } else {
            self.places.clone()
        }
    }

    /// Table of the bands with their yields.
    pub fn bands_table(&self) -> Table {
        let mut table = Table::new(["band", "yield", "linear"]);
        let mut push = |band: &str, kept: f64, linear: f64| {
            table.push_row([
                Cell::from(band),
                Cell::by(kept, percent),
                Cell::by(linear, percent),
            ]);
        };
        for band in &self.bands {
            push(&band.band, band.kept, band.kept_linear);
        }
        if let (Some(kept), Some(linear)) = (self.yield_of_all, self.yield_of_all_linear) {
            push("all", kept, linear);
        }
        table
    }

    /// Table of the contributors: their shares in the variance, the yields at half and double tolerance, and whether the tolerance
    /// can be relaxed.
    pub fn ranking_table(&self) -> Table {
        let yields = [
            Column::named("yield at half tolerance", "yield_halved"),
            Column::named("yield at double tolerance", "yield_doubled"),
        ];
        let relaxed = Column::named("can be relaxed", "may be looser");
        let shares = [
            Column::for_readers("largest share"),
            Column::for_readers("of the variance of"),
            Column::for_programs("share"),
            Column::for_programs("output"),
        ];
        let head = [Column::from("contributor")].into_iter();
        let mut table = Table::with_columns(head.chain(shares).chain(yields).chain([relaxed]));
        for r in &self.ranking {
            let percent = |share: f64| Cell::by(share, percent);
            let output = || Cell::from(r.output.as_str());
            table.push([
                Cell::from(r.contributor.as_str()),
                percent(r.share),
                output(),
                percent(r.share),
                output(),
                percent(r.yield_halved),
                percent(r.yield_doubled),
                r.may_be_looser.into(),
            ]);
        }
        table
    }

    /// Table of the contributors' shares in the builds' variance at the design position, with the remainder that is not first
    /// order. It is for studies without bands, which have no ranking. `contributors` has the names in the order of the study.
    pub fn shares_table(&self, contributors: &[String]) -> Table {
        let rest: Vec<&ValueRecord> = self.values.iter().filter(|v| v.at_rest).collect();
        let outputs = rest.iter().map(|v| v.output.clone());
        let mut table = Table::with_columns(["contributor".to_owned()].into_iter().chain(outputs));
        for (number, name) in contributors.iter().enumerate() {
            let shares = rest.iter();
            let shares = shares.map(|v| Cell::by(v.share_of_builds(number), percent));
            table.push_row([Cell::from(name.as_str())].into_iter().chain(shares));
        }
        let left = rest.iter().map(|v| match (v.remainder, v.remainder_error) {
            (Some(left), Some(error)) => {
                Cell::shown(left, format!("{} +- {}", percent(left), percent(error)))
            }
            _ => Cell::from(""),
        });
        table.push_row([Cell::from("remainder")].into_iter().chain(left));
        table
    }

    /// Content of `tolerance.csv`: one row per value. `length` is the symbol of the length unit.
    pub fn csv(&self, length: &str) -> Vec<u8> {
        let mut header = vec!["output".to_owned()];
        header.extend(self.place_columns(length));
        header.extend(
            [
                "builds",
                "nominal",
                "mean",
                "mean_error",
                "sigma",
                "sigma_error",
                "sigma_linear",
                "second_order",
                "linear_holds",
                "remainder",
                "remainder_error",
                "remainder_second_order",
                "min",
            ]
            .map(str::to_owned),
        );
        header.extend(PERCENTILES.map(|p| format!("p{p}")));
        header.push("max".to_owned());
        let rows = self.values.iter().map(|v| {
            let mut row = vec![v.output.clone()];
            row.extend(v.place());
            row.push(v.builds.to_string());
            row.extend([v.nominal, v.mean, v.mean_error, v.sigma, v.sigma_error].map(optional));
            row.extend([v.sigma_linear, v.second_order].map(optional));
            row.push(v.linear_holds.map_or_else(String::new, |h| h.to_string()));
            row.extend([v.remainder, v.remainder_error, v.remainder_second_order].map(optional));
            row.push(optional(v.range[0]));
            row.extend(v.percentiles.map(optional));
            row.push(optional(v.range[1]));
            row
        });
        csv_of_rows(std::iter::once(header).chain(rows))
    }

    /// Content of `contributors.csv`: share of each contributor in the first-order variance of each value and in the variance of
    /// the builds, and the remainder.
    pub fn contributors_csv(&self, contributors: &[String], length: &str) -> Vec<u8> {
        let mut header = vec!["output".to_owned()];
        header.extend(self.place_columns(length));
        header.extend(["contributor", "share", "share_of_builds"].map(str::to_owned));
        let rows = self.values.iter().flat_map(|v| {
            let row = move |name: &str, share, of_builds| {
                let mut row = vec![v.output.clone()];
                row.extend(v.place());
                row.extend([name.to_owned(), optional(share), optional(of_builds)]);
                row
            };
            let names = contributors.iter().enumerate();
            names
                .map(move |(number, name)| row(name, v.shares[number], v.share_of_builds(number)))
                .chain([row("remainder", None, v.remainder)])
        });
        csv_of_rows(std::iter::once(header).chain(rows))
    }
}

/// Share in percent with at most two decimals. A share below 1 is never rounded up to 100 %. Shares above 1 and below 0 occur for
/// shares in the variance of builds, because of sampling errors.
pub(super) fn percent(share: f64) -> String {
    match share {
        s if s < 1.0 && s > 0.9999 => "99.99 %".to_owned(),
        s if s.abs() < 5e-5 => "0 %".to_owned(),
        s => format!("{} %", brief((s * 1e4).round() / 1e2)),
    }
}

/// Names of the columns that give the position of an axle's values. Empty for a study of one wheel.
fn places(problem: &Problem) -> Vec<String> {
    let both = problem.study.axle();
    both.map_or_else(Vec::new, |AxleStudy { axle, plan, .. }| {
        GivenColumns { plan, axle }.names()
    })
}

#[cfg(test)]
mod tests {
    use super::percent;

    /// Shares beyond 0 and 100 % stay as they are. Only a share of 1 is 100 %.
    #[test]
    fn shares_are_not_clipped() {
        for (share, text) in [
            (1.0, "100 %"),
            (0.99999, "99.99 %"),
            (1.031, "103.1 %"),
            (-0.03, "-3 %"),
            (0.123_456, "12.35 %"),
            (0.0, "0 %"),
        ] {
            assert_eq!(percent(share), text);
        }
    }
}
