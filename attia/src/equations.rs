//! Equations (1) to (14) of Attia's paper: residual, Jacobian and second-order terms.
//!
//! All equations are quadratic in the unknowns and have the dimension of a squared length. Numbers in the code are the paper's
//! point numbers. The row of an equation is its number in the paper minus one.

use super::Moving;
use super::drive::Driver;
use hardpoint_engine::nalgebra::SVector;
use hardpoint_engine::number::Vector3;

/// One number for each equation, or one for each unknown. The order of the unknowns is x, y and z of point 5, then of points 6,
/// 7, 8 and 9.
pub(crate) type Column = SVector<f64, 15>;
/// Jacobian of the fifteen equations: a row for each equation, a column for each unknown.
pub(crate) type Jacobian = [[f64; 15]; 15];

/// Pairs of points whose distances equations (1) to (10) fix.
pub(crate) const DISTANCES: [[usize; 2]; 10] = [
    [5, 1],
    [5, 2],
    [8, 3],
    [9, 4],
    [6, 5],
    [7, 5],
    [8, 5],
    [7, 6],
    [8, 6],
    [8, 7],
];
const TIE_ROD: usize = 2;
const COLLINEARITY: usize = 10;
pub(crate) const DRIVE: usize = 14;

/// Points 1 to 4 at their present positions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Fixed(pub(crate) [Vector3<f64>; 4]);

impl Fixed {
    /// Returns the points after the rack has moved point 3.
    pub(crate) fn with_rack(&self, rack: f64) -> Self {
        let mut points = self.0;
        points[2].y += rack;
        Fixed(points)
    }

    /// Points 1 to 9; point n has index n - 1.
    pub(crate) fn all(&self, moving: &Moving) -> [Vector3<f64>; 9] {
        let ([p1, p2, p3, p4], [p5, p6, p7, p8, p9]) = (self.0, *moving);
        [p1, p2, p3, p4, p5, p6, p7, p8, p9]
    }
}

/// Squares of the distances in equations (1) to (10), in this position.
pub(crate) fn distances_squared(points: &[Vector3<f64>; 9]) -> [f64; 10] {
    DISTANCES.map(|[i, j]| (points[i - 1] - points[j - 1]).norm_squared())
}

/// Left-hand sides of equations (1) to (15).
pub(crate) fn residual(
    fixed: &Fixed,
    moving: &Moving,
    lengths_squared: &[f64; 10],
    driver: &Driver,
) -> Column {
    let mut out = Column::zeros();
    let now = distances_squared(&fixed.all(moving));
    for row in 0..DISTANCES.len() {
        out[row] = now[row] - lengths_squared[row];
    }
    let [[a, b], [c, _]] = axis_vectors(fixed, moving);
    collinearity(&mut out, [a, b], [c, b]);
    out[DRIVE] = driver.residual(moving);
    out
}

/// Writes equations (11) to (14), which are bilinear in pairs of vectors. They are x and y of a x b, then x and y of c x d. The
/// y-components have the paper's sign.
fn collinearity(out: &mut Column, [a, b]: [Vector3<f64>; 2], [c, d]: [Vector3<f64>; 2]) {
    out[COLLINEARITY] = a.y * b.z - a.z * b.y; // (11)
    out[COLLINEARITY + 1] = a.x * b.z - a.z * b.x; // (12)
    out[COLLINEARITY + 2] = c.y * d.z - c.z * d.y; // (13)
    out[COLLINEARITY + 3] = c.x * d.z - c.z * d.x; // (14)
}

/// Pairs of vectors whose vector products are zero. A number pair such as 6-7 is the vector between these points. The pairs are 6-7
/// and 4-9 for equations (11) and (12), 7-9 and 4-9 for equations (13) and (14).
fn axis_vectors(fixed: &Fixed, moving: &Moving) -> [[Vector3<f64>; 2]; 2] {
    let [_, p6, p7, _, p9] = *moving;
    let b = p9 - fixed.0[3];
    [[p7 - p6, b], [p9 - p7, b]]
}

/// Partial derivatives of equations (1) to (15) with respect to the unknowns.
pub(crate) fn jacobian(fixed: &Fixed, moving: &Moving, driver: &Driver) -> Jacobian {
    let mut out = [[0.0; 15]; 15];
    let points = fixed.all(moving);
    for (row, [i, j]) in DISTANCES.into_iter().enumerate() {
        let twice = (points[i - 1] - points[j - 1]) * 2.0;
        add(&mut out, row, i, twice);
        if j >= 5 {
            add(&mut out, row, j, -twice);
        }
    }

    // Gradients of a.y b.z - a.z b.y and a.x b.z - a.z b.x with respect to a. The gradients with respect to b have
    // the same form with a in place of b, and the opposite sign.
    let by_first = |b: Vector3<f64>| [Vector3::new(0.0, b.z, -b.y), Vector3::new(b.z, 0.0, -b.x)];
    let [[a, b], [c, _]] = axis_vectors(fixed, moving);
    for k in 0..2 {
        let (by_a, by_b) = (by_first(b)[k], -by_first(a)[k]);
        add(&mut out, COLLINEARITY + k, 6, -by_a);
        add(&mut out, COLLINEARITY + k, 7, by_a);
        add(&mut out, COLLINEARITY + k, 9, by_b);
        // Equations (13) and (14) contain 7-9 in place of 6-7, and the same vector 4-9. So their gradient with respect to 7-9
        // equals the gradient of (11) and (12) with respect to 6-7.
        add(&mut out, COLLINEARITY + 2 + k, 7, -by_a);
        add(&mut out, COLLINEARITY + 2 + k, 9, by_a - by_first(c)[k]);
    }

    for (n, gradient) in (5..).zip(driver.gradient) {
        add(&mut out, DRIVE, n, gradient);
    }
    out
}

fn add(jacobian: &mut Jacobian, row: usize, point: usize, gradient: Vector3<f64>) {
    let column = 3 * (point - 5);
    for (k, g) in gradient.to_array().iter().enumerate() {
        jacobian[row][column + k] += g;
    }
}

/// Column `-C_t` of equations (1) to (14), which are C = 0: their negative partial derivatives with respect to time t. Only
/// equation (3) depends on the rack. `motion` is the velocity of point 3. With the acceleration of point 3 as `motion`, the result
/// is the rack's part of the acceleration equations.
pub(crate) fn rack_column(fixed: &Fixed, moving: &Moving, motion: f64) -> Column {
    let mut out = Column::zeros();
    out[TIE_ROD] = 2.0 * (moving[3] - fixed.0[2]).y * motion;
    out
}

/// Terms of the second time derivative of equations (1) to (14) that are quadratic in the velocities. They are dJ/dt, the time
/// derivative of the Jacobian, times the velocities, including the velocity of the rack. The row of the drive is zero.
pub(crate) fn quadratic(rack_velocity: f64, velocity: &Moving) -> Column {
    let mut out = Column::zeros();
    let zero = Vector3::new(0.0, 0.0, 0.0);
    let still = Fixed([zero; 4]).with_rack(rack_velocity);
    let squares = distances_squared(&still.all(velocity));
    let [[a, b], [c, _]] = axis_vectors(&still, velocity);
    collinearity(&mut out, [a, b], [c, b]);
    for (row, square) in squares.into_iter().enumerate() {
        out[row] = square;
    }
    // The second derivative of a square or a product is twice the square or product of the rates.
    out * 2.0
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The equations are quadratic, so central differences with any step are exact derivatives.
    #[test]
    fn jacobian_is_the_derivative_of_the_residual() {
        let mut seed = 0.3_f64;
        let mut next = || {
            seed = (seed * 1013.7 + 0.41).fract();
            seed
        };
        let mut vector = || Vector3::new(next(), next(), next());
        let fixed = Fixed(std::array::from_fn(|_| vector()));
        let at: Moving = std::array::from_fn(|_| vector());
        let driver = Driver {
            gradient: std::array::from_fn(|_| vector()),
            level: 0.2,
        };
        let by_hand = jacobian(&fixed, &at, &driver);
        let value = |moving: &Moving| residual(&fixed, moving, &[0.5; 10], &driver);
        for column in 0..15 {
            let moved = |step: f64| {
                let mut moving = at;
                let point = &mut moving[column / 3];
                *[&mut point.x, &mut point.y, &mut point.z][column % 3] += step;
                moving
            };
            let difference = (value(&moved(1.0)) - value(&moved(-1.0))) / 2.0;
            // The values are about 10, and each has a few rounding errors.
            let by_hand = Column::from(by_hand.map(|row| row[column]));
            assert!((difference - by_hand).amax() < 64.0 * f64::EPSILON);
        }
        // The second difference along any direction is the quadratic term.
        let direction: Moving = std::array::from_fn(|_| vector());
        let along = |s: f64| value(&std::array::from_fn(|i| at[i] + direction[i] * s));
        let second = along(1.0) - along(0.0) * 2.0 + along(-1.0);
        assert!((second - quadratic(0.0, &direction)).amax() < 128.0 * f64::EPSILON);
    }
}
