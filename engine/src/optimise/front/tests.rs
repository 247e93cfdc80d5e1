//! Tests of Pareto fronts with known shapes.

use super::super::test_problems::{Values, stated};
use super::super::trade::{Criterion, Distance};
use super::super::{Bounds, Control, Options};
use super::{Found, Traced, Tracer, single_end};
use nalgebra::DVector;

/// Traces a Pareto front with this number of criteria. Each criterion has this number of residuals.
fn traced(
    ranges: &[[f64; 2]],
    [aims, each]: [usize; 2],
    starts: &[&[f64]],
    at: fn(&[f64]) -> Values,
) -> Traced {
    let bounds = Bounds::new(ranges).unwrap();
    let design = DVector::zeros(ranges.len());
    let distance = Distance::new(&design, &bounds, &vec![1.0; ranges.len()]);
    let options = Options::default();
    let tracer = Tracer {
        problem: || {
            stated(design.as_slice(), 0, f64::INFINITY, |x| {
                [at(x), vec![], vec![]]
            })
        },
        bounds: &bounds,
        distance: &distance,
        aims: (0..aims)
            .map(|aim| Criterion::misfit((aim * each..(aim + 1) * each).collect(), 1.0))
            .collect(),
        rest: Vec::new(),
        options: &options,
        control: Control::default(),
    };
    let starts: Vec<DVector<f64>> = starts
        .iter()
        .map(|start| DVector::from_column_slice(start))
        .collect();
    tracer.front(&starts.iter().collect::<Vec<_>>(), 0.0)
}

/// Widest step between neighbouring points, as a share of the extent of the Pareto front.
fn widest_step(points: &[Found]) -> f64 {
    let (first, last) = (&points[0].amounts, &points[points.len() - 1].amounts);
    let extent = [last[0] - first[0], first[1] - last[1]];
    let steps = points.windows(2).map(|pair| {
        let (a, b) = (&pair[0].amounts, &pair[1].amounts);
        ((b[0] - a[0]) / extent[0]).max((a[1] - b[1]) / extent[1])
    });
    steps.fold(0.0, f64::max)
}

/// Vector from a given point to `x`. The norm of this vector is the distance between the two points.
fn way_from(x: &[f64], from: [f64; 2]) -> Values {
    vec![
        (x[0] - from[0], vec![1.0, 0.0]),
        (x[1] - from[1], vec![0.0, 1.0]),
    ]
}

/// Test problem with exponentials of distances (C. M. Fonseca, P. J. Fleming, 1995). With the distance d between the two peaks,
/// 1 - f_2 = exp(-(d - sqrt(-ln(1 - f_1)))^2). Weighted sums have their minima only at the ends of the Pareto front.
#[test]
fn a_concave_front_is_traced_evenly() {
    let traced = traced(
        &[[-4.0, 4.0]; 3],
        [2, 1],
        &[&[0.1, -0.2, 0.3], &[-0.4, -0.4, -0.4]],
        |x| {
            let aim = |sign: f64| {
                let off: Vec<f64> = x.iter().map(|x| x - sign / 3.0_f64.sqrt()).collect();
                let bell = (-off.iter().map(|d| d * d).sum::<f64>()).exp();
                (1.0 - bell, off.iter().map(|d| 2.0 * d * bell).collect())
            };
            vec![aim(1.0), aim(-1.0)]
        },
    );
    assert_eq!(traced.points.len(), 50);
    assert!(traced.breaks.is_empty(), "{:?}", traced.breaks);
    assert!(
        widest_step(&traced.points) < 0.045,
        "{}",
        widest_step(&traced.points)
    );
    for point in &traced.points[1..49] {
        let [first, second] = point.amounts[..] else {
            panic!()
        };
        let way = 2.0 - (-(1.0 - first).ln()).sqrt();
        let wanted = 1.0 - (-way * way).exp();
        assert!((second - wanted).abs() < 1e-6, "{first}: {second} {wanted}");
        // The weights are the normal of the Pareto front.
        let step = 1e-5;
        let on = |f: f64| 1.0 - (-(2.0 - (-(1.0 - f).ln()).sqrt()).powi(2)).exp();
        let slope = (on(first + step) - on(first - step)) / (2.0 * step);
        let found = -point.weights[0] / point.weights[1];
        assert!(
            (found - slope).abs() < 1e-3 * slope.abs(),
            "{found} {slope}"
        );
    }
}

/// Criterion f_2 = 2 - sqrt(f_1 + 0.02) - f_1 sin(10 pi f_1), with a variable that only f_2 depends on. The problem is similar
/// to ZDT3 (E. Zitzler, K. Deb, L. Thiele, 2000). Its Pareto front consists of separate pieces; a fine grid gives the
/// reference.
#[test]
fn a_broken_front_is_found_piece_by_piece() {
    let curve = |x: f64| 2.0 - (x + 0.02).sqrt() - x * (10.0 * std::f64::consts::PI * x).sin();
    let traced = traced(
        &[[0.0, 1.0], [-1.0, 1.0]],
        [2, 2],
        &[&[0.02, 0.3], &[0.83, -0.4]],
        |x| {
            let turn = 10.0 * std::f64::consts::PI;
            let (u, v) = (x[0], x[1]);
            let slope = -0.5 / (u + 0.02).sqrt() - (turn * u).sin() - u * turn * (turn * u).cos();
            let second = 2.0 - (u + 0.02).sqrt() - u * (turn * u).sin();
            // Only the second criterion depends on this variable. The best value of the variable is 0.
            let idle = (0.0, vec![0.0; 2]);
            vec![
                (u, vec![1.0, 0.0]),
                idle,
                (second, vec![slope, 0.0]),
                (v, vec![0.0, 1.0]),
            ]
        },
    );
    let places: Vec<_> = traced.points.iter().map(|p| &p.amounts).collect();
    // Finds the Pareto front along a fine grid: the points with a smaller f_2 than all points before them.
    let grid = 200_000;
    let mut least = f64::INFINITY;
    let mut best: Vec<[f64; 2]> = Vec::new();
    for k in 0..=grid {
        let x = k as f64 / grid as f64;
        if curve(x) < least {
            least = curve(x);
            best.push([x, least]);
        }
    }
    for point in &traced.points {
        let [first, second] = point.amounts[..] else {
            panic!()
        };
        let before = best.partition_point(|p| p[0] <= first) - 1;
        assert!(
            second < best[before][1] + 1e-3,
            "{first}: {second} {:?}",
            best[before]
        );
    }
    for [x, y] in &best {
        let near = traced
            .points
            .iter()
            .map(|p| (p.amounts[0] - x).abs().max((p.amounts[1] - y).abs()));
        let near = near.fold(f64::INFINITY, f64::min);
        assert!(near < 0.08, "nothing near {x} {y}: {near}, {places:?}");
    }
    let jumps = best
        .windows(2)
        .filter(|pair| pair[1][0] - pair[0][0] > 0.03);
    assert_eq!(traced.breaks.len(), jumps.count(), "{:?}", traced.breaks);
}

/// Two criteria, the distances from two points of a plane. The Pareto front is the segment between them, and both criteria have
/// equal weights.
#[test]
fn a_straight_front_has_its_slope_everywhere() {
    let traced = traced(&[[-5.0, 5.0]; 2], [2, 2], &[&[0.4, 1.1]], |x| {
        [way_from(x, [-1.0, 0.0]), way_from(x, [2.0, 1.0])].concat()
    });
    let apart = 10.0_f64.sqrt();
    assert_eq!(traced.points.len(), 50);
    // The Pareto front reaches its ends. At each end one distance is zero, and the other is the distance between the two
    // points.
    for (end, aim) in [(&traced.points[0], 1), (&traced.points[49], 0)] {
        assert!((end.amounts[aim] - apart).abs() < 1e-3 * apart);
        assert!(end.amounts[1 - aim] < 1e-3, "{:?}", end.amounts);
    }
    for point in &traced.points[1..49] {
        let sum: f64 = point.amounts.iter().sum();
        assert!((sum - apart).abs() < 1e-6, "{:?}", point.amounts);
        assert!((point.weights[0] - 0.5).abs() < 1e-3, "{:?}", point.weights);
    }
    assert!(widest_step(&traced.points) < 0.045);
}

/// Each goal has a constant residual, so the smallest possible misfit of the goal is above zero. The ends of the Pareto front
/// are the minima of each goal alone.
#[test]
fn a_front_ends_at_the_minima_of_each_goal() {
    let traced = traced(&[[-5.0, 5.0]; 2], [2, 3], &[&[0.4, 1.1]], |x| {
        // The constant residual, 1 or 2, is the only one left at a goal's minimum. So it is the smallest value of the goal.
        let aim =
            |from: [f64; 2], rest: f64| [way_from(x, from), vec![(rest, vec![0.0; 2])]].concat();
        [aim([-1.0, 0.0], 1.0), aim([2.0, 1.0], 2.0)].concat()
    });
    let (first, last) = (&traced.points[0], &traced.points[traced.points.len() - 1]);
    assert!((first.amounts[0] - 1.0).abs() < 2e-4, "{:?}", first.amounts);
    assert!((last.amounts[1] - 2.0).abs() < 4e-4, "{:?}", last.amounts);
    assert!(widest_step(&traced.points) < 0.1);
}

/// If one design is best in all criteria, the Pareto front contains only this design.
#[test]
fn without_a_trade_there_is_one_point() {
    let traced = traced(&[[-5.0, 5.0]; 2], [2, 1], &[&[0.4, 1.1]], |x| {
        vec![(x[0] - 1.0, vec![1.0, 0.0]), (x[1] - 2.0, vec![0.0, 1.0])]
    });
    assert_eq!(traced.points.len(), 1);
    assert!(traced.points[0].amounts.iter().all(|amount| *amount < 1e-5));
}

/// Values below the good value count as equal. Differences above it are a trade-off, even if they are smaller than the good value.
#[test]
fn only_good_values_count_as_equal() {
    let found = |amounts: [f64; 2]| Found {
        x: DVector::zeros(1),
        amounts: amounts.to_vec(),
        weights: vec![0.5; 2],
    };
    let [first, last] = [found([0.05, 0.9]), found([0.1, 0.3])];
    assert_eq!(single_end([&first, &last], 0.1), Some(&last));
    assert_eq!(single_end([&first, &last], 0.0), None);
    let [first, last] = [found([1.4, 4.3]), found([1.7, 2.3])];
    assert_eq!(single_end([&first, &last], 1.0), None);
}

/// Three criteria, the distances from three points. The Pareto front is the triangle of these points, and every part of the
/// triangle has a computed point nearby.
#[test]
fn a_front_of_three_covers_the_triangle() {
    let corners = [[-1.0, 0.0], [2.0, 0.5], [0.3, 2.0]];
    let traced = traced(&[[-5.0, 5.0]; 2], [3, 2], &[&[0.4, 1.1]], |x| {
        let corners = [[-1.0, 0.0], [2.0, 0.5], [0.3, 2.0]];
        corners.map(|corner| way_from(x, corner)).concat()
    });
    assert!(traced.points.len() >= 30, "{}", traced.points.len());
    let barycentric = |x: &DVector<f64>| {
        let area = |a: [f64; 2], b: [f64; 2], c: [f64; 2]| {
            (b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1])
        };
        let [a, b, c] = corners;
        let (p, whole) = ([x[0], x[1]], area(a, b, c));
        [
            area(p, b, c) / whole,
            area(a, p, c) / whole,
            area(a, b, p) / whole,
        ]
    };
    for point in &traced.points {
        let least = barycentric(&point.x).into_iter().fold(1.0, f64::min);
        assert!(least > -1e-3, "{:?} {least}", point.x);
    }
    for i in 0..=8 {
        for j in 0..=8 - i {
            let (a, b) = (f64::from(i) / 8.0, f64::from(j) / 8.0);
            let c = 1.0 - a - b;
            let at = [0, 1].map(|k| a * corners[0][k] + b * corners[1][k] + c * corners[2][k]);
            let near = traced
                .points
                .iter()
                .map(|p| (p.x[0] - at[0]).hypot(p.x[1] - at[1]));
            let near = near.fold(f64::INFINITY, f64::min);
            assert!(near < 0.75, "nothing near {at:?}: {near}");
        }
    }
}
