//! Tests of steered solid axles against an independent formulation, and in cases with closed-form solutions.

mod hyper;
mod known;
mod lanes;
mod limits;
mod loads;
mod refused;
mod virtual_work;
mod world;

use super::axle;
use crate::support::random::Random;
use hardpoint::ask::NoValue;
use hardpoint::axle::axle_curves;
use hardpoint::model::Axis;
use hyper::Hyper;
use std::fmt::Write as _;
use world::{At, Travels, World};

/// Random steered front axle, with every point moved by up to `by`.
pub fn random(random: &mut Random, single: bool, by: f64) -> World {
    let mut near = |p: [f64; 3]| p.map(|c| Hyper::constant(c + by * random.signed()));
    let mut points = vec![
        ("lower_link_chassis", near([-840.0, 420.0, 385.0])),
        ("lower_link_axle", near([-5.0, 430.0, 305.0])),
        ("wheel_centre", near([0.0, 760.0, 375.0])),
        ("kingpin_upper", near([-18.0, 650.0, 470.0])),
        ("kingpin_lower", near([12.0, 675.0, 280.0])),
        ("drag_link_body", near([190.0, -420.0, 545.0])),
        ("drag_link_knuckle", near([160.0, 560.0, 480.0])),
        ("tie_rod_end", near([-150.0, 610.0, 330.0])),
    ];
    if single {
        points.extend([
            ("upper_link_chassis", near([-640.0, 270.0, 525.0])),
            ("upper_link_axle", near([-15.0, 250.0, 555.0])),
            ("panhard_chassis", near([130.0, -480.0, 560.0])),
            ("panhard_axle", near([120.0, 470.0, 500.0])),
        ])
    } else {
        points.extend([
            ("upper_link_chassis", near([-640.0, 470.0, 525.0])),
            ("upper_link_axle", near([-15.0, 150.0, 555.0])),
        ])
    }
    World {
        points,
        apart: Vec::new(),
        single,
        radius: 375.0,
        direction: [0.0, 1.0, 0.0],
        angles: [0.0; 2],
    }
}

/// Study of an axle.
pub fn study(world: &World, further: &str) -> String {
    let mut text = String::from("[suspension]\ntopology = \"solid_axle\"\n");
    if world.single {
        text += "single = [\"upper_link\"]\n";
    }
    text += "[suspension.hardpoints]\n";
    for (name, point) in &world.points {
        let [x, y, z] = point.map(|c| c.value);
        let _ = writeln!(text, "{name} = [{x:?}, {y:?}, {z:?}]");
    }
    if !world.apart.is_empty() {
        text += "[axle.right.hardpoints]\n";
    }
    for (name, _) in &world.apart {
        let [x, y, z] = world.of(1, name).map(|c| c.value);
        let _ = writeln!(text, "{name} = [{x:?}, {y:?}, {z:?}]");
    }
    let [x, y, z] = world.direction;
    let [camber, toe] = world.angles.map(f64::to_degrees);
    let _ = writeln!(
        text,
        "[wheel]\nradius = {:?}\nstatic_camber = {camber:?}\nstatic_toe = {toe:?}\n\
         [vehicle]\nwheelbase = 2700.0\ncg_height = 640.0\nposition = \"front\"\nbrakes = \"outboard\"\n\
         brake_share_front = 0.6\ndrive_torque = \"carrier\"\ndrive_share_front = 0.5\n\
         [steering]\ndirection = [{x:?}, {y:?}, {z:?}]",
        world.radius
    );
    text + further
}

/// Points that both halves have.
const RIGHT: [&str; 6] = [
    "lower_link_chassis",
    "lower_link_axle",
    "wheel_centre",
    "kingpin_upper",
    "kingpin_lower",
    "tie_rod_end",
];

const OUTPUTS: &str = "[outputs]\norder = \"acceleration\"\npoints = [\"wheel_centre\"]\ncharacteristics = [\"toe\", \"steer\", \
    \"camber\", \"caster\", \"kingpin_inclination\", \"scrub_radius\", \"kingpin_offset\", \"mean_steer\", \"axle_steer\", \
    \"pinion_angle\", \"roll_steer\"]\n";

/// Heave, roll (rad) and displacement of the steering gear.
type Place = [f64; 3];

/// Position with a derivative along `first` and another derivative along `second`: 0 is heave, 1 roll, 2 the steering
/// gear.
fn at(place: Place, first: Option<usize>, second: Option<usize>) -> At {
    let number = |k: usize| Hyper {
        first: f64::from(first == Some(k)),
        second: f64::from(second == Some(k)),
        ..Hyper::constant(place[k])
    };
    At {
        travels: Travels::OnPlane,
        heave: number(0),
        roll: number(1),
        gear: number(2),
    }
}

/// Largest error of each kind, with the name of the quantity. An error is relative to the value, or to 1 for values below 1.
#[derive(Default)]
struct Worst {
    /// Number of axles with compared gradients.
    with_gradients: usize,
    value: (f64, String),
    rate: (f64, String),
    second: (f64, String),
    gradient: (f64, String),
}

fn note(worst: &mut (f64, String), found: f64, expected: f64, what: impl FnOnce() -> String) {
    let error = (found - expected).abs() / expected.abs().max(1.0);
    if error.is_nan() || error > worst.0 {
        *worst = (error, format!("{}: {found} {expected}", what()));
    }
}

/// Returns the quantities of the independent formulation, and the columns `roll_steer`: the derivatives of steer with
/// respect to roll. Roll is the second direction of the derivatives.
fn expected(world: &World, place: Place, first: Option<usize>) -> Option<Vec<(String, Hyper)>> {
    let solved = world.solve(&at(place, first, Some(1)))?;
    let mut all = solved.quantities();
    let degrees = 1f64.to_radians().recip();
    for word in ["left_", "right_", ""] {
        let of = match word {
            "" => "mean_steer_deg".to_owned(),
            side => format!("{side}steer_deg"),
        };
        let steer = all.iter().find(|(name, _)| *name == of).unwrap().1;
        let rate = Hyper {
            value: steer.second / degrees,
            first: steer.both / degrees,
            ..Hyper::constant(0.0)
        };
        all.push((format!("{word}roll_steer_deg_per_deg"), rate));
    }
    Some(all)
}

/// Compares one axle in one position. Returns false if one of the two programs does not reach the position.
fn compare(world: &World, place: Place, gradients: bool, worst: &mut Worst) -> bool {
    let [heave, roll, gear] = place;
    let Some(values) = expected(world, place, None) else {
        return false;
    };
    let motion = format!(
        "[motion]\nheave = [{heave:?}]\nroll = [{:?}]\nrack = [{gear:?}]\n{OUTPUTS}",
        roll.to_degrees()
    );
    let mut text = study(world, &motion);
    if gradients {
        text += "sensitivities = true\n";
    }
    let own = axle(&text);
    let found = axle_curves(&own.axle, &own.plan).unwrap().curves;
    let station = &found.stations[0];
    let column = |name: &str| {
        let named = found.columns.iter().position(|c| c.name == name);
        named.unwrap_or_else(|| panic!("{name} of {:?}", found.columns))
    };
    // Near its toggle, a tie rod can block the path of the axle to this pose, although the pose itself exists.
    if station.values[column("left_toe_deg")] == Err(NoValue::NoPose) {
        return false;
    }
    let value = |name: &str| *station.values[column(name)].as_ref().expect(name);
    let is_known = |name: &str| found.columns.iter().any(|c| c.name == name);
    let compared = values.iter().filter(|(name, _)| is_known(name)).count();
    assert!(compared > 25, "{compared}");
    let named = |unit: &str, name: &str, by: &str| {
        let (stem, own) = ["_deg_per_deg", "_deg", "_mm"]
            .iter()
            .find_map(|unit| Some((name.strip_suffix(unit)?, *unit)))
            .unwrap();
        format!("{stem}_by_{by}{own}_{unit}")
    };
    for (name, expected) in values.iter().filter(|(name, _)| is_known(name)) {
        note(&mut worst.value, value(name), expected.value, || {
            name.clone()
        });
    }
    for (direction, by, unit, factor) in [
        (0, "heave", "per_mm", 1.0),
        (1, "roll", "per_deg", 1f64.to_radians()),
        (2, "rack", "per_mm", 1.0),
    ] {
        let rates = expected(world, place, Some(direction)).unwrap();
        for (name, expected) in rates.iter().filter(|(name, _)| is_known(name)) {
            let column = named(unit, name, by);
            let what = || column.clone();
            note(
                &mut worst.rate,
                value(&column),
                expected.first * factor,
                what,
            );
        }
    }
    let twice = world.solve(&at(place, Some(2), Some(2))).unwrap();
    let mut looked_at = 0;
    for (name, expected) in twice.quantities().iter().filter(|(name, _)| is_known(name)) {
        let column = named("per_mm2", name, "rack_d2");
        let what = || column.clone();
        note(&mut worst.second, value(&column), expected.both, what);
        looked_at += usize::from(expected.both.abs() > 1e-6);
    }
    assert!(looked_at > 10, "{looked_at}");
    assert!(!is_known("roll_steer_by_rack_d2_deg_per_deg_per_mm2"));
    if gradients {
        compare_gradients(world, place, &found, worst);
    }
    true
}

/// Knuckles move as rigid bodies. With respect to the drag link's motion, a knuckle has an angular velocity w and an
/// angular acceleration a. Three points of the knuckle must agree with them: for vectors r between these points, r' = w x
/// r and r'' = a x r + w x (w x r).
#[test]
fn knuckles_turn_as_rigid_bodies() {
    let mut generator = Random(479);
    for number in 0..8 {
        let world = random(&mut generator, number % 2 == 0, 30.0);
        let motion = format!(
            "[motion]\nheave = [{:?}]\nroll = [{:?}]\nrack = [{:?}]\n[outputs]\norder = \"acceleration\"\nknuckle = true\n\
             characteristics = [\"toe\"]\npoints = [\"wheel_centre\", \"tie_rod_end\", \"drag_link_knuckle\"]\n",
            30.0 * generator.signed(),
            3.0 * generator.signed(),
            50.0 * generator.signed()
        );
        let own = axle(&study(&world, &motion));
        let curves = axle_curves(&own.axle, &own.plan).unwrap().curves;
        let vector = |stem: &str, end: &str| {
            ["x", "y", "z"].map(|axis| {
                let name = format!("{stem}_{axis}{end}");
                let column = curves.columns.iter().position(|c| c.name == name);
                let column = column.unwrap_or_else(|| panic!("{name} of {:?}", curves.columns));
                curves.stations[0].value(column).unwrap()
            })
        };
        let turn = vector("left_knuckle_omega", "_by_rack_rad_per_mm");
        let faster = vector("left_knuckle_alpha", "_by_rack_rad_per_mm2");
        let cross = |a: [f64; 3], b: [f64; 3]| {
            [0, 1, 2].map(|i| a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3])
        };
        let place = |point: &str| {
            let stem = format!("left_{point}");
            ["_mm", "_by_rack_mm_per_mm", "_by_rack_d2_mm_per_mm2"].map(|end| vector(&stem, end))
        };
        let base = place("wheel_centre");
        for point in ["tie_rod_end", "drag_link_knuckle"] {
            let other = place(point);
            let [r, v, a] = [0, 1, 2].map(|k| [0, 1, 2].map(|i| other[k][i] - base[k][i]));
            let (first, whirl) = (cross(turn, r), cross(turn, cross(turn, r)));
            let second = cross(faster, r);
            for i in 0..3 {
                assert!((v[i] - first[i]).abs() < 1e-10, "{point}: {v:?} {first:?}");
                let expected = second[i] + whirl[i];
                assert!((a[i] - expected).abs() < 1e-11, "{point}: {a:?} {expected}");
            }
        }
        assert!(
            turn[2].abs() > 1e-3 && faster[2].abs() > 1e-6,
            "{turn:?} {faster:?}"
        );
    }
}

/// Compares derivatives with respect to every hardpoint coordinate.
fn compare_gradients(
    world: &World,
    place: Place,
    found: &hardpoint::curves::Curves,
    worst: &mut Worst,
) {
    let own = axle(&study(world, "[motion]\nheave = [0.0]\n"));
    let mut compared = 0;
    for number in 0..world.points.len() {
        for axis in 0..3 {
            let mut moved = world.clone();
            moved.points[number].1[axis].first = 1.0;
            let name = world.points[number].0;
            let id = own.axle.left.mechanism.point(name).unwrap();
            let by_point = expected(&moved, place, None).unwrap();
            for (column, known) in found.columns.iter().enumerate() {
                let Some((_, expected)) = by_point.iter().find(|(name, _)| *name == known.name)
                else {
                    continue;
                };
                let at = |s: &&hardpoint::curves::Sensitivity| {
                    s.column == column && s.point == id && s.axis == Axis::ALL[axis]
                };
                let sensitivity = found.sensitivities.iter().find(at).unwrap();
                let what = || format!("{} by {name} {axis}", known.name);
                note(&mut worst.gradient, sensitivity.value, expected.first, what);
                compared += 1;
            }
        }
    }
    // Every coordinate changes more than 25 quantities.
    assert!(compared > 3 * 25 * world.points.len(), "{compared}");
    worst.with_gradients += 1;
}

#[test]
fn everything_is_that_of_another_formulation() {
    compare_all(60);
}

#[test]
#[ignore = "1,000 axles"]
fn everything_of_a_thousand_axles_is_that_of_another_formulation() {
    compare_all(1000);
}

/// Compares positions, quantities and their derivatives with respect to heave, roll and steering gear. For every twelfth
/// axle, also compares derivatives with respect to every hardpoint.
fn compare_all(axles: usize) {
    let mut generator = Random(461);
    let (mut worst, mut solved) = (Worst::default(), 0);
    for number in 0..axles {
        let mut world = random(&mut generator, number % 2 == 0, 30.0);
        if number % 3 == 0 {
            let way = [0.0; 3].map(|_| generator.signed());
            let way = [way[0], 2.0 + way[1], way[2]];
            let length = way.iter().map(|c| c * c).sum::<f64>().sqrt();
            world.direction = way.map(|c| c / length);
            world.angles = [0.03 * generator.signed(), 0.02 * generator.signed()];
        }
        if number % 4 < 2 {
            // The right half differs, including the height of its wheel centre.
            world.apart = RIGHT
                .iter()
                .map(|name| (*name, [0.0; 3].map(|_| 15.0 * generator.signed())))
                .collect();
        }
        let place = [
            50.0 * generator.signed(),
            0.07 * generator.signed(),
            70.0 * generator.signed(),
        ];
        // Each gradient needs a solution for every coordinate.
        solved += usize::from(compare(&world, place, number % 12 == 0, &mut worst));
    }
    println!("{solved} of {axles} axles");
    println!("values {:?}", worst.value);
    println!("rates {:?}", worst.rate);
    println!("second derivatives {:?}", worst.second);
    println!("gradients {:?}", worst.gradient);
    assert!(10 * solved > 9 * axles, "{solved}");
    assert!(
        24 * worst.with_gradients > axles,
        "{}",
        worst.with_gradients
    );
    // In both programs, the residuals of the equations are up to 1e-12 mm, and condition numbers are below 1e3. The error
    // of derivatives is larger by another factor of the condition number.
    assert!(worst.value.0 < 1e-9, "{:?}", worst.value);
    assert!(worst.rate.0 < 1e-9, "{:?}", worst.rate);
    assert!(worst.second.0 < 1e-9, "{:?}", worst.second);
    assert!(worst.gradient.0 < 1e-9, "{:?}", worst.gradient);
}
