//! Descriptions, in words, of the conditions under which a characteristic is not defined. Tables show them as the
//! reason for empty cells.

use super::Characteristic;

impl Characteristic {
    /// Condition under which the formula has no value, worded as the end of a sentence.
    pub fn undefined_where(self) -> &'static str {
        use Characteristic as C;
        match self {
            C::RollCentreHeight | C::AntiDive | C::AntiLift | C::AntiSquat => {
                "the contact point neither rises nor falls there"
            }
            C::FrontViewSwingArm | C::FrontViewCentreLateral | C::FrontViewCentreHeight => {
                "the wheel does not turn in front view there"
            }
            C::SideViewSwingArm | C::SideViewCentreLongitudinal | C::SideViewCentreHeight => {
                "the wheel does not turn in side view there"
            }
            C::CamberGain
            | C::BumpSteer
            | C::CasterGain
            | C::KingpinInclinationGain
            | C::MotionRatio
            | C::AntiRollBarMotionRatio => "the wheel centre neither rises nor falls there",
            C::ScrubRadius
            | C::CasterTrail
            | C::SteeringAxisAtGroundLongitudinal
            | C::SteeringAxisAtGroundLateral
            | C::KingpinOffset
            | C::SpindleTrail => "the steering axis is level there",
            C::Toe => "the wheel lies flat there",
            C::AttiaCamber => "wheel_centre and strut_upper coincide",
            C::AttiaKingpin => "strut_upper and lower_ball_joint coincide",
            _ => "it is not a finite number there",
        }
    }
}
