//! Support for tests of tolerances: gradients and second-order terms from finite differences between builds.

use crate::compliance::support::fourth_order;
use hardpoint::curves::Curves;
use hardpoint::tolerance::{Expansion, Problem};

/// Half the width of a scatter range. The range is so narrow that the deviation of a part is known.
const NARROW: f64 = 1e-13;

/// List of scattered parts, each with this deviation.
pub fn scatter_at(steps: &[(&str, f64)]) -> String {
    let entry = |(part, step): &(&str, f64)| {
        let [low, high] = [step - NARROW, step + NARROW];
        format!("{{ {part}, limits = [{low:?}, {high:?}] }}")
    };
    let entries: Vec<String> = steps.iter().map(entry).collect();
    entries.join(", ")
}

/// Values of the curves of a build by output and station, in the units of the engine.
pub fn values_of(problem: &Problem<'_>, curves: &Curves) -> Vec<Vec<f64>> {
    let outputs = problem.outputs().iter().enumerate();
    let values = outputs.map(|(k, output)| {
        assert_eq!(output.name, curves.columns[k].name);
        let stations = curves.stations.iter();
        let values = stations.map(|station| station.value(k).unwrap_or(f64::NAN) / output.factor());
        values.collect()
    });
    values.collect()
}

/// Values of a build by output and station, in the units of the engine. The arguments are parts with their deviations.
type Built<'a> = &'a dyn Fn(&[(&str, f64)]) -> Vec<Vec<f64>>;

/// Asserts that the gradients with respect to the parts equal difference quotients (fourth order) of builds. Part k is source
/// k of the problem. Returns the number of quotients that are much larger than their rounding errors.
pub fn assert_gradients(problem: &Problem<'_>, parts: &[&str], built: Built<'_>) -> usize {
    let expansion = Expansion::of(problem).unwrap();
    let mut looked_at = 0;
    for (number, part) in parts.iter().enumerate() {
        let h = 0.1;
        let at = [-2.0, -1.0, 1.0, 2.0].map(|step| built(&[(part, step * h)]));
        for (output, column) in problem.outputs().iter().enumerate() {
            for station in problem.stations().of_motion() {
                let values = at.each_ref().map(|values| values[output][station]);
                let slope = fourth_order(values, h);
                let found = expansion.gradient(problem.cell(output, station))[number];
                let size = (values[1].abs() + values[2].abs()).max(1e-2) * 1e-11 / h;
                let error = (found - slope).abs();
                assert!(
                    error < 1e-6 * slope.abs() + size,
                    "{part}, {} {station}: {found} {slope}",
                    column.name
                );
                looked_at += usize::from(slope.abs() > 1e3 * size);
            }
        }
    }
    looked_at
}

/// Second derivatives of all outputs at a station, per `sigma` of the parts, which move together.
fn bend(parts: &[&str], sigma: f64, station: usize, built: Built<'_>) -> Vec<f64> {
    let h = 0.2;
    let at = |step: f64| {
        let steps: Vec<_> = parts.iter().map(|part| (*part, step * h * sigma)).collect();
        built(&steps)
    };
    let at = [-2.0, -1.0, 0.0, 1.0, 2.0].map(at);
    let second = |k: usize| {
        let [a, b, c, d, e] = at.each_ref().map(|values| values[k][station]);
        -a + 16.0 * b - 30.0 * c + 16.0 * d - e
    };
    let all = 0..at[0].len();
    all.map(|k| second(k) / (12.0 * h * h)).collect()
}

/// Asserts that the second-order terms of two parts with the standard deviation `sigma` equal finite differences, at the last
/// station of the motion. The terms are unknown for outputs whose names contain one of the names `of_velocities`. Returns
/// the number of outputs whose terms are much larger than rounding errors.
pub fn assert_second_order(
    problem: &Problem<'_>,
    parts: [&str; 2],
    sigma: f64,
    of_velocities: &[&str],
    built: Built<'_>,
) -> usize {
    let expansion = Expansion::of(problem).unwrap();
    let station = problem.stations().of_motion().last().unwrap();
    let [first, other, together] =
        [&parts[..1], &parts[1..], &parts].map(|parts| bend(parts, sigma, station, built));
    let mut looked_at = 0;
    for (output, column) in problem.outputs().iter().enumerate() {
        let cell = problem.cell(output, station);
        let found = expansion.second[cell];
        if of_velocities.iter().any(|name| column.name.contains(name)) {
            assert!(found[0].is_nan() && expansion.holds(cell).is_none());
            continue;
        }
        let (one, two) = (first[output], other[output]);
        let mixed = 0.5 * (together[output] - one - two);
        let mean = 0.5 * (one + two);
        let growth = 0.5 * (one * one + two * two) + mixed * mixed;
        // Rounding error of finite differences of positions in millimetres.
        let rounding = if column.name.ends_with("_deg") {
            1e-12
        } else {
            1e-9
        };
        let size = one.abs() + two.abs() + mixed.abs() + rounding;
        let at = format!("{parts:?}, {}", column.name);
        assert!(
            (found[0] - mean).abs() < 1e-4 * size + rounding,
            "{at}: {found:?} {mean}"
        );
        let error = (found[1] - growth).abs();
        assert!(
            error < 1e-4 * size * size + rounding * size,
            "{at}: {found:?} {growth}"
        );
        looked_at += usize::from(size > 1e3 * rounding);
    }
    looked_at
}
