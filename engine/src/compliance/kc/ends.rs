//! Largest test loads that a wheel can carry, at the design height and at rack displacement 0.

use super::{KcRun, KcTest, TestLoad};
use crate::compliance::NoEquilibrium;
use crate::compliance::ends::{EquilibriumEnd, Way};
use crate::model::LengthUnit;

impl KcTest {
    /// Ranges of the search for an end of equilibrium, in both directions of the test load.
    pub(super) fn ways(&self, length: LengthUnit) -> [Way; 2] {
        match self.load {
            TestLoad::Aligning => Way::of_moment(length),
            _ => Way::of_load(),
        }
    }
}

impl KcRun<'_> {
    /// Returns the smallest and the largest load of a test with which the wheel has an equilibrium. Tests of motions
    /// have no load. For the ends of motions, see [`crate::compliance::ElasticWheel::travel_ends`] and `rack_ends`.
    pub fn load_ends(&self, test: &KcTest) -> Result<[EquilibriumEnd; 2], NoEquilibrium> {
        let at = self.wheel.at(0.0, 0.0)?;
        let (unit, _) = test.unit_load(&self.suspension.vehicle);
        let ways = test.ways(self.suspension.length_unit);
        Ok(self.wheel.load_ends(&at, &unit, test.held, ways))
    }
}
