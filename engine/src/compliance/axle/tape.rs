//! Elastic axle with numbers on a tape: a record of all operations, from which derivatives of results with respect to
//! chosen inputs follow.

use super::equations::AxleTask;
use super::{AxleCompliance, AxleEquilibrium, ElasticAxle};
use crate::compliance::HeldQuantity;
use crate::compliance::fault::AxleFault;
use crate::compliance::inputs::{AxleParameter, Parameter, law_of};
use crate::compliance::system::Hold;
use crate::model::Suspension;
use crate::number::{Each, Scalar, Tape, Tracked, Vector3};

/// Elastic axle whose numbers are recorded on a tape, for derivatives with respect to inputs.
#[derive(Clone, Debug)]
pub struct AxleOnTape<'t> {
    /// The axle.
    pub axle: ElasticAxle<Tracked<'t>>,
}

impl<'t> AxleOnTape<'t> {
    /// Makes the axle with these inputs. The inputs are the first numbers on the tape, in the order of `parameters`. An
    /// input has no effect if the axle does not have the part to which it belongs.
    pub fn new(
        suspensions: [&Suspension; 2],
        designs: [&[Vector3<f64>]; 2],
        parts: &AxleCompliance,
        parameters: &[AxleParameter],
        tape: &'t Tape,
    ) -> Result<Self, AxleFault> {
        let constant = |point: &Vector3<f64>| point.map(Tracked::constant);
        let mut tracked = designs.map(|design| design.iter().map(constant).collect::<Vec<_>>());
        let mut parts = parts.map(Tracked::constant);
        // The inputs are the first numbers on the tape, so their indices start at 0.
        let changes: Vec<Tracked<'t>> = parameters.iter().map(|_| tape.input(0.0)).collect();
        for (of, change) in parameters.iter().zip(changes) {
            let parameter = &of.parameter;
            if let Parameter::Point(point, axis) = *parameter {
                for design in of.of_sides(&mut tracked) {
                    let coordinate = &mut design[point.0][axis];
                    *coordinate = *coordinate + change;
                }
                continue;
            }
            if let Some(number) = parts.shared_number(*parameter) {
                *number = *number + change;
                continue;
            }
            let has_bushing = |number: usize| number < parts.wheels[0].bushings.len();
            let is_known = match *parameter {
                Parameter::Stiffness(number, _)
                | Parameter::Cubic(number, _)
                | Parameter::Preload(number, _)
                | Parameter::AxisX(number, _)
                | Parameter::AxisZ(number, _) => has_bushing(number),
                _ => true,
            };
            for wheel in of.of_sides(&mut parts.wheels).filter(|_| is_known) {
                if let Some(number) = law_of(wheel, *parameter) {
                    *number = *number + change;
                }
            }
        }
        let [left, right] = &tracked;
        Ok(AxleOnTape {
            axle: ElasticAxle::of(suspensions, [left, right], &parts)?,
        })
    }

    /// Adds derivatives with respect to the inputs to an equilibrium of the axle. The heights or loads that the
    /// equilibrium holds stay held.
    pub fn carried(&self, at: &AxleEquilibrium) -> Option<AxleEquilibrium<Tracked<'t>>> {
        self.axle.carried(&at.state, &on_tape(at, at.task.rack))
    }
}

/// Converts the inputs of an equilibrium (loads, held heights and rack displacement) to numbers on a tape. `rack` is
/// the rack displacement.
fn on_tape<'t>(at: &AxleEquilibrium, rack: f64) -> AxleTask<Tracked<'t>> {
    let wheels = at.task.wheels.each_ref();
    AxleTask {
        rack: Tracked::constant(rack),
        wheels: wheels.each(|task| task.map(Tracked::constant)),
    }
}

impl<'t> ElasticAxle<Tracked<'t>> {
    /// Adds derivatives with respect to the inputs to an equilibrium under loads that act in addition to the loads of a
    /// station. The wheel heights or the wheel loads of the station stay held. These heights or loads can depend on the
    /// inputs.
    pub(in crate::compliance) fn carried_about(
        &self,
        station: &AxleEquilibrium<Tracked<'t>>,
        at: &AxleEquilibrium,
        held: HeldQuantity,
    ) -> Option<AxleEquilibrium<Tracked<'t>>> {
        let (_, base) = self.held_as(station, held);
        let mut task = AxleTask {
            rack: base.rack,
            ..on_tape(at, at.task.rack)
        };
        for (task, base) in task.wheels.iter_mut().zip(&base.wheels) {
            if let Hold::Load = base.hold {
                let change = task.loads.contact.z.value() - base.loads.contact.z.value();
                task.loads.contact.z = base.loads.contact.z + Tracked::constant(change);
            }
            task.hold = base.hold;
        }
        self.carried(&at.state, &task)
    }
}
