//! An axle in one pose, with all inputs of formulas.
//!
//! An [`AxleState`] contains both wheels as functions of their travels and racks. Along a [`Motion`] the travels, the rack and
//! the roll angle change. Their rates are computed from the state itself. [`AxleState::moving`] returns the same state as
//! series along the motion. These series contain the derivatives. C' and C,r are velocities of the carrier's point at the
//! contact point, with respect to the wheel's own travel and to the axle's rack. With h = n.C and, on a plane, f = h_l - h_r = 0,
//!
//! ```text
//! roll        z_l' = -z_r' = -track/F        F = n.C_l' + n.C_r'
//! heave       z_l' = 2 n.C_r'/F,  z_r' = 2 n.C_l'/F
//! rack        z_l' = -z_r' = -(n.C_l,r - n.C_r,r)/F
//! ```
//!
//! because C is the lowest point of the wheel: its displacement along the rim does not change its height to first order.
//!
//! Each wheel of a rigid axle moves with both travels. C_b,d and C_b,h are velocities of the carrier's point at contact point
//! b. For C_b,d, wheel b rises and the other wheel falls at the same unit rate (d z_own = -d z_other). C_b,h is with respect to
//! the mean travel. Then F above contains C_b,d, and
//!
//! ```text
//! heave       z_l' = 1 + D,  z_r' = 1 - D        D = -(n.C_l,h - n.C_r,h)/F
//! ```
//!
//! A pose on a plane can be defined by its roll angle and mean travel, by both travels, or by a load. Derivatives along
//! [`Motion::Rack`] depend on this choice, since the given coordinates of the station stay constant. Formulas of the catalogue
//! must not depend on this choice, so they use the other motions.

use super::Quantity;
use super::carriers::Carriers;
use super::moving::Moving;
use super::reading::{Reading, WheelParts};
use super::setup::Setup;
use crate::mechanism::Ground;
use crate::model::{AxleTravel, Side};
use crate::number::{Each, Jet, Real, Vector3, outlined};

/// Coordinates that stay constant while the rack, the heave or the roll angle changes. Without them, the motion would
/// not be unique.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Hold {
    /// Roll angle and mean travel of the wheel centres are constant, on a plane ground.
    MeanTravel,
    /// Both travels are constant, on a plane ground. The roll angle is a result.
    TravelsOnPlane,
    /// Both travels are constant, the body is level, and each wheel is on a level pad.
    TravelsOnPads,
}

/// Motion of the axle along which derivatives are taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Motion {
    /// Roll of the body with constant mean travel and rack. The parameter is the angle in radians.
    Roll,
    /// Mean travel of the wheel centres. The rack is constant. On a plane, the roll angle is constant, too. On pads,
    /// the travels of both wheels change equally.
    Heave,
    /// Displacement of the rack towards the left wheel. The other given coordinates of the station are constant.
    Rack,
    /// Displacement of the rack towards the left wheel. Unlike [`Motion::Rack`], it does not depend on the given
    /// coordinates. On a plane, the roll angle and the mean travel are constant. On pads, the travels of both wheels
    /// are constant.
    Steering,
    /// Travel of the left wheel. The other travel and the rack are constant. If both travels are given on a plane, the roll
    /// angle follows.
    TravelLeft,
    /// Travel of the right wheel, like [`Motion::TravelLeft`].
    TravelRight,
    /// Equal and opposite travels of the wheel centres, with the right wheel in jounce, as in a roll stiffness test on a
    /// rig.
    OpposedTravels,
}

impl Motion {
    /// Name of the motion, for titles.
    pub fn name(self) -> &'static str {
        match self {
            Motion::Roll => "roll",
            Motion::Heave => "heave",
            Motion::Rack => "rack",
            Motion::Steering => "steering",
            Motion::TravelLeft => "left travel",
            Motion::TravelRight => "right travel",
            Motion::OpposedTravels => "opposed travels",
        }
    }
}

/// One wheel in a state, in the kernel's frame of its own side.
#[derive(Clone, Copy, Debug)]
pub struct WheelState<'s, T, W = Reading<T>> {
    /// Values of the wheel as functions of travel and rack.
    pub reading: &'s W,
    /// Ground under the wheel.
    pub ground: Ground<T>,
    /// Loaded radius of the wheel. NaN if the study does not contain it.
    pub radius: f64,
    /// Bodies that carry the wheels.
    pub carriers: Carriers,
}

/// An axle in one pose.
#[derive(Clone, Copy, Debug)]
pub struct AxleState<'a, T, W = Reading<T>> {
    /// Values of the left and right wheel, each in its own frame.
    pub readings: [W; 2],
    /// Ground in the left wheel's frame: sine and cosine of the roll angle.
    pub ground: Ground<T>,
    /// Roll angle of the body.
    pub roll: T,
    /// Coordinates that stay constant in a motion.
    pub hold: Hold,
    /// Bodies that carry the wheels.
    pub carriers: Carriers,
    /// Further inputs of the study.
    pub setup: &'a Setup,
}

impl AxleState<'_, f64> {
    /// Returns true if both wheels stand on one plane. Pads of nearly the same height count as one plane.
    pub fn is_on_plane(&self) -> bool {
        self.hold != Hold::TravelsOnPads
            || self.mismatch().abs() <= Quantity::SAME_PLANE * self.track()
    }
}

/// Rates along a motion: of both travels, of the rack towards the outside of the left wheel, and of the roll angle.
struct Rates<T> {
    travel: [T; 2],
    rack: Option<T>,
    roll: T,
}

impl<T: Real, W: WheelParts<T>> WheelState<'_, T, W> {
    /// Vector from the wheel centre to the contact point.
    #[inline(always)]
    pub fn contact_lever(&self) -> Vector3<T> {
        self.ground
            .contact_lever(self.reading.spin_axis(), self.radius)
    }

    /// Contact point C.
    #[inline(always)]
    pub fn contact_point(&self) -> Vector3<T> {
        self.reading.centre() + self.contact_lever()
    }

    /// Velocity C' of the carrier's point at the contact point C with respect to the wheel's own travel. The wheel does not
    /// rotate relative to its carrier.
    #[inline(always)]
    pub fn contact_velocity(&self) -> Vector3<T> {
        self.carried_at_contact(self.reading.by_travel())
    }

    /// Velocity of the carrier's point at the contact point C with respect to the rack.
    #[inline(always)]
    pub fn contact_by_rack(&self) -> Vector3<T> {
        self.carried_at_contact(self.reading.by_rack())
    }

    /// Velocity of the carrier's point at the contact point C, while this wheel rises and the other wheel falls at the same
    /// unit rate. Only for a rigid axle.
    #[inline(always)]
    pub fn contact_by_difference(&self) -> Vector3<T> {
        self.carried_at_contact(self.reading.twist(self.carriers.by_difference()))
    }

    /// Velocity of the carrier's point at the contact point C with respect to the mean travel. Only for a rigid axle.
    #[inline(always)]
    pub fn contact_by_mean(&self) -> Vector3<T> {
        self.carried_at_contact(self.reading.twist(self.carriers.by_mean()))
    }

    /// Velocity of the carrier's point at the contact point C. `twist` is the velocity of the wheel centre and the angular
    /// velocity of the carrier.
    #[inline(always)]
    fn carried_at_contact(&self, twist: [Vector3<T>; 2]) -> Vector3<T> {
        outlined!(
            [T: Real, W: WheelParts<T>] self.ground.sine;
            wheel: WheelState<'p, T, W> = *self, twist: [Vector3<T>; 2] = twist => Vector3<T> {
                let [centre, turn] = twist;
                centre + turn.cross(wheel.contact_lever())
            }
        )
    }

    /// Height of the contact point above the origin, along the normal of the ground.
    #[inline(always)]
    pub fn height(&self) -> T {
        self.ground.normal().dot(self.contact_point())
    }

    /// Derivative of [`WheelState::height`] with respect to the wheel's own travel.
    #[inline(always)]
    pub fn rise(&self) -> T {
        self.ground.normal().dot(self.contact_velocity())
    }

    /// Derivative of [`WheelState::height`] while this wheel rises and the other wheel falls at the same unit rate. Only for a
    /// rigid axle.
    #[inline(always)]
    pub fn rise_by_difference(&self) -> T {
        self.ground.normal().dot(self.contact_by_difference())
    }

    /// Derivative of [`WheelState::height`] with respect to the mean travel, for a rigid axle.
    #[inline(always)]
    pub fn rise_by_mean(&self) -> T {
        self.ground.normal().dot(self.contact_by_mean())
    }

    /// Derivative of [`WheelState::height`] with respect to the rack.
    #[inline(always)]
    fn rise_by_rack(&self) -> T {
        self.ground.normal().dot(self.contact_by_rack())
    }

    /// Coordinate of the contact point along the ground, positive outboard.
    #[inline(always)]
    pub fn half_track(&self) -> T {
        outlined!(
            [T: Real, W: WheelParts<T>] self.ground.sine; wheel: WheelState<'p, T, W> = *self => T {
                wheel.ground.outboard().dot(wheel.contact_point())
            }
        )
    }
}

impl<'a, T: Real, W: WheelParts<T>> AxleState<'a, T, W> {
    /// Returns the left and the right wheel.
    #[inline(always)]
    pub fn wheels(&self) -> [WheelState<'_, T, W>; 2] {
        [self.wheel(Side::Left), self.wheel(Side::Right)]
    }

    /// Returns the wheel on this side.
    #[inline(always)]
    pub fn wheel(&self, side: Side) -> WheelState<'_, T, W> {
        WheelState {
            reading: &self.readings[side as usize],
            ground: match side {
                Side::Left => self.ground,
                Side::Right => self.ground.mirrored(),
            },
            radius: self.setup.wheel_radius.unwrap_or(f64::NAN),
            carriers: self.carriers,
        }
    }

    /// Distance of the contact points across the vehicle.
    #[inline(always)]
    pub fn track(&self) -> T {
        let [left, right] = self.wheels();
        left.half_track() + right.half_track()
    }

    /// Returns any one value of the state. New constants copy the number type and the count of coefficients from this value.
    #[inline(always)]
    pub fn like(&self) -> T {
        self.roll
    }

    /// Returns the state with the body level, and each wheel on a level pad at its travel.
    #[inline(always)]
    pub fn on_pads(&self) -> Self {
        AxleState {
            ground: Ground::level(self.like()),
            roll: self.like().zero(),
            hold: Hold::TravelsOnPads,
            ..*self
        }
    }

    /// Returns the state with both wheels on one plane ground, whatever coordinates the study gives. If the rack, the mean
    /// travel or the roll angle of this state changes, the other two stay constant.
    #[inline(always)]
    pub fn on_plane(&self) -> Self {
        AxleState {
            hold: Hold::MeanTravel,
            ..*self
        }
    }

    /// Height of the left contact point above the right one, along the normal of the ground: 0 on a plane.
    #[inline(always)]
    pub fn mismatch(&self) -> T {
        let [left, right] = self.wheels();
        left.height() - right.height()
    }

    /// Derivatives of the heights of both contact points with respect to the travels of their own wheels.
    #[inline(always)]
    fn rises(&self) -> [T; 2] {
        let [left, right] = self.wheels();
        if self.carriers.is_rigid() {
            // For a rigid axle, each contact point's rise is its derivative while its own wheel rises and the other wheel falls
            // at the same rate.
            [left, right].each(|wheel| wheel.rise_by_difference())
        } else {
            [left.rise(), right.rise()]
        }
    }

    /// Derivative of [`AxleState::mismatch`] with respect to the mean travel of a rigid axle, with constant difference.
    #[inline(always)]
    fn mismatch_by_mean(&self) -> T {
        let [left, right] = self.wheels();
        left.rise_by_mean() - right.rise_by_mean()
    }

    /// Derivative of [`AxleState::mismatch`] with respect to the rack, with constant travels. The right wheel's own rack
    /// moves in the opposite direction, so the difference becomes a sum.
    #[inline(always)]
    fn mismatch_by_rack(&self) -> T {
        let [left, right] = self.wheels();
        left.rise_by_rack() + right.rise_by_rack()
    }

    #[inline(always)]
    fn rates(&self, motion: Motion) -> Rates<T> {
        let (zero, one) = (self.like().zero(), self.like().one());
        let mut rates = Rates {
            travel: [zero; 2],
            rack: None,
            roll: zero,
        };
        match (motion, self.hold) {
            (Motion::Roll, _) => {
                let [left, right] = self.rises();
                let difference = -self.track() / (left + right);
                rates.travel = [difference, -difference];
                rates.roll = one;
            }
            (Motion::Heave, Hold::TravelsOnPads) => rates.travel = [one; 2],
            (Motion::Heave, Hold::MeanTravel | Hold::TravelsOnPlane)
                if self.carriers.is_rigid() =>
            {
                let [left, right] = self.rises();
                let difference = -self.mismatch_by_mean() / (left + right);
                rates.travel = [one + difference, one - difference];
            }
            (Motion::Heave, Hold::MeanTravel | Hold::TravelsOnPlane) => {
                let [left, right] = self.rises();
                let share = (one + one) / (left + right);
                rates.travel = [right * share, left * share];
            }
            (Motion::TravelLeft, _) => rates.travel = [one, zero],
            (Motion::TravelRight, _) => rates.travel = [zero, one],
            (Motion::OpposedTravels, _) => rates.travel = [-one, one],
            (Motion::Rack | Motion::Steering, Hold::TravelsOnPads) => rates.rack = Some(one),
            (Motion::Rack, Hold::TravelsOnPlane) => {
                rates.rack = Some(one);
                rates.roll = -self.mismatch_by_rack() / self.track();
            }
            (Motion::Rack | Motion::Steering, Hold::MeanTravel | Hold::TravelsOnPlane) => {
                rates.rack = Some(one);
                let [left, right] = self.rises();
                let difference = -self.mismatch_by_rack() / (left + right);
                rates.travel = [difference, -difference];
            }
        }
        let is_one_sided = matches!(
            motion,
            Motion::TravelLeft | Motion::TravelRight | Motion::OpposedTravels
        );
        if self.hold == Hold::TravelsOnPlane && is_one_sided {
            let [left, right] = self.rises();
            let [z_left, z_right] = rates.travel;
            let mismatch = if self.carriers.is_rigid() {
                let (mean, difference) = ((z_left + z_right), (z_left - z_right));
                (difference * (left + right) + mean * self.mismatch_by_mean()).scaled(0.5)
            } else {
                left * z_left - right * z_right
            };
            rates.roll = -mismatch / self.track();
        }
        rates
    }

    /// Returns the rates of a wheel's travel and of its rack (or held travel), in its own frame. `None` if the rack or
    /// held travel is at rest.
    #[inline(always)]
    fn own_rates(&self, side: Side, rates: &Rates<T>) -> (T, Option<T>) {
        let [left, right] = rates.travel;
        match (self.carriers.held(), side) {
            (None, Side::Left) => (left, rates.rack),
            (None, Side::Right) => (right, rates.rack.map(|rack| -rack)),
            (Some(held), side) => {
                let mean = (left + right).scaled(0.5);
                let difference = match side {
                    Side::Left => left - right,
                    Side::Right => right - left,
                };
                let difference = difference.scaled(0.5);
                match held {
                    AxleTravel::Mean => (difference, Some(mean)),
                    AxleTravel::Difference => (mean, Some(difference)),
                }
            }
        }
    }

    /// Derivative of a number of one wheel along a motion. It is computed from the derivatives of this number with
    /// respect to the wheel's own travel and rack.
    pub fn along(&self, motion: Motion, side: Side, [by_travel, by_rack]: [T; 2]) -> T {
        let (travel, rack) = self.own_rates(side, &self.rates(motion));
        match rack {
            None => by_travel * travel,
            Some(rack) => by_travel * travel + by_rack * rack,
        }
    }

    /// Returns the state as series along a motion.
    #[inline(always)]
    pub fn moving(&self, motion: Motion) -> AxleState<'a, Jet<T, 2>, Moving<'_, W, T>> {
        // The compiler makes a separate function, because most formulas take derivatives along a motion.
        let rates = outlined!(
            [T: Real, W: WheelParts<T>] self.like();
            state: &'p AxleState<'p, T, W> = self, motion: Motion = motion => Rates<T> { state.rates(motion) }
        );
        let [left, right] = &self.readings;
        let (of_left, of_right) = (
            self.own_rates(Side::Left, &rates),
            self.own_rates(Side::Right, &rates),
        );
        let roll = rates.roll;
        let Ground { sine, cosine } = self.ground;
        AxleState {
            readings: [
                left.moving(of_left.0, of_left.1),
                right.moving(of_right.0, of_right.1),
            ],
            ground: Ground {
                sine: Jet([sine, cosine * roll]),
                cosine: Jet([cosine, -(sine * roll)]),
            },
            roll: Jet([self.roll, roll]),
            hold: self.hold,
            carriers: self.carriers,
            setup: self.setup,
        }
    }
}

impl<T: Real> AxleState<'_, T> {
    /// Corrects the travels or the roll angle to first order, so that both wheels are on the same ground. If the study
    /// gives the roll angle, the travels change. If the study gives both travels, the roll angle changes. In numbers with
    /// gradients, the correction also adds the gradients of these results. The arguments are the values of F (equations of
    /// this module) and of the track, without derivatives.
    pub fn settled(&self, [rise, track]: [f64; 2]) -> Self {
        let like = self.like();
        match self.hold {
            Hold::TravelsOnPads => *self,
            Hold::MeanTravel => {
                let difference = -(self.mismatch() * like.constant(1.0 / rise));
                let [left, right] = &self.readings;
                AxleState {
                    readings: [left.shifted(difference), right.shifted(-difference)],
                    ..*self
                }
            }
            Hold::TravelsOnPlane => {
                let turn = -(self.mismatch() * like.constant(1.0 / track));
                let Ground { sine, cosine } = self.ground;
                AxleState {
                    ground: Ground {
                        sine: sine + cosine * turn,
                        cosine: cosine - sine * turn,
                    },
                    roll: self.roll + turn,
                    ..*self
                }
            }
        }
    }
}
