//! Proof that poses lie on the branch of the design position: a chain of proved steps.

use super::{Certificate, Certifier};
use crate::derive::MotionPoint;
use crate::mechanism::Pose;
use crate::mechanism::Unproven;
use crate::mechanism::{DesignFault, Failure};
use crate::model::Drive;
use crate::solve::Station;
use crate::solve::{Solver, StationOrder};
use std::ops::ControlFlow;

/// Largest number of steps in the proof of a path from one station to the next.
const MOST_STEPS: usize = 4096;
/// Largest number of halvings of such a step.
const MOST_HALVINGS: usize = 40;

impl Solver<'_> {
    /// Visits stations like [`Solver::for_each_pose`], with two proofs for every pose: that it is right, and that it lies on the
    /// branch of the design position. A pose without proof counts as a failure.
    ///
    /// # Errors
    /// If the design position is singular.
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

    /// Proves poses that were found at the stations: that each is right, and that it lies on the branch of the design
    /// position. `visit` gets the proved poses, and the reasons why the others are not proved.
    ///
    /// # Errors
    /// If the design position itself is singular.
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
                // No pose is proved beyond a gap in the proof. An unreachable station ends its side in any case.
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

    /// Proves that a pose lies on the same branch as another one, in as many steps as needed.
    fn prove_path(
        &mut self,
        certifier: &Certifier,
        mut from: Proved,
        to: Station,
    ) -> Result<Proved, Unproven> {
        if from.place == to {
            return Ok(from);
        }
        // Poses that remain to be proved to be on the branch. The nearest is last.
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
            // If an end itself is not proved, a shorter step to it cannot prove it.
            goals.push((Proved::new(certifier, (middle, between))?, depth));
        }
        Err(Unproven::Branch)
    }
}

/// A pose that is proved right.
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

    /// Proves that the straight line to another pose follows one branch.
    fn reaches(&self, certifier: &Certifier, other: &Self) -> Result<(), Unproven> {
        let ((from, start), (to, end)) = (&self.place, &other.place);
        let errors = [self.certificate.error, other.certificate.error];
        certifier.line((from, start), (to, end), errors)
    }
}
