//! Random numbers, assembly and solution of builds (vehicles with scattering parts). A build is given by its number.

use super::lanes::LaneBuilder;
use super::wheel_assembler::WheelAssembler;
use super::{Problem, elastic};
use crate::assembly::{AssemblyError, Parts, TensionInput, Tensions};
use crate::evaluate::{BLOCK, Block, Evaluator, NotInLanes};
use crate::mechanism::DesignFault;
use crate::model::{Side, Suspension};
use crate::number::{Vector3, Width};
use crate::study::Vehicle;

impl Problem<'_> {
    /// Reason why no build is solved in SIMD lanes (several builds at once). `None` if lanes are in use, or if the design cannot
    /// be solved.
    pub fn not_in_lanes(&self) -> Option<NotInLanes> {
        let builder = Builder::new(self, Width::widest()).ok()?;
        builder.evaluator.not_in_lanes()
    }

    /// Values of the nominal suspension, for each cell (an output at a station).
    pub fn drawn(&self) -> Result<Vec<f64>, DesignFault> {
        let mut builder = Builder::new(self, None)?;
        // With all random numbers 0, the build is the nominal design. A nominal design that cannot be assembled has no
        // values.
        if builder.build(0).is_err() {
            return Ok(vec![f64::NAN; self.cells()]);
        }
        builder.finish(0, Vec::new());
        let outputs = 0..self.outputs().len();
        let values = outputs.flat_map(|output| builder.block.values(0, output));
        Ok(values.collect())
    }

    /// Build with this number: its design in the static position, from the random numbers of the seed. The build is aligned
    /// if the study requests alignment. For an axle, returns the left wheel.
    pub fn built(&self, number: u64) -> Result<Suspension, AssemblyError> {
        let built = self.built_wheels(number).map_err(|(_, reject)| reject);
        built.map(|mut wheels| wheels.swap_remove(0))
    }

    /// Study of the build with this number, as text: its design in the static position, and the rates (stiffnesses) of its elastic
    /// parts. An error names the wheel that cannot be assembled.
    pub fn built_text(&self, number: u64) -> Result<String, (Option<Side>, AssemblyError)> {
        let (built, tensions) = self.built_parts(number)?;
        let text = match &built[..] {
            [left, right] => self.study.with_built_axle([left, right]),
            built => self.study.with_built(&built[0]),
        };
        let mut moved = self.study.clone();
        self.set_rates(number, &tensions, &mut moved.vehicle);
        Ok(self.study.as_written().with_rates_of(text, &moved))
    }

    /// The vehicle of the build with this number: its wheels in the static position, and the rates (stiffnesses) of its elastic
    /// parts. An error names the wheel that cannot be assembled.
    pub fn built_vehicle(&self, number: u64) -> Result<Vehicle, (Option<Side>, AssemblyError)> {
        let (wheels, tensions) = self.built_parts(number)?;
        let mut wheels = wheels.into_iter();
        let mut built = self.study.vehicle.clone();
        if let Some(left) = wheels.next() {
            match &mut built {
                Vehicle::Wheel(own) => own.suspension = left,
                Vehicle::Axle(both) => both.axle = both.axle.with_wheels(left, wheels.next()),
            }
        }
        self.set_rates(number, &tensions, &mut built);
        Ok(built)
    }

    /// Sets the rates (stiffnesses) of the elastic parts of the build with this number, and the tensions of its links.
    fn set_rates(&self, number: u64, tensions: &Tensions, vehicle: &mut Vehicle) {
        let mut draws = vec![0.0; self.tolerance.sources()];
        self.tolerance.draw(number, &mut draws);
        let mut rates = Vec::new();
        elastic::append_rates(self.tolerance, &draws, &mut rates);
        for ((parameter, _), value) in elastic::rates(self.tolerance).zip(rates) {
            vehicle.set_rate(parameter, value);
        }
        if let Vehicle::Axle(both) = vehicle {
            both.axle.add_tensions(tensions);
        }
    }

    /// Returns all wheels of the build with this number. For an axle, these are the left and the right wheel, each in the
    /// frame of a left wheel. An error names the wheel that cannot be assembled.
    pub fn built_wheels(
        &self,
        number: u64,
    ) -> Result<Vec<Suspension>, (Option<Side>, AssemblyError)> {
        Ok(self.built_parts(number)?.0)
    }

    /// All wheels of a build, and the tensions that deviations of the parts cause in the links of an axle with extra links.
    fn built_parts(
        &self,
        number: u64,
    ) -> Result<(Vec<Suspension>, Tensions), (Option<Side>, AssemblyError)> {
        let mut draws = vec![0.0; self.tolerance.sources()];
        self.tolerance.draw(number, &mut draws);
        // The tensions are the same for the axle as seen from the left wheel and as seen from the right wheel. The code uses
        // the names of the links in the view from the left wheel.
        let mut tensions = None;
        let wheels = self.wheel_assemblers.iter().map(|wheel_assembler| {
            let mut built = wheel_assembler.assembler.suspension().clone();
            let mut parts = wheel_assembler.assembler.drawn().clone();
            wheel_assembler.change_parts(self.tolerance, &draws, &mut parts);
            let together = wheel_assembler.put_together(&mut parts, &mut built.design);
            let found = together.map_err(|reject| (wheel_assembler.named_side(), reject))?;
            if wheel_assembler.side != Some(Side::Right) {
                tensions = found;
            }
            Ok(built)
        });
        let wheels = wheels.collect::<Result<_, _>>()?;
        Ok((wheels, tensions))
    }
}

/// A build that could not be assembled: its number, its wheel for an axle, and the reason.
pub(super) type Unbuilt = (u64, Option<Side>, AssemblyError);

/// Builds of a block that failed: not assembled, or without all values.
pub(super) struct Outcome {
    pub(super) rejects: Vec<Unbuilt>,
    /// Number of builds without a pose or without values (toggle) at some station, and the number of the first such build.
    pub(super) incomplete: (u64, Option<u64>),
}

/// Solves blocks of builds. Each CPU thread has a separate builder.
///
/// Builds are assembled in SIMD lanes. Builds that do not converge in lanes, builds with rockers near a toggle position, and
/// axles with extra links are assembled one by one. The choice of method depends only on the build.
pub(super) struct Builder<'a> {
    problem: &'a Problem<'a>,
    /// One wheel, or left and right wheel.
    wheels: Vec<WheelBuilder<'a>>,
    evaluator: Evaluator<'a>,
    /// Values of the builds assembled together, in the order of their numbers.
    pub(super) block: Block,
    draws: Vec<f64>,
    /// Random numbers of the block, `[tolerance source][build]`.
    draws_of_block: Vec<f64>,
    /// For each assembled design, its index among the builds of the block.
    places: Vec<usize>,
    /// Rates (stiffnesses) of elastic parts that scatter, design after design.
    rates: Vec<f64>,
}

/// Builds the wheels of one side.
struct WheelBuilder<'a> {
    wheel_assembler: &'a WheelAssembler,
    lanes: Option<LaneBuilder<'a>>,
    parts: Parts<f64>,
    designs: Vec<Vector3<f64>>,
    /// Tensions in the links of the latest build.
    tensions: Tensions,
}

impl<'a> Builder<'a> {
    /// Makes a builder with lanes of this width, or without lanes.
    pub(super) fn new(problem: &'a Problem<'a>, width: Option<Width>) -> Result<Self, DesignFault> {
        let mut evaluator = problem.request.evaluator(width)?;
        evaluator.interrupt = problem.interrupt;
        let wheel = |wheel_assembler: &'a WheelAssembler| WheelBuilder {
            wheel_assembler,
            // Builds of an axle with extra links are assembled one by one.
            lanes: width
                .filter(|_| wheel_assembler.tensions.is_empty())
                .map(|width| LaneBuilder::new(problem.tolerance, wheel_assembler, width)),
            tensions: None,
            parts: wheel_assembler.assembler.drawn().clone(),
            designs: Vec::with_capacity(
                BLOCK * wheel_assembler.assembler.suspension().design.len(),
            ),
        };
        Ok(Builder {
            problem,
            wheels: problem.wheel_assemblers.iter().map(wheel).collect(),
            evaluator,
            block: problem.request.block(),
            draws: vec![0.0; problem.tolerance.sources()],
            draws_of_block: vec![0.0; problem.tolerance.sources() * BLOCK],
            places: Vec::with_capacity(BLOCK),
            rates: Vec::new(),
        })
    }

    /// Draws and solves `count` builds from number `first` on, at most one block. `None` if the problem's interrupt is raised
    /// during this work.
    pub(super) fn solve(&mut self, first: u64, count: usize) -> Option<Outcome> {
        let Problem {
            tolerance,
            interrupt,
            ..
        } = *self.problem;
        if self.wheels[0].lanes.is_some() {
            tolerance.draw_block(first, count, &mut self.draws_of_block);
        }
        for lanes in self
            .wheels
            .iter_mut()
            .filter_map(|wheel| wheel.lanes.as_mut())
        {
            lanes.assemble(&self.draws_of_block, count);
        }
        let mut rejects = Vec::new();
        self.begin();
        for place in 0..count {
            if interrupt.is_raised() {
                return None;
            }
            let in_lanes = |wheel: &WheelBuilder| {
                wheel
                    .lanes
                    .as_ref()
                    .is_some_and(|lanes| lanes.accepted[place])
            };
            let has_rates = elastic::rates(tolerance).next().is_some();
            if has_rates || !self.wheels.iter().all(in_lanes) {
                tolerance.draw(first + place as u64, &mut self.draws);
            }
            if let Err((side, reject)) = self.build(place) {
                rejects.push((first + place as u64, side, reject));
            }
        }
        let outcome = self.finish(first, rejects);
        // If an interrupt stopped the solution, the stored values belong to an earlier block.
        (!interrupt.is_raised()).then_some(outcome)
    }

    fn begin(&mut self) {
        for wheel in &mut self.wheels {
            wheel.designs.clear();
        }
        self.places.clear();
        self.rates.clear();
    }

    /// Assembles all wheels of a build from its random numbers, if the build was not assembled in lanes. If one wheel fails,
    /// no wheel of the build is stored.
    fn build(&mut self, place: usize) -> Result<(), (Option<Side>, AssemblyError)> {
        let (tolerance, draws) = (self.problem.tolerance, &self.draws);
        let built = self.wheels.iter_mut().try_for_each(|wheel| {
            let WheelBuilder {
                wheel_assembler,
                lanes,
                parts,
                designs,
                tensions,
            } = wheel;
            let points = parts.points.len();
            if let Some(lanes) = lanes.as_ref().filter(|lanes| lanes.accepted[place]) {
                designs.extend_from_slice(&lanes.designs[place * points..(place + 1) * points]);
                return Ok(());
            }
            wheel_assembler.change_parts(tolerance, draws, parts);
            let start = designs.len();
            designs.resize(start + points, Vector3::default());
            let together = wheel_assembler.put_together(parts, &mut designs[start..]);
            *tensions = together.map_err(|reject| (wheel_assembler.named_side(), reject))?;
            Ok(())
        });
        match built {
            Ok(()) => {
                self.places.push(place);
                elastic::append_rates(tolerance, draws, &mut self.rates);
                let left = &self.wheels[0];
                let inputs = left.wheel_assembler.tensions.iter();
                let tension = |own: &TensionInput| Some(own.nominal + left.tensions?[own.link]);
                self.rates.extend(inputs.filter_map(tension));
            }
            Err(_) => {
                let builds = self.places.len();
                for wheel in &mut self.wheels {
                    wheel.designs.truncate(builds * wheel.parts.points.len());
                }
            }
        }
        built
    }

    /// Solves the assembled builds of a block. `first` is the number of the first build of the block.
    fn finish(&mut self, first: u64, mut rejects: Vec<Unbuilt>) -> Outcome {
        let wheels = &self.wheels;
        let designs = [0, 1].map(|k| wheels.get(k).map_or(&[][..], |wheel| &wheel.designs));
        self.evaluator.set_rates(&self.rates);
        self.evaluator.evaluate_pairs(designs, &mut self.block);
        let number = |design: &usize| first + self.places[*design] as u64;
        for (design, fault) in self.block.faults() {
            rejects.push((
                number(design),
                None,
                AssemblyError::Immovable(fault.clone()),
            ));
        }
        let failures = self.block.failures().iter();
        let mut incomplete: Vec<usize> = failures.map(|failure| failure.design).collect();
        incomplete.dedup();
        Outcome {
            rejects,
            incomplete: (incomplete.len() as u64, incomplete.iter().map(number).min()),
        }
    }
}
