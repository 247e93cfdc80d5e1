//! Placements of an axle: coordinates at which the position of the axle is solved.

use super::*;

/// Required position of an axle. Lengths are in the study's unit. The rack is positive in the outboard direction of the left
/// wheel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Placement {
    /// The body is rolled on a plane ground.
    Roll {
        /// Mean travel of the wheel centres.
        heave: f64,
        /// Roll angle of the body, in radians.
        roll: f64,
        /// Displacement of the rack.
        rack: f64,
    },
    /// The body is rolled on a plane ground, and the mean travel is computed from the load. The axle carries the same
    /// load as in the level position at `heave`, with the rack centred.
    AtLoad {
        /// Mean travel of the wheel centres at which the level axle carries the same load.
        heave: f64,
        /// Roll angle of the body, in radians.
        roll: f64,
        /// Displacement of the rack.
        rack: f64,
    },
    /// Both wheels have given travels.
    Travels {
        /// Travels of the left and the right wheel.
        travels: [f64; 2],
        /// Displacement of the rack.
        rack: f64,
        /// True if both wheels stand on one plane. Otherwise the body is level, and each wheel stands on a level pad.
        on_plane: bool,
    },
}

impl Placement {
    /// Returns travels and rack displacement of wheels that are on level pads. `None` for another placement.
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

    /// Returns the mean travel of both wheel centres. For a placement at a load, this is the mean travel of the level
    /// axle.
    pub(in crate::axle) fn mean(&self) -> f64 {
        match *self {
            Placement::Roll { heave, .. } | Placement::AtLoad { heave, .. } => heave,
            Placement::Travels {
                travels: [left, right],
                ..
            } => 0.5 * (left + right),
        }
    }

    /// Coordinates that stay constant in motions from this placement.
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
                write!(
                    f,
                    "roll {roll:.6} deg at the wheel load of heave {}",
                    heave + 0.0
                )?;
            }
            Placement::Travels {
                travels: [left, right],
                ..
            } => write!(f, "travels {} and {}", left + 0.0, right + 0.0)?,
        }
        write!(f, ", rack {} to the left", self.rack() + 0.0)
    }
}
