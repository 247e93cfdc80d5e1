//! What else can be asked of a mechanism: how far it goes, what its links carry, in how many ways it can be
//! assembled, and a proof of a pose.

mod assemblies;
pub(crate) mod certificate;
mod limits;
mod loads;

pub use assemblies::{Assemblies, Assembly, AssemblyMode, Undecided};
pub use certificate::{Certificate, Certifier, Inclusion};
pub use limits::{Limit, Limits, Range, RangeEnd, RockerRange};
pub use loads::{
    Balance, Balanced, Carried, Factors, Load, LoadPoint, Member, Reaction, Reactions, Support,
    members,
};
