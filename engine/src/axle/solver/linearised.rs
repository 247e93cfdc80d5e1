//! Both wheels of a position, linearised: the basis for gradients with respect to the hardpoints.

use super::*;

/// Both wheels of a position, linearised for gradients of formulas with respect to the hardpoints.
pub(crate) struct LinearisedAxle<'s, const N: usize> {
    /// Linearised wheels. Each wheel is linearised along each line in travel and rack.
    pub(super) wheels: [Vec<Linearised<'s, N>>; 2],
    pub(super) snapshots: [Vec<Snapshot<N>>; 2],
    pub(super) parts: Parts,
}

impl<const N: usize> LinearisedAxle<'_, N> {
    /// Puts both wheels on the tape as inputs. Returns each wheel with the index of its first input. Between the inputs
    /// of the two wheels, the tape contains operations that combine series along several lines.
    pub(crate) fn on_tape<'t>(&self, tape: &'t Tape) -> [(Reading<Tracked<'t>>, usize); 2] {
        self.snapshots.each_ref().each(|lines| {
            let first = tape.len();
            (Reading::on_tape(tape, lines, &self.parts), first)
        })
    }

    /// Number of inputs per wheel.
    pub(crate) fn inputs(&self) -> usize {
        inputs_on_tape::<N>(&self.parts, self.wheels[0].len())
    }

    /// Working memory for [`LinearisedAxle::add_gradient`].
    pub(crate) fn buffer(&self) -> Vec<Vector3<Jet<f64, N>>> {
        let zero = Jet::constant(0.0);
        let points = self.wheels[0][0].at.mechanism.points.len();
        vec![Vector3::new(zero, zero, zero); points]
    }

    /// Adds the gradient with respect to the hardpoints of a wheel. It is computed from the derivatives with respect to
    /// the inputs of this wheel.
    pub(crate) fn add_gradient(
        &self,
        side: Side,
        by: &[f64],
        buffer: &mut [Vector3<Jet<f64, N>>],
        gradient: &mut [Vector3<f64>],
    ) {
        let lines = &self.wheels[side as usize];
        let per_line = self.inputs() / lines.len();
        for (linearised, by) in lines.iter().zip(by.chunks(per_line)) {
            add_gradient(linearised, &self.parts, by, buffer, gradient);
        }
    }
}

/// Linearises both wheels of a position along the lines in travel and rack that are needed.
pub(super) fn linearise<'s, const N: usize>(
    corners: &'s [Corner<'_, N>; 2],
    (lines, parts): (&[Line], Parts),
    placed: &AxlePose,
    coordinates: [(f64, f64); 2],
) -> Result<LinearisedAxle<'s, N>, NoPose> {
    let mut wheels = [Vec::new(), Vec::new()];
    for (corner, linearised) in corners.iter().zip(&mut wheels) {
        let pose = &placed.poses[corner.side as usize];
        let (travel, rack) = coordinates[corner.side as usize];
        let (inner_travel, inner_rack) = corner.inner(travel, rack);
        for line in lines {
            let motion = along::<N>(line, inner_travel, inner_rack);
            let found = corner.solver.linearised(&corner.series, pose, &motion);
            linearised.push(found.map_err(|failure| corner.fails(travel, failure))?);
        }
    }
    let snapshots = wheels.each_ref().map(|of_wheel| {
        let lines = of_wheel.iter();
        lines
            .map(|linearised| Snapshot::of(&linearised.at, &parts))
            .collect::<Vec<_>>()
    });
    Ok(LinearisedAxle {
        wheels,
        snapshots,
        parts,
    })
}

/// Derivative of a requested number with respect to the mean travel.
pub(super) fn derivative_by_heave<const N: usize>(
    state: &AxleState<'_, f64>,
    linearised: &[Vec<Linearised<'_, N>>; 2],
    sought: &Sought,
) -> f64 {
    match *sought {
        Sought::Quantity(quantity) => quantity.evaluate(&state.moving(Motion::Heave))[1],
        Sought::Point(side, id, axis) => {
            let place = linearised[side as usize][0].at.point(id)[axis];
            let by_travel = place.0.get(1).copied().unwrap_or(f64::NAN);
            // For a rigid axle, the second line is along the held travel. So its first coefficient is the derivative by the
            // held travel.
            let by_rack = match (state.carriers.is_rigid(), linearised[side as usize].get(1)) {
                (false, _) => 0.0,
                (true, None) => f64::NAN,
                (true, Some(line)) => line.at.point(id)[axis]
                    .0
                    .get(1)
                    .copied()
                    .unwrap_or(f64::NAN),
            };
            state.along(Motion::Heave, side, [by_travel, by_rack])
        }
    }
}
