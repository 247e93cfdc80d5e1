//! Tests of axles in SIMD lanes (several designs at once) against evaluation one by one: same values, same refusals,
//! and the same bits at every lane width.

use hardpoint::axle::Quantity;
use hardpoint::evaluate::NotInLanes;
use hardpoint::number::Width;
use hardpoint::study::Study;
use hardpoint::sweep::{SweepPlan, Worker};
use std::path::Path;

const DESIGNS: usize = 20;
const STRUT: &str = "macpherson_axle_front.toml";
const FIVE_LINK: &str = "five_link_axle_rear.toml";

/// Axle of a sample with some scattered points, and with every quantity that is available in SIMD lanes.
fn study(name: &str, right: &str, motion: &str, by: f64) -> Study {
    let text = crate::support::sample(name);
    let head = text.split("[motion]").next().unwrap();
    let head = head.replace("right = \"mirrored\"", right);
    let points: &[(&str, &str)] = match name {
        STRUT => &[
            ("tie_rod_outer", "z"),
            ("tie_rod_inner", "x"),
            ("lower_ball_joint", "y"),
            ("lower_arm_rear", "z"),
            ("wheel_centre", "y"),
            ("strut_top", "x"),
        ],
        _ => &[
            ("toe_link_inner", "z"),
            ("toe_link_outer", "y"),
            ("wheel_centre", "y"),
            ("toe_link_inner", "x"),
        ],
    };
    let variables: Vec<String> = points
        .iter()
        .map(|(point, axis)| {
            format!("{{ hardpoint = \"{point}\", axis = \"{axis}\", range = [-{by}, {by}] }}")
        })
        .collect();
    let text = format!(
        "{head}\n[motion]\n{motion}\n[outputs]\ncharacteristics = [\"toe\"]\n[sweep]\nmethod = \"random\"\n\
         samples = {DESIGNS}\nseed = 5\nvariables = [{}]\n",
        variables.join(", ")
    );
    with_all_quantities(&text)
}

/// Study of an axle, read from its text, with every quantity that SIMD lanes can compute.
pub(crate) fn with_all_quantities(text: &str) -> Study {
    let mut study =
        Study::from_text("swept.toml", text, Path::new(".")).unwrap_or_else(|e| panic!("{e}"));
    let both = study.axle_mut().unwrap();
    let has = |quantity: &Quantity| both.axle.has(*quantity);
    let names = Quantity::names();
    let all = names.iter().flat_map(|name| Quantity::named(name));
    both.plan.quantities = all.filter(|q| q.is_for_lanes()).filter(has).collect();
    study
}

/// Worker for single designs, or for SIMD lanes of one width.
pub(crate) fn worker(plan: &SweepPlan<'static>, width: Option<Width>) -> Worker<'static> {
    let plan: &'static SweepPlan<'static> = Box::leak(Box::new(plan.clone()));
    plan.worker_of_width(width).unwrap()
}

const ROLL: &str = "roll = { from = -4.0, to = 4.0, steps = 5 }\nheave = [0.0, 30.0]";
const STEERED: &str =
    "roll = { from = -3.0, to = 3.0, steps = 5 }\nheave = [15.0]\nrack = [-35.0, 12.0]";
const HEAVE: &str = "heave = { from = -60.0, to = 60.0, steps = 5 }\nrack = [0.0, 20.0]";
const OWN_STRUT: &str = "[axle.right.hardpoints]\ntie_rod_outer = [-131.0, -688.0, 243.0]";
const OWN_FIVE_LINK: &str = "[axle.right.hardpoints]\ntoe_link_inner = [-180.0, -347.0, 262.0]";

/// Every quantity of every design has the same value, whether designs are computed in SIMD lanes or one by one. Almost
/// no design in lanes needs the solver for single designs.
#[test]
fn lanes_have_the_values_of_designs_one_by_one() {
    let mirrored = "right = \"mirrored\"";
    for (name, right, motion) in [
        (STRUT, mirrored, ROLL),
        (STRUT, OWN_STRUT, STEERED),
        (STRUT, mirrored, HEAVE),
        (FIVE_LINK, OWN_FIVE_LINK, ROLL),
        (FIVE_LINK, mirrored, "heave = [-40.0, 0.0, 30.0]"),
    ] {
        let study: &'static Study = Box::leak(Box::new(study(name, right, motion, 8.0)));
        let plan = SweepPlan::of(study, study.sweep.as_ref().unwrap()).unwrap();
        let quantities = &study.axle().unwrap().plan.quantities;
        let mut alone = worker(&plan, None);
        assert_eq!(alone.not_in_lanes(), Some(NotInLanes::Asked));
        alone.rows(0);
        let mut first: Option<Vec<u64>> = None;
        for width in Width::available() {
            let mut lanes = worker(&plan, Some(width));
            assert_eq!(lanes.not_in_lanes(), None, "{name} {motion}");
            lanes.rows(0);
            let left = lanes.one_by_one();
            assert!(
                left.len() <= DESIGNS / 10,
                "{name} {motion}: {} left",
                left.len()
            );
            let mut bits = Vec::new();
            for design in 0..DESIGNS {
                for (k, quantity) in quantities.iter().enumerate() {
                    let pairs = lanes
                        .block()
                        .values(design, k)
                        .zip(alone.block().values(design, k));
                    for (station, (found, expected)) in pairs.enumerate() {
                        bits.push(found.to_bits());
                        let what = || {
                            format!("{name} {motion}: {quantity:?} {station} {found} {expected}")
                        };
                        assert_eq!(found.is_nan(), expected.is_nan(), "{}", what());
                        // The accepted error grows with the value: a quotient with a small denominator has a large value and a
                        // large error.
                        let scale = expected.abs().max(1.0) * (1.0 + expected.abs() / 500.0);
                        assert!(
                            expected.is_nan() || (found - expected).abs() < 1e-9 * scale,
                            "{}",
                            what()
                        );
                    }
                }
            }
            match &first {
                None => first = Some(bits),
                Some(first) => assert!(*first == bits, "{name} {motion}: bits of {width:?}"),
            }
        }
    }
}

/// A quantity that is not available in SIMD lanes is refused with the reason.
#[test]
fn what_is_not_for_lanes_is_said() {
    if !crate::support::has_lanes() {
        return;
    }
    let of = |motion: &str, name: &str| {
        let mut study = study(STRUT, "right = \"mirrored\"", motion, 1.0);
        study.axle_mut().unwrap().plan.quantities = Quantity::named(name);
        let study: &'static Study = Box::leak(Box::new(study));
        let plan = SweepPlan::of(study, study.sweep.as_ref().unwrap()).unwrap();
        worker(&plan, Width::widest()).not_in_lanes()
    };
    assert_eq!(of(HEAVE, "toe"), None);
    assert_eq!(of(HEAVE, "steering_ratio"), None);
    assert_eq!(
        of(ROLL, "roll_centre_migration_vertical"),
        Some(NotInLanes::Reading)
    );
    let singly = "travel_left = [0.0, 10.0]\ntravel_right = [0.0]";
    assert_eq!(of(singly, "toe"), Some(NotInLanes::Travels));
}
