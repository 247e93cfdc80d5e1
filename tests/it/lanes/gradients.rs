//! Tests of gradients in lanes.

use super::*;

/// The gradient evaluator finds the same values in SIMD lanes and one by one. For every design that it cannot solve, it
/// gives a reason.
#[test]
fn the_evaluator_of_gradients_falls_back_one_by_one() {
    if !crate::support::has_lanes() {
        return;
    }
    let mut left_of_all = 0;
    for (name, by) in [
        ("macpherson_solve.toml", 90.0),
        ("double_wishbone_rocker.toml", 15.0),
        ("semi_trailing_arm_solve.toml", 60.0),
    ] {
        let study = study(name, "[-60.0, 0.0, 40.0]", "[0.0]");
        let suspension = study.wheel();
        let stations = Stations::of(study.motion(), &suspension.frame, &[]);
        let quantities = differentiable(&study);
        let points: Vec<PointId> = (0..suspension.design.len()).map(PointId).collect();
        let evaluator = |width| {
            GradientEvaluator::new(suspension, &stations, &quantities, &points, width)
                .expect("it is sound")
        };
        let (mut lanes, mut alone) = (evaluator(Width::widest()), evaluator(None));
        let points = suspension.design.len();
        let mut scatter = Scatter {
            random: Random(12),
            base: suspension.design.clone(),
            by,
        };
        let designs = scatter.block();
        let designs = &designs[..48 * points];
        let (mut found, mut wanted) = (Evaluated::default(), Evaluated::default());
        let left = lanes.evaluate([designs, &[]], &mut found);
        assert_eq!(alone.evaluate([designs, &[]], &mut wanted), 48);
        assert!(left < 48, "{name}: {left}");
        left_of_all += left;
        let mut compared = 0;
        for design in 0..48 {
            assert_eq!(found.fault(design), wanted.fault(design));
            let of = |e: &Evaluated, station| e.is_solved(design, station);
            for station in 0..stations.count() {
                assert_eq!(
                    of(&found, station),
                    of(&wanted, station),
                    "{design} {station}"
                );
            }
            if !(0..stations.count()).all(|station| of(&found, station)) {
                continue;
            }
            compared += 1;
            for (k, quantity) in quantities.iter().enumerate() {
                let size = suspension.size();
                let scale = scale_of(*quantity, size, size);
                for station in 0..stations.count() {
                    let [a, b] = [&found, &wanted].map(|e| e.value(design, k, station));
                    assert!(
                        (a - b).abs() < 1e-11 * scale,
                        "{name}: {quantity:?} {a} {b}"
                    );
                    let [a, b] =
                        [&found, &wanted].map(|e| e.gradient((design, k, station), Side::Left));
                    let scale = norm(b).max(scale / suspension.size());
                    for (a, b) in a.iter().zip(b) {
                        let missed = (*a - *b).norm();
                        assert!(missed < 1e-9 * scale, "{name}: {quantity:?} {a:?} {b:?}");
                    }
                }
            }
        }
        assert!(compared > 0, "{name}");
    }
    assert!(left_of_all > 0);
}

/// The values have the same bits whether the lanes contain stations of one design or several designs.
#[test]
fn one_design_alone_has_the_bits_it_has_among_others() {
    if !crate::support::has_lanes() {
        return;
    }
    let mut alone_in_lanes = 0;
    for (name, rack, by) in [
        ("macpherson_solve.toml", "[0.0, 12.0, -20.0]", 60.0),
        ("double_wishbone_solve.toml", "[0.0]", 30.0),
        ("double_wishbone_rocker.toml", "[0.0]", 15.0),
        ("five_link_solve.toml", "[0.0, 10.0]", 10.0),
        ("semi_trailing_arm_solve.toml", "[0.0]", 30.0),
    ] {
        let travels: Vec<String> = (0..41).map(|k| format!("{}.0", 3 * k - 60)).collect();
        let study = study(name, &format!("[{}]", travels.join(", ")), rack);
        let suspension = study.wheel();
        let stations = Stations::of(study.motion(), &suspension.frame, &[]);
        let quantities = differentiable(&study);
        let points: Vec<PointId> = (0..suspension.design.len()).map(PointId).collect();
        let width = Width::widest();
        let mut evaluator =
            GradientEvaluator::new(suspension, &stations, &quantities, &points, width)
                .expect("it is sound");
        let points = suspension.design.len();
        let mut scatter = Scatter {
            random: Random(5),
            base: suspension.design.clone(),
            by,
        };
        let designs = scatter.block();
        let designs = &designs[..16 * points];
        let (mut among, mut alone) = (Evaluated::default(), Evaluated::default());
        let fallback = evaluator.evaluate([designs, &[]], &mut among);
        let mut fallback_alone = 0;
        for (number, design) in designs.chunks_exact(points).enumerate() {
            fallback_alone += evaluator.evaluate([design, &[]], &mut alone);
            assert_eq!(among.fault(number), alone.fault(0), "{name}");
            for (k, quantity) in quantities.iter().enumerate() {
                for station in 0..stations.count() {
                    let values = [among.value(number, k, station), alone.value(0, k, station)];
                    let bits = values.map(f64::to_bits);
                    assert_eq!(bits[0], bits[1], "{name}: {quantity:?}");
                    let among = among.gradient((number, k, station), Side::Left);
                    for (a, b) in among
                        .iter()
                        .zip(alone.gradient((0, k, station), Side::Left))
                    {
                        let bits = [a, b].map(|v| v.to_array().map(f64::to_bits));
                        assert_eq!(bits[0], bits[1], "{name}: {quantity:?}");
                    }
                }
            }
        }
        assert_eq!(fallback, fallback_alone, "{name}");
        alone_in_lanes += 16 - fallback_alone;
    }
    assert!(alone_in_lanes > 40, "{alone_in_lanes}");
}

/// In lanes, gradients come from the adjoint of the closed form. For single designs, they come from the adjoint of the
/// closure equations. Both are equal.
#[test]
fn gradients_in_lanes_are_those_of_the_closure_equations() {
    for (name, rack, by) in [
        ("macpherson_solve.toml", "[0.0, 20.0]", 30.0),
        ("macpherson_front.toml", "[0.0]", 30.0),
        ("double_wishbone_solve.toml", "[-15.0]", 20.0),
        ("five_link_solve.toml", "[0.0, 10.0]", 10.0),
        ("semi_trailing_arm_solve.toml", "[0.0]", 30.0),
        ("double_wishbone_rocker.toml", "[0.0]", 3.0),
    ] {
        let study = study(name, "[-50.0, 0.0, 20.0, 60.0]", rack);
        let suspension = study.wheel();
        let (mechanism, size) = (&suspension.mechanism, suspension.size());
        let stations = Stations::of(study.motion(), &suspension.frame, &[]);
        let angles = differentiable(&study);
        let angles = &angles[..];
        let wanted: Vec<AngleTarget> = (0..angles.len() * stations.count())
            .map(|k| AngleTarget {
                value: 0.01 * k as f64 - 0.02,
                weight: (k % 3) as f64,
            })
            .collect();
        let in_lanes = |width| {
            Gradients::new(suspension, &stations, angles, width)
                .unwrap_or_else(|| panic!("{name} has gradients in lanes"))
        };
        let Some(widest) = Width::widest() else {
            return;
        };
        let mut lanes = in_lanes(widest);
        let mut scatter = Scatter {
            random: Random(8),
            base: suspension.design.clone(),
            by,
        };
        let points = suspension.design.len();
        let designs = scatter.block();
        let designs = &designs[..lanes.at_once() * points];
        let jacobians = collected(&mut lanes, designs, angles.len(), stations.count(), points);
        let sums = |lanes: &mut Gradients<'_>, designs: &[Vector3<f64>]| -> Vec<(f64, Vec<_>)> {
            let count = designs.len() / points;
            let deviations = lanes.deviations(designs, &wanted);
            let of = |design| {
                let gradient = (0..points).map(|p| deviations.gradient(design, PointId(p)));
                (deviations.sum(design), gradient.collect())
            };
            (0..count).map(of).collect()
        };
        let deviations = sums(&mut lanes, designs);

        // The gradients have the same bits for a design alone and in the narrowest lanes.
        let mut narrow = in_lanes(Width::available().next().unwrap_or(widest));
        for (number, design) in designs.chunks_exact(points).enumerate() {
            let alone = collected(&mut narrow, design, angles.len(), stations.count(), points);
            assert_eq!(narrow.is_accepted(0), lanes.is_accepted(number));
            let sum = sums(&mut narrow, design);
            if narrow.is_accepted(0) {
                assert_eq!(alone[0], jacobians[number]);
                assert_eq!(sum[0], deviations[number]);
            }
        }

        let mut right = 0;
        for (number, design) in designs.chunks_exact(points).enumerate() {
            if !lanes.is_accepted(number) {
                continue;
            }
            right += 1;
            let mut sum = 0.0;
            let mut by_points = vec![Vector3::default(); points];
            let careful = careful_gradients(&study, &stations, design, angles);
            for (k, (value, gradient)) in careful.iter().enumerate() {
                let (found, by_point) = &jacobians[number][k];
                let quantity = angles[k / stations.count()];
                let of_quantity =
                    &careful[k / stations.count() * stations.count()..][..stations.count()];
                let scale = scale_of(quantity, size, size);
                let largest = of_quantity.iter().map(|(_, g)| norm(g));
                let largest = largest.fold(scale / size, larger);
                let missed = (found - value).abs() / scale;
                assert!(missed < 1e-12, "{name}: {quantity:?} {found} {value}");
                let AngleTarget { value: v, weight } = wanted[k];
                sum += weight * (value - v) * (value - v);
                for (point, wanted) in gradient.iter().enumerate() {
                    let found = by_point[point];
                    let missed = (found - *wanted).norm() / largest;
                    let what = &mechanism.points[point].name;
                    assert!(
                        missed < 1e-11,
                        "{name}, {quantity:?} by {what}: {found:?} {wanted:?}"
                    );
                    by_points[point] = by_points[point] + *wanted * (2.0 * weight * (value - v));
                }
            }
            let missed = (deviations[number].0 - sum).abs();
            assert!(missed < 1e-12 * sum, "{name}: {missed}");
            let scale = norm(&by_points).max(sum / size);
            for (point, wanted) in by_points.iter().enumerate() {
                let found = deviations[number].1[point];
                assert!((found - *wanted).norm() < 1e-11 * scale, "{name}");
            }
        }
        assert!(2 * right > lanes.at_once(), "{name}: {right}");
    }
}

/// Returns the value and the gradient of each angle at each station, for each design.
fn collected(
    lanes: &mut Gradients<'_>,
    designs: &[Vector3<f64>],
    angles: usize,
    stations: usize,
    points: usize,
) -> Vec<Vec<(f64, Vec<Vector3<f64>>)>> {
    let count = designs.len() / points;
    let mut collected = vec![vec![(0.0, Vec::new()); angles * stations]; count];
    lanes.jacobians(designs, |jacobians| {
        for (design, collected) in collected.iter_mut().enumerate() {
            for angle in 0..angles {
                let gradient = |point| jacobians.gradient(design, angle, PointId(point));
                collected[angle * stations + jacobians.station()] = (
                    jacobians.value(design, angle),
                    (0..points).map(gradient).collect(),
                );
            }
        }
    });
    collected
}

fn norm(gradient: &[Vector3<f64>]) -> f64 {
    gradient
        .iter()
        .map(|g| g.norm_squared())
        .sum::<f64>()
        .sqrt()
}

/// Returns the value and the gradient of each angle at each station, from the closure equations.
fn careful_gradients(
    study: &Study,
    stations: &Stations,
    design: &[Vector3<f64>],
    angles: &[Quantity],
) -> Vec<(f64, Vec<Vector3<f64>>)> {
    let mechanism = &study.wheel().mechanism;
    let mut solver = Solver::new(mechanism, design).expect("lanes solved this design");
    let design_series = DesignSeries::<1>::new(mechanism, design);
    let constants = Constants::of(study.wheel());
    let none = Vector3::new(0.0, 0.0, 0.0).map(Jet::constant);
    let mut buffer = vec![none; design.len()];
    let mut found = vec![(0.0, Vec::new()); angles.len() * stations.count()];
    for (number, rack) in stations.racks.iter().enumerate() {
        let visited = solver.for_each_pose(
            stations.drive,
            &stations.station_order,
            *rack,
            |solver, k, pose| {
                let pose = pose.as_ref().expect("lanes solved this design");
                let motion = MotionPoint {
                    drive: stations.drive,
                    value: stations.station_order.values()[k],
                    rack: *rack,
                };
                let linearised = solver
                    .linearised(&design_series, pose, &motion.along_drive())
                    .expect("lanes solved this design");
                let view = WheelReading::of(&linearised.at, constants);
                for (angle, quantity) in angles.iter().copied().enumerate() {
                    let at = angle * stations.count() + stations.number(number, k);
                    let mut gradient = vec![Vector3::default(); design.len()];
                    view.gradients(
                        &linearised,
                        quantity,
                        0,
                        &mut buffer,
                        &mut |_, point, by| {
                            gradient[point.0] = by;
                        },
                    );
                    found[at] = (view.value(&linearised.at, quantity)[0], gradient);
                }
                ControlFlow::Continue(())
            },
        );
        visited.expect("lanes solved this design");
    }
    found
}
