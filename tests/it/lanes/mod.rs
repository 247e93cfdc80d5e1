//! Tests of designs in SIMD lanes (several designs at once) against the slower continuation: same poses, same failures,
//! and the same bits at every lane width.
//!
//! `DESIGNS=1000000 cargo test --release --test it lanes:: -- --ignored --nocapture` is the long run.

mod gradients;
mod singular;

use crate::support::larger;
use crate::support::random::Random;
use hardpoint::ask::{Need, Unit};
use hardpoint::characteristics::{Characteristic, Constants, Quantity, WheelReading};
use hardpoint::derive::{DesignSeries, MotionPoint};
use hardpoint::evaluate::{AngleTarget, BLOCK, Block, Evaluator, Gradients, Stations};
use hardpoint::evaluate::{Evaluated, GradientEvaluator};
use hardpoint::model::{Axis, Drive, PointId, Side, SteeringAxis};
use hardpoint::number::{Jet, Vector3, Width};
use hardpoint::solve::Solver;
use hardpoint::study::Study;
use std::ops::ControlFlow;

/// Sample study with other travels and rack displacements.
fn study(name: &str, travel: &str, rack: &str) -> Study {
    let path = crate::support::studies().join(name);
    let overrides = [
        format!("motion.travel={travel}"),
        format!("motion.rack={rack}"),
    ];
    Study::read(&path, &overrides).unwrap_or_else(|e| panic!("{e}"))
}

/// Sample study driven by the angle of the lower arm. With this drive, a gain (per travel) differs from the derivative
/// with respect to the drive.
fn by_arm_angle(name: &str) -> Study {
    let path = crate::support::studies().join(name);
    let motion = "motion={ drive = \"arm_angle\", arm_angle = { from = -14.0, to = 14.0, steps = 15 }, \
                  rack = [-10.0, 0.0] }";
    Study::read(&path, &[motion.to_owned()]).unwrap_or_else(|e| panic!("{e}"))
}

const FINE: &str = "{ from = -80.0, to = 80.0, steps = 41 }";
const COARSE: &str = "[-90.0, -30.0, 55.0, 120.0]";

/// Characteristics that a typical sweep requests.
const ANGLES: [Characteristic; 4] = [
    Characteristic::Camber,
    Characteristic::Toe,
    Characteristic::KingpinInclination,
    Characteristic::Caster,
];

/// All quantities that the suspension has.
fn quantities(study: &Study) -> Vec<Quantity> {
    let suspension = study.wheel();
    let possible = |c: &&Characteristic| {
        c.info().needs.iter().all(|need| match need {
            Need::WheelRadius
            | Need::Wheelbase
            | Need::CgHeight
            | Need::FrontBraking
            | Need::RearDrive
            | Need::RearBrakingOrFrontDrive => true,
            _ => need.met_by(suspension),
        })
    };
    let all = Characteristic::ALL.iter().filter(possible);
    let characteristics = all.map(|c| Quantity::Characteristic(*c));
    let points = (0..suspension.design.len()).map(|id| Quantity::Coordinate(PointId(id), Axis::Z));
    let turns = [Axis::X, Axis::Z].map(Quantity::AngularVelocity);
    characteristics.chain(points).chain(turns).collect()
}

/// Quantities of the study for which lanes can compute derivatives: no velocities, no instantaneous steering axis.
fn differentiable(study: &Study) -> Vec<Quantity> {
    let is_through = matches!(
        study.wheel().mechanism.steering_axis,
        Some(SteeringAxis::Through { .. })
    );
    let possible = |q: &Quantity| match q {
        Quantity::Characteristic(c) => is_through || !c.info().reads_steering_axis(),
        _ => true,
    };
    let all = quantities(study).into_iter();
    all.filter(|q| q.rate_order() == 0)
        .filter(possible)
        .collect()
}

/// Generator of random designs about the study's design, block by block.
struct Scatter {
    random: Random,
    base: Vec<Vector3<f64>>,
    by: f64,
}

impl Scatter {
    fn block(&mut self) -> Vec<Vector3<f64>> {
        let mut designs = Vec::new();
        for _ in 0..BLOCK {
            designs.extend(self.random.scattered(&self.base, self.by));
        }
        designs
    }
}

/// Result of a comparison of two evaluators.
#[derive(Debug, Default)]
struct Found {
    designs: usize,
    /// Number of values that both evaluators have.
    compared: usize,
    /// Number of designs with an unreachable station.
    unreachable: usize,
    /// Number of designs that the lanes left to the solver for single designs.
    left: usize,
    /// Largest deviation of values and rates. Angles are in rad, lengths are divided by the suspension size.
    worst: f64,
    /// Quantity with the largest deviation.
    of: Option<(Quantity, f64)>,
    /// Number of ill-conditioned values. Their deviation is no larger than the error of the continuation, or than the
    /// effect of rounding the design.
    ill: usize,
    /// Largest error of derivatives with respect to travel in the design position.
    worst_slope: f64,
}

fn compare(study: &Study, quantities: &[Quantity], by: f64, seed: u64, designs: usize) -> Found {
    let suspension = study.wheel();
    let stations = Stations::of(study.motion(), &suspension.frame, &[]);
    let unit_of_drive = match stations.drive {
        Drive::Travel => suspension.size(),
        Drive::ArmAngle => 1.0,
    };
    let mut careful = Evaluator::by_continuation(suspension, &stations, quantities)
        .expect("the sample can be solved");
    let mut lanes =
        Evaluator::new(suspension, &stations, quantities).expect("the sample can be solved");
    let mut scatter = Scatter {
        random: Random(seed),
        base: suspension.design.clone(),
        by,
    };
    let mut found = Found::default();
    let mut wanted = Block::new(quantities.len(), stations.count());
    let mut block = wanted.clone();
    while found.designs < designs {
        let points = scatter.block();
        careful.evaluate(&points, &mut wanted);
        found.left += lanes.evaluate(&points, &mut block);
        let left: Vec<bool> = (0..BLOCK)
            .map(|k| lanes.one_by_one().contains(&k))
            .collect();
        found.designs += BLOCK;
        assert_eq!(block.faults(), wanted.faults());
        let key = |b: &Block| -> Vec<(usize, usize)> {
            b.failures().iter().map(|f| (f.design, f.station)).collect()
        };
        assert_eq!(key(&block), key(&wanted), "{by}");
        let mut failing: Vec<usize> = key(&wanted).iter().map(|f| f.0).collect();
        failing.dedup();
        found.unreachable += failing.len();
        for design in 0..BLOCK {
            for (k, quantity) in quantities.iter().enumerate() {
                let scale = scale_of(*quantity, suspension.size(), unit_of_drive);
                let arm = swing_arm(*quantity);
                let arm = quantities.iter().position(|q| Some(*q) == arm);
                let pairs = block.values(design, k).zip(wanted.values(design, k));
                for (station, (a, b)) in pairs.enumerate() {
                    assert_eq!(a.is_nan(), b.is_nan(), "{quantity:?} of design {design}");
                    if !a.is_nan() {
                        found.compared += 1;
                        // A swing arm is infinite where the wheel does not turn. Only its inverse is smooth there. The
                        // height of the centre is a quotient h = v/w with the same rotation rate w: |dh| <= |1/w| (|dv| +
                        // |h dw|), where |1/w| is about the swing arm.
                        let size = suspension.size();
                        let arm = arm.map_or(b, |arm| wanted.value(design, arm, station));
                        let pole = (arm * b / size).abs().max(arm.abs()).max(b * b / size);
                        let deviation = (a - b).abs() / scale.max(b.abs()).max(pole);
                        // Lanes leave designs very near a fold or toggle to the solver for single designs. There the
                        // condition number limits the accuracy of every solver, including the continuation.
                        if left[design] && deviation < BESIDE_FOLDS {
                            continue;
                        }
                        if deviation > BOUND {
                            let n = suspension.design.len();
                            let design = &points[design * n..][..n];
                            let spread = spread(&mut careful, design, quantities.len(), &stations);
                            let rounded = rounded(study, &stations, *quantity, design, station);
                            let spread = spread[k * stations.count() + station].max(rounded);
                            if (a - b).abs() < spread {
                                found.ill += 1;
                                continue;
                            }
                        }
                        let worst = larger(found.worst, deviation);
                        if worst != found.worst {
                            found.worst = worst;
                            found.of = Some((*quantity, b));
                        }
                    }
                }
                let (a, b) = (block.slope(design, k), wanted.slope(design, k));
                assert_eq!(a.is_nan(), b.is_nan(), "slope of {quantity:?}");
                if !a.is_nan() && !left[design] {
                    let scale = (scale / unit_of_drive).max(b.abs());
                    found.worst_slope = larger(found.worst_slope, (a - b).abs() / scale);
                }
            }
        }
    }
    println!("{} points, {by} mm: {found:?}", suspension.design.len());
    found
}

/// Returns the variation of each value when the whole design moves along the vehicle. The exact values do not change, so
/// the variation is the error of the continuation.
fn spread(
    careful: &mut Evaluator<'_>,
    design: &[Vector3<f64>],
    quantities: usize,
    stations: &Stations,
) -> Vec<f64> {
    let size = 1e-3 * (design[1] - design[0]).norm();
    let moved = |k: usize| Vector3::new(size * (k as f64), 0.0, 0.0);
    let designs: Vec<_> = (0..BLOCK)
        .flat_map(|k| design.iter().map(move |point| *point + moved(k)))
        .collect();
    let mut block = Block::new(quantities, stations.count());
    careful.evaluate(&designs, &mut block);
    let places = (0..quantities).flat_map(|k| (0..stations.count()).map(move |s| (k, s)));
    let spread = |(k, station): (usize, usize)| {
        let values = (0..BLOCK).map(|design| block.value(design, k, station));
        let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| {
            (low.min(v), high.max(v))
        });
        high - low
    };
    places.map(spread).collect()
}

/// First-order effect of rounding errors of the coordinates on a value. It is the sum of the norms of the exact
/// derivatives, times an error of 1e-14 of the suspension size. (`tests/it/builds` finds half of this error in points
/// of poses.)
fn rounded(
    study: &Study,
    stations: &Stations,
    quantity: Quantity,
    design: &[Vector3<f64>],
    station: usize,
) -> f64 {
    const OFF: f64 = 1e-14;
    let (suspension, quantities) = (study.wheel(), [quantity]);
    let points: Vec<PointId> = (0..suspension.design.len()).map(PointId).collect();
    let evaluator = GradientEvaluator::new(suspension, stations, &quantities, &points, None);
    let mut evaluator = evaluator.expect("it is sound");
    let mut found = Evaluated::default();
    evaluator.evaluate([design, &[]], &mut found);
    let slopes = found
        .gradient((0, 0, station), Side::Left)
        .iter()
        .map(|by| by.norm());
    OFF * suspension.size() * slopes.sum::<f64>()
}

/// Returns the swing arm in the same view if the quantity is the height of an instant centre. Otherwise returns `None`.
fn swing_arm(quantity: Quantity) -> Option<Quantity> {
    let arm = match quantity {
        Quantity::Characteristic(Characteristic::FrontViewCentreHeight) => {
            Characteristic::FrontViewSwingArm
        }
        Quantity::Characteristic(Characteristic::SideViewCentreHeight) => {
            Characteristic::SideViewSwingArm
        }
        _ => return None,
    };
    Some(Quantity::Characteristic(arm))
}

/// Returns the scale of a quantity's error. An angular velocity is a derivative with respect to the drive.
fn scale_of(quantity: Quantity, size: f64, unit_of_drive: f64) -> f64 {
    let c = match quantity {
        Quantity::Characteristic(c) => c,
        Quantity::Coordinate(..) => return size,
        Quantity::AngularVelocity(_) => return 1.0 / unit_of_drive,
    };
    match c.info().unit {
        Unit::Length => size,
        Unit::AnglePerLength => 1.0 / size,
        _ => 1.0,
    }
}

fn all(designs: usize) -> Vec<(f64, Found)> {
    let mut found = Vec::new();
    for (name, scatters) in [
        ("macpherson_solve.toml", [10.0, 60.0, 150.0]),
        ("double_wishbone_solve.toml", [10.0, 40.0, 100.0]),
        ("five_link_solve.toml", [10.0, 30.0, 80.0]),
        ("semi_trailing_arm_solve.toml", [10.0, 60.0, 150.0]),
        // Pushrod with a rocker that also turns an anti-roll bar.
        ("double_wishbone_rocker.toml", [3.0, 15.0, 40.0]),
    ] {
        for (k, by) in scatters.into_iter().enumerate() {
            let seed = 17 + k as u64;
            let fine = study(name, FINE, "[0.0]");
            let coarse = study(name, COARSE, "[-40.0, 0.0, 35.0]");
            let angles = ANGLES.map(Quantity::Characteristic);
            let angles: Vec<_> = angles
                .into_iter()
                .filter(|q| quantities(&fine).contains(q))
                .collect();
            found.push((by, compare(&fine, &angles, by, seed, designs)));
            found.push((
                by,
                compare(&fine, &quantities(&fine), by, seed, designs / 2),
            ));
            found.push((
                by,
                compare(&coarse, &quantities(&coarse), by, seed, designs / 4),
            ));
        }
    }
    for name in ["macpherson_solve.toml", "double_wishbone_solve.toml"] {
        let study = by_arm_angle(name);
        for by in [10.0, 40.0] {
            found.push((
                by,
                compare(&study, &quantities(&study), by, 31, designs / 2),
            ));
        }
    }
    found
}

/// Bound of the difference between lanes and single designs. The residuals in lanes are rounding errors. Lanes approach
/// folds and toggles up to an angle with sine 1/4, where the knuckle turns four times as fast. This multiplies an error
/// of a position by 4, and an error of a rate by the cube of 4. The bound covers these factors and the rounding errors of
/// both methods. Errors are larger in quotients of two values near zero, such as the roll centre of a wheel that turns
/// about its contact point.
const BOUND: f64 = 1e-12;

/// Bound for designs that are solved one by one. The relative error of rates is the rounding error times the square of
/// the condition number. The condition number is below 1e3 at an ordinary station, so ten of sixteen digits are
/// correct. The bound allows a factor of ten for the rounding errors of both methods.
const BESIDE_FOLDS: f64 = 1e-9;

fn check(all: Vec<(f64, Found)>) {
    for (by, found) in all {
        // Every sound design has values in its design position.
        assert!(found.compared > found.designs, "{by}: {found:?}");
        assert!(found.worst < BOUND, "{by}: {found:?}");
        assert!(found.worst_slope < BOUND, "{by}: {found:?}");
        assert!(found.ill * 10_000 < found.designs, "{by}: {found:?}");
    }
}

#[test]
fn the_tracker_agrees_with_the_continuation() {
    check(all(100));
}

#[test]
#[ignore = "a million designs take minutes"]
fn a_million_designs_tracked_agree_with_the_continuation() {
    let designs = std::env::var("DESIGNS").map_or(1_000_000, |n| n.parse().expect("a number"));
    check(all(designs / 10));
}

#[test]
fn ordinary_designs_stay_in_the_lanes() {
    if !crate::support::has_lanes() {
        return;
    }
    // With 30 mm of random change at the rear axle's toe links, some five-link designs would steer by ten degrees. Lanes
    // cannot solve such angles.
    for (name, rack) in [
        ("macpherson_solve.toml", "[0.0, 30.0]"),
        ("double_wishbone_solve.toml", "[0.0, 30.0]"),
        ("five_link_solve.toml", "[0.0, 15.0]"),
        ("semi_trailing_arm_solve.toml", "[0.0, 30.0]"),
    ] {
        let study = study(name, FINE, rack);
        assert_eq!(left_of_a_thousand(&study, 10.0), 0, "{name}");
    }
    for name in ["macpherson_solve.toml", "double_wishbone_solve.toml"] {
        assert_eq!(left_of_a_thousand(&by_arm_angle(name), 10.0), 0, "{name}");
    }
    for name in [
        "double_wishbone_pushrod.toml",
        "double_wishbone_rocker.toml",
    ] {
        let study = study(
            name,
            "{ from = -30.0, to = 30.0, steps = 31 }",
            "[0.0, 10.0]",
        );
        assert_eq!(left_of_a_thousand(&study, 5.0), 0, "{name}");
    }
}

/// Returns the number of designs out of a thousand that lanes leave to the solver for single designs. Also compares one
/// block with the continuation.
fn left_of_a_thousand(study: &Study, by: f64) -> usize {
    let suspension = study.wheel();
    let stations = Stations::of(study.motion(), &suspension.frame, &[]);
    let quantities = quantities(study);
    let compared = compare(study, &quantities, by, 3, BLOCK);
    assert_eq!(compared.left, 0, "{compared:?}");
    let mut lanes = Evaluator::new(suspension, &stations, &quantities).expect("it is sound");
    let mut scatter = Scatter {
        random: Random(3),
        base: suspension.design.clone(),
        by,
    };
    let mut block = Block::new(quantities.len(), stations.count());
    let blocks = 1000_usize.div_ceil(BLOCK);
    (0..blocks)
        .map(|_| lanes.evaluate(&scatter.block(), &mut block))
        .sum()
}

#[test]
fn every_width_gives_the_same_bits() {
    for (name, by) in [
        ("macpherson_solve.toml", 120.0),
        ("double_wishbone_solve.toml", 80.0),
        ("five_link_solve.toml", 60.0),
        ("semi_trailing_arm_solve.toml", 100.0),
        ("double_wishbone_rocker.toml", 20.0),
    ] {
        let study = study(name, FINE, "[0.0, 25.0]");
        let suspension = study.wheel();
        let stations = Stations::of(study.motion(), &suspension.frame, &[]);
        let quantities = quantities(&study);
        let mut scatter = Scatter {
            random: Random(5),
            base: suspension.design.clone(),
            by,
        };
        let designs = scatter.block();
        let bits = |width, designs: &[Vector3<f64>]| -> Vec<u64> {
            let mut evaluator =
                Evaluator::with_width(suspension, &stations, &quantities, Some(width))
                    .unwrap_or_else(|_| panic!("the sample cannot be solved"));
            let mut block = Block::new(quantities.len(), stations.count());
            evaluator.evaluate(designs, &mut block);
            let all = (0..block.designs()).flat_map(|d| {
                let block = &block;
                (0..quantities.len()).flat_map(move |k| {
                    let slope = std::iter::once(block.slope(d, k));
                    block.values(d, k).chain(slope)
                })
            });
            all.map(f64::to_bits).collect()
        };
        let points = suspension.design.len();
        let mut expected = None;
        for width in Width::available() {
            let found = bits(width, &designs);
            let numbers = found
                .iter()
                .filter(|bits| f64::from_bits(**bits).is_finite());
            assert!(numbers.count() > BLOCK, "{name}");
            // Solves one design alone, without other designs in the lanes.
            let alone = bits(width, &designs[3 * points..4 * points]);
            let size = alone.len();
            assert!(alone == found[3 * size..4 * size]);
            assert!(
                *expected.get_or_insert_with(|| found.clone()) == found,
                "{}",
                width.name()
            );
        }
    }
}
