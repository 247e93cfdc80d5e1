//! Running a plan with the formulation in point coordinates.

use super::run::{Findings, Run};
use crate::attia::{self, PointCoordinates, Pose, Rates, Refusal, Strut, StrutPoints};
use crate::mechanism::{Configuration, DesignFault, Failure};
use crate::number::Jet;
use crate::study::Drive;

/// The paper's equations with the study's drive.
struct Driven {
    equations: PointCoordinates,
    drive: attia::Drive,
    /// Factor from a drive value of the study to one of the equations.
    sense: f64,
}

impl Driven {
    fn new(strut: &Strut, drive: Drive) -> Result<Self, DesignFault> {
        let (drive, sense) = match drive {
            Drive::Travel => (attia::Drive::Travel, 1.0),
            Drive::ArmAngle => (attia::Drive::ArmAngle, strut.raising_turn()),
            Drive::PaperTheta => (attia::Drive::PaperTheta, 1.0),
        };
        let equations = PointCoordinates::new(strut, StrutPoints::Spread, drive)
            .map_err(DesignFault::PointCoordinates)?;
        Ok(Driven {
            equations,
            drive,
            sense,
        })
    }

    fn failure(&self, refusal: Refusal) -> Failure {
        let refusal = match refusal {
            Refusal::Unreachable { value, limit } => Refusal::Unreachable {
                value: value * self.sense,
                limit,
            },
            other => other,
        };
        Failure::PointCoordinates {
            drive: self.drive,
            refusal,
        }
    }
}

impl<const N: usize> Run<'_, N> {
    pub(super) fn by_point_coordinates(&mut self) -> Result<(), DesignFault> {
        let (suspension, plan) = (self.suspension, self.plan);
        let strut = Strut::of(&suspension.mechanism, &suspension.design)
            .expect("the study has seen to it that the suspension is a strut");
        let driven = Driven::new(&strut, plan.drive)?;
        let values: Vec<f64> = plan
            .station_order
            .values()
            .iter()
            .map(|v| v * driven.sense)
            .collect();
        for (i, rack) in plan.racks.iter().enumerate() {
            let start = match driven.equations.placed(rack * plan.rack_sign) {
                Ok(start) => start,
                Err(refusal) => {
                    for number in 0..values.len() {
                        self.note(i, number, Err(driven.failure(refusal)));
                    }
                    continue;
                }
            };
            if let Ok(at) = self.configuration(&driven, &start) {
                self.toggles.begin_at(&at);
            }
            let start_value = start.station().value;
            driven
                .equations
                .for_each_pose(&start, &values, &mut |number, pose| {
                    let read = |pose: &Pose| {
                        let configuration = self.configuration(&driven, pose)?;
                        Ok(Findings {
                            condition: Some(driven.equations.condition(pose)),
                            ..self.values(
                                None,
                                &configuration,
                                number,
                                pose.station().value - start_value,
                            )
                        })
                    };
                    let found = pose
                        .and_then(read)
                        .map_err(|refusal| driven.failure(refusal));
                    self.note(i, number, found);
                });
        }
        self.work = driven.equations.work();
        Ok(())
    }

    fn configuration(
        &self,
        driven: &Driven,
        pose: &Pose,
    ) -> Result<Configuration<'_, Jet<f64, N>>, Refusal> {
        let rates = Rates {
            drive: driven.sense,
            ..Rates::default()
        };
        let series = driven.equations.knuckle_pose(pose, rates)?;
        let rack = Jet::constant(pose.station().rack);
        Ok(self
            .design_series
            .at(&self.suspension.mechanism, series, rack))
    }
}
