//! Tests of designs in SIMD lanes (several designs at once) against the slower continuation: same poses, same failures,
//! and the same bits at every lane width.
//!
//! `DESIGNS=1000000 cargo test --release --test it lanes:: -- --ignored --nocapture` is the long run.

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
use std::path::Path;

/// Sample study with other travels and rack displacements.
fn study(name: &str, travel: &str, rack: &str) -> Study {
    let path = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("studies")
        .join(name);
    let overrides = [
        format!("motion.travel={travel}"),
        format!("motion.rack={rack}"),
    ];
    Study::read(&path, &overrides).unwrap_or_else(|e| panic!("{e}"))
}

/// Sample study driven by the angle of the lower arm. With this drive, a gain (per travel) differs from the derivative
/// with respect to the drive.
fn by_arm_angle(name: &str) -> Study {
    let path = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("studies")
        .join(name);
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
    /// Largest deviation, and the quantity in which it occurs. Angles are in rad, lengths are divided by the suspension
    /// size; rates are included.
    worst: f64,
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

/// Double wishbones whose wheel centre is at its lowest or highest point within 0.01 mm of the design position. Their
/// other points are those of `double_wishbone_solve.toml`. So close to a fold (end of travel), the slopes differ from
/// those of the base design. At the fold, a second solution branch starts. Its curves are smooth too, so smoothness
/// alone does not distinguish the branches.
const BESIDE_A_FOLD: [([[f64; 3]; 12], &str, &str); 2] = [
    (
        [
            [3.559105095727901, 384.73921951851366, 411.48594135533403],
            [-51.52461173110213, 464.8247890509996, 533.2254859447784],
            [-58.93697912275535, 592.1694851838768, 549.0655088616003],
            [108.75854763749612, 281.65183848524794, 174.397313573023],
            [-260.07000819234145, 287.32732934453, 162.96336371605742],
            [-31.837276144536652, 785.5120445864833, 252.20299651978297],
            [-227.20534478087959, 397.05023883492106, 155.95653383769618],
            [-207.7365983125793, 673.5490419647047, 250.41702840689914],
            [96.96707419103292, 798.0735363377229, 319.89282306304256],
            [-21.854573250034303, 727.1811108457567, 220.83223954358502],
            [-39.41660537834919, 549.5116201928588, 665.5804600159514],
            [3.831834776388776, 547.8124068002285, 201.1094784875504],
        ],
        FINE,
        "[0.0]",
    ),
    (
        [
            [119.71718744550859, 430.31471960223394, 604.7024030039963],
            [-51.59065171850085, 420.2818889198776, 392.08122712808483],
            [35.060689272752164, 706.0912708635605, 593.6664299836742],
            [113.90431454103253, 459.20881545392484, 120.37612173948305],
            [-255.51849199637235, 356.9410066333063, 146.7877473426656],
            [77.35515576544282, 604.7939015148788, 264.6199379117188],
            [-48.913321426798646, 348.6552696435039, 169.9389887584661],
            [-78.96314145944935, 632.8434360843457, 281.3555113255795],
            [-50.84694937754761, 849.8596358583354, 401.8277343116298],
            [65.07702168316752, 652.3332221568467, 401.8540142497852],
            [-65.09289986015891, 562.7720384897971, 654.0415717941315],
            [-62.774316527772676, 542.0595684044755, 175.06314776802355],
        ],
        COARSE,
        "[-40.0, 0.0, 35.0]",
    ),
];

#[test]
fn designs_beside_a_fold_stay_on_their_own_side() {
    for (points, travel, rack) in BESIDE_A_FOLD {
        let study = study("double_wishbone_solve.toml", travel, rack);
        let suspension = study.wheel();
        let stations = Stations::of(study.motion(), &suspension.frame, &[]);
        let quantities = ANGLES.map(Quantity::Characteristic);
        let design = points.map(|[x, y, z]| Vector3::new(x, y, z));
        let designs: Vec<_> = (0..BLOCK).flat_map(|_| design).collect();
        let mut wanted = Block::new(quantities.len(), stations.count());
        let mut found = wanted.clone();
        let careful = Evaluator::by_continuation(suspension, &stations, &quantities);
        let lanes = Evaluator::new(suspension, &stations, &quantities);
        for (evaluator, block) in [(careful, &mut wanted), (lanes, &mut found)] {
            let mut evaluator = evaluator.expect("the sample can be solved");
            evaluator.evaluate(&designs, block);
        }
        let mut compared = 0;
        for (k, quantity) in quantities.iter().enumerate() {
            for station in 0..stations.count() {
                let [a, b] = [&found, &wanted].map(|block| block.value(0, k, station));
                let agree = (a - b).abs() < BESIDE_FOLDS || (a.is_nan() && b.is_nan());
                assert!(agree, "{quantity:?} at {station}: {a}, not {b}");
                compared += usize::from(!a.is_nan());
            }
        }
        // The design position has every quantity.
        assert!(compared >= quantities.len(), "{compared}");
    }
}

/// Design 3672 of the pushrods with bars has random changes of up to 40 mm. In the design position it is very near its
/// toggle (leverage 5.9e-5). If poses differ by one rounding error, their motion ratios differ by a relative 1e-7. The
/// expected ratio was computed in 60 digits: from the six linear equations of the knuckle's twist, then from those of
/// rocker and bar.
#[test]
fn the_design_position_is_the_design_itself_beside_a_toggle() {
    const NUMBER: usize = 3672;
    const RATIO: f64 = 44.276_002_729_724_26;
    let study = study("double_wishbone_rocker.toml", FINE, "[0.0]");
    let suspension = study.wheel();
    let stations = Stations::of(study.motion(), &suspension.frame, &[]);
    let quantities = [Quantity::Characteristic(
        Characteristic::AntiRollBarMotionRatio,
    )];
    let mut scatter = Scatter {
        random: Random(19),
        base: suspension.design.clone(),
        by: 40.0,
    };
    let mut blocks = std::iter::from_fn(|| Some(scatter.block()));
    let block = blocks.nth(NUMBER / BLOCK).expect("endless");
    let points = suspension.design.len();
    let design = &block[NUMBER % BLOCK * points..][..points];
    for evaluator in [
        Evaluator::new(suspension, &stations, &quantities),
        Evaluator::by_continuation(suspension, &stations, &quantities),
    ] {
        let mut evaluator = evaluator.expect("the sample can be solved");
        let mut found = Block::new(1, stations.count());
        evaluator.evaluate(design, &mut found);
        let ratio = found.value(0, 0, stations.design());
        // The bound is one rounding error of the design, 2e-16, divided by the leverage, times 25 for further rounding
        // errors.
        assert!((ratio - RATIO).abs() < 1e-10 * RATIO, "{ratio}");
    }
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

/// Lanes skip a degenerate design with a rod of zero length. This does not affect later designs in the same lane.
#[test]
fn a_degenerate_design_leaves_its_lane_as_it_was() {
    for (name, [one, other]) in [
        ("macpherson_solve.toml", ["tie_rod_inner", "tie_rod_outer"]),
        ("five_link_solve.toml", ["toe_link_inner", "toe_link_outer"]),
    ] {
        let study = study(name, FINE, "[0.0]");
        let suspension = study.wheel();
        let stations = Stations::of(study.motion(), &suspension.frame, &[]);
        let quantities = quantities(&study);
        let place = |name| suspension.mechanism.point(name).expect("a point").0;
        let mut without = suspension.design.clone();
        without[place(one)] = without[place(other)];
        let sound = suspension.design.repeat(BLOCK - 1);
        for width in Width::available() {
            let mut evaluator =
                Evaluator::with_width(suspension, &stations, &quantities, Some(width))
                    .unwrap_or_else(|_| panic!("the sample cannot be solved"));
            let mut block = Block::new(quantities.len(), stations.count());
            let fallback = evaluator.evaluate(&[&without[..], &sound].concat(), &mut block);
            assert_eq!(fallback, 1, "{name}, {}", width.name());
        }
    }
}

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
