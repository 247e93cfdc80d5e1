//! Acceptance of designs by the tracker, with one design in each SIMD lane, and the reasons for rejections.

use crate::number::SimdReal;

/// Reason why the tracker rejects a pose. The continuation then starts from the last accepted pose.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Rejection {
    /// A rod or an axis is too short to have a direction.
    NoLength,
    /// Newton's method did not converge.
    NotSettled,
    /// A divisor of the equations is too small.
    IllConditioned,
    /// The slope of the path, or a number that must not vanish, fell below half of its value or more than doubled in one
    /// step. Or the prediction needed a large correction.
    ChangedTooMuch,
    /// The mechanism rotated too far in one step, or from the design position.
    TurnedFar,
    /// The path is as steep as near a fold. Or a contact point rises too slowly with its wheel.
    FoldNear,
    /// The route does not visit the station: the station is out of reach, or has the same drive value as another one. Or the
    /// mechanism cannot be tracked.
    NotOnTheWay,
}

impl Rejection {
    /// All reasons for a rejection.
    pub const ALL: [Rejection; 7] = [
        Rejection::NoLength,
        Rejection::NotSettled,
        Rejection::IllConditioned,
        Rejection::ChangedTooMuch,
        Rejection::TurnedFar,
        Rejection::FoldNear,
        Rejection::NotOnTheWay,
    ];

    /// The reason in words, for tables.
    pub fn describe(self) -> &'static str {
        match self {
            Rejection::NoLength => "a rod or an axis is too short",
            Rejection::NotSettled => "Newton's method did not converge",
            Rejection::IllConditioned => "the equations are ill-conditioned",
            Rejection::ChangedTooMuch => "the equations changed too much in one step",
            Rejection::TurnedFar => "the mechanism turned too far in one step",
            Rejection::FoldNear => "a fold is near",
            Rejection::NotOnTheWay => "the station is out of reach or listed twice",
        }
    }

    /// Number that represents this reason in a SIMD lane. 0 means no rejection.
    #[inline(always)]
    fn code(self) -> f64 {
        f64::from(self as u8 + 1)
    }

    fn of_code(code: f64) -> Option<Rejection> {
        Rejection::ALL.into_iter().find(|r| r.code() == code)
    }
}

/// SIMD lanes whose design has passed every check so far. For each other lane, the first check that failed.
#[derive(Clone, Copy)]
pub struct Acceptance<B: SimdReal> {
    accepted: B::Mask,
    reason: B,
}

impl<B: SimdReal> Acceptance<B> {
    /// Accepts every lane.
    #[inline(always)]
    pub fn everywhere(like: B) -> Self {
        Acceptance {
            accepted: like.everywhere(),
            reason: like.zero(),
        }
    }

    /// Rejects the lanes in which `mask` is false. `otherwise` is the reason for the rejection.
    #[inline(always)]
    pub fn require(&mut self, mask: B::Mask, otherwise: Rejection) {
        let failing = self.accepted & !mask;
        self.reason = B::select(failing, self.reason.constant(otherwise.code()), self.reason);
        self.accepted = self.accepted & mask;
    }

    /// SIMD lanes whose designs are accepted.
    #[inline(always)]
    pub fn lanes(&self) -> B::Mask {
        self.accepted
    }

    /// Reason why the design in a lane is rejected. `None` if it is accepted.
    #[inline(always)]
    pub fn reason(&self, lane: usize) -> Option<Rejection> {
        match self.reason.in_lane(lane) {
            0.0 => None,
            code => Rejection::of_code(code),
        }
    }
}
