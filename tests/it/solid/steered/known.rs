//! Tests of steered axles for which a closed-form solution exists: vertical kingpins, horizontal links and horizontal
//! rods.

use super::hyper::{Hyper, Point};
use super::limits::follows;
use super::world::World;
use super::{axle, study};
use hardpoint::analyse::RangeEnd;
use hardpoint::axle::WheelQuantity as W;
use hardpoint::axle::{AxlePose, AxleQuantity as A, AxleSolver, Motion, Placement, Quantity, Read};
use hardpoint::mechanism::{Failure, NoPose};
use hardpoint::model::{Rod, Side};
use hardpoint::optimise::Control;
use hardpoint::study::Study;
use std::path::Path;

/// Height of the lower ball joints, of Panhard rod and drag link, and of the tie rod.
const HEIGHT: f64 = 400.0;
/// Length of the drag link's arm ahead of the kingpin, and of the tie rod's arms behind it.
const ARM: f64 = 150.0;
const KINGPIN: [f64; 2] = [20.0, 660.0];

fn at(x: f64, y: f64, z: f64) -> Point {
    [x, y, z].map(Hyper::constant)
}

/// Axle on horizontal links with vertical kingpins. Its drag link has the direction and the length of the Panhard rod,
/// but is higher by `above`. The ends of the tie rod are inboard of the line from the kingpin straight back, by the
/// distance `inboard`.
fn level(above: f64, inboard: f64) -> World {
    let [x, y] = KINGPIN;
    World {
        points: vec![
            ("lower_link_chassis", at(-800.0, 420.0, 300.0)),
            ("lower_link_axle", at(0.0, 420.0, 300.0)),
            ("upper_link_chassis", at(-600.0, 0.0, 520.0)),
            ("upper_link_axle", at(0.0, 0.0, 520.0)),
            ("panhard_chassis", at(120.0, -450.0, HEIGHT)),
            ("panhard_axle", at(120.0, 470.0, HEIGHT)),
            ("wheel_centre", at(x, 760.0, 375.0)),
            ("kingpin_upper", at(x, y, 480.0)),
            ("kingpin_lower", at(x, y, 280.0)),
            ("drag_link_body", at(x + ARM, y - 920.0, HEIGHT + above)),
            ("drag_link_knuckle", at(x + ARM, y, HEIGHT + above)),
            ("tie_rod_end", at(x - ARM, y - inboard, 330.0)),
        ],
        apart: Vec::new(),
        single: true,
        radius: 375.0,
        direction: [0.0, 1.0, 0.0],
        angles: [0.0; 2],
    }
}

const STEER: [Quantity; 4] = [
    Quantity::Wheel(Side::Left, W::Steer),
    Quantity::Wheel(Side::Right, W::Steer),
    Quantity::Axle(A::RollSteer),
    Quantity::Axle(A::AckermannError),
];

/// Calls `look` with the axle of `world`, with the steering gear displaced by `rack`.
fn steered<R>(
    world: &World,
    rack: f64,
    look: impl FnOnce(&AxlePose, Read<'_>) -> R,
) -> Result<R, NoPose> {
    let own = axle(&study(world, "[motion]\nheave = [0.0]\n"));
    let mut solver = AxleSolver::<3>::new(&own.axle, &STEER, false).unwrap();
    let placed = solver.place(&Placement::Roll {
        heave: 0.0,
        roll: 0.0,
        rack,
    })?;
    let read = solver.read(&placed)?;
    Ok(look(&placed, read))
}

/// Let the drag link be parallel to the Panhard rod and equally long. If it is at the same height, heave and roll do
/// not steer the wheels to first order. If the drag link is higher by `above`, its end on the knuckle moves sideways by
/// `above` times the roll angle. With the arm length `ARM` the wheels steer by -above/ARM per roll angle.
#[test]
fn a_drag_link_steers_in_roll_by_its_height_over_the_panhard_rod() {
    for above in [0.0, 12.0, -30.0] {
        let world = level(above, 0.0);
        let (roll_steer, by_heave) = steered(&world, 0.0, |_, read| {
            let moving = read.state.moving(Motion::Heave);
            let by_heave = [0, 1].map(|side| STEER[side].evaluate(&moving)[1]);
            (STEER[2].evaluate(&read.state), by_heave)
        })
        .unwrap();
        println!("{above}: {roll_steer} {by_heave:?}");
        assert!((roll_steer + above / ARM).abs() < 1e-12, "{roll_steer}");
        assert!(by_heave.iter().all(|by| by.abs() < 1e-14), "{by_heave:?}");
    }
}

/// With arms straight back, the tie rod and the axle form a parallelogram, so both wheels turn equally. The drag link
/// keeps its length, and the wheels keep their heights. If the arms converge behind the axle, the inner wheel turns
/// farther.
#[test]
fn parallelogram_steering_turns_both_wheels_equally() {
    let length = 920.0;
    for gear in [-80.0, -35.0, 10.0, 60.0] {
        let turns = |inboard: f64| {
            steered(&level(0.0, inboard), gear, |placed, read| {
                assert!(placed.travels.iter().all(|z| z.abs() < 1e-12));
                [0, 1].map(|side| STEER[side].evaluate(&read.state))
            })
            .unwrap()
        };
        let [left, right] = turns(0.0);
        assert!((left - right).abs() < 1e-13, "{left} {right}");
        // End of the arm, relative to the drag link's end on the body.
        let (x, y) = (ARM * (left.cos() - 1.0), ARM * left.sin() + length - gear);
        assert!((x.hypot(y) - length).abs() < 1e-11, "{left}");
        assert!(left * gear > 0.0);
        let [left, right] = turns(25.0);
        let (inner, outer) = if gear > 0.0 {
            (left, right)
        } else {
            (-right, -left)
        };
        assert!(inner > outer + 0.1 * inner * inner, "{inner} {outer}");
    }
}

/// The drag link reaches its toggle when it is in line with its arm. Beyond this position there is no pose, and the
/// program names the drag link.
#[test]
fn the_drag_link_is_named_where_it_cannot_follow() {
    // Arm and drag link are in one line, and the drag link's end on the body is at its greatest distance.
    let reach = ARM + 920.0;
    let last = 920.0 - (reach * reach - ARM * ARM).sqrt();
    let world = level(0.0, 0.0);
    for (share, follows) in [(0.999, true), (1.001, false), (1.5, false)] {
        let found = steered(&world, share * last, |_, read| {
            STEER[0].evaluate(&read.state)
        });
        match (found, follows) {
            (Ok(steer), true) => assert!(steer < -1.0, "{steer}"),
            (Err(NoPose::RigidAxle { failure, .. }), false) => {
                assert_eq!(failure, Failure::Toggle(Rod::DragLink));
            }
            (found, _) => panic!("{share}: {found:?}"),
        }
    }
}

/// `limits` finds this end of the range, and names the drag link. Random axles have positions up to the ends of the range
/// and none beyond.
#[test]
fn limits_of_the_drag_link_are_its_toggles() {
    let reach = ARM + 920.0;
    let last = 920.0 - (reach * reach - ARM * ARM).sqrt();
    let own = axle(&study(&level(0.0, 0.0), "[motion]\nheave = [0.0]\n"));
    let [lower, _] = own.axle.limits().unwrap().rack.unwrap();
    // A rod counts as at its toggle if its leverage is below 1e-5. Leverage is the sine of the angle between rod and
    // arm. Let c be the drag link length and a the arm length. Then the toggle is reported before the end of the range,
    // at a distance of a c/(a + c)/2 times the square of the leverage.
    let before = 0.5e-10 * ARM * 920.0 / reach;
    let error = lower.value - last;
    assert!(
        (0.5 * before..2.0 * before).contains(&error),
        "{error:e} {before:e}"
    );
    assert!(matches!(
        lower.end,
        RangeEnd::Toggle {
            rod: Rod::DragLink,
            ..
        }
    ));

    let mut generator = crate::support::random::Random(464);
    for number in 0..3 {
        let world = super::random(&mut generator, number % 2 == 0, 30.0);
        let own = axle(&study(&world, "[motion]\nheave = [0.0]\n"));
        for end in own.axle.limits().unwrap().rack.unwrap() {
            let follows = |share: f64| follows(&own.axle, share * end.value);
            assert!(follows(0.9999), "{number}: {end:?}");
            assert!(!follows(1.0001), "{number}: {end:?}");
        }
    }
}

/// Studies with other axis conventions describe the same axle: only signs of coordinates change.
#[test]
fn the_axes_of_the_study_do_not_matter() {
    let mut generator = crate::support::random::Random(462);
    for number in 0..6 {
        let mut world = super::random(&mut generator, true, 30.0);
        if number % 2 == 0 {
            world.direction = [0.6, 0.8, 0.0];
        }
        let [gear, heave] = [60.0, 40.0].map(|size| size * generator.signed());
        let further = format!(
            "[motion]\nheave = [{heave:?}]\nroll = [2.0]\nrack = [{gear:?}]\n[outputs]\norder = \"velocity\"\n\
                 characteristics = [\"steer\", \"camber\", \"roll_steer\", \"roll_centre_height\"]\n"
        );
        let values = |text: &str| {
            let own = axle(text);
            let found = hardpoint::axle::axle_curves(&own.axle, &own.plan)
                .unwrap()
                .curves;
            let values = found.stations[0].values.clone().into_iter();
            values.map(|v| v.unwrap()).collect::<Vec<_>>()
        };
        let iso = study(&world, &further);
        let own = values(&iso);
        for (frame, signs) in [
            ("sae_j670", [1.0, -1.0, -1.0]),
            ("x_rear", [-1.0, -1.0, 1.0]),
        ] {
            let mut turned = world.clone();
            for (_, point) in &mut turned.points {
                *point = [0, 1, 2].map(|k| point[k].scaled(signs[k]));
            }
            turned.direction = [0, 1, 2].map(|k| world.direction[k] * signs[k]);
            let text = study(&turned, &further).replacen(
                "[suspension]\n",
                &format!("[suspension]\nframe = \"{frame}\"\n"),
                1,
            );
            let found = values(&text);
            assert_eq!(found.len(), own.len(), "{frame}");
            for (k, (found, own)) in found.iter().zip(&own).enumerate() {
                let error = (found - own).abs() / own.abs().max(1.0);
                assert!(error < 1e-10, "{frame} {k}: {found} {own}");
            }
        }
    }
}

/// If a drag link is too high, a tuning lowers it to the height of the Panhard rod. There it does not steer in roll.
#[test]
fn tuning_takes_the_roll_steer_away() {
    let text = study(
        &level(12.0, 0.0),
        "[motion]\nroll = [-1.0, 0.0, 1.0]\n[optimise]\nstarts = 1\ngood_enough = 0.0\nvariables = [{ hardpoints = \
         [\"drag_link_body\", \"drag_link_knuckle\"], axis = \"z\", range = [-30.0, 30.0] }]\ntargets = [{ characteristic = \
         \"roll_steer\", over = \"roll\", at = 0.0, value = 0.0, tolerance = 0.001 }]\n",
    );
    let own = Study::from_text("steered.toml", &text, Path::new("")).unwrap();
    let best = own.tune(Control::default()).unwrap().best.unwrap();
    assert!((best.offsets[0] + 12.0).abs() < 1e-6, "{:?}", best.offsets);
}
