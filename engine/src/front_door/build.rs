//! Construction of suspensions from numbers, with a check that the design position can be solved.

use crate::curves::{Status, curves};
use crate::mechanism::{BuildError, SuspensionBuilder};
use crate::model::Suspension;
use crate::plan::Plan;
use crate::study::WheelStudy;

impl SuspensionBuilder {
    /// Returns the suspension after a check of its design position: the suspension has a pose, and the drive can move the
    /// wheel from this pose.
    ///
    /// # Errors
    /// Returns the first error in the hardpoints, in other inputs, or in the design position.
    pub fn build(self) -> Result<Suspension, BuildError> {
        let own = WheelStudy::of(self.assemble()?);
        let suspension = &own.suspension;
        let solved = curves(suspension, &Plan::of(&own))
            .map_err(|fault| BuildError::Design(fault.describe(&suspension.mechanism)))?;
        for station in &solved.stations {
            if let Status::Failed(failure) = station.status {
                return Err(BuildError::Design(format!(
                    "the mechanism cannot be assembled in its design position: {}",
                    failure.describe(suspension.length_unit, suspension.frame)
                )));
            }
        }
        Ok(own.suspension)
    }
}
