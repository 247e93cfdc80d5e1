//! Reasons why a quantity has no value.

/// Reason why a quantity has no value at a station.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum NoValue {
    /// The station has no pose.
    NoPose,
    /// The quantity is a quotient of two differences of steer angles, such as Ackermann. Near straight ahead both
    /// differences are almost zero.
    StraightAhead,
    /// The quantity follows from the intersection of two lines: the normals to the velocities of the two contact points.
    /// These normals are nearly parallel.
    ParallelNormals,
    /// The wheels stand on pads of different heights, but the quantity is a derivative with respect to roll on a plane
    /// ground.
    NoPlane,
    /// A rocker is at a toggle or beyond it.
    Toggle,
    /// The spring, or the vertical force that replaces it, has almost no leverage in this pose. So it cannot carry the
    /// load.
    Unsupported,
    /// The elastic parts have no equilibrium under the load.
    NotHeld,
    /// The formula divides by zero in this state.
    NotFinite,
    /// The formula of a wheel characteristic has no value for the reason given.
    Undefined(&'static str),
}

impl NoValue {
    /// Returns true if the reason is that the suspension cannot carry the load. The status of the station reports this
    /// reason.
    pub fn is_about_loads(self) -> bool {
        matches!(self, NoValue::Unsupported | NoValue::NotHeld)
    }

    /// Reason in words, as the end of a sentence.
    pub fn reason(self) -> &'static str {
        match self {
            NoValue::NoPose => "the station has no pose",
            NoValue::StraightAhead => "not defined near straight ahead (mean steer below 1.1 deg)",
            NoValue::ParallelNormals => {
                "the normals to the velocities of the contact points are nearly parallel"
            }
            NoValue::NoPlane => "the wheels stand on pads of different heights, not on a plane",
            NoValue::Toggle => "its rocker is at a toggle",
            NoValue::Unsupported => {
                "the spring, or the support that replaces it, has almost no leverage there"
            }
            NoValue::NotHeld => "the elastic parts have no equilibrium under the load",
            NoValue::NotFinite => "its formula divides by zero there",
            NoValue::Undefined(condition) => condition,
        }
    }
}
