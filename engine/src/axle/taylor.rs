//! Taylor polynomials in two variables: the travel and the rack displacement of one wheel.
//!
//! A quantity is u(z + a, r + b) = sum c_ij a^i b^j up to degree 3. The coefficients are computed from power series
//! along straight lines (a, b) = e (p, q). The coefficient of e^k is sum_(i+j=k) c_ij p^i q^j. So k + 1 lines determine
//! the k + 1 coefficients of that degree (A. Griewank, J. Utke, A. Walther, *Evaluating higher derivative tensors by
//! forward propagation of univariate Taylor series*, Math. Comp. 69, 2000). The lines are the two axes and the two
//! diagonals, so that only sums and differences are needed.

use crate::number::Real;

/// Number of coefficients up to degree 3.
const COEFFICIENTS: usize = 10;

/// Powers of travel and rack of each coefficient.
const POWERS: [[usize; 2]; COEFFICIENTS] = [
    [0, 0],
    [1, 0],
    [0, 1],
    [2, 0],
    [1, 1],
    [0, 2],
    [3, 0],
    [2, 1],
    [1, 2],
    [0, 3],
];

/// Index of the coefficient with these powers.
const fn place(travel: usize, rack: usize) -> usize {
    let degree = travel + rack;
    degree * (degree + 1) / 2 + rack
}

/// Direction of a straight line in the plane of travel and rack displacement.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Line {
    /// Change of travel per unit of the line's parameter.
    pub travel: f64,
    /// Change of the rack displacement per unit of the line's parameter.
    pub rack: f64,
}

impl Line {
    /// Returns the lines that determine a polynomial. Terms that contain the rack have at most this degree.
    pub fn needed(degree_with_rack: usize) -> &'static [Line] {
        const LINES: [Line; 4] = {
            const fn line(travel: f64, rack: f64) -> Line {
                Line { travel, rack }
            }
            [
                line(1.0, 0.0),
                line(0.0, 1.0),
                line(1.0, 1.0),
                line(1.0, -1.0),
            ]
        };
        match degree_with_rack {
            0 => &LINES[..1],
            1 => &LINES[..2],
            _ => &LINES,
        }
    }
}

/// A Taylor polynomial in travel and rack displacement. Unknown coefficients are NaN.
#[derive(Clone, Copy, Debug)]
pub struct Taylor<T>([T; COEFFICIENTS]);

impl<T: Real> Taylor<T> {
    /// Makes a constant polynomial.
    pub fn constant(value: T) -> Self {
        let mut coefficients = [value.zero(); COEFFICIENTS];
        coefficients[0] = value;
        Taylor(coefficients)
    }

    /// Makes a polynomial with unknown coefficients: all are NaN. Constants get the number type and the number of
    /// coefficients of `like`.
    pub fn unknown(like: T) -> Self {
        Taylor([like.constant(f64::NAN); COEFFICIENTS])
    }

    /// Makes the polynomial from its series along the lines of [`Line::needed`]. Each series lists its coefficients by
    /// rising power of the line's parameter. All series have the same length.
    pub fn through(lines: &[&[T]]) -> Self {
        let first = lines[0];
        let mut taylor = Taylor::unknown(first[0]);
        let mut set = |travel: usize, rack: usize, value: T| taylor.0[place(travel, rack)] = value;
        for (degree, value) in first.iter().enumerate() {
            set(degree, 0, *value);
        }
        let Some(along_rack) = lines.get(1) else {
            return taylor;
        };
        for (degree, value) in along_rack.iter().enumerate().skip(1) {
            set(0, degree, *value);
        }
        let [Some(up), Some(down)] = [lines.get(2), lines.get(3)] else {
            return taylor;
        };
        if first.len() > 2 {
            set(1, 1, (up[2] - down[2]).scaled(0.5));
        }
        if first.len() > 3 {
            set(2, 1, (up[3] - down[3]).scaled(0.5) - along_rack[3]);
            set(1, 2, (up[3] + down[3]).scaled(0.5) - first[3]);
        }
        taylor
    }

    /// Returns the coefficient with these powers of travel and rack. The result is NaN beyond the known orders.
    #[inline(always)]
    pub fn coefficient(&self, [travel, rack]: [usize; 2]) -> T {
        match travel + rack {
            0..4 => self.0[place(travel, rack)],
            _ => self.0[0].constant(f64::NAN),
        }
    }

    /// Returns the polynomial about a point that is moved by `travel`, to first order in `travel`. The coefficients of the
    /// highest known degree become NaN.
    pub fn shifted(&self, travel: T) -> Self {
        let mut moved = *self;
        for (coefficient, [i, j]) in moved.0.iter_mut().zip(POWERS) {
            let rate = self.coefficient([i + 1, j]).scaled((i + 1) as f64);
            *coefficient = *coefficient + rate * travel;
        }
        moved
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Series along these lines determine a cubic polynomial, and so also the values of this polynomial along any other
    /// line.
    #[test]
    fn polynomials_come_back_from_lines() {
        let coefficients: [f64; COEFFICIENTS] =
            std::array::from_fn(|k| ((k * 7 + 3) % 11) as f64 - 4.0);
        let along = |line: &Line| {
            let mut series = [0.0; 4];
            for (c, [i, j]) in coefficients.iter().zip(POWERS) {
                series[i + j] += c * line.travel.powi(i as i32) * line.rack.powi(j as i32);
            }
            series
        };
        let series: Vec<_> = Line::needed(3).iter().map(along).collect();
        let lines: Vec<&[f64]> = series.iter().map(|s| &s[..]).collect();
        let taylor = Taylor::through(&lines);
        assert_eq!(taylor.0, coefficients);
        let oblique = Line {
            travel: 0.5,
            rack: -2.0,
        };
        let expected = along(&oblique);
        let slope = |[i, j]: [usize; 2]| {
            let by_travel = taylor.coefficient([i + 1, j]) * (i + 1) as f64;
            let by_rack = taylor.coefficient([i, j + 1]) * (j + 1) as f64;
            by_travel * oblique.travel + by_rack * oblique.rack
        };
        assert_eq!(slope([0, 0]), expected[1]);
        let twice = slope([1, 0]) * oblique.travel + slope([0, 1]) * oblique.rack;
        assert_eq!(twice, 2.0 * expected[2]);
        let shifted = taylor.shifted(2.0);
        assert_eq!(
            shifted.coefficient([0, 0]),
            taylor.coefficient([0, 0]) + 2.0 * taylor.coefficient([1, 0])
        );
        assert!(taylor.coefficient([2, 2]).is_nan());
    }
}
