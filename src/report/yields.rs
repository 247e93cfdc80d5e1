//! Shares of builds within the bands, before and after a robust tuning.

use super::bands::in_words;
use super::table::{Cell, Column, Table};
use super::text::counted;
use super::tolerance_summary::percent;
use crate::optimise::ExpectedYield;
use crate::study::Tolerance;
use crate::tolerance::MonteCarlo;
use serde::{Deserialize, Serialize};

/// Shares of builds before and after.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct YieldRecord {
    /// Number of builds.
    pub builds: u64,
    /// The share that keeps to every band: of the design given and of the tuned one; none where it cannot be built.
    pub all: [Option<f64>; 2],
    /// The same share of the optimum without scatter.
    #[serde(default)]
    pub plain: Option<f64>,
    /// Band by band.
    pub bands: Vec<BandShares>,
    /// For a tuning towards the yield, the builds that it raised the surrogate over, and the surrogate at its end.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub surrogate: Option<Surrogate>,
}

/// The smooth surrogate of a yield at the tuned design.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Surrogate {
    /// Number of builds that it is a mean over.
    pub builds: usize,
    /// The surrogate.
    pub value: f64,
    /// The surrogate minus the yield of builds that the tuning has not seen.
    pub error: Option<f64>,
    /// True if no design found has a larger yield than the optimum without scatter. That optimum is then the result.
    pub keeps_plain: bool,
}

/// A band, and the shares of builds that keep to it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct BandShares {
    /// The band in words.
    pub band: String,
    /// Before and after.
    pub shares: [Option<f64>; 2],
    /// Share of the builds within all bands, at the optimum without scatter.
    #[serde(default)]
    pub plain: Option<f64>,
}

impl YieldRecord {
    /// Compares the builds of the given design, `before`, with those of the optimum without scatter, `plain`, and of the
    /// tuned design, `after`.
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

    /// The shares of builds that keep to every band, for reading.
    pub fn percentages(&self) -> [String; 2] {
        let share = |share: Option<f64>| share.map_or("unknown".to_owned(), percent);
        self.all.map(share)
    }

    /// The outcome in a sentence.
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

    /// The surrogate and its error in a sentence, and whether the search found anything; for a tuning towards the yield.
    pub fn surrogate_in_words(&self) -> Option<String> {
        let surrogate = self.surrogate.as_ref()?;
        let error = surrogate.error.map_or(String::new(), |error| {
            format!(", {:+.1} points from the yield", 100.0 * error)
        });
        let kept = match surrogate.keeps_plain {
            true => {
                "; the search found no larger yield than that of the optimum without scatter, which is kept"
            }
            false => "",
        };
        Some(format!(
            "smooth surrogate of the yield over {}: {}{error}{kept}",
            counted(surrogate.builds, "build"),
            percent(surrogate.value)
        ))
    }

    /// A remark if the optimum without scatter has a higher yield, by more than chance allows.
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
                "the optimum without scatter keeps more builds in all bands ({} against {}): the robust tuning lowers the \
                 mean squared misfit, not the number of builds outside of bands. Bring targets and tolerances in line with \
                 the bands, or ask for robust = \"yield\"",
                percent(plain),
                percent(after)
            )
        })
    }

    /// Band by band.
    pub fn table(&self) -> Table {
        let columns = ["band", "before", "without scatter", "after"].map(Column::from);
        let mut table = Table::with_columns(columns);
        for band in &self.bands {
            let [before, after] = band.shares.map(|share| Cell::by(share, percent));
            let plain = Cell::by(band.plain, percent);
            table.push([Cell::from(band.band.as_str()), before, plain, after]);
        }
        table
    }
}
