//! Static position of a built mechanism.

use super::assembler::{Assembler, Linearised};
use super::assembly_error::AssemblyError;
use super::least_energy::Tensions;
use super::parts::{BuildParameter, Parts};
use crate::mechanism::Pose;
use crate::model::{PointId, Suspension};
use crate::number::{Dual, Each, Jet, Matrix3, Real, Vector3};

/// Definition of the height of the wheel centre at travel 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Rest {
    /// The workshop sets the height. The value is the difference from the nominal height, positive upwards.
    Height(f64),
    /// The spring's length sets the height. The value is the difference from the nominal length between the spring's
    /// ends. If the spring itself does not change, for example if only the pushrod changes, the value is 0.
    Spring(f64),
}

/// Assembled parts.
#[derive(Clone, Debug)]
pub struct Built {
    /// Built design in its static position.
    pub suspension: Suspension,
    /// The parts.
    pub parts: Parts<f64>,
    /// Definition of the static height.
    pub rest: Rest,
    /// Height of the wheel centre above its nominal height.
    pub height: f64,
    /// Tensions that the parts cause in the links of an axle on five links. `None` for other suspensions.
    pub tensions: Tensions,
    at: Linearised,
}

/// Direction of a change of parts: dimensions that change together, each with its factor.
pub type Direction = [(BuildParameter, f64)];

/// A value and its derivative with respect to one variable.
type Slope = Dual<f64, 1>;

/// Largest number of steps in the search for the height at which the spring has its length.
const MOST_STEPS: usize = 30;
/// Smallest fraction of a step in the search for the height at which the spring has its length.
const SHORTEST: f64 = 1e-3;

/// Finds the height at which the spring has its length, by Newton's method. It begins with the state `at` at `height`. `size` is
/// the size of the suspension. `step` returns the Newton step of the height from a state, and `place` moves a state to a height. If
/// `place` fails, the step is halved. It fails if the parts cannot be assembled at the height, or have no equilibrium there.
pub(super) fn settle_height<S, E: From<AssemblyError>>(
    at: &mut S,
    mut height: f64,
    size: f64,
    step: impl Fn(&S) -> Result<f64, E>,
    place: impl Fn(&mut S, f64) -> Result<(), E>,
) -> Result<(), E> {
    let mut before = f64::INFINITY;
    for _ in 0..MOST_STEPS {
        let step = step(at)?;
        if step.is_nan() || step.abs() > size {
            break;
        }
        // If small steps no longer shrink, the remaining error is rounding, and the present height is accepted.
        if step.abs() <= 1e-13 * size || (step.abs() <= 1e-10 * size && step.abs() >= before) {
            return Ok(());
        }
        before = step.abs();
        let mut share = 1.0;
        while let Err(reject) = place(at, height + share * step) {
            share *= 0.5;
            if share < SHORTEST {
                return Err(reject);
            }
        }
        height += share * step;
    }
    Err(AssemblyError::Spring.into())
}

impl Assembler {
    /// Assembles the nominal parts at the nominal height.
    pub(crate) fn build_drawn(&self) -> Result<Built, AssemblyError> {
        self.build(self.drawn(), Rest::Height(0.0))
    }

    /// Assembles parts in their static position, at the height that `rest` defines.
    pub fn build(&self, parts: &Parts<f64>, rest: Rest) -> Result<Built, AssemblyError> {
        let suspension = self.suspension();
        let mut built = Built {
            suspension: suspension.clone(),
            parts: parts.clone(),
            rest,
            height: 0.0,
            tensions: None,
            at: *self.home(),
        };
        match rest {
            Rest::Height(height) => self.rebuild(&mut built, height)?,
            Rest::Spring(longer) => {
                let drawn = suspension
                    .spring_length(&suspension.design)
                    .ok_or(AssemblyError::Spring)?;
                self.settle_on_spring(&mut built, drawn + longer)?;
            }
        }
        Ok(built)
    }

    fn rebuild(&self, built: &mut Built, height: f64) -> Result<(), AssemblyError> {
        let parts = &*self.turned(&built.parts);
        self.check_turned(parts)?;
        let at = self.position(parts, height)?;
        self.place_checked(parts, &at.pose, &mut built.suspension.design)?;
        built.tensions = self.tensions(parts, height, &at);
        built.at = at;
        built.height = height;
        Ok(())
    }

    /// Finds the height at which the spring has the length `wanted`.
    fn settle_on_spring(&self, built: &mut Built, wanted: f64) -> Result<(), AssemblyError> {
        self.rebuild(built, 0.0)?;
        let step = |built: &Built| -> Result<f64, AssemblyError> {
            let length = self.spring_by(built, &[], 1.0);
            let [now, by_height] = length.ok_or(AssemblyError::Spring)?;
            Ok((wanted - now) / by_height)
        };
        let place = |built: &mut Built, height: f64| self.rebuild(built, height);
        settle_height(built, 0.0, self.suspension().size(), step, place)
    }

    /// Returns the length of the spring, and the derivative of this length along a direction of the parts. `rise` is the
    /// derivative of the height along this direction. `None` without a spring.
    fn spring_by(&self, built: &Built, direction: &Direction, rise: f64) -> Option<[f64; 2]> {
        let (_, design) = self.design_along(built, dual, 1, direction, rise);
        let length = self.suspension().spring_length(&design)?;
        Some([length.value, length.partials[0]])
    }

    /// Returns the pose of the carrier and the built design in another number type, with their derivatives along a
    /// direction. `number` makes a number from a value and a derivative.
    fn design_along<T: Real>(
        &self,
        built: &Built,
        number: impl Fn(f64, f64) -> T,
        orders: usize,
        direction: &Direction,
        rise: f64,
    ) -> (Pose<T>, Vec<Vector3<T>>) {
        let mut parts = built.parts.map(|value| number(value, 0.0));
        for (parameter, share) in direction {
            let mechanism = &self.suspension().mechanism;
            parts.change(mechanism, *parameter, number(0.0, *share));
        }
        self.placed_series(built, &parts, number(built.height, rise), orders)
    }

    fn placed_series<T: Real>(
        &self,
        built: &Built,
        parts: &Parts<T>,
        height: T,
        orders: usize,
    ) -> (Pose<T>, Vec<Vector3<T>>) {
        let parts = &*self.turned(parts);
        let pose = self.pose_series(parts, height, &built.at, orders);
        let mut design = parts.points.clone();
        self.place(parts, &pose, &mut design);
        (pose, design)
    }

    /// Returns the built design of parts that are derivative numbers with `orders` orders. The parts must have the same values as
    /// in the build. The height does not change.
    pub fn design_of<T: Real>(
        &self,
        built: &Built,
        parts: &Parts<T>,
        orders: usize,
    ) -> Vec<Vector3<T>> {
        let height = parts.points[0].x.constant(built.height);
        self.placed_series(built, parts, height, orders).1
    }

    /// Returns the derivatives of every point of the built design and of the static height along a direction of the
    /// parts. If the spring sets the height, the spring keeps its length.
    pub fn design_by(&self, built: &Built, direction: &Direction) -> (Vec<Vector3<f64>>, f64) {
        let rise = match built.rest {
            Rest::Height(_) => 0.0,
            // The height changes with the parts.
            Rest::Spring(_) => {
                let by_parts = self.spring_by(built, direction, 0.0);
                let by_height = self.spring_by(built, &[], 1.0);
                match (by_parts, by_height) {
                    (Some([_, by_parts]), Some([_, by_height])) => -by_parts / by_height,
                    _ => 0.0,
                }
            }
        };
        let (_, design) = self.design_along(built, dual, 1, direction, rise);
        let slopes = design.iter().map(|p| p.map(|c| c.partials[0]));
        (slopes.collect(), rise)
    }

    /// Returns the derivatives of every point of the built design with respect to the height of the wheel centre. The
    /// parts do not change.
    pub(super) fn design_by_height(&self, built: &Built) -> Vec<Vector3<f64>> {
        let (_, design) = self.design_along(built, dual, 1, &[], 1.0);
        design.iter().map(|p| p.map(|c| c.partials[0])).collect()
    }

    /// Returns the derivatives of the tensions in the links of an axle on five links along a direction of the parts, at
    /// constant height.
    pub(crate) fn tensions_by(&self, built: &Built, direction: &Direction) -> Tensions {
        built.tensions?;
        let mut parts = built.parts.map(|value| dual(value, 0.0));
        for (parameter, share) in direction {
            let mechanism = &self.suspension().mechanism;
            parts.change(mechanism, *parameter, dual(0.0, *share));
        }
        let height = dual(built.height, 0.0);
        let (_, tensions) = self.relaxed_series(&parts, height, &built.at, 1);
        Some(tensions.each(|tension| tension.partials[0]))
    }

    /// Returns the built design as a Taylor series to second order along a direction, at constant height.
    pub fn design_series(&self, built: &Built, direction: &Direction) -> Vec<Vector3<Jet<f64, 3>>> {
        let number = |value, by| Jet([value, by, 0.0]);
        self.design_along(built, number, 2, direction, 0.0).1
    }

    /// Returns the rotation of a solid axle from the nominal design, and the displacement of the midpoint between both wheel
    /// centres. For a twist beam, returns the rotation of the near half (the half of the wheel whose mechanism is used). Both
    /// results contain their derivatives along a direction of the parts, at constant height. `None` for another suspension.
    pub(super) fn axle_by(
        &self,
        built: &Built,
        direction: &Direction,
    ) -> Option<(Matrix3<Slope>, Vector3<Slope>)> {
        let mechanism = &self.suspension().mechanism;
        let far = mechanism.rigid_axle.as_ref()?.far_centre;
        let (pose, design) = self.design_along(built, dual, 1, direction, 0.0);
        let displacement = |id: PointId| {
            let place = design[id.0];
            place - place.constant(self.suspension().design[id.0])
        };
        let sum = displacement(mechanism.wheel_centre) + displacement(far);
        Some((pose.rotation, sum * dual(0.5, 0.0)))
    }
}

/// Makes a number from a value and its derivative.
fn dual(value: f64, by: f64) -> Slope {
    Dual {
        value,
        partials: [by],
    }
}
