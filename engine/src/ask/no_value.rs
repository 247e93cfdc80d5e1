//! Reasons why a quantity has no value.

/// Reason why a quantity has no value at a station.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum NoValue {
    /// The station has no pose.
    NoPose,
    /// The quantity is a quotient of differences of steer angles that are zero straight ahead.
    StraightAhead,
    /// The quantity is the meeting point of normals that are parallel.
    ParallelNormals,
    /// The quantity is a derivative along roll, and the wheels stand on pads of different heights.
    NoPlane,
    /// A rocker is at a toggle or beyond it.
    Toggle,
    /// Nothing can carry the load.
    Unsupported,
    /// The formula divides by zero here.
    NotFinite,
    /// The formula of a wheel characteristic has no value under this condition.
    Undefined(&'static str),
}

impl NoValue {
    /// The reason in words, as the end of a sentence.
    pub fn reason(self) -> &'static str {
        match self {
            NoValue::NoPose => "the station has no pose",
            NoValue::StraightAhead => {
                "below 0.02 rad of mean steer it is a quotient of two angles that vanish"
            }
            NoValue::ParallelNormals => {
                "the normals to the velocities of the contact points are all but parallel"
            }
            NoValue::NoPlane => "the wheels stand on pads of different heights, not on a plane",
            NoValue::Toggle => "a rocker it moves with is at a toggle",
            NoValue::Unsupported => {
                "the spring, or the support in its place, has next to no leverage there"
            }
            NoValue::NotFinite => "its formula divides by zero there",
            NoValue::Undefined(condition) => condition,
        }
    }
}
