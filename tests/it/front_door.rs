//! Tests of the Rust interface with impossible requests. Every request returns an error with a message. No CPU thread overflows
//! its stack, even if the program is compiled without optimisation.

use hardpoint::{
    Axis, BuildError, Characteristic, Control, Error, Iteration, Motion, Order, Sampling, Study,
    Suspension, SuspensionBuilder, SweepControl, Target, Topology, Variable, VehicleFigures,
};
use std::collections::BTreeSet;
use std::ops::ControlFlow;
use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering};

const POINTS: [(&str, [f64; 3]); 9] = [
    ("lower_arm_front", [150.0, 350.0, 150.0]),
    ("lower_arm_rear", [-150.0, 350.0, 155.0]),
    ("lower_ball_joint", [0.0, 700.0, 140.0]),
    ("upper_arm_front", [100.0, 400.0, 430.0]),
    ("upper_arm_rear", [-120.0, 400.0, 425.0]),
    ("upper_ball_joint", [-20.0, 660.0, 450.0]),
    ("tie_rod_inner", [-120.0, 340.0, 200.0]),
    ("tie_rod_outer", [-130.0, 680.0, 205.0]),
    ("wheel_centre", [0.0, 750.0, 300.0]),
];

/// Double wishbone with one point moved.
fn moved(name: &str, to: [f64; 3]) -> SuspensionBuilder {
    let begun = Suspension::builder("double_wishbone").static_angles_deg(-1.0, 0.1);
    POINTS.iter().fold(begun, |builder, (point, at)| {
        builder.hardpoint(point, if *point == name { to } else { *at })
    })
}

fn builder() -> SuspensionBuilder {
    moved("", [0.0; 3])
}

fn suspension() -> Suspension {
    builder().build().unwrap()
}

fn height(suspension: &Suspension) -> Variable {
    Variable::offset(suspension, "tie_rod_inner", Axis::Z, -5.0..=5.0).unwrap()
}

fn straight(suspension: &Suspension) -> Target {
    let points = [[-30.0, 0.0], [30.0, 0.0]];
    Target::curve(suspension, Characteristic::Toe, &points, 0.02).unwrap()
}

fn study(suspension: &Suspension) -> Study {
    Study::of(suspension.clone())
        .over(Motion::travel(-40.0..=40.0, 9).unwrap())
        .asking(&[Characteristic::Toe], Order::Position)
        .unwrap()
}

fn words<T>(answer: Result<T, impl std::fmt::Display>) -> String {
    match answer {
        Ok(_) => panic!("there is an answer"),
        Err(error) => error.to_string(),
    }
}

/// Values of the variables in every design of a sweep.
fn designs(study: &Study) -> Result<Vec<Vec<f64>>, Error> {
    let mut designs = Vec::new();
    study.sweep(SweepControl::default(), |rows| {
        designs.extend((0..rows.designs()).map(|design| rows.variables(design).to_vec()));
        ControlFlow::Continue(())
    })?;
    Ok(designs)
}

/// Uses `mib` MiB of stack.
fn descend(mib: usize) -> usize {
    let frame = std::hint::black_box([1_u8; 1 << 20]);
    match mib {
        0 => 0,
        _ => descend(mib - 1) + usize::from(frame[mib]),
    }
}

/// Compiled without optimisation, a sweep needs 5 MiB of stack and a certificate 12 MiB. Callbacks run on the CPU threads of
/// sweeps and tunings, and these threads have more stack. With the default stack of the library rayon (2 MiB), this test
/// process would abort.
#[test]
fn the_threads_of_sweeps_and_tunings_have_large_stacks() {
    let suspension = suspension();
    let one = [height(&suspension)];
    let swept = study(&suspension).sampling(Sampling::Sobol, 3, 1, &one);
    let mut deepest = 0;
    let sweep = swept.sweep(SweepControl::default(), |_| {
        deepest = deepest.max(descend(16));
        ControlFlow::Continue(())
    });
    assert_eq!((sweep.is_ok(), deepest), (true, 16));

    let mut tuned = study(&suspension).tuning(one.to_vec(), vec![straight(&suspension)]);
    for starts in [1, 3] {
        tuned.optimise.as_mut().unwrap().starts = starts;
        let deepest = AtomicUsize::new(0);
        let watch = |_: usize, _: &Iteration| {
            deepest.fetch_max(descend(16), Ordering::Relaxed);
        };
        let control = Control {
            watch: Some(&watch),
            ..Control::default()
        };
        let best = tuned.tune(control).unwrap().best;
        assert_eq!(
            (best.is_some(), deepest.into_inner()),
            (true, 16),
            "{starts} starts"
        );
    }
}

#[test]
fn a_curve_has_two_points_and_a_value_stands_at_one_travel() {
    let suspension = suspension();
    let curve = |points: &[[f64; 2]]| Target::curve(&suspension, Characteristic::Toe, points, 0.02);
    for (count, points) in [&[][..], &[[3.0, 0.0]]].into_iter().enumerate() {
        let expected = format!(
            "the number of points of a curve is {count}; expected at least 2, or Target::at for a value at one travel"
        );
        assert_eq!(words(curve(points)), expected);
    }
    let at = |travel, value, tolerance| {
        Target::at(&suspension, Characteristic::Toe, travel, value, tolerance)
    };
    assert!(words(at(f64::NAN, 0.0, 0.02)).starts_with("a travel is NaN"));
    assert!(words(at(3.0, f64::INFINITY, 0.02)).starts_with("a target value is inf"));
    assert!(words(at(3.0, 0.0, 0.0)).starts_with("the tolerance is 0"));

    // The tuning has one variable and one target value. This value is the toe of a design with the variable point 2 mm
    // higher, at a travel between two stations of the motion.
    let toe_at = |suspension: &Suspension, travel: f64| {
        let pose = suspension.pose_at(travel, 0.0).unwrap();
        pose.characteristic(Characteristic::Toe).unwrap()
    };
    let travel = 33.0;
    let higher = moved("tie_rod_inner", [-120.0, 340.0, 202.0]).build();
    let toe = toe_at(&higher.unwrap(), travel);
    assert!((toe - toe_at(&suspension, travel)).abs() > 0.01);
    let tuning = study(&suspension)
        .tuning(
            vec![height(&suspension)],
            vec![at(travel, toe, 1e-6).unwrap()],
        )
        .tune(Control::default())
        .unwrap();
    let met = study(&suspension).at_design(tuning.best.unwrap().design);
    let found = toe_at(met.wheel(), travel);
    assert!((found - toe).abs() < 2e-6, "{found} instead of {toe}");
}

#[test]
fn a_grid_has_as_many_values_of_every_variable_or_is_refused() {
    let suspension = suspension();
    let inner = height(&suspension);
    let outer = Variable::offset(&suspension, "tie_rod_outer", Axis::Z, -3.0..=3.0).unwrap();
    let one = [inner.clone()];
    let two = [inner, outer];
    let grid = |samples, variables: &[Variable]| {
        designs(&study(&suspension).sampling(Sampling::Grid, samples, 1, variables))
    };
    assert_eq!(
        grid(5, &one).unwrap(),
        [[-5.0], [-2.5], [0.0], [2.5], [5.0]]
    );
    let values = [-3.0, 0.0, 3.0];
    let expected: Vec<[f64; 2]> = [-5.0, 0.0, 5.0]
        .iter()
        .flat_map(|first| values.map(|second| [*first, second]))
        .collect();
    assert_eq!(grid(9, &two).unwrap(), expected);
    for (samples, variables) in [(10, &two[..]), (8, &two), (1, &two), (1, &one)] {
        let expected =
            format!("the number of samples of a grid is {samples}; expected the product");
        assert!(words(grid(samples, variables)).starts_with(&expected));
    }
    assert!(words(grid(0, &one)).starts_with("the number of samples is 0; expected at least 1"));
    let too_many = words(grid(u64::MAX, &two));
    assert!(too_many.contains("no more than 1e12 designs"), "{too_many}");

    // The variables get different numbers of steps.
    let mut uneven = study(&suspension).sampling(Sampling::Grid, 6, 1, &two);
    if let hardpoint::Designs::Sampled(sampled) = &mut uneven.sweep.as_mut().unwrap().designs {
        sampled.variables[0].steps = Some(2);
        sampled.variables[1].steps = Some(3);
    }
    let found = designs(&uneven).unwrap();
    let distinct = |k: usize| {
        found
            .iter()
            .map(|d| d[k] as i64)
            .collect::<BTreeSet<_>>()
            .len()
    };
    assert_eq!((found.len(), distinct(0), distinct(1)), (6, 2, 3));
}

#[test]
fn an_axle_has_curves_and_takes_its_outputs_from_its_text() {
    let path = crate::support::studies().join("macpherson_axle.toml");
    let study = Study::read(&path, &[]).unwrap();
    let curves = study.curves().unwrap();
    let both = study.axle().unwrap();
    assert_eq!(curves.stations.len(), both.plan.motion.stations());
    // On a mirrored axle, left and right camber are equal in the design position.
    let column = |name: &str| curves.columns.iter().position(|c| c.name == name).unwrap();
    let is_design = |s: &&hardpoint::Station| {
        let given = curves.motion.iter().zip(&s.at).filter(|(c, _)| c.is_given);
        given.into_iter().all(|(_, value)| *value == Some(0.0))
    };
    let design = curves.stations.iter().find(is_design).unwrap();
    let [left, right] =
        ["left_camber_deg", "right_camber_deg"].map(|name| design.value(column(name)));
    assert!(left.is_some() && left == right);
    let asked = study.asking(&[Characteristic::Toe], Order::Position);
    assert!(matches!(asked, Err(Error::Axle(_))));
}

#[test]
fn lists_with_nothing_in_them_are_refused() {
    let suspension = suspension();
    let variables = vec![height(&suspension)];
    let targets = vec![straight(&suspension)];
    let tune = |variables: &[Variable], targets: &[Target]| {
        let study = study(&suspension).tuning(variables.to_vec(), targets.to_vec());
        words(study.tune(Control::default()))
    };
    let expected = |what: &str| format!("no {what} is given; expected at least one");
    assert_eq!(tune(&[], &targets), expected("variable to tune"));
    assert_eq!(tune(&variables, &[]), expected("target"));
    for method in [Sampling::Sobol, Sampling::Grid, Sampling::Saltelli] {
        let swept = study(&suspension).sampling(method, 8, 1, &[]);
        assert_eq!(words(designs(&swept)), expected("variable to sweep over"));
    }
    let together = Variable::together(&suspension, &[], Axis::Z, -5.0..=5.0);
    assert_eq!(words(together), expected("point that moves"));
    let racks = Motion::travel(-5.0..=5.0, 3).unwrap().with_racks(&[]);
    assert_eq!(words(racks), expected("rack displacement"));
}

/// The results of a sweep contain no rotations. So a sweep refuses a variable that only rotates, because all its designs
/// would look the same.
#[test]
fn a_sweep_refuses_a_variable_that_moves_no_coordinate() {
    let suspension = suspension();
    let mut turn = height(&suspension);
    let points = turn.moves.drain(..).map(|m| m.point).collect();
    let axis = Axis::Z;
    turn.turn = Some(hardpoint::Turn { points, axis });
    let swept = study(&suspension).sampling(Sampling::Sobol, 8, 1, &[turn]);
    let said = words(designs(&swept));
    assert!(
        said.starts_with("tie_rod_inner_turn_z moves no coordinate"),
        "{said}"
    );
}

/// A sweep accepts a variable that changes a rate instead of a coordinate.
#[test]
fn a_sweep_varies_a_rate() {
    let sweep = "sweep={ method = \"sobol\", samples = 4, variables = [{ bushing = \"lower_arm_rear\", stiffness = \"y\", \
                 range = [0.5, 2.0], relative = true }] }";
    let path = Path::new("studies/macpherson_compliance.toml");
    let study = Study::read_elastic(path, &[sweep.to_owned()]).unwrap();
    let factors = designs(&study).unwrap();
    assert_eq!(factors.len(), 4);
    assert!(factors.iter().all(|row| (0.5..=2.0).contains(&row[0])));
}

#[test]
fn the_builder_names_what_there_is() {
    let topology = |name: &str| words(Suspension::builder(name).build());
    let near = topology("doublewishbone");
    assert!(
        near.starts_with(
            "there is no topology \"doublewishbone\"; did you mean \"double_wishbone\"? There are "
        ),
        "{near}"
    );
    let far = topology("x");
    for topology in Topology::ALL {
        assert!(
            near.contains(topology.name) && far.contains(topology.name),
            "{far}"
        );
    }
    let hardpoint = |name: &str| words(builder().hardpoint(name, [0.0; 3]).build());
    assert_eq!(
        hardpoint("lower_arm_frnt"),
        "double_wishbone has no hardpoint \"lower_arm_frnt\"; did you mean \"lower_arm_front\"?"
    );
    let far = hardpoint("qqq");
    assert!(
        far.contains("; there are upper_arm_front, upper_arm_rear, "),
        "{far}"
    );
}

#[test]
fn the_builder_refuses_figures_that_are_none() {
    for wrong in [f64::INFINITY, f64::NAN, 0.0, -300.0] {
        let said = words(builder().wheel_radius(wrong).build());
        assert_eq!(
            said,
            format!("wheel_radius is {wrong}; expected a finite number above 0")
        );
        let vehicle = VehicleFigures {
            wheelbase: Some(wrong),
            ..VehicleFigures::default()
        };
        assert!(words(builder().vehicle(vehicle).build()).starts_with("wheelbase is "));
    }
    for wrong in [f64::NAN, -0.1, 1.1] {
        let vehicle = VehicleFigures {
            brake_share_front: Some(wrong),
            ..VehicleFigures::default()
        };
        let said = words(builder().vehicle(vehicle).build());
        assert!(said.ends_with("; expected a share from 0 to 1"), "{said}");
    }
}

/// Every design that the builder accepts has a pose (position and orientation of the knuckle). The builder refuses a
/// tie rod with an end on the steering axis. It also refuses a tie rod that lies in one plane with this axis. Such a
/// rod does not hold the wheel's heading.
#[test]
fn a_design_position_that_cannot_be_solved_is_none() {
    let between = [-10.0, 680.0, 295.0];
    for (name, to, reason) in [
        (
            "tie_rod_outer",
            between,
            "tie_rod_outer lies on the steering axis",
        ),
        (
            "tie_rod_inner",
            between,
            "tie_rod_inner lies on the steering axis",
        ),
        (
            "tie_rod_inner",
            [-260.0, 660.0, 270.0],
            "the tie rod is at toggle",
        ),
    ] {
        match moved(name, to).build() {
            Err(BuildError::Design(said)) => assert!(said.starts_with(reason), "{said}"),
            other => panic!("{name}: {other:?}"),
        }
    }
    // The builder accepts a design that is close, but not too close, to a singular one.
    let near = moved("tie_rod_outer", [-12.0, 680.0, 295.0])
        .build()
        .unwrap();
    assert!(near.pose_at(0.0, 0.0).is_ok());
}
