//! Tests of random loads on random designs with bushings: every reported equilibrium is correct, and loads that the
//! program refuses have no equilibrium.

use super::support::{elastic, with};
use crate::support::larger;
use crate::support::random::Random;
use hardpoint::compliance::{
    AxialStiffness, Compliance, ElasticWheel, Equilibrium, HeldQuantity, Shape, WheelFigures,
    WheelLoads,
};
use hardpoint::model::Suspension;
use hardpoint::number::Vector3;
use hardpoint::study::Study;

/// Largest force, N.
const LARGEST: f64 = 10_000.0;
/// Number of steps of the fine continuation.
const FINE: usize = 40;
/// Number of bisections at the end of a continuation.
const BISECTIONS: usize = 12;

/// Counts of loads by outcome, and the largest errors.
#[derive(Debug, Default)]
struct Seen {
    loads: usize,
    ok: usize,
    /// Loads at 0.5 of the load at which fine steps end: number of tried loads, and of solved loads.
    below_half: [usize; 2],
    /// Loads at 0.9 of the load at which fine steps end: number of tried loads, and of solved loads.
    below_end: [usize; 2],
    /// Largest unbalanced force, divided by its bound.
    worst_balance: f64,
    /// Largest difference between a solution and the end of fine steps: rad, and positions divided by 300 mm.
    worst_difference: f64,
    /// Largest difference between a solution and a second solution that starts from the first one.
    worst_correction: f64,
}

fn between(random: &mut Random, low: f64, high: f64) -> f64 {
    low + (high - low) * 0.5 * (random.signed() + 1.0)
}

/// Random integer from 0 to `count` - 1.
fn below(random: &mut Random, count: usize) -> usize {
    ((0.5 * (random.signed() + 1.0) * count as f64) as usize).min(count - 1)
}

/// Suspension and parts of a study, with points moved by up to 10 mm and rates changed by up to a factor of 2.
pub fn varied(study: &Study, random: &mut Random) -> (Suspension, Compliance) {
    let mut suspension = study.wheel().clone();
    suspension.design = random.scattered(&suspension.design, 10.0);
    let mut parts = study.compliance().unwrap().parts.clone();
    let mut factor = || random.signed().exp2();
    for bushing in &mut parts.bushings {
        for shape in &mut bushing.shapes {
            match shape {
                Shape::Cubic { rate, .. } => *rate *= factor(),
                Shape::Curve { scale, .. } => *scale *= factor(),
            }
        }
    }
    for link in &mut parts.links {
        if let AxialStiffness::Rate(rate) = &mut link.stiffness {
            *rate *= factor();
        }
    }
    (suspension, parts)
}

/// Load with forces at the contact point and the wheel centre, up to 10 kN, and a moment.
fn load(random: &mut Random) -> WheelLoads {
    let mut loads = WheelLoads::none(0.0);
    let direction = random.vector(1.0);
    let size = between(random, 0.0, LARGEST);
    let force = direction * (size / direction.norm().max(1e-3));
    match below(random, 3) {
        0 => loads.contact = Vector3::new(force.x, force.y, 0.0),
        1 => loads.centre = force,
        _ => {
            (loads.side, loads.trail) = (force.y, between(random, 0.0, 50.0));
            loads.moment.z = between(random, -2e5, 2e5);
        }
    }
    loads
}

fn times(loads: &WheelLoads, share: f64) -> WheelLoads {
    let mut scaled = WheelLoads::none(0.0).plus(loads, share);
    scaled.trail = loads.trail;
    scaled
}

/// Largest difference of angles (rad), and of the wheel centre divided by 300 mm.
fn difference(a: &WheelFigures, b: &WheelFigures) -> f64 {
    let centre = (a.centre - b.centre).norm() / 300.0;
    [a.toe - b.toe, a.camber - b.camber, a.spin - b.spin]
        .into_iter()
        .fold(centre, |m, d| larger(m, d.abs()))
}

/// Follows the equilibrium in fine steps of the load, with bisection at the end. Returns the largest fraction of the
/// load with an equilibrium. Also returns the equilibrium if this fraction is 1.
fn fine(
    wheel: &ElasticWheel,
    station: &Equilibrium,
    loads: &WheelLoads,
    held: HeldQuantity,
    steps: usize,
) -> (f64, Option<Equilibrium>) {
    let (mut reached, mut at) = (0.0, *station);
    for k in 1..=steps {
        let share = k as f64 / steps as f64;
        match wheel.loaded_about(station, &at, &times(loads, share), held) {
            Ok(next) => (reached, at) = (share, next),
            Err(_) => {
                let mut end = share;
                for _ in 0..BISECTIONS {
                    let middle = 0.5 * (reached + end);
                    match wheel.loaded_about(station, &at, &times(loads, middle), held) {
                        Ok(next) => (reached, at) = (middle, next),
                        Err(_) => end = middle,
                    }
                }
                return (reached, None);
            }
        }
    }
    (1.0, Some(at))
}

/// Largest translational stiffness, N/mm.
fn stiffest(parts: &Compliance) -> f64 {
    let shapes = parts.bushings.iter().flat_map(|part| &part.shapes[..3]);
    let rates = shapes.map(|shape| shape.initial_rate());
    let links = parts.links.iter().map(|link| match link.stiffness {
        AxialStiffness::Rate(rate) => rate,
        AxialStiffness::PerStrain(force) => force / 100.0,
    });
    rates.chain(links).fold(0.0, larger)
}

/// Checks `loads_of_each` loads on each of `designs` designs.
fn check(seed: u64, designs: usize, loads_of_each: usize) -> Seen {
    let studies = [
        "double_wishbone_compliance.toml",
        "five_link_compliance.toml",
    ]
    .map(|name| elastic(&with(name, "")));
    let mut random = Random(seed);
    let mut seen = Seen::default();
    for number in 0..designs {
        let study = &studies[number % 2];
        let (suspension, parts) = varied(study, &mut random);
        let Ok(wheel) = ElasticWheel::new(&suspension, &parts) else {
            continue;
        };
        let Ok(station) = wheel.at(between(&mut random, -30.0, 30.0), 0.0) else {
            continue;
        };
        let design_load = wheel.wheel_load(&station).abs();
        for _ in 0..loads_of_each {
            let loads = load(&mut random);
            let held = match below(&mut random, 2) {
                0 => HeldQuantity::WheelHeight,
                _ => HeldQuantity::WheelLoad,
            };
            seen.loads += 1;
            let found = wheel.loaded_about(&station, &station, &loads, held);
            let (end, whole) = fine(&wheel, &station, &loads, held, FINE);
            // `end` is the share of the load that the fine continuation reaches.
            let is_ok = found.is_ok();
            if let Ok(at) = &found {
                seen.ok += 1;
                let size = [loads.contact, loads.centre]
                    .into_iter()
                    .fold(loads.side.abs(), |m, f| larger(m, f.norm()));
                let bound = 1e-10 * size.max(design_load)
                    + 8.0 * f64::EPSILON * stiffest(&parts) * suspension.size();
                let left = wheel.out_of_balance(at);
                seen.worst_balance = larger(seen.worst_balance, left / bound);
                assert!(left <= bound, "{left} {bound}: {loads:?} {held:?}");
                // The solver leaves out corrections that it predicts to be small. A second solution shows that they are
                // small.
                let again = wheel.loaded_about(&station, at, &loads, held).unwrap();
                let off = difference(&wheel.figures(at), &wheel.figures(&again));
                seen.worst_correction = larger(seen.worst_correction, off);
                // The solution does not jump to another equilibrium: a continuation in fine steps ends in the same state.
                let whole = whole.unwrap_or_else(|| panic!("fine steps end at {end}: {loads:?}"));
                let off = difference(&wheel.figures(at), &wheel.figures(&whole));
                seen.worst_difference = larger(seen.worst_difference, off);
                assert!(off < 1e-9, "{off}: {loads:?} {held:?}");
            } else {
                // The refusal is correct: a continuation in fine steps does not reach the load either.
                assert!(
                    whole.is_none(),
                    "refused, but held in fine steps: {loads:?} {held:?}"
                );
            }
            if end < 1.0 {
                for (share, counts) in [(0.5, &mut seen.below_half), (0.9, &mut seen.below_end)] {
                    let part = times(&loads, 0.999 * share * end);
                    let found = wheel.loaded_about(&station, &station, &part, held);
                    counts[0] += 1;
                    counts[1] += usize::from(found.is_ok());
                }
            } else if is_ok {
                // The whole load has an equilibrium. So the loads at half of it and at 0.9 of it count as tried and
                // solved.
                for counts in [&mut seen.below_half, &mut seen.below_end] {
                    counts[0] += 1;
                    counts[1] += 1;
                }
            }
        }
    }
    seen
}

fn assert_seen(seen: &Seen) {
    assert!(seen.worst_correction < 1e-12, "{seen:?}");
    let share = |[all, ok]: [usize; 2]| ok as f64 / all as f64;
    assert!(share(seen.below_half) >= 0.99, "{seen:?}");
    assert!(share(seen.below_end) >= 0.9, "{seen:?}");
}

#[test]
fn random_loads_are_balanced_or_rightly_refused() {
    let seen = check(7, 12, 10);
    assert!(seen.ok > 60, "{seen:?}");
    assert_seen(&seen);
}

#[test]
#[ignore = "100 000 loads: minutes"]
fn a_hundred_thousand_random_loads() {
    let seen = check(11, 2_000, 50);
    assert!(seen.loads > 90_000, "{seen:?}");
    println!("{seen:?}");
    assert_seen(&seen);
}
