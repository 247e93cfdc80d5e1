//! Tests of the mechanics of elastic wheels: limits, identities, and two descriptions of the same mechanism.

use super::reference::unit;
use super::{case, compliance, suspension};
use crate::support::larger;
use hardpoint::characteristics::Characteristic;
use hardpoint::compliance::{
    AxialStiffness, BushingPart, Change, Compliance, ElasticFault, ElasticWheel, HeldQuantity,
    Lack, LinkPart, Relaxed, Shape, WheelFigures, WheelLoads, link_members,
};
use hardpoint::model::Suspension;
use hardpoint::study::Study;
use serde_json::Value;

fn wheel(case: &Value) -> ElasticWheel {
    let suspension = suspension(case);
    ElasticWheel::new(&suspension, &compliance(case, &suspension)).unwrap()
}

/// Returns toe, camber and spin in rad, and the wheel centre divided by 300 mm.
fn numbers(f: &WheelFigures) -> [f64; 6] {
    let [x, y, z] = f.centre.to_array().map(|c| c / 300.0);
    [f.toe, f.camber, f.spin, x, y, z]
}

fn largest_difference(a: &WheelFigures, b: &WheelFigures) -> f64 {
    let pairs = numbers(a).into_iter().zip(numbers(b));
    pairs.fold(0.0, |m, (a, b)| larger(m, (a - b).abs()))
}

/// A lateral force behind the contact point equals a lateral force at the contact point plus a moment about the vertical.
#[test]
fn a_trail_is_a_lateral_force_and_an_aligning_moment() {
    for name in ["double_wishbone", "macpherson", "semi_trailing_arm"] {
        let wheel = wheel(&case(name));
        let at = wheel.at(25.0, 0.0).unwrap();
        let by = |load: &WheelLoads| {
            let held = HeldQuantity::WheelHeight;
            wheel.figures_by(&at, &Change::Load(*load), held).unwrap()
        };
        let trail = WheelLoads {
            trail: 45.0,
            ..unit("lateral")
        };
        let (lateral, aligning) = (by(&unit("lateral")), by(&unit("aligning")));
        let found = by(&trail);
        // x component of the heading of a toed wheel.
        let heading = wheel.figures(&at).toe.cos();
        // The rounding error of a solution is relative to its largest component, here of rotations and of displacements
        // divided by 300 mm.
        let parts = numbers(&lateral).into_iter().zip(numbers(&aligning));
        let scale = parts.fold(0.0_f64, |m, (a, b)| larger(m, a.abs() + 45.0 * b.abs()));
        for (k, found) in numbers(&found).into_iter().enumerate() {
            let (a, b) = (numbers(&lateral)[k], numbers(&aligning)[k]);
            let expected = a + 45.0 * heading * b;
            assert!((found - expected).abs() <= 1e-12 * scale, "{name} {k}");
        }
    }
}

/// Elastic parts and a vertical force have a potential energy, so forces and displacements of the wheel centre are
/// reciprocal (symmetric compliance matrix).
#[test]
fn the_compliance_of_the_wheel_centre_is_symmetric() {
    for name in [
        "double_wishbone_free",
        "macpherson",
        "formula_student_links",
    ] {
        let wheel = wheel(&case(name));
        let at = wheel.at(10.0, 0.0).unwrap();
        let tangent = wheel.tangent(&at, HeldQuantity::WheelLoad).unwrap();
        let mut matrix = [[0.0; 6]; 6];
        for column in 0..6 {
            let mut load = WheelLoads::none(0.0);
            let part = if column < 3 {
                &mut load.centre
            } else {
                &mut load.moment
            };
            *[&mut part.x, &mut part.y, &mut part.z][column % 3] = 1.0;
            let [shift, turn] = wheel.twist_along(&tangent, &load).unwrap();
            let twist = shift.to_array().into_iter().chain(turn.to_array());
            for (row, value) in twist.enumerate() {
                matrix[row][column] = value;
            }
        }
        for i in 0..6 {
            for j in 0..i {
                let (a, b) = (matrix[i][j], matrix[j][i]);
                let scale = (matrix[i][i] * matrix[j][j]).sqrt();
                assert!((a - b).abs() < 1e-11 * scale, "{name} {i} {j}: {a} {b}");
            }
        }
    }
}

/// If the stiffness rises, the motion of the wheel approaches that of the rigid mechanism. The difference is proportional
/// to one over the stiffness.
#[test]
fn stiff_parts_move_as_the_rigid_mechanism() {
    for name in ["double_wishbone", "macpherson", "formula_student_links"] {
        let case = case(name);
        let suspension = suspension(&case);
        let travel = 20.0;
        let pose = suspension.pose_at(travel, 0.0).unwrap();
        let angle = |c| pose.characteristic(c).unwrap().to_radians();
        let (toe, camber) = (angle(Characteristic::Toe), angle(Characteristic::Camber));
        let errors = [1e3, 1e4, 1e5].map(|factor| {
            let mut stiff = compliance(&case, &suspension);
            for part in &mut stiff.bushings {
                for shape in &mut part.shapes[..3] {
                    if let Shape::Cubic { rate, .. } = shape {
                        *rate *= factor;
                    }
                }
                // A strut's bushing needs a torsional stiffness, because otherwise the strut could tilt and be displaced.
                part.shapes[3..].iter_mut().for_each(|shape| {
                    *shape = Shape::Cubic {
                        rate: 1.0,
                        cubic: 0.0,
                    };
                });
            }
            for part in &mut stiff.links {
                if let AxialStiffness::Rate(rate) = &mut part.stiffness {
                    *rate *= factor;
                }
            }
            let wheel = ElasticWheel::new(&suspension, &stiff).unwrap();
            let figures = wheel.figures(&wheel.at(travel, 0.0).unwrap());
            (figures.toe - toe).abs() + (figures.camber - camber).abs()
        });
        assert!(errors[2] < 1e-6, "{name} {errors:?}");
        for pair in errors.windows(2) {
            let ratio = pair[0] / pair[1];
            assert!((9.5..10.5).contains(&ratio), "{name} {errors:?}");
        }
    }
}

/// A rigid mechanism has the same derivatives with respect to travel and rack as the kinematics.
#[test]
fn rigid_parts_have_the_derivatives_of_the_mechanism() {
    for name in ["double_wishbone", "macpherson", "semi_trailing_arm"] {
        let case = case(name);
        let suspension = suspension(&case);
        let wheel = ElasticWheel::new(&suspension, &Compliance::rigid(None)).unwrap();
        let at = wheel.at(15.0, 0.0).unwrap();
        let held = HeldQuantity::WheelHeight;
        let by = wheel.figures_by(&at, &Change::Travel, held).unwrap();
        let pose = suspension.pose_at(15.0, 0.0).unwrap();
        for (found, c) in [
            (by.toe, Characteristic::BumpSteer),
            (by.camber, Characteristic::CamberGain),
        ] {
            let expected = pose.characteristic(c).unwrap().to_radians();
            assert!(
                (found - expected).abs() < 1e-13,
                "{name}: {found} {expected}"
            );
        }
        if name == "semi_trailing_arm" {
            continue;
        }
        let by = wheel.figures_by(&at, &Change::Rack, held).unwrap();
        let step = 1e-3;
        let toe = |rack: f64| wheel.figures(&wheel.at(15.0, rack).unwrap()).toe;
        let expected = (toe(step) - toe(-step)) / (2.0 * step);
        assert!((by.toe - expected).abs() < 1e-7 * expected.abs(), "{name}");
    }
}

fn five_link() -> Suspension {
    let path = crate::support::studies().join("five_link_compliance.toml");
    Study::read_elastic(&path, &[]).unwrap().into_wheel()
}

/// Laws of a bushing with equal stiffness in all directions and a torsional stiffness about its x axis.
fn uniform(rate: f64, torsion: f64) -> [Shape; 6] {
    let law = |rate| Shape::Cubic { rate, cubic: 0.0 };
    let (k, t, none) = (law(rate), law(torsion), law(0.0));
    [k.clone(), k.clone(), k, t, none.clone(), none]
}

/// A link between two bushings with equal stiffness in all directions acts as an elastic two-force member with half the
/// stiffness of a bushing. A link with one bushing and one ball joint has the stiffness of this bushing. The test
/// compares each such link with an equivalent two-force member.
#[test]
fn links_on_uniform_bushings_are_stretching_links() {
    let suspension = five_link();
    let mechanism = &suspension.mechanism;
    let elastic = Study::read_elastic(
        &crate::support::studies().join("five_link_compliance.toml"),
        &[],
    );
    let spring = elastic.unwrap().compliance().unwrap().parts.spring.clone();
    let rate = 8000.0;
    // Only one end has a torsional stiffness about the link's line, so the link rotates with that end and carries no
    // torque.
    let with_torsion = |name: &str, torsion: f64| BushingPart {
        point: mechanism.point(name).unwrap(),
        shapes: uniform(rate, torsion),
        preload: [0.0; 6],
        x_axis: None,
        z_axis: None,
    };
    let part = |name: &str| with_torsion(name, 1e5);
    let free = |name: &str| with_torsion(name, 0.0);
    let members = link_members(mechanism);
    let stretching = |name: &str, rate: f64| LinkPart {
        member: members.iter().find(|(known, _)| known == name).unwrap().1,
        stiffness: AxialStiffness::Rate(rate),
        preload: 0.0,
    };
    for relaxed in [Relaxed::Free, Relaxed::AtDesignLoad] {
        let bushed = Compliance {
            relaxed,
            bushings: vec![
                part("upper_front_link_inner"),
                free("upper_front_link_outer"),
                part("upper_rear_link_inner"),
                part("lower_front_link_outer"),
                part("toe_link_inner"),
                free("toe_link_outer"),
            ],
            links: Vec::new(),
            spring: spring.clone(),
        };
        let stretched = Compliance {
            relaxed,
            bushings: Vec::new(),
            links: vec![
                stretching("upper_front_link", 0.5 * rate),
                stretching("upper_rear_link", rate),
                stretching("lower_front_link", rate),
                stretching("toe_link", 0.5 * rate),
            ],
            spring: spring.clone(),
        };
        let [a, b] = [bushed, stretched].map(|c| ElasticWheel::new(&suspension, &c).unwrap());
        // In the design position both descriptions have the same forces. Elsewhere they may differ: the preload of a
        // bushing keeps its direction in the body, but the preload of a link stays along the link.
        if relaxed == Relaxed::AtDesignLoad {
            let [a, b] = [&a, &b].map(|wheel| wheel.design_load().unwrap());
            assert!((a - b).abs() < 1e-11 * b, "{a} {b}");
            continue;
        }
        for (travel, rack) in [(0.0, 0.0), (35.0, 0.0), (-30.0, 8.0)] {
            let load = WheelLoads {
                side: 2500.0,
                trail: 20.0,
                ..unit("braking")
            };
            let loaded = |wheel: &ElasticWheel| {
                let at = wheel.at(travel, rack).unwrap();
                let at = wheel.loaded(&at, &load, HeldQuantity::WheelHeight).unwrap();
                let by =
                    wheel.figures_by(&at, &Change::Load(unit("lateral")), HeldQuantity::WheelLoad);
                (wheel.figures(&at), by.unwrap(), wheel.rack_force(&at))
            };
            let (found, expected) = (loaded(&a), loaded(&b));
            let error = largest_difference(&found.0, &expected.0);
            assert!(error < 1e-11, "{relaxed:?} {travel} {error:e}");
            let error = largest_difference(&found.1, &expected.1);
            assert!(error < 1e-15, "{relaxed:?} {travel} {error:e}");
            assert!(
                (found.2 - expected.2).abs() < 1e-6,
                "{found:?} {expected:?}"
            );
        }
    }
}

/// If the stiffness of one bushing grows, an arm with two bushings approaches an arm with one bushing and one ball joint.
#[test]
fn a_ball_joint_is_the_limit_of_a_stiff_bushing() {
    let case = case("double_wishbone");
    let suspension = suspension(&case);
    let full = compliance(&case, &suspension);
    let stiff_at = suspension.mechanism.point("lower_arm_front").unwrap();
    let mut one = full.clone();
    one.bushings.retain(|part| part.point != stiff_at);
    let loaded = |compliance: &Compliance| {
        let wheel = ElasticWheel::new(&suspension, compliance).unwrap();
        let at = wheel.at(20.0, 0.0).unwrap();
        let load = WheelLoads {
            side: 2000.0,
            ..unit("braking")
        };
        let at = wheel.loaded(&at, &load, HeldQuantity::WheelHeight).unwrap();
        wheel.figures(&at)
    };
    let expected = loaded(&one);
    let errors = [1e3, 1e4, 1e5].map(|factor| {
        let mut stiff = full.clone();
        let part = stiff
            .bushings
            .iter_mut()
            .find(|part| part.point == stiff_at)
            .unwrap();
        for shape in &mut part.shapes[..3] {
            if let Shape::Cubic { rate, .. } = shape {
                *rate *= factor;
            }
        }
        for shape in &mut part.shapes[3..] {
            *shape = Shape::Cubic {
                rate: 0.0,
                cubic: 0.0,
            };
        }
        largest_difference(&loaded(&stiff), &expected)
    });
    for pair in errors.windows(2) {
        let ratio = pair[0] / pair[1];
        assert!((9.0..11.0).contains(&ratio), "{errors:?}");
    }
}

/// With the wheel load held, the lateral force on a wheel has a maximum (a fold). Its value comes from an independent
/// calculation.
#[test]
fn a_side_force_ends_at_the_fold() {
    let wheel = wheel(&case("double_wishbone"));
    let start = wheel.at(0.0, 0.0).unwrap();
    let mut more = WheelLoads::none(0.0);
    more.contact.z = 2000.0;
    let at = wheel
        .loaded(&start, &more, HeldQuantity::WheelLoad)
        .unwrap();
    let side = |force: f64| WheelLoads {
        side: force,
        ..WheelLoads::none(0.0)
    };
    let wanted = 25_000.0;
    let found = wheel.loaded(&at, &side(wanted), HeldQuantity::WheelLoad);
    let why = found.unwrap_err();
    let reached = why.share * wanted;
    // The program finds the reachable fraction of the load to 1e-6. The bound is twice this error.
    assert!((reached - 18_129.16).abs() < 2e-6 * wanted, "{reached}");
    assert!(why.softest.is_some() && why.lack == Lack::Equilibrium);
    // If the wheel height is held instead, the force has no maximum up to this value.
    wheel
        .loaded(&start, &side(wanted), HeldQuantity::WheelHeight)
        .unwrap();
}

/// The program refuses a link without torsional stiffness, because it could turn freely about its own line.
#[test]
fn a_loose_link_is_refused() {
    let suspension = five_link();
    let part = |name: &str| BushingPart {
        point: suspension.mechanism.point(name).unwrap(),
        shapes: uniform(5000.0, 0.0),
        preload: [0.0; 6],
        x_axis: None,
        z_axis: None,
    };
    let loose = Compliance {
        relaxed: Relaxed::Free,
        bushings: vec![part("toe_link_inner"), part("toe_link_outer")],
        links: Vec::new(),
        spring: None,
    };
    let fault = ElasticWheel::new(&suspension, &loose).unwrap_err();
    let ElasticFault::Loose { part, .. } = fault else {
        panic!("{fault:?}");
    };
    assert_eq!(part, "toe_link");
}

/// Constant forces of bushings are added to the forces that hold the design position. A second suspension has no design
/// load, and its constant forces are the sums of these two forces. If the laws are linear, both suspensions have the same
/// results.
#[test]
fn constant_forces_and_those_at_the_design_load_add() {
    let case = case("double_wishbone");
    let suspension = suspension(&case);
    let clamped = compliance(&case, &suspension);
    let wheel = ElasticWheel::new(&suspension, &clamped).unwrap();
    let at_design = wheel.bushings(&wheel.at(0.0, 0.0).unwrap());
    let offset = |k: usize, axis: usize| 100.0 * (k as f64 - 1.3) * (axis as f64 + 0.7);
    let mut both = clamped.clone();
    let mut free = clamped.clone();
    free.relaxed = Relaxed::Free;
    for (k, at_design) in at_design.iter().enumerate() {
        let held = (-at_design.force).to_array();
        for (axis, held) in held.into_iter().enumerate() {
            both.bushings[k].preload[axis] = offset(k, axis);
            free.bushings[k].preload[axis] = held + offset(k, axis);
        }
    }
    let [both, free] = [both, free].map(|parts| ElasticWheel::new(&suspension, &parts).unwrap());
    for travel in [-25.0, 0.0, 30.0] {
        let [a, b] = [&both, &free].map(|w| w.figures(&w.at(travel, 0.0).unwrap()));
        let plain = wheel.figures(&wheel.at(travel, 0.0).unwrap());
        let effect = (a.toe - plain.toe).abs();
        assert!(
            effect > 1e-6,
            "the constant forces have no effect: {effect:e}"
        );
        assert!(
            (a.toe - b.toe).abs() < 1e-12,
            "{travel}: {} {}",
            a.toe,
            b.toe
        );
        assert!((a.camber - b.camber).abs() < 1e-12, "{travel}");
        assert!((a.contact - b.contact).norm() < 1e-9, "{travel}");
        assert!((a.vertical - b.vertical).abs() < 1e-7, "{travel}");
    }
}
