//! Newton's method from one pose to the next on the same solution branch.

use super::branch::{Branch, nearest_singularity};
use super::drive::{Driver, Driving};
use super::equations::{
    Column, DRIVE, Fixed, Jacobian, distances_squared, jacobian, quadratic, residual,
};
use super::{Drive, KnucklePoint, Moving, Refusal, Singular, Strut, StrutPoints};
use hardpoint_engine::bench_hooks::Lu;
use hardpoint_engine::mechanism::{Work, WorkCounter};
use hardpoint_engine::number::Vector3;

/// Largest condition number that leaves half of the digits correct: 1/sqrt(2^-52).
const WORST_CONDITION: f64 = (1_u64 << 26) as f64;

/// Largest ratio of Newton's second step to its first step that the solver accepts.
///
/// The equations are quadratic. So Newton's method converges to the root on the branch of the start if Kantorovich's h is at most
/// 1/2. Then the ratio is at most h/2/(1 - h). The measured ratio belongs to one direction only, but h covers all directions. A
/// ratio of 1/4 leaves a margin of two.
const CONTRACTION: f64 = 0.25;

/// Smallest step, as a fraction of the whole distance. Smaller steps are not tried.
///
/// Steps must shrink with the distance from the end of a branch. Towards the end, the condition number grows with the inverse
/// square root of the distance. At this fraction of the distance, the condition number has grown by a factor of 2^20, to about
/// [`WORST_CONDITION`].
const SMALLEST_STEP: f64 = 1.0 / (1_u64 << 40) as f64;

/// A point of a motion: drive value and rack displacement.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Station {
    /// Value of the drive, see [`Drive`].
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
    /// Drive value and rack displacement of this pose.
    pub fn station(&self) -> Station {
        self.station
    }

    /// Points 5, 6, 7, 8 and 9.
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
    /// Ratio of smallest to largest pivot at which the condition number reaches [`WORST_CONDITION`].
    smallest_spread: f64,
    /// Size of the left-hand sides at a solution. Because of rounding, this size is not zero.
    rounding: f64,
    pub(crate) work: WorkCounter,
}

impl PointCoordinates {
    /// Makes the equations for a strut with this design position. The design position must not be singular.
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
        // If points 5 to 8 lie in one plane, the choice of this knuckle point for the wheel centre does not matter. The condition
        // number is then infinite, and the strut is refused.
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

    /// Pose of the design position.
    pub fn design(&self) -> Pose {
        self.design
    }

    /// Condition number of the Jacobian at a pose, in the Frobenius norm. It does not depend on the unit of length. The rounding
    /// error is a few times this number, times 2^-52, times the size of the result.
    pub fn condition(&self, pose: &Pose) -> f64 {
        let jacobian = self.jacobian(pose);
        condition(&jacobian, Lu::of(jacobian, 1.0).as_ref())
    }

    /// Wheel centre, point 10.
    pub fn wheel_centre(&self) -> KnucklePoint {
        self.wheel_centre
    }

    /// Knuckle point that is at `design` in the design position.
    pub fn knuckle_point(&self, design: Vector3<f64>) -> KnucklePoint {
        KnucklePoint::new(design, &self.design.moving)
            .expect("the points of the knuckle span a volume")
    }

    /// Work done since the equations were made.
    pub fn work(&self) -> Work {
        self.work.work()
    }

    /// Returns the pose at another station, on the branch of `from`.
    ///
    /// Drive and rack change in proportion to each other, up to the new station. The solver makes one step if that is safe,
    /// otherwise as many as necessary. It accepts a step if three conditions hold along the step:
    ///
    /// - Newton's method contracts from the start. The contraction is an estimate of Kantorovich's condition. If this
    ///   condition holds, the root is the only one nearby, and a path of regular roots joins this root to the start.
    /// - The determinant of the Jacobian keeps its sign. The volumes that distinguish the assemblies keep their signs, too.
    /// - The condition number of the Jacobian leaves half of the digits correct.
    ///
    /// Otherwise the solver halves the step. If the step becomes next to nothing, the branch ends there.
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

    /// Applies Newton's method from the position `start`. `None` if the iteration does not contract from the first step on, or
    /// if it arrives on another solution branch.
    ///
    /// The iteration always ends: every step is at most a quarter of the previous one, until the equations hold up to rounding
    /// errors. The method makes at least one step, so that it does not accept a double root as a solution.
    fn corrected(&self, fixed: &Fixed, start: &Moving, driver: &Driver) -> Option<Moving> {
        let mut moving = *start;
        let (mut last, mut orientation, mut contracted) = (f64::INFINITY, 0.0, false);
        let mut factors: Option<Factors> = None;
        let factors = loop {
            let mut left = residual(fixed, &moving, &self.lengths_squared, driver);
            let solved = left.amax() <= self.rounding;
            // After two contracting steps, the Jacobian has hardly changed since the last factorisation.
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

    /// True if a position that satisfies the equations up to rounding errors is a true solution.
    ///
    /// Near the end of a branch, the equations also hold beyond the end, up to rounding errors. There the Jacobian J has a unit
    /// vector v nearly in its kernel. With w = J^-T v, the equations F = 0 become, for a step t along v,
    ///
    /// t + c t^2/2 + w.F = 0, where c = w.F''(v, v).
    ///
    /// With a rounding error r in every F, each with the worst sign, the two roots meet at h = |c| r sum|w| = 1/2. This h is
    /// Kantorovich's. The test requires h <= 1/4.
    fn is_clear_of_rounding(&self, factors: &Factors) -> bool {
        // If J is nearly singular, then for almost any b the solution x of J x = b is nearly parallel to v.
        let v = Column::from(factors.solve([1.0; 15])).normalize();
        let w = Column::from(factors.solve_transposed(v.into()));
        let curvature = w.dot(&quadratic(0.0, &moving_of(&v)));
        curvature.abs() * self.rounding * w.lp_norm(1) <= 0.25
    }

    /// Factorises a Jacobian. `None` if fewer than half of the digits of a solution would be correct.
    pub(crate) fn factorised(&self, jacobian: Jacobian) -> Option<Factors> {
        Lu::of(jacobian, 1.0).filter(|lu| spread(lu) > self.smallest_spread)
    }

    /// Jacobian at a pose.
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

/// Smallest pivot of the LU factors, divided by the largest.
fn spread(lu: &Factors) -> f64 {
    let (mut least, mut most) = (f64::INFINITY, 0.0_f64);
    for pivot in lu.pivots() {
        least = least.min(pivot.abs());
        most = most.max(pivot.abs());
    }
    least / most
}

/// Condition number of a Jacobian with these factors, in the Frobenius norm. Infinite or NaN if the Jacobian is singular.
///
/// Every equation is a squared length and every unknown is a length, so no scaling is needed. Scaling the rows would hide two
/// points that coincide, because their row then contains only rounding errors.
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
/// Take coordinates up to M and distances up to D. Each coordinate difference has an error of eps M. This error changes a squared
/// distance or a component of a vector product by at most 2 sqrt(3) D eps M. The squares, products and sums add at most 4 D^2
/// eps. If M is at least D, the total is below 8 D M eps.
fn rounding(points: &[Vector3<f64>; 9], lengths_squared: &[f64; 10]) -> f64 {
    let distance = lengths_squared
        .iter()
        .fold(0.0, |a, b| f64::max(a, *b))
        .sqrt();
    let coordinates = points.iter().flat_map(|p| p.to_array());
    let largest = coordinates.fold(distance, |a, b| a.max(b.abs()));
    8.0 * distance * largest * f64::EPSILON
}

/// Converts a column of unknowns to points.
pub(crate) fn moving_of(column: &Column) -> Moving {
    std::array::from_fn(|i| Vector3::new(column[3 * i], column[3 * i + 1], column[3 * i + 2]))
}

/// Returns points 5 to 9 of a strut at a wheel travel (relative to the design) and a rack displacement. The solver follows the
/// motion from the design position.
pub fn solve_travel(strut: &Strut, travel: f64, rack: f64) -> Result<Moving, Refusal> {
    let mechanism = PointCoordinates::new(strut, StrutPoints::Spread, Drive::Travel)?;
    let to = Station {
        value: travel,
        rack,
    };
    Ok(mechanism.track(&mechanism.design, to)?.moving)
}
