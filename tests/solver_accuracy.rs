//! `[solver] accuracy`: less work, and an error that is never larger than the one claimed.

use hardpoint::curves::curves;
use hardpoint::derive::MotionPoint;
use hardpoint::mechanism::{Configuration, Pose};
use hardpoint::model::{Body, Drive, Suspension};
use hardpoint::number::Vector3;
use hardpoint::plan::Plan;
use hardpoint::solve::{PoseError, Solver, StationOrder};
use hardpoint::study::Study;
use std::ops::ControlFlow;
use std::path::Path;

const STUDIES: [&str; 3] = [
    "macpherson_solve.toml",
    "double_wishbone_solve.toml",
    "five_link_solve.toml",
];
const POSES: usize = 10_000;

fn study(name: &str, overrides: &[&str]) -> Study {
    let path = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("studies")
        .join(name);
    let overrides: Vec<String> = overrides.iter().map(|o| (*o).to_owned()).collect();
    Study::read(&path, &overrides).unwrap_or_else(|e| panic!("{e}"))
}

/// Numbers in [-1, 1): G. L. Steele, D. Lea, C. H. Flood, Fast splittable pseudorandom number
/// generators, OOPSLA 2014.
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^= z >> 31;
        (z >> 11) as f64 * (2.0 / (1_u64 << 53) as f64) - 1.0
    }
}

fn poses(
    solver: &mut Solver<'_>,
    station_order: &StationOrder,
    rack: f64,
) -> Vec<Option<Pose<f64>>> {
    let mut found = vec![None; station_order.values().len()];
    let visited = solver.for_each_pose(Drive::Travel, station_order, rack, |_, station, pose| {
        found[station] = pose.ok().copied();
        ControlFlow::Continue(())
    });
    visited.map_or_else(|_| Vec::new(), |()| found)
}

/// What separates a pose from the true one: the farthest of the points that the knuckle carries, and
/// the turn between them.
fn error(suspension: &Suspension, found: &Pose<f64>, truth: &Pose<f64>) -> PoseError {
    let mechanism = &suspension.mechanism;
    let at = |pose: &Pose<f64>| Configuration {
        mechanism,
        design: &suspension.design,
        pose: *pose,
        rack: 0.0,
        steering: None,
    };
    let carried = mechanism.points.iter().enumerate();
    let carried = carried.filter(|(_, p)| p.body == Body::Knuckle);
    let apart = carried.map(|(i, _)| {
        let id = hardpoint::model::PointId(i);
        (at(found).point(id) - at(truth).point(id)).norm()
    });
    // The vector of the turn is half the sum of the columns' vector products.
    let columns = found
        .rotation
        .columns
        .into_iter()
        .zip(truth.rotation.columns);
    let turn = columns.fold(Vector3::new(0.0, 0.0, 0.0), |sum, (a, b)| sum + a.cross(b));
    PoseError {
        length: apart.fold(0.0, f64::max),
        angle: 0.5 * turn.norm(),
    }
}

/// 10,000 random poses of random designs for each tolerance.
#[test]
fn the_claimed_error_is_never_below_the_true_one() {
    for (number, length) in [1.0, 1e-2, 1e-4, 1e-6].into_iter().enumerate() {
        let allowed = PoseError {
            length,
            angle: f64::INFINITY,
        };
        let (mut count, mut tightest) = (0, f64::INFINITY);
        let mut random = Random(7 + number as u64);
        let mut studies = STUDIES.iter().cycle();
        while count < POSES {
            let mut suspension = study(studies.next().unwrap(), &[]).suspension;
            for _ in 0..20 {
                let home = suspension.design.clone();
                for p in &mut suspension.design {
                    *p = p.map(|c| c + 20.0 * random.next());
                }
                let travels: Vec<f64> = (0..25).map(|_| 80.0 * random.next()).collect();
                let (station_order, rack) = (StationOrder::through(&travels), 10.0 * random.next());
                let solver = Solver::new(&suspension.mechanism, &suspension.design);
                if let Ok(mut full) = solver {
                    let mut modest = full.clone().with_accuracy(allowed);
                    let truth = poses(&mut full, &station_order, rack);
                    let found = poses(&mut modest, &station_order, rack);
                    let claimed = modest.error_bound();
                    assert!(claimed.length <= 1.001 * length, "{claimed:?}");
                    for (found, truth) in found.iter().zip(&truth) {
                        // Both reach the same stations.
                        assert_eq!(found.is_some(), truth.is_some());
                        let (Some(found), Some(truth)) = (found, truth) else {
                            continue;
                        };
                        count += 1;
                        let error = error(&suspension, found, truth);
                        assert!(
                            error.length <= claimed.length && error.angle <= claimed.angle,
                            "asked {length}: {error:?} where {claimed:?} is claimed"
                        );
                        tightest = tightest.min(claimed.length / error.length);
                    }
                }
                suspension.design = home;
            }
        }
        println!(
            "accuracy {length:.0e}: {count} poses, claimed at least {tightest:.1} times the error"
        );
    }
}

/// Less is asked for, less is done.
#[test]
fn less_accuracy_takes_less_work() {
    for name in STUDIES {
        let evaluations = |overrides: &[&str]| {
            let study = study(name, overrides);
            let found = curves(&study.suspension, &Plan::of(&study)).unwrap();
            assert_eq!(found.error_bound.is_some(), !overrides.is_empty());
            found.work.closed_form_evaluations + found.work.newton_iterations
        };
        let full = evaluations(&[]);
        let modest = evaluations(&["solver.accuracy=0.001"]);
        assert!(modest < full, "{name}: {modest} and {full}");
        let by_angle = evaluations(&["solver.accuracy={angle=0.001}"]);
        assert!(by_angle < full, "{name}: {by_angle} and {full}");
    }
}

/// Angles read off the pose inherit its error.
#[test]
fn camber_is_as_good_as_was_asked() {
    for name in STUDIES {
        let camber = |overrides: &[&str]| {
            let study = study(name, overrides);
            let found = curves(&study.suspension, &Plan::of(&study)).unwrap();
            let bound = found.error_bound;
            let values: Vec<f64> = found
                .stations
                .iter()
                .map(|s| s.values[0].unwrap())
                .collect();
            (values, bound)
        };
        let (full, _) = camber(&["outputs.characteristics=[\"camber\"]"]);
        let (modest, bound) = camber(&[
            "outputs.characteristics=[\"camber\"]",
            "solver.accuracy={length=0.1, angle=1e-4}",
        ]);
        let bound = bound.unwrap().angle.to_degrees();
        assert!(bound <= 1.001e-4);
        for (full, modest) in full.iter().zip(&modest) {
            assert!((full - modest).abs() <= bound, "{name}: {full} {modest}");
        }
    }
}

#[test]
fn a_wrong_accuracy_is_refused() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("studies/macpherson_solve.toml");
    let refused = |value: &str| {
        let overrides = [format!("solver.accuracy={value}")];
        Study::read(&path, &overrides).unwrap_err().render(false)
    };
    for (value, message) in [
        ("0.0", "expected an accuracy above 0"),
        ("-1.0", "expected an accuracy above 0"),
        ("{length=-1.0}", "expected an accuracy above 0"),
        ("{}", "expected a length, or { length, angle }"),
        ("1e-15", "finer than double precision can promise"),
        ("{angle=1e-15}", "finer than double precision can promise"),
        ("\"fine\"", "{ length, angle }"),
        ("{size=1.0}", "size"),
        ("nan", "finite"),
    ] {
        let text = refused(value);
        assert!(text.contains(message), "{value}: {text}");
        assert!(text.contains("accuracy"), "{text}");
    }
}

/// A pose at the design position is exact whatever was asked.
#[test]
fn the_design_position_is_exact() {
    let study = study(STUDIES[0], &[]);
    let suspension = &study.suspension;
    let solver = Solver::new(&suspension.mechanism, &suspension.design).unwrap();
    let mut solver = solver.with_accuracy(PoseError {
        length: 1.0,
        angle: f64::INFINITY,
    });
    let found = poses(&mut solver, &StationOrder::through(&[0.0]), 0.0);
    assert_eq!(found[0], Some(solver.design_pose()));
    let point = MotionPoint {
        drive: Drive::Travel,
        value: 0.0,
        rack: 0.0,
    };
    assert!(solver.conditioning(&solver.design_pose(), &point).distance > 0.0);
    assert!(solver.error_bound().length < 1e-8);
}
