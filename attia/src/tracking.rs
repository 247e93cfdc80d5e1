//! Newton's method, from one pose to the next on the same branch.

use super::branch::{Branch, nearest_singularity};
use super::drive::{Driver, Driving};
use super::equations::{
    Column, DRIVE, Fixed, Jacobian, distances_squared, jacobian, quadratic, residual,
};
use super::{Drive, KnucklePoint, Moving, Refusal, Singular, Strut, StrutPoints};
use hardpoint_engine::bench_hooks::Lu;
use hardpoint_engine::mechanism::{Work, WorkCounter};
use hardpoint_engine::number::Vector3;

/// The largest condition number at which half of the digits are left: 1/sqrt(2^-52).
const WORST_CONDITION: f64 = (1_u64 << 26) as f64;

/// The largest ratio of Newton's second step to its first at which a start is trusted.
///
/// The equations are quadratic, so Newton's method converges to the root of the start's own branch if
/// Kantorovich's h is at most 1/2, in which case the ratio is at most h/2/(1 - h). The ratio seen is
/// that along one direction only, h is for all of them; a ratio of 1/4 leaves a margin of two.
const CONTRACTION: f64 = 0.25;

/// The share of the way below which steps are not tried.
///
/// Steps have to shrink with the distance from the end of a branch, and towards it the condition number
/// grows with the inverse square root of the distance. This near to the end, as a share of the way, it
/// has grown by 2^20, to about [`WORST_CONDITION`].
const SMALLEST_STEP: f64 = 1.0 / (1_u64 << 40) as f64;

/// A point of a motion: drive value and rack displacement.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Station {
    /// The value of the drive, see [`Drive`].
    pub value: f64,
    /// Displacement of `tie_rod_inner` along y.
    pub rack: f64,
}

/// A solved position.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    station: Station,
    moving: Moving,
}

impl Pose {
    /// The drive and the rack it belongs to.
    pub fn station(&self) -> Station {
        self.station
    }

    /// The points 5, 6, 7, 8 and 9.
    pub fn moving(&self) -> &Moving {
        &self.moving
    }
}

/// The fifteen equations of one strut with one drive.
#[derive(Clone, Debug)]
pub struct PointCoordinates {
    pub(crate) fixed: Fixed,
    pub(crate) driving: Driving,
    lengths_squared: [f64; 10],
    wheel_centre: KnucklePoint,
    design: Pose,
    /// The pivots' spread at which the condition number passes [`WORST_CONDITION`].
    smallest_spread: f64,
    /// Size of the left-hand sides at a solution, which rounding alone causes.
    rounding: f64,
    pub(crate) work: WorkCounter,
}

impl PointCoordinates {
    /// The equations for a strut with this design position, which must not be a singular one.
    pub fn new(strut: &Strut, points: StrutPoints, drive: Drive) -> Result<Self, Refusal> {
        if !strut.is_finite() {
            return Err(Refusal::NotFinite);
        }
        let moving = strut.moving(points);
        let fixed = Fixed([
            strut.lower_arm_front,
            strut.lower_arm_rear,
            strut.tie_rod_inner,
            strut.strut_top,
        ]);
        let all = fixed.all(&moving);
        let lengths_squared = distances_squared(&all);
        // In a coplanar knuckle any point will do: the condition number below is infinite.
        let wheel_centre =
            KnucklePoint::new(strut.wheel_centre, &moving).unwrap_or(KnucklePoint::BALL_JOINT);
        let driving = Driving::new(drive, strut, wheel_centre);
        let mut mechanism = PointCoordinates {
            fixed,
            driving,
            lengths_squared,
            wheel_centre,
            design: Pose {
                station: Station {
                    value: driving.design_value(),
                    rack: 0.0,
                },
                moving,
            },
            smallest_spread: 0.0,
            rounding: rounding(&all, &lengths_squared),
            work: WorkCounter::default(),
        };
        let jacobian = mechanism.jacobian(&mechanism.design);
        let factors = Lu::of(jacobian, 1.0);
        let condition = condition(&jacobian, factors.as_ref());
        if condition.is_nan() || condition > WORST_CONDITION {
            let what = mechanism.diagnosis(&mechanism.design);
            return Err(Refusal::Singular(what));
        }
        let spread = factors.as_ref().map_or(0.0, spread);
        mechanism.smallest_spread = spread * condition / WORST_CONDITION;
        Ok(mechanism)
    }

    /// The design position.
    pub fn design(&self) -> Pose {
        self.design
    }

    /// Condition number of the Jacobian at a pose (in the Frobenius norm; independent of the unit of
    /// length). Rounding errors are this number times 2^-52 times a few times the size of the result.
    pub fn condition(&self, pose: &Pose) -> f64 {
        let jacobian = self.jacobian(pose);
        condition(&jacobian, Lu::of(jacobian, 1.0).as_ref())
    }

    /// The wheel centre, point 10.
    pub fn wheel_centre(&self) -> KnucklePoint {
        self.wheel_centre
    }

    /// The knuckle point whose design position is `design`.
    pub fn knuckle_point(&self, design: Vector3<f64>) -> KnucklePoint {
        KnucklePoint::new(design, &self.design.moving)
            .expect("the knuckle of a regular design position is not flat")
    }

    /// Counts of the work done since the equations were made.
    pub fn work(&self) -> Work {
        self.work.work()
    }

    /// The pose at another station, on the branch of `from`.
    ///
    /// The drive and the rack go there on a straight line, in one step where that is safe, else in as
    /// many as it takes. A step is taken when, along it,
    ///
    /// - Newton's method contracts from the start (an estimate of Kantorovich's condition, under which
    ///   the root is the only one near and joined to the start by a path of regular ones);
    /// - the determinant of the Jacobian keeps its sign, and so do the volumes that tell the assemblies
    ///   apart;
    /// - the Jacobian stays well enough conditioned that half of the digits are left.
    ///
    /// Otherwise it is halved, until it is next to nothing: there the branch ends.
    pub fn track(&self, from: &Pose, to: Station) -> Result<Pose, Refusal> {
        if !(to.value.is_finite() && to.rack.is_finite()) {
            return Err(Refusal::NotFinite);
        }
        let parameter = |station: Station| self.driving.parameter(station.value);
        let (start, end) = (parameter(from.station), parameter(to));
        let between = |share: f64| {
            let mix = |a: f64, b: f64| if share < 1.0 { a + share * (b - a) } else { b };
            (mix(start, end), mix(from.station.rack, to.rack))
        };
        let mut moving = from.moving;
        let (mut done, mut step) = (0.0, 1.0);
        while done < 1.0 {
            let next = f64::min(done + step, 1.0);
            let (parameter, rack) = between(next);
            if step < SMALLEST_STEP {
                let value = self.driving.value(parameter);
                let station = Station { value, rack };
                let limit = self.diagnosis(&Pose { station, moving });
                return Err(Refusal::Unreachable { value, limit });
            }
            let fixed = self.fixed.with_rack(rack);
            match self.corrected(&fixed, &moving, &self.driving.driver(parameter)) {
                Some(solved) => {
                    moving = solved;
                    done = next;
                    step *= 2.0;
                }
                None => step = 0.5 * (next - done),
            }
        }
        Ok(Pose {
            station: to,
            moving,
        })
    }

    /// Newton's method from the position `start`. `None` where it does not contract from its first
    /// step on, or arrives elsewhere than on the branch of `start`.
    ///
    /// It ends by itself: every step is at most a quarter of the one before, until the equations hold
    /// to rounding. At least one step is made, so that a double root is not taken for a solution.
    fn corrected(&self, fixed: &Fixed, start: &Moving, driver: &Driver) -> Option<Moving> {
        let mut moving = *start;
        let (mut last, mut orientation, mut contracted) = (f64::INFINITY, 0.0, false);
        let mut factors: Option<Factors> = None;
        let factors = loop {
            let mut left = residual(fixed, &moving, &self.lengths_squared, driver);
            let solved = left.amax() <= self.rounding;
            // Where two steps have contracted, the Jacobian has changed next to nothing since the last.
            if let Some(lu) = factors.take_if(|_| solved && contracted) {
                break lu;
            }
            self.work.note(|w| w.factorisations += 1);
            let lu = self.factorised(jacobian(fixed, &moving, driver))?;
            let determinant = lu.determinant();
            if determinant * orientation < 0.0 {
                return None;
            }
            if solved && last.is_finite() {
                break lu;
            }
            self.work.note(|w| {
                w.newton_iterations += 1;
                w.right_hand_sides += 1;
            });
            left = Column::from(lu.solve(left.into()));
            let length = left.amax();
            if length.is_nan() || length > CONTRACTION * last {
                return None;
            }
            let step = moving_of(&left);
            moving = std::array::from_fn(|i| moving[i] - step[i]);
            contracted = last.is_finite();
            (last, orientation) = (length, determinant.signum());
            factors = Some(lu);
        };
        let branch = |moving| Branch::of(self.driving.kind(), fixed, moving);
        (self.is_clear_of_rounding(&factors) && branch(&moving) == branch(start)).then_some(moving)
    }

    /// Returns true if a position that satisfies the equations to rounding is a true solution.
    ///
    /// Near the end of a branch the equations hold to rounding beyond the end as well. There a unit vector v is
    /// nearly in the kernel of the Jacobian J. With w = J^-T v, the equations F = 0 become, for a step t along v,
    ///
    /// - t + c t^2/2 + w.F = 0, where c = w.F''(v, v).
    ///
    /// With a rounding error r in every F, each with the worst sign, the two roots meet at h = |c| r sum|w| = 1/2.
    /// This h is Kantorovich's. The test requires h <= 1/4.
    fn is_clear_of_rounding(&self, factors: &Factors) -> bool {
        // Where J is nearly singular, what solves it for any right-hand side is nearly v.
        let v = Column::from(factors.solve([1.0; 15])).normalize();
        let w = Column::from(factors.solve_transposed(v.into()));
        let curvature = w.dot(&quadratic(0.0, &moving_of(&v)));
        curvature.abs() * self.rounding * w.lp_norm(1) <= 0.25
    }

    /// The factors of a Jacobian, unless too few digits would be left.
    pub(crate) fn factorised(&self, jacobian: Jacobian) -> Option<Factors> {
        Lu::of(jacobian, 1.0).filter(|lu| spread(lu) > self.smallest_spread)
    }

    /// The Jacobian at a pose.
    pub(crate) fn jacobian(&self, pose: &Pose) -> Jacobian {
        let Station { value, rack } = pose.station;
        let driver = self.driving.driver(self.driving.parameter(value));
        jacobian(&self.fixed.with_rack(rack), &pose.moving, &driver)
    }

    /// Returns the configuration that is nearly singular at a pose.
    pub(crate) fn diagnosis(&self, pose: &Pose) -> Singular {
        let fixed = self.fixed.with_rack(pose.station.rack);
        let arm = self.driving.along_the_arm(&pose.moving);
        let mut right = [0.0; 15];
        right[DRIVE] = self.driving.arm_share();
        let factors = Lu::of(jacobian(&fixed, &pose.moving, &arm), 1.0);
        let velocity = factors.map(|lu| moving_of(&Column::from(lu.solve(right))));
        let travel = velocity.map(|velocity| self.wheel_centre.of(&velocity).z);
        nearest_singularity(&self.driving, &fixed, &pose.moving, travel)
    }
}

type Factors = Lu<f64, 15>;

/// The smallest pivot over the largest.
fn spread(lu: &Factors) -> f64 {
    let (mut least, mut most) = (f64::INFINITY, 0.0_f64);
    for pivot in lu.pivots() {
        least = least.min(pivot.abs());
        most = most.max(pivot.abs());
    }
    least / most
}

/// Condition number of a Jacobian with these factors, in the Frobenius norm; infinite (or not a number) where singular.
///
/// Every equation is a squared length and every unknown a length, so that they need no scaling. Scaling the rows
/// would hide two points that coincide, because their row then is only rounding.
fn condition(jacobian: &Jacobian, factors: Option<&Factors>) -> f64 {
    let norm = |rows: &Jacobian| {
        rows.as_flattened()
            .iter()
            .map(|c| c * c)
            .sum::<f64>()
            .sqrt()
    };
    factors.map_or(f64::INFINITY, |lu| norm(&lu.inverse()) * norm(jacobian))
}

/// Returns a bound on the rounding error of the equations at their solution.
///
/// With coordinates up to M and distances up to D: each coordinate difference carries eps M, which
/// moves a squared distance or a component of a vector product by no more than 2 sqrt(3) D eps M; the
/// squares, products and sums add at most 4 D^2 eps. With M no less than D that is below 8 D M eps.
fn rounding(points: &[Vector3<f64>; 9], lengths_squared: &[f64; 10]) -> f64 {
    let distance = lengths_squared
        .iter()
        .fold(0.0, |a, b| f64::max(a, *b))
        .sqrt();
    let coordinates = points.iter().flat_map(|p| p.to_array());
    let largest = coordinates.fold(distance, |a, b| a.max(b.abs()));
    8.0 * distance * largest * f64::EPSILON
}

/// The unknowns as points.
pub(crate) fn moving_of(column: &Column) -> Moving {
    std::array::from_fn(|i| Vector3::new(column[3 * i], column[3 * i + 1], column[3 * i + 2]))
}

/// The points 5 to 9 of a strut at a wheel travel (relative to the design) and a rack displacement,
/// followed there from the design position.
pub fn solve_travel(strut: &Strut, travel: f64, rack: f64) -> Result<Moving, Refusal> {
    let mechanism = PointCoordinates::new(strut, StrutPoints::Spread, Drive::Travel)?;
    let to = Station {
        value: travel,
        rack,
    };
    Ok(mechanism.track(&mechanism.design, to)?.moving)
}
