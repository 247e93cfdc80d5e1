//! Builds by number: drawn, put together, solved.

use super::Problem;
use super::lanes::LaneBuilder;
use crate::build::{Parts, Reject};
use crate::mechanism::DesignFault;
use crate::model::Suspension;
use crate::number::{Vector3, Width};
use crate::sweep::{BLOCK, Block, Evaluator};

impl Problem<'_> {
    /// A build by its number: its built design, at rest, as drawn by the seed and aligned where that is asked for.
    pub fn built(&self, number: u64) -> Result<Suspension, Reject> {
        let mut built = self.assembler.suspension().clone();
        let mut draws = vec![0.0; self.tolerance.sources()];
        let mut parts = self.assembler.drawn().clone();
        self.tolerance.draw(number, &mut draws);
        self.change_parts(&draws, &mut parts);
        self.put_together(&mut parts, &mut built.design)?;
        Ok(built)
    }

    /// Makes these the parts of a build, of what was drawn for it.
    fn change_parts(&self, draws: &[f64], parts: &mut Parts<f64>) {
        let assembler = &self.assembler;
        parts.points.copy_from_slice(&assembler.drawn().points);
        parts.lengths.copy_from_slice(&assembler.drawn().lengths);
        let sources = self.tolerance.scatter.iter().flat_map(|c| &c.sources);
        for (source, z) in sources.zip(draws) {
            for (parameter, share) in &source.changes {
                parts.change(&assembler.suspension().mechanism, *parameter, share * z);
            }
        }
    }

    /// Puts parts together and writes their built design.
    fn put_together(
        &self,
        parts: &mut Parts<f64>,
        into: &mut [Vector3<f64>],
    ) -> Result<(), Reject> {
        match &self.alignment {
            None => self.assembler.assemble(parts, 0.0, into),
            Some(alignment) => alignment.assemble(&self.assembler, parts, into),
        }
    }
}

/// What came of the builds of a block.
pub(super) struct Outcome {
    /// Builds that could not be put together, by place in the block.
    pub(super) rejects: Vec<(usize, Reject)>,
    /// How many builds have no pose somewhere in the motion, and the place of the first.
    pub(super) incomplete: (u64, Option<usize>),
}

/// Solves blocks of builds. One for each thread.
///
/// Builds are put together in SIMD lanes; those that do not settle there, and those of rockers near a toggle, one by one.
/// Which of the two depends on the build alone.
pub(super) struct Builder<'a> {
    problem: &'a Problem<'a>,
    lanes: Option<LaneBuilder<'a>>,
    evaluator: Evaluator<'a>,
    /// The values of the builds that go together, in the order of their numbers.
    pub(super) block: Block,
    parts: Parts<f64>,
    draws: Vec<f64>,
    designs: Vec<Vector3<f64>>,
    /// Where in the block each of these designs stands.
    places: Vec<usize>,
}

impl<'a> Builder<'a> {
    /// In lanes of a width, or one by one alone.
    pub(super) fn new(problem: &'a Problem<'a>, width: Option<Width>) -> Result<Self, DesignFault> {
        let suspension = problem.assembler.suspension();
        let (stations, quantities) = (&problem.stations, &problem.quantities);
        Ok(Builder {
            problem,
            lanes: width.map(|width| LaneBuilder::new(problem, width)),
            evaluator: Evaluator::with_width(suspension, stations, quantities, width)?,
            block: Block::new(quantities.len(), stations.count()),
            parts: problem.assembler.drawn().clone(),
            draws: vec![0.0; problem.tolerance.sources()],
            designs: Vec::with_capacity(BLOCK * suspension.design.len()),
            places: Vec::with_capacity(BLOCK),
        })
    }

    /// Draws and solves the builds number `first` and on, up to `count` of them, at most a block.
    pub(super) fn solve(&mut self, first: u64, count: usize) -> Outcome {
        let tolerance = self.problem.tolerance;
        let points = self.parts.points.len();
        if let Some(lanes) = &mut self.lanes {
            tolerance.draw_block(first, count, &mut lanes.draws);
            lanes.assemble(count);
        }
        let mut rejects = Vec::new();
        self.begin();
        for place in 0..count {
            if let Some(lanes) = &self.lanes
                && lanes.right[place]
            {
                let design = &lanes.designs[place * points..(place + 1) * points];
                self.designs.extend_from_slice(design);
                self.places.push(place);
                continue;
            }
            tolerance.draw(first + place as u64, &mut self.draws);
            self.problem.change_parts(&self.draws, &mut self.parts);
            if let Err(reject) = self.put_together(place) {
                rejects.push((place, reject));
            }
        }
        self.finish(rejects)
    }

    fn begin(&mut self) {
        self.designs.clear();
        self.places.clear();
    }

    /// Puts the parts together, as a build of this place in the block.
    fn put_together(&mut self, place: usize) -> Result<(), Reject> {
        let start = self.designs.len();
        let zero = Vector3::default();
        self.designs.resize(start + self.parts.points.len(), zero);
        let into = &mut self.designs[start..];
        let assembled = self.problem.put_together(&mut self.parts, into);
        match assembled {
            Ok(()) => self.places.push(place),
            Err(_) => self.designs.truncate(start),
        }
        assembled
    }

    /// Solves what was put together.
    fn finish(&mut self, mut rejects: Vec<(usize, Reject)>) -> Outcome {
        self.evaluator.evaluate(&self.designs, &mut self.block);
        for (number, fault) in self.block.faults() {
            rejects.push((self.places[*number], Reject::Immovable(fault.clone())));
        }
        let failures = self.block.failures().iter();
        let mut incomplete: Vec<usize> = failures.map(|failure| failure.design).collect();
        incomplete.dedup();
        Outcome {
            rejects,
            incomplete: (
                incomplete.len() as u64,
                incomplete.iter().map(|design| self.places[*design]).min(),
            ),
        }
    }
}

/// The values of the suspension as drawn, by cell.
pub(super) fn drawn_values(problem: &Problem) -> Result<Vec<f64>, DesignFault> {
    let mut builder = Builder::new(problem, None)?;
    // A drawing that cannot be put together is left without values.
    if builder.put_together(0).is_err() {
        return Ok(vec![f64::NAN; problem.cells()]);
    }
    builder.finish(Vec::new());
    let outputs = 0..problem.quantities.len();
    let values = outputs.flat_map(|output| builder.block.values(0, output));
    Ok(values.collect())
}

#[cfg(test)]
mod tests;
