//! What builds keep to before and after a robust tuning.

use super::bands::in_words;
use super::table::{Cell, Table};
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
    /// Band by band.
    pub bands: Vec<BandShares>,
}

/// A band, and the shares of builds that keep to it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct BandShares {
    /// What it is, in words.
    pub band: String,
    /// Before and after.
    pub shares: [Option<f64>; 2],
}

impl YieldRecord {
    /// Compares the builds of the given design, `before`, with those of the tuned one, `after`.
    pub fn of(
        tolerance: &Tolerance,
        before: Option<MonteCarlo>,
        after: Option<MonteCarlo>,
    ) -> Self {
        let both = [before, after];
        let share = |of: &dyn Fn(&MonteCarlo) -> u64| {
            let share = |found: &MonteCarlo| of(found) as f64 / found.builds as f64;
            [0, 1].map(|k: usize| both[k].as_ref().map(share))
        };
        let bands = tolerance.bands.iter().enumerate();
        let bands = bands.map(|(number, band)| BandShares {
            band: in_words(band),
            shares: share(&|found| found.in_bands[number]),
        });
        YieldRecord {
            builds: tolerance.builds,
            bands: bands.collect(),
            all: share(&|found| found.in_all_bands),
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
        format!(
            "yield {before} -> {after} of {}",
            counted(self.builds, "build")
        )
    }

    /// Band by band.
    pub fn table(&self) -> Table {
        let mut table = Table::new(["band", "before", "after"]);
        for band in &self.bands {
            let [before, after] = band.shares.map(|share| Cell::by(share, percent));
            table.push([Cell::from(band.band.as_str()), before, after]);
        }
        table
    }
}
