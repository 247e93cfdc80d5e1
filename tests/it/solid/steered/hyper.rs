//! Numbers with first derivatives along two directions and the mixed second derivative. With these numbers, the
//! independent formulation has exact derivatives.

use std::ops::{Add, Div, Mul, Neg, Sub};

/// A value, its first derivatives along two directions, and its mixed second derivative.
#[derive(Clone, Copy, Debug)]
pub struct Hyper {
    pub value: f64,
    pub first: f64,
    pub second: f64,
    pub both: f64,
}

pub type Point = [Hyper; 3];

impl Hyper {
    pub fn constant(value: f64) -> Hyper {
        Hyper {
            value,
            first: 0.0,
            second: 0.0,
            both: 0.0,
        }
    }

    /// Function with this value, first and second derivative with respect to its argument.
    fn chain(self, value: f64, slope: f64, curvature: f64) -> Hyper {
        Hyper {
            value,
            first: slope * self.first,
            second: slope * self.second,
            both: slope * self.both + curvature * self.first * self.second,
        }
    }

    pub fn sqrt(self) -> Hyper {
        let root = self.value.sqrt();
        self.chain(root, 0.5 / root, -0.25 / (root * self.value))
    }

    pub fn sine(self) -> Hyper {
        let (sine, cosine) = self.value.sin_cos();
        self.chain(sine, cosine, -sine)
    }

    pub fn cosine(self) -> Hyper {
        let (sine, cosine) = self.value.sin_cos();
        self.chain(cosine, -sine, -cosine)
    }

    pub fn inverse(self) -> Hyper {
        let inverse = 1.0 / self.value;
        self.chain(
            inverse,
            -inverse * inverse,
            2.0 * inverse * inverse * inverse,
        )
    }

    pub fn arctangent(self) -> Hyper {
        let slope = 1.0 / (1.0 + self.value * self.value);
        self.chain(self.value.atan(), slope, -2.0 * self.value * slope * slope)
    }

    /// Returns the angle of a direction with the components `ahead` (must be positive) and `self` (across).
    pub fn angle(self, ahead: Hyper) -> Hyper {
        assert!(ahead.value > 0.0);
        (self * ahead.inverse()).arctangent()
    }

    pub fn scaled(self, by: f64) -> Hyper {
        Hyper {
            value: self.value * by,
            first: self.first * by,
            second: self.second * by,
            both: self.both * by,
        }
    }
}

impl Add for Hyper {
    type Output = Hyper;
    fn add(self, other: Hyper) -> Hyper {
        Hyper {
            value: self.value + other.value,
            first: self.first + other.first,
            second: self.second + other.second,
            both: self.both + other.both,
        }
    }
}

impl Neg for Hyper {
    type Output = Hyper;
    fn neg(self) -> Hyper {
        self.scaled(-1.0)
    }
}

impl Sub for Hyper {
    type Output = Hyper;
    fn sub(self, other: Hyper) -> Hyper {
        self + -other
    }
}

impl Mul for Hyper {
    type Output = Hyper;
    fn mul(self, other: Hyper) -> Hyper {
        Hyper {
            value: self.value * other.value,
            first: self.first * other.value + self.value * other.first,
            second: self.second * other.value + self.value * other.second,
            both: self.both * other.value
                + self.first * other.second
                + self.second * other.first
                + self.value * other.both,
        }
    }
}

impl Div for Hyper {
    type Output = Hyper;
    fn div(self, other: Hyper) -> Hyper {
        Mul::mul(self, other.inverse())
    }
}

pub fn plus(a: Point, b: Point) -> Point {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

pub fn minus(a: Point, b: Point) -> Point {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

pub fn times(a: Point, by: Hyper) -> Point {
    a.map(|c| c * by)
}

pub fn dot(a: Point, b: Point) -> Hyper {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub fn cross(a: Point, b: Point) -> Point {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

pub fn unit(a: Point) -> Point {
    times(a, dot(a, a).sqrt().inverse())
}

pub fn mirror([x, y, z]: Point) -> Point {
    [x, -y, z]
}
