//! Tests of loads on elastic suspensions: the forces of all members and the load keep each body in balance. With stiff
//! parts, the member forces approach those of the rigid mechanism.

use super::support::{elastic, with};
use crate::support::larger;
use hardpoint::compliance::{ElasticAxle, ElasticWheel, Equilibrium, HeldQuantity, WheelLoads};
use hardpoint::curves::{Curves, Status};
use hardpoint::model::{Body, Side, Suspension};
use hardpoint::number::Vector3;
use hardpoint::study::Study;
use std::path::Path;

/// Loads of a study: two complete loads at the contact point and at the wheel centre, and one load with the wheel height
/// held.
#[derive(Clone, Copy)]
struct Given {
    braking: [f64; 3],
    kerb: [f64; 3],
    moment: [f64; 3],
    corner: [f64; 3],
}

impl Given {
    /// Returns loads for a wheel that carries approximately this force.
    fn about(wheel_load: f64) -> Self {
        let of = |shares: [f64; 3]| shares.map(|share| share * wheel_load);
        Given {
            braking: of([-0.6, 0.3, 1.2]),
            kerb: of([-0.4, 0.0, 1.3]),
            moment: of([5.0, 12.0, -8.0]),
            corner: of([0.0, -0.5, 0.0]),
        }
    }

    /// Section of a study with these loads.
    fn text(&self) -> String {
        let Given {
            braking,
            kerb,
            moment,
            corner,
        } = self;
        format!(
            "\n[outputs]\ncharacteristics = [\"toe\"]\nloads = [\n\
             {{ name = \"braking\", at = \"contact_point\", force = {braking:?} }},\n\
             {{ name = \"kerb\", at = \"wheel_centre\", force = {kerb:?}, moment = {moment:?} }},\n\
             {{ name = \"corner\", at = \"contact_point\", force = {corner:?}, hold = \"wheel_height\" }},\n]\n"
        )
    }
}

/// Value of a column at a station.
fn value(curves: &Curves, station: usize, name: &str) -> f64 {
    let names: Vec<&str> = curves.columns.iter().map(|c| &c.name[..]).collect();
    let place = names.iter().position(|known| *known == name);
    let place = place.unwrap_or_else(|| panic!("{name} in {names:?}"));
    curves.stations[station].value(place).unwrap()
}

/// Force in the columns `NAME_x_N`, `NAME_y_N` and `NAME_z_N`.
fn force(curves: &Curves, station: usize, name: &str) -> Vector3<f64> {
    let of = |axis: &str| value(curves, station, &format!("{name}_{axis}_N"));
    Vector3::new(of("x"), of("y"), of("z"))
}

fn design(suspension: &Suspension, name: &str) -> Vector3<f64> {
    suspension.design[suspension.mechanism.point(name).unwrap().0]
}

/// Rotation of a vector by a rotation vector (Rodrigues' formula).
fn turned(v: Vector3<f64>, by: Vector3<f64>) -> Vector3<f64> {
    let angle = by.norm();
    if angle == 0.0 {
        return v;
    }
    let axis = by * (1.0 / angle);
    v * angle.cos() + axis.cross(v) * angle.sin() + axis * (axis.dot(v) * (1.0 - angle.cos()))
}

/// Equilibrium under a load. The test solves it separately and stores the total force and its point of application.
struct Loaded {
    wheel: ElasticWheel,
    at: Equilibrium,
    force: Vector3<f64>,
    point: Vector3<f64>,
    moment: Vector3<f64>,
}

impl Loaded {
    fn of(study: &Study, given: &Given, travel: f64, name: &str) -> Self {
        let wheel = ElasticWheel::new(study.wheel(), &study.compliance().unwrap().parts).unwrap();
        let station = wheel.at(travel, 0.0).unwrap();
        let mut loads = WheelLoads::none(0.0);
        let zero = Vector3::new(0.0, 0.0, 0.0);
        let (mut moment, mut held) = (zero, HeldQuantity::WheelLoad);
        match name {
            "braking" => loads.contact = Vector3::from(given.braking),
            "kerb" => {
                loads.centre = Vector3::from(given.kerb);
                moment = Vector3::from(given.moment);
                loads.moment = moment;
            }
            _ => {
                loads.contact = Vector3::from(given.corner);
                held = HeldQuantity::WheelHeight;
            }
        }
        if held == HeldQuantity::WheelLoad {
            loads.contact.z -= wheel.wheel_load(&station);
        }
        let at = wheel
            .loaded_about(&station, &station, &loads, held)
            .unwrap();
        let figures = wheel.figures(&at);
        let (force, point) = match name {
            "kerb" => (loads.centre, figures.centre),
            _ => {
                let up = wheel.wheel_load(&at);
                (
                    Vector3::new(loads.contact.x, loads.contact.y, up),
                    figures.contact,
                )
            }
        };
        Loaded {
            wheel,
            at,
            force,
            point,
            moment,
        }
    }

    /// Position of a point of the carrier.
    fn carried(&self, suspension: &Suspension, name: &str) -> Vector3<f64> {
        let lever = design(suspension, name) - design(suspension, "wheel_centre");
        self.wheel.figures(&self.at).centre + turned(lever, self.wheel.rotation(&self.at))
    }
}

/// Name of a rod, its inner and its outer end.
type Rod = (&'static str, &'static str, &'static str);

/// Samples with a typical wheel load, and the parts that hold the carrier: joints, and rods with both ends.
const CASES: [(&str, f64, &[&str], &[Rod]); 3] = [
    (
        "double_wishbone_compliance.toml",
        4000.0,
        &["upper_ball_joint", "lower_ball_joint"],
        &[("tie_rod", "tie_rod_inner", "tie_rod_outer")],
    ),
    (
        "formula_student_compliance.toml",
        700.0,
        &["lower_ball_joint"],
        &[
            ("tie_rod", "tie_rod_inner", "tie_rod_outer"),
            ("upper_arm_front", "upper_arm_front", "upper_ball_joint"),
            ("upper_arm_rear", "upper_arm_rear", "upper_ball_joint"),
        ],
    ),
    (
        "five_link_compliance.toml",
        4000.0,
        &[
            "upper_front_link_outer",
            "upper_rear_link_outer",
            "lower_front_link_outer",
            "lower_rear_link_outer",
        ],
        &[("toe_link", "toe_link_inner", "toe_link_outer")],
    ),
];

/// The forces of joints and rods balance the load on the wheel carrier: forces, and moments about the wheel centre.
#[test]
fn printed_forces_balance_the_wheel_carrier() {
    for (name, wheel_load, joints, rods) in CASES {
        let given = Given::about(wheel_load);
        let study = elastic(&with(name, &given.text()));
        let suspension = study.wheel();
        let curves = study.curves().unwrap();
        let station = 0;
        let travel = study.motion().values[station];
        assert_eq!(curves.stations[station].status, Status::Ok);
        for load in ["braking", "kerb", "corner"] {
            let loaded = Loaded::of(&study, &given, travel, load);
            let centre = loaded.wheel.figures(&loaded.at).centre;
            let (mut total, mut moment) = (loaded.force, loaded.moment);
            moment = moment + (loaded.point - centre).cross(loaded.force);
            let mut add = |point: Vector3<f64>, force: Vector3<f64>| {
                total = total + force;
                moment = moment + (point - centre).cross(force);
            };
            for joint in joints {
                let force = force(&curves, station, &format!("{load}_{joint}"));
                add(loaded.carried(suspension, joint), force);
            }
            for (rod, inner, outer) in rods {
                let outer = loaded.carried(suspension, outer);
                let inward = (design(suspension, inner) - outer).normalised();
                let tension = value(&curves, station, &format!("{load}_{rod}_N"));
                add(outer, inward * tension);
            }
            let mechanism = &suspension.mechanism;
            if mechanism.body(mechanism.spring.unwrap().lower) == Body::Knuckle {
                let lower = loaded.carried(suspension, "spring_lower");
                let push = (lower - design(suspension, "spring_upper")).normalised();
                add(
                    lower,
                    push * value(&curves, station, &format!("{load}_spring_N")),
                );
            }
            // Residual bound of equilibria: 1e-10 of the load.
            let size = loaded.force.norm();
            assert!(
                total.norm() < 1e-10 * size,
                "{name} {load}: {:e}",
                total.norm() / size
            );
            // Bushings between links and carrier also transmit torques.
            if name != "five_link_compliance.toml" {
                let off = moment.norm() / (size * 300.0);
                assert!(off < 1e-10, "{name} {load}: {off:e}");
            }
            let open = match load {
                "corner" => {
                    let found = value(&curves, station, "corner_vertical_force_N");
                    found - loaded.wheel.wheel_load(&loaded.at)
                }
                _ => {
                    let found = value(&curves, station, &format!("{load}_travel_mm"));
                    found - loaded.wheel.travel(&loaded.at)
                }
            };
            assert!(open.abs() < 1e-9, "{name} {load}: {open:e}");
        }
    }
}

/// An arm without a spring transmits the forces of its bushings to the carrier. The printed forces of spring and links equal
/// the forces in the equilibrium.
#[test]
fn an_arm_passes_the_forces_of_its_bushings() {
    let given = Given::about(4000.0);
    let study = elastic(&with("double_wishbone_compliance.toml", &given.text()));
    let suspension = study.wheel();
    let curves = study.curves().unwrap();
    let [front, rear] = ["upper_arm_front", "upper_arm_rear"].map(|name| design(suspension, name));
    let x = (front - rear).normalised();
    let up = Vector3::new(0.0, 0.0, 1.0);
    let z = (up - x * x.dot(up)).normalised();
    let axes = [x, z.cross(x), z];
    for load in ["braking", "kerb", "corner"] {
        let bushing = |name: &str| {
            let own = force(&curves, 1, &format!("{load}_{name}_force"));
            axes[0] * own.x + axes[1] * own.y + axes[2] * own.z
        };
        let sum = bushing("upper_arm_front") + bushing("upper_arm_rear");
        let joint = force(&curves, 1, &format!("{load}_upper_ball_joint"));
        assert!((sum - joint).norm() < 1e-8, "{load}: {sum:?} {joint:?}");
        let loaded = Loaded::of(&study, &given, study.motion().values[1], load);
        let spring = loaded.wheel.spring(&loaded.at).unwrap().force;
        let found = value(&curves, 1, &format!("{load}_spring_N"));
        assert!((found - spring).abs() < 1e-9 * spring);
    }
    let given = Given::about(700.0);
    let study = elastic(&with("formula_student_compliance.toml", &given.text()));
    let curves = study.curves().unwrap();
    let loaded = Loaded::of(&study, &given, study.motion().values[1], "corner");
    let names = &study.compliance().unwrap().link_names;
    let mut compared = 0;
    for (name, tension) in names.iter().zip(loaded.wheel.tensions(&loaded.at)) {
        // The pushrod acts on the lower arm. So the arm carries bending, and the program prints the force of its ball joint
        // instead of the tensions of its tubes.
        if name.starts_with("lower_arm") {
            continue;
        }
        let (found, tension) = (
            value(&curves, 1, &format!("corner_{name}_N")),
            tension.unwrap(),
        );
        assert!((found - tension).abs() < 1e-8, "{name}: {found} {tension}");
        compared += 1;
    }
    // Two tubes of the upper arm, tie rod and pushrod.
    assert_eq!(compared, 4);
}

/// With very stiff bushings without torsion, members carry the same forces as in the rigid mechanism under the same load.
/// The difference is proportional to one over the stiffness.
#[test]
fn stiff_bushings_carry_the_forces_of_the_rigid_mechanism() {
    let base = with("double_wishbone_compliance.toml", "");
    let (rigid, _) = base.split_once("[compliance]").unwrap();
    let rigid = rigid.replace(
        "travel = { from = -40.0, to = 40.0, steps = 5 }",
        "travel = 15.0",
    );
    let stiff = |rate: f64| {
        let mut text = format!("{rigid}[compliance]\nrelaxed = \"free\"\n");
        for name in [
            "lower_arm_front",
            "lower_arm_rear",
            "upper_arm_front",
            "upper_arm_rear",
        ] {
            text += &format!(
                "[bushings.{name}]\nstiffness = [{rate:?}, {rate:?}, {rate:?}, 0.0, 0.0, 0.0]\n"
            );
        }
        text += "[outputs]\nloads = [{ name = \"both\", at = \"contact_point\", force = [-2000.0, -1500.0, 0.0], hold = \"wheel_height\" }]\n";
        elastic(&text).curves().unwrap()
    };
    let names = [
        "both_tie_rod_N",
        "both_upper_ball_joint_x_N",
        "both_upper_ball_joint_y_N",
        "both_upper_ball_joint_z_N",
        "both_lower_ball_joint_x_N",
        "both_lower_ball_joint_y_N",
        "both_lower_ball_joint_z_N",
        "both_spring_N",
    ];
    let off = |rate: f64| {
        let curves = stiff(rate);
        let up = value(&curves, 0, "both_vertical_force_N");
        // The height of a rigid wheel does not depend on its spring, so the study of the rigid mechanism needs no
        // spring rate.
        let (points, motion) = rigid.split_once("[spring]").unwrap();
        let (_, motion) = motion.split_once("[motion]").unwrap();
        let text = format!(
            "{points}[motion]{motion}[outputs]\nloads = [{{ name = \"both\", at = \"contact_point\", force = [-2000.0, -1500.0, {up:?}] }}]\n"
        );
        let study = Study::from_text("case.toml", &text, Path::new("")).unwrap();
        let exact = study.curves().unwrap();
        let apart = names.map(|name| (value(&curves, 0, name) - value(&exact, 0, name)).abs());
        apart.into_iter().fold(0.0, larger)
    };
    let [soft, hard] = [1e6, 1e8].map(off);
    // The bound is 4e-5 of the load. The ratio shows that the whole error falls with the stiffness.
    assert!(hard < 0.1, "{hard}");
    let ratio = soft / hard;
    assert!((80.0..120.0).contains(&ratio), "{soft} {hard}");
}

const AXLE_LOADS: &str = r#"
[outputs]
characteristics = ["toe"]
loads = [
  { name = "turn", at = "contact_point", side = "left", force = [0.0, -2500.0, 5000.0] },
  { name = "turn", at = "contact_point", side = "right", force = [0.0, -800.0, 3000.0] },
  { name = "brake", at = "contact_point", force = [-2000.0, 0.0, 0.0], hold = "wheel_height" },
]
"#;

/// At each wheel of an axle on a subframe that rotates, the tie rod tension balances load and joint forces, with its sign.
/// The printed forces of bar, rack and bushings equal the forces in the equilibrium.
#[test]
fn forces_of_an_axle_balance_both_carriers() {
    let study = elastic(&with("subframe_axle_compliance.toml", AXLE_LOADS));
    let both = study.axle().unwrap();
    let parts = &both.axle.elastic.as_ref().unwrap().parts;
    let suspension = &both.axle.left;
    let model = ElasticAxle::of([suspension; 2], [&suspension.design[..]; 2], parts).unwrap();
    let curves = study.curves().unwrap();
    assert_eq!(curves.stations[0].status, Status::Ok);
    let station = model.at([-30.0; 2], 0.0).unwrap();
    for (name, sides) in [
        ("turn", [[0.0, -2500.0, 5000.0], [0.0, -800.0, 3000.0]]),
        ("brake", [[-2000.0, 0.0, 0.0]; 2]),
    ] {
        let is_complete = name == "turn";
        let held = if is_complete {
            HeldQuantity::WheelLoad
        } else {
            HeldQuantity::WheelHeight
        };
        let loads = Side::ALL.map(|side| {
            let [x, y, z] = sides[side as usize];
            let mut loads = WheelLoads::none(0.0);
            // The right wheel's frame is mirrored.
            let mirror = if side == Side::Left { 1.0 } else { -1.0 };
            loads.contact = Vector3::new(x, mirror * y, z);
            if is_complete {
                loads.contact.z -= model.wheel_load(&station, side);
            }
            loads
        });
        let at = model
            .loaded_about(&station, &station, &loads, held)
            .unwrap();
        let mut of_rods = 0.0;
        for side in Side::ALL {
            let [x, y, _] = sides[side as usize];
            let load = Vector3::new(x, y, model.wheel_load(&at, side));
            let word = side.name();
            let joint = |joint: &str| force(&curves, 0, &format!("{word}_{name}_{joint}"));
            let rest = load + joint("upper_ball_joint") + joint("lower_ball_joint");
            // A tie rod under tension pulls its carrier inboard, so load and joint forces then point outboard.
            let outboard = if side == Side::Left { rest.y } else { -rest.y };
            let tension = value(&curves, 0, &format!("{word}_{name}_tie_rod_N"));
            let off = rest.norm().copysign(outboard) - tension;
            assert!(off.abs() < 1e-11 * load.norm(), "{name} {word}: {off:e}");
            of_rods -= rest.y;
            let readings = model.bushings(&at, side);
            let found = value(
                &curves,
                0,
                &format!("{word}_{name}_subframe_front_force_z_N"),
            );
            assert!(
                (found - readings[4].force.z).abs() < 1e-8,
                "{found} {readings:?}"
            );
        }
        // The subframe rotates only slightly, so the rack carries nearly the lateral forces of both tie rods.
        let rack = value(&curves, 0, &format!("{name}_rack_force_N"));
        assert!((rack - model.rack_force(&at)).abs() < 1e-8);
        assert!(
            (rack - of_rods).abs() < 0.05 * of_rods.abs() + 5.0,
            "{rack} {of_rods}"
        );
        let bar = value(&curves, 0, &format!("{name}_anti_roll_bar_torque_N_m"));
        assert!((bar - model.bar_torque(&at).unwrap() / 1000.0).abs() < 1e-8);
    }
}

/// If the wheel cannot carry a load, the members have no forces, and the station reports this. The program refuses
/// invalid loads and names their key.
#[test]
fn loads_that_cannot_be_held_have_no_values() {
    let one = |load: &str| {
        let text = format!(
            "\n[outputs]\ncharacteristics = [\"toe\"]\nloads = [{{ name = \"x\", {load} }}]\n"
        );
        with("double_wishbone_compliance.toml", &text)
    };
    let text = one("at = \"contact_point\", force = [0.0, -60000.0, 6000.0]");
    let curves = elastic(&text).curves().unwrap();
    assert_eq!(curves.stations.len(), 5);
    assert!(
        curves
            .stations
            .iter()
            .all(|s| s.status == Status::Unsupported)
    );
    let place = curves
        .columns
        .iter()
        .position(|c| c.name == "x_tie_rod_N")
        .unwrap();
    assert!(curves.stations.iter().all(|s| s.value(place).is_none()));
    assert!(curves.stations.iter().all(|s| s.value(0).is_some()));
    let refused = |text: &str| {
        let errors = Study::elastic_from_text("case.toml", text, Path::new("")).unwrap_err();
        errors.render(false)
    };
    let held = "at = \"contact_point\", force = [0.0, 0.0, 4000.0], hold = \"wheel_height\"";
    let said = refused(&one(held));
    assert!(said.contains("leave z of force out"), "{said}");
    let said = refused(&one(
        "at = \"contact_point\", force = [0.0, 1.0, 0.0], hold = \"travel\"",
    ));
    assert!(said.contains("wheel_height"), "{said}");
    let text = one("at = \"contact_point\", force = [0.0, 1.0, 0.0], hold = \"wheel_load\"");
    let (rigid, rest) = text.split_once("[compliance]").unwrap();
    let (_, outputs) = rest.split_once("[outputs]").unwrap();
    let said = refused(&format!("{rigid}[outputs]{outputs}"));
    assert!(said.contains("hold\" needs [compliance]"), "{said}");
    let without = text.replace("[spring]\nrate = 90.0       # N/mm along the spring\nforce = 7000.0    # N in the design position\n", "");
    assert_ne!(without, text);
    let said = refused(&without.replace("\"at_design_load\"", "\"free\""));
    assert!(said.contains("needs [spring]"), "{said}");
}
