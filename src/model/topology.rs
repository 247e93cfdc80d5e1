//! The catalogue of topologies.

use super::{Mechanism, macpherson};

/// A hardpoint that a topology has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Hardpoint {
    /// Name in the study.
    pub name: &'static str,
    /// What it is, for messages and templates.
    pub about: &'static str,
    /// Whether a study must give it.
    pub required: bool,
}

/// A kind of suspension.
pub struct Topology {
    /// Name in the study.
    pub name: &'static str,
    /// One line on what it is.
    pub summary: &'static str,
    /// Its hardpoints, in the order they are printed.
    pub hardpoints: &'static [Hardpoint],
    /// Pairs of hardpoints that must not coincide, and why.
    pub distinct: &'static [(&'static str, &'static str, &'static str)],
    /// Builds the mechanism from the hardpoints a study gives (all required ones among them).
    pub build: fn(&'static Topology, &[&'static str]) -> Mechanism,
    /// A commented study that runs as it is.
    pub template: &'static str,
}

impl Topology {
    /// Every topology there is.
    pub const ALL: &'static [&'static Topology] = &[&macpherson::MACPHERSON];

    /// The topology of this name.
    pub fn named(name: &str) -> Option<&'static Topology> {
        Self::ALL.iter().find(|t| t.name == name).copied()
    }
}

impl std::fmt::Debug for Topology {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "Topology({})", self.name)
    }
}

impl PartialEq for Topology {
    fn eq(&self, other: &Self) -> bool {
        self.name == other.name
    }
}
