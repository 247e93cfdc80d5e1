//! Largest test loads that an axle can carry, and ends of its motions from the design position.

use super::{AxleKcRun, KcTest, end_loads};
use crate::compliance::ends::EquilibriumEnd;
use crate::compliance::{AxleWay, NoEquilibrium};
use crate::number::Each;

impl AxleKcRun<'_> {
    /// Returns the smallest and the largest load of a test with which the axle has an equilibrium, under the conditions
    /// of the test.
    pub fn load_ends(&self, test: &KcTest) -> Result<[EquilibriumEnd; 2], NoEquilibrium> {
        let here = self.here(test.conditions(), [0.0; 2], 0.0, [])?;
        let suspension = self.vehicle.suspensions[0];
        let (load, _) = test.unit_load(&suspension.vehicle);
        let unit = test.factors().each(|factor| end_loads(&load, factor));
        let ways = test.ways(suspension.length_unit);
        Ok(here.axle.load_ends(&here.at, &unit, test.held, ways))
    }

    /// Returns the smallest and the largest value of a motion at which an equilibrium exists. The anti-roll bar is
    /// connected, and the steering wheel is held.
    pub fn motion_ends(&self, way: AxleWay) -> Result<[EquilibriumEnd; 2], NoEquilibrium> {
        self.axle.motion_ends(way)
    }
}
