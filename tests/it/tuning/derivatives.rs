//! Tests of the derivatives of targets and constraints.

use super::*;

/// The derivatives of every kind of target and constraint equal finite differences of sixth order, to 1e-9 of the largest
/// derivative of the same kind. The test uses designs away from the nominal design, at stations and between stations.
#[test]
fn derivatives_of_targets_and_constraints_are_exact() {
    let rim = "{ point = \"tie_rod_outer\", inside = { rim = 150.0, from = -90.0, to = 20.0 }, clearance = 4.0 }";
    let places = "{ point = \"tie_rod_outer\", inside = { box = [[-500, 0, 0], [500, 900, 900]] } }, \
        { point = \"wheel_centre\", outside = { box = [[-100, 100, 0], [100, 300, 200]] }, clearance = 3.0 }, \
        { point = \"tie_rod_outer\", outside = { cylinder = { from = [0, 100, 100], to = [50, 400, 120], radius = 30.0 } } }, \
        { point = \"tie_rod_inner\", inside = { sphere = { centre = [10.0, 300.0, 200.0], radius = 500.0 } } }, \
        { point = \"tie_rod_outer\", inside = { cylinder = { from = [0, 0, 0], to = [0, 900, 100], radius = 600.0 } } }, \
        { point = \"wheel_centre\", inside = { half_space = { point = [0, 0, 0], normal = [0.1, 1.0, 0.2] } } }";
    let parts = "{ members = [\"tie_rod\", \"lower_arm_front\"], radii = [8.0, 9.0], clearance = 5.0 }, \
        { articulation = \"lower_ball_joint\", at_most = 20.0 }, \
        { articulation = \"tie_rod_outer\", at_most = 25.0 }, \
        { articulation = \"drive_shaft_outer\", at_most = 40.0 }, \
        { articulation = \"drive_shaft_inner\", at_most = 20.0 }, \
        { plunge = \"drive_shaft\", between = [-30.0, 20.0] }, \
        { members = [\"tie_rod\", \"lower_arm_front\", \"drive_shaft\"], radii = [8.0, 9.0, 15.0], clearance = 2.0, \
            inside = { rim = 260.0, from = -90.0, to = 40.0 } }, \
        { length = \"tie_rod\", between = [100.0, 900.0] }, \
        { length = [\"tie_rod_outer\", \"lower_arm_front\"], at_least = 10.0 }, \
        { coplanar = [\"lower_arm_front\", \"lower_arm_rear\", \"lower_ball_joint\", \"tie_rod_outer\"] }, \
        { line = [\"lower_arm_front\", \"lower_arm_rear\", \"tie_rod_inner\"] }, \
        { characteristic = \"camber\", between = [-9.0, 9.0] }";
    let constraints = format!("optimise.constraints=[{rim}, {places}, {parts}]");
    let variables = "optimise.variables=[\
        { hardpoint = \"tie_rod_inner\", axis = \"z\", range = [-20.0, 20.0] }, \
        { hardpoint = \"lower_arm_front\", axis = \"y\", range = [-20.0, 20.0] }, \
        { rigid = [\"lower_ball_joint\", \"tie_rod_outer\", \"wheel_centre\"], shift = 10.0, turn = 3.0 }]";
    let targets = "optimise.targets=[\
        { characteristic = \"camber\", between = [[[-80.0, -1.0], [80.0, 0.5]], [[-80.0, 1.0], [80.0, 2.5]]], tolerance = 0.05 }, \
        { characteristic = \"bump_steer\", at_most = 0.002, tolerance = 0.0005, rack = [0.0, 10.0] }, \
        { point = \"tie_rod_outer\", axis = \"x\", at = 10.0, value = -130.0, tolerance = 0.5 }, \
        { length = [\"tie_rod_inner\", \"wheel_centre\"], at_least = 100.0, tolerance = 0.5 }, \
        { characteristic = \"toe\", points = [[-40.0, 0.1], [40.0, -0.1]], tolerance = 0.05, motion = \"steer\" }]";
    let steer = "motions.steer={ travel = [-40.0, 0.0, 40.0], rack = 12.0 }";
    let travel = "motion.travel={ from = -60.0, to = 60.0, steps = 7 }";
    let [inner, outer] = DRIVE_SHAFT;
    for file in ["macpherson_front.toml", "double_wishbone_front.toml"] {
        let study = edited(
            file,
            &[
                travel,
                steer,
                inner,
                outer,
                variables,
                targets,
                &constraints,
            ],
        );
        let optimise = study.optimise.as_ref().unwrap();
        let suspension = study.wheel();
        let layout = TargetLayout::of(optimise, &study.vehicle);
        let mut problem = Objective::new(suspension, &optimise.variables, &layout).unwrap();
        let n = optimise.variables.len();
        let x = nalgebra::DVector::from_fn(n, |j, _| 2.0 * ((j * 7 + 3) as f64).sin());
        check_derivatives(file, &mut problem, &layout, &x);
    }
}

/// Compares the derivatives of residuals and constraint values at `x` with finite differences of sixth order. The test compares
/// every constraint value, and residuals of at least two targets.
fn check_derivatives(
    name: &str,
    problem: &mut Objective<'_>,
    layout: &TargetLayout,
    x: &nalgebra::DVector<f64>,
) {
    let (n, shape) = (x.len(), Constrained::shape(problem));
    let mut at = |x: &nalgebra::DVector<f64>| {
        let mut found = Assessment::new(&shape);
        problem
            .assess(x, &mut found)
            .unwrap_or_else(|e| panic!("{name}: {e}"));
        found
    };
    let here = at(x);
    let targets = layout.targets_of_rows();
    assert!(shape.rows > 0, "{name}");
    let mut compared = std::collections::BTreeSet::new();
    for j in 0..n {
        let h = 0.05;
        let moved = |steps: f64| {
            let mut moved = x.clone();
            moved[j] += steps * h;
            moved
        };
        let steps = [1.0, 2.0, 3.0].map(|k| (at(&moved(k)), at(&moved(-k))));
        for (is_goal, count) in [(true, shape.goal), (false, shape.rows)] {
            let part = |of: &Assessment, row: usize| {
                if is_goal {
                    of.goal.residuals[row]
                } else {
                    of.rows.residuals[row]
                }
            };
            for row in 0..count {
                let weights = [45.0 / 60.0, -9.0 / 60.0, 1.0 / 60.0];
                let differences = steps.iter().zip(weights);
                let slope: f64 = differences
                    .map(|((up, down), w)| w * (part(up, row) - part(down, row)))
                    .sum::<f64>()
                    / h;
                let of = if is_goal { &here.goal } else { &here.rows };
                // At the edge of a band, a derivative is one-sided, so the test omits it.
                let inside = |at: &Assessment| part(at, row) == 0.0;
                if is_goal && (inside(&here) || steps.iter().any(|(u, d)| inside(u) || inside(d))) {
                    continue;
                }
                if is_goal {
                    compared.insert(targets[row]);
                }
                // The scale is the largest derivative of the same target or constraint.
                let kind = |row: usize| {
                    if is_goal {
                        targets[row]
                    } else {
                        layout.labels()[row].constraint
                    }
                };
                let same = (0..count).filter(|other| kind(*other) == kind(row));
                let largest = same
                    .map(|row| of.jacobian.row(row).amax())
                    .fold(1e-2, larger);
                // Rounding error of the finite differences.
                let rounding = 16.0 * f64::EPSILON * (1.0 + of.residuals[row].abs()) / h;
                let bound = 1e-9 + rounding / largest;
                let off = (slope - of.jacobian[(row, j)]).abs() / largest;
                assert!(
                    off < bound,
                    "{name}: variable {j}, {} {row}: {slope} {} ({off:e})",
                    if is_goal { "residual" } else { "row" },
                    of.jacobian[(row, j)]
                );
            }
        }
    }
    assert!(compared.len() >= 2, "{name}: {compared:?}");
}

/// Derivatives of targets and constraints that every topology has are exact, for a point of the carrier. The design is
/// random, within 6 mm of the study's in every coordinate of six points.
#[test]
fn derivatives_are_exact_at_a_random_design_of_every_topology() {
    for (file, carried, more, forces) in [
        (
            "macpherson_front.toml",
            "tie_rod_outer",
            "{ members = [\"strut\", \"tie_rod\"], radii = [30.0, 8.0], clearance = 2.0 }",
            ["tie_rod", "strut_side_y"],
        ),
        (
            "double_wishbone_front.toml",
            "upper_ball_joint",
            "{ articulation = \"upper_ball_joint\", at_most = 20.0 }",
            ["lower_arm_front", "upper_ball_joint_y"],
        ),
        (
            "double_wishbone_rocker.toml",
            "tie_rod_outer",
            "{ members = [\"pushrod\", \"upper_arm_front\"], radii = [8.0, 10.0], clearance = 5.0 }, { characteristic = \"spring_length\", between = [165.0, 205.0] }",
            ["pushrod", "lower_ball_joint_x"],
        ),
        (
            "five_link_rear.toml",
            "toe_link_outer",
            "{ members = [\"toe_link\", \"lower_rear_link\"], radii = [9.0, 11.0], clearance = 5.0 }, { length = \"upper_rear_link\", at_least = 90.0 }",
            ["toe_link", "support"],
        ),
        (
            "semi_trailing_arm_rear.toml",
            "wheel_centre",
            "{ length = [\"arm_pivot_inner\", \"wheel_centre\"], between = [500.0, 800.0] }",
            ["arm_pivot_inner_x", "arm_pivot_outer_z"],
        ),
    ] {
        let plain = edited(file, &[]);
        let names: Vec<String> = plain
            .wheel()
            .mechanism
            .points
            .iter()
            .map(|p| p.name.clone())
            .collect();
        let axes = ["x", "y", "z"];
        let step = (names.len() / 6).max(1);
        let variables: Vec<String> = (0..6)
            .map(|k| {
                (
                    names[(k * step) % names.len()].clone(),
                    axes[(k + k / names.len()) % 3],
                )
            })
            .map(|(name, axis)| {
                format!("{{ hardpoint = \"{name}\", axis = \"{axis}\", range = [-9.0, 9.0] }}")
            })
            .collect();
        let variables = format!("optimise.variables=[{}]", variables.join(", "));
        let targets = format!(
            "optimise.targets=[\
            {{ characteristic = \"camber\", between = [-0.5, 0.5], tolerance = 0.05 }}, \
            {{ characteristic = \"bump_steer\", at_most = -0.05, tolerance = 0.0005 }}, \
            {{ characteristic = \"toe\", points = [[-40.0, 0.9], [40.0, -0.7]], tolerance = 0.05 }}, \
            {{ point = \"{carried}\", axis = \"x\", at = 10.0, value = -400.0, tolerance = 0.5 }}, \
            {{ load = \"kerb_{0}\", points = [[-30.0, -9e3], [30.0, 8e3]], tolerance = 20.0 }}, \
            {{ load = \"kerb_{1}\", at = -10.0, value = 5e3, tolerance = 20.0 }}, \
            {{ characteristic = \"roll_centre_height\", at = 0.0, value = 900.0, tolerance = 2.0 }}]",
            forces[0], forces[1]
        );
        let loads = "outputs.loads=[{ name = \"kerb\", at = \"contact_point\", force = [-900.0, 400.0, 3000.0], \
            moment = [2e4, -3e4, 5e4] }]";
        // The wheel centre is on the spin axis. So the distance of the wheel centre from this axis has no derivative.
        let rim = match carried {
            "wheel_centre" => String::new(),
            _ => format!(
                "{{ point = \"{carried}\", inside = {{ rim = 160.0, from = -200.0, to = 40.0 }}, clearance = 4.0 }}, "
            ),
        };
        let constraints = format!(
            "optimise.constraints=[\
            {rim}\
            {{ point = \"{carried}\", inside = {{ sphere = {{ centre = [10.0, 300.0, 200.0], radius = 600.0 }} }} }}, \
            {{ point = \"{carried}\", inside = {{ half_space = {{ point = [0, 0, 0], normal = [0.1, 1.0, 0.2] }} }} }}, \
            {{ load = \"kerb_{0}\", between = [-9e4, 9e4] }}, {{ load = \"kerb_{1}\", at_most = 9e4 }}, \
            {more}]",
            forces[0], forces[1]
        );
        let travel = "motion.travel={ from = -30.0, to = 30.0, steps = 5 }";
        let wheel = "wheel.radius=290.0";
        let study = edited(
            file,
            &[travel, wheel, loads, &variables, &targets, &constraints],
        );
        let optimise = study.optimise.as_ref().unwrap();
        let suspension = study.wheel();
        let layout = TargetLayout::of(optimise, &study.vehicle);
        let mut problem = Objective::new(suspension, &optimise.variables, &layout).unwrap();
        let mut seed = 0x9E37_79B9_7F4A_7C15;
        let n = optimise.variables.len();
        let x = nalgebra::DVector::from_fn(n, |_, _| 6.0 * noise(&mut seed));
        check_derivatives(file, &mut problem, &layout, &x);
    }
}
