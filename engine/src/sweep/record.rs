//! Description of a sweep without its results: `sweep.json`.
//!
//! It lists the columns, the samples, and the division into parts. `--resume`, `hardpoint merge` and the results page need
//! only this file and the rows and statistics of the parts.

use crate::axle::Coordinate;
use crate::evaluate::BLOCK;
use serde::{Deserialize, Serialize};
use std::ops::Range;

/// Version of the file's format. The program reads only files of this version.
pub const FORM: u32 = 2;

/// Number of blocks in a part of a sweep of wheels or axles. With 128 designs per block, one core needs some tenths of a
/// second for a part. A part is also a Parquet row group of usual size. The number must not depend on the machine,
/// because parts must be identical on all machines.
pub const BLOCKS_OF_PART: u64 = 1024;

/// Number of blocks in a part of a sweep of cars. With 16 designs per block and some milliseconds per design, one core needs a
/// few seconds for a part.
pub(super) const CAR_BLOCKS_OF_PART: u64 = 64;
/// Number of blocks in a part of a sweep of elastic designs, if the stations of targets or constraints are not stations of
/// the sweep. Such a design takes up to 10 milliseconds, so one core needs some seconds for a part.
pub(super) const ELASTIC_BLOCKS_OF_PART: u64 = 8;

/// Number of designs in a block of cars, which have no SIMD lanes.
const CAR_BLOCK: u64 = 16;

/// Description of a sweep without its results.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SweepRecord {
    /// Version of the format: `FORM`.
    pub form: u32,
    /// Version of the program.
    pub version: String,
    /// SHA-256 digest of everything that determines the results. For a sequence of samples, the digest does not cover the
    /// number of designs, because a longer sequence begins with the points of a shorter sequence.
    pub digest: String,
    /// Name of the study.
    pub study: String,
    /// Name of the suspension's topology; `car` for a car.
    pub topology: String,
    /// Unit of every length in the study.
    pub length_unit: String,
    /// Method of sampling: `grid`, `latin_hypercube`, `sobol`, `random`, `saltelli` or `file`.
    pub method: String,
    /// Seed of the samples.
    pub seed: Option<u32>,
    /// Number of designs in the sweep.
    pub designs: u64,
    /// Number of blocks of each part except the last, which may be shorter.
    pub blocks_of_part: u64,
    /// Name and unit of the drive, for example `travel_mm`. `case` for a car, whose stations are its load cases.
    pub drive: String,
    /// Number of stations of each design.
    pub stations: usize,
    /// Variables of the sweep.
    pub variables: Vec<VariableRecord>,
    /// Outputs of each design in the results.
    pub outputs: Vec<OutputColumn>,
    /// Targets with which designs are compared.
    pub targets: Vec<TargetColumn>,
    /// True if the study is a fit (`fit = true`). Its targets are measurements, so they do not rank the designs.
    #[serde(default)]
    pub is_fit: bool,
    /// Names of the constraints of `[optimise]` that the sweep does not evaluate, because of `constraints = false`.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub unchecked_constraints: Vec<String>,
    /// True if the sweep keeps the curves of every design.
    pub curves: bool,
    /// Extension of the files' names: `csv` or `parquet`.
    pub format: String,
}

/// A variable and its column.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct VariableRecord {
    /// Name of the variable's column.
    pub column: String,
    /// Lowest value of the variable in the sweep.
    pub low: f64,
    /// Highest value of the variable in the sweep.
    pub high: f64,
    /// Number of values of the variable in a grid. `None` for other methods of sampling.
    pub steps: Option<u64>,
    /// Value of the variable in the study's design. `None` if the design has no single value, for example for a
    /// coordinate that several hardpoints share.
    pub at_design: Option<f64>,
    /// Coordinates that the variable moves.
    pub moves: Vec<MoveRecord>,
}

/// Coordinate of a hardpoint that a variable moves.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct MoveRecord {
    /// Name of the hardpoint.
    pub hardpoint: String,
    /// Name of the coordinate's axis.
    pub axis: String,
    /// Displacement of the coordinate per unit of the variable.
    pub factor: f64,
}

/// Kind of number in a column.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Kind {
    /// Smallest value of the output over the motion.
    Min,
    /// Largest value of the output over the motion.
    Max,
    /// Value of the output in the design position.
    Design,
    /// Derivative with respect to the drive in the design position.
    Gain,
    /// Value in a load case of a car.
    Case,
    /// Root mean square deviation from a target, divided by the tolerance.
    Rms,
    /// Misfit: root of the weighted mean of the squared [`Rms`](Kind::Rms) of all targets.
    Misfit,
    /// Smallest margin of a constraint. Negative if the design violates the constraint.
    Margin,
}

/// Reason why the columns of a sweep cannot be written.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ColumnFault {
    /// Two columns of the results would have this name.
    #[error("two columns of the results would have the name {0}; give a variable another name")]
    Twice(String),
    /// The results would have no values of the designs.
    #[error(
        "[sweep]: there is nothing to write for each design: name characteristics in [outputs] that have a value in \
         [motion] or in a load case, or give targets in [optimise] without fit = true"
    )]
    Nothing,
}

/// A column of results.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct OutputColumn {
    /// Name of the column.
    pub column: String,
    /// Output of the column, for example `camber`.
    pub output: String,
    /// Kind of number in the column.
    pub kind: Kind,
    /// Unit of the column. Empty for a plain number.
    pub unit: String,
    /// Value of the study's own design. `None` if this value does not exist.
    pub at_design: Option<f64>,
    /// Smallest margin with which a design still satisfies the constraint: zero minus an allowance for rounding errors.
    /// `None` for other outputs, and for a constraint that fixes a value. No sample satisfies such a constraint exactly,
    /// so the ranking ignores it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub least: Option<f64>,
}

impl OutputColumn {
    /// Column without a value of the study's own design.
    pub(super) fn new(column: String, output: &str, kind: Kind, unit: &str) -> Self {
        OutputColumn {
            column,
            output: output.to_owned(),
            kind,
            unit: unit.to_owned(),
            at_design: None,
            least: None,
        }
    }

    /// Columns of the deviations from targets with these names, and of the misfit. Targets with the same name are numbered.
    pub(super) fn of_targets(names: &[String]) -> impl Iterator<Item = Self> {
        let deviation = move |(k, name): (usize, &String)| {
            let earlier = names[..k].iter().filter(|other| *other == name);
            let column = match earlier.count() {
                0 => format!("rms_{name}"),
                n => format!("rms_{name}_{}", n + 1),
            };
            OutputColumn::new(column, name, Kind::Rms, "")
        };
        let misfit = || OutputColumn::new("misfit".to_owned(), "misfit", Kind::Misfit, "");
        let misfit = (!names.is_empty()).then(misfit);
        names.iter().enumerate().map(deviation).chain(misfit)
    }
}

/// A target with which designs are compared.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TargetColumn {
    /// Column of the curves to which the target applies, for example `camber_deg`.
    pub column: String,
    /// Tolerance, in the column's unit.
    pub tolerance: f64,
    /// Weight relative to the other targets.
    pub weight: f64,
    /// Pairs of drive value and target value. On an axle, the first number is a value of the coordinate that the target
    /// varies. Empty for a band, for a rig of a car, and for stations that the page does not show.
    pub points: Vec<[f64; 2]>,
}

impl SweepRecord {
    /// Number of designs in a block: [`BLOCK`], or 16 cars. For Saltelli's samples, a multiple of the size of a group,
    /// because a group is never divided between blocks.
    pub fn block(&self) -> u64 {
        let most = if self.is_of_car() {
            CAR_BLOCK
        } else {
            BLOCK as u64
        };
        match self.group() {
            Some(group) => (most / group).max(1) * group,
            None => most,
        }
    }

    /// Number of designs in a group of Saltelli's samples. `None` for other methods.
    pub fn group(&self) -> Option<u64> {
        (self.method == "saltelli").then_some(self.variables.len() as u64 + 2)
    }

    /// Value of `topology` for a car.
    pub const CAR: &'static str = "car";

    /// Returns true if the designs are cars.
    pub fn is_of_car(&self) -> bool {
        self.topology == SweepRecord::CAR
    }

    /// Returns true if the designs are axles with both wheels.
    pub fn is_of_axle(&self) -> bool {
        let drive = self.drive.rsplit_once('_').map_or("", |(key, _)| key);
        Coordinate::ALL.iter().any(|c| c.key() == drive)
    }

    /// Number of blocks in the sweep.
    pub fn blocks(&self) -> u64 {
        self.designs.div_ceil(self.block())
    }

    /// Number of parts of the sweep.
    pub fn parts(&self) -> u64 {
        self.blocks().div_ceil(self.blocks_of_part.max(1))
    }

    /// Numbers of the blocks of a part.
    pub fn blocks_of(&self, part: u64) -> Range<u64> {
        let size = self.blocks_of_part;
        part * size..self.blocks().min((part + 1) * size)
    }

    /// Numbers of the parts of a shard. `shard` counts from 1; `shards` is the number of shards. The range may be empty.
    pub fn parts_of(&self, [shard, shards]: [u64; 2]) -> Range<u64> {
        let parts = u128::from(self.parts());
        let up_to = |shard: u64| (parts * u128::from(shard) / u128::from(shards)) as u64;
        up_to(shard - 1)..up_to(shard)
    }

    /// Text that distinguishes this sweep from all others, including sweeps with fewer designs of the same sequence. It covers
    /// the whole record, because parts belong only to sweeps with an equal record. Only `blocks_of_part` is left out: it
    /// states how the files divide the designs.
    pub fn run_digest(&self) -> String {
        let undivided = SweepRecord {
            designs: 0,
            blocks_of_part: 0,
            ..self.clone()
        };
        let digest = super::digest_of(&format!("{undivided:?}"));
        format!("{digest}-{}", self.designs)
    }

    /// Returns true if this sweep contains the designs of `other`, followed by further designs of the same sequence.
    pub fn continues(&self, other: &SweepRecord) -> bool {
        let longer = SweepRecord {
            designs: self.designs,
            ..other.clone()
        };
        other.designs < self.designs && longer == *self
    }

    /// Number of designs in a part.
    pub fn designs_of_part(&self, part: u64) -> u64 {
        let blocks = self.blocks_of(part);
        self.designs.min(blocks.end * self.block()) - blocks.start * self.block()
    }

    /// Numbers of the designs in a block.
    pub fn designs_of(&self, block: u64) -> Range<u64> {
        let size = self.block();
        block * size..self.designs.min((block + 1) * size)
    }

    /// Columns with numbers in every row: the variables, then the outputs.
    pub fn value_columns(&self) -> Vec<String> {
        let variables = self.variables.iter().map(|v| v.column.clone());
        let outputs = self.outputs.iter().map(|o| o.column.clone());
        variables.chain(outputs).collect()
    }

    /// Checks that there are outputs, and that all columns have different names.
    pub(super) fn check_columns(&self) -> Result<(), ColumnFault> {
        if self.outputs.is_empty() {
            return Err(ColumnFault::Nothing);
        }
        let columns = self.columns();
        let twice = |(i, name): &(usize, &String)| columns[..*i].contains(name);
        match columns.iter().enumerate().find(twice) {
            Some((_, name)) => Err(ColumnFault::Twice(name.clone())),
            None => Ok(()),
        }
    }

    /// Names of the columns of the designs, in order.
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

    /// Name of the file with the rows of a part. If the sweep has only one part, the name is `designs.csv` or `designs.parquet`.
    pub fn rows_name(&self, part: u64) -> String {
        self.part_name("designs", "part", part, &self.format)
    }

    /// Name of the file with the curves of a part.
    pub fn curves_name(&self, part: u64) -> String {
        self.part_name("curves", "curves", part, &self.format)
    }

    /// Name of the file with the statistics of a part.
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

    /// Indices of the outputs that are margins of constraints with limits, each with the smallest margin of a design that
    /// satisfies the constraint.
    pub fn limits(&self) -> Vec<(usize, f64)> {
        let outputs = self.outputs.iter().enumerate();
        outputs.filter_map(|(k, o)| Some((k, o.least?))).collect()
    }

    fn outputs_of(&self, kind: Kind) -> impl Iterator<Item = usize> {
        let outputs = self.outputs.iter().enumerate();
        outputs.filter(move |(_, o)| o.kind == kind).map(|(k, _)| k)
    }
}
