//! Certifies that poses lie on the solution branch of the design position, by a chain of certified steps.

use super::{Certificate, Certifier};
use crate::derive::MotionPoint;
use crate::mechanism::Pose;
use crate::mechanism::Unproven;
use crate::mechanism::{DesignFault, Failure};
use crate::model::Drive;
use crate::solve::Station;
use crate::solve::{Solver, StationOrder};
use std::ops::ControlFlow;

/// Largest number of steps that are tried from one station to the next.
const MOST_STEPS: usize = 4096;
/// Largest number of times that a certified step is halved.
const MOST_HALVINGS: usize = 40;

impl Solver<'_> {
    /// Visits stations like [`Solver::for_each_pose`], and certifies two facts for every pose. The pose is within its
    /// error bound of an exact pose, and it lies on the solution branch of the design position. A pose that cannot be
    /// certified counts as a failure.
    ///
    /// # Errors
    /// Returns the fault of the design if the design position is singular.
    pub fn for_each_certified_pose(
        &mut self,
        certifier: &Certifier,
        drive: Drive,
        station_order: &StationOrder,
        rack: f64,
        visit: impl FnMut(&Self, usize, Result<(&Pose<f64>, Certificate), Failure>) -> ControlFlow<()>,
    ) -> Result<(), DesignFault> {
        let mut found: Vec<Result<Pose<f64>, Failure>> =
            vec![Err(Failure::Singular); station_order.values().len()];
        self.for_each_pose(drive, station_order, rack, |_, station, pose| {
            found[station] = pose.copied();
            ControlFlow::Continue(())
        })?;
        self.prove_poses(certifier, drive, station_order, rack, &found, visit)
    }

    /// Certifies poses that were found at the stations: each is within its error bound of an exact pose, and lies on
    /// the solution branch of the design position. The function calls `visit` with each certified pose. For every other
    /// pose, it calls `visit` with the reason.
    ///
    /// # Errors
    /// Returns the fault of the design if the design position itself is singular.
    pub fn prove_poses(
        &mut self,
        certifier: &Certifier,
        drive: Drive,
        station_order: &StationOrder,
        rack: f64,
        found: &[Result<Pose<f64>, Failure>],
        mut visit: impl FnMut(
            &Self,
            usize,
            Result<(&Pose<f64>, Certificate), Failure>,
        ) -> ControlFlow<()>,
    ) -> Result<(), DesignFault> {
        let start = match self.placed(drive, rack)? {
            Ok(placed) => {
                let design = self.design_place(drive);
                Proved::new(certifier, design)
                    .and_then(|from| self.prove_path(certifier, from, placed))
                    .map_err(Failure::Uncertified)
            }
            Err(failure) => Err(failure),
        };
        for side in station_order.sides() {
            let mut from = start;
            for station in side {
                let point = MotionPoint {
                    drive,
                    value: station_order.values()[*station],
                    rack,
                };
                let certified = found[*station].and_then(|pose| {
                    self.prove_path(certifier, from?, (pose, point))
                        .map_err(Failure::Uncertified)
                });
                // The chain cannot continue beyond a station that fails. So all stations farther out on this side of
                // the design position fail, too.
                from = certified;
                let shown = match &certified {
                    Ok(proved) => Ok((&proved.place.0, proved.certificate)),
                    Err(failure) => Err(*failure),
                };
                if visit(self, *station, shown).is_break() {
                    return Ok(());
                }
            }
        }
        Ok(())
    }

    /// Certifies that two poses lie on the same solution branch, in as many steps as needed.
    fn prove_path(
        &mut self,
        certifier: &Certifier,
        mut from: Proved,
        to: Station,
    ) -> Result<Proved, Unproven> {
        if from.place == to {
            return Ok(from);
        }
        // Poses that the chain still has to reach. The nearest of them is the last in the list.
        let mut goals = vec![(Proved::new(certifier, to)?, 0)];
        for _ in 0..MOST_STEPS {
            let Some(&(goal, depth)) = goals.last() else {
                return Ok(from);
            };
            let failed = match from.reaches(certifier, &goal) {
                Ok(()) => {
                    from = goal;
                    goals.pop();
                    continue;
                }
                Err(failed) => failed,
            };
            if depth == MOST_HALVINGS {
                return Err(failed);
            }
            let ((_, start), (_, end)) = (from.place, goal.place);
            let between = MotionPoint {
                drive: end.drive,
                value: 0.5 * (start.value + end.value),
                rack: 0.5 * (start.rack + end.rack),
            };
            let middle = self
                .follow(&from.place, &between)
                .map_err(|_| Unproven::Branch)?;
            let top = goals.last_mut().expect("checked above");
            top.1 += 1;
            let depth = top.1;
            // If the pose in the middle cannot be certified, a shorter step to this pose cannot help.
            goals.push((Proved::new(certifier, (middle, between))?, depth));
        }
        Err(Unproven::Branch)
    }
}

/// A certified pose.
#[derive(Clone, Copy)]
struct Proved {
    place: Station,
    certificate: Certificate,
}

impl Proved {
    fn new(certifier: &Certifier, place: Station) -> Result<Self, Unproven> {
        let certificate = certifier.pose(&place.0, &place.1)?;
        Ok(Proved { place, certificate })
    }

    /// Certifies that another pose lies on the same solution branch, in one step along the straight line between the
    /// poses.
    fn reaches(&self, certifier: &Certifier, other: &Self) -> Result<(), Unproven> {
        let ((from, start), (to, end)) = (&self.place, &other.place);
        let errors = [self.certificate.error, other.certificate.error];
        certifier.line((from, start), (to, end), errors)
    }
}
