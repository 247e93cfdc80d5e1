//! Tests the constants of the Newton-Kantorovich theorem: second derivatives for every pair of variables, and the radii that
//! are computed from them.

use super::quadratic::{PoseBend, Quadratic};
use super::theorem::{Radii, defect, image, radii};
use super::{N, Square};
use crate::derive::MotionPoint;
use crate::mechanism::{Closure, Configuration, Driver, Pose, Unproven};
use crate::model::{Drive, Mechanism, Suspension, Topology};
use crate::number::{Interval, Matrix3, Real, Vector3};
use crate::study::Study;
use std::array::from_fn;
use std::path::Path;

fn suspensions() -> Vec<Suspension> {
    let read = |topology: &&Topology| {
        let study = Study::from_text("row.toml", topology.template, Path::new("."));
        study.expect("a template is valid").into_wheel()
    };
    // The hinge of a twist beam is not quadratic, so studies of twist beams have no certificates.
    let proved = Topology::ALL.iter().filter(|t| !t.is_twist_beam());
    proved.map(read).collect()
}

/// Returns the values of the twelve closure equations. `z` is the displacement from the design position: the change of the pose's
/// twelve numbers. Lengths are divided by the scale.
fn equations(suspension: &Suspension, drive: Drive, scale: f64, z: [f64; N]) -> [Interval; N] {
    let mechanism: &Mechanism = &suspension.mechanism;
    let design: Vec<_> = suspension
        .design
        .iter()
        .map(|p| p.map(Interval::point))
        .collect();
    let closure = Closure::new(mechanism, &design);
    let at = |j: usize| {
        let unit = if j < 3 { scale } else { 1.0 };
        let designed = match j {
            0..3 => suspension.design[mechanism.origin.0].to_array()[j],
            _ if (j - 3).is_multiple_of(4) => 1.0,
            _ => 0.0,
        };
        Interval::point(designed) + Interval::point(z[j]).times(unit)
    };
    let vector = |first: usize| Vector3::new(at(first), at(first + 1), at(first + 2));
    let pose = Pose {
        origin: vector(0),
        rotation: Matrix3 {
            columns: [vector(3), vector(6), vector(9)],
        },
    };
    let zero = Interval::point(0.0);
    let driver = match drive {
        Drive::Travel => Driver::Travel(zero),
        Drive::ArmAngle => Driver::ArmAngle {
            sine: zero,
            cosine: Interval::point(1.0),
        },
    };
    let configuration = Configuration::new(mechanism, &design, pose, zero);
    let closed = closure.residuals(&configuration, driver);
    let [a, b, c] = pose.rotation.columns;
    let half = |v: Vector3<Interval>| (v.norm_squared() - Interval::point(1.0)).scaled(0.5);
    let turned = [half(a), half(b), half(c), a.dot(b), b.dot(c), c.dot(a)];
    let lengths = closed.map(|row| row.times(1.0 / scale));
    let mut all = [zero; N];
    all[..6].copy_from_slice(&lengths);
    all[6..].copy_from_slice(&turned);
    all
}

/// Returns the second derivative of a polynomial of second degree with respect to variables j and l. It is computed
/// from values of the polynomial: F(e_j + e_l) - F(e_j) - F(e_l) + F(0). For j = l this is also F'', since F(2 e) - 2
/// F(e) + F(0) = F''.
fn differences(at: &impl Fn([f64; N]) -> [Interval; N], j: usize, l: usize) -> [Interval; N] {
    let unit = |one: bool, other: bool| {
        let mut z = [0.0; N];
        z[j] += f64::from(u8::from(one));
        z[l] += f64::from(u8::from(other));
        at(z)
    };
    let values = [(true, true), (true, false), (false, true), (false, false)];
    let [both, first, second, none] = values.map(|(one, other)| unit(one, other));
    from_fn(|i| both[i] - first[i] - second[i] + none[i])
}

/// The test covers every template except the twist beam, and every drive, equation and pair of pose numbers. H is the second
/// derivative of the equations, and z the displacement from the design position. The stored constant equals the coefficient of the
/// pair in H(z, z). This coefficient is H_jj for one number, and H_jl + H_lj = 2 H_jl for two different numbers.
#[test]
fn constants_are_the_second_derivatives_of_every_pair() {
    for suspension in suspensions() {
        let name = suspension.mechanism.topology.name;
        let scale = suspension.size().log2().round().exp2();
        for drive in [Drive::Travel, Drive::ArmAngle] {
            if drive == Drive::ArmAngle && suspension.mechanism.arms.is_empty() {
                continue;
            }
            let quadratic = Quadratic::new(&suspension.mechanism, &suspension.design, scale, drive);
            let at = |z| equations(&suspension, drive, scale, z);
            let mut mixed = 0;
            for j in 0..N {
                for l in j..N {
                    let truth = differences(&at, j, l);
                    for (equation, truth) in truth.into_iter().enumerate() {
                        let truth = truth.times(if j == l { 1.0 } else { 2.0 });
                        let own = quadratic.pose_bends.iter();
                        let mut own = own.filter(|b| b.pair == N * j + l && b.equation == equation);
                        let (middle, off) = own.next().map_or((0.0, 0.0), |b| (b.middle, b.off));
                        assert!(own.next().is_none(), "{name}: a pair counts once");
                        let what =
                            format!("{name} {drive:?} {equation} {j} {l}: {middle} {truth:?}");
                        // The interval of the stored constant and the interval from `differences` must contain the same
                        // number. Both intervals must be narrow.
                        assert!(
                            middle - off <= truth.high && truth.low <= middle + off,
                            "{what}"
                        );
                        assert!(truth.width() < 1e-9 && off < 1e-9, "{what}");
                        let is_mixed = j != l && middle != 0.0;
                        mixed += usize::from(is_mixed);
                    }
                }
            }
            // Three equations require that two columns a, b of the rotation matrix are perpendicular: a.b = 0. Each has three pairs
            // of different numbers.
            assert!(mixed >= 9, "{name} {drive:?}: {mixed}");
        }
    }
}

const IDENTITY: Square = {
    let mut identity = [[0.0; N]; N];
    let mut i = 0;
    while i < N {
        identity[i][i] = 1.0;
        i += 1;
    }
    identity
};

fn proved(jacobian: &Square, bends: &[PoseBend], residual: f64) -> Result<Radii, Unproven> {
    let intervals = jacobian.map(|row| row.map(Interval::point));
    radii(&IDENTITY, &intervals, bends, residual)
}

/// A system with known solutions, in which only one pair of variables has a second derivative: x_j + k x_j x_l = r and
/// x_l - x_j = 0. Elimination gives x_j + k x_j^2 = r along x_j = x_l, with J = 1. The result contains the second
/// derivative 2 k of the pair: H_jj if j and l are equal, H_jl + H_lj if they differ.
fn planted(equation: usize, j: usize, l: usize, k: f64) -> PoseBend {
    PoseBend {
        equation,
        pair: N * j + l,
        middle: 2.0 * k,
        off: 0.0,
    }
}

/// For every pair, the other solution of x + k x^2 = 0 is at the distance 1/k. The radius of uniqueness must be smaller
/// than this distance. The equation x + k x^2 = r has no solution if 4 k r < -1. Just beyond this limit the certificate
/// must fail. Just before it, the certificate must succeed. Then the solution is x = (sqrt(1 + 4 k r) - 1)/(2 k), and
/// the error bound must not be smaller than |x|.
#[test]
fn planted_solutions_are_not_beyond_the_radii() {
    for j in 0..N {
        for l in j..N {
            let equation = (5 * j + l) % N;
            for k in [0.25, 1.0, 7.5] {
                let bends = [planted(equation, j, l, k)];
                let found = proved(&IDENTITY, &bends, 0.0).expect("a solution");
                assert!(found.uniqueness <= 1.0 / k, "{j} {l}: {}", found.uniqueness);
                assert!(found.uniqueness >= (1.0 - 1e-9) / k, "{}", found.uniqueness);
                let limit = 0.25 / k;
                for share in [0.1, 0.5, 0.999_999_99] {
                    let found = proved(&IDENTITY, &bends, share * limit).expect("a solution");
                    // Solutions of k x^2 - x + r = 0, computed without cancellation.
                    let root = (1.0 - share).sqrt();
                    let near = 2.0 * share * limit / (1.0 + root);
                    let far = (1.0 + root) / (2.0 * k);
                    assert!(found.error >= near * (1.0 - 1e-15), "{j} {l} {share}");
                    assert!(found.error <= near * (1.0 + 1e-6), "{j} {l} {share}");
                    assert!(found.uniqueness <= far * (1.0 + 1e-15), "{j} {l} {share}");
                    assert!(found.uniqueness >= far * (1.0 - 1e-6), "{j} {l} {share}");
                }
                let beyond = proved(&IDENTITY, &bends, limit * 1.000_000_01);
                assert_eq!(beyond.err(), Some(Unproven::TooClose), "{j} {l} {k}");
            }
        }
    }
}

/// Second derivatives of several pairs are added. Second derivatives of one pair in several equations are added with the weights of
/// the inverse. The errors of the second derivatives are added in the same way.
#[test]
fn constants_of_all_pairs_add_up() {
    let bends = [
        planted(3, 0, 0, 0.5),
        planted(3, 0, 7, -0.75),
        planted(3, 4, 9, 0.25),
        PoseBend {
            off: 0.5,
            ..planted(3, 11, 11, 0.0)
        },
        planted(8, 2, 5, 0.5),
    ];
    let found = proved(&IDENTITY, &bends, 0.0).unwrap();
    // The pairs of equation 3 contribute 1 + 1.5 + 0.5 + 0.5 = 3.5 to |H|, and equation 8 contributes 1. The largest is 3.5.
    let expected = 2.0 / 3.5;
    assert!((found.uniqueness / expected - 1.0).abs() < 1e-9);
    // The inverse subtracts equation 8 from equation 3. Coefficients of the same pair must be added with their signs
    // before the absolute value is taken.
    let mut inverse = IDENTITY;
    inverse[3][8] = -1.0;
    let mut jacobian = IDENTITY;
    jacobian[3][8] = 1.0;
    let intervals = jacobian.map(|row| row.map(Interval::point));
    let cancelling = [planted(3, 2, 5, 0.5), planted(8, 2, 5, 0.5)];
    let found = radii(&inverse, &intervals, &cancelling, 0.0).unwrap();
    assert!(
        (found.uniqueness / 2.0 - 1.0).abs() < 1e-9,
        "{}",
        found.uniqueness
    );
    let adding = [planted(3, 2, 5, -0.5), planted(8, 2, 5, 0.5)];
    let found = radii(&inverse, &intervals, &adding, 0.0).unwrap();
    assert!(
        (found.uniqueness - 1.0).abs() < 1e-9,
        "{}",
        found.uniqueness
    );
}

/// If A = 1 deviates from the exact inverse by z, the radii of x (1 + z) + k x^2 = 0 equal the radii of x (1 - z) + k x^2 = 0. For
/// z = 1 or more, the certificate fails.
#[test]
fn an_inverse_that_is_off_narrows_the_radii() {
    let bends = [planted(4, 1, 6, 0.5)];
    for off in [0.125, 0.5, 0.875] {
        let mut jacobian = IDENTITY;
        jacobian[4][4] += off;
        let found = proved(&jacobian, &bends, 0.0).unwrap();
        let expected = 2.0 * (1.0 - off);
        assert!(found.uniqueness <= expected && found.uniqueness > expected * (1.0 - 1e-9));
        // Largest Y that fulfils the theorem's condition 2 Z2 Y <= (1 - Z0)^2.
        let limit = 0.5 * (1.0 - off).powi(2);
        assert!(proved(&jacobian, &bends, limit * (1.0 - 1e-9)).is_ok());
        let beyond = proved(&jacobian, &bends, limit * (1.0 + 1e-9));
        assert_eq!(beyond.err(), Some(Unproven::TooClose));
    }
    let mut jacobian = IDENTITY;
    jacobian[4][4] = 2.0;
    assert_eq!(
        proved(&jacobian, &bends, 0.0).err(),
        Some(Unproven::Singular)
    );
}

/// The bound includes the rounding of twelve products and of the subtraction of 1. It is at least thirteen units of
/// roundoff, and at most ten times as much.
#[test]
fn an_exact_inverse_is_off_by_rounding() {
    let intervals = IDENTITY.map(|row| row.map(Interval::point));
    let off = defect(&IDENTITY, &intervals);
    let unit = 0.5 * f64::EPSILON;
    assert!(off >= 13.0 * unit && off <= 128.0 * unit, "{off}");
    let vector: [Interval; N] = from_fn(|j| Interval::point(1.0 + j as f64));
    let norm = image(&IDENTITY, &vector);
    assert!(norm >= 12.0 * (1.0 + 12.0 * unit) && norm <= 12.0 * (1.0 + 2e-12));
}

/// Linear equations have only one solution, so the radius of uniqueness has no limit.
#[test]
fn linear_equations_have_one_solution() {
    let found = proved(&IDENTITY, &[], 0.0).unwrap();
    assert!(found.uniqueness > 1e300, "{}", found.uniqueness);
}

/// Along a line between two motion points, a parabola encloses the equations. If the arm rotates only by a small angle,
/// the enclosure of the curvature is narrow.
#[test]
fn equations_on_a_line_are_enclosed() {
    for suspension in suspensions() {
        for drive in [Drive::Travel, Drive::ArmAngle] {
            if drive == Drive::ArmAngle && suspension.mechanism.arms.is_empty() {
                continue;
            }
            let scale = suspension.size().log2().round().exp2();
            let quadratic = Quadratic::new(&suspension.mechanism, &suspension.design, scale, drive);
            let pose = Pose {
                origin: suspension.design[suspension.mechanism.origin.0],
                rotation: Matrix3::identity(1.0),
            };
            let point = |value: f64| MotionPoint {
                drive,
                value,
                rack: 0.0,
            };
            let unit = if drive == Drive::Travel { scale } else { 1.0 };
            let (start, end) = (0.8 * unit, (0.8 + 1.0 / 8192.0) * unit);
            let at = |share: f64| {
                let point = point(start + share * (end - start));
                quadratic.displacement(&pose, &point)
            };
            let ([constant, slope, bend], _) =
                quadratic.on_line([&at(0.0), &at(1.0)], [&point(start), &point(end)]);
            let mut curved = 0;
            for share in [0.25, 0.5, 1.0] {
                let (exact, _) = quadratic.linearised(&at(share));
                for i in 0..N {
                    let line = constant[i] + slope[i].times(share);
                    let sum = line + bend[i].times(share * share);
                    assert!(sum.low <= exact[i].high && exact[i].low <= sum.high, "{i}");
                    // The enclosure of the curvature must be hardly wider than needed. The arm's rotation and the
                    // rounding explain the remaining excess.
                    let needed = (exact[i] - line).times(1.0 / (share * share));
                    let most = bend[i].magnitude();
                    assert!(bend[i].width() <= 5e-4 * most + 1e-14, "{i}: {:?}", bend[i]);
                    if most > 1e-13 && needed.width() < 1e-4 * most {
                        assert!((most / needed.magnitude() - 1.0).abs() < 5e-4, "{i}");
                        curved += 1;
                    }
                }
            }
            let name = suspension.mechanism.topology.name;
            assert_eq!(curved > 0, drive == Drive::ArmAngle, "{name}");
        }
    }
}

/// The error bound of a knuckle point b is computed from the errors of origin and rotation: sqrt 3 e + 3 (e/scale) |b|.
#[test]
fn points_are_off_by_origin_and_rotation() {
    let certificate = super::Certificate {
        error: 1e-6,
        uniqueness: 1.0,
        scale: 0.5,
    };
    for distance in [0.0, 0.25, 3.0] {
        let least = f64::sqrt(3.0) * 1e-6 + 3.0 * 1e-6 / 0.5 * distance;
        let found = certificate.point_error(distance);
        assert!(found >= least && found <= 1.0001 * least, "{found} {least}");
    }
}
