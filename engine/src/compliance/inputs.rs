//! Inputs of an elastic suspension. For derivatives with respect to chosen inputs, a copy of the suspension records its
//! calculations on a tape (reverse differentiation).

use super::definition::{AxialStiffness, Compliance};
use super::fault::ElasticFault;
use super::law::Shape;
use super::system::Hold;
use super::wheel::{ElasticWheel, Equilibrium, HeldQuantity};
use crate::axle::Law;
use crate::mechanism::DesignFault;
use crate::model::{Axis, PointId, Side, Suspension};
use crate::number::{Tape, Tracked, Vector3};

/// Input of an elastic suspension with respect to which results are differentiated. Vectors are in the kernel's frame
/// of a left wheel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Parameter {
    /// Coordinate of a hardpoint. The axes and lengths of parts, and the forces at the design load, change with the
    /// hardpoint.
    Point(PointId, Axis),
    /// Rate of a bushing along an axis (0 to 2) or about an axis (3 to 5). If the law is a force curve: factor on the
    /// forces of the curve.
    Stiffness(usize, usize),
    /// Cubic term of a bushing, if the law is not a force curve.
    Cubic(usize, usize),
    /// Constant force or torque of a bushing.
    Preload(usize, usize),
    /// Component of the direction of a bushing's x axis, if this direction is given.
    AxisX(usize, Axis),
    /// Component of the direction that determines a bushing's z axis, if this direction is given.
    AxisZ(usize, Axis),
    /// Stiffness of a link: force per length or per strain, as the study gives it.
    Link(usize),
    /// Constant tension of a link.
    LinkPreload(usize),
    /// Rate of a linear spring.
    SpringRate,
    /// Force of a linear spring in the design position.
    SpringForce,
    /// Stiffness between the commanded and the actual rack displacement, without the steering column.
    RackRate,
    /// Stiffness of the steering column.
    ColumnRate,
    /// Rate of the anti-roll bar.
    BarRate,
    /// Wheel travel. The equilibrium must be at a given wheel height.
    Travel,
    /// Displacement of the rack along the kernel's +y.
    Rack,
    /// Component of the force at the contact point.
    Contact(Axis),
    /// Side force at the contact point.
    Side,
    /// Component of the force at the wheel centre.
    Centre(Axis),
    /// Component of the moment on the wheel.
    Moment(Axis),
}

/// Input of an axle. It belongs to one wheel or to both wheels. If it belongs to both, the two wheels change as mirror
/// images.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AxleParameter {
    /// Input of one wheel, or of a part that both wheels share.
    pub parameter: Parameter,
    /// Wheel that changes; `None` for both wheels.
    pub side: Option<Side>,
}

/// Reason why a design is refused if a rate is 0 or negative.
pub(crate) const NOT_ABOVE_ZERO: &str = "the rate of an elastic part is not above 0";

impl Parameter {
    /// Checks a value of a parameter that varies. Only the tension of a link may be 0 or negative.
    pub(crate) fn check(self, value: f64) -> Result<(), DesignFault> {
        if value <= 0.0 && !matches!(self, Parameter::LinkPreload(_)) {
            return Err(DesignFault::Elastic(NOT_ABOVE_ZERO.to_owned()));
        }
        Ok(())
    }
}

impl From<Parameter> for AxleParameter {
    fn from(parameter: Parameter) -> Self {
        AxleParameter {
            parameter,
            side: None,
        }
    }
}

impl AxleParameter {
    /// Returns the elements of `wheels` that change.
    pub(super) fn of_sides<'w, W>(
        &self,
        wheels: &'w mut [W; 2],
    ) -> impl Iterator<Item = &'w mut W> + use<'w, W> {
        let side = self.side;
        let wheels = Side::ALL.into_iter().zip(wheels);
        let own = wheels.filter(move |(own, _)| side.is_none_or(|side| side == *own));
        own.map(|(_, wheel)| wheel)
    }
}

impl Compliance {
    /// Sets the value of a parameter, for example the rate of a bushing, a link or a linear spring, or the tension of a
    /// link. If the law of a bushing is a force curve, the value is the factor on the forces of the curve. If these
    /// parts do not have the parameter, nothing changes. The right half of a solid axle does not have the parts that
    /// exist only once.
    pub fn set_rate(&mut self, parameter: Parameter, value: f64) {
        if let Some(number) = law_of(self, parameter) {
            *number = value;
        }
    }

    /// Changes the value of a parameter by `change`. If `is_relative` is true, `change` is a fraction of the value.
    /// Returns false if the new value is not above 0, and true if these parts do not have the parameter.
    pub(crate) fn change_rate(
        &mut self,
        parameter: Parameter,
        change: f64,
        is_relative: bool,
    ) -> bool {
        law_of(self, parameter).is_none_or(|number| scatter_rate(number, change, is_relative))
    }
}

/// Elastic suspension whose numbers are recorded on a tape, for derivatives with respect to inputs.
#[derive(Clone, Debug)]
pub struct OnTape<'t> {
    /// The suspension.
    pub wheel: ElasticWheel<Tracked<'t>>,
    /// Inputs that are loads, travel or rack displacement. Each is an offset whose value is 0.
    added: Vec<(Parameter, Tracked<'t>)>,
}

/// Changes a rate by `change`. If `is_relative` is true, `change` is a fraction of the rate. Returns false if the new
/// rate is not above 0.
pub(super) fn scatter_rate(rate: &mut f64, change: f64, is_relative: bool) -> bool {
    *rate += if is_relative { *rate * change } else { change };
    *rate > 0.0
}

/// Returns the value of a parameter in the laws of bushings, links and spring; `None` if these parts do not have the
/// parameter.
pub(super) fn law_of<T>(parts: &mut Compliance<T>, parameter: Parameter) -> Option<&mut T> {
    match parameter {
        Parameter::Stiffness(bushing, axis) => {
            match &mut parts.bushings.get_mut(bushing)?.shapes[axis] {
                Shape::Cubic { rate, .. } => Some(rate),
                Shape::Curve { scale, .. } => Some(scale),
            }
        }
        Parameter::Cubic(bushing, axis) => match &mut parts.bushings.get_mut(bushing)?.shapes[axis]
        {
            Shape::Cubic { cubic, .. } => Some(cubic),
            Shape::Curve { .. } => None,
        },
        Parameter::Preload(bushing, axis) => {
            Some(&mut parts.bushings.get_mut(bushing)?.preload[axis])
        }
        Parameter::AxisX(bushing, axis) => {
            let given = parts.bushings.get_mut(bushing)?.x_axis.as_mut();
            given.map(|direction| &mut direction[axis])
        }
        Parameter::AxisZ(bushing, axis) => {
            let given = parts.bushings.get_mut(bushing)?.z_axis.as_mut();
            given.map(|direction| &mut direction[axis])
        }
        Parameter::Link(link) => match &mut parts.links.get_mut(link)?.stiffness {
            AxialStiffness::Rate(rate) => Some(rate),
            AxialStiffness::PerStrain(force) => Some(force),
        },
        Parameter::LinkPreload(link) => Some(&mut parts.links.get_mut(link)?.preload),
        Parameter::SpringRate | Parameter::SpringForce => {
            match &mut parts.spring.as_mut()?.spring {
                Law::Linear { force, rate } => Some(match parameter {
                    Parameter::SpringRate => rate,
                    _ => force,
                }),
                Law::Curve(_) => None,
            }
        }
        _ => None,
    }
}

impl<'t> OnTape<'t> {
    /// Makes the suspension with these inputs. The inputs are the first numbers on the tape, in the order of
    /// `parameters`. An input has no effect if the suspension does not have the part to which it belongs.
    pub fn new(
        suspension: &Suspension,
        design: &[Vector3<f64>],
        compliance: &Compliance,
        parameters: &[Parameter],
        tape: &'t Tape,
    ) -> Result<Self, ElasticFault> {
        let constant = |point: &Vector3<f64>| point.map(Tracked::constant);
        let mut design: Vec<Vector3<Tracked<'t>>> = design.iter().map(constant).collect();
        let mut parts = compliance.map(Tracked::constant);
        let mut added = Vec::new();
        for parameter in parameters {
            match *parameter {
                Parameter::Point(point, axis) => {
                    let coordinate = &mut design[point.0][axis];
                    *coordinate = tape.input(coordinate.plain());
                }
                Parameter::Travel
                | Parameter::Rack
                | Parameter::Contact(_)
                | Parameter::Side
                | Parameter::Centre(_)
                | Parameter::Moment(_) => added.push((*parameter, tape.input(0.0))),
                _ => match law_of(&mut parts, *parameter) {
                    Some(number) => *number = tape.input(number.plain()),
                    None => _ = tape.input(0.0),
                },
            }
        }
        Ok(OnTape {
            wheel: ElasticWheel::of(suspension, &design, &parts)?,
            added,
        })
    }

    /// Adds derivatives with respect to the inputs to an equilibrium of the suspension. The height or the load that the
    /// equilibrium holds stays held. `None` if the tangent is singular.
    pub fn carried(&self, at: &Equilibrium) -> Option<Equilibrium<Tracked<'t>>> {
        let mut task = at.solution.task.map(Tracked::constant);
        for (parameter, added) in &self.added {
            let loads = &mut task.loads;
            let number = match *parameter {
                Parameter::Rack => &mut task.rack,
                Parameter::Contact(axis) => &mut loads.contact[axis],
                Parameter::Side => &mut loads.side,
                Parameter::Centre(axis) => &mut loads.centre[axis],
                Parameter::Moment(axis) => &mut loads.moment[axis],
                _ => match &mut task.hold {
                    Hold::Height(travel) => travel,
                    Hold::Load => continue,
                },
            };
            *number = *number + *added;
        }
        self.wheel.carried(&at.solution.state, &task)
    }

    /// Adds derivatives with respect to the inputs to an equilibrium under loads that act in addition to the loads of a
    /// station. The height or the wheel load of the station stays held. This height or load can depend on the inputs. The
    /// other loads are constants. `None` if the tangent is singular.
    pub fn carried_about(
        &self,
        station: &Equilibrium<Tracked<'t>>,
        at: &Equilibrium,
        held: HeldQuantity,
    ) -> Option<Equilibrium<Tracked<'t>>> {
        let (_, base) = self.wheel.held_as(station, held);
        let mut task = at.solution.task.map(Tracked::constant);
        // The wheel load has the value in the equilibrium `at`, but the derivatives of the station.
        if let Hold::Load = base.hold {
            let change = task.loads.contact.z.plain() - base.loads.contact.z.plain();
            task.loads.contact.z = base.loads.contact.z + Tracked::constant(change);
        }
        task.hold = base.hold;
        task.rack = base.rack;
        self.wheel.carried(&at.solution.state, &task)
    }
}
