//! Tests of many random struts, and of a strut in another unit of length.

use super::{at, bound, nominal, size, with_points};
use hardpoint::attia::Drive;
use hardpoint::attia::{PointCoordinates, Pose, solve_travel};
use hardpoint::attia::{Strut, StrutPoints};
use hardpoint::number::Vector3;

/// Random generator for scattering hardpoints (Numerical Recipes' quick 64-bit one).
pub(super) struct Scatter(pub(super) u64);

impl Scatter {
    fn next(&mut self) -> f64 {
        self.0 = self
            .0
            .wrapping_mul(6364136223846793005)
            .wrapping_add(1442695040888963407);
        (self.0 >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }

    pub(super) fn strut(&mut self, spread: f64) -> Strut {
        let s = nominal();
        let mut moved = |p: Vector3<f64>| p + Vector3::from([(); 3].map(|()| spread * self.next()));
        Strut {
            lower_arm_front: moved(s.lower_arm_front),
            lower_arm_rear: moved(s.lower_arm_rear),
            tie_rod_inner: moved(s.tie_rod_inner),
            strut_top: moved(s.strut_top),
            lower_ball_joint: moved(s.lower_ball_joint),
            strut_lower: moved(s.strut_lower),
            strut_upper: s.strut_upper.map(&mut moved),
            tie_rod_outer: moved(s.tie_rod_outer),
            rod_point: None,
            wheel_centre: moved(s.wheel_centre),
        }
    }
}

/// 300 struts with random hardpoints stay on their solution branch over +-80 mm of travel. The knuckle is rigid and not
/// mirrored, the strut's line passes through the mount, and tie rod and arm keep their lengths. A single large step
/// reaches the same pose as small steps.
#[test]
fn scattered_struts_stay_on_their_branch() {
    let mut scatter = Scatter(1);
    let (mut solved, mut refused) = (0, 0);
    for case in 0..300 {
        let strut = scatter.strut(0.02 + 0.06 * (case as f64 / 299.0));
        let Ok(mechanism) = PointCoordinates::new(&strut, StrutPoints::Spread, Drive::Travel)
        else {
            refused += 1;
            continue;
        };
        let design = mechanism.design();
        for end in [-0.08, 0.08] {
            let mut last = design;
            for step in 1..=80 {
                let station = at(end * step as f64 / 80.0);
                let Ok(pose) = mechanism.track(&last, station) else {
                    refused += 1;
                    assert!(mechanism.track(&design, station).is_err());
                    break;
                };
                last = pose;
                solved += 1;
                check_assembly(&strut, &mechanism, &pose);
                if step % 20 == 0 {
                    let jump = mechanism.track(&design, station).unwrap();
                    let apart = std::array::from_fn(|i| pose.moving()[i] - jump.moving()[i]);
                    assert!(
                        size(&apart) < 2.0 * bound(&mechanism, &pose, 0, 1.0),
                        "{case} {station:?}"
                    );
                }
            }
        }
    }
    println!("{solved} poses, {refused} refused");
    assert!(refused < 30, "{refused}");
}

fn check_assembly(strut: &Strut, mechanism: &PointCoordinates, pose: &Pose) {
    let ([a5, a6, a7, a8, _], [p5, p6, p7, p8, p9]) =
        (*mechanism.design().moving(), *pose.moving());
    // Twice the solver's bound, 8 D M eps with D and M below 1.3 m.
    let rounding = 16.0 * 1.3 * 1.3 * f64::EPSILON;
    let (before, now) = ([a5, a6, a7, a8], [p5, p6, p7, p8]);
    for i in 0..4 {
        for j in 0..i {
            let change = (now[i] - now[j]).norm_squared() - (before[i] - before[j]).norm_squared();
            assert!(change.abs() < rounding);
        }
    }
    for (fixed, a, p) in [
        (strut.lower_arm_front, a5, p5),
        (strut.lower_arm_rear, a5, p5),
        (strut.tie_rod_inner, a8, p8),
    ] {
        assert!(((p - fixed).norm_squared() - (a - fixed).norm_squared()).abs() < rounding);
    }
    let volume = |p: [Vector3<f64>; 4]| (p[1] - p[0]).cross(p[2] - p[0]).dot(p[3] - p[0]);
    assert!(volume(before) * volume(now) > 0.0, "mirrored");
    let along = (p7 - p6).normalised();
    for p in [strut.strut_top, p9] {
        // Equations (11)-(14) are two components of the cross products, divided by the z component of the axis.
        let off = (p - p6).cross(along).norm();
        assert!(
            off < rounding / ((p7 - p6).norm() * along.z.abs()),
            "{off:e}"
        );
    }
    assert!((p9 - strut.strut_top).dot(along) < 0.0, "rod reversed");
    let height = mechanism.wheel_centre().of(pose.moving()).z - strut.wheel_centre.z;
    let weights: f64 = mechanism.wheel_centre().shares().map(f64::abs).iter().sum();
    assert!((height - pose.station().value).abs() < rounding * weights / 0.2);
}

/// Another unit of length gives the same result. If the ratio of the units is a power of two, the result has the same
/// bits.
#[test]
fn the_unit_of_length_does_not_matter() {
    let s = Strut {
        rod_point: None,
        ..nominal()
    };
    let scaled = |k: f64| with_points(&s, |p| p * k);
    for travel in [-0.08, 0.05] {
        let metres = solve_travel(&s, travel, 0.01).unwrap();
        let large = solve_travel(&scaled(1024.0), travel * 1024.0, 0.01 * 1024.0).unwrap();
        assert_eq!(large, metres.map(|p| p * 1024.0));
    }
}
