//! Tests of solid axles in SIMD lanes against one-by-one evaluation.

use super::{case, study_of, text, twist_beam};
use crate::axle::lanes::{with_all_quantities, worker};
use hardpoint::axle::Quantity;
use hardpoint::evaluate::NotInLanes;
use hardpoint::number::Width;
use hardpoint::study::Study;
use hardpoint::sweep::SweepPlan;
use std::path::Path;

const DESIGNS: usize = 40;

const WATT: [(&str, [f64; 3]); 11] = [
    ("lower_link_chassis", [540.0, 430.0, 305.0]),
    ("lower_link_axle", [0.0, 525.0, 255.0]),
    ("wheel_centre", [-10.0, 755.0, 333.0]),
    ("upper_link_chassis", [420.0, 40.0, 470.0]),
    ("upper_link_axle", [10.0, 60.0, 480.0]),
    ("watt_pivot", [-150.0, 5.0, 340.0]),
    ("watt_axis", [-100.0, 0.0, 345.0]),
    ("watt_upper_chassis", [-150.0, 480.0, 400.0]),
    ("watt_upper_rocker", [-150.0, 0.0, 410.0]),
    ("watt_lower_chassis", [-150.0, -480.0, 280.0]),
    ("watt_lower_rocker", [-150.0, 0.0, 270.0]),
];

/// Study of an axle, with every quantity that SIMD lanes can compute, and with some points scattered.
fn study(name: &str, motion: &str, right: &str) -> Study {
    let points: &[(&str, &str)] = match name {
        "solid_four_link" => &[("upper_link_axle", "y"), ("upper_link_chassis", "z")],
        "watt" => &[("watt_upper_rocker", "y"), ("watt_lower_chassis", "z")],
        "twist_beam" => &[("mount", "z"), ("shear_centre", "x"), ("shear_centre", "z")],
        _ => &[("panhard_axle", "z"), ("upper_link_chassis", "z")],
    };
    let of_links = [("lower_link_axle", "z"), ("lower_link_chassis", "x")];
    let of_links = of_links.iter().filter(|_| name != "twist_beam");
    let variables: Vec<String> = points
        .iter()
        .chain(of_links)
        .chain(&[("wheel_centre", "y")])
        .map(|(point, axis)| {
            format!("{{ hardpoint = \"{point}\", axis = \"{axis}\", range = [-10.0, 10.0] }}")
        })
        .collect();
    let further = format!(
        "{right}[motion]\n{motion}\n[outputs]\ncharacteristics = [\"toe\"]\n[sweep]\nmethod = \"random\"\n\
         samples = {DESIGNS}\nseed = 5\nvariables = [{}]\n",
        variables.join(", ")
    );
    let text = match name {
        "watt" => text(&WATT, true, &further),
        "twist_beam" => twist_beam::sample().text(&further),
        _ => study_of(&case(name), &further),
    };
    with_all_quantities(&text)
}

const ROLL: &str = "roll = { from = -4.0, to = 4.0, steps = 5 }\nheave = [-20.0, 0.0, 30.0]";
const HEAVE: &str = "heave = { from = -50.0, to = 50.0, steps = 5 }";
const OWN: &str = "[axle.right.hardpoints]\nlower_link_axle = [4.0, -538.0, 251.0]\n";

/// Every quantity of every design has the same value, whether designs are computed in SIMD lanes or one by one. The
/// lanes leave almost no design to the solver for single designs.
#[test]
fn lanes_have_the_values_of_designs_one_by_one() {
    for (name, motion, right) in [
        ("solid_four_link", ROLL, ""),
        ("solid_four_link", HEAVE, ""),
        ("solid_four_link", ROLL, OWN),
        ("solid_three_link_panhard", ROLL, ""),
        ("watt", ROLL, ""),
        ("twist_beam", ROLL, ""),
        ("twist_beam", HEAVE, ""),
    ] {
        let study: &'static Study = Box::leak(Box::new(study(name, motion, right)));
        let plan = SweepPlan::of(study, study.sweep.as_ref().unwrap()).unwrap();
        let quantities = &study.axle().unwrap().plan.quantities;
        let of_axle = quantities.iter().filter(|q| matches!(q, Quantity::Axle(_)));
        assert!(of_axle.count() > 8, "{quantities:?}");
        let mut alone = worker(&plan, None);
        assert_eq!(alone.not_in_lanes(), Some(NotInLanes::Asked));
        alone.rows(0);
        let mut first: Option<Vec<u64>> = None;
        for width in Width::available() {
            let mut lanes = worker(&plan, Some(width));
            assert_eq!(lanes.not_in_lanes(), None, "{name} {motion}");
            lanes.rows(0);
            let left = lanes.one_by_one().len();
            assert!(left <= DESIGNS / 10, "{name} {motion}: {left} left");
            let (mut bits, mut finite) = (Vec::new(), 0);
            for design in 0..DESIGNS {
                for (k, quantity) in quantities.iter().enumerate() {
                    let found = lanes.block().values(design, k);
                    let expected = alone.block().values(design, k);
                    for (station, (found, expected)) in found.zip(expected).enumerate() {
                        bits.push(found.to_bits());
                        finite += usize::from(expected.is_finite());
                        // The error of a quotient with a small denominator grows with its value.
                        let scale = expected.abs().max(1.0) * (1.0 + expected.abs() / 500.0);
                        assert!(
                            found.is_nan() && expected.is_nan()
                                || (found - expected).abs() < 1e-9 * scale,
                            "{name} {motion}: {quantity:?} {station} {found} {expected}"
                        );
                    }
                }
            }
            // Some quantities do not exist at some stations.
            let all = bits.len();
            assert!(
                all >= 3 * DESIGNS * quantities.len(),
                "{name} {motion}: {all}"
            );
            assert!(2 * finite > all, "{name} {motion}: {finite} of {all}");
            match &first {
                None => first = Some(bits),
                Some(first) => assert!(*first == bits, "{name} {motion}: bits of {width:?}"),
            }
        }
    }
}

/// The Panhard rod lies on the ground, below the middle of the axle. So the roll centre is on the ground, and the jacking
/// coefficients are zero. It exists in SIMD lanes as in single solutions.
#[test]
fn a_roll_centre_on_the_ground_exists_in_lanes() {
    let text = "[suspension]\ntopology = \"solid_axle\"\nsingle = [\"upper_link\"]\n[suspension.hardpoints]\n\
                lower_link_chassis = [540.0, 420.0, 305.0]\nlower_link_axle = [5.0, 530.0, 255.0]\n\
                upper_link_chassis = [340.0, 0.0, 445.0]\nupper_link_axle = [15.0, 0.0, 475.0]\n\
                panhard_chassis = [0.0, -480.0, 0.0]\npanhard_axle = [0.0, 470.0, 0.0]\n\
                wheel_centre = [0.0, 760.0, 335.0]\n[axle]\nright = \"mirrored\"\n\
                [wheel]\nradius = 335.0\nstatic_camber = 0.0\nstatic_toe = 0.0\n[motion]\nroll = [0.0]\nheave = [0.0]\n\
                [outputs]\ncharacteristics = [\"roll_centre_height\", \"roll_centre_lateral\"]\n\
                [sweep]\nmethod = \"random\"\nsamples = 8\nseed = 5\n\
                variables = [{ hardpoint = \"lower_link_chassis\", axis = \"z\", range = [-8.0, 8.0] }]\n";
    let study = Study::from_text("ground.toml", text, Path::new("."));
    let study: &'static Study = Box::leak(Box::new(study.unwrap_or_else(|e| panic!("{e}"))));
    let plan = SweepPlan::of(study, study.sweep.as_ref().unwrap()).unwrap();
    for width in [None].into_iter().chain(Width::available().map(Some)) {
        let mut worker = worker(&plan, width);
        worker.rows(0);
        for design in 0..8 {
            for quantity in 0..2 {
                let found: Vec<f64> = worker.block().values(design, quantity).collect();
                assert!(
                    found.iter().all(|value| value.abs() < 1e-9),
                    "{width:?} {found:?}"
                );
            }
        }
    }
}
