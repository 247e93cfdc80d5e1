//! Mechanisms as they are built: what holds a suspension together is its parts, not its drawing.
//!
//! A drawing gives points, from which lengths and shapes follow. What is built has parts that are what they
//! are: points of the body, lengths of members, shapes of carriers, each off by a little ([`Parts`]). Put
//! together ([`Assembler`]) with the wheel centre at its height, they come to lie somewhere near the drawing. Where
//! they lie is a design again, the *built design*: the drawing of a mechanism with just these parts, at rest where this
//! one rests. So everything the crate knows of designs (poses, lanes, derivatives, limits, certificates) holds
//! of built mechanisms without a formula of its own.
//!
//! With x the parts and p(x) the built design, whatever is read off the mechanism has
//!
//! ```text
//! dy/dx = dy/dp dp/dx
//! ```
//!
//! dy/dp is the adjoint of designs ([`mod@crate::derive`]), dp/dx the derivative of the assembly. What a build holds:
//! travel 0 is the wheel centre at its drawn height, the rack is at 0, points of the body are where they are, the
//! spindle is fixed in its carrier. Changes "since the design position" (half-track change, angles of arms and rockers) are
//! counted from where the built mechanism rests.

mod alignment;
mod assembler;
mod derivatives;
mod parts;
mod rest;
mod set_up;
mod settle;
mod settle_series;

pub(crate) use alignment::Alignment;
pub use assembler::{Assembler, Reject};
pub use derivatives::{BuiltCurves, built_curves};
pub use parts::{BuildParameter, Member, Parts};
pub use rest::{Built, Direction, Rest};
pub use set_up::{AdjustedSuspension, Aim, Miss, NoSetUp, PARTS_OF_A_TURN, SetUp, Static};
