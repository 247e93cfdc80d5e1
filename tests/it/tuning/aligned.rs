//! Tests of points on one plane or line, and of the margins of constraints between stations.

use super::edited;
use super::still::tuned;
use crate::support::larger;
use hardpoint::number::{Vector3, Width};
use hardpoint::optimise::{Assessment, Constrained, Objective, Price, TargetLayout, assessed};
use hardpoint::study::Study;
use nalgebra::DVector;

/// All orders of these names.
fn orders<'n>(names: &[&'n str]) -> Vec<Vec<&'n str>> {
    let [first, rest @ ..] = names else {
        return vec![Vec::new()];
    };
    let shorter = orders(rest);
    let places = shorter.iter().flat_map(|order| {
        (0..names.len()).map(move |place| {
            let mut order = order.clone();
            order.insert(place, first);
            order
        })
    });
    places.collect()
}

/// Rocker whose pushrod end is 3 mm out of the plane of the other points. No variable can bring it back completely.
fn rocker(kind: &str, order: &[&str]) -> Study {
    let constraint = format!("optimise.constraints=[{{ {kind} = {order:?} }}]");
    let overrides = [
        "suspension.hardpoints.pushrod_inner=[3.0, 265.0, 455.0]",
        "optimise.variables=[\
            { hardpoint = \"pushrod_inner\", axis = \"x\", range = [-1.0, 1.0] }, \
            { hardpoint = \"pushrod_inner\", axis = \"z\", range = [-5.0, 5.0] }, \
            { hardpoint = \"spring_lower\", axis = \"z\", range = [-10.0, 10.0] }]",
        "optimise.targets=[{ characteristic = \"motion_ratio\", at = 0.0, value = 0.9, tolerance = 0.01 }]",
        "optimise.good_enough=0.0",
        constraint.as_str(),
    ];
    edited("double_wishbone_rocker.toml", &overrides)
}

/// Violation of the only constraint in the design of a study.
fn violation(study: &Study) -> f64 {
    let optimise = study.optimise.as_ref().unwrap();
    let layout = TargetLayout::of(optimise, &study.vehicle);
    let found = assessed(study.wheel(), &optimise.variables, &layout);
    -found.unwrap().unwrap().margins[0].margin
}

fn points(study: &Study, names: &[&str]) -> Vec<Vector3<f64>> {
    let own = study.wheel();
    let at = |name: &&str| own.design[own.mechanism.point(name).unwrap().0];
    names.iter().map(at).collect()
}

/// A study lists the points of a plane or a line. Their order changes neither the violation, nor the tuned design, nor
/// the price of the constraint (misfit per unit of the limit). The violation is the distance from the plane through
/// the largest triangle, or from the line through the two points that are farthest apart.
#[test]
fn the_order_of_points_on_a_plane_or_line_does_not_matter() {
    let plane = [
        "pushrod_outer",
        "pushrod_inner",
        "spring_lower",
        "spring_upper",
    ];
    let line = ["pushrod_inner", "spring_lower", "spring_upper"];
    for (kind, names) in [("coplanar", &plane[..]), ("line", &line[..])] {
        let first = rocker(kind, names);
        let own = points(&first, names);
        let wanted = if kind == "line" {
            // The ends of the longest side are the pushrod's and the spring's upper end.
            let along = own[2] - own[0];
            along.cross(own[1] - own[0]).norm() / along.norm()
        } else {
            let volume = (own[1] - own[0])
                .cross(own[2] - own[0])
                .dot(own[3] - own[0]);
            let faces = [[0, 1, 2], [0, 1, 3], [0, 2, 3], [1, 2, 3]];
            let area = |[a, b, c]: [usize; 3]| (own[b] - own[a]).cross(own[c] - own[a]).norm();
            volume.abs() / faces.map(area).into_iter().fold(0.0, larger)
        };
        assert!(
            (violation(&first) - wanted).abs() < 1e-9,
            "{kind}: {wanted}"
        );
        let reference = tuned(&first).best.unwrap();
        assert!(reference.constraints[0].margin < -0.1, "{kind}");
        for (number, order) in orders(names).iter().enumerate() {
            let study = rocker(kind, order);
            assert_eq!(violation(&study), violation(&first), "{order:?}");
            if number % 5 == 0 {
                let best = tuned(&study).best.unwrap();
                assert_eq!(best.offsets, reference.offsets, "{order:?}");
                assert_eq!(best.constraints, reference.constraints, "{order:?}");
            }
        }
    }
}

/// Tunings with three points on a line give the same design and the same price of the constraint in every order of the
/// points. The tuned points are on the line to 1e-6 mm.
#[test]
fn a_line_is_met_exactly_at_one_price() {
    let names = ["lower_arm_front", "lower_arm_rear", "tie_rod_inner"];
    let at = |order: &[&str]| {
        let constraint = format!("optimise.constraints=[{{ line = {order:?} }}]");
        let overrides = [
            "optimise.variables=[\
                { hardpoint = \"tie_rod_inner\", axis = \"y\", range = [-60.0, 60.0] }, \
                { hardpoint = \"tie_rod_inner\", axis = \"z\", range = [-60.0, 60.0] }, \
                { hardpoint = \"tie_rod_outer\", axis = \"x\", range = [-10.0, 10.0] }]",
            "optimise.good_enough=0.0",
            constraint.as_str(),
        ];
        let study = edited("double_wishbone_front.toml", &overrides);
        let best = tuned(&study).best.unwrap();
        let moved = study.moved(&best.offsets);
        let own = points(&moved, &names);
        let along = own[1] - own[0];
        let off = along.cross(own[2] - own[0]).norm() / along.norm();
        assert!(off < 1e-6, "{off}");
        best
    };
    let first = at(&names);
    let Price::PerUnit(price) = first.constraints[0].price else {
        panic!("{:?}", first.constraints)
    };
    assert!(price > 0.0);
    for order in orders(&names) {
        let other = at(&order);
        assert_eq!(other.offsets, first.offsets);
        assert_eq!(other.constraints, first.constraints);
    }
}

/// The margin of an inactive limit belongs to the nearest pose, also between stations. The program reports this margin
/// and the travel of this pose.
#[test]
fn the_margin_of_a_limit_that_does_not_bind_is_that_between_stations() {
    let of = |steps: usize| {
        let motion = format!("motion.travel={{ from = -30.0, to = 30.0, steps = {steps} }}");
        let overrides = [
            motion.as_str(),
            "optimise.variables=[{ hardpoint = \"tie_rod_inner\", axis = \"z\", range = [-20.0, 20.0] }]",
            "optimise.targets=[{ characteristic = \"toe\", at = 0.0, value = 0.0, tolerance = 10.0 }]",
            "optimise.good_enough=1.0",
            "optimise.constraints=[{ point = \"upper_ball_joint\", outside = { sphere = { centre = [-25.0, 575.0, 530.0], radius = 20.0 } } }]",
        ];
        edited("double_wishbone_front.toml", &overrides)
    };
    let fine = of(6001);
    let optimise = fine.optimise.as_ref().unwrap();
    let layout = TargetLayout::of(optimise, &fine.vehicle);
    let problem = Objective::new(fine.wheel(), &optimise.variables, &layout).unwrap();
    let mut problem = problem.with_width(fine.wheel(), Width::widest());
    let mut at = Assessment::new(&problem.shape());
    problem.assess(&DVector::zeros(1), &mut at).unwrap();
    let rows = at.rows.residuals.iter().enumerate();
    let margins = rows.map(|(row, value)| (layout.margin(row, *value), row));
    let (wanted, row) = margins.min_by(|a, b| a.0.total_cmp(&b.0)).unwrap();
    let place = -30.0 + 0.01 * row as f64;
    let coarse = tuned(&of(3)).best.unwrap().constraints[0];
    assert!(
        wanted > 5.0 && place.abs() > 0.5 && place.abs() < 29.0,
        "{place}"
    );
    assert!((coarse.margin - wanted).abs() < 1e-4, "{coarse:?} {wanted}");
    assert!(
        (coarse.at.unwrap() - place).abs() < 0.02,
        "{coarse:?} {place}"
    );
}
