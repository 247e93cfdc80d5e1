//! `sweep.json`: the description of a sweep, without its results.
//!
//! Together with the rows and statistics of its parts, it is all that `--resume`, `hardpoint merge` and a page need: the
//! columns, the samples, and the division into parts.

use crate::axle::Coordinate;
use crate::evaluate::BLOCK;
use serde::{Deserialize, Serialize};
use std::ops::Range;

/// The form of the file. A reader takes no other.
pub const FORM: u32 = 2;

/// Blocks in a part. With 128 designs per block, a part is some tenths of a second of work for one core, and a row group of
/// the usual size. It must not depend on the machine, because parts are the same wherever they are computed.
pub const BLOCKS_OF_PART: u64 = 1024;

/// The description of a sweep, without its results.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SweepRecord {
    /// `FORM`.
    pub form: u32,
    /// Version of the program.
    pub version: String,
    /// SHA-256 of everything the results depend on. The number of designs is left out where they are points of a
    /// sequence, since a longer one begins with the shorter.
    pub digest: String,
    /// Name of the study.
    pub study: String,
    /// Name of the topology.
    pub topology: String,
    /// Unit of every length.
    pub length_unit: String,
    /// `grid`, `latin_hypercube`, `sobol`, `random`, `saltelli` or `file`.
    pub method: String,
    /// Seed of the samples.
    pub seed: Option<u32>,
    /// Number of designs.
    pub designs: u64,
    /// Blocks of each part but the last, which may be shorter.
    pub blocks_of_part: u64,
    /// Name and unit of the drive, as in `travel_mm`; `case` for a car, whose stations are its load cases.
    pub drive: String,
    /// Stations each design is solved at.
    pub stations: usize,
    /// The variables.
    pub variables: Vec<VariableRecord>,
    /// The outputs that are kept of each design.
    pub outputs: Vec<OutputColumn>,
    /// The targets that designs are compared with.
    pub targets: Vec<TargetColumn>,
    /// True if the sweep keeps the curves of every design.
    pub curves: bool,
    /// Ending of the files' names: `csv` or `parquet`.
    pub format: String,
}

/// A variable and its column.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct VariableRecord {
    /// Column of the variable.
    pub column: String,
    /// Lowest value.
    pub low: f64,
    /// Highest value.
    pub high: f64,
    /// Number of values in a grid.
    pub steps: Option<u64>,
    /// Value in the study's design.
    pub at_design: f64,
    /// The coordinates it moves.
    pub moves: Vec<MoveRecord>,
}

/// A coordinate that a variable moves.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct MoveRecord {
    /// The hardpoint.
    pub hardpoint: String,
    /// The axis.
    pub axis: String,
    /// Displacement of the coordinate per unit of the variable.
    pub factor: f64,
}

/// Number of an output in a column.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Kind {
    /// Least value over the motion.
    Min,
    /// Largest value over the motion.
    Max,
    /// Value in the design position.
    Design,
    /// Derivative by the drive in the design position.
    Gain,
    /// Value in a load case of a car.
    Case,
    /// Root mean square deviation from a target, in tolerances.
    Rms,
    /// Root of the weighted mean of the squares of all targets' root mean square deviations.
    Misfit,
}

/// A column of results.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct OutputColumn {
    /// Name of the column.
    pub column: String,
    /// The output it is about, as in `camber`.
    pub output: String,
    /// Number of the output in this column.
    pub kind: Kind,
    /// Unit of the column; empty for a plain number.
    pub unit: String,
    /// The value of the study's design, if it has one.
    pub at_design: Option<f64>,
}

/// A target.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TargetColumn {
    /// The column of curves it is about, as in `camber_deg`.
    pub column: String,
    /// Tolerance, in the column's unit.
    pub tolerance: f64,
    /// Weight relative to the other targets.
    pub weight: f64,
    /// Drive values (for an axle, values of the number that the target is over) with the wanted values; empty for a
    /// band.
    pub points: Vec<[f64; 2]>,
}

impl SweepRecord {
    /// Number of designs in a block: [`BLOCK`], or fewer so that no group of Saltelli's samples is divided.
    pub fn block(&self) -> u64 {
        match self.group() {
            Some(group) => BLOCK as u64 / group * group,
            None => BLOCK as u64,
        }
    }

    /// The number of designs in a group of Saltelli's samples; `None` for other methods.
    pub fn group(&self) -> Option<u64> {
        (self.method == "saltelli").then_some(self.variables.len() as u64 + 2)
    }

    /// Topology of a car.
    pub const CAR: &'static str = "car";

    /// Returns true if the designs are of a car.
    pub fn is_of_car(&self) -> bool {
        self.topology == SweepRecord::CAR
    }

    /// Returns true if the designs are of both wheels of an axle.
    pub fn is_of_axle(&self) -> bool {
        let drive = self.drive.rsplit_once('_').map_or("", |(key, _)| key);
        Coordinate::ALL.iter().any(|c| c.key() == drive)
    }

    /// The number of blocks.
    pub fn blocks(&self) -> u64 {
        self.designs.div_ceil(self.block())
    }

    /// The number of parts.
    pub fn parts(&self) -> u64 {
        self.blocks().div_ceil(self.blocks_of_part.max(1))
    }

    /// Numbers of the blocks of a part.
    pub fn blocks_of(&self, part: u64) -> Range<u64> {
        let size = self.blocks_of_part;
        part * size..self.blocks().min((part + 1) * size)
    }

    /// Parts of a shard, from its number (from 1) and the number of shards. There may be none.
    pub fn parts_of(&self, [shard, shards]: [u64; 2]) -> Range<u64> {
        let parts = u128::from(self.parts());
        let up_to = |shard: u64| (parts * u128::from(shard) / u128::from(shards)) as u64;
        up_to(shard - 1)..up_to(shard)
    }

    /// A text that tells this sweep from all others, also from those of fewer designs of the same sequence.
    pub fn run_digest(&self) -> String {
        format!("{}-{}", self.digest, self.designs)
    }

    /// Returns true if this sweep has the designs of `other` and further ones of the same sequence.
    pub fn continues(&self, other: &SweepRecord) -> bool {
        let longer = SweepRecord {
            designs: self.designs,
            ..other.clone()
        };
        other.designs < self.designs && longer == *self
    }

    /// The number of designs of a part.
    pub fn designs_of_part(&self, part: u64) -> u64 {
        let blocks = self.blocks_of(part);
        self.designs.min(blocks.end * self.block()) - blocks.start * self.block()
    }

    /// Numbers of the designs of a block.
    pub fn designs_of(&self, block: u64) -> Range<u64> {
        let size = self.block();
        block * size..self.designs.min((block + 1) * size)
    }

    /// The columns of numbers that every row has: the variables, then the outputs.
    pub fn value_columns(&self) -> Vec<String> {
        let variables = self.variables.iter().map(|v| v.column.clone());
        let outputs = self.outputs.iter().map(|o| o.column.clone());
        variables.chain(outputs).collect()
    }

    /// The names of the columns of the designs, in order.
    pub fn columns(&self) -> Vec<String> {
        let unit = self.drive.rsplit('_').next().unwrap_or_default();
        let mut columns = vec!["design".to_owned()];
        columns.extend(self.value_columns());
        columns.push("failed_stations".to_owned());
        columns.push(format!("failed_at_{unit}"));
        columns.push("reason".to_owned());
        columns.push("status".to_owned());
        columns
    }

    /// The name of the file with the rows of a part: that of a sweep of one part is `designs.csv`.
    pub fn rows_name(&self, part: u64) -> String {
        self.part_name("designs", "part", part, &self.format)
    }

    /// The name of the file with the curves of a part.
    pub fn curves_name(&self, part: u64) -> String {
        self.part_name("curves", "curves", part, &self.format)
    }

    /// The name of the file with the statistics of a part.
    pub fn statistics_name(&self, part: u64) -> String {
        self.part_name("designs", "part", part, "json")
    }

    fn part_name(&self, only: &str, one_of_many: &str, part: u64, ending: &str) -> String {
        match self.parts() {
            0 | 1 => format!("{only}.{ending}"),
            _ => format!("{one_of_many}-{part:09}.{ending}"),
        }
    }

    /// Indices of the outputs that are deviations from targets.
    pub fn deviations(&self) -> Vec<usize> {
        self.outputs_of(Kind::Rms).collect()
    }

    /// Index of the misfit among the outputs, if there are targets.
    pub fn misfit(&self) -> Option<usize> {
        self.outputs_of(Kind::Misfit).next()
    }

    fn outputs_of(&self, kind: Kind) -> impl Iterator<Item = usize> {
        let outputs = self.outputs.iter().enumerate();
        outputs.filter(move |(_, o)| o.kind == kind).map(|(k, _)| k)
    }
}
