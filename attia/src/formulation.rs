//! Registers the formulation `point_coordinates` for studies.

use super::{Drive, PointCoordinates, Pose, Rates, Refusal, Strut, StrutPoints};
use hardpoint_engine::mechanism::{self, DesignFault, Failure, FormulationFailure, Work};
use hardpoint_engine::model::{self, Suspension};
use hardpoint_engine::number::Jet;
use hardpoint_engine::solve::{
    self, Formulation, FormulationMotion, FormulationPose, FormulationVisit,
};

/// Makes `formulation = "point_coordinates"` available to studies in this process. Further calls do nothing.
pub fn register() {
    solve::register_formulation(&PaperFormulation);
}

/// The paper's equations as a formulation of studies.
struct PaperFormulation;

impl Formulation for PaperFormulation {
    fn poses(
        &self,
        suspension: &Suspension,
        motion: &FormulationMotion<'_>,
        visit: &mut dyn FnMut(FormulationVisit),
    ) -> Result<Work, DesignFault> {
        let strut = Strut::of(&suspension.mechanism, &suspension.design)
            .expect("the study requires a strut");
        let driven = Driven::new(&strut, motion.drive, motion.coefficients)?;
        let values: Vec<f64> = motion.values.iter().map(|v| v * driven.sense).collect();
        for (i, rack) in motion.racks.iter().enumerate() {
            let start = match driven.equations.placed(*rack) {
                Ok(start) => start,
                Err(refusal) => {
                    for number in 0..values.len() {
                        visit(FormulationVisit::Station {
                            rack: i,
                            number,
                            found: Err(driven.failure(refusal)),
                        });
                    }
                    continue;
                }
            };
            if let Ok(pose) = driven.series(&start) {
                visit(FormulationVisit::Start {
                    pose,
                    rack: start.station().rack,
                });
            }
            let start_value = start.station().value;
            let equations = &driven.equations;
            equations.for_each_pose(&start, &values, &mut |number, pose| {
                let found = pose.and_then(|pose| {
                    Ok(FormulationPose {
                        pose: driven.series(pose)?,
                        rack: pose.station().rack,
                        condition: equations.condition(pose),
                        drive: pose.station().value - start_value,
                    })
                });
                visit(FormulationVisit::Station {
                    rack: i,
                    number,
                    found: found.map_err(|refusal| driven.failure(refusal)),
                });
            });
        }
        Ok(driven.equations.work())
    }
}

/// The paper's equations, with the drive of the study.
struct Driven {
    equations: PointCoordinates,
    drive: Drive,
    /// Factor that converts a drive value of the study to a drive value of the equations.
    sense: f64,
    coefficients: usize,
}

impl Driven {
    fn new(strut: &Strut, drive: Drive, coefficients: usize) -> Result<Self, DesignFault> {
        let sense = match drive {
            Drive::Travel | Drive::PaperTheta => 1.0,
            Drive::ArmAngle => strut.raising_turn(),
        };
        let equations =
            PointCoordinates::new(strut, StrutPoints::Spread, drive).map_err(|refusal| {
                let failure = failure_of(refusal, drive);
                DesignFault::PointCoordinates(failure)
            })?;
        Ok(Driven {
            equations,
            drive,
            sense,
            coefficients,
        })
    }

    /// Converts a refusal of the paper's equations to a failure of the engine. The failure contains the drive value with the
    /// sign of the study.
    fn failure(&self, refusal: Refusal) -> Failure {
        let refusal = match refusal {
            Refusal::Unreachable { value, limit } => Refusal::Unreachable {
                value: value * self.sense,
                limit,
            },
            other => other,
        };
        Failure::PointCoordinates(failure_of(refusal, self.drive))
    }

    /// Taylor series of the knuckle pose along the drive of the study.
    fn series(&self, pose: &Pose) -> Result<mechanism::Pose<Jet<f64, 3>>, Refusal> {
        let rates = Rates {
            drive: self.sense,
            ..Rates::default()
        };
        // Rates need a matrix factorisation, so they are computed only on request.
        match self.coefficients {
            1 => {
                let pose = self.equations.knuckle_pose::<1>(pose, rates)?;
                Ok(pose.map(|c| Jet::constant(c[0])))
            }
            _ => self.equations.knuckle_pose(pose, rates),
        }
    }
}

/// Converts a refusal to the failure that the engine reports.
fn failure_of(refusal: Refusal, drive: Drive) -> FormulationFailure {
    match refusal {
        Refusal::Singular(cause) => FormulationFailure::Singular {
            cause: cause.words(),
        },
        Refusal::Unreachable { value, limit } => {
            let cause = limit.words();
            let drive = match drive {
                Drive::Travel => model::Drive::Travel,
                Drive::ArmAngle => model::Drive::ArmAngle,
                Drive::PaperTheta => return FormulationFailure::ThetaEnds { value, cause },
            };
            FormulationFailure::DriveEnds {
                drive,
                value,
                cause,
            }
        }
        Refusal::RackUnreachable { limit } => FormulationFailure::RackEnds {
            cause: limit.words(),
        },
        Refusal::NotFinite => FormulationFailure::NotFinite,
    }
}
