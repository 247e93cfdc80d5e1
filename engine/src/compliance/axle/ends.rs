//! Ends of equilibrium of an axle, with the method of `compliance/ends.rs`.

use super::equations::{AxleState, AxleTask};
use super::{AxleEquilibrium, ElasticAxle};
use crate::compliance::ends::{
    DrivingForce, EquilibriumEnd, Event, Followable, NEGATIVE, Way, is_slack,
};
use crate::compliance::fault::{Motion, NoEquilibrium};
use crate::compliance::loads::WheelLoads;
use crate::compliance::solve::Obstacle;
use crate::compliance::wheel::HeldQuantity;
use crate::model::Side;

/// Motion of an axle. The search finds the ends of this motion.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AxleWay {
    /// Travel of one wheel, with the other wheel at the design height.
    Travel(Side),
    /// Equal travels of both wheels.
    Heave,
    /// Left travel minus right travel, at zero mean travel.
    TravelDifference,
    /// Displacement of the rack along the left wheel's +y, at the design heights.
    Rack,
}

impl Followable for ElasticAxle {
    type State = AxleState<f64>;
    type Task = AxleTask<f64>;

    fn settle(
        &self,
        from: &AxleState<f64>,
        task: &AxleTask<f64>,
    ) -> Result<AxleState<f64>, (Option<usize>, Obstacle)> {
        let found = self.newton(from, task, None);
        found.map(|(state, _)| state)
    }

    fn force(&self, of: DrivingForce, state: &AxleState<f64>, task: &AxleTask<f64>) -> f64 {
        if of == DrivingForce::Rack {
            return self.rack_force(&equilibrium(state, task));
        }
        let of = |side: usize| state.wheels[side].vertical + task.wheels[side].loads.contact.z;
        let [left, right] = [of(0), of(1)];
        if left.abs() >= right.abs() {
            left
        } else {
            right
        }
    }

    fn is_past(&self, event: Event, state: &AxleState<f64>, task: &AxleTask<f64>) -> bool {
        let at = equilibrium(state, task);
        Side::ALL.into_iter().any(|side| match event {
            Event::WheelLifts => {
                self.spring(&at, side).is_some() && self.wheel_load(&at, side) < -NEGATIVE
            }
            Event::StopMet(stop) => self.spring(&at, side).is_some_and(|own| own.meets(stop)),
            Event::SpringSlack => self.spring(&at, side).as_ref().is_some_and(is_slack),
            Event::Extrapolated => {
                let bushings = self.bushings(&at, side);
                bushings.iter().any(|own| own.is_extrapolated)
            }
        })
    }

    fn softest_motion(
        &self,
        state: &AxleState<f64>,
        task: &AxleTask<f64>,
    ) -> Option<(f64, (String, Motion))> {
        self.softest(state, task)
    }

    fn limb(&self, side: Option<usize>, limb: usize) -> (String, Motion) {
        self.limb_of(side.unwrap_or(0), limb)
    }
}

/// Makes an equilibrium from a state in balance and its inputs (loads, held heights and rack displacement).
fn equilibrium(state: &AxleState<f64>, task: &AxleTask<f64>) -> AxleEquilibrium {
    AxleEquilibrium {
        state: *state,
        task: *task,
        steps: 0,
    }
}

impl ElasticAxle {
    /// Returns the smallest and the largest value of a motion at which an equilibrium exists.
    pub fn motion_ends(&self, way: AxleWay) -> Result<[EquilibriumEnd; 2], NoEquilibrium> {
        let at = self.at([0.0; 2], 0.0)?;
        let force = match way {
            AxleWay::Rack => DrivingForce::Rack,
            _ => DrivingForce::ContactPoint,
        };
        let ways = Way::of_motion(self.wheels[0].bounds.millimetre, force);
        Ok(self.ends(&at.state, ways, |value| match way {
            AxleWay::Travel(Side::Left) => self.level([value, 0.0], 0.0),
            AxleWay::Travel(Side::Right) => self.level([0.0, value], 0.0),
            AxleWay::Heave => self.level([value; 2], 0.0),
            AxleWay::TravelDifference => self.level([0.5 * value, -0.5 * value], 0.0),
            AxleWay::Rack => self.level([0.0; 2], value),
        }))
    }

    /// Returns the smallest and the largest factor on the loads `unit` with which an equilibrium exists. These loads
    /// act in addition to the loads of a station.
    pub(in crate::compliance) fn load_ends(
        &self,
        station: &AxleEquilibrium,
        unit: &[WheelLoads; 2],
        held: HeldQuantity,
        ways: [Way; 2],
    ) -> [EquilibriumEnd; 2] {
        let (state, base) = self.held_as(station, held);
        self.ends(&state, ways, |factor| {
            let mut task = base;
            for (own, unit) in task.wheels.iter_mut().zip(unit) {
                own.loads = own.loads.plus(unit, factor);
            }
            task
        })
    }
}
