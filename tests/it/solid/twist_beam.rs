//! Tests of twist beams against an independent formulation: two rigid bodies, each with a position and a quaternion. The
//! equations are five of the hinge, five of the mounts, two for unit quaternions and two for heights. Newton's method continues
//! until the residuals are rounding errors. So its Jacobian, from finite differences, need not be accurate.

use super::own::{Point, cross, dot, minus, mirror, plus, solve, turned};
use super::{STILL, axle, slopes_of_designs};
use crate::support::larger;
use crate::support::random::Random;
use hardpoint::axle::{
    AxleQuantity as A, AxleSolver, Motion, Placement, Quantity, Read, WheelParts as _,
};
use hardpoint::model::Side;
use std::fmt::Write as _;

/// Unknowns of both halves: position and quaternion of each half.
pub(super) type Unknowns = [f64; 14];

const AT_REST: Unknowns = [
    0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0,
];

pub(super) fn half(x: &Unknowns, side: usize) -> (Point, [f64; 4]) {
    let x = &x[7 * side..][..7];
    ([x[0], x[1], x[2]], [x[3], x[4], x[5], x[6]])
}

pub(super) fn carried(x: &Unknowns, side: usize, point: Point) -> Point {
    let (shift, q) = half(x, side);
    plus(turned(q, point), shift)
}

/// Solves a beam for both travels: at rest, and then in three steps. In each of them, six iterations of Newton's method use a
/// Jacobian from central differences.
pub(super) fn in_steps(
    travels: [f64; 2],
    residuals: impl Fn(&Unknowns, [f64; 2]) -> Unknowns,
) -> Unknowns {
    let mut x = AT_REST;
    const STEPS: u32 = 3;
    for step in 0..=STEPS {
        let travels = travels.map(|travel| travel * f64::from(step) / f64::from(STEPS));
        for _ in 0..6 {
            let now = residuals(&x, travels);
            let mut rows: Vec<Vec<f64>> = now.iter().map(|_| Vec::new()).collect();
            for k in 0..14 {
                let by = if k % 7 < 3 { 1e-3 } else { 1e-6 };
                let moved = |sign: f64| {
                    let mut moved = x;
                    moved[k] += sign * by;
                    residuals(&moved, travels)
                };
                let (above, below) = (moved(1.0), moved(-1.0));
                for (row, entry) in rows.iter_mut().enumerate() {
                    entry.push((above[row] - below[row]) / (2.0 * by));
                }
            }
            for (row, residual) in rows.iter_mut().zip(now) {
                row.push(-residual);
            }
            for (x, step) in x.iter_mut().zip(solve(rows)) {
                *x += step;
            }
        }
    }
    x
}

/// Points of the left half with the shear centre.
#[derive(Clone)]
pub(super) struct Beam {
    pub(super) mount: Point,
    pub(super) shear_centre: Point,
    pub(super) wheel_centre: Point,
    spring_upper: Point,
    spring_lower: Point,
}

impl Beam {
    pub(super) fn text(&self, further: &str) -> String {
        let points = [
            ("mount", self.mount),
            ("shear_centre", self.shear_centre),
            ("wheel_centre", self.wheel_centre),
            ("spring_upper", self.spring_upper),
            ("spring_lower", self.spring_lower),
        ];
        let mut text =
            "[suspension]\ntopology = \"twist_beam\"\n[suspension.hardpoints]\n".to_owned();
        for (name, [x, y, z]) in points {
            let _ = writeln!(text, "{name} = [{x:?}, {y:?}, {z:?}]");
        }
        text + "[wheel]\nradius = 300.0\nstatic_camber = 0.0\nstatic_toe = 0.0\n[vehicle]\nwheelbase = 2600.0\n\
                cg_height = 550.0\nposition = \"rear\"\nbrakes = \"outboard\"\nbrake_share_front = 0.7\n\
                [twist_beam]\ntorsional_rate = 5.0e5\n[spring]\nrate = 28.0\nforce = 3600.0\n"
            + further
    }

    fn of_side(point: Point, side: usize) -> Point {
        match side {
            0 => point,
            _ => mirror(point),
        }
    }

    fn residuals(&self, x: &Unknowns, travels: [f64; 2]) -> Unknowns {
        let centre = self.shear_centre;
        let [left, right] = [0, 1].map(|side| carried(x, side, centre));
        let [along, other] = [0, 1].map(|side| turned(half(x, side).1, [0.0, 300.0, 0.0]));
        let mounts = [0, 1].map(|side| {
            let mount = Beam::of_side(self.mount, side);
            minus(carried(x, side, mount), mount)
        });
        let height = |side: usize| {
            let centre = Beam::of_side(self.wheel_centre, side);
            carried(x, side, centre)[2] - centre[2] - travels[side]
        };
        let unit = |side: usize| {
            let (_, q) = half(x, side);
            300.0 * (q.iter().map(|c| c * c).sum::<f64>() - 1.0)
        };
        [
            left[0] - right[0],
            left[1] - right[1],
            left[2] - right[2],
            along[0] - other[0],
            along[2] - other[2],
            mounts[0][0],
            mounts[0][2],
            mounts[1][0],
            mounts[1][2],
            mounts[0][1] + mounts[1][1],
            height(0),
            height(1),
            unit(0),
            unit(1),
        ]
    }

    fn solved(&self, travels: [f64; 2]) -> Unknowns {
        in_steps(travels, |x, travels| self.residuals(x, travels))
    }

    /// Rotation of the right half relative to the left half, positive if it raises the rear of an arm.
    fn twist(&self, x: &Unknowns) -> f64 {
        let [hinge, left, right] = [
            turned(half(x, 0).1, [0.0, 1.0, 0.0]),
            turned(half(x, 0).1, [1.0, 0.0, 0.0]),
            turned(half(x, 1).1, [1.0, 0.0, 0.0]),
        ];
        dot(right, cross(hinge, left)).atan2(dot(right, left))
    }
}

/// Typical beam.
pub(super) fn sample() -> Beam {
    random(&mut Random(70))
}

/// Random typical beam.
pub(super) fn random(random: &mut Random) -> Beam {
    let mut near = |p: Point, by: f64| p.map(|c| c + by * random.signed());
    let mut shear_centre = near([300.0, 0.0, 390.0], 60.0);
    shear_centre[1] = 0.0;
    Beam {
        mount: near([410.0, 530.0, 340.0], 40.0),
        shear_centre,
        wheel_centre: near([0.0, 740.0, 300.0], 40.0),
        spring_upper: near([90.0, 520.0, 480.0], 30.0),
        spring_lower: near([80.0, 520.0, 260.0], 30.0),
    }
}

fn on_pads(travels: [f64; 2]) -> Placement {
    Placement::Travels {
        travels,
        rack: 0.0,
        on_plane: false,
    }
}

fn read_at<'a>(solver: &mut AxleSolver<'a, 2>, travels: [f64; 2]) -> Read<'a> {
    let placed = solver.place(&on_pads(travels)).unwrap();
    solver.read(&placed).unwrap()
}

const WANTED: [Quantity; 2] = [Quantity::Axle(A::BeamTwist), Quantity::Axle(A::MeanSteer)];

/// For 1,000 beams at random travels, wheel centres, spin axes and twist agree with the formulation of two rigid bodies.
#[test]
fn positions_are_those_of_two_rigid_bodies() {
    let mut generator = Random(71);
    let (mut worst, mut worst_turn, mut most_twist) = (0.0_f64, 0.0_f64, 0.0_f64);
    for _ in 0..1000 {
        let beam = random(&mut generator);
        let study = axle(&beam.text(STILL));
        let mut solver = AxleSolver::<2>::new(&study.axle, &WANTED, false).unwrap();
        let travels = [(); 2].map(|()| 60.0 * generator.signed());
        let x = beam.solved(travels);
        let read = read_at(&mut solver, travels);
        for (side, wheel) in read.state.wheels().into_iter().enumerate() {
            let own = |v: Point| Beam::of_side(v, side);
            let found = own(wheel.reading.centre().to_array());
            let expected = carried(&x, side, own(beam.wheel_centre));
            let axis = own(wheel.reading.spin_axis().to_array());
            let expected_axis = turned(half(&x, side).1, own([0.0, 1.0, 0.0]));
            for i in 0..3 {
                worst = larger(worst, (found[i] - expected[i]).abs());
                worst_turn = larger(worst_turn, (axis[i] - expected_axis[i]).abs());
            }
        }
        let twist = WANTED[0].evaluate(&read.state);
        worst_turn = larger(worst_turn, (twist - beam.twist(&x)).abs());
        most_twist = larger(most_twist, twist.abs());
    }
    println!("{worst:e} mm, {worst_turn:e}, twists up to {most_twist}");
    assert!(most_twist > 0.2, "{most_twist}");
    // Residuals are a few rounding errors of coordinates of 700 mm, with a condition number below 1e3.
    assert!(worst < 1e-9, "{worst:e} mm");
    assert!(worst_turn < 1e-11, "{worst_turn:e}");
}

/// In parallel travel the beam turns about the line through both mounts. In opposite travel from the design position,
/// each arm turns about the line from its mount to the shear centre.
#[test]
fn arms_turn_about_the_axes_of_the_mode() {
    let mut generator = Random(72);
    for _ in 0..50 {
        let beam = random(&mut generator);
        let study = axle(&beam.text(STILL));
        let mut solver = AxleSolver::<2>::new(&study.axle, &WANTED, false).unwrap();
        let read = read_at(&mut solver, [35.0, 35.0]);
        let reading = &read.state.readings[0];
        let (from, now) = (
            minus(beam.wheel_centre, beam.mount),
            minus(reading.centre().to_array(), beam.mount),
        );
        let radius = |v: Point| v[0].hypot(v[2]);
        assert!(
            (radius(from) - radius(now)).abs() < 1e-10,
            "{from:?} {now:?}"
        );
        assert!((from[1] - now[1]).abs() < 1e-10, "{from:?} {now:?}");
        let axis = reading.spin_axis();
        assert!(axis.x.abs() + axis.z.abs() < 1e-13, "{axis:?}");
        assert!(WANTED[0].evaluate(&read.state).abs() < 1e-13);

        let read = read_at(&mut solver, [0.0; 2]);
        let wheel = read.state.wheel(Side::Left);
        // Motion in opposite travel: the left wheel rises while the right wheel falls.
        let [velocity, turn] = wheel.reading.twist([1, 0]);
        let axis = minus(beam.shear_centre, beam.mount);
        let turn = turn.to_array();
        let speed = dot(turn, axis) / dot(axis, axis);
        for i in 0..3 {
            assert!(
                (turn[i] - speed * axis[i]).abs() < 1e-14,
                "{turn:?} {axis:?}"
            );
        }
        let lever = minus(beam.wheel_centre, beam.mount);
        let expected = cross(turn, lever);
        for (found, expected) in velocity.to_array().into_iter().zip(expected) {
            assert!(
                (found - expected).abs() < 1e-12,
                "{velocity:?} {expected:?}"
            );
        }
    }
}

/// The mounts of the sample move sideways by about 0.05 mm at 2 deg of roll. With two ball joints as mounts, the beam
/// could not roll.
#[test]
fn mounts_move_sideways_a_little() {
    let beam = random(&mut Random(73));
    let x = beam.solved([-26.0, 26.0]);
    let aside = carried(&x, 0, beam.mount)[1] - beam.mount[1];
    assert!((0.005..0.5).contains(&aside.abs()), "{aside}");
}

/// Wheel loads equal the derivatives of the energy of springs and beam in the independent formulation.
#[test]
fn loads_are_slopes_of_the_energy() {
    let mut generator = Random(74);
    let quantities =
        Side::ALL.map(|side| Quantity::Wheel(side, hardpoint::axle::WheelQuantity::WheelLoad));
    for _ in 0..20 {
        let beam = random(&mut generator);
        let study = axle(&beam.text(STILL));
        let mut solver = AxleSolver::<2>::new(&study.axle, &quantities, false).unwrap();
        let travels = [(); 2].map(|()| 40.0 * generator.signed());
        let read = read_at(&mut solver, travels);
        let found = quantities.map(|q| q.evaluate(&read.state));
        let energy = |travels: [f64; 2]| {
            let x = beam.solved(travels);
            let twist = beam.twist(&x);
            let springs = [0, 1].map(|side| {
                let own = |p: Point| Beam::of_side(p, side);
                let length = |lower: Point| {
                    let way = minus(lower, own(beam.spring_upper));
                    dot(way, way).sqrt()
                };
                let shorter = length(own(beam.spring_lower))
                    - length(carried(&x, side, own(beam.spring_lower)));
                3600.0 * shorter + 14.0 * shorter * shorter
            });
            2.5e5 * twist * twist + springs[0] + springs[1]
        };
        // Heights of the contact points at both travels. Wheels are round, so their lowest points carry the load.
        let heights = |travels: [f64; 2]| {
            let x = beam.solved(travels);
            [0, 1].map(|side| {
                let centre = carried(&x, side, Beam::of_side(beam.wheel_centre, side));
                let axis = turned(half(&x, side).1, [0.0, 1.0, 0.0]);
                centre[2] - 300.0 * axis[0].hypot(axis[1])
            })
        };
        let slope = |f: &dyn Fn([f64; 2]) -> f64, k: usize| {
            let at = |by: f64| {
                let mut moved = travels;
                moved[k] += by;
                f(moved)
            };
            (8.0 * (at(0.5) - at(-0.5)) - (at(1.0) - at(-1.0))) / 6.0
        };
        for k in 0..2 {
            let work: f64 = (0..2)
                .map(|side| found[side] * slope(&|t| heights(t)[side], k))
                .sum();
            let expected = slope(&energy, k);
            assert!(
                (work - expected).abs() < 1e-5 * expected.abs(),
                "{work} {expected}"
            );
        }
    }
}

/// Gradients with respect to every point equal difference quotients of complete designs.
#[test]
fn gradients_are_those_of_whole_designs() {
    let beam = random(&mut Random(75));
    let study = axle(&beam.text(STILL));
    let wanted = [
        A::BeamTwist,
        A::BeamTorque,
        A::MeanSteer,
        A::RollSteer,
        A::AxleLateral,
        A::ForceRollCentreHeight,
        A::RigidAntiLift,
        A::RollStiffness,
        A::Track,
    ]
    .map(Quantity::Axle);
    let mut solver = AxleSolver::<4>::new(&study.axle, &wanted, false).unwrap();
    let base = study.axle.left.design.clone();
    let placement = Placement::Roll {
        heave: 15.0,
        roll: 0.04,
        rack: 0.0,
    };
    let placed = solver.place(&placement).unwrap();
    let mut found = vec![Vec::new(); wanted.len()];
    solver
        .gradients(&placed, &wanted, |number, [left, _]| {
            found[number] = left.to_vec()
        })
        .unwrap();
    for name in ["mount", "shear_centre", "wheel_centre", "spring_lower"] {
        let id = study.axle.left.mechanism.point(name).unwrap();
        // The shear centre stays in the middle plane.
        for axis in (0..3).filter(|axis| name != "shear_centre" || *axis != 1) {
            let at = (&base[..], &placement, &wanted[..]);
            let slopes = slopes_of_designs(&mut solver, at, (id, axis));
            for (k, quantity) in wanted.iter().enumerate() {
                let expected = slopes[k];
                let found = found[k][id.0].to_array()[axis];
                let scale = match quantity {
                    Quantity::Axle(A::RollStiffness | A::BeamTorque) => 1e4,
                    Quantity::Axle(A::RigidAntiLift | A::ForceRollCentreHeight) => 1.0,
                    _ => 1e-2,
                };
                assert!(
                    (found - expected).abs() < 1e-7 * (scale + expected.abs()),
                    "{name} {axis} {quantity:?}: {found} {expected}"
                );
            }
        }
    }
}

/// Derivatives along heave and roll equal difference quotients.
#[test]
fn derivatives_by_motions_are_slopes() {
    let beam = random(&mut Random(76));
    let study = axle(&beam.text(STILL));
    let wanted = [A::BeamTwist, A::MeanSteer, A::AxleLongitudinal].map(Quantity::Axle);
    let mut solver = AxleSolver::<3>::new(&study.axle, &wanted, false).unwrap();
    let mut at = |heave: f64, roll: f64| {
        let placement = Placement::Roll {
            heave,
            roll,
            rack: 0.0,
        };
        let placed = solver.place(&placement).unwrap();
        let read = solver.read(&placed).unwrap();
        let rates = [Motion::Heave, Motion::Roll]
            .map(|motion| wanted.map(|q| q.evaluate(&read.state.moving(motion))[1]));
        (wanted.map(|q| q.evaluate(&read.state)), rates)
    };
    let (heave, roll) = (12.0, 0.05);
    let (_, [by_heave, by_roll]) = at(heave, roll);
    for k in 0..wanted.len() {
        let mut slope = |h: f64, turn: f64| {
            let (above, below) = (at(heave + h, roll + turn), at(heave - h, roll - turn));
            above.0[k] - below.0[k]
        };
        let heaving = (8.0 * slope(0.5, 0.0) - slope(1.0, 0.0)) / 6.0;
        let rolling = (8.0 * slope(0.0, 1e-3) - slope(0.0, 2e-3)) / 12e-3;
        assert!(
            (heaving - by_heave[k]).abs() < 1e-10,
            "{k}: {heaving} {}",
            by_heave[k]
        );
        let scale = by_roll[k].abs().max(1.0);
        assert!(
            (rolling - by_roll[k]).abs() < 1e-8 * scale,
            "{k}: {rolling} {}",
            by_roll[k]
        );
    }
}
