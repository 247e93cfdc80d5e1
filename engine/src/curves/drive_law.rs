//! Motion of a study, expressed in a drive that the solver supports.

use super::PaperTheta;
use crate::derive::MotionPoint;
use crate::mechanism::DesignFault;
use crate::model::Suspension;
use crate::number::Jet;
use crate::plan::Plan;
use crate::solve::StationOrder;
use crate::study::Drive;

/// Stations of a motion as values of a drive that the solver supports, and the order in which they are visited.
pub struct DriveLaw {
    drive: Drive,
    /// Conversion of the drive, if the solver does not support the study's drive directly.
    law: Option<PaperTheta>,
    /// Values of the solver's drive, and the order in which the solver visits them.
    pub station_order: StationOrder,
    /// For each value of the solver's drive, the index of its station in the motion.
    pub stations: Vec<usize>,
}

impl DriveLaw {
    /// Expresses the motion of a plan for this design. The result omits stations that the solver's drive cannot express.
    pub fn of(suspension: &Suspension, plan: &Plan) -> Result<Self, DesignFault> {
        let law = match plan.drive {
            Drive::Travel | Drive::ArmAngle => None,
            Drive::PaperTheta => Some(PaperTheta::of(&suspension.mechanism, &suspension.design)?),
        };
        let all = plan.station_order.values().iter().enumerate();
        let (stations, station_order) = match law {
            None => (
                all.map(|(number, _)| number).collect(),
                plan.station_order.clone(),
            ),
            Some(law) => {
                let angle = |theta: f64| law.arm_angle(Jet::<f64, 1>::constant(theta));
                let found = all.filter_map(|(number, theta)| Some((number, angle(*theta)?[0])));
                let (stations, angles): (Vec<_>, Vec<_>) = found.unzip();
                (stations, StationOrder::through(&angles))
            }
        };
        Ok(DriveLaw {
            drive: plan.drive,
            law,
            station_order,
            stations,
        })
    }

    /// Taylor series of the solver's drive with respect to the study's drive, at a station with this drive value.
    pub fn motion<const N: usize>(&self, value: f64, rack: f64) -> MotionPoint<Jet<f64, N>> {
        let along = Jet::variable(value);
        MotionPoint {
            drive: self.drive.in_kernel(),
            value: match self.law {
                None => along,
                Some(law) => law
                    .arm_angle(along)
                    .expect("stations of the drive law are not dead centres"),
            },
            rack: Jet::constant(rack),
        }
    }
}
