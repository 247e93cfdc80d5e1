//! Mechanisms as built: a suspension of actual parts, not of the nominal design.
//!
//! The nominal design consists of points. They define the lengths and shapes of the parts. The actual parts deviate a
//! little: points of the body, lengths of members, shapes of carriers ([`Parts`]). The [`Assembler`] assembles the actual
//! parts with the wheel centre at a given height. The points of the assembled parts lie near the nominal points. Their
//! positions are a design, too: the *built design*. It is the nominal design of a mechanism with exactly these parts in
//! this static position. So all methods for designs (poses, SIMD lanes, derivatives, limits, certificates) also work for
//! built mechanisms, without further formulas. Only an axle on five links also has tensions ([`Tensions`]).
//!
//! With x the parts and p(x) the built design, every output y of the mechanism has
//!
//! ```text
//! dy/dx = dy/dp dp/dx
//! ```
//!
//! dy/dp comes from the adjoint method for designs ([`mod@crate::derive`]), dp/dx is the derivative of the assembly. In
//! every build,
//!
//! - the wheel centre is at the height of [`Rest`] at travel 0: at its nominal height, unless a set-up changes it,
//! - the rack is at 0,
//! - points of the body do not move, except sideways at the mounts of a twist beam,
//! - the spindle is fixed in its carrier.
//!
//! Changes "since the design position" (half-track change, angles of arms and rockers) are measured from the static
//! position of the built mechanism.

mod alignment;
mod assembler;
mod assembly_error;
mod carriers;
mod derivatives;
mod least_energy;
mod parts;
mod rest;
mod set_up;
mod settle;
mod settle_series;

pub(crate) use alignment::Alignment;
pub use assembler::Assembler;
pub use assembly_error::AssemblyError;
pub use derivatives::{BuiltCurves, built_curves};
pub use least_energy::Tensions;
pub(crate) use least_energy::{TensionInput, tension_inputs};
pub use parts::{BuildParameter, Member, Parts};
pub use rest::{Built, Direction, Rest};
pub use set_up::{
    AdjustedSuspension, Aim, MissedTarget, PARTS_OF_A_TURN, SetUp, SetUpError, Static,
};
