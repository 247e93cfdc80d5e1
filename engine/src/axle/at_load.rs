//! Poses in roll at constant load. The mean travel is a result.
//!
//! When a car rolls, the load on its axle stays the same, but its height may change. F(z) is the sum of the wheel loads at
//! the mean travel z. F_0 is this sum for the level axle with the rack centred. So z is the root of F(z) = F_0. The
//! derivative F_z of F with respect to z is twice the ride rate without the tyre. Newton's method finds the root. At a
//! given roll angle, the derivative of z with respect to the design p is
//!
//! ```text
//! dz/dp = (dF_0/dp - dF/dp)/F_z
//! ```

use super::formulas::loads::axle_load;
use super::solver::{AxlePose, AxleSolver, Placement};
use super::state::Motion;
use super::{Quantity, WheelQuantity};
use crate::mechanism::NoPose;
use crate::model::Side;
use crate::number::{Each, Vector3};

/// Number of terms of the power series from which wheel loads are computed. Wheel loads contain velocities, and the program
/// differentiates wheel loads with respect to the travel and the design.
pub(super) const LOAD_TERMS: usize = 3;
/// Largest number of Newton steps, including steps back to a travel that the wheels can reach.
const MOST_STEPS: usize = 60;
/// Smallest step of the roll angle, as a fraction of the required roll angle.
const LEAST_STEP: f64 = 1.0 / 64.0;

/// Wheel loads whose sum stays constant.
const LOADS: [Quantity; 2] = [
    Quantity::Wheel(Side::Left, WheelQuantity::WheelLoad),
    Quantity::Wheel(Side::Right, WheelQuantity::WheelLoad),
];

/// Sum of the wheel loads in a pose, and its derivative with respect to the mean travel.
struct Carried {
    placed: AxlePose,
    load: f64,
    by_heave: f64,
}

impl<'a> AxleSolver<'a, LOAD_TERMS> {
    fn carried(&mut self, heave: f64, roll: f64, rack: f64) -> Result<Carried, NoPose> {
        let placed = self.place(&Placement::Roll { heave, roll, rack })?;
        let state = self.read(&placed)?.state;
        let carried = Carried {
            placed,
            load: axle_load(&state),
            by_heave: axle_load(&state.moving(Motion::Heave))[1],
        };
        // The condition is also false if one of the values is NaN.
        if carried.by_heave > 0.0 && carried.load.is_finite() {
            Ok(carried)
        } else {
            Err(NoPose::NoLoad)
        }
    }

    /// Finds the pose in which the axle carries the same load as when it is level at the travel `level`, with the rack
    /// centred.
    ///
    /// Newton's method starts at the mean travel of the level axle. It can fail there, for example because a wheel
    /// cannot reach its travel. Then the roll angle increases from zero in steps. Each step starts from the mean travel
    /// of the previous step.
    fn found(&mut self, level: f64, roll: f64, rack: f64) -> Result<AxlePose, NoPose> {
        let wanted = self.carried(level, 0.0, 0.0)?.load;
        let (mut heave, mut reached, mut step) = (level, 0.0, 1.0);
        // `reached` is the fraction of the roll angle that is solved. The next step ends at the whole angle, or is
        // twice as long as the previous step.
        loop {
            let next = f64::min(reached + step, 1.0);
            match self.descend(heave, wanted, next * roll, rack) {
                Ok(mut placed) if next == 1.0 => {
                    placed.at_load = Some(level);
                    return Ok(placed);
                }
                Ok(placed) => {
                    let [left, right] = placed.travels;
                    (heave, reached, step) = (0.5 * (left + right), next, 2.0 * step);
                }
                Err(failure) if step <= LEAST_STEP => return Err(failure),
                Err(_) => step *= 0.5,
            }
        }
    }

    /// Newton's method for the mean travel at which the sum of the wheel loads is `wanted`. It begins at the mean travel
    /// `start`.
    fn descend(
        &mut self,
        start: f64,
        wanted: f64,
        roll: f64,
        rack: f64,
    ) -> Result<AxlePose, NoPose> {
        let size = self.size();
        let (mut heave, mut reached, mut smallest) = (start, None, f64::INFINITY);
        for _ in 0..MOST_STEPS {
            let here = match self.carried(heave, roll, rack) {
                Ok(here) => here,
                // Go halfway back to the last travel at which both wheels have a pose.
                Err(failure) => {
                    let back: f64 = reached.ok_or(failure)?;
                    if (heave - back).abs() <= 1e-9 * size {
                        return Err(NoPose::NoLoad);
                    }
                    heave = 0.5 * (heave + back);
                    continue;
                }
            };
            let step: f64 = (wanted - here.load) / here.by_heave;
            let is_rounding = step.abs() <= 4.0 * f64::EPSILON * size;
            if is_rounding || step.abs() >= smallest && smallest <= 1e-9 * size {
                return Ok(here.placed);
            }
            smallest = smallest.min(step.abs());
            reached = Some(heave);
            heave += step;
        }
        Err(NoPose::NoLoad)
    }

    /// Adds the gradient of the sum of the wheel loads, multiplied by `factor`, to `into`. This gradient is with
    /// respect to the hardpoints of both sides.
    fn add_load_gradients(
        &mut self,
        placed: &AxlePose,
        factor: f64,
        into: &mut [Vec<Vector3<f64>>; 2],
    ) -> Result<(), NoPose> {
        let sought = LOADS.each(super::solver::Sought::Quantity);
        self.each_gradient(placed, &sought, None, &mut |_, gradients| {
            for (into, gradient) in into.iter_mut().zip(gradients) {
                for (sum, by) in into.iter_mut().zip(&*gradient) {
                    *sum = *sum + *by * factor;
                }
            }
        })
    }

    /// Derivatives of the mean travel with respect to the hardpoints of both sides. The sum of the wheel loads stays
    /// constant.
    pub(super) fn heave_by_design(
        &mut self,
        level: f64,
        placed: &AxlePose,
    ) -> Result<[Vec<Vector3<f64>>; 2], NoPose> {
        let heave = 0.5 * (placed.travels[0] + placed.travels[1]);
        let here = self.carried(heave, placed.roll, placed.rack)?;
        let standing = self.carried(level, 0.0, 0.0)?;
        let count = self.points().count();
        let mut by_design = [(); 2].map(|()| vec![Vector3::new(0.0, 0.0, 0.0); count]);
        self.add_load_gradients(&standing.placed, 1.0 / here.by_heave, &mut by_design)?;
        self.add_load_gradients(&here.placed, -1.0 / here.by_heave, &mut by_design)?;
        Ok(by_design)
    }
}

impl<'a, const N: usize> AxleSolver<'a, N> {
    /// Returns a second solver for the same designs. Its power series are long enough for wheel loads ([`LOAD_TERMS`]).
    pub(super) fn loads(&mut self) -> Result<&mut AxleSolver<'a, LOAD_TERMS>, NoPose> {
        if self.loads.is_none() {
            let made = AxleSolver::new(self.axle, &LOADS, false);
            let mut made = made.map_err(|_| NoPose::NoLoad)?;
            let designs = self.designs();
            let prepared = made.prepare_whole(designs.each_ref().each(Vec::as_slice));
            prepared.map_err(|_| NoPose::NoLoad)?;
            self.loads = Some(Box::new(made));
        }
        self.loads.as_deref_mut().ok_or(NoPose::NoLoad)
    }

    /// Finds the pose in which the axle carries the same load as when it is level at the travel `level`, with the rack
    /// centred.
    pub(super) fn at_load(&mut self, level: f64, roll: f64, rack: f64) -> Result<AxlePose, NoPose> {
        self.loads()?.found(level, roll, rack)
    }
}
