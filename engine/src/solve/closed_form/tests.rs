//! Tests of the assemblies of the closed form.

use super::{ClosedForm, Roles, UpperRoles};
use crate::mechanism::Pose;
use crate::mechanism::{Closure, Configuration, DesignFault, Driver};
use crate::model::Topology;
use crate::number::Vector3;
use crate::study::Study;
use std::path::Path;

/// At each arm angle all assemblies have the lengths of the design, and they differ from each other. The first one is
/// the assembly of the design.
#[test]
fn assemblies_keep_every_length() {
    let mut seen = 0;
    for topology in Topology::ALL {
        let study = Study::from_text("closed.toml", topology.template, Path::new(".")).unwrap();
        let suspension = study.wheel();
        let (mechanism, design) = (&suspension.mechanism, &suspension.design);
        let Some(form) = ClosedForm::of(mechanism, design).unwrap() else {
            continue;
        };
        seen += 1;
        let closure = Closure::new(mechanism, design);
        for angle in [0.0, 0.12, -0.17] {
            let (sine, cosine) = f64::sin_cos(angle);
            let poses = [(false, false), (false, true), (true, false), (true, true)].map(
                |(upper_across, tie_rod_across)| {
                    let form = form.assembled(upper_across, tie_rod_across);
                    form.pose(&form.at(cosine, sine, 0.0))
                },
            );
            // At some arm angles, assemblies other than the first one do not exist. Their poses contain NaN.
            let is_real = |pose: &&Pose<f64>| !pose.rotation.columns[0].x.is_nan();
            assert!(is_real(&&poses[0]));
            let poses: Vec<_> = poses.iter().filter(is_real).collect();
            assert!(poses.len() >= 2, "{}", topology.name);
            for (number, pose) in poses.iter().enumerate() {
                let at = Configuration::new(mechanism, design, **pose, 0.0);
                let off = closure.residuals(&at, Driver::ArmAngle { sine, cosine });
                let bound = rounding_bound(&at);
                assert!(
                    off.iter().all(|r| r.abs() < bound),
                    "{number}: {off:?} {bound}"
                );
                for other in &poses[..number] {
                    let [a, b] = [*pose, *other].map(|pose| pose.rotation.columns);
                    let apart = (0..3).map(|k| (a[k] - b[k]).norm()).sum::<f64>();
                    assert!(apart > 0.01, "{} {number}: {apart}", topology.name);
                }
            }
            if angle == 0.0 {
                let [x, y, z] = poses[0].rotation.columns;
                assert!((x.x - 1.0).abs() + (y.y - 1.0).abs() + (z.z - 1.0).abs() < 1e-12);
            }
        }
    }
    assert!(seen >= 2);
}

/// Bound of the residuals that rounding errors cause. An error of a square root moves a point along the circle that the
/// lengths allow, so it changes no length. The two Gram systems multiply the rounding errors of coordinates by the inverse
/// of their determinants: |d|^2 |g|^2/|d x g|^2 and |d|^2 |t|^2/|d x t|^2. About 200 operations contribute.
fn rounding_bound(at: &Configuration<f64>) -> f64 {
    let roles = Roles::of(at.mechanism).unwrap();
    let from = at.point(roles.ball_joint());
    let axis = at.point(roles.upper_end()) - from;
    let amplified = roles.tie_rod().map(|end| {
        let lever = at.point(end) - from;
        axis.norm_squared() * lever.norm_squared() / axis.cross(lever).norm_squared()
    });
    let coordinates = at.mechanism.coordinate_scale(at.design);
    200.0 * f64::EPSILON * coordinates * amplified.iter().product::<f64>()
}

/// The closed form computes the length of a strut from its square. If the length is below 1e-5 of the steering axis, too
/// few digits of the square remain, and the design is refused.
#[test]
fn a_strut_without_length_is_refused() {
    let template = Topology::named("macpherson").unwrap().template;
    let study = Study::from_text("closed.toml", template, Path::new(".")).unwrap();
    let suspension = study.wheel();
    let mechanism = &suspension.mechanism;
    let roles = Roles::of(mechanism).unwrap();
    let UpperRoles::Strut { top, lower, upper } = roles.upper else {
        panic!("no strut");
    };
    for (share, is_refused) in [(1e-4, false), (1e-6, true)] {
        let mut design = suspension.design.clone();
        let axis = design[top.0] - design[roles.ball_joint().0];
        let across = axis.cross(Vector3::new(1.0, 0.0, 0.0)).normalised();
        let line = across + axis.normalised() * share;
        design[lower.0] = design[upper.unwrap_or(top).0] - line * 100.0;
        let found = ClosedForm::of(mechanism, &design);
        let refused = matches!(found, Err(DesignFault::NoStrutLength));
        assert_eq!(refused, is_refused, "{share}");
    }
}

/// If rounding puts a state beyond a toggle, `at_toggle_if_beyond` moves the tie rod's outer end back to the toggle.
/// Other states do not change.
#[test]
fn a_state_beyond_a_toggle_is_put_at_it() {
    let study = Topology::ALL.iter().find_map(|topology| {
        let study = Study::from_text("closed.toml", topology.template, Path::new(".")).ok()?;
        let suspension = study.wheel();
        ClosedForm::of(&suspension.mechanism, &suspension.design).ok()?
    });
    let mut state = study.unwrap().at(1.0, 0.0, 0.0);
    let ga = state.ga;
    state.at_toggle_if_beyond();
    assert_eq!(state.ga, ga);
    assert!(ga != 0.0);
    state.ga = f64::NAN;
    state.at_toggle_if_beyond();
    assert_eq!(state.ga, 0.0);
}
