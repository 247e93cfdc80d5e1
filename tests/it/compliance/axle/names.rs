//! Tests of axle test results in `kc.csv` with the names and definitions of other programs.

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

/// Axle whose wheels are upright and straight ahead, so that rotations about x and z are camber and steer. The bushings
/// of the right wheel differ.
fn text() -> String {
    let text = with("subframe_axle_compliance.toml", "");
    let (before, after) = text.split_once("tests = [").unwrap();
    let (_, after) = after.split_once("]\n").unwrap();
    let text = format!("{before}{TESTS}{after}");
    let text = text.replace("[  -0.2, 660.0, 309.1]", "[   0.0, 660.0, 310.0]");
    let own = "[axle.right.bushings.lower_arm_rear]\nstiffness = [900.0, 2100.0, 1700.0, 8.0e4, 2.5e5, 2.5e5]\n";
    let one = "heave = { from = -30.0, to = 30.0, steps = 3 }";
    let text = text.replace(one, "heave = [0.0]");
    text.replace("right = \"mirrored\"\n", "") + own
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

/// Returns derivatives of the positions and angles of both wheels with respect to a common factor on `loads`. Loads are
/// in the frame of each side.
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
        let slope =
            |of: &dyn Fn(&WheelFigures) -> f64| fourth_order(figures.each_ref().map(of), step);
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

/// Displacements of both wheels in vehicle axes, in degrees and mm. Unit loads act on both wheels.
struct Vehicle {
    by: [WheelFigures; 2],
}

impl Vehicle {
    fn steer_to_left(&self, side: usize) -> f64 {
        let to_left = [-1.0, 1.0][side];
        (to_left * self.by[side].toe).to_degrees()
    }

    /// Rotation about a rearward axis, positive if the top of the wheel moves to the left.
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

/// Responses of both wheels to the loads of all definitions of other programs.
struct Responses {
    to_right: Vehicle,
    inboard: Vehicle,
    turned_left: Vehicle,
    turned_in_mirror: Vehicle,
    rearward: Vehicle,
    rearward_at_centre: Vehicle,
    up: Vehicle,
    rolled: Vehicle,
}

const TYRE: f64 = 220.0;
const TRACK: f64 = 2.0 * 760.0;

impl Responses {
    fn of(study: &Study) -> Self {
        let by = |loads, step| Vehicle {
            by: response(study, loads, step),
        };
        // The frame of the right wheel is mirrored: its y points to the right of the car.
        Responses {
            to_right: by([contact(0.0, -1.0), contact(0.0, 1.0)], 100.0),
            inboard: by([contact(0.0, -1.0), contact(0.0, -1.0)], 100.0),
            turned_left: by([about_z(1.0), about_z(-1.0)], 1e4),
            turned_in_mirror: by([about_z(1.0), about_z(1.0)], 1e4),
            rearward: by([contact(-1.0, 0.0); 2], 100.0),
            rearward_at_centre: by([centre(-1.0, 0.0); 2], 100.0),
            up: by([centre(0.0, 1.0); 2], 100.0),
            rolled: by([centre(0.0, 1.0), centre(0.0, -1.0)], 100.0),
        }
    }

    /// Height of the left wheel centre above the right one.
    fn height(&self) -> f64 {
        self.rolled.rise(0) - self.rolled.rise(1)
    }

    fn roll_steer(&self, side: usize) -> f64 {
        let steer = self.rolled.steer_to_left(side).to_radians();
        steer * TRACK / (self.height() + 2.0 / TYRE) * 100.0
    }

    /// Change of an angle per height of the wheel centre.
    fn per_mm(&self, side: usize, angle: impl Fn(&Vehicle) -> f64) -> f64 {
        angle(&self.up) / self.up.rise(side)
    }

    fn ride_camber(&self, side: usize) -> f64 {
        let outboard = [1.0, -1.0][side];
        self.per_mm(side, |up| outboard * up.lean_to_left(side))
    }

    fn ride_caster(&self, side: usize) -> f64 {
        self.per_mm(side, |up| up.nose_up(side))
    }

    fn mean(&self, of: impl Fn(&Self, usize) -> f64) -> f64 {
        0.5 * (of(self, 0) + of(self, 1))
    }

    /// Values of a wheel with MotionView's names, without the name of the wheel.
    fn altair(&self, side: usize) -> Vec<(String, f64)> {
        let mut found = Vec::new();
        for (word, loads, moments) in [
            ("Parallel", &self.to_right, &self.turned_left),
            ("Converging", &self.inboard, &self.turned_in_mirror),
        ] {
            let own = [
                ("Lateral Force Steer", 1000.0 * loads.steer_to_left(side)),
                ("Lateral Force Camber", 1000.0 * loads.lean_to_left(side)),
                (
                    "Lateral Force Deflection",
                    1000.0 * loads.shift_to_right(side),
                ),
                ("Aligning Torque Steer", 1e5 * moments.steer_to_left(side)),
            ];
            found.extend(own.map(|(name, value)| (format!("{word} {name}"), value)));
        }
        for (word, loads) in [("TP", &self.rearward), ("WC", &self.rearward_at_centre)] {
            let steer = format!("{word} Longitudinal Compliance Steer");
            let caster = format!("{word} Longitudinal Caster Compliance");
            found.push((steer, 1000.0 * loads.steer_to_left(side)));
            found.push((caster, 1000.0 * loads.nose_up(side)));
        }
        let steer = self.per_mm(side, |up| up.steer_to_left(side));
        let rate = 1.0 / self.up.rise(side);
        let own = [
            ("Wheel Ride Steer", 1000.0 * steer),
            ("Ride Caster", 1000.0 * self.ride_caster(side)),
            ("Wheel Ride Camber", 1000.0 * self.ride_camber(side)),
            ("Wheel Rate", rate),
            ("Ride Rate", 1.0 / (1.0 / rate + 1.0 / TYRE)),
            ("Wheel Roll Steer", self.roll_steer(side)),
        ];
        found.extend(own.map(|(name, value)| (name.to_owned(), value)));
        found
    }

    /// Values of a wheel with the names of Adams Car.
    fn adams(&self, side: usize) -> Vec<(String, f64)> {
        let word = ["left", "right"][side];
        vec![
            (
                format!("alt_steer_compliance.{word}"),
                self.turned_left.steer_to_left(side),
            ),
            (format!("wheel_rate.{word}"), 1.0 / self.up.rise(side)),
            (format!("Camber Change, {word}"), self.ride_camber(side)),
            (format!("Caster Change, {word}"), self.ride_caster(side)),
        ]
    }
}

/// Names with the expected values of MotionView and of Adams Car.
fn expected(study: &Study) -> [Vec<(String, f64)>; 2] {
    let of = Responses::of(study);
    let rate = TRACK * TRACK / of.height() * std::f64::consts::PI / 180.0 / 1000.0;
    let steer = of.mean(|of, side| of.to_right.steer_to_left(side));
    let mut altair = vec![
        (
            "Average Parallel Lateral Force Steer".to_owned(),
            1000.0 * steer,
        ),
        ("Suspension Roll Rate".to_owned(), rate),
    ];
    let camber = of.turned_left.lean_to_left(0);
    let mut adams = vec![
        ("alt_camber_compliance.left".to_owned(), camber),
        (
            "Percentage Roll Steer".to_owned(),
            of.mean(Responses::roll_steer),
        ),
    ];
    for (side, word) in ["Left", "Right"].into_iter().enumerate() {
        let own = of.altair(side).into_iter();
        altair.extend(own.map(|(name, value)| (format!("{word} {name}"), value)));
        adams.extend(of.adams(side));
    }
    [altair, adams]
}

/// Rows of `kc.csv` with the names of another program.
fn named(study: &Study, program: OtherProgram) -> Vec<BTreeMap<String, String>> {
    let tests = RigTests::of(study, Some(program)).unwrap();
    let rows = rows_by_column(&tests.results.kc_csv());
    let has_name = |row: &BTreeMap<String, String>| !row["other_name"].is_empty();
    rows.into_iter().filter(has_name).collect()
}

/// The definition of each value describes a motion in vehicle axes. The value equals this motion for all axis
/// conventions of the study.
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

/// Signs of the results of other programs divided by the results of this program. Each row has the other program, test
/// result, mode, and the signs at the left and right wheel.
const SIGNS: [(OtherProgram, &str, &str, [f64; 2]); 14] = [
    (ALTAIR, "toe_by_lateral_force", "parallel", [-1.0, -1.0]),
    (ALTAIR, "toe_by_lateral_force", "opposed", [-1.0, 1.0]),
    (ALTAIR, "camber_by_lateral_force", "parallel", [1.0, 1.0]),
    (ALTAIR, "camber_by_lateral_force", "opposed", [1.0, -1.0]),
    (
        ALTAIR,
        "wheel_centre_by_lateral_force",
        "parallel",
        [1.0, 1.0],
    ),
    (
        ALTAIR,
        "wheel_centre_by_lateral_force",
        "opposed",
        [1.0, -1.0],
    ),
    (ALTAIR, "toe_by_aligning_moment", "parallel", [-1.0, -1.0]),
    (ALTAIR, "toe_by_aligning_moment", "opposed", [-1.0, 1.0]),
    (ALTAIR, "toe_by_braking", "parallel", [-1.0, 1.0]),
    (ALTAIR, "toe_by_traction", "parallel", [1.0, -1.0]),
    (ALTAIR, "spin_by_braking", "parallel", [1.0, 1.0]),
    (ALTAIR, "spin_by_traction", "parallel", [-1.0, -1.0]),
    (ADAMS, "toe_by_aligning_moment", "parallel", [-1.0, -1.0]),
    (ADAMS, "compliant_wheel_rate", "parallel", [1.0, 1.0]),
];

const ALTAIR: OtherProgram = OtherProgram::Altair;
const ADAMS: OtherProgram = OtherProgram::Adams;

/// The ratios of the signs of other programs to the signs of this program equal the manual's table. In these tests the
/// wheel load is held, and the wheels are upright.
#[test]
fn signs_against_ours_are_those_of_the_manual() {
    let study = elastic(&text());
    let mut seen = 0;
    for (program, quantity, mode, signs) in SIGNS {
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
