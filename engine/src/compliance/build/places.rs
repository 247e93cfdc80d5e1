//! Locations of the parts in the system of equations, and hardpoints of these parts.

use crate::model::{PointId, Rod};

/// Location of a bushing in the system of equations.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::compliance) enum BushingPlace {
    /// End of a part with its own degrees of freedom.
    Limb {
        /// Index of the part in the system.
        limb: usize,
        /// Index of the end of the part.
        end: usize,
    },
    /// Top mount of the strut.
    Mount(usize),
    /// Connection of body and carrier.
    Carrier(usize),
    /// Connection of body and subframe: index of the subframe's mount.
    Subframe(usize),
}

/// Location of a link with axial stiffness in the system of equations.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::compliance) enum LinkPlace {
    /// Rod with axial stiffness that holds the carrier.
    Rod(usize),
    /// Rod of the rocker on which the spring acts.
    RockerRod,
}

/// Points of a part with its own degrees of freedom (see `limb.rs`).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::compliance) enum LimbPlace {
    /// Arm with bushings. Its outer joint identifies the arm.
    Arm(PointId),
    /// Link with bushings.
    Link {
        /// End at the body, subframe or rack.
        inner: PointId,
        /// End at the carrier.
        outer: PointId,
    },
    /// Top mount of the strut.
    Mount,
    /// Point on which the spring acts: on the carrier, or on the arm without bushings that has this outer joint.
    Seat(Option<PointId>),
}

impl LimbPlace {
    /// Returns the joint at which the part holds the carrier.
    pub(in crate::compliance) fn point(self) -> Option<PointId> {
        match self {
            LimbPlace::Arm(outer) | LimbPlace::Link { outer, .. } => Some(outer),
            LimbPlace::Seat(outer) => outer,
            LimbPlace::Mount => None,
        }
    }
}

/// Points of a rigid joint.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::compliance) enum JointPlace {
    /// Rigid rod, or rigid leg of an arm without bushings.
    Rod {
        /// End at the body, subframe or rack.
        inner: PointId,
        /// End at the carrier.
        outer: PointId,
    },
    /// Ball joint of an arm at the body. The distance between this joint and the outer joint is constant. The field is the
    /// outer joint.
    Pivot(PointId),
    /// Mount of a strut. It stays on the line of the strut.
    Line(PointId),
    /// Point at which the body or subframe holds the carrier directly.
    Pin(PointId),
}

impl JointPlace {
    /// Point at which the joint holds the carrier.
    pub(in crate::compliance) fn point(self) -> PointId {
        match self {
            JointPlace::Rod { outer, .. } | JointPlace::Pivot(outer) => outer,
            JointPlace::Line(point) | JointPlace::Pin(point) => point,
        }
    }
}

/// Hardpoints of the parts in a system of equations, in the order of the parts.
#[derive(Clone, Debug, Default)]
pub(in crate::compliance) struct Places {
    pub(in crate::compliance) limbs: Vec<LimbPlace>,
    /// Inner and outer end of each rod with axial stiffness.
    pub(in crate::compliance) rods: Vec<[PointId; 2]>,
    pub(in crate::compliance) joints: Vec<JointPlace>,
    /// Outer joint of the arm without bushings that carries the drop link, or the rod of the drop link's rocker. `None` if
    /// no such arm carries it.
    pub(in crate::compliance) bar: Option<PointId>,
    /// Rod between suspension and rocker, if the spring is on a rocker.
    pub(in crate::compliance) rocker_rod: Option<Rod>,
    pub(in crate::compliance) has_spring: bool,
}
