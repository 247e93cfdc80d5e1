//! Tests of instantaneous centres and roll centres at infinity. They have no value, whatever the rounding errors are. If
//! a centre is far away but finite, it has the value of the closed form.

use hardpoint::ask::NoValue;
use hardpoint::axle::{AxleQuantity, AxleSolver, Placement, Quantity};
use hardpoint::{
    Axis, Characteristic, Motion, Order, Sampling, Study, Suspension, SweepControl, Variable,
};
use std::ops::ControlFlow;
use std::path::Path;

const IN_SIDE_VIEW: [Characteristic; 2] = [
    Characteristic::SideViewSwingArm,
    Characteristic::SideViewCentreHeight,
];
const IN_FRONT_VIEW: [Characteristic; 2] = [
    Characteristic::FrontViewSwingArm,
    Characteristic::FrontViewCentreHeight,
];

/// Values at every station.
fn values(suspension: Suspension, asked: &[Characteristic]) -> Vec<Vec<Option<f64>>> {
    let study = Study::of(suspension)
        .over(Motion::travel(-30.0..=30.0, 13).unwrap())
        .asking(asked, Order::Position)
        .unwrap();
    let curves = study.curves().unwrap();
    assert_eq!(curves.failed(), 0);
    let values = |s: hardpoint::Station| s.values.into_iter().map(Result::ok).collect();
    curves.stations.into_iter().map(values).collect()
}

/// Double wishbone that moves in the plane x = 0: the axes of both arms are along x, and the tie rod is in this plane.
fn planar_double_wishbone() -> Suspension {
    Suspension::builder("double_wishbone")
        .hardpoint("upper_arm_front", [150.0, 250.0, 330.0])
        .hardpoint("upper_arm_rear", [-150.0, 250.0, 330.0])
        .hardpoint("upper_ball_joint", [0.0, 545.0, 365.0])
        .hardpoint("lower_arm_front", [150.0, 215.0, 142.0])
        .hardpoint("lower_arm_rear", [-150.0, 215.0, 142.0])
        .hardpoint("lower_ball_joint", [0.0, 575.0, 130.0])
        .hardpoint("tie_rod_inner", [-90.0, 215.0, 142.0])
        .hardpoint("tie_rod_outer", [-90.0, 575.0, 130.0])
        .hardpoint("wheel_centre", [0.0, 620.0, 255.0])
        .wheel_radius(255.0)
        .static_angles_deg(-1.0, 0.0)
        .build()
        .unwrap()
}

/// Trailing arm about a pivot axis. The outer end of the axis is `ahead` farther forward than the inner end.
fn trailing_arm(ahead: f64, rise: f64) -> Suspension {
    Suspension::builder("semi_trailing_arm")
        .hardpoint("arm_pivot_inner", [400.0, 200.0, 260.0])
        .hardpoint("arm_pivot_outer", [400.0 + ahead, 550.0, 260.0 + rise])
        .hardpoint("wheel_centre", [0.0, 740.0, 310.0])
        .wheel_radius(310.0)
        .static_angles_deg(-1.0, 0.0)
        .build()
        .unwrap()
}

#[test]
fn a_wheel_that_does_not_turn_in_a_view_has_no_centre_in_it() {
    for (suspension, asked) in [
        (planar_double_wishbone(), IN_SIDE_VIEW),
        (trailing_arm(0.0, 20.0), IN_FRONT_VIEW),
        (trailing_arm(0.0, 0.0), IN_FRONT_VIEW),
    ] {
        for station in values(suspension, &asked) {
            assert_eq!(station, [None, None]);
        }
    }
}

/// Sweeps solve their designs in SIMD lanes. They report no centre at infinity either.
#[test]
fn sweeps_have_no_centre_there_either() {
    let suspension = trailing_arm(0.0, 20.0);
    let height = Variable::offset(&suspension, "wheel_centre", Axis::Z, -10.0..=10.0).unwrap();
    let study = Study::of(suspension)
        .over(Motion::travel(-30.0..=30.0, 13).unwrap())
        .asking(&IN_FRONT_VIEW, Order::Position)
        .unwrap()
        .sampling(Sampling::Random, 64, 1, &[height]);
    let mut designs = 0;
    let columns = study.sweep(SweepControl::default(), |rows| {
        for design in 0..rows.designs() {
            designs += 1;
            let outputs = rows.outputs(design);
            assert!(!outputs.is_empty() && outputs.iter().all(|v| !v.is_finite()));
        }
        ControlFlow::Continue(())
    });
    assert!(columns.unwrap().len() > 2);
    assert_eq!(designs, 64);
}

/// An arm turns about the unit vector u at the rate w: C_z' = w (u_x (C_y - P_y) - u_y (C_x - P_x)), with the contact
/// point C and a point P on the pivot axis. So the swing arm C_z'/w_x is (C_y - P_y) - (u_y/u_x) (C_x - P_x). The
/// component w_x is at least a ten-millionth of w, so nine of sixteen digits are correct.
#[test]
fn far_centres_are_those_of_the_closed_form() {
    for ahead in [1e-3, 1e-4, -1e-4] {
        let found = values(trailing_arm(ahead, 20.0), &IN_FRONT_VIEW)[6][0].unwrap();
        // The wheel has one degree of camber in the design position, which moves the contact point outboard.
        let contact = 740.0 + 310.0 * 1.0_f64.to_radians().sin();
        let slope = 350.0 / ((400.0 + ahead) - 400.0);
        let expected = (contact - 200.0) + slope * 400.0;
        assert!((found / expected - 1.0).abs() < 1e-8, "{found} {expected}");
    }
}

/// If the arms are level and at equal heights on both sides, the axle has no roll centre in the design position: both
/// normals to the velocities of the contact points are vertical. After a tenth of a micrometre of travel on one side, it
/// has a roll centre.
#[test]
fn upright_normals_have_no_roll_centre() {
    let text = r#"
[suspension]
topology = "double_wishbone"
[suspension.hardpoints]
upper_arm_front  = [ 150.0, 250.0, 365.0]
upper_arm_rear   = [-150.0, 250.0, 365.0]
upper_ball_joint = [  -7.0, 545.0, 365.0]
lower_arm_front  = [ 150.0, 215.0, 130.0]
lower_arm_rear   = [-150.0, 215.0, 130.0]
lower_ball_joint = [   3.0, 575.0, 130.0]
tie_rod_inner    = [ -90.0, 215.0, 157.0]
tie_rod_outer    = [ -93.0, 565.0, 157.0]
wheel_centre     = [   0.0, 620.0, 255.0]
[axle]
right = "mirrored"
[wheel]
radius = 255.0
static_camber = -1.0
[motion]
travel_left = [0.0]
travel_right = [0.0]
ground = "plane"
"#;
    let study = Study::from_text("level.toml", text, Path::new(".")).unwrap();
    let axle = study.axle().unwrap().clone().axle;
    let wanted = [
        AxleQuantity::RollCentreHeight,
        AxleQuantity::RollCentreLateral,
        AxleQuantity::RollCentreMigrationLateral,
    ]
    .map(Quantity::Axle);
    let mut solver = AxleSolver::<3>::new(&axle, &wanted, false).unwrap();
    let mut at = |travels| {
        let placement = Placement::Travels {
            travels,
            rack: 0.0,
            on_plane: true,
        };
        let placed = solver.place(&placement).unwrap();
        let read = solver.read(&placed).unwrap();
        wanted.map(|quantity| quantity.value(&read.state))
    };
    assert_eq!(at([0.0, 0.0]), [Err(NoValue::ParallelNormals); 3]);
    assert_eq!(at([1e-9, 0.0]), [Err(NoValue::ParallelNormals); 3]);
    assert!(at([1e-4, 0.0]).iter().all(Result::is_ok));
}
