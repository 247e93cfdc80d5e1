//! Tests of first-order and second-order results of builds of axles against finite differences between built axles.

use super::axle::{axle, problem};
use hardpoint::assembly::Assembler;
use hardpoint::axle::{Axle, AxleSolver, Placement, Quantity};
use hardpoint::model::Side;
use hardpoint::study::{Source, Study};
use hardpoint::tolerance::Expansion;

/// Values of a built axle in one position, with each tolerance source moved by a given amount.
struct Moved<'s> {
    sources: Vec<&'s Source>,
    assemblers: [Assembler; 2],
    drawn: Axle,
    quantities: Vec<Quantity>,
    placement: Placement,
}

impl<'s> Moved<'s> {
    fn of(study: &'s Study, placement: Placement) -> Self {
        let both = study.axle().unwrap();
        let assemblers = Side::ALL.map(|side| Assembler::new(both.axle.suspension(side)).unwrap());
        let scatter = &study.tolerance.as_ref().unwrap().scatter;
        Moved {
            sources: scatter.iter().flat_map(|c| &c.sources).collect(),
            drawn: Axle {
                left: assemblers[0].suspension().clone(),
                right: Some(assemblers[1].suspension().clone()),
                setup: both.axle.setup.clone(),
                elastic: None,
            },
            assemblers,
            quantities: both.plan.quantities.clone(),
            placement,
        }
    }

    fn values(&self, steps: &[(usize, f64)]) -> Vec<f64> {
        let mut designs = Side::ALL.map(|side| self.drawn.suspension(side).design.clone());
        for side in Side::ALL {
            let assembler = &self.assemblers[side as usize];
            let mut parts = assembler.drawn().clone();
            for (number, step) in steps {
                let source = self.sources[*number];
                let own = source.changes.iter().filter(|_| source.side == Some(side));
                for (parameter, share) in own {
                    parts.change(&assembler.suspension().mechanism, *parameter, share * step);
                }
            }
            let into = &mut designs[side as usize];
            assembler.assemble(&parts, 0.0, into).unwrap();
        }
        let mut solver = AxleSolver::<2>::new(&self.drawn, &self.quantities, false).unwrap();
        solver.prepare([&designs[0], &designs[1]]).unwrap();
        let placed = solver.place(&self.placement).unwrap();
        let read = solver.read(&placed).unwrap();
        let value = |quantity: &Quantity| quantity.value(&read.state).unwrap_or(f64::NAN);
        self.quantities.iter().map(value).collect()
    }
}

/// Derivatives with respect to all contributors of either side equal the slopes of the built axle's values, by finite
/// differences of fourth order.
#[test]
fn gradients_are_slopes_of_built_axles() {
    let study = axle("builds=2", &[]);
    let problem = problem(&study);
    let expansion = Expansion::of(&problem).unwrap();
    // The tested station has roll, heave and steering.
    let station = 9;
    let moved = Moved::of(&study, problem.placements()[station]);
    let mut looked_at = 0;
    for (k, source) in moved.sources.iter().enumerate() {
        let h = 0.05 * source.law.variance().sqrt();
        let at = [-2.0, -1.0, 1.0, 2.0].map(|step| moved.values(&[(k, step * h)]));
        for output in 0..moved.quantities.len() {
            let [a, b, c, d] = at.each_ref().map(|values| values[output]);
            let slope = (a - d + 8.0 * (c - b)) / (12.0 * h);
            let found = expansion.gradient(problem.cell(output, station))[k];
            let size = (b.abs() + c.abs()).max(1e-3) * 1e-11 / h;
            let error = (found - slope).abs();
            assert!(
                error < 1e-8 * slope.abs() + size,
                "{} {output}: {found} {slope}",
                source.name
            );
            looked_at += usize::from(slope.abs() > 1e3 * size);
        }
    }
    assert!(looked_at > 2 * moved.sources.len(), "{looked_at}");
}

/// The second-order contribution is half the second derivative times the variance, including products of tolerance sources of
/// both wheels. The result agrees with finite differences of fourth order in roll, at given travels on a plane, and on pads.
/// The program does not compute this contribution for quantities made of velocities.
#[test]
fn second_order_is_that_of_built_axles() {
    let two = "tolerance.scatter=[{length=\"tie_rod\",sigma=2.0,side=\"left\"},\
        {hardpoint=\"lower_arm_rear\",axis=\"z\",sigma=3.0,side=\"right\"}]";
    let outputs = "outputs.characteristics=[\"toe\",\"camber_to_road\",\"mean_steer\",\"track\",\"ackermann_error\",\"roll_angle\",\"roll_steer\"]";
    let motions = [
        "motion={roll=[2.0],heave=[-20.0],rack=12.0}",
        "motion={travel_left=[-20.0],travel_right=[30.0],ground=\"plane\",rack=12.0}",
        "motion={heave=[30.0],rack=12.0}",
    ];
    for motion in motions {
        let study = axle(
            "builds=2",
            &[two, outputs, motion, "vehicle.wheelbase=2650.0"],
        );
        let problem = problem(&study);
        let expansion = Expansion::of(&problem).unwrap();
        let moved = Moved::of(&study, problem.placements()[0]);
        // Steps of a fifth of a standard deviation along one tolerance source, or along two.
        let bend = |sources: &[usize]| -> Vec<f64> {
            let h = 0.2;
            let at = |step: f64| {
                let sigma = |k: &usize| moved.sources[*k].law.variance().sqrt();
                let steps: Vec<_> = sources.iter().map(|k| (*k, step * h * sigma(k))).collect();
                moved.values(&steps)
            };
            let [a, b, c, d, e] = [-2.0, -1.0, 0.0, 1.0, 2.0].map(at);
            let second = |k: usize| -a[k] + 16.0 * b[k] - 30.0 * c[k] + 16.0 * d[k] - e[k];
            (0..a.len()).map(|k| second(k) / (12.0 * h * h)).collect()
        };
        let [first, other, together] = [bend(&[0]), bend(&[1]), bend(&[0, 1])];
        let mut looked_at = 0;
        for (output, quantity) in moved.quantities.iter().enumerate() {
            let cell = problem.cell(output, 0);
            let found = expansion.second[cell];
            if quantity.rate_order() > 0 {
                assert!(found[0].is_nan() && expansion.holds(cell).is_none());
                continue;
            }
            let (one, two) = (first[output], other[output]);
            let mixed = 0.5 * (together[output] - one - two);
            let mean = 0.5 * (one + two);
            let growth = 0.5 * (one * one + two * two) + mixed * mixed;
            let value = moved.values(&[])[output].abs().max(1e-3);
            // Rounding error of the finite differences.
            let rounding = 1e-12 * value;
            let size = one.abs() + two.abs() + mixed.abs() + rounding;
            let name = quantity.name();
            assert!(
                (found[0] - mean).abs() < 1e-5 * size + rounding,
                "{motion} {name}: {found:?} {mean}"
            );
            let error = (found[1] - growth).abs();
            assert!(
                error < 1e-5 * size * size + rounding * size,
                "{motion} {name}: {found:?} {growth}"
            );
            looked_at += usize::from(mixed.abs() > 1e3 * rounding);
        }
        let on_pads = motion.starts_with("motion={heave");
        assert!(
            looked_at >= if on_pads { 1 } else { 3 },
            "{motion}: {looked_at}"
        );
    }
}
