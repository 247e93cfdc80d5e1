//! Axles with elastic parts: quantities of an axle in equilibrium, including test results.
//!
//! Each wheel is on a level pad at a given height, without horizontal loads ([`crate::compliance`]). Each quantity
//! keeps its name, sign and formula. It is computed in the equilibrium instead of the pose of the rigid mechanism.

mod curves;
mod figure;
mod loads;
mod reading;

pub(super) use curves::curves;
pub use figure::TestFigure;
pub use reading::not_in_equilibrium;
pub(crate) use reading::{AxleRead, Equilibria};
