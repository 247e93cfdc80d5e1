//! An elastic axle over numbers on a tape that has some of its inputs.

use super::equations::AxleState;
use super::{AxleCompliance, AxleEquilibrium, ElasticAxle};
use crate::compliance::HeldQuantity;
use crate::compliance::fault::AxleFault;
use crate::compliance::inputs::{Parameter, law_of};
use crate::compliance::system::Hold;
use crate::model::Suspension;
use crate::number::{Scalar, Tape, Tracked, Vector3};

/// An elastic axle over numbers on a tape.
#[derive(Clone, Debug)]
pub struct AxleOnTape<'t> {
    /// The axle.
    pub axle: ElasticAxle<Tracked<'t>>,
}

impl<'t> AxleOnTape<'t> {
    /// The axle with these inputs, which get the first numbers of the tape in their order. Hardpoints and parts of both
    /// wheels change together, as mirror images. An input that the axle does not have changes nothing.
    pub fn new(
        suspensions: [&Suspension; 2],
        designs: [&[Vector3<f64>]; 2],
        parts: &AxleCompliance,
        parameters: &[Parameter],
        tape: &'t Tape,
    ) -> Result<Self, AxleFault> {
        let constant = |point: &Vector3<f64>| point.map(Tracked::constant);
        let mut tracked = designs.map(|design| design.iter().map(constant).collect::<Vec<_>>());
        let mut parts = parts.map(Tracked::constant);
        // Inputs come first on the tape, so that they are numbered from 0.
        let changes: Vec<Tracked<'t>> = parameters.iter().map(|_| tape.input(0.0)).collect();
        for (parameter, change) in parameters.iter().zip(changes) {
            if let Parameter::Point(point, axis) = *parameter {
                for design in &mut tracked {
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
            for wheel in parts.wheels.iter_mut().filter(|_| is_known) {
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

    /// An equilibrium of the axle in plain numbers, with the derivatives by the inputs. What is held there stays.
    pub fn carried(&self, at: &AxleEquilibrium) -> Option<AxleEquilibrium<Tracked<'t>>> {
        let task = super::equations::AxleTask {
            rack: Tracked::constant(at.task.rack),
            wheels: at
                .task
                .wheels
                .each_ref()
                .map(|task| task.map(Tracked::constant)),
        };
        let state: &AxleState<f64> = &at.state;
        self.axle.carried(state, &task)
    }

    /// An equilibrium under loads beside those of a station, with the derivatives by the inputs. What is held is the
    /// station's, whose heights or wheel loads may change with the inputs.
    pub fn carried_about(
        &self,
        station: &AxleEquilibrium<Tracked<'t>>,
        at: &AxleEquilibrium,
        held: HeldQuantity,
    ) -> Option<AxleEquilibrium<Tracked<'t>>> {
        let (_, base) = self.axle.held_as(station, held);
        let mut task = super::equations::AxleTask {
            rack: base.rack,
            wheels: at
                .task
                .wheels
                .each_ref()
                .map(|task| task.map(Tracked::constant)),
        };
        for (task, base) in task.wheels.iter_mut().zip(&base.wheels) {
            if let Hold::Load = base.hold {
                let change = task.loads.contact.z.value() - base.loads.contact.z.value();
                task.loads.contact.z = base.loads.contact.z + Tracked::constant(change);
            }
            task.hold = base.hold;
        }
        self.axle.carried(&at.state, &task)
    }
}
