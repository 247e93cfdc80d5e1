//! Tests of springs between the rockers of both wheels: heave springs, T-bars, heave bars, monoshocks.

use super::commands::study;
use crate::support::random::Random;
use hardpoint::axle::{
    Axle, AxleQuantity as A, AxleSolver, Law, Placement, Preloaded, Quantity, RockerSprings,
    SpringLaw, WheelQuantity as W,
};
use hardpoint::characteristics::Characteristic;
use hardpoint::model::{Axis, PointId, Side};
use hardpoint::study::Study;

/// Axle of the sample with every spring that a test may need.
fn sample() -> Axle {
    let study = Study::read(&study("double_wishbone_monoshock.toml"), &[]).unwrap();
    let mut axle = study.axle().unwrap().axle.clone();
    axle.setup.rocker_springs.heave_bar = Some(Preloaded {
        load: 2.0e4,
        rate: 1.5e5,
    });
    axle
}

/// Sample with only these springs.
fn with(springs: RockerSprings) -> Axle {
    let mut axle = sample();
    axle.setup.rocker_springs = springs;
    axle
}

/// Values of quantities at given travels of both wheels on level pads.
fn values(axle: &Axle, travels: [f64; 2], quantities: &[Quantity]) -> Vec<f64> {
    let mut solver = AxleSolver::<4>::new(axle, quantities, false).unwrap();
    let placement = Placement::Travels {
        travels,
        rack: 0.0,
        on_plane: false,
    };
    let placed = solver.place(&placement).unwrap();
    let read = solver.read(&placed).unwrap();
    let value = |quantity: &Quantity| read.value(*quantity).unwrap();
    quantities.iter().map(value).collect()
}

const BOTH: [Side; 2] = Side::ALL;

/// Energy of heave spring, T-bar and heave bar, from lengths and angles.
fn energy(axle: &Axle, travels: [f64; 2]) -> f64 {
    let angle = |side| Quantity::Corner(side, Characteristic::RockerAngle);
    let asked = [
        Quantity::Axle(A::HeaveSpringLength),
        angle(BOTH[0]),
        angle(BOTH[1]),
    ];
    let [length, left, right] = values(axle, travels, &asked).try_into().unwrap();
    let design = axle.design_heave_spring().unwrap();
    let springs = &axle.setup.rocker_springs;
    let along = |law: Option<Preloaded>, by: f64| {
        law.map_or(0.0, |law| law.load * by + 0.5 * law.rate * by * by)
    };
    along(springs.heave_spring, design - length)
        + 0.5 * springs.t_bar.unwrap_or(0.0) * (left - right) * (left - right)
        + along(springs.heave_bar, left + right)
}

/// Wheel loads do the work of the springs: F dh = dU, where h is the height of the wheel's level pad.
#[test]
fn wheel_loads_are_slopes_of_the_energy() {
    let axle = sample();
    let radius = axle.setup.wheel_radius.unwrap();
    let mut random = Random(3);
    let step = 1e-3;
    for _ in 0..20 {
        let travels = [25.0 * random.signed(), 25.0 * random.signed()];
        for side in BOTH {
            let at = |by: f64| {
                let mut moved = travels;
                moved[side as usize] += by;
                let camber = Quantity::Corner(side, Characteristic::Camber);
                let [camber] = values(&axle, moved, &[camber]).try_into().unwrap();
                (
                    energy(&axle, moved),
                    moved[side as usize] - radius * camber.cos(),
                )
            };
            let ((below, low), (above, high)) = (at(-step), at(step));
            let load = Quantity::Wheel(side, W::WheelLoad);
            let [load] = values(&axle, travels, &[load]).try_into().unwrap();
            let expected = (above - below) / (high - low);
            // Error of a central difference, plus rounding of the energies. Measured: at most 6e-10.
            let error = (load - expected).abs();
            assert!(error < 2e-8 * load.abs().max(100.0), "{load} {expected}");
        }
    }
}

/// Without preload, a heave spring or heave bar adds no roll stiffness in the design position. The reason: its force is
/// an even function of the roll angle. A T-bar adds no stiffness in heave.
#[test]
fn each_spring_resists_its_own_motion() {
    let heave_spring = Some(Preloaded {
        load: 0.0,
        rate: 70.0,
    });
    let heave_bar = Some(Preloaded {
        load: 0.0,
        rate: 1.5e5,
    });
    let stiffnesses = |springs: RockerSprings| {
        let mut axle = with(springs);
        axle.setup.tyre_rate = None;
        let asked = [A::RollStiffness, A::RideRate].map(Quantity::Axle);
        <[f64; 2]>::try_from(values(&axle, [0.0, 0.0], &asked)).unwrap()
    };
    let [roll, ride] = stiffnesses(RockerSprings {
        heave_spring,
        t_bar: None,
        heave_bar: None,
    });
    assert!(roll.abs() < 1e-6 && ride > 1.0, "{roll} {ride}");
    let [roll, bar_ride] = stiffnesses(RockerSprings {
        heave_spring: None,
        t_bar: None,
        heave_bar,
    });
    assert!(roll.abs() < 1e-6 && bar_ride > 1.0, "{roll} {bar_ride}");
    let [bar, all] = stiffnesses(RockerSprings {
        heave_spring,
        t_bar: Some(4.0e5),
        heave_bar,
    });
    // The T-bar adds nothing in heave. The rates of heave spring and heave bar add up.
    assert!((all - ride - bar_ride).abs() < 1e-9 * all, "{all}");
    assert!(bar > 1.0e4, "{bar}");
}

/// A T-bar acts as an anti-roll bar whose levers are the rockers. If the left wheel is higher than the right wheel, the
/// T-bar increases the left wheel load and reduces the right wheel load.
#[test]
fn a_t_bar_adds_to_the_load_of_the_springs() {
    let law = SpringLaw {
        spring: Law::Linear {
            rate: 35.0,
            force: 900.0,
        },
        bump_stop: None,
        rebound_stop: None,
        own_length: None,
    };
    let text = std::fs::read_to_string(study("double_wishbone_axle.toml")).unwrap();
    let study = Study::from_text("axle.toml", &text, std::path::Path::new(".")).unwrap();
    let mut axle = study.axle().unwrap().axle.clone();
    axle.setup.springs = Some([law.clone(), law]);
    axle.setup.bar_rate = None;
    let loads = BOTH.map(|side| Quantity::Wheel(side, W::WheelLoad));
    let torque = [Quantity::Axle(A::TBarTorque)];
    let travels = [14.0, -9.0];
    let plain = values(&axle, travels, &loads);
    axle.setup.rocker_springs.t_bar = Some(3.0e5);
    let barred = values(&axle, travels, &loads);
    let [torque] = values(&axle, travels, &torque).try_into().unwrap();
    let (left, right) = (barred[0] - plain[0], barred[1] - plain[1]);
    assert!(torque > 0.0 && left > 0.0 && right < 0.0, "{left} {right}");
}

/// Gradients with respect to hardpoints equal finite differences between moved designs.
#[test]
fn gradients_are_those_of_moved_designs() {
    let axle = sample();
    let asked = [
        Quantity::Axle(A::HeaveSpringForce),
        Quantity::Axle(A::HeaveSpringMotionRatio),
        Quantity::Axle(A::TBarTorque),
        Quantity::Axle(A::HeaveBarTorque),
        Quantity::Axle(A::RideRate),
        Quantity::Axle(A::RollStiffness),
        Quantity::Wheel(Side::Left, W::WheelLoad),
    ];
    let travels = [12.0, -17.0];
    let placement = Placement::Travels {
        travels,
        rack: 0.0,
        on_plane: false,
    };
    let mut solver = AxleSolver::<4>::new(&axle, &asked, false).unwrap();
    let placed = solver.place(&placement).unwrap();
    let mut found = Vec::new();
    let add = |_: usize, [left, right]: [&[hardpoint::number::Vector3<f64>]; 2]| {
        let both = left.iter().zip(right);
        found.push(both.map(|(a, b)| *a + *b).collect::<Vec<_>>());
    };
    solver.gradients(&placed, &asked, add).unwrap();
    let points = ["heave_spring", "pushrod_inner", "lower_ball_joint"];
    for name in points {
        let PointId(point) = axle.left.mechanism.point(name).unwrap();
        for axis in Axis::ALL {
            let step = 1e-3;
            let at = |by: f64| {
                let mut moved = axle.clone();
                moved.left.design[point][axis] += by;
                values(&moved, travels, &asked)
            };
            let (below, above) = (at(-step), at(step));
            for (k, quantity) in asked.iter().enumerate() {
                let expected = (above[k] - below[k]) / (2.0 * step);
                let by = found[k][point][axis];
                let value = (0.5 * (above[k] + below[k])).abs();
                // Rounding of the values, divided by the step.
                let error = (by - expected).abs() / (expected.abs() + 1e-3 * value + 1e-9);
                assert!(
                    error < 1e-4,
                    "{quantity:?} by {name} {axis:?}: {by} {expected}"
                );
            }
        }
    }
}

/// A monoshock needs no `[spring]`. The program refuses a heave spring without its point, or bars without rockers, and
/// states the remedy.
#[test]
fn what_is_missing_is_said() {
    use super::commands::run;
    let path = study("double_wishbone_monoshock.toml");
    let (said, _) = run(&["check", path.to_str().unwrap()], 0);
    assert!(!said.contains("error"), "{said}");
    let text = std::fs::read_to_string(&path).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let refused = |text: &str| {
        let file = folder.path().join("study.toml");
        std::fs::write(&file, text).unwrap();
        run(&["check", file.to_str().unwrap()], 2).1
    };
    let without = |start: &str| -> String {
        let kept = text.lines().filter(|line| !line.starts_with(start));
        kept.map(|line| format!("{line}\n")).collect()
    };
    let said = refused(&without("heave_spring "));
    assert!(
        said.contains("[heave_spring] is given, but the hardpoint of its end is missing"),
        "{said}"
    );
    let said = refused(&without("pushrod_inner"));
    assert!(said.contains("missing for the rocker"), "{said}");
    let said = refused(&text.replace("rate = 4.0e5", "rate = -4.0e5"));
    assert!(said.contains("-4"), "{said}");
    let macpherson = std::fs::read_to_string(study("macpherson_axle.toml")).unwrap();
    let said = refused(&format!("{macpherson}\n[t_bar]\nrate = 1.0e5\n"));
    assert!(said.contains("[t_bar] acts on rockers"), "{said}");
}
