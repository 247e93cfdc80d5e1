//! Tests of equilibria in SIMD lanes against single wheels: same values, same failures, and the same bits at every lane
//! width.

use super::support::{elastic, with};
use crate::support::larger;
use hardpoint::evaluate::NotInLanes;
use hardpoint::number::Width;
use hardpoint::study::Study;
use hardpoint::sweep::{SweepPlan, Worker};

/// Number of designs: more than the lanes of the widest registers, and not a multiple of any lane width.
const DESIGNS: usize = 37;

/// Study whose points move by up to `by` mm, and whose rates change by up to a factor of 2.
fn study(name: &str, rates: &str, head: &str, by: f64) -> Study {
    let text = with(name, "");
    let text = text.split("\n[motion]").next().unwrap().to_owned()
        + "\n[compliance]"
        + text.split("\n[compliance]").nth(1).unwrap();
    let plain = elastic(&with(name, ""));
    let points = plain.wheel().mechanism.points.iter();
    let mut variables: Vec<String> = points
        .flat_map(|point| ["x", "y", "z"].map(|axis| (point.name.as_str(), axis)))
        .filter(|(name, _)| !name.starts_with("spindle"))
        .map(|(point, axis)| {
            format!("{{ hardpoint = \"{point}\", axis = \"{axis}\", range = [-{by}, {by}] }}")
        })
        .collect();
    variables.push(rates.to_owned());
    elastic(&format!(
        "{text}\n{head}\n[sweep]\nmethod = \"random\"\nsamples = {DESIGNS}\nseed = 11\nvariables = [{}]\n",
        variables.join(", ")
    ))
}

const MOTION: &str = "[motion]\ntravel = [-40.0, 0.0, 25.0]\n[outputs]\ncharacteristics = [\"toe\", \"camber\", \"bump_steer\", \
                      \"toe_by_braking\", \"toe_by_braking_secant\"]";

const ARMS: (&str, &str) = (
    "double_wishbone_compliance.toml",
    "{ bushing = \"lower_arm_rear\", stiffness = \"y\", range = [0.5, 2.0], relative = true }",
);
const LINKS: (&str, &str) = (
    "five_link_compliance.toml",
    "{ bushing = \"lower_rear_link_inner\", stiffness = \"x\", range = [0.5, 2.0], relative = true }",
);

fn worker(plan: &SweepPlan<'static>, width: Option<Width>) -> Worker<'static> {
    let plan: &'static SweepPlan<'static> = Box::leak(Box::new(plan.clone()));
    plan.worker_of_width(width).unwrap()
}

fn planned(study: Study) -> SweepPlan<'static> {
    let study: &'static Study = Box::leak(Box::new(study));
    SweepPlan::of(study, study.sweep.as_ref().unwrap()).unwrap()
}

/// Values of all designs of the first block, one list for each column.
fn values(worker: &Worker<'_>, columns: usize) -> Vec<Vec<f64>> {
    let block = worker.block();
    let designs = 0..block.designs();
    let of = |column| {
        designs
            .clone()
            .flat_map(move |k| block.values(k, column))
            .collect()
    };
    (0..columns).map(of).collect()
}

fn bits(values: &[Vec<f64>]) -> Vec<u64> {
    values
        .iter()
        .flatten()
        .map(|value| value.to_bits())
        .collect()
}

/// SIMD lanes and single designs have the same values and the same failures. The bits are the same at every lane width.
/// Lanes and single designs stop at corrections of 1e-13 rad, which is 1e-11 of the largest angles here. Test results are
/// as accurate as the stiffness matrices from which they are computed.
#[test]
fn lanes_have_the_values_of_designs_one_by_one() {
    for (name, rates) in [ARMS, LINKS] {
        let plan = planned(study(name, rates, MOTION, 10.0));
        let mut alone = worker(&plan, None);
        assert_eq!(alone.not_in_lanes(), Some(NotInLanes::Asked));
        alone.rows(0);
        let columns = plan.values().len();
        let expected = values(&alone, columns);
        let mut first: Option<Vec<u64>> = None;
        for width in Width::available() {
            let mut lanes = worker(&plan, Some(width));
            assert_eq!(lanes.not_in_lanes(), None, "{name}");
            lanes.rows(0);
            assert!(
                lanes.one_by_one().len() <= DESIGNS / 10,
                "{name} {width:?}: {:?}",
                lanes.one_by_one()
            );
            let found = values(&lanes, columns);
            for (column, (found, expected)) in found.iter().zip(&expected).enumerate() {
                let sizes = expected.iter().filter(|value| value.is_finite());
                let largest = sizes.map(|value| value.abs()).fold(0.0, larger);
                assert!(largest > 0.0, "{name}: nothing in column {column}");
                for (a, b) in found.iter().zip(expected) {
                    assert_eq!(a.is_nan(), b.is_nan(), "{name} {width:?} {column}: {a} {b}");
                    assert!(
                        a.is_nan() || (a - b).abs() < 1e-11 * largest,
                        "{name} {width:?} {column}: {a} {b}"
                    );
                }
            }
            let bits = bits(&found);
            assert_eq!(first.get_or_insert(bits.clone()), &bits, "{name} {width:?}");
        }
    }
}

/// The first correction of the solver for SIMD lanes is limited to 60 mm. The solver reaches longer travels in several
/// increments.
#[test]
fn long_travels_stay_in_lanes() {
    if !crate::support::has_lanes() {
        return;
    }
    let long = MOTION.replace("[-40.0, 0.0, 25.0]", "[-70.0, 0.0, 80.0]");
    for (name, rates) in [ARMS, LINKS] {
        let plan = planned(study(name, rates, &long, 5.0));
        let mut lanes = worker(&plan, Width::widest());
        lanes.rows(0);
        let left = lanes.one_by_one();
        assert!(left.len() <= DESIGNS / 10, "{name}: {left:?}");
        let mut alone = worker(&plan, None);
        alone.rows(0);
        let toe = |worker: &Worker<'_>| values(worker, 1).remove(0);
        for (a, b) in toe(&lanes).iter().zip(toe(&alone)) {
            assert!((a - b).abs() < 1e-12, "{name}: {a} {b}");
        }
    }
}

/// If only some designs reach a travel, the others fail in the SIMD lanes with the same status as in a single solution.
/// The values of a design do not depend on the other designs in the lanes.
#[test]
fn a_design_without_equilibrium_does_not_disturb_its_neighbours() {
    if !crate::support::has_lanes() {
        return;
    }
    let far = MOTION.replace("[-40.0, 0.0, 25.0]", "[-40.0, 0.0, 260.0]");
    let (name, rates) = ARMS;
    let plan = planned(study(name, rates, &far, 25.0));
    let mut alone = worker(&plan, None);
    alone.rows(0);
    let mut lanes = worker(&plan, Width::widest());
    lanes.rows(0);
    let failures = |worker: &Worker<'_>| {
        let failures = worker.block().failures().iter();
        let mut failures: Vec<_> = failures.map(|f| (f.design, f.station)).collect();
        failures.sort_unstable();
        failures
    };
    let failed = failures(&alone);
    assert!(
        failed.len() > 2 && failed.len() < DESIGNS - 2,
        "{failed:?} of {DESIGNS}"
    );
    assert_eq!(failed, failures(&lanes));
    let refused = lanes.one_by_one().to_vec();
    assert!(failed.iter().all(|(design, _)| refused.contains(design)));
    // At another lane width, a design has other designs in the neighbouring lanes.
    let columns = plan.values().len();
    for width in Width::available() {
        let mut others = worker(&plan, Some(width));
        others.rows(0);
        assert_eq!(
            bits(&values(&others, columns)),
            bits(&values(&lanes, columns))
        );
    }
}

/// SIMD lanes do not support the elastic mount of a strut. The worker reports this.
#[test]
fn a_strut_on_an_elastic_mount_goes_one_by_one() {
    if !crate::support::has_lanes() {
        return;
    }
    let rates =
        "{ bushing = \"lower_arm_rear\", stiffness = \"y\", range = [0.5, 2.0], relative = true }";
    let plan = planned(study("macpherson_compliance.toml", rates, MOTION, 2.0));
    let lanes = worker(&plan, Width::widest());
    assert_eq!(lanes.not_in_lanes(), Some(NotInLanes::Elastic));
}
