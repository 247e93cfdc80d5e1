//! State of one wheel in the car's axes, computed from the wheel of its axle.

use crate::axle::{Carriers, RockerMotion, WheelParts};
use crate::characteristics::{NumberPart, VectorPart};
use crate::model::AxleTravel;
use crate::number::{Each, Real, Vector3};

/// Derivatives of a wheel's pose with respect to one travel of its axle, while the body of the car is held.
#[derive(Clone, Copy, Debug)]
pub struct WheelRates<T> {
    /// Derivative W' of the position of the wheel centre.
    pub centre: Vector3<T>,
    /// Angular velocity of the wheel carrier, per unit of travel.
    pub turn: Vector3<T>,
    /// Derivative of the spring's length.
    pub spring: T,
    /// Derivative of the angle of the anti-roll bar's lever.
    pub bar: T,
}

/// Motion of a steered solid axle, without its knuckles, while the left wheel rises and the right wheel falls.
#[derive(Clone, Copy, Debug)]
pub struct AxleMotion<T> {
    /// A point of the solid axle.
    pub point: Vector3<T>,
    /// Velocity of `point`.
    pub velocity: Vector3<T>,
    /// Angular velocity of the axle.
    pub turn: Vector3<T>,
}

/// State of one wheel at its travel, in the car's axes.
#[derive(Clone, Copy, Debug)]
pub struct Corner<T> {
    /// 1 for a left wheel, -1 for a right wheel.
    pub sign: f64,
    /// Wheel centre W.
    pub centre: Vector3<T>,
    /// Unit vector a along the spin axis, outboard.
    pub spin: Vector3<T>,
    /// Length of the spring.
    pub spring: T,
    /// Length of the spring in the design position.
    pub design_spring: T,
    /// Angle of the anti-roll bar's lever.
    pub bar: T,
    /// Motion of the rocker, in the frame of the wheel's side.
    pub rocker: RockerMotion<T>,
    /// Wheel centre W in the design position.
    pub design_centre: Vector3<T>,
    /// Spin axis in the design position.
    pub design_spin: Vector3<T>,
    /// Derivatives with respect to the wheel's own travel.
    pub own: WheelRates<T>,
    /// Derivatives with respect to the other wheel's travel, for a solid axle or twist beam.
    pub other: Option<WheelRates<T>>,
    /// Motion of the axle itself, for the left wheel of a steered solid axle.
    pub axle: Option<AxleMotion<T>>,
}

/// Steps from the travels and the rack displacement at which the values of the wheel were computed.
#[derive(Clone, Copy, Debug)]
pub(super) struct Steps<T> {
    /// Change of the wheel's own travel.
    pub own: T,
    /// Change of the other wheel's travel.
    pub other: T,
    /// Change of the rack displacement, in the wheel's frame; `None` if the values of the wheel were computed at one
    /// rack displacement only.
    pub rack: Option<T>,
}

/// Value and first derivatives of a polynomial in two variables `a` and `b`. `c` returns the coefficient for a pair of
/// exponents. The terms go to the third degree, so derivatives of the results are exact up to the second order. If `b` is
/// `None`, the second variable is omitted. If `has_fourth` is true, the fourth-degree coefficient of `a` is known.
/// Derivatives with respect to `a` alone are then exact up to the third order.
#[inline(always)]
fn polynomial<T: Real>(
    c: impl Fn([usize; 2]) -> T,
    a: T,
    b: Option<T>,
    has_fourth: bool,
) -> [T; 3] {
    let mut value = c([0, 0]) + a * (c([1, 0]) + a * c([2, 0]));
    let mut first = c([1, 0]) + a * (c([2, 0]).scaled(2.0) + a * c([3, 0]).scaled(3.0));
    if has_fourth {
        let cube = a * a * a;
        value = value + cube * c([3, 0]);
        first = first + cube * c([4, 0]).scaled(4.0);
    }
    let Some(b) = b else {
        return [value, first, a.zero()];
    };
    [
        value + b * (c([0, 1]) + a * c([1, 1]) + b * c([0, 2])),
        first + b * (c([1, 1]) + (a * c([2, 1])).scaled(2.0) + b * c([1, 2])),
        c([0, 1])
            + a * (c([1, 1]) + a * c([2, 1]))
            + b * (c([0, 2]).scaled(2.0) + (a * c([1, 2])).scaled(2.0) + b * c([0, 3]).scaled(3.0)),
    ]
}

/// Derivatives with respect to the wheel's own travel and to the other wheel's travel.
struct ByTravels<T> {
    own: T,
    other: T,
}

#[inline(always)]
fn by_travels<T: Real>(held: AxleTravel, [first, second]: [T; 2]) -> ByTravels<T> {
    // The variables of the polynomial are the mean (own + other)/2 and the difference (own - other)/2. `held` tells which
    // of them the axle holds: it is the second variable. If the own travel changes by 1, both variables change by 1/2. If
    // the other travel changes by 1, the mean changes by 1/2 and the difference by -1/2.
    let other = match held {
        AxleTravel::Mean => second - first,
        AxleTravel::Difference => first - second,
    };
    ByTravels {
        own: (first + second).scaled(0.5),
        other: other.scaled(0.5),
    }
}

impl<T: Copy> WheelRates<T> {
    fn map<U: Copy>(&self, f: impl Fn(T) -> U + Copy) -> WheelRates<U> {
        WheelRates {
            centre: self.centre.map(f),
            turn: self.turn.map(f),
            spring: f(self.spring),
            bar: f(self.bar),
        }
    }
}

impl<T: Copy> Corner<T> {
    /// Converts all values of the wheel to another number type.
    pub(super) fn map<U: Copy>(&self, f: impl Fn(T) -> U + Copy) -> Corner<U> {
        Corner {
            sign: self.sign,
            centre: self.centre.map(f),
            spin: self.spin.map(f),
            spring: f(self.spring),
            design_spring: f(self.design_spring),
            bar: f(self.bar),
            rocker: self.rocker.map(f),
            design_centre: self.design_centre.map(f),
            design_spin: self.design_spin.map(f),
            own: self.own.map(f),
            other: self.other.as_ref().map(|rates| rates.map(f)),
            axle: self.axle.as_ref().map(|axle| AxleMotion {
                point: axle.point.map(f),
                velocity: axle.velocity.map(f),
                turn: axle.turn.map(f),
            }),
        }
    }
}

impl<T: Real> Corner<T> {
    /// Computes the state of a wheel after the changes `steps` of travels and rack. The values of `wheel` are in the
    /// frame of its side. `lift` converts these values to the number type of the result.
    #[inline(always)]
    pub(super) fn read<U: Real, W: WheelParts<U>>(
        wheel: &W,
        (sign, carriers): (f64, Carriers),
        offset: Vector3<T>,
        steps: Steps<T>,
        lift: impl Fn(U) -> T + Copy,
    ) -> Self {
        let at = Displacement::of::<U, W>(carriers, &steps);
        let mirrored = |v: Vector3<T>| Vector3::new(v.x, v.y.scaled(sign), v.z);
        let zero = at.first.zero();
        let turns = angular_velocities(&at, wheel, carriers.is_rigid(), lift);
        // The angular velocity is an axial vector, so a reflection also reverses its sign.
        let turns = turns.each(|turn| mirrored(turn).scaled(sign));
        let mut vectors = [[Vector3::new(zero, zero, zero); 3]; 3];
        let parts = [
            VectorPart::Centre,
            VectorPart::SpinAxis,
            VectorPart::HeaveSpring,
        ];
        for (vectors, part) in vectors.iter_mut().zip(parts) {
            *vectors = vector(&at, wheel, part, lift);
        }
        let [
            [centre, centre_first, centre_second],
            [spin, ..],
            [end, end_first, _],
        ] = vectors;
        let centres = [centre_first, centre_second].each(mirrored);
        let mut numbers = [[zero; 3]; 3];
        let parts = [
            NumberPart::SpringLength,
            NumberPart::BarAngle,
            NumberPart::RockerAngle,
        ];
        for (numbers, part) in numbers.iter_mut().zip(parts) {
            *numbers = number(&at, wheel, part, lift);
        }
        let [
            [spring, spring_first, spring_second],
            [bar, bar_first, bar_second],
            [angle, angle_first, _],
        ] = numbers;
        let (own, other) = rates(
            carriers,
            centres,
            turns,
            [spring_first, spring_second],
            [bar_first, bar_second],
        );
        let axle = match (carriers, sign > 0.0) {
            (Carriers::Steered(held), true) => {
                let columns = [0, 1].each(|i| at.vector(|p| wheel.axle_column(i, p).map(lift)));
                let place = vector(&at, wheel, VectorPart::SteeringPoint, lift);
                Some(axle_motion(held, columns, place, offset))
            }
            _ => None,
        };
        let design = wheel.design();
        Corner {
            sign,
            centre: mirrored(centre) + offset,
            spin: mirrored(spin),
            spring,
            design_spring: lift(design.spring_length),
            bar,
            rocker: RockerMotion {
                end: [end, end_first],
                design_end: design.heave_spring.map(lift),
                angle: [angle, angle_first],
            },
            design_centre: mirrored(design.centre.map(lift)) + offset,
            design_spin: mirrored(design.spin_axis.map(lift)),
            own,
            other,
            axle,
        }
    }
}

/// Computes the motion of the axle while the left wheel rises and the right wheel falls. The inputs are two columns of
/// the axle's rotation matrix, and a point. Each has its derivatives with respect to both coordinates of the power
/// series.
fn axle_motion<T: Real>(
    held: AxleTravel,
    [along, across]: [[Vector3<T>; 3]; 2],
    place: [Vector3<T>; 3],
    offset: Vector3<T>,
) -> AxleMotion<T> {
    let by_difference = |[_, first, second]: [Vector3<T>; 3]| match held {
        AxleTravel::Mean => first,
        AxleTravel::Difference => second,
    };
    let (a, b) = (along[0], across[0]);
    let (a_rate, b_rate) = (by_difference(along), by_difference(across));
    AxleMotion {
        point: place[0] + offset,
        velocity: by_difference(place),
        turn: a.cross(a_rate) + a * b_rate.dot(a.cross(b)),
    }
}

/// Small displacement from the travel and the rack displacement about which the series of a wheel are expanded.
struct Displacement<T> {
    /// Step of the first coordinate: the wheel's own travel, or the axle's travel (mean or difference) that is not held.
    first: T,
    /// Step of the second coordinate: the rack or the held travel. `None` if there is no such coordinate.
    second: Option<T>,
    /// True if the coefficients of the fourth power of the first step are known.
    has_fourth: bool,
}

impl<T: Real> Displacement<T> {
    #[inline(always)]
    fn of<U: Real, W: WheelParts<U>>(carriers: Carriers, steps: &Steps<T>) -> Self {
        let (first, second) = match carriers.held() {
            None => (steps.own, steps.rack),
            Some(held) => {
                let mean = (steps.own + steps.other).scaled(0.5);
                let difference = (steps.own - steps.other).scaled(0.5);
                match held {
                    AxleTravel::Mean => (difference, Some(mean)),
                    AxleTravel::Difference => (mean, Some(difference)),
                }
            }
        };
        Displacement {
            first,
            second,
            has_fourth: W::HAS_FOURTH,
        }
    }

    /// Returns a number and its derivatives with respect to both coordinates of its power series. `of` returns the
    /// coefficients of this series.
    #[inline(always)]
    fn number(&self, of: impl Fn([usize; 2]) -> T) -> [T; 3] {
        polynomial(of, self.first, self.second, self.has_fourth)
    }

    /// Returns a vector and its derivatives with respect to both coordinates of its power series. `of` returns the
    /// coefficients of this series.
    #[inline(always)]
    fn vector(&self, of: impl Fn([usize; 2]) -> Vector3<T>) -> [Vector3<T>; 3] {
        let (a, b) = (self.first, self.second);
        let zero = a.zero();
        // Read each coefficient once for all three components.
        let mut table = [[Vector3::new(zero, zero, zero); 4]; 5];
        let degrees = if self.has_fourth { 5 } else { 4 };
        for (i, row) in table.iter_mut().enumerate().take(degrees) {
            let count = match (i, b) {
                (..4, Some(_)) => 4 - i,
                _ => 1,
            };
            for (j, entry) in row.iter_mut().enumerate().take(count) {
                *entry = of([i, j]);
            }
        }
        let [x, y, z] = [
            polynomial(|[i, j]| table[i][j].x, a, b, self.has_fourth),
            polynomial(|[i, j]| table[i][j].y, a, b, self.has_fourth),
            polynomial(|[i, j]| table[i][j].z, a, b, self.has_fourth),
        ];
        [0, 1, 2].each(|k| Vector3::new(x[k], y[k], z[k]))
    }
}

/// Returns a vector of a wheel and its derivatives with respect to both coordinates of its power series. If the wheel was
/// expanded at the present travel, the coefficients of the series already are the results. The code treats this case
/// separately, because the compiler would not inline the closure for SIMD lanes.
#[inline(always)]
fn vector<T: Real, U: Real, W: WheelParts<U>>(
    at: &Displacement<T>,
    wheel: &W,
    part: VectorPart,
    lift: impl Fn(U) -> T + Copy,
) -> [Vector3<T>; 3] {
    if W::IS_AT_TRAVELS {
        let zero = at.first.zero();
        return [
            wheel.read_vector(part, [0, 0]).map(lift),
            wheel.read_vector(part, [1, 0]).map(lift),
            Vector3::new(zero, zero, zero),
        ];
    }
    at.vector(|p| wheel.read_vector(part, p).map(lift))
}

/// Returns a column of the carrier's rotation matrix and its derivatives, like [`vector`].
#[inline(always)]
fn column<T: Real, U: Real, W: WheelParts<U>>(
    at: &Displacement<T>,
    wheel: &W,
    i: usize,
    lift: impl Fn(U) -> T + Copy,
) -> [Vector3<T>; 3] {
    if W::IS_AT_TRAVELS {
        let zero = at.first.zero();
        return [
            wheel.column(i, [0, 0]).map(lift),
            wheel.column(i, [1, 0]).map(lift),
            Vector3::new(zero, zero, zero),
        ];
    }
    at.vector(|p| wheel.column(i, p).map(lift))
}

/// Returns the angular velocities of the carrier with respect to the two variables of the power series, in the frame of
/// the wheel's side. The variables are the wheel's own and the other wheel's travel, or their mean and difference. The
/// second angular velocity is zero if the wheels are independent (`is_rigid` is false). An angular velocity is half the
/// sum of the cross products of the columns of the rotation matrix with their derivatives.
#[inline(always)]
fn angular_velocities<T: Real, U: Real, W: WheelParts<U>>(
    at: &Displacement<T>,
    wheel: &W,
    is_rigid: bool,
    lift: impl Fn(U) -> T + Copy,
) -> [Vector3<T>; 2] {
    let zero = at.first.zero();
    let mut sums = [Vector3::new(zero, zero, zero); 2];
    for i in 0..3 {
        let [column, first, second] = column(at, wheel, i, lift);
        sums[0] = sums[0] + column.cross(first);
        if is_rigid {
            sums[1] = sums[1] + column.cross(second);
        }
    }
    [sums[0].scaled(0.5), sums[1].scaled(0.5)]
}

/// Returns one value of a wheel and its derivatives, like [`vector`].
#[inline(always)]
fn number<T: Real, U: Real, W: WheelParts<U>>(
    at: &Displacement<T>,
    wheel: &W,
    part: NumberPart,
    lift: impl Fn(U) -> T + Copy,
) -> [T; 3] {
    if W::IS_AT_TRAVELS {
        let [value, first] = [[0, 0], [1, 0]].each(|p| lift(wheel.number(part, p)));
        return [value, first, at.first.zero()];
    }
    at.number(|p| lift(wheel.number(part, p)))
}

/// Converts derivatives with respect to the coordinates of the series to derivatives with respect to the wheel's own
/// travel and the other wheel's travel.
#[inline(always)]
fn rates<T: Real>(
    carriers: Carriers,
    centres: [Vector3<T>; 2],
    turns: [Vector3<T>; 2],
    springs: [T; 2],
    bars: [T; 2],
) -> (WheelRates<T>, Option<WheelRates<T>>) {
    let of = |centre, turn, spring, bar| WheelRates {
        centre,
        turn,
        spring,
        bar,
    };
    let Some(held) = carriers.held() else {
        return (of(centres[0], turns[0], springs[0], bars[0]), None);
    };
    let vectors = |[first, second]: [Vector3<T>; 2]| {
        let [x, y, z] = [
            by_travels(held, [first.x, second.x]),
            by_travels(held, [first.y, second.y]),
            by_travels(held, [first.z, second.z]),
        ];
        ByTravels {
            own: Vector3::new(x.own, y.own, z.own),
            other: Vector3::new(x.other, y.other, z.other),
        }
    };
    let (centre, turn) = (vectors(centres), vectors(turns));
    let spring = by_travels(held, springs);
    let bar = by_travels(held, bars);
    let other = of(centre.other, turn.other, spring.other, bar.other);
    (of(centre.own, turn.own, spring.own, bar.own), Some(other))
}
