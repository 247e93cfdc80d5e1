//! Names of other programs for the tests of an axle.

use super::super::support::{elastic, fourth_order, with};
use crate::support::rows_by_column;
use hardpoint::compliance::{ElasticAxle, HeldQuantity, WheelFigures, WheelLoads};
use hardpoint::model::Side;
use hardpoint::number::Vector3;
use hardpoint::report::OtherProgram;
use hardpoint::rig::RigTests;
use hardpoint::study::Study;
use std::collections::BTreeMap;

const TESTS: &str = r#"tests = [
  { load = "heave" },
  { load = "roll" },
  { load = "lateral", hold = "wheel_load" },
  { load = "lateral", mode = "opposed", hold = "wheel_load" },
  { load = "lateral", trail = 30.0 },
  { load = "lateral", mode = "single" },
  { load = "lateral", anti_roll_bar = "disconnected" },
  { load = "aligning", hold = "wheel_load" },
  { load = "aligning", mode = "opposed", hold = "wheel_load" },
  { load = "braking", hold = "wheel_load" },
  { load = "braking", mode = "opposed" },
  { load = "traction", hold = "wheel_load" },
  { load = "vertical" },
  { load = "vertical", mode = "opposed" },
]
"#;

/// An axle whose wheels stand upright and straight ahead, so that rotations about x and z are camber and steer. The right
/// wheel's bushings differ.
fn text() -> String {
    let text = with("subframe_axle_compliance.toml", "");
    let (before, after) = text.split_once("tests = [").unwrap();
    let (_, after) = after.split_once("]\n").unwrap();
    let text = format!("{before}{TESTS}{after}");
    let text = text.replace("[  -0.2, 660.0, 309.1]", "[   0.0, 660.0, 310.0]");
    let own = "[axle.right.bushings.lower_arm_rear]\nstiffness = [900.0, 2100.0, 1700.0, 8.0e4, 2.5e5, 2.5e5]\n";
    let one = "heave = { from = -30.0, to = 30.0, steps = 3 }";
    text.replace(one, "heave = [0.0]") + own
}

/// The same axle with x rearward and y to the right.
fn rearward(text: &str) -> String {
    let text = text.replacen("topology", "frame = \"x_rear\"\ntopology", 1);
    let mut turned = String::new();
    for (k, part) in text.split('[').enumerate() {
        let (inside, rest) = part.split_once(']').unwrap_or((part, ""));
        let numbers: Option<Vec<f64>> = inside.split(',').map(|n| n.trim().parse().ok()).collect();
        turned += match k {
            0 => "",
            _ => "[",
        };
        turned += &match numbers.as_deref() {
            Some([x, y, z]) => format!("{:?}, {:?}, {z:?}]{rest}", -x, -y),
            _ => part.to_owned(),
        };
    }
    turned
}

/// Changes of both wheels per newton, or per newton times length, by loads in the frame of each side.
fn response(study: &Study, loads: [WheelLoads; 2], step: f64) -> [WheelFigures; 2] {
    let both = study.axle().unwrap();
    let elastic = both.axle.elastic.as_ref().unwrap();
    let suspension = &both.axle.left;
    let design = &suspension.design[..];
    let axle = ElasticAxle::of([suspension; 2], [design; 2], &elastic.parts).unwrap();
    let station = axle.at([0.0; 2], 0.0).unwrap();
    let at = [-2.0, -1.0, 1.0, 2.0].map(|steps: f64| {
        let scaled = loads.map(|of| WheelLoads {
            contact: of.contact * (steps * step),
            centre: of.centre * (steps * step),
            moment: of.moment * (steps * step),
            ..of
        });
        let held = HeldQuantity::WheelLoad;
        axle.loaded_about(&station, &station, &scaled, held)
            .unwrap()
    });
    Side::ALL.map(|side| {
        let figures = at.map(|at| axle.figures(&at, side));
        let slope = |of: &dyn Fn(&WheelFigures) -> f64| {
            fourth_order(figures.each_ref().map(|figures| of(figures)), step)
        };
        WheelFigures {
            toe: slope(&|f| f.toe),
            camber: slope(&|f| f.camber),
            spin: slope(&|f| f.spin),
            centre: Vector3::new(
                slope(&|f| f.centre.x),
                slope(&|f| f.centre.y),
                slope(&|f| f.centre.z),
            ),
            ..figures[0]
        }
    })
}

/// Values in words of the vehicle: each by loads of one unit on both wheels, in degrees and mm.
struct Vehicle {
    by: [WheelFigures; 2],
}

impl Vehicle {
    fn steer_to_left(&self, side: usize) -> f64 {
        let to_left = [-1.0, 1.0][side];
        (to_left * self.by[side].toe).to_degrees()
    }

    /// Rotation about an axis to the rear: the top of the wheel moves to the left.
    fn lean_to_left(&self, side: usize) -> f64 {
        let outboard = [1.0, -1.0][side];
        (outboard * self.by[side].camber).to_degrees()
    }

    fn shift_to_right(&self, side: usize) -> f64 {
        [-1.0, 1.0][side] * self.by[side].centre.y
    }

    fn nose_up(&self, side: usize) -> f64 {
        self.by[side].spin.to_degrees()
    }

    fn rise(&self, side: usize) -> f64 {
        self.by[side].centre.z
    }
}

fn contact(x: f64, y: f64) -> WheelLoads {
    WheelLoads {
        contact: Vector3::new(x, y, 0.0),
        ..WheelLoads::none(0.0)
    }
}

fn centre(x: f64, z: f64) -> WheelLoads {
    WheelLoads {
        centre: Vector3::new(x, 0.0, z),
        ..WheelLoads::none(0.0)
    }
}

fn about_z(moment: f64) -> WheelLoads {
    WheelLoads {
        moment: Vector3::new(0.0, 0.0, moment),
        ..WheelLoads::none(0.0)
    }
}

/// Names with the expected values of MotionView and of Adams Car.
fn expected(study: &Study) -> [Vec<(String, f64)>; 2] {
    let by = |loads, step| Vehicle {
        by: response(study, loads, step),
    };
    // The frame of the right wheel is a mirror image: its y points to the right of the car.
    let to_right = by([contact(0.0, -1.0), contact(0.0, 1.0)], 100.0);
    let inboard = by([contact(0.0, -1.0), contact(0.0, -1.0)], 100.0);
    let turned_left = by([about_z(1.0), about_z(-1.0)], 1e4);
    let turned_in_mirror = by([about_z(1.0), about_z(1.0)], 1e4);
    let rearward = by([contact(-1.0, 0.0); 2], 100.0);
    let rearward_at_centre = by([centre(-1.0, 0.0); 2], 100.0);
    let up = by([centre(0.0, 1.0); 2], 100.0);
    let rolled = by([centre(0.0, 1.0), centre(0.0, -1.0)], 100.0);
    let (tyre, track) = (220.0, 2.0 * 760.0);
    let height = rolled.rise(0) - rolled.rise(1);
    let roll_steer = |side: usize| {
        rolled.steer_to_left(side).to_radians() * track / (height + 2.0 / tyre) * 100.0
    };
    let (mut altair, mut adams) = (Vec::new(), Vec::new());
    for (k, (side, small)) in [("Left", "left"), ("Right", "right")]
        .into_iter()
        .enumerate()
    {
        for (word, loads, moments) in [
            ("Parallel", &to_right, &turned_left),
            ("Converging", &inboard, &turned_in_mirror),
        ] {
            altair.extend([
                (
                    format!("{side} {word} Lateral Force Steer"),
                    1000.0 * loads.steer_to_left(k),
                ),
                (
                    format!("{side} {word} Lateral Force Camber"),
                    1000.0 * loads.lean_to_left(k),
                ),
                (
                    format!("{side} {word} Lateral Force Deflection"),
                    1000.0 * loads.shift_to_right(k),
                ),
                (
                    format!("{side} {word} Aligning Torque Steer"),
                    1e5 * moments.steer_to_left(k),
                ),
            ]);
        }
        for (word, loads) in [("TP", &rearward), ("WC", &rearward_at_centre)] {
            let steer = format!("{side} {word} Longitudinal Compliance Steer");
            let caster = format!("{side} {word} Longitudinal Caster Compliance");
            altair.push((steer, 1000.0 * loads.steer_to_left(k)));
            altair.push((caster, 1000.0 * loads.nose_up(k)));
        }
        let per_mm = |angle: f64| angle / up.rise(k);
        let outboard = [1.0, -1.0][k] * up.lean_to_left(k);
        let rate = 1.0 / up.rise(k);
        altair.extend([
            (
                format!("{side} Wheel Ride Steer"),
                1000.0 * per_mm(up.steer_to_left(k)),
            ),
            (
                format!("{side} Ride Caster"),
                1000.0 * per_mm(up.nose_up(k)),
            ),
            (
                format!("{side} Wheel Ride Camber"),
                1000.0 * per_mm(outboard),
            ),
            (format!("{side} Wheel Rate"), rate),
            (format!("{side} Ride Rate"), 1.0 / (1.0 / rate + 1.0 / tyre)),
            (format!("{side} Wheel Roll Steer"), roll_steer(k)),
        ]);
        adams.extend([
            (
                format!("alt_steer_compliance.{small}"),
                turned_left.steer_to_left(k),
            ),
            (format!("wheel_rate.{small}"), rate),
            (format!("Camber Change, {small}"), per_mm(outboard)),
            (format!("Caster Change, {small}"), per_mm(up.nose_up(k))),
        ]);
    }
    let mean = 0.5 * (to_right.steer_to_left(0) + to_right.steer_to_left(1));
    altair.push((
        "Average Parallel Lateral Force Steer".to_owned(),
        1000.0 * mean,
    ));
    let rate = track * track / height * std::f64::consts::PI / 180.0 / 1000.0;
    altair.push(("Suspension Roll Rate".to_owned(), rate));
    adams.push((
        "alt_camber_compliance.left".to_owned(),
        turned_left.lean_to_left(0),
    ));
    let mean = 0.5 * (roll_steer(0) + roll_steer(1));
    adams.push(("Percentage Roll Steer".to_owned(), mean));
    [altair, adams]
}

/// Rows of `kc.csv` with another program's names.
fn named(study: &Study, program: OtherProgram) -> Vec<BTreeMap<String, String>> {
    let tests = RigTests::of(study, Some(program)).unwrap();
    let rows = rows_by_column(&tests.results.kc_csv());
    let has_name = |row: &BTreeMap<String, String>| !row["other_name"].is_empty();
    rows.into_iter().filter(has_name).collect()
}

/// Each value is the motion of the vehicle that the words of its definition describe, in any axes of the study.
#[test]
fn values_of_other_programs_are_motions_by_loads_on_both_wheels() {
    let text = text();
    let expected = expected(&elastic(&text));
    for text in [text.clone(), rearward(&text)] {
        let study = elastic(&text);
        let programs = [OtherProgram::Altair, OtherProgram::Adams];
        for (program, expected) in programs.into_iter().zip(&expected) {
            let rows = named(&study, program);
            let mut names: Vec<&str> = rows.iter().map(|row| &row["other_name"][..]).collect();
            let mut known: Vec<&str> = expected.iter().map(|(name, _)| &name[..]).collect();
            names.sort_unstable();
            known.sort_unstable();
            assert_eq!(names, known);
            for row in rows {
                let (name, expected) = expected
                    .iter()
                    .find(|(name, _)| *name == row["other_name"])
                    .unwrap();
                let found: f64 = row["other_value"].parse().unwrap();
                let off = (found - expected).abs();
                assert!(
                    off < 1e-6 * expected.abs().max(1e-6),
                    "{name}: {found} {expected}"
                );
            }
        }
    }
}

/// Signs against ours, as the manual's table has them: our tests hold the wheel load here, and the wheels stand upright.
#[test]
fn signs_against_ours_are_those_of_the_manual() {
    let study = elastic(&text());
    let mut seen = 0;
    for (program, quantity, mode, signs) in [
        (
            OtherProgram::Altair,
            "toe_by_lateral_force",
            "parallel",
            [-1.0, -1.0],
        ),
        (
            OtherProgram::Altair,
            "toe_by_lateral_force",
            "opposed",
            [-1.0, 1.0],
        ),
        (
            OtherProgram::Altair,
            "camber_by_lateral_force",
            "parallel",
            [1.0, 1.0],
        ),
        (
            OtherProgram::Altair,
            "camber_by_lateral_force",
            "opposed",
            [1.0, -1.0],
        ),
        (
            OtherProgram::Altair,
            "wheel_centre_by_lateral_force",
            "parallel",
            [1.0, 1.0],
        ),
        (
            OtherProgram::Altair,
            "wheel_centre_by_lateral_force",
            "opposed",
            [1.0, -1.0],
        ),
        (
            OtherProgram::Altair,
            "toe_by_aligning_moment",
            "parallel",
            [-1.0, -1.0],
        ),
        (
            OtherProgram::Altair,
            "toe_by_aligning_moment",
            "opposed",
            [-1.0, 1.0],
        ),
        (
            OtherProgram::Altair,
            "toe_by_braking",
            "parallel",
            [-1.0, 1.0],
        ),
        (
            OtherProgram::Altair,
            "toe_by_traction",
            "parallel",
            [1.0, -1.0],
        ),
        (
            OtherProgram::Altair,
            "spin_by_braking",
            "parallel",
            [1.0, 1.0],
        ),
        (
            OtherProgram::Altair,
            "spin_by_traction",
            "parallel",
            [-1.0, -1.0],
        ),
        (
            OtherProgram::Adams,
            "toe_by_aligning_moment",
            "parallel",
            [-1.0, -1.0],
        ),
        (
            OtherProgram::Adams,
            "compliant_wheel_rate",
            "parallel",
            [1.0, 1.0],
        ),
    ] {
        for row in named(&study, program) {
            if row["quantity"] != quantity || row["mode"] != mode {
                continue;
            }
            let sign = signs[usize::from(row["wheel"] == "right")];
            let (own, other): (f64, f64) = (
                row["value"].parse().unwrap(),
                row["other_value"].parse().unwrap(),
            );
            let factor = match &row["other_unit"][..] {
                "deg/(N mm)" => 1e-5,
                _ => 1.0,
            };
            let off = (other - sign * factor * own).abs();
            assert!(off < 1e-9 * other.abs(), "{quantity} {mode}: {other} {own}");
            seen += 1;
        }
    }
    assert_eq!(seen, 28);
}
