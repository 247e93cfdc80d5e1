//! Scatter of a car's results over its builds (random samples of the manufactured car): `tolerance.csv`, `contributors.csv`,
//! `summary.json` and tables.

use crate::report::bands::nominal_outside;
use crate::report::figure::{as_written, finite};
use crate::report::files::csv_of_rows;
use crate::report::table::{Cell, Column, Table};
use crate::report::text::counted;
use crate::report::tolerance_summary::{LinearResult, percent};
use crate::report::{figure, optional};
use crate::study::CarStudy;
use crate::tolerance::{CarBuilds, CarExpansion, CarProblem, PERCENTILES};
use serde::Serialize;

/// Results of `hardpoint tolerance` for a car.
#[derive(Clone, Debug, Serialize)]
pub struct CarToleranceSummary {
    command: &'static str,
    study: String,
    builds: u64,
    seed: u32,
    /// Number of builds that cannot be assembled, or have no equilibrium in some load case.
    failed: u64,
    /// Number of the first failed build.
    first_failed: Option<u64>,
    /// Reason why build `first_failed` failed.
    reason: Option<String>,
    /// Names of the contributors (scattering parts), in the order of the study.
    contributors: Vec<String>,
    values: Vec<CarValue>,
    bands: Vec<CarBandRecord>,
    /// Sentences about the bands that the nominal design misses.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub nominal_outside: Vec<String>,
    /// Fraction of the builds within all bands. `None` without bands.
    yield_of_all: Option<f64>,
}

/// Scatter of a result in a load case, as printed numbers.
#[derive(Clone, Debug, Serialize)]
struct CarValue {
    output: String,
    case: String,
    unit: String,
    /// Number of builds that have the value.
    builds: u64,
    nominal: Option<f64>,
    mean: Option<f64>,
    mean_error: Option<f64>,
    sigma: Option<f64>,
    sigma_error: Option<f64>,
    /// Standard deviation according to the first-order estimate.
    sigma_linear: Option<f64>,
    /// Second-order term, as a fraction of the first-order variance.
    second_order: Option<f64>,
    /// True if the first-order estimate is accurate enough, according to the second-order estimate and the builds.
    linear_holds: Option<bool>,
    /// Fraction of the builds' variance that is not first order: curvature, interaction and sampling error. It may be negative.
    remainder: Option<f64>,
    /// Standard error of `remainder`.
    remainder_error: Option<f64>,
    /// Estimate of `remainder` from second-order derivatives.
    remainder_second_order: Option<f64>,
    percentiles: [Option<f64>; PERCENTILES.len()],
    range: [Option<f64>; 2],
    /// Share of each contributor in the first-order variance of the result. `None` if the result does not scatter.
    shares: Vec<Option<f64>>,
    /// False if the result differs between the builds only by rounding errors.
    scatters: bool,
    /// True if a band (allowed range) applies to the result.
    has_band: bool,
}

/// A band (allowed range of a result) with its yield (fraction of the builds within the band).
#[derive(Clone, Debug, Serialize)]
struct CarBandRecord {
    output: String,
    case: String,
    /// Lowest allowed value. `None` without a lower limit.
    low: Option<f64>,
    /// Highest allowed value. `None` without an upper limit.
    high: Option<f64>,
    /// Fraction of the builds within the band.
    kept: f64,
}

/// Sentences about the bands of a car that its nominal design misses. Empty without tolerances, and if the nominal design cannot be
/// solved.
pub fn car_study_bands_missed(study: &CarStudy) -> Vec<String> {
    let missed = || {
        let with_bands = study.tolerance.as_ref().filter(|t| !t.bands.is_empty());
        let problem = CarProblem::of(study, with_bands?).ok()?;
        let nominal = problem.nominal().ok()?;
        Some(car_bands_missed(&problem, &nominal))
    };
    missed().unwrap_or_default()
}

/// Sentences about the bands that the nominal design of a car misses. `nominal` has all nominal results.
fn car_bands_missed(problem: &CarProblem<'_>, nominal: &[f64]) -> Vec<String> {
    let study = problem.study;
    let length = study.car.length_unit;
    let missed = problem.bands_missed(nominal).into_iter();
    let words = missed.map(|(number, value)| {
        let band = &problem.tolerance.bands[number];
        let column = band.quantity.column(length);
        let limits = match band.between.map(f64::is_finite) {
            [true, true] => band.between.map(as_written).join(" to "),
            [true, false] => format!("at least {}", as_written(band.between[0])),
            _ => format!("at most {}", as_written(band.between[1])),
        };
        let band = format!("{column} in case {}: {limits}", study.cases[band.case].name);
        let unit = problem.tolerance.bands[number].quantity.info().unit;
        let value = if value.is_finite() {
            figure(value, &unit.suffix(length))
        } else {
            "missing".to_owned()
        };
        nominal_outside(&band, &value)
    });
    words.collect()
}

impl CarToleranceSummary {
    /// Summarises the first-order estimate and the builds. `nominal` has all results of the nominal design, in printed units.
    pub fn of(
        problem: &CarProblem<'_>,
        nominal: &[f64],
        expansion: &[CarExpansion],
        builds: &CarBuilds,
    ) -> Self {
        let (study, tolerance) = (problem.study, problem.tolerance);
        let length = study.car.length_unit;
        let column = |case: usize, quantity: crate::car::CarQuantity| {
            (quantity.column(length), study.cases[case].name.clone())
        };
        let results = problem.request.results.iter().enumerate();
        let values = results.map(|(k, result)| {
            let (spread, first) = (&builds.spreads[k], &expansion[k]);
            let (output, case) = column(result.case, result.quantity);
            let unit = result.quantity.info().unit.suffix(length);
            let scatters = first.scatters;
            let remainder = first.estimate.remainder(spread);
            let of_scatter = |part: f64| finite(part).filter(|_| scatters);
            let contributors = 0..tolerance.contributors.len();
            CarValue {
                output,
                case,
                unit,
                builds: spread.count,
                nominal: finite(nominal[k]),
                mean: finite(spread.mean),
                mean_error: finite(spread.sigma / (spread.count as f64).sqrt()),
                sigma: finite(spread.sigma),
                sigma_error: finite(spread.sigma_error),
                sigma_linear: finite(first.sigma()),
                second_order: of_scatter(first.estimate.bend()),
                linear_holds: first.holds(spread),
                remainder: of_scatter(remainder.part),
                remainder_error: of_scatter(remainder.error),
                remainder_second_order: of_scatter(remainder.second),
                percentiles: spread.percentiles.map(finite),
                range: spread.range.map(finite),
                shares: contributors
                    .map(|c| finite(first.share(c)).filter(|_| scatters))
                    .collect(),
                scatters,
                has_band: tolerance
                    .bands
                    .iter()
                    .any(|band| (band.case, band.quantity) == (result.case, result.quantity)),
            }
        });
        let share = |count: u64| count as f64 / builds.builds as f64;
        let bands = tolerance.bands.iter().zip(&builds.in_bands);
        let bands = bands.map(|(band, kept)| {
            let (output, case) = column(band.case, band.quantity);
            CarBandRecord {
                output,
                case,
                low: finite(band.between[0]),
                high: finite(band.between[1]),
                kept: share(*kept),
            }
        });
        let first = builds.first_failed.as_ref();
        CarToleranceSummary {
            command: "tolerance",
            study: study.name.clone(),
            builds: builds.builds,
            seed: tolerance.seed,
            failed: builds.failed,
            first_failed: first.map(|(number, _)| *number),
            reason: first.map(|(_, reason)| reason.clone()),
            contributors: tolerance
                .contributors
                .iter()
                .map(|contributor| contributor.name().to_owned())
                .collect(),
            values: values.collect(),
            bands: bands.collect(),
            nominal_outside: car_bands_missed(problem, nominal),
            yield_of_all: (!tolerance.bands.is_empty()).then(|| share(builds.in_all_bands)),
        }
    }

    /// Line that describes the tolerance analysis.
    pub fn headline(&self) -> String {
        let mut line = counted(self.builds, "build");
        if let Some(kept) = self.yield_of_all {
            line += &format!(", {} in all bands", percent(kept));
        }
        line
    }

    /// Sentence about failed builds. `None` if no build failed.
    pub fn failure(&self) -> Option<String> {
        let (first, reason) = (self.first_failed?, self.reason.as_ref()?);
        let builds = counted(self.failed, "build");
        Some(format!(
            "{builds} without a solution in at least one case, first build {first}: {reason}"
        ))
    }

    /// Table of the results that have bands. If there are no bands, the table has all results that scatter.
    pub fn values_table(&self) -> Table {
        let numbers = ["mean", "sigma", "linear", "p5", "p95", "linear holds"].map(Column::from);
        let head = [
            Column::from("output"),
            "case".into(),
            Column::from("nominal"),
        ];
        let because = Column::for_programs("because");
        let columns = head.into_iter().chain(numbers).chain([because]);
        let mut table = Table::with_columns(columns).keyed(2);
        let has_bands = !self.bands.is_empty();
        for value in &self.values {
            let is_shown = if has_bands {
                value.has_band
            } else {
                value.scatters
            };
            if !is_shown {
                continue;
            }
            let numbers = [
                value.nominal,
                value.mean,
                value.sigma,
                value.sigma_linear,
                value.percentiles[2],
                value.percentiles[4],
            ];
            let linear = LinearResult {
                holds: value.linear_holds,
                second_order: value.second_order,
                has_nominal: value.nominal.is_some(),
                builds: value.builds,
                scatters: value.scatters,
            };
            let figure = |v: Option<f64>| Cell::from(v.map(|v| Cell::figure(v, &value.unit)));
            let head = [value.output.as_str().into(), value.case.as_str().into()];
            let cells = head.into_iter().chain(numbers.map(figure));
            let holds = Cell::in_words(linear.holds, linear.in_words());
            table.push_row(cells.chain([holds, linear.because().into()]));
        }
        table
    }

    /// Table of the bands with their yields.
    pub fn bands_table(&self) -> Table {
        let mut table = Table::new(["output", "case", "at least", "at most", "yield"]);
        for band in &self.bands {
            table.push_row([
                Cell::from(band.output.as_str()),
                band.case.as_str().into(),
                band.low.into(),
                band.high.into(),
                Cell::by(band.kept, percent),
            ]);
        }
        if let Some(kept) = self.yield_of_all {
            let rest = [Cell::from(""), "".into(), "".into()];
            let all = [Cell::from("all")].into_iter().chain(rest);
            table.push_row(all.chain([Cell::by(kept, percent)]));
        }
        table
    }

    /// Table of contributors, ranked by their largest share in the variance of a result. If there are bands, only results with
    /// bands are used.
    pub fn ranking_table(&self) -> Table {
        let has_bands = !self.bands.is_empty();
        let values = || {
            self.values
                .iter()
                .filter(|value| value.has_band || !has_bands)
        };
        let mut ranked: Vec<(f64, &str, &CarValue)> = Vec::new();
        for (number, name) in self.contributors.iter().enumerate() {
            let shares = values().filter_map(|value| Some((value.shares[number]?, value)));
            let most = shares.max_by(|a, b| a.0.total_cmp(&b.0));
            ranked.extend(most.map(|(share, value)| (share, name.as_str(), value)));
        }
        ranked.sort_by(|a, b| b.0.total_cmp(&a.0));
        let mut table = Table::new(["contributor", "largest share", "output", "case"]);
        for (share, name, value) in ranked {
            table.push_row([
                Cell::from(name),
                Cell::by(share, percent),
                value.output.as_str().into(),
                value.case.as_str().into(),
            ]);
        }
        table
    }

    /// Content of `tolerance.csv`: one row for each result of each load case.
    pub fn csv(&self) -> Vec<u8> {
        let columns = [
            "output",
            "case",
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
        ];
        let mut header: Vec<String> = columns.map(str::to_owned).to_vec();
        header.extend(PERCENTILES.map(|p| format!("p{p}")));
        header.push("max".to_owned());
        let rows = self.values.iter().map(|v| {
            let mut row = vec![v.output.clone(), v.case.clone(), v.builds.to_string()];
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

    /// Content of `contributors.csv`: share of each contributor in the first-order variance of each result.
    pub fn contributors_csv(&self) -> Vec<u8> {
        let header = ["output", "case", "contributor", "share"].map(str::to_owned);
        let rows = self.values.iter().flat_map(|v| {
            let names = self.contributors.iter().zip(&v.shares);
            names.map(|(name, share)| {
                let share = optional(*share);
                vec![v.output.clone(), v.case.clone(), name.clone(), share]
            })
        });
        csv_of_rows(std::iter::once(header.to_vec()).chain(rows))
    }
}
