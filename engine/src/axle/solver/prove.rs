//! Certifies that poses lie on the solution branch of the design position.

use super::AxleSolver;
use crate::analyse::Certifier;
use crate::mechanism::{Failure, NoPose, Pose, Unproven};
use crate::model::{Drive, Side};
use crate::solve::StationOrder;
use std::ops::ControlFlow;

impl<const N: usize> AxleSolver<'_, N> {
    /// Certifies that poses of one wheel lie on the solution branch of its design position. `travels` contains the
    /// travel of each pose. All poses have the same rack displacement. For a rigid axle, `travels` contains half the
    /// differences of travels, and the mean travel takes the place of the rack displacement.
    pub(in crate::axle) fn prove_branch(
        &mut self,
        certifier: &Certifier,
        side: Side,
        rack: f64,
        (travels, poses): (&[f64], &[Pose<f64>]),
    ) -> Vec<Result<(), NoPose>> {
        let corner = &mut self.corners[side as usize];
        let order = StationOrder::through(travels);
        let found: Vec<_> = poses.iter().copied().map(Ok).collect();
        let mut proved = vec![Err(Failure::Uncertified(Unproven::Branch)); travels.len()];
        let rack = rack * corner.rack_sign;
        // The constructor has already checked the design position, so the call cannot fail there.
        let _ = corner.solver.prove_poses(
            certifier,
            Drive::Travel,
            &order,
            rack,
            &found,
            |_, station, certified| {
                proved[station] = certified.map(|_| ());
                ControlFlow::Continue(())
            },
        );
        let wheel = |(proved, travel): (Result<(), Failure>, &f64)| {
            proved.map_err(|failure| corner.fails(*travel, failure))
        };
        proved.into_iter().zip(travels).map(wheel).collect()
    }
}
