//! Axles with elastic parts: the quantities of an axle in equilibrium, and figures of tests among them.
//!
//! Both wheels stand on level pads at given heights, without horizontal loads ([`crate::compliance`]). A quantity keeps its
//! name, sign and formula; it is read in the equilibrium in place of the rigid mechanism's position.

mod curves;
mod figure;
mod reading;

pub(super) use curves::curves;
pub use figure::TestFigure;
pub use reading::not_in_equilibrium;
pub(crate) use reading::{AxleRead, Equilibria};
