//! Shares of builds within the bands, before and after a robust tuning.

use super::bands::in_words;
use super::table::{Cell, Column, Table};
use super::text::counted;
use super::tolerance_summary::percent;
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
}

/// A band, and the shares of builds that keep to it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct BandShares {
    /// The band in words.
    pub band: String,
    /// Before and after.
    pub shares: [Option<f64>; 2],
    /// The share of the optimum without scatter.
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

    /// A remark if the optimum without scatter has a higher yield, by more than chance allows.
    pub fn remark(&self) -> Option<String> {
        let (plain, after) = self.plain.zip(self.all[1])?;
        // Standard error of the difference of two shares: sqrt((p (1 - p) + q (1 - q))/n).
        let variance = plain * (1.0 - plain) + after * (1.0 - after);
        let error = (variance / self.builds as f64).sqrt();
        (plain - after > error).then(|| {
            format!(
                "the optimum without scatter keeps more builds in all bands ({} against {}): the robust tuning lowers the \
                 mean squared misfit, not the number of builds outside of bands. Bring targets and tolerances in line with \
                 the bands, or tune without scatter",
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
