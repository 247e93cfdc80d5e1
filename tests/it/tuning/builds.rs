//! Tests of builds in a robust tuning: their derivatives, and their relation to the nominal design.

use super::edited;
use hardpoint::number::Width;
use hardpoint::optimise::{
    Assessment, Constrained, LeastSquares, Linearisation, Objective, TargetLayout,
};
use hardpoint::study::{Optimise, Study};
use nalgebra::DVector;

const VARIABLES: &str = "optimise.variables=[\
    { hardpoint = \"tie_rod_inner\", axis = \"z\", range = [-20.0, 20.0] }, \
    { hardpoint = \"lower_arm_front\", axis = \"y\", range = [-20.0, 20.0] }, \
    { rigid = [\"lower_ball_joint\", \"tie_rod_outer\", \"wheel_centre\"], shift = 10.0, turn = 3.0 }]";
const TARGETS: &str = "optimise.targets=[\
    { characteristic = \"camber\", points = [[-20.0, -1.0], [20.0, 0.5]], tolerance = 0.05 }, \
    { characteristic = \"toe\", at = 0.0, value = 0.4, tolerance = 0.05 }, \
    { characteristic = \"bump_steer\", at = 5.0, value = 0.02, tolerance = 0.001 }]";
const TRAVEL: &str = "motion.travel={ from = -20.0, to = 20.0, steps = 3 }";

/// Calls a function with the residuals of a study's builds at `x`.
fn with_problem<R>(
    study: &Study,
    width: Option<Width>,
    f: impl FnOnce(&mut dyn FnMut(&DVector<f64>) -> Linearisation) -> R,
) -> R {
    let optimise = study.optimise.as_ref().unwrap();
    let suspension = study.wheel();
    let layout = TargetLayout::of(optimise, &study.vehicle);
    let assembled = study.vehicle.assembled().unwrap();
    let scatter = optimise.scatter.as_ref().unwrap();
    let variables = &optimise.variables;
    let mut problem = Objective::of_builds(&assembled, variables, &layout, scatter, width).unwrap();
    let count = layout.residuals();
    f(&mut |x| {
        let mut at = Linearisation::new(count, x.len());
        LeastSquares::evaluate(&mut problem, x, &mut at).unwrap();
        // SIMD lanes solve most builds.
        let (in_lanes, name) = (
            problem.builds_in_lanes(),
            suspension.mechanism.topology.name,
        );
        let most = 10 * in_lanes >= 9 * scatter.builds;
        assert!(width.is_none() || most, "{name} {width:?}: {in_lanes}");
        at
    })
}

/// Derivatives of builds equal finite differences of sixth order. The test covers a strut, and a wishbone with a
/// pushrod. Builds are as assembled, or with toe and camber aligned.
#[test]
fn derivatives_of_builds_are_exact() {
    for (file, more) in [
        ("double_wishbone_tolerance.toml", "tolerance.aligned=false"),
        ("double_wishbone_tolerance.toml", "tolerance.aligned=true"),
        ("macpherson_tolerance.toml", "tolerance.aligned=false"),
    ] {
        let study = edited(
            file,
            &[
                TRAVEL,
                VARIABLES,
                TARGETS,
                "optimise.scatter=3",
                "tolerance.bands=[]",
                more,
            ],
        );
        with_problem(&study, None, |at| {
            let x = DVector::from_fn(8, |j, _| ((j * 7 + 3) as f64).sin());
            let here = at(&x);
            assert_eq!(here.residuals.len(), 3 * 5);
            for j in 0..x.len() {
                let h = 0.05;
                let mut moved = |steps: f64| {
                    let mut moved = x.clone();
                    moved[j] += steps * h;
                    at(&moved).residuals
                };
                let mut slope = DVector::zeros(here.residuals.len());
                for (k, weight) in [(1.0, 45.0), (2.0, -9.0), (3.0, 1.0)] {
                    slope += (moved(k) - moved(-k)) * (weight / (60.0 * h));
                }
                for row in 0..slope.len() {
                    let found = here.jacobian[(row, j)];
                    let largest = here.jacobian.row(row).amax().max(1e-2);
                    let off = (slope[row] - found).abs() / largest;
                    assert!(
                        off < 1e-8,
                        "{file} {more}: {row} by {j}: {found} {}",
                        slope[row]
                    );
                }
            }
        });
    }
}

/// With very small scatter, builds equal the nominal design. Aligned builds keep the toe and camber of the nominal
/// design.
#[test]
fn builds_of_exact_parts_are_the_drawing() {
    let exact = "tolerance.scatter=[{ hardpoint = \"upper_arm_front\", sigma = 1e-9 }]";
    let study = edited(
        "double_wishbone_tolerance.toml",
        &[TRAVEL, VARIABLES, TARGETS, "optimise.scatter=2", exact],
    );
    let x = DVector::from_fn(8, |j, _| ((j * 5 + 1) as f64).sin());
    let wanted = drawing_at(&study, Width::widest(), &x);
    let found = with_problem(&study, None, |at| at(&x));
    for build in 0..2 {
        for row in 0..wanted.residuals.len() {
            let of_build = build * wanted.residuals.len() + row;
            let off = (found.residuals[of_build] - wanted.residuals[row]).abs();
            assert!(off < 1e-5, "{off}");
            for j in 0..8 {
                let scale = wanted.jacobian.row(row).amax();
                let off = found.jacobian[(of_build, j)] - wanted.jacobian[(row, j)];
                assert!(off.abs() < 1e-6 * scale + 1e-9, "{row} {j}: {off}");
            }
        }
    }
}

/// SIMD lanes of any width give the residuals and derivatives of builds one by one, with the same bits at every width.
/// The test covers every topology, rockers, bands, several rack displacements, and builds as assembled or aligned. It
/// also compares the nominal design, with stations in lanes and one by one.
#[test]
fn what_is_found_in_lanes_is_what_is_found_one_by_one() {
    let angles = "optimise.targets=[\
        { characteristic = \"camber\", points = [[-20.0, -1.0], [20.0, 0.5]], tolerance = 0.05 }, \
        { characteristic = \"toe\", between = [-0.05, 0.3], tolerance = 0.05 }, \
        { characteristic = \"bump_steer\", points = [[-20.0, 0.01], [20.0, 0.02]], tolerance = 0.001 }, \
        { characteristic = \"camber_gain\", at = 5.0, value = 0.02, tolerance = 0.001 }, \
        { characteristic = \"toe\", at = 10.0, value = 0.4, tolerance = 0.05, rack = [-4.0, 4.0] }]";
    let variables = |points: [&str; 3]| {
        let [a, b, c] = points;
        format!(
            "optimise.variables=[{{ hardpoint = \"{a}\", axis = \"z\", range = [-20.0, 20.0] }}, \
             {{ hardpoint = \"{b}\", axis = \"y\", range = [-20.0, 20.0] }}, \
             {{ rigid = [\"{a}\", \"{c}\"], shift = 10.0 }}]"
        )
    };
    let wishbone = ["tie_rod_inner", "lower_arm_front", "upper_arm_front"];
    let cases = [
        (
            "macpherson_tolerance",
            ["tie_rod_inner", "lower_arm_front", "strut_top"],
            "",
        ),
        (
            "double_wishbone_tolerance",
            wishbone,
            "{length=\"tie_rod\"},{shim=\"upper_ball_joint\",axis=\"y\"}",
        ),
        (
            "five_link_solve",
            [
                "toe_link_inner",
                "lower_front_link_inner",
                "upper_rear_link_outer",
            ],
            "{length=\"toe_link\"},{length=\"upper_rear_link\"}",
        ),
        (
            "semi_trailing_arm_solve",
            ["arm_pivot_inner", "arm_pivot_outer", "wheel_centre"],
            "{shim=\"arm_pivot_outer\",axis=\"x\"},{shim=\"arm_pivot_outer\",axis=\"z\"}",
        ),
    ];
    for (name, points, adjust) in cases {
        for aligned in [false, true] {
            let scattered = points.map(|point| format!("{point:?}")).join(",");
            let is_steered = !name.starts_with("semi") && !name.starts_with("five");
            let targets = if is_steered {
                angles.to_owned()
            } else {
                angles.replace(", rack = [-4.0, 4.0]", "")
            };
            let mut overrides = vec![
                TRAVEL.to_owned(),
                variables(points),
                targets,
                "tolerance.builds=10".to_owned(),
                "tolerance.seed=1".to_owned(),
                "tolerance.bands=[]".to_owned(),
                format!("tolerance.scatter=[{{hardpoints=[{scattered}],sigma=0.5}}]"),
                format!("tolerance.aligned={aligned}"),
                "optimise.scatter=19".to_owned(),
            ];
            if !adjust.is_empty() {
                overrides.push(format!("setup.adjust=[{adjust}]"));
            }
            let overrides: Vec<&str> = overrides.iter().map(String::as_str).collect();
            let study = edited(&format!("{name}.toml"), &overrides);
            let count = study.optimise.as_ref().unwrap().variables.len();
            let x = DVector::from_fn(count, |j, _| 3.0 * ((j * 7 + 3) as f64).sin());
            let of_builds = |width| with_problem(&study, width, |at| at(&x));
            let of_drawing = |width| drawing_at(&study, width, &x);
            let what = format!("{name} {aligned}");
            assert_same_at_every_width(&what, of_builds);
            if !aligned {
                assert_same_at_every_width(&what, of_drawing);
            }
        }
    }
}

/// Residuals of a study's nominal design.
fn drawing_at(study: &Study, width: Option<Width>, x: &DVector<f64>) -> Linearisation {
    let plain = Optimise {
        scatter: None,
        ..study.optimise.clone().unwrap()
    };
    let suspension = study.wheel();
    let layout = TargetLayout::of(&plain, &study.vehicle);
    let problem = Objective::new(suspension, &plain.variables, &layout).unwrap();
    let mut problem = problem.with_width(suspension, width);
    assert_eq!(problem.is_in_lanes(x), width.is_some());
    let mut at = Linearisation::new(layout.residuals(), x.len());
    LeastSquares::evaluate(&mut problem, x, &mut at).unwrap();
    at
}

/// Asserts that every lane width finds the one-by-one results, with equal bits at all widths.
fn assert_same_at_every_width(what: &str, find: impl Fn(Option<Width>) -> Linearisation) {
    let expected = find(None);
    let mut first: Option<Linearisation> = None;
    for width in Width::available() {
        let found = find(Some(width));
        for row in 0..expected.residuals.len() {
            let off = (found.residuals[row] - expected.residuals[row]).abs();
            assert!(off < 1e-9, "{what}: {row}: {off}");
            let largest = expected.jacobian.row(row).amax().max(1e-2);
            for j in 0..expected.jacobian.ncols() {
                let (a, b) = (found.jacobian[(row, j)], expected.jacobian[(row, j)]);
                let off = (a - b).abs() / largest;
                assert!(off < 1e-11, "{what}: {row} by {j}: {a} {b}");
            }
        }
        assert_eq!(first.get_or_insert(found.clone()), &found);
    }
}

/// If angles define the spin axis, a scattered wheel centre translates the axis. So the wheel radius has no effect on
/// camber and toe of robust builds. This also holds if the variables have moved the nominal design.
#[test]
fn the_radius_has_no_effect_on_robust_builds() {
    let scatter = "tolerance.scatter=[{ hardpoint = \"wheel_centre\", sigma = 1.0 }]";
    let residuals = |radius: &str| {
        let study = edited(
            "double_wishbone_tolerance.toml",
            &[
                TRAVEL,
                VARIABLES,
                TARGETS,
                "optimise.scatter=3",
                "tolerance.bands=[]",
                "tolerance.aligned=false",
                scatter,
                radius,
            ],
        );
        let x = DVector::from_fn(8, |j, _| ((j * 7 + 3) as f64).sin());
        with_problem(&study, None, |at| at(&x).residuals)
    };
    let usual = residuals("wheel.radius=300.0");
    for radius in ["wheel.radius=150.0", "wheel.radius=600.0"] {
        let off = (residuals(radius) - &usual).amax();
        assert!(off < 1e-9 * usual.amax(), "{radius}: {off}");
    }
}

/// Constraints apply to the nominal design. Some builds lack a pose at the end of the motion, where only a constraint
/// applies. This does not refuse the design, in SIMD lanes and one by one. A target at this place does refuse it.
#[test]
fn a_build_needs_no_pose_where_only_constraints_apply() {
    let far = "motion.travel={ from = 0.0, to = 321.0, steps = 5 }";
    let variables = "optimise.variables=[{ hardpoint = \"tie_rod_inner\", axis = \"z\", range = [-20.0, 20.0] }]";
    let constraint =
        "optimise.constraints=[{ characteristic = \"camber\", between = [-170.0, 170.0] }]";
    let scatter = "tolerance.scatter=[{ hardpoints = [\"lower_ball_joint\", \"upper_ball_joint\"], sigma = 3.0 }]";
    let at_end = "{ characteristic = \"camber\", at = 321.0, value = 0.0, tolerance = 1.0 }";
    let at_design = "{ characteristic = \"camber\", at = 0.0, value = 0.0, tolerance = 1.0 }";
    let is_accepted = |targets: &str, width: Option<Width>| {
        let targets = format!("optimise.targets=[{targets}]");
        let study = edited(
            "double_wishbone_tolerance.toml",
            &[
                far,
                variables,
                constraint,
                scatter,
                &targets,
                "optimise.scatter=32",
                "tolerance.bands=[]",
            ],
        );
        let optimise = study.optimise.as_ref().unwrap();
        let layout = TargetLayout::of(optimise, &study.vehicle);
        let assembled = study.vehicle.assembled().unwrap();
        let scatter = optimise.scatter.as_ref().unwrap();
        let variables = &optimise.variables;
        let problem = Objective::of_builds(&assembled, variables, &layout, scatter, width);
        let mut problem = problem.unwrap();
        let mut at = Assessment::new(&problem.shape());
        problem.assess(&DVector::zeros(1), &mut at).is_ok()
    };
    for width in [None, Width::widest()] {
        assert!(is_accepted(at_design, width));
        assert!(!is_accepted(&format!("{at_design}, {at_end}"), width));
    }
}
