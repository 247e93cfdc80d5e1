//! A wheel in the car's axes, read from the wheel of its axle.

use crate::axle::WheelParts;
use crate::characteristics::{NumberPart, VectorPart};
use crate::number::{Each, Real, Vector3};

/// A wheel at its travel, in the car's axes. Rates are by the wheel's own travel, the body held.
#[derive(Clone, Copy, Debug)]
pub struct Corner<T> {
    /// 1 for a left wheel, -1 for a right one.
    pub sign: f64,
    /// Wheel centre W.
    pub centre: Vector3<T>,
    /// Spin axis a, outboard.
    pub spin: Vector3<T>,
    /// W'.
    pub centre_rate: Vector3<T>,
    /// Angular velocity of the carrier.
    pub turn: Vector3<T>,
    /// Length of the spring and its rate.
    pub spring: [T; 2],
    /// Length of the spring in the design position.
    pub design_spring: T,
    /// Angle of the anti-roll bar's lever and its rate.
    pub bar: [T; 2],
    /// Wheel centre in the design position.
    pub design_centre: Vector3<T>,
    /// Spin axis in the design position.
    pub design_spin: Vector3<T>,
}

impl<T: Real> Corner<T> {
    /// The wheel that `wheel` reads in the frame of its own side, `step` further in travel. `lift` makes numbers of the
    /// wheel into numbers of this kind. Derivatives of the result by `step` are exact up to the second.
    pub fn read<U: Real>(
        wheel: &impl WheelParts<U>,
        sign: f64,
        offset: Vector3<T>,
        step: T,
        lift: impl Fn(U) -> T + Copy,
    ) -> Self {
        // Value and rate of a polynomial in the travel.
        let at = |c: [T; 4]| {
            let value = c[0] + step * (c[1] + step * c[2]);
            let rate = c[1] + step * (c[2].scaled(2.0) + step * c[3].scaled(3.0));
            [value, rate]
        };
        let vector = |of: &dyn Fn([usize; 2]) -> Vector3<U>| {
            let coefficients = [0, 1, 2, 3].each(|k| of([k, 0]).map(lift));
            let [x, y, z] = [
                at(coefficients.each(|c| c.x)),
                at(coefficients.each(|c| c.y)),
                at(coefficients.each(|c| c.z)),
            ];
            [0, 1].each(|k| Vector3::new(x[k], y[k], z[k]))
        };
        let number = |part: NumberPart| at([0, 1, 2, 3].each(|k| lift(wheel.number(part, [k, 0]))));
        let mirrored = |v: Vector3<T>| Vector3::new(v.x, v.y.scaled(sign), v.z);
        let mut turn = Vector3::new(step.zero(), step.zero(), step.zero());
        for i in 0..3 {
            let [column, rate] = vector(&|powers| wheel.column(i, powers));
            turn = turn + column.cross(rate);
        }
        let half = step.lit(0.5);
        let [centre, centre_rate] = vector(&|powers| wheel.read_vector(VectorPart::Centre, powers));
        let [spin, _] = vector(&|powers| wheel.read_vector(VectorPart::SpinAxis, powers));
        let design = wheel.design();
        Corner {
            sign,
            centre: mirrored(centre) + offset,
            spin: mirrored(spin),
            centre_rate: mirrored(centre_rate),
            // An axial vector: its mirror image turns the other way.
            turn: mirrored(turn * half).scaled(sign),
            spring: number(NumberPart::SpringLength),
            design_spring: lift(design.spring_length),
            bar: number(NumberPart::BarAngle),
            design_centre: mirrored(design.centre.map(lift)) + offset,
            design_spin: mirrored(design.spin_axis.map(lift)),
        }
    }
}

trait Scaled {
    fn scaled(self, factor: f64) -> Self;
}

impl<T: Real> Scaled for Vector3<T> {
    fn scaled(self, factor: f64) -> Self {
        self.map(|c| c.scaled(factor))
    }
}
