//! Many designs at a time, one in each lane.
//!
//! What the careful path ([`Solver`](super::Solver)) does for one design, this does for as many as fit
//! into SIMD registers, by the same closed form, provided that nothing is close to changing. Along the
//! travel the tangent of half the arm angle is predicted from the places visited; nearly always one
//! correction is all it takes, elsewhere secant steps follow. A lane is frozen once it has converged, so
//! it does not matter what its neighbours still do.
//!
//! A lane is *lost*, and its design left to the careful path, where
//!
//! - the iteration does not settle,
//! - the closed form is less than well conditioned ([`Watch::LEAST`]),
//! - a quantity that may not vanish, or the slope of the path, changes by more than half (or doubles) from
//!   one place to the next: it could vanish in between,
//! - the arm turns far, in one step or from the design position,
//! - a fold is near: the arm turns fast by the travel.
//!
//! So a lane is either right or lost; which of the two depends on its own design alone.

mod route;

use super::closed_form::{Carried, Carrier, ClosedForm, Roles, State, Velocity};
use super::path::March;
use crate::model::{Drive, Mechanism, PointId, SteeringAxis};
use crate::number::{Bundle, Jet, Vector3};
use route::{Leg, Route, Stencil};

/// A way to solve designs of one mechanism in lanes.
#[derive(Clone, Debug)]
pub struct Batch {
    roles: Roles,
    drive: Drive,
    /// One for each displacement of the rack.
    routes: Vec<Route>,
    /// Pairs of points whose distance must be a length.
    distinct: Vec<(PointId, PointId)>,
    /// The square of the shortest length.
    shortest: f64,
    /// How far the wheel centre may be from its travel.
    tolerance: f64,
    /// Slope of the half tangent by the travel, in the base design.
    slope: f64,
    /// The steepest it may get.
    steepest: f64,
}

/// What is read off the poses.
pub trait Visit<B: Bundle> {
    /// A pose. Lanes that are lost hold anything, NaN included.
    fn pose(&mut self, station: usize, at: &LanePose<B>);
}

/// The constants of a design in each lane.
#[derive(Clone, Copy)]
pub struct LaneDesign<B: Bundle> {
    form: ClosedForm<B>,
    carrier: Carrier<B>,
    ball_joint: Vector3<B>,
    /// Whether all rods have a length.
    distinct: B::Mask,
}

/// A vector fixed to the knuckle.
#[derive(Clone, Copy, Debug)]
pub struct KnuckleVector<B>(Carried<B>);

/// A point fixed to the knuckle.
#[derive(Clone, Copy, Debug)]
pub struct KnucklePoint<B>(Carried<B>);

impl<B: Bundle> LaneDesign<B> {
    /// Whether all rods have a length.
    #[inline(always)]
    pub fn is_regular(&self) -> B::Mask {
        self.distinct
    }

    /// A vector of the knuckle in the design position.
    #[inline(always)]
    pub fn vector(&self, designed: Vector3<B>) -> KnuckleVector<B> {
        KnuckleVector(self.carrier.carried(designed))
    }

    /// A point of the knuckle in the design position.
    #[inline(always)]
    pub fn point(&self, designed: Vector3<B>) -> KnucklePoint<B> {
        KnucklePoint(self.carrier.carried(designed - self.ball_joint))
    }
}

/// The mechanism in a pose, in each lane.
pub struct LanePose<B> {
    state: State<B>,
    tangent: B,
    drive: Drive,
}

/// How the mechanism moves in a pose, by the drive.
pub struct LaneRates<B>(Velocity<B>);

impl<B: Bundle> LanePose<B> {
    /// Where a vector of the knuckle points now.
    #[inline(always)]
    pub fn vector(&self, vector: &KnuckleVector<B>) -> Vector3<B> {
        self.state.carry(&vector.0)
    }

    /// Where a point of the knuckle is now.
    #[inline(always)]
    pub fn point(&self, point: &KnucklePoint<B>) -> Vector3<B> {
        self.state.ball_joint() + self.state.carry(&point.0)
    }

    /// The lower end of the steering axis and the vector to its upper end.
    #[inline(always)]
    pub fn steering_axis(&self) -> (Vector3<B>, Vector3<B>) {
        (self.state.ball_joint(), self.state.steering_axis())
    }

    /// The derivatives by the drive.
    #[inline(always)]
    pub fn rates(&self, design: &LaneDesign<B>) -> LaneRates<B> {
        let velocity = design.form.velocity(&self.state, self.tangent);
        let one = self.tangent.one();
        LaneRates(velocity.scaled(match self.drive {
            Drive::Travel => one / velocity.rise,
            Drive::ArmAngle => one / velocity.arm_angle,
        }))
    }
}

impl<B: Bundle> LaneRates<B> {
    /// Of a vector of the knuckle that points here now.
    #[inline(always)]
    pub fn vector(&self, now: Vector3<B>) -> Vector3<B> {
        self.0.turn.cross(now)
    }

    /// Of a point of the knuckle that is here now.
    #[inline(always)]
    pub fn point(&self, at: &LanePose<B>, now: Vector3<B>) -> Vector3<B> {
        self.0.ball_joint + self.0.turn.cross(now - at.state.ball_joint())
    }

    /// Of the vector along the steering axis.
    #[inline(always)]
    pub fn steering_axis(&self) -> Vector3<B> {
        self.0.steering_axis
    }

    /// Angular velocity of the knuckle.
    #[inline(always)]
    pub fn turn(&self) -> Vector3<B> {
        self.0.turn
    }
}

/// Steps longer than this part of the size are broken up.
const LONGEST_STEP: f64 = 0.02;
/// How far the wheel centre may be from its travel, in sizes.
const TOLERANCE: f64 = 2e-14;
/// Rods shorter than this part of the reach are left to the careful path.
const SHORTEST_LENGTH: f64 = 1e-6;
/// How many sizes from the origin the closed form keeps its accuracy.
const FAR: f64 = 100.0;
/// The steepest slope of the half tangent by the travel, in sizes; an arm as long as the size has half of
/// one. Beyond, a fold is near: what is left of the residual grows with the slope, and in rates with its
/// cube.
const STEEPEST: f64 = 4.0;
/// Pairs of corrections a lane may take to settle.
const MOST_ROUNDS: usize = 4;

impl Batch {
    /// For designs of this mechanism that are not far from `base`, with the rack at each of `racks`
    /// (towards the kernel's +y); `None` where there is no closed form to run in lanes.
    pub fn new(
        mechanism: &Mechanism,
        base: &[Vector3<f64>],
        drive: Drive,
        march: &March,
        racks: &[f64],
    ) -> Option<Batch> {
        let roles = Roles::of(mechanism)?;
        let (size, reach) = (mechanism.size(base), mechanism.reach(base));
        let longest = match drive {
            Drive::Travel => LONGEST_STEP * size,
            Drive::ArmAngle => LONGEST_STEP,
        };
        let form = ClosedForm::new(&roles, base).map(Jet::<f64, 2>::constant);
        let state = form.at_half_tangent(Jet::variable(0.0), Jet::constant(0.0));
        let slope = 1.0 / form.travel(&state)[1];
        (slope.is_finite() && reach < FAR * size).then_some(())?;
        Some(Batch {
            roles,
            drive,
            routes: racks
                .iter()
                .map(|rack| Route::through(march, *rack, longest, LONGEST_STEP * size))
                .collect::<Option<_>>()?,
            distinct: mechanism.lengths().collect(),
            shortest: (SHORTEST_LENGTH * reach).powi(2),
            tolerance: TOLERANCE * reach,
            slope,
            steepest: match drive {
                Drive::Travel => STEEPEST / size,
                Drive::ArmAngle => f64::INFINITY,
            },
        })
    }

    /// Whether this is the steering axis that [`LanePose::steering_axis`] speaks of.
    pub fn steers_about(&self, axis: Option<SteeringAxis>) -> bool {
        let (lower, upper) = (self.roles.ball_joint(), self.roles.upper_end());
        axis == Some(SteeringAxis::Through { lower, upper })
    }

    /// Room for the history of [`Batch::solve`].
    pub fn history<B: Bundle>(&self, like: B) -> Vec<B> {
        let places = self.routes.iter().map(|route| route.places.len());
        vec![like.zero(); places.max().unwrap_or(0)]
    }

    /// The constants of designs, a point of all lanes after another.
    #[inline(always)]
    pub fn design<B: Bundle>(&self, design: &[Vector3<B>]) -> LaneDesign<B> {
        let (form, carrier) = ClosedForm::with_carrier(&self.roles, design);
        let ball_joint = design[self.roles.ball_joint().0];
        let shortest = ball_joint.x.lit(self.shortest);
        let mut distinct = ball_joint.x.zero().less(shortest);
        for (first, second) in &self.distinct {
            let length = (design[second.0] - design[first.0]).norm_squared();
            distinct = distinct & shortest.less(length);
        }
        LaneDesign {
            form,
            carrier,
            ball_joint,
            distinct,
        }
    }

    /// Visits every station with the rack at its `rack`-th place; says which lanes are right throughout.
    #[inline(always)]
    pub fn solve<B: Bundle>(
        &self,
        design: &LaneDesign<B>,
        rack: usize,
        history: &mut [B],
        visit: &mut impl Visit<B>,
    ) -> B::Mask {
        let form = &design.form;
        let like = design.ball_joint.x;
        let zero = like.zero();
        let tolerance = like.lit(self.tolerance);

        let mut sound = design.distinct;
        let slope = like.lit(self.slope);
        let mut last = [Watch {
            tangent: zero,
            rate: slope,
            slope,
            squares: [zero; 3],
            upper_margin: zero,
        }; 2];
        history[0] = zero;
        for (number, place) in self.routes[rack].places.iter().enumerate() {
            let target = like.lit(place.value);
            let rack = like.lit(place.rack);
            // By the arm angle there is nothing to solve: every residual will do.
            let (mut tangent, mut slope_here, tolerance) = match self.drive {
                Drive::ArmAngle => {
                    let tangent = like.lit((0.5 * place.value).tan());
                    (tangent, zero, like.lit(f64::INFINITY))
                }
                Drive::Travel => {
                    let tangent = weighted(&place.prediction, history, like);
                    let tangent = tangent + like.lit(self.slope * place.along_slope);
                    (tangent, last[place.leg.side()].slope, tolerance)
                }
            };
            let mut settled = zero.less(zero);
            let mut round = 1;
            loop {
                // Two at a time: a correction is always needed, and a branch that cannot be foreseen
                // would cost more than the second. A lane that has settled stays where it is.
                let missed = form.travel(&form.at_half_tangent(tangent, rack)) - target;
                let step = B::select(settled, zero, -(missed * slope_here));
                let corrected = tangent + step;
                let state = form.at_half_tangent(corrected, rack);
                let miss = form.travel(&state) - target;
                settled = miss.abs().less(tolerance);
                if round < MOST_ROUNDS && !B::all(settled | !sound) {
                    slope_here = B::select(settled, slope_here, step / (miss - missed));
                    let next = corrected - miss * slope_here;
                    tangent = B::select(settled, corrected, next);
                    round += 1;
                    continue;
                }
                let tangent = corrected;
                history[number] = tangent;
                sound = sound & settled & Watch::is_sound(&state, tangent);
                if place.leg == Leg::Rack {
                    let watch = Watch::start(&state, tangent, slope);
                    if number > 0 {
                        sound = sound & watch.continues(&last[0]);
                    }
                    last = [watch; 2];
                } else {
                    let before = last[place.leg.side()];
                    let watch = before.next(&state, tangent, like.lit(1.0 / place.step));
                    let is_flat = watch.slope.abs().less(like.lit(self.steepest));
                    sound = sound & watch.continues(&before) & is_flat;
                    last[place.leg.side()] = watch;
                }
                if let Some(station) = place.station {
                    let drive = self.drive;
                    let pose = LanePose {
                        state,
                        tangent,
                        drive,
                    };
                    visit.pose(station, &pose);
                }
                break;
            }
        }
        sound
    }
}

/// A weighted sum of places visited; the nearest, which is known last, is added last.
#[inline(always)]
fn weighted<B: Bundle>(weights: &Stencil, history: &[B], like: B) -> B {
    let mut k = weights.len() - 1;
    let mut sum = history[weights[k].0] * like.lit(weights[k].1);
    while k > 0 {
        k -= 1;
        let (place, weight) = weights[k];
        sum = sum.plus_product(history[place], like.lit(weight));
    }
    sum
}

/// What is watched along the path.
#[derive(Clone, Copy)]
struct Watch<B> {
    tangent: B,
    /// Slope of the tangent by the drive over the last step.
    rate: B,
    /// The same, extrapolated to the next place.
    slope: B,
    /// Squares that the closed form divides by or takes the root of.
    squares: [B; 3],
    upper_margin: B,
}

impl<B: Bundle> Watch<B> {
    /// The least squared sine of an angle that the closed form divides by.
    const LEAST: f64 = 0.04;
    /// The least margin of the upper end.
    const LEAST_UPPER: f64 = 0.05;
    /// The farthest the arm may be turned, as a tangent of half the angle, and in one step.
    const FARTHEST: f64 = 0.7;
    const LONGEST: f64 = 0.1;

    /// At the first place.
    #[inline(always)]
    fn start(state: &State<B>, tangent: B, slope: B) -> Self {
        let [a, b, c] = state.squares();
        Watch {
            tangent,
            rate: slope,
            slope,
            squares: [a.0, b.0, c.0],
            upper_margin: state.upper_margin(),
        }
    }

    /// At the place after this one, a step of the drive further on.
    #[inline(always)]
    fn next(&self, state: &State<B>, tangent: B, inverse_step: B) -> Self {
        let rate = (tangent - self.tangent) * inverse_step;
        let mut next = Watch::start(state, tangent, rate);
        next.slope = rate + (rate - self.rate);
        next
    }

    /// Whether the closed form is well conditioned here. False for NaN.
    #[inline(always)]
    fn is_sound(state: &State<B>, tangent: B) -> B::Mask {
        let least = tangent.lit(Self::LEAST);
        let [a, b, c] = state.squares();
        (a.1 * least).less(a.0)
            & (b.1 * least).less(b.0)
            & (c.1 * least).less(c.0)
            & tangent.lit(Self::LEAST_UPPER).less(state.upper_margin())
            & tangent.abs().less(tangent.lit(Self::FARTHEST))
    }

    /// Whether nothing changed so much since the place before that it could have vanished on the way.
    #[inline(always)]
    fn continues(&self, before: &Self) -> B::Mask {
        let step = (self.tangent - before.tangent).abs();
        within_half(self.rate, before.rate)
            & within_half(self.squares[0], before.squares[0])
            & within_half(self.squares[1], before.squares[1])
            & within_half(self.squares[2], before.squares[2])
            & within_half(self.upper_margin, before.upper_margin)
            & step.less(self.tangent.lit(Self::LONGEST))
    }
}

/// Whether `now` lies between half of and twice `before`, whatever its sign.
#[inline(always)]
fn within_half<B: Bundle>(now: B, before: B) -> B::Mask {
    ((now - (before + before)) * now.minus_product(before, before.lit(0.5))).less(before.zero())
}
