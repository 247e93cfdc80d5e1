//! Six closure equations of a mechanism in the pose of its knuckle: five constraints (see [`crate::mechanism::constraint`])
//! and a drive.
//!
//! Let J be the Jacobian of these equations with respect to the pose. Each row is the wrench of a constraint: for most
//! constraints, the Pluecker coordinates of its line. So J is singular exactly where the mechanism is singular.

use super::constraint::{ArmAngle, PartDimensions, Row, TravelRow};
use super::pose::{Configuration, Pose, Sink, Twist, Wrench};
use crate::linear::lu::{Lu6, Matrix6, Vector6};
use crate::model::{Mechanism, PointId};
use crate::number::{Each, Matrix3, Outlined, Real, Vector3};

/// Sixth equation: the drive with its present value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Driver<T> {
    /// Height of the wheel centre above its design position. For a rigid axle, this value is either the mean travel or half
    /// the difference of travels. The other of the two stays constant.
    Travel(T),
    /// Angle of the first arm, from its design position.
    ArmAngle {
        /// Sine of the arm's angle.
        sine: T,
        /// Cosine of the arm's angle.
        cosine: T,
    },
}

/// Set of closure equations, one bit for each equation. The bits stand for the five constraints, the drive with the wheel
/// travel, and the drive with the arm angle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct RowSet(u8);

impl RowSet {
    /// Every equation.
    pub(crate) const ALL: RowSet = RowSet(0xff);

    #[inline]
    fn holds(self, row: usize) -> bool {
        self.0 & (1 << row) != 0
    }

    /// Number of equations in the set. Of the two drive equations, only the equation of `driver` counts.
    #[inline]
    pub(crate) fn count<T>(self, driver: Driver<T>) -> u64 {
        u64::from((self.0 & 0b1_1111).count_ones()) + u64::from(self.holds(driver.row()))
    }
}

/// Receiver of derivatives (sink). It records only whether it received a derivative with respect to one of these hardpoints.
struct Touches<'a> {
    points: &'a [PointId],
    found: bool,
}

impl<T> Sink<T> for Touches<'_> {
    fn wrench(&mut self, _: Vector3<T>, _: Vector3<T>) {}
    fn hardpoint(&mut self, id: PointId, _: Vector3<T>) {
        self.found |= self.points.contains(&id);
    }
}

/// Closure equations of one design.
#[derive(Clone, Debug)]
pub struct Closure<T> {
    rows: [Row<T>; 5],
    /// Travel that drives a rigid axle. `None` for other mechanisms: their drive is the height of the wheel centre.
    driven: Option<TravelRow<T>>,
}

/// Source of the dimensions in the constraint equations (rows): a design or built parts. With a trait instead of an enum, code for
/// designs contains no code for built parts. The function `row` is inlined, because a called function would not be compiled for
/// SIMD lanes.
trait Dimensions<T>: Copy {
    /// Returns one of the dimensions. The number type of this dimension is the type of new constants.
    fn like(self) -> T;
    /// Makes one constraint equation (row). `constraint` is the index of the constraint. `number` is the index among the equations
    /// of this constraint.
    fn row(self, mechanism: &Mechanism, constraint: usize, number: usize) -> Row<T>;
}

impl<T: Real> Dimensions<T> for &[Vector3<T>] {
    #[inline(always)]
    fn like(self) -> T {
        self[0].x
    }
    #[inline(always)]
    fn row(self, mechanism: &Mechanism, constraint: usize, number: usize) -> Row<T> {
        Row::of(mechanism, mechanism.constraints[constraint], number, self)
    }
}

impl<T: Real> Dimensions<T> for PartDimensions<'_, T> {
    #[inline(always)]
    fn like(self) -> T {
        self.lengths[0]
    }
    #[inline(always)]
    fn row(self, mechanism: &Mechanism, constraint: usize, number: usize) -> Row<T> {
        Row::of_parts(mechanism, constraint, number, self)
    }
}

/// A constraint equation (row) that must be made: the index of its constraint, and its index among the equations of this
/// constraint.
#[derive(Clone, Copy)]
struct RowToMake<'a, T, D> {
    mechanism: &'a Mechanism,
    dimensions: D,
    constraint: usize,
    number: usize,
    of: std::marker::PhantomData<T>,
}

impl<T: Real, D: Dimensions<T>> Outlined for RowToMake<'_, T, D> {
    type Output = Row<T>;
    #[inline(always)]
    fn work(self) -> Row<T> {
        (self.dimensions).row(self.mechanism, self.constraint, self.number)
    }
}

impl<T: Real> Closure<T> {
    /// Makes the closure equations of a design.
    #[inline(always)]
    pub fn new(mechanism: &Mechanism, design: &[Vector3<T>]) -> Self {
        Closure::of_rows(mechanism, design)
    }

    /// Makes the closure equations for built parts.
    #[inline(always)]
    pub(crate) fn of_parts(mechanism: &Mechanism, parts: PartDimensions<T>) -> Self {
        Closure::of_rows(mechanism, parts)
    }

    /// Makes the five constraint equations.
    #[inline(always)]
    fn of_rows(mechanism: &Mechanism, dimensions: impl Dimensions<T>) -> Self {
        let like = dimensions.like();
        let mut next = RowToMake {
            mechanism,
            dimensions,
            constraint: 0,
            number: 0,
            of: std::marker::PhantomData,
        };
        let mut rows = [like.outlined(next); 5];
        for row in &mut rows[1..] {
            next.number += 1;
            if next.number == mechanism.constraints[next.constraint].freedoms() {
                (next.constraint, next.number) = (next.constraint + 1, 0);
            }
            *row = like.outlined(next);
        }
        let held = rows.iter().find_map(|row| match row {
            Row::AxleTravel(held) => Some(held),
            _ => None,
        });
        let driven = held.map(TravelRow::of_other_travel);
        Closure { rows, driven }
    }

    /// Replaces the design by another design of the same mechanism.
    pub fn prepare(&mut self, mechanism: &Mechanism, design: &[Vector3<T>]) {
        *self = Closure::new(mechanism, design);
    }

    /// The five constraint equations.
    #[inline(always)]
    pub(crate) fn rows(&self) -> &[Row<T>; 5] {
        &self.rows
    }

    /// Residuals as lengths: five constraints, then the drive. This function is not inlined, since inlining would cost
    /// minutes of compile time for derivative numbers.
    #[inline(never)]
    pub fn residuals(&self, at: &Configuration<T>, driver: Driver<T>) -> Vector6<T> {
        self.residuals_inlined(at, driver)
    }

    /// Residuals as in [`Closure::residuals`], for SIMD lanes.
    #[inline(always)]
    pub(crate) fn residuals_inlined(&self, at: &Configuration<T>, driver: Driver<T>) -> Vector6<T> {
        let mut residuals = [at.rack.zero(); 6];
        for (k, row) in self.rows.iter().enumerate() {
            residuals[k] = row.residual(at);
        }
        residuals[5] = self.driver_residual(at, driver);
        residuals
    }

    /// Jacobian of the closure equations with respect to the pose.
    #[inline]
    pub fn jacobian(&self, at: &Configuration<T>, driver: Driver<T>) -> Matrix6<T> {
        self.wrenches(at, driver).each(Wrench::to_row)
    }

    /// Jacobian of the closure equations with respect to the pose, row by row, with the derivatives with respect to the
    /// displacement of the rack.
    #[inline(never)]
    pub(crate) fn wrenches(&self, at: &Configuration<T>, driver: Driver<T>) -> [Wrench<T>; 6] {
        let like = at.rack;
        let mut wrenches = [Wrench::zero(like); 6];
        for (k, row) in self.rows.iter().enumerate() {
            row.differential(at, like.one(), &mut wrenches[k]);
        }
        self.driver_differential(at, driver, like.one(), &mut wrenches[5]);
        wrenches
    }

    /// Residual of one of the six equations, and its row of the Jacobian as in [`Closure::wrenches`].
    #[inline(always)]
    pub(crate) fn row(
        &self,
        number: usize,
        at: &Configuration<T>,
        driver: Driver<T>,
    ) -> (T, Wrench<T>) {
        let mut wrench = Wrench::zero(at.rack);
        let one = at.rack.one();
        let residual = match self.rows.get(number) {
            Some(row) => {
                row.differential(at, one, &mut wrench);
                row.residual(at)
            }
            None => {
                self.driver_differential(at, driver, one, &mut wrench);
                self.driver_residual(at, driver)
            }
        };
        (residual, wrench)
    }

    /// Rates of the rows of [`Closure::wrenches`] along a motion of the knuckle, with the rack fixed. The sixth row is the
    /// drive with the wheel travel.
    #[inline(always)]
    pub(crate) fn wrench_rates(&self, at: &Configuration<T>, along: &Twist<T>) -> [Wrench<T>; 6] {
        let mut rates = [Wrench::zero(at.rack); 6];
        for (k, row) in self.rows.iter().enumerate() {
            rates[k] = row.wrench_rate(at, along);
        }
        if let Some(row) = &self.driven {
            rates[5] = row.wrench_rate(at, along);
            return rates;
        }
        let centre = at.designed_lever(at.mechanism.wheel_centre);
        let velocity = along.turn.cross(at.pose.rotation.apply(centre));
        let zero = velocity.x.zero();
        rates[5].moment = Vector3::new(velocity.y, -velocity.x, zero);
        rates
    }

    /// Adds `weights` times the differentials of the equations in `rows` to the sink. This function is not inlined, for
    /// the same reason as [`Closure::residuals`].
    #[inline(never)]
    pub(crate) fn differential(
        &self,
        rows: RowSet,
        at: &Configuration<T>,
        driver: Driver<T>,
        weights: &Vector6<T>,
        mut sink: &mut dyn Sink<T>,
    ) {
        self.differential_inlined(rows, at, driver, weights, &mut sink);
    }

    /// Adds differentials as [`Closure::differential`] does, for SIMD lanes.
    #[inline(always)]
    pub(crate) fn differential_inlined(
        &self,
        rows: RowSet,
        at: &Configuration<T>,
        driver: Driver<T>,
        weights: &Vector6<T>,
        sink: &mut impl Sink<T>,
    ) {
        for (number, row) in self.rows.iter().enumerate() {
            if rows.holds(number) {
                row.differential(at, weights[number], sink);
            }
        }
        if rows.holds(driver.row()) {
            self.driver_differential(at, driver, weights[5], sink);
        }
    }

    #[inline(always)]
    fn driver_residual(&self, at: &Configuration<T>, driver: Driver<T>) -> T {
        match driver {
            Driver::Travel(travel) => {
                if let Some(row) = &self.driven {
                    return row.value(at) - travel;
                }
                let centre = at.mechanism.wheel_centre;
                at.carried(centre).z - at.designed(centre).z - travel
            }
            Driver::ArmAngle { sine, cosine } => ArmAngle { sine, cosine }.residual(at),
        }
    }

    #[inline(always)]
    fn driver_differential(
        &self,
        at: &Configuration<T>,
        driver: Driver<T>,
        weight: T,
        sink: &mut impl Sink<T>,
    ) {
        match driver {
            Driver::Travel(_) => {
                if let Some(row) = &self.driven {
                    return row.push(at, weight, sink);
                }
                let centre = at.mechanism.wheel_centre;
                let zero = weight.zero();
                let up = Vector3::new(zero, zero, weight);
                at.push_carried(centre, up, sink);
                sink.hardpoint(centre, -up);
            }
            Driver::ArmAngle { sine, cosine } => {
                ArmAngle { sine, cosine }.differential(at, weight, sink);
            }
        }
    }
}

impl Closure<f64> {
    /// Set of equations that depend on one of these hardpoints, either on its design position or on its present
    /// position.
    pub(crate) fn rows_holding(
        &self,
        mechanism: &Mechanism,
        design: &[Vector3<f64>],
        points: &[PointId],
    ) -> RowSet {
        let origin = design[mechanism.origin.0];
        let at = Configuration::new(
            mechanism,
            design,
            Pose {
                origin,
                rotation: Matrix3::identity(1.0),
            },
            0.0,
        );
        let drivers = [
            Driver::Travel(0.0),
            Driver::ArmAngle {
                sine: 0.0,
                cosine: 1.0,
            },
        ];
        let mut set = RowSet(0);
        let mut touches = Touches {
            points,
            found: false,
        };
        for (number, row) in self.rows.iter().enumerate() {
            touches.found = false;
            row.differential(&at, 1.0, &mut touches);
            set.0 |= u8::from(touches.found) << number;
        }
        for driver in drivers {
            // The arm angle cannot drive a mechanism without an arm.
            if mechanism.arms.is_empty() && matches!(driver, Driver::ArmAngle { .. }) {
                continue;
            }
            touches.found = false;
            self.driver_differential(&at, driver, 1.0, &mut touches);
            set.0 |= u8::from(touches.found) << driver.row();
        }
        set
    }

    /// Takes one Newton step from a pose. Returns the corrected pose, the size of the correction as a length, and the
    /// factorised Jacobian. A rotation counts as the displacement that it causes at the distance `size`. `None` if the Jacobian
    /// is singular.
    pub(crate) fn newton_step(
        &self,
        at: &Configuration<f64>,
        driver: Driver<f64>,
        size: f64,
    ) -> Option<(Pose<f64>, f64, Lu6<f64>)> {
        let lu = Lu6::new(self.jacobian(at, driver), size)?;
        let [x, y, z, a, b, c] = lu.solve(self.residuals(at, driver)).each(|v| -v);
        let (shift, turn) = (Vector3::new(x, y, z), Vector3::new(a, b, c));
        let pose = at.pose.moved(shift, turn * 0.5);
        Some((pose, shift.norm().max(turn.norm() * size), lu))
    }
}

impl<T> Driver<T> {
    /// Bit of this drive's equation in a [`RowSet`].
    #[inline]
    fn row(&self) -> usize {
        match self {
            Driver::Travel(_) => 5,
            Driver::ArmAngle { .. } => 6,
        }
    }
}

impl<T: Real> Driver<T> {
    /// Converts the drive to another kind of number.
    #[inline]
    pub(crate) fn map<U: Copy>(self, f: impl Fn(T) -> U + Copy) -> Driver<U> {
        match self {
            Driver::Travel(travel) => Driver::Travel(f(travel)),
            Driver::ArmAngle { sine, cosine } => Driver::ArmAngle {
                sine: f(sine),
                cosine: f(cosine),
            },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::number::Jet;
    use crate::study::Study;
    use std::path::Path;

    /// A steered axle on four links.
    const STEERED: &str = r#"
[suspension]
topology = "solid_axle"
[suspension.hardpoints]
lower_link_chassis = [-840.0,  420.0,  385.0]
lower_link_axle    = [  -5.0,  430.0,  305.0]
upper_link_chassis = [-640.0,  470.0,  525.0]
upper_link_axle    = [ -15.0,  150.0,  555.0]
wheel_centre       = [   0.0,  760.0,  375.0]
kingpin_upper      = [ -18.0,  650.0,  470.0]
kingpin_lower      = [  12.0,  675.0,  280.0]
drag_link_body     = [ 190.0, -420.0,  545.0]
drag_link_knuckle  = [ 160.0,  560.0,  480.0]
tie_rod_end        = [-150.0,  610.0,  330.0]
[wheel]
static_camber = 0.0
static_toe = 0.0
[motion]
heave = [0.0]
"#;

    /// The rates of all rows of the Jacobian along a motion of the knuckle equal the derivatives of Taylor series. The test
    /// covers rods on knuckles, rods on a half of a twist beam, and rods on both halves of an axle.
    #[test]
    fn rates_of_rows_are_those_of_series() {
        let beam = crate::model::Topology::named("twist_beam")
            .unwrap()
            .template;
        for text in [STEERED, beam] {
            let study = Study::from_text("study.toml", text, Path::new("")).unwrap();
            let left = &study.axle().unwrap().axle.left;
            let turned = left.mechanism.from_other_wheel();
            let mut over = left.design.clone();
            let rigid = left.mechanism.rigid_axle.as_ref().unwrap();
            rigid.turn_over(&left.design, &mut over);
            for (mechanism, design) in [(&left.mechanism, &left.design), (&turned, &over)] {
                compare(mechanism, design);
            }
        }
    }

    fn compare(mechanism: &Mechanism, design: &[Vector3<f64>]) {
        let designed = Pose {
            origin: design[mechanism.origin.0],
            rotation: Matrix3::identity(1.0),
        };
        let pose = designed.moved(
            Vector3::new(9.0, -7.0, 20.0),
            Vector3::new(0.02, 0.03, -0.01),
        );
        let along = Twist {
            shift: Vector3::new(0.3, -0.2, 0.9),
            turn: Vector3::new(0.004, -0.002, 0.003),
        };
        let at = Configuration::new(mechanism, design, pose, 0.0);
        let driver = Driver::Travel(0.0);
        let rates = Closure::new(mechanism, design).wrench_rates(&at, &along);

        let series: Vec<Vector3<Jet<f64, 2>>> =
            design.iter().map(|p| p.map(Jet::constant)).collect();
        let rate = |v: Vector3<f64>| v.map(|c| Jet([0.0, c]));
        let moving = pose
            .map(Jet::constant)
            .moved(rate(along.shift), rate(along.turn * 0.5));
        let at = Configuration::new(mechanism, &series, moving, Jet::constant(0.0));
        let driver = driver.map(Jet::constant);
        let expected = Closure::new(mechanism, &series).wrenches(&at, driver);
        for (number, (rate, expected)) in rates.iter().zip(&expected).enumerate() {
            let [force, moment] = [expected.force, expected.moment].map(|v| v.map(|c| c[1]));
            let (off, turn) = ((rate.force - force).norm(), (rate.moment - moment).norm());
            assert!(off < 1e-14, "row {number}: {:?} {force:?}", rate.force);
            assert!(turn < 1e-11, "row {number}: {:?} {moment:?}", rate.moment);
        }
    }
}
