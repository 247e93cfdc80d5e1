//! Builds by number: drawn, put together, solved.

use super::Problem;
use crate::build::{Parts, Reject};
use crate::mechanism::DesignFault;
use crate::number::Vector3;
use crate::sweep::{BLOCK, Block, Evaluator};

/// What came of the builds of a block.
pub(super) struct Outcome {
    /// Builds that could not be put together, by place in the block.
    pub(super) rejects: Vec<(usize, Reject)>,
    /// Builds without a pose somewhere in the motion, by place in the block.
    pub(super) incomplete: Vec<usize>,
}

/// Solves blocks of builds. One for each thread.
pub(super) struct Builder<'a> {
    problem: &'a Problem<'a>,
    evaluator: Evaluator<'a>,
    block: Block,
    parts: Parts<f64>,
    draws: Vec<f64>,
    designs: Vec<Vector3<f64>>,
    /// Where in the block each design handed to the evaluator stands.
    places: Vec<usize>,
    /// The values of the builds, build by build and cell by cell; NaN where there is none.
    pub(super) values: Vec<f64>,
}

impl<'a> Builder<'a> {
    pub(super) fn new(problem: &'a Problem<'a>) -> Result<Self, DesignFault> {
        let suspension = problem.assembler.suspension();
        Ok(Builder {
            problem,
            evaluator: Evaluator::new(suspension, &problem.stations, &problem.quantities)?,
            block: Block::new(problem.quantities.len(), problem.stations.count()),
            parts: problem.assembler.drawn().clone(),
            draws: vec![0.0; problem.tolerance.sources()],
            designs: Vec::with_capacity(BLOCK * suspension.design.len()),
            places: Vec::with_capacity(BLOCK),
            values: vec![f64::NAN; BLOCK * problem.cells()],
        })
    }

    /// Draws and solves the builds number `first` and on, up to `count` of them, at most a block.
    pub(super) fn solve(&mut self, first: u64, count: usize) -> Outcome {
        let (problem, assembler) = (self.problem, &self.problem.assembler);
        let mechanism = &assembler.suspension().mechanism;
        let mut rejects = Vec::new();
        self.begin();
        for place in 0..count {
            problem
                .tolerance
                .draw(first + place as u64, &mut self.draws);
            self.parts.points.copy_from_slice(&assembler.drawn().points);
            self.parts
                .lengths
                .copy_from_slice(&assembler.drawn().lengths);
            let sources = problem.tolerance.scatter.iter().flat_map(|c| &c.sources);
            for (source, z) in sources.zip(&self.draws) {
                for (parameter, share) in &source.changes {
                    self.parts.change(mechanism, *parameter, share * z);
                }
            }
            if let Err(reject) = self.put_together(place) {
                rejects.push((place, reject));
            }
        }
        self.finish(count, rejects)
    }

    fn begin(&mut self) {
        self.designs.clear();
        self.places.clear();
    }

    /// Puts the parts together, as a build of this place in the block.
    fn put_together(&mut self, place: usize) -> Result<(), Reject> {
        let assembler = &self.problem.assembler;
        let start = self.designs.len();
        let zero = Vector3::default();
        self.designs.resize(start + self.parts.points.len(), zero);
        let into = &mut self.designs[start..];
        let assembled = match &self.problem.alignment {
            None => assembler.assemble(&self.parts, 0.0, into),
            Some(alignment) => alignment.assemble(assembler, &mut self.parts, into),
        };
        match assembled {
            Ok(()) => self.places.push(place),
            Err(_) => self.designs.truncate(start),
        }
        assembled
    }

    /// Solves what was put together.
    fn finish(&mut self, count: usize, mut rejects: Vec<(usize, Reject)>) -> Outcome {
        self.evaluator.evaluate(&self.designs, &mut self.block);
        let (outputs, stations) = (self.problem.quantities.len(), self.problem.stations.count());
        let cells = outputs * stations;
        self.values[..count * cells].fill(f64::NAN);
        for (number, place) in self.places.iter().enumerate() {
            let values = &mut self.values[place * cells..(place + 1) * cells];
            for output in 0..outputs {
                for station in 0..stations {
                    values[output * stations + station] = self.block.value(number, output, station);
                }
            }
        }
        for (number, fault) in self.block.faults() {
            rejects.push((self.places[*number], Reject::Immovable(fault.clone())));
        }
        let mut incomplete: Vec<usize> = self
            .block
            .failures()
            .iter()
            .map(|failure| self.places[failure.design])
            .collect();
        incomplete.dedup();
        Outcome {
            rejects,
            incomplete,
        }
    }
}

/// The values of builds with given parts, by build and cell.
pub(super) fn values_of(problem: &Problem, builds: &[Parts<f64>]) -> Result<Vec<f64>, DesignFault> {
    let mut builder = Builder::new(problem)?;
    builder.begin();
    for (place, parts) in builds.iter().enumerate() {
        builder.parts.clone_from(parts);
        // A build that cannot be put together is left without values.
        let _ = builder.put_together(place);
    }
    builder.finish(builds.len(), Vec::new());
    builder.values.truncate(builds.len() * problem.cells());
    Ok(builder.values)
}
