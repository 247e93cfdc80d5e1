//! Places at which an axle is solved.

use super::*;

/// The position that an axle is to take. Lengths are in the study's unit; the rack is positive towards the left wheel's
/// outside.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Placement {
    /// The body rolled on a plane ground.
    Roll {
        /// Mean travel of the wheel centres.
        heave: f64,
        /// Roll angle in radians.
        roll: f64,
        /// Displacement of the rack.
        rack: f64,
    },
    /// The body rolled on a plane ground, with a mean travel that follows from the load. The axle carries the same
    /// load as when it stands level at `heave`, with the rack in the middle.
    AtLoad {
        /// Mean travel of the wheel centres at which the level axle carries the same load.
        heave: f64,
        /// Roll angle in radians.
        roll: f64,
        /// Displacement of the rack.
        rack: f64,
    },
    /// Given travels of both wheels.
    Travels {
        /// Travels of left and right wheel.
        travels: [f64; 2],
        /// Displacement of the rack.
        rack: f64,
        /// True if both wheels stand on one plane. Otherwise the body is level, and each wheel stands on a level pad.
        on_plane: bool,
    },
}

impl Placement {
    /// Travels and rack, if both wheels stand on level pads at given heights; `None` for another placement.
    pub fn on_level_pads(&self) -> Option<([f64; 2], f64)> {
        match *self {
            Placement::Travels {
                travels,
                rack,
                on_plane: false,
            } => Some((travels, rack)),
            _ => None,
        }
    }

    /// Displacement of the rack.
    pub fn rack(&self) -> f64 {
        match *self {
            Placement::Roll { rack, .. }
            | Placement::AtLoad { rack, .. }
            | Placement::Travels { rack, .. } => rack,
        }
    }

    /// Mean travel of both wheel centres. A placement at a load has the mean travel of the level axle.
    pub(in crate::axle) fn mean(&self) -> f64 {
        match *self {
            Placement::Roll { heave, .. } | Placement::AtLoad { heave, .. } => heave,
            Placement::Travels {
                travels: [left, right],
                ..
            } => 0.5 * (left + right),
        }
    }

    /// Quantities that stay fixed in motions from this placement.
    pub fn hold(&self) -> Hold {
        match self {
            Placement::Roll { .. } | Placement::AtLoad { .. } => Hold::MeanTravel,
            Placement::Travels { on_plane: true, .. } => Hold::TravelsOnPlane,
            Placement::Travels { .. } => Hold::TravelsOnPads,
        }
    }
}

impl std::fmt::Display for Placement {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Placement::Roll { heave, roll, .. } => {
                let roll = roll.to_degrees();
                write!(f, "roll {roll:.6} deg, heave {}", heave + 0.0)?;
            }
            Placement::AtLoad { heave, roll, .. } => {
                let roll = roll.to_degrees();
                write!(f, "roll {roll:.6} deg at the load of heave {}", heave + 0.0)?;
            }
            Placement::Travels {
                travels: [left, right],
                ..
            } => write!(f, "travels {} and {}", left + 0.0, right + 0.0)?,
        }
        write!(f, ", rack {} to the left", self.rack() + 0.0)
    }
}
