//! Tests of steered axles in SIMD lanes against one-by-one evaluation.

use super::world::World;
use super::{RIGHT, random, study};
use crate::support::random::Random;
use hardpoint::axle::{AxleQuantity, Quantity};
use hardpoint::number::Width;
use hardpoint::study::Study;
use hardpoint::sweep::{SweepPlan, Worker};
use std::path::Path;

/// Number of designs of each axle.
const DESIGNS: usize = 24;

/// Points whose coordinates a sweep scatters.
const MOVED: [(&str, &str); 6] = [
    ("lower_link_axle", "z"),
    ("kingpin_upper", "y"),
    ("drag_link_knuckle", "z"),
    ("drag_link_body", "x"),
    ("tie_rod_end", "y"),
    ("wheel_centre", "z"),
];

/// Sweep of an axle with every quantity that SIMD lanes can compute.
fn swept(world: &World, motion: &str, scatter: f64) -> &'static Study {
    let variables = MOVED.map(|(point, axis)| {
        format!(
            "{{ hardpoint = \"{point}\", axis = \"{axis}\", range = [{:?}, {scatter:?}] }}",
            -scatter
        )
    });
    let further = format!(
        "[motion]\n{motion}\n[outputs]\ncharacteristics = [\"toe\"]\n[sweep]\nmethod = \"random\"\n\
         samples = {DESIGNS}\nseed = 3\nvariables = [{}]\n",
        variables.join(", ")
    );
    let text = study(world, &further);
    let read = Study::from_text("swept.toml", &text, Path::new("."));
    let mut study = read.unwrap_or_else(|errors| panic!("{errors}\n{text}"));
    let both = study.axle_mut().unwrap();
    let names = Quantity::names();
    let all = names.iter().flat_map(|name| Quantity::named(name));
    let has = |quantity: &Quantity| both.axle.has(*quantity);
    both.plan.quantities = all.filter(|q| q.is_for_lanes()).filter(has).collect();
    Box::leak(Box::new(study))
}

fn worker(study: &'static Study, width: Option<Width>) -> Worker<'static> {
    let plan = SweepPlan::of(study, study.sweep.as_ref().unwrap()).unwrap();
    let plan: &'static SweepPlan<'static> = Box::leak(Box::new(plan));
    let mut worker = plan.worker_of_width(width).unwrap();
    worker.rows(0);
    worker
}

/// Random axle. Every third axle has a slanted steering gear, static camber and toe, and a different right half.
fn axle(generator: &mut Random, number: usize, by: f64) -> World {
    let mut world = random(generator, number.is_multiple_of(2), by);
    if number.is_multiple_of(3) {
        let way = [0.2, 2.0, -0.3];
        let length = way.iter().map(|c| c * c).sum::<f64>().sqrt();
        world.direction = way.map(|c| c / length);
        world.angles = [0.02, -0.01];
        world.apart = RIGHT
            .iter()
            .map(|name| (*name, [0.0; 3].map(|_| 12.0 * generator.signed())))
            .collect();
    }
    world
}

/// Results of a comparison of SIMD lanes with single designs.
struct Compared {
    /// Number of designs without all poses.
    failed: usize,
    /// Number of designs that the lanes reject.
    rejected: usize,
    /// Number of values that exist, and number of all values.
    values: [usize; 2],
}

/// Compares a sweep in SIMD lanes with the same sweep one by one: values, failures and faults.
fn compare(world: &World, motion: &str, scatter: f64) -> Compared {
    let study = swept(world, motion, scatter);
    let quantities = &study.axle().unwrap().plan.quantities;
    let mean_steer = Quantity::named("mean_steer")[0];
    let mean_steer = quantities.iter().position(|q| *q == mean_steer).unwrap();
    let of_axle = quantities.iter().filter(|q| matches!(q, Quantity::Axle(_)));
    assert!(of_axle.count() > 12, "{quantities:?}");
    let alone = worker(study, None);
    let mut first: Option<Vec<u64>> = None;
    let mut rejected = 0;
    for width in Width::available() {
        let lanes = worker(study, Some(width));
        assert_eq!(lanes.not_in_lanes(), None, "{motion}");
        rejected = lanes.one_by_one().len();
        assert_eq!(lanes.block().failures(), alone.block().failures());
        assert_eq!(lanes.block().faults(), alone.block().faults());
        let mut bits = Vec::new();
        for design in 0..DESIGNS {
            for (k, quantity) in quantities.iter().enumerate() {
                let found = lanes.block().values(design, k);
                let expected = alone.block().values(design, k);
                for (station, (found, expected)) in found.zip(expected).enumerate() {
                    bits.push(found.to_bits());
                    let steer = alone.block().value(design, mean_steer, station);
                    if *quantity == Quantity::Axle(AxleQuantity::AckermannError)
                        && steer.abs() < 1e-9
                    {
                        // At zero steer either wheel may count as the inner one, so such values are not compared.
                        continue;
                    }
                    // The error of a quotient with a small denominator grows with its value.
                    let scale = expected.abs().max(1.0) * (1.0 + expected.abs() / 500.0);
                    assert!(
                        found.is_nan() && expected.is_nan()
                            || (found - expected).abs() < 1e-9 * scale,
                        "{motion} {design}: {quantity:?} {station} {found} {expected}"
                    );
                }
            }
        }
        match &first {
            None => first = Some(bits),
            Some(first) => assert!(*first == bits, "{motion}: bits of {width:?}"),
        }
    }
    let cells = (0..DESIGNS).flat_map(|design| (0..quantities.len()).map(move |k| (design, k)));
    let all = cells.flat_map(|(design, k)| alone.block().values(design, k));
    let values = all.fold([0; 2], |[finite, all], value| {
        [finite + usize::from(value.is_finite()), all + 1]
    });
    let failures = alone.block().failures().iter().map(|failed| failed.design);
    let faults = alone.block().faults().iter().map(|(design, _)| *design);
    let failed: std::collections::BTreeSet<usize> = failures.chain(faults).collect();
    Compared {
        failed: failed.len(),
        rejected,
        values,
    }
}

/// SIMD lanes and the solver for single designs give equal values for steered axles: in roll, in heave, and steered to
/// both sides. The lanes leave almost no design to the solver for single designs.
#[test]
fn lanes_have_the_values_of_designs_one_by_one() {
    let mut generator = Random(99);
    let (mut designs, mut left) = (0, 0);
    for number in 0..8 {
        let world = axle(&mut generator, number, 15.0);
        for motion in [
            "roll = { from = -4.0, to = 4.0, steps = 5 }\nheave = [-20.0, 30.0]\nrack = [-60.0, 0.0, 45.0]",
            "heave = { from = -50.0, to = 50.0, steps = 5 }\nrack = [50.0]",
            "travel_left = [20.0]\ntravel_right = [20.0]\nrack = { from = -60.0, to = 60.0, steps = 5 }",
        ] {
            let found = compare(&world, motion, 8.0);
            (designs, left) = (designs + DESIGNS, left + found.rejected);
            let [finite, all] = found.values;
            assert!(
                all > 5 * 12 * DESIGNS && 2 * finite > all,
                "{motion}: {finite} of {all}"
            );
        }
    }
    println!("{left} of {designs} designs were solved one by one");
    assert!(20 * left < designs, "{left} of {designs}");
}

/// Beyond the toggle of a rod there is no pose. Lanes find no pose there, and no lane changes to the other assembly of a
/// knuckle.
#[test]
fn toggles_of_knuckles_are_found_as_one_by_one() {
    if !crate::support::has_lanes() {
        return;
    }
    let mut generator = Random(7);
    let mut counts = [0; 3];
    for number in 0..8 {
        let world = axle(&mut generator, number, 25.0);
        let gear = -50.0 - 5.0 * number as f64;
        let motion =
            format!("roll = [-5.0, 0.0, 5.0]\nheave = [0.0, 40.0]\nrack = [{gear:?}, 90.0]");
        let found = compare(&world, &motion, 25.0);
        assert!(found.failed <= found.rejected);
        counts = [
            counts[0] + DESIGNS,
            counts[1] + found.failed,
            counts[2] + found.rejected,
        ];
    }
    let [designs, failed, rejected] = counts;
    println!("{failed} of {designs} designs have no pose, {rejected} were solved one by one");
    assert!(failed > designs / 20 && failed < designs, "{failed}");
}
