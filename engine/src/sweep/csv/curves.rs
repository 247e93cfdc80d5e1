//! The curves of every design as CSV: a row for each design and station of the motion.

use super::cells::{append_number, append_whole};
use crate::curves::Status;
use crate::evaluate::Block;
use crate::sweep::SweepPlan;

/// Writer of curves as CSV. It holds the header, and the cells of each row that are the same for all designs.
#[derive(Clone, Debug)]
pub struct CurvesCsv {
    /// Header line of the CSV file.
    pub header: Vec<u8>,
    /// For each station of the motion: its index in a block, and the cells with its coordinates.
    stations: Vec<(usize, Vec<u8>)>,
    factors: Vec<f64>,
    stations_of_block: usize,
}

impl CurvesCsv {
    /// Makes the writer for a sweep. `places` names the columns for the coordinates of the motion. `stations` holds the index
    /// of each station in a block and the values of these columns.
    pub fn of(plan: &SweepPlan, places: Vec<String>, stations: Vec<(usize, Vec<f64>)>) -> Self {
        let mut names = vec!["design".to_owned()];
        names.extend(places);
        names.extend(plan.values().iter().map(|c| c.name.clone()));
        names.push("status".to_owned());
        let cells = |(number, values): (usize, Vec<f64>)| {
            let mut cells = Vec::new();
            for value in values {
                cells.push(b',');
                append_number(value + 0.0, &mut cells);
            }
            (number, cells)
        };
        CurvesCsv {
            header: (names.join(",") + "\n").into_bytes(),
            stations: stations.into_iter().map(cells).collect(),
            factors: plan.values().iter().map(|c| c.factor()).collect(),
            stations_of_block: plan.stations().count(),
        }
    }

    /// Appends the curves of a block. `first` is the number of its first design.
    pub fn append(&self, first: u64, block: &Block, to: &mut Vec<u8>) {
        let mut words: Vec<&'static str> = Vec::new();
        for design in 0..block.designs() {
            let degenerate = block.faults().iter().any(|(d, _)| *d == design);
            words.clear();
            words.resize(
                self.stations_of_block,
                if degenerate { "degenerate" } else { "ok" },
            );
            let failures = block.failures();
            let from = failures.partition_point(|f| f.design < design);
            for failed in failures[from..].iter().take_while(|f| f.design == design) {
                words[failed.station] = Status::Failed(failed.failure).word();
            }
            for (station, cells) in &self.stations {
                append_whole(first + design as u64, to);
                to.extend_from_slice(cells);
                for (k, factor) in self.factors.iter().enumerate() {
                    to.push(b',');
                    append_number(block.value(design, k, *station) * factor + 0.0, to);
                }
                to.push(b',');
                to.extend_from_slice(words[*station].as_bytes());
                to.push(b'\n');
            }
        }
    }
}
