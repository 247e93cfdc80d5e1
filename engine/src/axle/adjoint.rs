//! Adjoint of an axle's formulas: puts the numbers of both wheels on a tape and returns gradients with respect to the
//! hardpoints.

use super::reading::{MOST_LINES, Parts, Reading, Snapshot, WheelPose, zipped};
use super::taylor::Taylor;
use crate::characteristics::{NumberPart, Slot, VectorPart};
use crate::derive::{Linearised, Seeds};
use crate::number::{Each, Jet, Real, Tape, Tracked, Vector3, array_of};
use std::cell::Cell;

/// Largest number of coefficients of a power series. Each series describes one value of a wheel along one straight line in travel
/// and rack.
const MOST_POWERS: usize = 4;
/// Upper limit for the count of values that describe a wheel: the size in bytes of a wheel in which each value is one byte.
const MOST_NUMBERS: usize = size_of::<WheelPose<u8>>();

impl<'t> Reading<Tracked<'t>> {
    /// Makes a wheel whose used values are all inputs on the tape (the recorded operations for derivatives). The inputs are ordered
    /// by straight line in travel and rack, then by value of the wheel, then by power of the series. Other values are NaN.
    pub fn on_tape<const N: usize>(tape: &'t Tape, lines: &[Snapshot<N>], parts: &Parts) -> Self {
        const { assert!(N <= MOST_POWERS) };
        let zero = Tracked::constant(0.0);
        let mut inputs = [[zero; MOST_NUMBERS * MOST_POWERS]; MOST_LINES];
        for (inputs, line) in inputs.iter_mut().zip(lines) {
            let inputs = Cell::from_mut(&mut inputs[..]).as_slice_of_cells();
            zipped(&parts.places, &line.0).map(|(place, series): (Option<usize>, Jet<f64, N>)| {
                let Some(place) = place else { return };
                for (input, value) in inputs[place * N..].iter().zip(series.0) {
                    input.set(tape.input(value));
                }
            });
        }
        let moving = |place: Option<usize>| {
            let Some(place) = place else {
                return Taylor::unknown(zero);
            };
            let along = inputs.each_ref().each(|line| &line[place * N..][..N]);
            Taylor::through(&along[..lines.len()])
        };
        let fixed = |place: Option<usize>| match place {
            Some(place) => inputs[0][place * N],
            None => zero.constant(f64::NAN),
        };
        Reading::made_of(&parts.places, moving, fixed)
    }
}

/// Number of inputs that a wheel puts on the tape, if its series are given along `lines` straight lines in travel and rack.
pub(super) fn inputs_on_tape<const N: usize>(parts: &Parts, lines: usize) -> usize {
    parts.count * N * lines
}

/// Adds the gradient of an output with respect to every hardpoint to `gradient`. `by` contains the derivatives of the
/// output with respect to the inputs of one straight line in travel and rack, in the order of [`Reading::on_tape`].
/// `buffer` is working memory with one entry per point.
///
/// The series are in powers of e, the parameter of the line. Let u_p be the derivative of the input u with respect to
/// hardpoint p. An adjoint pass with a seed series S returns the series of S.u_p. In S, the coefficient of e^(N-1-k) is the
/// derivative of the output with respect to the coefficient of e^k of u. So the coefficient of e^(N-1) of S.u_p is the
/// required derivative.
pub(super) fn add_gradient<const N: usize>(
    linearised: &Linearised<'_, N>,
    parts: &Parts,
    by: &[f64],
    buffer: &mut [Vector3<Jet<f64, N>>],
    gradient: &mut [Vector3<f64>],
) {
    if by.iter().all(|b| *b == 0.0) {
        return;
    }
    let zero = Jet::constant(0.0);
    let seeds = parts.places.map(|place: Option<usize>| match place {
        None => zero,
        Some(place) => Jet(array_of(|k| by[place * N + N - 1 - k])),
    });
    buffer.fill(Vector3::new(zero, zero, zero));
    linearised.gradient(buffer, |sink| push(linearised, parts, &seeds, sink));
    for (total, series) in gradient.iter_mut().zip(buffer) {
        *total = *total + series.map(|c| c[N - 1]);
    }
}

/// Adds the seeds of all values of the wheel that the formulas use to `sink`. The seed of a value contains the derivatives of the
/// output with respect to this value.
fn push<const N: usize>(
    linearised: &Linearised<'_, N>,
    parts: &Parts,
    seeds: &WheelPose<Jet<f64, N>>,
    sink: &mut Seeds<'_, '_, Jet<f64, N>>,
) {
    let WheelPose {
        wheel,
        rotation,
        axle,
        design,
    } = seeds;
    let places = &parts.places;
    let at = &linearised.at;
    let zero = Jet::constant(0.0);
    let number = |seed: Jet<f64, N>| Vector3::new(seed, zero, zero);
    for part in VectorPart::ALL {
        if places.wheel.vector(*part).x.is_some() {
            part.slots()[0].push(wheel.vector(*part), at, sink);
        }
    }
    for part in NumberPart::ALL {
        if places.wheel.number(*part).is_some() {
            part.slots()[0].push(number(wheel.number(*part)), at, sink);
        }
    }
    if places.design.spin_axis.x.is_some() {
        Slot::DesignSpinAxis.push(design.spin_axis, at, sink);
    }
    if places.design.centre.x.is_some() {
        Slot::DesignCentre.push(design.centre, at, sink);
    }
    // Let g be the seed of a column c of the carrier's rotation matrix: the gradient of the output with respect to c. A
    // small rotation d of the carrier moves c by d x c. So it changes the output by g.(d x c) = d.(c x g).
    for (column, seed) in at.carrier_rotation().columns.into_iter().zip(rotation) {
        sink.carrier_turn(column.cross(*seed));
    }
    if places.axle[0].x.is_some() {
        for (column, seed) in at.pose.rotation.columns.into_iter().zip(axle) {
            sink.turn(column.cross(*seed));
        }
    }
    if places.design.spring_length.is_some() {
        Slot::DesignSpringLength.push(number(design.spring_length), at, sink);
    }
    if places.design.heave_spring.x.is_some() {
        Slot::DesignHeaveSpring.push(design.heave_spring, at, sink);
    }
}
