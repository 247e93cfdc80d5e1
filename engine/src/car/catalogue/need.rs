//! Parts and inputs that a car must have for a result.

use crate::axle::{Axle, AxleKind, BumpStop, SpringLaw};

/// Part or input of a car that a result needs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CarNeed {
    /// Ride-height point of the car at this axle.
    RideHeight,
    /// Both ride-height points.
    RideHeights,
    /// `[car.aero]`.
    Air,
    /// `[car] pitch_inertia`.
    PitchInertia,
    /// An anti-roll bar with a rate at this axle.
    Bar,
    /// A twist beam with a torsional rate at this axle.
    Beam,
    /// `[spring]` at this axle.
    Spring,
    /// `[bump_stop]` at this axle.
    BumpStop,
    /// `[rebound_stop]` at this axle.
    ReboundStop,
    /// `[heave_spring]` at this axle.
    HeaveSpring,
    /// `[t_bar]` at this axle.
    TBar,
    /// `[heave_bar]` at this axle.
    HeaveBar,
    /// Wheels of this axle that are independently suspended.
    Independent,
}

impl CarNeed {
    /// Returns true if an axle has the part. Also returns true for parts and inputs of the car itself, which are
    /// checked elsewhere.
    pub(super) fn met_by(self, axle: &Axle) -> bool {
        let setup = &axle.setup;
        let rockers = &setup.rocker_springs;
        let has_stop = |of: fn(&SpringLaw) -> &Option<BumpStop>| {
            let mut laws = setup.springs.iter().flatten();
            laws.any(|law| of(law).is_some())
        };
        match self {
            CarNeed::RideHeight | CarNeed::RideHeights | CarNeed::Air | CarNeed::PitchInertia => {
                true
            }
            CarNeed::Bar => setup.bar_rate.is_some() && axle.kind() != AxleKind::TwistBeam,
            CarNeed::Beam => setup.bar_rate.is_some() && axle.kind() == AxleKind::TwistBeam,
            CarNeed::Spring => setup.springs.is_some(),
            CarNeed::BumpStop => has_stop(|law| &law.bump_stop),
            CarNeed::ReboundStop => has_stop(|law| &law.rebound_stop),
            CarNeed::HeaveSpring => rockers.heave_spring.is_some(),
            CarNeed::TBar => rockers.t_bar.is_some(),
            CarNeed::HeaveBar => rockers.heave_bar.is_some(),
            CarNeed::Independent => !axle.is_rigid(),
        }
    }

    /// Returns the keys of the study that provide the part or input.
    pub fn key(self) -> &'static str {
        match self {
            CarNeed::RideHeight | CarNeed::RideHeights => {
                "ride_height_point_front and ride_height_point_rear in [car]"
            }
            CarNeed::Air => "[car.aero]",
            CarNeed::PitchInertia => "pitch_inertia in [car]",
            CarNeed::Bar => "an anti-roll bar with a rate",
            CarNeed::Beam => "a twist beam with torsional_rate in [twist_beam]",
            CarNeed::Spring => "[spring]",
            CarNeed::BumpStop => "[bump_stop]",
            CarNeed::ReboundStop => "[rebound_stop]",
            CarNeed::HeaveSpring => "[heave_spring]",
            CarNeed::TBar => "[t_bar]",
            CarNeed::HeaveBar => "[heave_bar]",
            CarNeed::Independent => "independently suspended wheels, not a solid axle",
        }
    }
}
