//! Builds of a wheel with elastic parts. The parts are assembled without load, and their rates (stiffnesses) also scatter.
//!
//! The parts of a build are assembled like the parts of a rigid mechanism, in the position in which elastic parts carry no
//! force. The built design is then the design of a wheel with elastic parts, and the code evaluates the equilibria of this
//! wheel. With p the built design and k the rates,
//!
//! ```text
//! dy/dx = (dy/dp) (dp/dx) + (dy/dk) (dk/dx)
//! ```
//!
//! For each station, a tape (a record of the operations, for adjoint differentiation) gives dy/dp and dy/dk. Second
//! derivatives are not computed.

use super::axle_expansion::{Moves, moves_of_wheel};
use super::wheel_assembler::WheelAssembler;
use super::{Banded, Problem, with_rounding};
use crate::assembly::SetUpError;
use crate::compliance::{AxleParameter, KcRun, KcValue, Parameter};
use crate::curves::Column;
use crate::evaluate::{ElasticQuantities, ElasticRead, Request, Stations};
use crate::model::{Axis, PointId, Suspension};
use crate::number::Vector3;
use crate::study::{Band, ComplianceStudy, Rate, Source, Study, TargetKind, Tolerance, WheelStudy};
use crate::threads::Interrupt;

/// Rates that scatter, each with the wheel that has the part, in the order of the tolerance sources.
pub(super) fn rates(tolerance: &Tolerance) -> impl Iterator<Item = (AxleParameter, &Rate)> {
    tolerance.each_source().filter_map(|source| {
        let rate = source.rate.as_ref()?;
        let (parameter, side) = (rate.parameter, source.side);
        Some((AxleParameter { parameter, side }, rate))
    })
}

/// Appends the rates (stiffnesses) of the elastic parts of a build, from its random numbers.
pub(super) fn append_rates(tolerance: &Tolerance, draws: &[f64], into: &mut Vec<f64>) {
    let sources = tolerance.each_source().zip(draws);
    into.extend(sources.filter_map(|(source, z)| Some(source.rate.as_ref()?.scattered(*z)[0])));
}

/// Values of the study's outputs and of bands, without duplicates, with their columns.
fn reads(own: &WheelStudy, tolerance: &Tolerance) -> (Vec<KcValue>, Vec<Column>) {
    let length = own.suspension.length_unit;
    let (mut reads, mut columns) = (Vec::new(), Vec::new());
    let mut add = |value: KcValue, column: Column| {
        if !reads.contains(&value) {
            reads.push(value);
            columns.push(column);
        }
    };
    for of in &own.outputs.characteristics {
        add(KcValue::Wheel(*of), Column::of_characteristic(*of, length));
    }
    for figure in &own.outputs.figures {
        add(figure.value, figure.as_column(length));
    }
    for band in &tolerance.bands {
        match (band.of.as_characteristic(), band.of.as_figure()) {
            (Some(of), _) => add(KcValue::Wheel(of), Column::of_characteristic(of, length)),
            (None, Some(figure)) => add(figure.value, figure.as_column(length)),
            (None, None) => {}
        }
    }
    (reads, columns)
}

/// Prepares the tolerances of a study with elastic parts: characteristics over the motion, test results in the design
/// position.
pub(super) fn problem<'a>(
    study: &'a Study,
    own: &WheelStudy,
    elastic: &ComplianceStudy,
    tolerance: &'a Tolerance,
) -> Result<Problem<'a>, SetUpError> {
    let wheel_assembler = WheelAssembler::of(study, tolerance, &own.suspension, None)?;
    let further: Vec<f64> = tolerance.bands.iter().filter_map(|band| band.at).collect();
    let stations = Stations::of(&own.motion, &own.suspension.frame, &further);
    let (reads, columns) = reads(own, tolerance);
    let banded = |band: &Band| -> Banded {
        let TargetKind::Elastic(value) = band.of.kind else {
            return (Vec::new(), with_rounding(band.between));
        };
        let output = reads.iter().position(|read| *read == value);
        let output = output.expect("`reads` contains the value of every band");
        let is_figure = matches!(value, KcValue::Figure { .. });
        let places: Vec<usize> = match band.at {
            Some(at) => stations.at(at).into_iter().collect(),
            None if is_figure => vec![stations.design()],
            None => stations.of_motion().collect(),
        };
        (
            places
                .into_iter()
                .map(|station| [output, station])
                .collect(),
            with_rounding(band.between),
        )
    };
    let bands: Vec<Banded> = tolerance.bands.iter().map(banded).collect();
    let further: Vec<[usize; 2]> = bands
        .iter()
        .flat_map(|(cells, _)| cells.iter().copied())
        .collect();
    let wheel = WheelStudy {
        suspension: wheel_assembler.assembler.suspension().clone(),
        ..own.clone()
    };
    let quantities = ElasticQuantities::of(
        &wheel,
        elastic,
        &stations,
        reads
            .iter()
            .map(|value| ElasticRead {
                value: *value,
                slope: None,
            })
            .collect(),
        &further,
        rates(tolerance).map(|(_, rate)| rate.parameter).collect(),
    );
    Ok(Problem {
        study,
        tolerance,
        request: Request::of_elastic(quantities, stations, columns),
        bands,
        wheel_assemblers: vec![wheel_assembler],
        elastic: reads,
        interrupt: Interrupt::default(),
    })
}

/// Derivatives of every cell (an output at a station) with respect to each tolerance source, `[cell][source]`. NaN if
/// there is no value.
pub(super) fn gradients(problem: &Problem, sources: &[&Source]) -> Result<Vec<f64>, SetUpError> {
    let wheel_assembler = &problem.wheel_assemblers[0];
    let built = wheel_assembler.assembler.build_drawn()?;
    let suspension: &Suspension = &built.suspension;
    let moves: Vec<Moves> = moves_of_wheel(wheel_assembler, &built, sources).collect();
    let Some(elastic) = problem.study.compliance() else {
        return Ok(Vec::new());
    };
    let parts = &elastic.parts;
    let run = KcRun::new(suspension, parts, elastic.tyre_rate)
        .map_err(|fault| SetUpError::Fault(fault.of_design()))?;
    let points = (0..suspension.design.len()).map(PointId);
    let mut parameters: Vec<Parameter> = points
        .flat_map(|point| Axis::ALL.map(|axis| Parameter::Point(point, axis)))
        .collect();
    parameters.extend(rates(problem.tolerance).map(|(_, rate)| rate.parameter));
    let stations = problem.stations();
    let mut gradient = vec![f64::NAN; problem.cells() * sources.len()];
    for station in 0..stations.count() {
        let numbers = problem.request.read_at(station);
        let wanted: Vec<KcValue> = numbers.iter().map(|k| problem.elastic[*k]).collect();
        let travel = stations.values()[stations.value_of(station)];
        let rack = stations.racks[stations.rack_of(station)] * suspension.frame.sign(Axis::Y);
        // A station without an equilibrium has no derivatives.
        let _: Result<(), _> = run.gradients([travel, rack], &wanted, &parameters, &mut |found| {
            if found.value.is_none() {
                return;
            }
            let cell = problem.cell(numbers[found.number], station);
            let into = &mut gradient[cell * sources.len()..][..sources.len()];
            let moves = |k: usize| std::slice::from_ref(&moves[k]);
            write_slopes(sources, moves, found.by, into);
        });
    }
    Ok(gradient)
}

/// Writes the derivatives of a value with respect to each tolerance source. `by` holds the derivatives with respect to the
/// coordinates of all points, wheel after wheel, then with respect to the rates (stiffnesses) that scatter. `moves` returns the
/// derivatives of the points of each wheel with respect to a source.
pub(super) fn write_slopes<'m>(
    sources: &[&Source],
    moves: impl Fn(usize) -> &'m [Moves],
    by: &[f64],
    into: &mut [f64],
) {
    let rates = sources
        .iter()
        .filter(|source| source.rate.is_some())
        .count();
    let (by_points, by_rates) = by.split_at(by.len() - rates);
    let mut by_rates = by_rates.iter();
    for (k, (source, slope)) in sources.iter().zip(into).enumerate() {
        let wheels = moves(k);
        let by_wheels = by_points.chunks_exact(by_points.len() / wheels.len());
        let coordinates = wheels.iter().zip(by_wheels);
        let coordinates = coordinates.flat_map(|(own, by)| own.iter().zip(by.chunks_exact(3)));
        // A point that does not move contributes nothing, even if the derivative with respect to it has no value.
        let moving = coordinates.filter(|(way, _)| way.to_array() != [0.0; 3]);
        let along =
            |(way, by): (&Vector3<f64>, &[f64])| way.x * by[0] + way.y * by[1] + way.z * by[2];
        *slope = moving.map(along).sum();
        if let Some(rate) = &source.rate {
            let by = by_rates.next();
            *slope += by.map_or(0.0, |by| by * rate.scattered(0.0)[1]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::Law;

    /// A point at rest contributes nothing to a slope, even if the derivative with respect to it has no value.
    #[test]
    fn points_at_rest_have_no_part_in_a_slope() {
        let source = Source {
            name: String::new(),
            changes: Vec::new(),
            rate: None,
            law: Law::Normal { sigma: 1.0 },
            side: None,
            seen_from_other: Vec::new(),
        };
        let moves: [Moves; 1] = [vec![
            Vector3::new(0.0, 0.0, 0.0),
            Vector3::new(1.0, 0.0, -2.0),
        ]];
        let by = [f64::NAN, f64::NAN, f64::NAN, 3.0, 7.0, 0.5];
        let mut slopes = [f64::NAN];
        write_slopes(&[&source], |_| &moves, &by, &mut slopes);
        assert_eq!(slopes, [2.0]);
    }
}
