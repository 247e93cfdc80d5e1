//! A wheel as a function of its travels and of one direction of its design.
//!
//! With the design d(e) = d_0 + d_1 e + d_2 e^2, each value of a wheel is u(a, b, e). Here a and b are steps of travel and
//! rack. For a rigid axle, a and b are steps of its two travels. Along a line (a, b) = t (p, q), the value is a polynomial in
//! t and e. The coefficients c_ij of t^i e^j are computed from power series in s along straight lines (t, e) = s (1, 0), s (0,
//! 1), s (1, 1), s (1, -1), as in module `taylor`. Degree 4 needs one more line, s (2, 1). With A, B and C, the coefficients of
//! s^4 along the last three lines,
//!
//! ```text
//! c_22 = (A + B)/2 - c_40 - c_04                                                                                (1)
//! c_31 = (C - 16 c_40 - 4 c_22 - c_04 - (A - B))/6                                                              (2)
//! ```

use super::reading::{Parts, Reading, Snapshot, WheelParts, WheelPose};
use super::series::Series;
use super::solver::displace;
use super::taylor::{Line, Taylor};
use crate::characteristics::{DesignWheel, NumberPart, VectorPart};
use crate::derive::pose_series;
use crate::linear::lu::Lu6;
use crate::mechanism::{Closure, Configuration, Driver, Pose};
use crate::model::Mechanism;
use crate::number::{Jet, Vector3, array_of};
use std::cell::{Cell, RefCell};

/// Number of terms of the series of an independent wheel.
const TERMS: usize = 5;
/// Number of terms of the series of a wheel of a rigid axle.
const TERMS_OF_RIGID: usize = 4;

/// A wheel of an axle in a solved pose, prepared for power series along changes of its design.
#[derive(Clone, Debug)]
pub(crate) struct Expandable<'a> {
    pub(super) mechanism: &'a Mechanism,
    /// Design in which the wheel was solved. Its steering gear is in the centre position.
    pub(super) design: &'a [Vector3<f64>],
    pub(super) pose: Pose<f64>,
    /// LU factors of the closure equations' Jacobian in this pose.
    pub(super) factors: Lu6<f64>,
    /// Driving travel and rack displacement of the wheel, in its own frame. For a rigid axle, the held travel takes the place of
    /// the rack displacement.
    pub(super) coordinates: (f64, f64),
    /// Displacement of the steering gear of a steered axle.
    pub(super) gear: f64,
    pub(super) lines: &'static [Line],
    pub(super) parts: Parts,
}

/// A wheel as a function of its travel, and of a change of its design along one direction. Each value is a polynomial in
/// travel, up to travel^3 (up to travel^4 for an independent wheel). The coefficients of the polynomial are Taylor series along
/// the direction of the design.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ExpandedWheel {
    reading: Reading<Series>,
    /// Coefficients of the fourth power of travel; zero for a rigid axle.
    fourth: WheelPose<Series>,
}

/// Coefficients of powers of travel, each a series along the direction of the design.
type ByTravel = [Series; TERMS];

impl Expandable<'_> {
    /// Returns the wheel as a function of travel, with a design that does not change.
    pub(crate) fn still(&self) -> ExpandedWheel {
        let design: Vec<_> = self.design.iter().map(|p| p.map(Jet::constant)).collect();
        self.along(&design)
    }

    /// Returns the wheel as a function of travel and of the change of its design. The points of `design` are series in e.
    pub(crate) fn along(&self, design: &[Vector3<Series>]) -> ExpandedWheel {
        let lines = self.lines.iter();
        let series: Vec<Vec<ByTravel>> = match self.mechanism.rigid_axle {
            None => lines.take(1).map(|line| self.line(design, line)).collect(),
            Some(_) => lines.map(|line| self.line_of_rigid(design, line)).collect(),
        };
        let count = Cell::new(0);
        let numbers = WheelPose::filled(()).map(|()| {
            count.set(count.get() + 1);
            count.get() - 1
        });
        let moving = |number: usize| {
            let mut along: [&[Series]; 4] = [&[]; 4];
            for (along, line) in along.iter_mut().zip(&series) {
                *along = &line[number][..TERMS_OF_RIGID];
            }
            Taylor::through(&along[..series.len()])
        };
        ExpandedWheel {
            reading: Reading::made_of(&numbers, moving, |number: usize| series[0][number][0]),
            fourth: numbers.map(|number| series[0][number][TERMS - 1]),
        }
    }

    /// Returns the values of the wheel along (t, e) = s (`travel`, `design`). Here t is the step along a line in travel and
    /// rack.
    fn series<const N: usize>(
        &self,
        along: &[Vector3<Series>],
        line: &Line,
        [travel, part]: [f64; 2],
    ) -> Vec<Jet<f64, N>> {
        let extended = |c: Series| {
            let mut series = [0.0; N];
            series[..3].copy_from_slice(&[c[0], part * c[1], part * part * c[2]]);
            Jet(series)
        };
        let mut design: Vec<_> = along.iter().map(|point| point.map(extended)).collect();
        let lifts = displace(self.mechanism, &mut design, Jet::constant(self.gear));
        let closure = Closure::new(self.mechanism, &design);
        let moving = |value: f64, rate: f64, lift: Jet<f64, N>| {
            let mut series = Jet::constant(value);
            series.0[1] = travel * rate;
            series - lift
        };
        let (drive, rack) = self.coordinates;
        let drive = moving(drive, line.travel, lifts[0]);
        let rack = moving(rack, line.rack, lifts[1]);
        let pose = pose_series(
            self.mechanism,
            &design,
            &closure,
            &self.factors,
            &self.pose,
            Driver::Travel(drive),
            rack,
        );
        let at = Configuration::new(self.mechanism, &design, pose, rack);
        let numbers = RefCell::new(Vec::new());
        Snapshot::of(&at, &self.parts)
            .0
            .map(|number| numbers.borrow_mut().push(number));
        numbers.into_inner()
    }

    /// Coefficients up to the third degree, for a wheel of a rigid axle that moves along a line in travel and rack.
    fn line_of_rigid(&self, design: &[Vector3<Series>], line: &Line) -> Vec<ByTravel> {
        let lines = [[1.0, 0.0], [0.0, 1.0], [1.0, 1.0], [1.0, -1.0]];
        let series = lines.map(|along| self.series::<TERMS_OF_RIGID>(design, line, along));
        let numbers = 0..series[0].len();
        let number = |k: usize| cubic(series.each_ref().map(|of| &of[k].0[..]));
        numbers.map(number).collect()
    }

    /// Coefficients up to the fourth degree, for an independent wheel that moves along a line in travel and rack.
    fn line(&self, design: &[Vector3<Series>], line: &Line) -> Vec<ByTravel> {
        let lines = [[1.0, 0.0], [0.0, 1.0], [1.0, 1.0], [1.0, -1.0], [2.0, 1.0]];
        let series = lines.map(|along| self.series::<TERMS>(design, line, along));
        let numbers = 0..series[0].len();
        let number = |k: usize| {
            let [base, along, up, down, oblique] = series.each_ref().map(|of| &of[k].0);
            let mut powers = cubic([base, along, up, down].map(|of| &of[..TERMS_OF_RIGID]));
            let (c40, c04, difference) = (base[4], along[4], up[4] - down[4]);
            let c22 = 0.5 * (up[4] + down[4]) - c40 - c04;
            let c31 = (oblique[4] - 16.0 * c40 - 4.0 * c22 - c04 - difference) / 6.0;
            powers[2].0[2] = c22;
            powers[3].0[1] = c31;
            powers[4].0[0] = c40;
            powers
        };
        numbers.map(number).collect()
    }
}

/// Coefficients up to the third degree, from the series along the lines s (1, 0), s (0, 1), s (1, 1) and s (1, -1). Coefficients of
/// higher degrees are zero.
fn cubic(series: [&[f64]; 4]) -> ByTravel {
    let polynomial = Taylor::through(&series);
    array_of(|i| {
        Jet(array_of(|j| match i + j {
            0..4 => polynomial.coefficient([i, j]),
            _ => 0.0,
        }))
    })
}

impl ExpandedWheel {
    fn fourth_vector(&self, part: VectorPart) -> Vector3<Series> {
        self.fourth.wheel.vector(part)
    }
}

impl WheelParts<Series> for ExpandedWheel {
    const HAS_FOURTH: bool = true;

    fn like(&self) -> Series {
        self.reading.like()
    }

    fn read_vector(&self, part: VectorPart, powers: [usize; 2]) -> Vector3<Series> {
        match powers {
            [4, 0] => self.fourth_vector(part),
            _ => self.reading.read_vector(part, powers),
        }
    }

    fn number(&self, part: NumberPart, powers: [usize; 2]) -> Series {
        match powers {
            [4, 0] => self.fourth.wheel.number(part),
            _ => self.reading.number(part, powers),
        }
    }

    fn column(&self, i: usize, powers: [usize; 2]) -> Vector3<Series> {
        match powers {
            [4, 0] => self.fourth.rotation[i],
            _ => self.reading.column(i, powers),
        }
    }

    fn axle_column(&self, i: usize, powers: [usize; 2]) -> Vector3<Series> {
        match powers {
            [4, 0] => self.fourth.axle[i],
            _ => self.reading.axle_column(i, powers),
        }
    }

    fn design(&self) -> DesignWheel<Series> {
        self.reading.design()
    }
}
