//! Vocabulary of requests: plain data without numerics.
//!
//! [`Unit`] is the physical type of a number, with its printed unit. [`Need`] is an input or part that a quantity requires.
//! [`Info`] is the catalogue entry of a quantity of a wheel or an axle. [`NoValue`] is the reason why a quantity has no
//! value. [`Accepted`] is the set of values that a study accepts for a number.

mod accepted;
mod info;
mod need;
mod no_value;
mod unit;

pub use accepted::Accepted;
pub(crate) use accepted::six_digits;
pub use info::Info;
pub use need::Need;
pub use no_value::NoValue;
pub use unit::{Unit, degrees, with_unit};
