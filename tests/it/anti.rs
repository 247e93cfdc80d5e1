//! Tests of anti-dive, anti-lift and anti-squat against statics: the spring force under a longitudinal force with its
//! load transfer, and the spring force under the load transfer alone.
//!
//! The spring forces come from the force balance of the links (`analyse::loads`), which uses no velocities. If a shaft
//! carries the torque about the spin axis, the test subtracts this torque from the load on the wheel carrier.

use hardpoint::curves::curves;
use hardpoint::number::Vector3;
use hardpoint::plan::Plan;
use hardpoint::study::Study;

const WHEELBASE: f64 = 2650.0;
const CG_HEIGHT: f64 = 540.0;
const RADIUS: f64 = 300.0;
/// Braking or drive force of the whole car, in N.
const FORCE: f64 = 1000.0;

struct Case {
    characteristic: &'static str,
    /// Values of the keys of `[vehicle]`.
    axle: &'static str,
    /// Share of the force at this axle, positive forward.
    share: f64,
    /// Sign of the load transfer: 1 if the load on the axle increases, -1 if it decreases.
    transfer: f64,
    shafts: bool,
}

const CASES: &[Case] = &[
    Case {
        characteristic: "anti_dive",
        axle: "position=\"front\", brakes=\"outboard\", brake_share_front=0.65",
        share: -0.65,
        transfer: 1.0,
        shafts: false,
    },
    Case {
        characteristic: "anti_dive",
        axle: "position=\"front\", brakes=\"inboard\", brake_share_front=0.65",
        share: -0.65,
        transfer: 1.0,
        shafts: true,
    },
    Case {
        characteristic: "anti_lift",
        axle: "position=\"rear\", brakes=\"outboard\", brake_share_front=0.65",
        share: -0.35,
        transfer: -1.0,
        shafts: false,
    },
    Case {
        characteristic: "anti_lift",
        axle: "position=\"rear\", brakes=\"inboard\", brake_share_front=0.65",
        share: -0.35,
        transfer: -1.0,
        shafts: true,
    },
    Case {
        characteristic: "anti_lift",
        axle: "position=\"front\", drive_torque=\"shafts\", drive_share_front=0.4",
        share: 0.4,
        transfer: -1.0,
        shafts: true,
    },
    Case {
        characteristic: "anti_lift",
        axle: "position=\"front\", drive_torque=\"carrier\", drive_share_front=0.4",
        share: 0.4,
        transfer: -1.0,
        shafts: false,
    },
    Case {
        characteristic: "anti_squat",
        axle: "position=\"rear\", drive_torque=\"shafts\", drive_share_front=0.4",
        share: 0.6,
        transfer: 1.0,
        shafts: true,
    },
    Case {
        characteristic: "anti_squat",
        axle: "position=\"rear\", drive_torque=\"carrier\", drive_share_front=0.0",
        share: 1.0,
        transfer: 1.0,
        shafts: false,
    },
];

/// Sample study with a spindle that is neither horizontal nor lateral, so that camber and toe affect the results.
fn study(topology: &str, more: &[String]) -> Study {
    let path = crate::support::studies();
    let mut set = vec![
        "suspension.hardpoints.wheel_centre=[0.0, 760.0, 300.0]".to_owned(),
        "suspension.hardpoints.spindle_inner=[-3.0, 660.0, 295.0]".to_owned(),
        format!("wheel.radius={RADIUS:?}"),
        "motion.travel=0.0".to_owned(),
    ];
    set.extend_from_slice(more);
    Study::read(&path.join(format!("{topology}_solve.toml")), &set)
        .unwrap_or_else(|e| panic!("{topology}: {}", e.render(false)))
}

fn value(study: &Study, column: &str) -> f64 {
    let found = curves(study.wheel(), &Plan::of(study.one_wheel().unwrap())).unwrap();
    let names = || found.columns.iter().map(|c| c.name.as_str());
    let k = names().position(|name| name == column);
    let k = k.unwrap_or_else(|| panic!("{column} of {:?}", names().collect::<Vec<_>>()));
    found.stations[0].values[k].unwrap()
}

#[test]
fn the_spring_feels_what_the_percentages_leave_to_it() {
    let up = Vector3::new(0.0, 0.0, 1.0);
    for topology in [
        "macpherson",
        "double_wishbone",
        "five_link",
        "semi_trailing_arm",
    ] {
        for case in CASES {
            let vehicle = format!(
                "vehicle={{wheelbase={WHEELBASE:?}, cg_height={CG_HEIGHT:?}, {}}}",
                case.axle
            );
            let name = case.characteristic;
            let asked = format!("outputs={{characteristics=[\"{name}\"]}}");
            let told = value(
                &study(topology, &[vehicle, asked]),
                &format!("{name}_percent"),
            );

            let axis = Vector3::new(3.0, 100.0, 5.0).normalised();
            let down = axis * axis.dot(up) - up;
            let lever = down * (RADIUS / down.norm());
            let force = Vector3::new(case.share * FORCE, 0.0, 0.0);
            let torque = axis * axis.dot(lever.cross(force));
            let moment = if case.shafts {
                -torque
            } else {
                Vector3::default()
            };
            let transfer = case.transfer * FORCE * CG_HEIGHT / WHEELBASE;
            let loads = format!(
                "outputs={{characteristics=[], loads=[{{name=\"along\", at=\"contact_point\", force={:?}, moment={:?}}}, \
                 {{name=\"transfer\", at=\"contact_point\", force=[0.0, 0.0, {transfer:?}]}}]}}",
                force.to_array(),
                moment.to_array()
            );
            let loaded = study(topology, &[loads]);
            let [along, transfer] =
                ["along", "transfer"].map(|load| value(&loaded, &format!("{load}_spring_N")));
            let wanted = -100.0 * along / transfer;
            println!("{topology} {name} {}: {told} {wanted}", case.axle);
            assert!(
                (told - wanted).abs() < 1e-9 * wanted.abs().max(1.0),
                "{topology} {name} {}: {told} {wanted}",
                case.axle
            );
        }
    }
}

/// If a study requests an anti-effect that the axle does not have, the program refuses it and names the available ones.
#[test]
fn an_axle_is_told_what_it_does_not_have() {
    let path = crate::support::studies().join("macpherson_solve.toml");
    for (axle, asked, said) in [
        (
            "position=\"front\", drive_torque=\"shafts\", drive_share_front=0.0",
            "anti_squat",
            "undriven front axle",
        ),
        (
            "position=\"front\", drive_torque=\"shafts\", drive_share_front=1.0",
            "anti_squat",
            "use anti_lift",
        ),
        (
            "position=\"rear\", drive_torque=\"shafts\", drive_share_front=1.0",
            "anti_squat",
            "not driven",
        ),
        (
            "position=\"front\", drive_torque=\"shafts\", drive_share_front=0.0",
            "anti_lift",
            "use anti_dive",
        ),
        (
            "position=\"front\", brakes=\"outboard\", brake_share_front=0.6",
            "anti_lift",
            "drive_share_front in [vehicle]",
        ),
        (
            "position=\"rear\", brakes=\"inboard\", brake_share_front=0.6",
            "anti_dive",
            "use anti_lift",
        ),
        (
            "brake_share_front=0.6",
            "anti_lift",
            "position in [vehicle]",
        ),
        (
            "position=\"rear\", brake_share_front=0.6",
            "anti_lift",
            "brakes in [vehicle]",
        ),
    ] {
        let set = [
            format!("vehicle={{wheelbase=2650.0, cg_height=540.0, {axle}}}"),
            format!("outputs={{characteristics=[\"{asked}\"]}}"),
        ];
        let refused = Study::read(&path, &set).unwrap_err().render(false);
        assert!(refused.contains(said), "{axle} {asked}: {refused}");
    }
}
