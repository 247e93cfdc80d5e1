//! Analyses of a mechanism: its range, the forces in its links, all its assemblies, and certificates of poses.

mod applied;
mod assemblies;
mod beam_loads;
pub(crate) mod certificate;
mod limits;
mod loads;
mod steering_loads;

pub use applied::{Applied, Carrying, bears, rod_name};
pub use assemblies::{Assemblies, Assembly, AssemblyMode, Undecided};
pub use beam_loads::{BeamForce, BeamForces};
pub use certificate::{Certificate, Certifier, Inclusion};
pub(crate) use limits::AT_TOGGLE;
pub use limits::{Limit, Limits, Range, RangeEnd, RockerRange};
pub(crate) use loads::members_of_constraints;
pub use loads::{
    Balance, Balanced, Carried, FAR, Factors, Load, LoadPoint, Member, Reaction, Reactions,
    Support, members,
};
