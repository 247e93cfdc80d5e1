//! Remarks on `kc` tests: stations and load levels without equilibrium, and warnings.

use super::{KcResults, no_equilibrium};
use crate::axle::Stop;
use crate::compliance::{KcWheelState, TestLoad};

impl KcResults<'_> {
    /// True if every station and every load level has an equilibrium.
    pub fn is_complete(&self) -> bool {
        self.failures().is_empty()
    }

    /// Stations and load levels without equilibrium, one per line. For each test, the list has only the failed level nearest to 0
    /// in each direction.
    pub fn failures(&self) -> Vec<String> {
        let u = self.length().symbol();
        let mut failures = Vec::new();
        for station in &self.stations {
            let at = self.station_name(station);
            match &station.outcomes {
                Err(why) => failures.push(format!("{at}: {}", no_equilibrium(why))),
                Ok(outcomes) => {
                    for outcome in outcomes {
                        let levels = outcome.levels.iter();
                        let missing = levels
                            .filter_map(|level| Some((level.load, level.state.as_ref().err()?)));
                        let (negative, positive): (Vec<_>, Vec<_>) =
                            missing.partition(|(load, _)| *load < 0.0);
                        let nearest = [negative, positive].map(|found| {
                            let found = found.into_iter();
                            found.min_by(|(a, _), (b, _)| a.abs().total_cmp(&b.abs()))
                        });
                        for (load, why) in nearest.into_iter().flatten() {
                            let unit = match outcome.test.load {
                                TestLoad::Aligning => format!("N {u}"),
                                _ => "N".to_owned(),
                            };
                            failures.push(format!(
                                "{at}, {} at {} {unit}: {}",
                                self.test_name(&outcome.test),
                                super::super::brief(load),
                                no_equilibrium(why)
                            ));
                        }
                    }
                }
            }
        }
        failures
    }

    /// Warnings about load levels. They name bushings beyond their force curve or turned by more than 60 degrees, and wheels that
    /// lift. A remark without the word "warning" states how often a spring's stop is in contact. For an axle, the states of both
    /// wheels are counted.
    pub fn warnings(&self) -> Vec<String> {
        let outcomes = self
            .stations
            .iter()
            .flat_map(|s| s.outcomes.iter().flatten());
        let states = outcomes
            .flat_map(|outcome| &outcome.levels)
            .filter_map(|level| level.state.as_ref().ok());
        let states: Vec<&KcWheelState> = states.flat_map(|state| &state.wheels).collect();
        let mut warnings = Vec::new();
        for (k, name) in self.bushings.iter().enumerate() {
            // The right half of a solid axle has no bushings of parts in the middle of the axle.
            let own = || states.iter().filter_map(|state| state.bushings.get(k));
            let count = own().filter(|found| found.is_extrapolated).count();
            if count > 0 {
                warnings.push(format!(
                    "warning: {name} is beyond its curve, or turned by more than 60 degrees, in \
                     {} of {} states; the force law is extended by a straight line",
                    count,
                    own().count()
                ));
            }
        }
        let lifted = states.iter().filter(|s| s.wheel_load < 0.0).count();
        let carries = states.iter().any(|s| s.spring.is_some());
        if lifted > 0 && carries {
            warnings.push(format!(
                "warning: the wheel load is below 0 in {lifted} of {} states: the wheel lifts",
                states.len()
            ));
        }
        for stop in Stop::ALL {
            let meets = |s: &&&KcWheelState| s.spring.is_some_and(|spring| spring.meets(stop));
            let stopped = states.iter().filter(meets).count();
            if stopped > 0 {
                warnings.push(format!(
                    "the {} is in contact in {stopped} of {} states",
                    stop.name(),
                    states.len()
                ));
            }
        }
        warnings
    }
}
