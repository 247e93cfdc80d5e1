//! Closure equations, their factorisation and the closed form, without the checks of the solver. `hardpoint-bench` runs them
//! with other number types and other starts. `hardpoint-attia` factorises its own equations. Nothing else may use them.

pub use crate::linear::lu::{Lu, Lu6};
pub use crate::mechanism::{Closure, Driver};
pub use crate::solve::closed_form::{ArmState, ClosedForm, Roles};

use crate::compliance::{ElasticWheel, Equilibrium, WheelFigures};

/// Angles and positions of a wheel in equilibrium. The function is compiled here, and not again in the crate that measures
/// it.
pub fn wheel_figures(wheel: &ElasticWheel, at: &Equilibrium) -> WheelFigures {
    wheel.figures(at)
}
