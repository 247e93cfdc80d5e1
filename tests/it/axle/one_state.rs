//! Tests that each quantity at a position on plane ground is independent of the coordinates that define the position.

use super::reference::condition;
use super::tuning::study;
use crate::support::larger;
use hardpoint::ask::Unit;
use hardpoint::axle::{Axle, AxleSolver, AxleState, Motion, Placement, Quantity};
use hardpoint::model::Side;
use std::collections::BTreeMap;

/// Axle with its name.
pub(super) type Named = (&'static str, Axle);

/// Axles of struts, links, and wishbones with rockers. The first and the last axle are mirrored; the others have different sides.
pub(super) fn axles() -> [Named; 5] {
    let of = |name, changes: &[(&str, &str)]| study(name, changes).axle().unwrap().clone().axle;
    let lopsided = "[axle.right.hardpoints]\ntie_rod_outer = [-133.0, -687.0, 244.0]\n\
        lower_ball_joint = [9.0, -701.0, 193.0]\nstrut_top = [-31.0, -579.0, 846.0]\n\
        [axle.right.spring]\nrate = 36.0\n\n[steering]";
    let figures = "[tyre]\nrate = 210.0\n\n[wheel]";
    let masses = "[vehicle]\nsprung_mass = 640.0\nunsprung_mass = 90.0\ncg_height = 560.0\nbrakes = \"outboard\"\n\
        brake_share_front = 0.65\ndrive_torque = \"shafts\"\ndrive_share_front = 0.2";
    let wishbones = "[axle.right.hardpoints]\nupper_ball_joint = [-5.0, -542.0, 369.0]\n\
        pushrod_inner = [0.0, -262.0, 452.0]\n\n[steering]\nc_factor = 80.0\n\n[spring]\nrate = 60.0\nforce = 2500.0\n\n\
        [anti_roll_bar]\nrate = 4.0e5\n\n[tyre]\nrate = 120.0\n\n[vehicle]\nwheelbase = 1550.0\nsprung_mass = 130.0\n\
        unsprung_mass = 20.0\ncg_height = 290.0\nposition = \"front\"\nbrakes = \"outboard\"\n\
        brake_share_front = 0.65\ndrive_torque = \"shafts\"\ndrive_share_front = 0.3\n\n[wheel]";
    let pushrod = std::fs::read_to_string(concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/studies/double_wishbone_pushrod.toml"
    ));
    let pushrod = pushrod.unwrap();
    let head = &pushrod[..pushrod.find("[wheel]").unwrap()];
    let text = format!("{head}{wishbones}\nradius = 255.0\n\n[motion]\nroll = 0.0\n");
    let wishbone = hardpoint::study::Study::from_text("wishbone.toml", &text, ".".as_ref());
    let wishbone = wishbone.unwrap_or_else(|e| panic!("{e}\n{text}"));
    let mut all = [
        (
            "struts",
            of(
                "macpherson_axle",
                &[(
                    "strut_lower ",
                    "strut_upper = [-23.0, 599.0, 610.0]\nstrut_lower ",
                )],
            ),
        ),
        (
            "different struts",
            of(
                "macpherson_axle",
                &[
                    (
                        "right = \"mirrored\"               # or [axle.right.hardpoints]: hardpoints that are not the mirror image, with their actual y",
                        "",
                    ),
                    ("[steering]", lopsided),
                ],
            ),
        ),
        (
            "different links",
            of(
                "five_link_axle",
                &[("[wheel]", figures), ("[vehicle]", masses)],
            ),
        ),
        ("different wishbones", wishbone.axle().unwrap().clone().axle),
        (
            "monoshock",
            of(
                "double_wishbone_monoshock",
                &[(
                    "[tyre]",
                    "[heave_bar]\nrate = 1.5e5\ntorque = 2.0e4\n\n[tyre]",
                )],
            ),
        ),
    ];
    for (_, axle) in &mut all {
        axle.left.rim_diameter = Some(430.0);
        if let Some(right) = &mut axle.right {
            right.rim_diameter = Some(430.0);
        }
        axle.setup.constants.rim_diameter = 430.0;
    }
    all
}

/// Quantities of the catalogue that are available for the axle in a state on plane ground.
fn quantities(axle: &Axle) -> Vec<Quantity> {
    let all = Quantity::names().into_iter().flat_map(Quantity::named);
    let has = |quantity: &Quantity| match quantity {
        Quantity::Corner(side, c) => {
            let wheel = axle.suspension(*side);
            c.info().needs.iter().all(|need| need.met_by(wheel))
        }
        _ => true,
    };
    all.filter(has).collect()
}

/// Typical magnitude of a value with this unit, in mm, N and rad.
pub(super) fn natural(unit: Unit) -> f64 {
    match unit {
        Unit::Length | Unit::LengthPerAngle => 1e3,
        Unit::AnglePerLength => 1e-3,
        Unit::Percent | Unit::ForcePerLength => 100.0,
        Unit::Force => 1e4,
        Unit::Torque => 1e7,
        Unit::TorquePerAngle => 1e8,
        _ => 1.0,
    }
}

/// Every quantity of the catalogue has the same value whether roll and heave, both travels, or a load define the
/// position.
#[test]
fn quantities_do_not_depend_on_how_a_position_is_asked_for() {
    let mut worst: BTreeMap<String, (f64, String)> = BTreeMap::new();
    for (name, axle) in axles() {
        let all = quantities(&axle);
        let mut solver = AxleSolver::<3>::new(&axle, &all, true).unwrap();
        let steers = axle.setup.c_factor.is_some();
        let mut moved = 0.0_f64;
        for (heave, roll, rack) in [
            (0.0, 0.4, 0.0),
            (6.0, -2.1, 9.0),
            (-8.0, 1.6, -14.0),
            (3.0, 2.4, 20.0),
        ] {
            let (roll, rack) = (f64::to_radians(roll), if steers { rack } else { 0.0 });
            let at_load = Placement::AtLoad { heave, roll, rack };
            let travels = solver.place(&at_load).unwrap().travels;
            let mean = 0.5 * (travels[0] + travels[1]);
            moved = larger(moved, (mean - heave).abs());
            let by_roll = Placement::Roll {
                heave: mean,
                roll,
                rack,
            };
            let by_travels = Placement::Travels {
                travels,
                rack,
                on_plane: true,
            };
            let [wanted, others @ ..] = [by_roll, by_travels, at_load].map(|placement| {
                let placed = solver.place(&placement).unwrap();
                solver.read(&placed).unwrap()
            });
            for other in &others {
                for quantity in &all {
                    let values = [&wanted, other].map(|read| read.value(*quantity));
                    let [a, b] = match values {
                        [Ok(a), Ok(b)] => [a, b],
                        [Err(a), Err(b)] if a == b => continue,
                        different => panic!("{name} {quantity:?}: {different:?}"),
                    };
                    let size = natural(quantity.info().unit).max(a.abs());
                    let size = size * condition(&quantity.name(), &wanted.state);
                    let entry = worst.entry(quantity.name()).or_default();
                    let deviation = (a - b).abs() / size;
                    // NaN counts as the largest deviation.
                    if deviation.is_nan() || deviation >= entry.0 {
                        *entry = (deviation, format!("{name}: {a} {b}"));
                    }
                }
            }
        }
        assert!(moved > 1e-3, "{name}: the load changes the mean travel");
    }
    for (quantity, (deviation, values)) in &worst {
        println!("{quantity}: {deviation:.1e} ({values})");
    }
    // The test has compared every quantity of the catalogue.
    let compared =
        |name: &str| worst.contains_key(name) || worst.contains_key(&format!("left_{name}"));
    let names = Quantity::names().into_iter();
    let missing: Vec<&str> = names.filter(|name| !compared(name)).collect();
    assert!(missing.is_empty(), "{missing:?}");
    for (quantity, (deviation, values)) in worst {
        assert!(deviation < 1e-11, "{quantity}: {deviation:e}, {values}");
    }
}

/// The stiffness at constant load of a road car's axle equals an independent calculation with twelve digits.
#[test]
fn the_stiffness_at_a_load_is_that_of_an_independent_calculation() {
    let (_, axle) = axles().into_iter().next().unwrap();
    let stiffness = Quantity::named("roll_stiffness_at_load")[0];
    let mut solver = AxleSolver::<3>::new(&axle, &[stiffness], false).unwrap();
    let factor = stiffness.info().unit.printed_factor(axle.left.length_unit);
    for placement in [
        Placement::Travels {
            travels: [-40.0, 55.0],
            rack: 20.0,
            on_plane: true,
        },
        Placement::Roll {
            heave: 7.5,
            roll: 3.590_033_913_604_249_f64.to_radians(),
            rack: 20.0,
        },
    ] {
        let placed = solver.place(&placement).unwrap();
        let found = stiffness.evaluate(&solver.read(&placed).unwrap().state) * factor;
        assert!(
            (found - 1_799.118_246_07).abs() < 1e-8,
            "{placement}: {found}"
        );
    }
}

/// Level pads at one height form a plane. Derivatives with respect to roll on these pads equal those on the plane, also
/// if the sides of the axle differ.
#[test]
fn level_pads_at_one_height_are_a_plane() {
    for (name, axle) in axles() {
        let named = |name: &&str| Quantity::named(name);
        let sought: Vec<Quantity> = [
            "roll_stiffness_at_load",
            "roll_stiffness_on_road",
            "roll_steer",
        ]
        .iter()
        .flat_map(named)
        .collect();
        let mut solver = AxleSolver::<3>::new(&axle, &sought, false).unwrap();
        let mut values = |placement: Placement| {
            let placed = solver.place(&placement).unwrap();
            let state: AxleState<f64> = solver.read(&placed).unwrap().state;
            let values = sought
                .iter()
                .map(|q| q.evaluate(&state))
                .collect::<Vec<_>>();
            (placed.travels, values)
        };
        let level = |heave| Placement::Roll {
            heave,
            roll: 0.0,
            rack: 0.0,
        };
        let (travels, plane) = values(level(-5.0));
        let (_, pads) = values(Placement::Travels {
            travels,
            rack: 0.0,
            on_plane: false,
        });
        for ((a, b), quantity) in plane.iter().zip(&pads).zip(&sought) {
            assert!(
                (a - b).abs() <= 1e-11 * a.abs().max(1e-3),
                "{name} {quantity:?}: {a} {b}"
            );
        }
    }
}

/// At a station that is given by both travels, heave and steering on a plane keep the roll angle constant. The motion of
/// the rack alone keeps both travels constant.
#[test]
fn motions_hold_what_they_say() {
    let (_, axle) = axles().into_iter().nth(1).unwrap();
    let roll = Quantity::named("roll_angle");
    let mut solver = AxleSolver::<3>::new(&axle, &roll, true).unwrap();
    let placement = Placement::Travels {
        travels: [-12.0, 18.0],
        rack: 6.0,
        on_plane: true,
    };
    let placed = solver.place(&placement).unwrap();
    let state = solver.read(&placed).unwrap().state;
    let by = |motion: Motion| {
        let moving = state.moving(motion);
        let travels = Side::ALL.map(|side| state.along(motion, side, [1.0, 0.0]));
        (roll[0].evaluate(&moving)[1], travels, moving.mismatch()[1])
    };
    let (turn, [left, right], mismatch) = by(Motion::Heave);
    assert!(turn == 0.0 && (left + right - 2.0).abs() < 1e-14 && left != right);
    assert!(mismatch.abs() < 1e-13, "{mismatch}");
    let (turn, [left, right], mismatch) = by(Motion::Steering);
    assert!(turn == 0.0 && (left + right).abs() < 1e-14 && left != 0.0);
    assert!(mismatch.abs() < 1e-13, "{mismatch}");
    let (turn, travels, mismatch) = by(Motion::Rack);
    assert!(turn != 0.0 && travels == [0.0, 0.0]);
    assert!(mismatch.abs() < 1e-13, "{mismatch}");
}
