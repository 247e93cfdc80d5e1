//! A wheel of an independent axle as a function of its own travel: piecewise polynomials between poses.
//!
//! Newton's method for a car evaluates the same wheels at thousands of travels. In each step, poses take most of the
//! time. So a wheel is solved only at some travels (nodes), and polynomial pieces connect the nodes. Each node has
//! three derivatives with respect to travel. In a piece of length h from z_0, with t = (z - z_0)/h, each number f
//! becomes the polynomial p of degree 7 that has the same values and derivatives as f at both nodes:
//!
//! ```text
//! p(t) = c_0 + c_1 t + c_2 t^2 + c_3 t^3 + t^4 q(t),     c_k = h^k f^(k)(z_0)/k!                                (1)
//! q(t) = q_0 + q_1 (t-1) + q_2 (t-1)^2 + q_3 (t-1)^3                                                            (2)
//! D_k  = sum_i binom(4, i) q_(k-i)                                                                              (3)
//! f - p = f^(8)(..) h^8 t^4 (1-t)^4/8!                                                                          (4)
//! ```
//!
//! D_k is a difference of k-th coefficients at the second node: f minus the cubic c_0 + c_1 t + c_2 t^2 + c_3 t^3. The
//! error (4) and the error of its derivative with respect to t fall with the eighth power of h. The error of the derivative
//! is largest near t = 0.31. At this t, each piece is compared with one more pose: value and derivative must agree. If they
//! differ by more than rounding errors, or this pose does not exist, the length of all pieces is halved.

use super::reading::{Reading, WheelParts};
use super::solver::AxleSolver;
use crate::characteristics::{DesignWheel, NumberPart, VectorPart};
use crate::model::Side;
use crate::number::{Each, SimdReal, SimdTask, Vector3, array_of, run_short};

/// Largest number of polynomial pieces on each side of the design position.
const MOST_PIECES: i32 = 48;
/// Initial length of pieces, relative to the mechanism's size.
const LENGTH: f64 = 1.0 / 24.0;
/// Largest number of times that the length of the pieces is halved.
const MOST_HALVINGS: u32 = 4;
/// Relative position t in a piece (0 to 1) at which the piece is compared with a pose.
const CHECK: f64 = 0.31;
/// Largest accepted error of a piece, relative to the sum of the number's size and the length of the piece.
const TOLERANCE: f64 = 4e-13;

/// Vectors that a curve contains, in addition to the columns of the carrier's rotation matrix.
const VECTORS: [VectorPart; 3] = [
    VectorPart::Centre,
    VectorPart::SpinAxis,
    VectorPart::HeaveSpring,
];
/// Scalars that a curve contains.
const SINGLE: [NumberPart; 3] = [
    NumberPart::SpringLength,
    NumberPart::BarAngle,
    NumberPart::RockerAngle,
];
/// Index of the first number of the rotation matrix, among all numbers of a curve.
const COLUMNS: usize = 3 * VECTORS.len();
/// Index of the first scalar, among all numbers of a curve.
const NUMBERS: usize = COLUMNS + 9;
/// Count of all numbers, rounded up to a multiple of [`LANES`]. The last numbers are unused.
const COUNT: usize = (NUMBERS + SINGLE.len()).next_multiple_of(LANES);
/// Count of numbers, and of wheels, that the processor evaluates at the same time. With wider registers, a part of the
/// last group of numbers would be unused.
pub(crate) const LANES: usize = 8;

/// Coefficients of all values of a wheel, for each power of travel. Values that are not used are NaN.
type Powers<const N: usize> = [[f64; COUNT]; N];

/// Polynomials of all values of the wheel between two nodes, equation (1), and the wheel in the design position.
#[derive(Clone, Debug)]
struct Piece {
    polynomials: Powers<8>,
    design: DesignWheel<f64>,
}

/// A wheel at one travel of its curve: its values with three derivatives with respect to travel.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CurveWheel {
    coefficients: Powers<4>,
    design: DesignWheel<f64>,
}

impl CurveWheel {
    /// Makes a wheel whose values are all NaN.
    pub(crate) fn unknown() -> Self {
        CurveWheel {
            coefficients: [[f64::NAN; COUNT]; 4],
            design: DesignWheel::filled(f64::NAN),
        }
    }

    /// Makes a wheel from the values of `reading` that curves contain.
    fn of(reading: &Reading<f64>) -> Self {
        let mut wheel = CurveWheel::unknown();
        for (k, numbers) in wheel.coefficients.iter_mut().enumerate() {
            let powers = [k, 0];
            let vectors = VECTORS.each(|part| reading.read_vector(part, powers));
            let columns = [0, 1, 2].each(|i| reading.column(i, powers));
            let vectors = vectors.into_iter().chain(columns);
            let single = SINGLE.each(|part| reading.number(part, powers));
            let all = vectors.flat_map(Vector3::to_array).chain(single);
            numbers.iter_mut().zip(all).for_each(|(into, c)| *into = c);
        }
        wheel.design = reading.design();
        wheel
    }

    /// Returns the coefficients of powers of travel, with the length of a piece as unit of travel.
    fn scaled(&self, length: f64) -> Powers<4> {
        let mut power = 1.0;
        self.coefficients.each(|numbers| {
            let scaled = numbers.each(|c| c * power);
            power *= length;
            scaled
        })
    }

    #[inline]
    fn vector_at(&self, first: usize, [travel, rack]: [usize; 2]) -> Vector3<f64> {
        if rack > 0 || travel > 3 {
            return Vector3::new(f64::NAN, f64::NAN, f64::NAN);
        }
        let numbers = &self.coefficients[travel];
        Vector3::new(numbers[first], numbers[first + 1], numbers[first + 2])
    }
}

/// Curves give only some values of a wheel, and no derivatives with respect to the rack. All other values are NaN.
impl WheelParts<f64> for CurveWheel {
    #[inline(always)]
    fn like(&self) -> f64 {
        self.coefficients[0][0]
    }

    #[inline(always)]
    fn read_vector(&self, part: VectorPart, powers: [usize; 2]) -> Vector3<f64> {
        match VECTORS.iter().position(|own| *own == part) {
            Some(place) => self.vector_at(3 * place, powers),
            None => Vector3::new(f64::NAN, f64::NAN, f64::NAN),
        }
    }

    #[inline(always)]
    fn number(&self, part: NumberPart, [travel, rack]: [usize; 2]) -> f64 {
        match SINGLE.iter().position(|own| *own == part) {
            Some(place) if rack == 0 && travel < 4 => self.coefficients[travel][NUMBERS + place],
            _ => f64::NAN,
        }
    }

    #[inline(always)]
    fn column(&self, i: usize, powers: [usize; 2]) -> Vector3<f64> {
        self.vector_at(COLUMNS + 3 * i, powers)
    }

    #[inline(always)]
    fn axle_column(&self, _: usize, _: [usize; 2]) -> Vector3<f64> {
        Vector3::new(f64::NAN, f64::NAN, f64::NAN)
    }

    #[inline(always)]
    fn design(&self) -> DesignWheel<f64> {
        self.design
    }
}

/// Wheels in SIMD lanes, each at its own travel: values of the wheels, and first derivatives of these values with
/// respect to travel.
#[derive(Clone, Debug)]
pub(crate) struct CurveLanes {
    numbers: [[[f64; LANES]; COUNT]; 2],
    design: DesignWheel<f64>,
}

impl CurveLanes {
    /// Makes SIMD lanes that all contain this wheel.
    pub(crate) fn filled(wheel: &CurveWheel) -> Self {
        let mut lanes = CurveLanes {
            numbers: [[[f64::NAN; LANES]; COUNT]; 2],
            design: wheel.design,
        };
        (0..LANES).for_each(|lane| lanes.set(lane, wheel));
        lanes
    }

    /// Puts a wheel of the same design into a lane.
    pub(crate) fn set(&mut self, lane: usize, wheel: &CurveWheel) {
        for (lanes, numbers) in self.numbers.iter_mut().zip(&wheel.coefficients) {
            for (lanes, number) in lanes.iter_mut().zip(numbers) {
                lanes[lane] = *number;
            }
        }
    }
}

/// Wheels in SIMD lanes, at the travels for which [`CurveLanes`] contains their values.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LaneCurveWheel<'n, B> {
    pub(crate) of: &'n CurveLanes,
    pub(crate) like: B,
}

impl<B: SimdReal> LaneCurveWheel<'_, B> {
    #[inline(always)]
    fn load(&self, place: usize, [travel, rack]: [usize; 2]) -> B {
        match (travel, rack) {
            (0 | 1, 0) => self.like.load(&self.of.numbers[travel][place]),
            _ => self.like.constant(f64::NAN),
        }
    }

    #[inline(always)]
    fn vector_at(&self, first: usize, powers: [usize; 2]) -> Vector3<B> {
        Vector3::new(
            self.load(first, powers),
            self.load(first + 1, powers),
            self.load(first + 2, powers),
        )
    }
}

impl<B: SimdReal> WheelParts<B> for LaneCurveWheel<'_, B> {
    const IS_AT_TRAVELS: bool = true;

    #[inline(always)]
    fn like(&self) -> B {
        self.like
    }

    #[inline(always)]
    fn read_vector(&self, part: VectorPart, powers: [usize; 2]) -> Vector3<B> {
        match part {
            VectorPart::Centre => self.vector_at(0, powers),
            VectorPart::SpinAxis => self.vector_at(3, powers),
            VectorPart::HeaveSpring => self.vector_at(6, powers),
            _ => self.axle_column(0, powers),
        }
    }

    #[inline(always)]
    fn number(&self, part: NumberPart, powers: [usize; 2]) -> B {
        match part {
            NumberPart::SpringLength => self.load(NUMBERS, powers),
            NumberPart::BarAngle => self.load(NUMBERS + 1, powers),
            NumberPart::RockerAngle => self.load(NUMBERS + 2, powers),
        }
    }

    #[inline(always)]
    fn column(&self, i: usize, powers: [usize; 2]) -> Vector3<B> {
        self.vector_at(COLUMNS + 3 * i, powers)
    }

    #[inline(always)]
    fn axle_column(&self, _: usize, _: [usize; 2]) -> Vector3<B> {
        let unknown = self.like.constant(f64::NAN);
        Vector3::new(unknown, unknown, unknown)
    }

    #[inline(always)]
    fn design(&self) -> DesignWheel<B> {
        let like = self.like;
        self.of.design.map(|number| like.constant(number))
    }
}

/// A wheel as a function of its own travel, at one rack displacement.
#[derive(Clone, Debug)]
pub(crate) struct WheelCurve {
    side: Side,
    rack: f64,
    length: f64,
    halvings: u32,
    nodes: Vec<Known<CurveWheel>>,
    pieces: Vec<Known<Piece>>,
}

/// A value that is computed only once, when the value is first needed.
#[derive(Clone, Debug)]
enum Known<T> {
    NotYet,
    /// The value does not exist: the wheel has no pose at some travel of this interval.
    Absent,
    Here(Box<T>),
}

impl<T> Known<T> {
    fn of(found: Option<T>) -> Self {
        match found {
            Some(found) => Known::Here(Box::new(found)),
            None => Known::Absent,
        }
    }

    fn get(&self) -> Option<&T> {
        match self {
            Known::Here(found) => Some(found),
            _ => None,
        }
    }
}

impl WheelCurve {
    /// Makes the curve of one wheel of the solver's axle. The curve has no pieces yet.
    pub(crate) fn new<const N: usize>(solver: &AxleSolver<'_, N>, side: Side) -> Self {
        let mut curve = WheelCurve {
            side,
            rack: 0.0,
            length: LENGTH * solver.size(),
            halvings: 0,
            nodes: Vec::new(),
            pieces: Vec::new(),
        };
        curve.clear();
        curve
    }

    fn clear(&mut self) {
        let pieces = 2 * MOST_PIECES as usize;
        self.pieces.clear();
        self.pieces.resize(pieces, Known::NotYet);
        self.nodes.clear();
        self.nodes.resize(pieces + 1, Known::NotYet);
    }

    /// Writes the wheel at a travel to `into`. `None` if no piece of the curve at this travel is exact up to rounding
    /// errors.
    pub(crate) fn at<const N: usize>(
        &mut self,
        solver: &mut AxleSolver<'_, N>,
        [travel, rack]: [f64; 2],
        into: &mut CurveWheel,
    ) -> Option<()> {
        if rack != self.rack {
            self.rack = rack;
            self.clear();
        }
        loop {
            let place = (travel / self.length).floor();
            let is_far = place.is_nan() || place.abs() >= f64::from(MOST_PIECES);
            if is_far || self.halvings > MOST_HALVINGS {
                return None;
            }
            let number = (place as i32 + MOST_PIECES) as usize;
            if let Known::NotYet = self.pieces[number] {
                let made = self.piece(solver, number);
                if self.is_inexact(solver, number, made.as_ref()) {
                    self.halvings += 1;
                    self.length *= 0.5;
                    self.clear();
                    continue;
                }
                self.pieces[number] = Known::of(made);
            }
            let t = travel / self.length - place;
            self.pieces[number].get()?.write(t, self.length, into);
            return Some(());
        }
    }

    /// Returns the travel at a node.
    fn travel(&self, node: f64) -> f64 {
        (node - f64::from(MOST_PIECES)) * self.length
    }

    /// Returns the wheel in a solved pose. `None` if the wheel has no pose, or if a rocker is at a toggle.
    fn read<const N: usize>(
        &self,
        solver: &mut AxleSolver<'_, N>,
        travel: f64,
    ) -> Option<CurveWheel> {
        let mut read = solver.wheel_curve(self.side, &[travel], self.rack);
        let reading = read.pop()?.ok()?.without_toggle()?;
        Some(CurveWheel::of(&reading))
    }

    fn node<const N: usize>(
        &mut self,
        solver: &mut AxleSolver<'_, N>,
        node: usize,
    ) -> Option<&CurveWheel> {
        if let Known::NotYet = self.nodes[node] {
            self.nodes[node] = Known::of(self.read(solver, self.travel(node as f64)));
        }
        self.nodes[node].get()
    }

    /// Computes a polynomial piece by equations (1) to (3).
    fn piece<const N: usize>(
        &mut self,
        solver: &mut AxleSolver<'_, N>,
        number: usize,
    ) -> Option<Piece> {
        let length = self.length;
        let from = self.node(solver, number)?;
        let (c, design) = (from.scaled(length), from.design);
        let end = self.node(solver, number + 1)?.scaled(length);
        let mut polynomials = [[f64::NAN; COUNT]; 8];
        for k in 0..COUNT {
            let c = [c[0][k], c[1][k], c[2][k], c[3][k]];
            let at_end = [
                c[0] + c[1] + c[2] + c[3],
                c[1] + 2.0 * c[2] + 3.0 * c[3],
                c[2] + 3.0 * c[3],
                c[3],
            ];
            let d: [f64; 4] = array_of(|i| end[i][k] - at_end[i]);
            let q0 = d[0];
            let q1 = d[1] - 4.0 * q0;
            let q2 = d[2] - 4.0 * q1 - 6.0 * q0;
            let q3 = d[3] - 4.0 * q2 - 6.0 * q1 - 4.0 * q0;
            let [c0, c1, c2, c3] = c;
            let all = [
                c0,
                c1,
                c2,
                c3,
                q0 - q1 + q2 - q3,
                q1 - 2.0 * q2 + 3.0 * q3,
                q2 - 3.0 * q3,
                q3,
            ];
            for (numbers, c) in polynomials.iter_mut().zip(all) {
                numbers[k] = c;
            }
        }
        Some(Piece {
            polynomials,
            design,
        })
    }

    /// Returns true if a polynomial piece is inexact: at one travel inside the piece, it differs from the solved pose
    /// by more than rounding errors.
    fn is_inexact<const N: usize>(
        &self,
        solver: &mut AxleSolver<'_, N>,
        number: usize,
        piece: Option<&Piece>,
    ) -> bool {
        let Some(piece) = piece else {
            return false;
        };
        let travel = self.travel(number as f64 + CHECK);
        let Some(read) = self.read(solver, travel) else {
            return true;
        };
        let length = self.length;
        let mut found = CurveWheel::unknown();
        piece.write(CHECK, length, &mut found);
        let (found, read) = (found.scaled(length), read.scaled(length));
        // Numbers that are not used are NaN in both wheels.
        (0..COUNT).any(|k| {
            let bound = TOLERANCE * (read[0][k].abs() + length);
            (found[0][k] - read[0][k]).abs() > bound || (found[1][k] - read[1][k]).abs() > bound
        })
    }
}

impl Piece {
    /// Writes the wheel at position `t` of the piece to `into`.
    #[inline]
    fn write(&self, t: f64, length: f64, into: &mut CurveWheel) {
        run_short(Evaluation {
            polynomials: &self.polynomials,
            at: [t, length],
            coefficients: &mut into.coefficients,
        });
        into.design = self.design;
    }
}

/// Evaluates all polynomials of a piece, with three derivatives.
struct Evaluation<'p> {
    polynomials: &'p Powers<8>,
    /// Relative position t in the piece (0 to 1), and length of the piece.
    at: [f64; 2],
    coefficients: &'p mut Powers<4>,
}

impl SimdTask for Evaluation<'_> {
    type Output = ();

    #[inline(always)]
    fn run<B: SimdReal>(self, like: B) {
        let [t, length] = self.at;
        let [t, inverse] = [t, 1.0 / length].map(|number| like.constant(number));
        for first in (0..COUNT).step_by(B::LANES) {
            let mut c: [B; 8] = array_of(|k| like.load(&self.polynomials[k][first..]));
            // Four passes of Horner's scheme give the first four coefficients of each polynomial in powers of the distance
            // from t.
            for last in 0..4 {
                for k in (last..7).rev() {
                    c[k] = c[k] + t * c[k + 1];
                }
            }
            let mut power = inverse;
            for c in &mut c[1..4] {
                *c = *c * power;
                power = power * inverse;
            }
            for (numbers, c) in self.coefficients.iter_mut().zip(c) {
                c.store(&mut numbers[first..]);
            }
        }
    }
}
