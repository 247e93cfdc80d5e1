//! The language of requests: plain data without numerics.
//!
//! [`Unit`] is the kind of a number and its printed unit, [`Need`] a figure or part that a quantity requires, and
//! [`Info`] the catalogue's entry of a quantity, of a wheel or of an axle.

mod info;
mod need;
mod unit;

pub use info::Info;
pub use need::Need;
pub use unit::{Unit, with_unit};
