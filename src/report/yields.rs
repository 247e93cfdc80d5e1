//! Yields before and after a robust tuning: shares of builds (random samples of the manufactured suspension) within the bands
//! (allowed ranges of outputs), as fractions of 1.

use super::bands::in_words;
use super::figure::{with_decimals, with_plus};
use super::table::{Cell, Column, Table};
use super::text::counted;
use super::tolerance_summary::percent;
use crate::optimise::ExpectedYield;
use crate::study::Tolerance;
use crate::tolerance::MonteCarlo;
use serde::{Deserialize, Serialize};

/// Yields before and after a tuning.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct YieldRecord {
    /// Number of builds of each design.
    pub builds: u64,
    /// Share of builds within all bands: for the design before the tuning, and for the tuned design. `None` if the design cannot be
    /// built.
    pub all: [Option<f64>; 2],
    /// Share of builds within all bands, for the optimum of a tuning without scatter. `None` if this design cannot be built or was
    /// not computed.
    #[serde(default)]
    pub plain: Option<f64>,
    /// Share of builds within each single band.
    pub bands: Vec<BandShares>,
    /// For a tuning that maximises the yield: final value of the smooth surrogate of the yield.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub surrogate: Option<Surrogate>,
}

/// Smooth surrogate of a yield at the tuned design.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Surrogate {
    /// Number of builds over which the surrogate (smooth approximation of the yield) is a mean.
    pub builds: usize,
    /// Value of the surrogate.
    pub value: f64,
    /// Surrogate minus the yield after the tuning. `None` if this yield is unknown.
    pub error: Option<f64>,
    /// True if the search found no design with a larger yield than the optimum without scatter. Then that optimum is the
    /// result.
    pub keeps_plain: bool,
}

/// A band (allowed range of an output) with its yields.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct BandShares {
    /// Band in words.
    pub band: String,
    /// Share of builds within the band, before and after the tuning.
    pub shares: [Option<f64>; 2],
    /// Share of builds within the band, for the optimum of a tuning without scatter.
    #[serde(default)]
    pub plain: Option<f64>,
}

impl YieldRecord {
    /// Compares the builds of three designs: `before` is the given design, `plain` the optimum without scatter, and `after` the
    /// tuned design. `None` for a design that cannot be built.
    pub fn of(
        tolerance: &Tolerance,
        before: Option<MonteCarlo>,
        plain: Option<MonteCarlo>,
        after: Option<MonteCarlo>,
        expected: Option<&ExpectedYield>,
    ) -> Self {
        let share = |found: &Option<MonteCarlo>, of: &dyn Fn(&MonteCarlo) -> u64| {
            let found = found.as_ref()?;
            Some(of(found) as f64 / found.builds as f64)
        };
        let shares = |of: &dyn Fn(&MonteCarlo) -> u64| {
            [&before, &after, &plain].map(|found| share(found, of))
        };
        let bands = tolerance.bands.iter().enumerate();
        let bands = bands.map(|(number, band)| {
            let [before, after, plain] = shares(&|found| found.in_bands[number]);
            BandShares {
                band: in_words(band),
                shares: [before, after],
                plain,
            }
        });
        let [before, after, plain] = shares(&|found| found.in_all_bands);
        YieldRecord {
            builds: tolerance.builds,
            bands: bands.collect(),
            all: [before, after],
            plain,
            surrogate: expected.map(|expected| Surrogate {
                builds: expected.builds,
                value: expected.surrogate,
                error: after.map(|after| expected.surrogate - after),
                keeps_plain: expected.keeps_plain,
            }),
        }
    }

    /// Yields of all bands together, before and after, in percent for people.
    pub fn percentages(&self) -> [String; 2] {
        let share = |share: Option<f64>| share.map_or("unknown".to_owned(), percent);
        self.all.map(share)
    }

    /// Yield before and after the tuning in a sentence.
    pub fn headline(&self) -> String {
        let [before, after] = self.percentages();
        let plain = self.plain.map_or(String::new(), |share| {
            format!("; optimum without scatter: {}", percent(share))
        });
        format!(
            "yield {before} -> {after} of {}{plain}",
            counted(self.builds, "build")
        )
    }

    /// Surrogate with its error in a sentence, and the result of the search. `None` unless the tuning maximised the yield.
    pub fn surrogate_in_words(&self) -> Option<String> {
        let surrogate = self.surrogate.as_ref()?;
        let error = surrogate.error.map_or(String::new(), |error| {
            let points = 100.0 * error;
            let points = with_plus(points, with_decimals(points, 1));
            format!(", {points} percentage points relative to the yield")
        });
        let kept = if surrogate.keeps_plain {
            "; the search found no larger yield than the optimum without scatter, which is kept"
        } else {
            ""
        };
        Some(format!(
            "surrogate (smooth approximation of the yield) over {}: {}{error}{kept}",
            counted(surrogate.builds, "build"),
            percent(surrogate.value)
        ))
    }

    /// Remark if the yield of the optimum without scatter is higher by more than a standard error. `None` for a tuning that
    /// maximised the yield.
    pub fn remark(&self) -> Option<String> {
        if self.surrogate.is_some() {
            return None;
        }
        let (plain, after) = self.plain.zip(self.all[1])?;
        // Standard error of the difference of two shares: sqrt((p (1 - p) + q (1 - q))/n).
        let variance = plain * (1.0 - plain) + after * (1.0 - after);
        let error = (variance / self.builds as f64).sqrt();
        (plain - after > error).then(|| {
            format!(
                "the optimum without scatter has more builds within all bands ({} against {}). The robust \
                 tuning minimises the mean squared misfit, not the number of \
                 builds outside the bands. Choose targets and tolerances that agree with the \
                 bands, or use robust = \"yield\"",
                percent(plain),
                percent(after)
            )
        })
    }

    /// Table of the yields of the single bands, and of all bands together.
    pub fn table(&self) -> Table {
        let columns = ["band", "before", "without scatter", "after"].map(Column::from);
        let mut table = Table::with_columns(columns);
        let mut push = |band: &str, shares: [Option<f64>; 2], plain: Option<f64>| {
            let [before, after] = shares.map(|share| Cell::by(share, percent));
            table.push([Cell::from(band), before, Cell::by(plain, percent), after]);
        };
        for band in &self.bands {
            push(&band.band, band.shares, band.plain);
        }
        push("all", self.all, self.plain);
        table
    }
}
