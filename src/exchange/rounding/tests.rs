//! Tests of rounding, on the sample study and on a tuned semi-trailing arm.

use super::*;
use std::path::Path;

#[test]
fn multiples_of_a_decimal_grid_are_decimals() {
    for (step, steps, length) in [
        (0.1, 3.0, 0.3),
        (0.5, -3.0, -1.5),
        (2.0, 7.0, 14.0),
        (0.001, 1234.0, 1.234),
        (0.3, 3.0, 0.9),
        (0.15, 3387.0, 508.05),
        (1.1, 73.0, 80.3),
        (2.5, -3.0, -7.5),
    ] {
        let unit = LengthUnit::Millimetre;
        assert_eq!(Grid { step, unit }.length(steps), length);
    }
}

#[test]
fn decimals_of_any_length_are_the_shortest() {
    let unit = LengthUnit::Metre;
    for (step, parts) in [(0.001, 1000.0), (0.0001, 10_000.0), (1.0, 1.0)] {
        for steps in 0..2000 {
            let steps = f64::from(steps);
            assert_eq!(Grid { step, unit }.length(steps), steps / parts);
        }
    }
}

/// A number of grid steps counts as an integer if its relative distance from an integer is at most 1e-9. For numbers below 1, this
/// limit applies to the distance itself.
#[test]
fn whole_numbers_have_no_neighbours() {
    for (at, expected) in [
        (3.0, (3.0, 3.0)),
        (3.0 + 2.9985e-9, (3.0, 3.0)),
        (3.0 + 3.0015e-9, (3.0, 4.0)),
        (0.9995e-9, (0.0, 0.0)),
        (1.0005e-9, (0.0, 1.0)),
        (-2.5, (-3.0, -2.0)),
    ] {
        assert_eq!(neighbours(at), expected, "{at}");
    }
}

fn front() -> Study {
    let directory = Path::new(env!("CARGO_MANIFEST_DIR")).join("studies");
    let text = std::fs::read_to_string(directory.join("macpherson_front.toml")).unwrap();
    let study = Study::from_text("front.toml", &text, &directory).unwrap();
    // In this design, as after a tuning, no coordinate is on the grid.
    let design = study.wheel().design.iter().zip(1..).map(|(p, n)| {
        let off = 0.37 * f64::from(n);
        *p + Vector3::new(off.sin(), off.cos(), (2.0 * off).sin()) * 0.4
    });
    study.at_design(design.collect())
}

/// The sample meets its targets with a misfit of a tenth of a tolerance. Rounding to a millimetre raises the misfit by
/// several tolerances. The best rounding must be no worse than ordinary rounding, must be on the grid, and must be within
/// one step. This holds in any unit of the grid.
#[test]
fn nearest_plane_loses_no_more_than_ordinary_rounding() {
    let study = front();
    let all = vec![true; 3 * study.wheel().design.len()];
    let free = vec![[f64::NEG_INFINITY, f64::INFINITY]; all.len()];
    let mut better = 0;
    for (step, unit) in [
        (1.0, LengthUnit::Millimetre),
        (0.1, LengthUnit::Millimetre),
        (0.05, LengthUnit::Inch),
        (0.001, LengthUnit::Metre),
    ] {
        let grid = Grid { step, unit };
        let rounded = rounded(&study, grid, &all, &free).unwrap();
        let loss = rounded.loss.unwrap();
        assert!(loss.best <= loss.ordinary.unwrap(), "{loss:?}");
        better += usize::from(loss.best < loss.ordinary.unwrap());
        // Rounding the rounded design again does not change it.
        let after = study.at_design(rounded.design.clone());
        let again = super::rounded(&after, grid, &all, &free).unwrap();
        assert_eq!(again.coordinates, rounded.coordinates);
        let before = Problem::new(&study, grid, &all, &free).before;
        let written = rounded.coordinates.iter().flatten();
        for (before, after) in before.iter().zip(written) {
            assert!(
                (after - before).abs() <= step * (1.0 + 1e-9),
                "{before} {after}"
            );
            assert_eq!(grid.length((after / step).round()), *after);
        }
        // The rounded design and the written coordinates describe the same points.
        let own = study.wheel().length_unit;
        for (point, written) in rounded.design.iter().zip(&rounded.coordinates) {
            let point = study.wheel().frame.vector(*point).to_array();
            for (x, written) in point.iter().zip(written) {
                assert!((x - own.convert(*written, unit)).abs() <= 1e-12 * x.abs());
            }
        }
    }
    assert!(better >= 1, "{better}");
}

#[test]
fn coordinates_that_are_not_free_keep_their_bits() {
    let study = front();
    let tuned = tuned_coordinates(&study);
    let count = tuned.iter().filter(|free| **free).count();
    let free = vec![[f64::NEG_INFINITY, f64::INFINITY]; tuned.len()];
    assert!(count > 0 && count < tuned.len(), "{count}");
    for unit in LengthUnit::ALL {
        let step = unit.convert(1.0, LengthUnit::Millimetre);
        let grid = Grid { step, unit };
        let rounded = rounded(&study, grid, &tuned, &free).unwrap();
        let moved = moved_coordinates(&study.wheel().design, &rounded.design);
        for (moved, tuned) in moved.iter().zip(&tuned) {
            assert_eq!(moved, tuned);
        }
    }
}

/// A tuned semi-trailing arm: the tuning moved x of the outer pivot from 380 to 347.696. The box constraint and the range
/// of this coordinate begin at `least`.
fn arm(range: f64, least: f64) -> (Study, Vec<Vector3<f64>>) {
    let text = |x: f64| {
        format!(
            "[suspension]\ntopology = \"semi_trailing_arm\"\n\
             [suspension.hardpoints]\narm_pivot_inner = [420.0, 250.0, 280.0]\n\
             arm_pivot_outer = [{x:?}, 560.0, 290.0]\nwheel_centre = [0.0, 700.0, 300.0]\n\
             [wheel]\nstatic_camber = -1.0\nstatic_toe = 0.0\n\
             [motion]\ntravel = {{ from = -40.0, to = 40.0, steps = 9 }}\n\
             [optimise]\nvariables = [{{ hardpoint = \"arm_pivot_outer\", axis = \"x\", range = [-{range:?}, {range:?}] }}]\n\
             [[optimise.targets]]\ncharacteristic = \"camber_gain\"\nat = 0.0\nvalue = 0.05\ntolerance = 0.001\n\
             [[optimise.constraints]]\npoint = \"arm_pivot_outer\"\nat = \"design\"\n\
             inside = {{ box = [[{least:?}, 500.0, 200.0], [349.0, 600.0, 400.0]] }}\n"
        )
    };
    let study = |x| Study::from_text("arm", &text(x), Path::new("")).unwrap();
    let origin = study(380.0).wheel().design.clone();
    (study(347.696), origin)
}

/// The nearest multiples of 1 mm and 5 mm are 348 and 350, and the target prefers smaller x. Constraints and ranges have
/// priority. If no multiple satisfies the box constraint, the result states by how much the rounding misses it.
#[test]
fn rounding_keeps_constraints_and_ranges() {
    let millimetres = |step: f64, range: f64, least: f64| {
        let (study, origin) = arm(range, least);
        let free = tuned_coordinates(&study);
        let ranges = ranges_of_coordinates(&study, &origin);
        let unit = LengthUnit::Millimetre;
        let rounded = rounded(&study, Grid { step, unit }, &free, &ranges).unwrap();
        let broken: Vec<f64> = rounded.broken.iter().map(|own| own.missed).collect();
        (rounded.coordinates[1][0], broken)
    };
    assert_eq!(millimetres(1.0, 60.0, 300.0), (347.0, vec![]));
    assert_eq!(millimetres(1.0, 60.0, 347.6), (348.0, vec![]));
    assert_eq!(millimetres(1.0, 32.5, 300.0), (348.0, vec![]));
    // 345 is 1.5 mm below the lower limit, and 350 is 1 mm above the upper limit. With a lower limit of 344, the multiple 345
    // is within the limits.
    let (at, broken) = millimetres(5.0, 60.0, 346.5);
    assert_eq!(at, 350.0);
    assert!((broken[0] - 1.0).abs() < 1e-9, "{broken:?}");
    assert_eq!(millimetres(5.0, 60.0, 344.0), (345.0, vec![]));
}

/// If the range of a coordinate contains no multiple, the result names the coordinate and its distance from the range.
#[test]
fn a_range_without_a_multiple_is_named() {
    let (study, _) = arm(60.0, 300.0);
    let free = tuned_coordinates(&study);
    let mut ranges = vec![[f64::NEG_INFINITY, f64::INFINITY]; free.len()];
    ranges[3] = [346.0, 348.0];
    let unit = LengthUnit::Millimetre;
    let rounded = rounded(&study, Grid { step: 5.0, unit }, &free, &ranges).unwrap();
    let [broken] = &rounded.broken[..] else {
        panic!("{:?}", rounded.broken);
    };
    assert_eq!(
        broken.name,
        "x of arm_pivot_outer in its range from 346 to 348"
    );
    assert_eq!(rounded.coordinates[1][0], 345.0);
    assert!((broken.missed - 1.0).abs() < 1e-9, "{}", broken.missed);
}

/// No change of one or two coordinates to their other neighbours improves the chosen rounding. This also holds if the design is
/// within a target band. There the misfit has no derivative that the method nearest plane could use.
#[test]
fn no_flip_of_one_or_two_coordinates_is_better() {
    let directory = Path::new(env!("CARGO_MANIFEST_DIR")).join("studies");
    let text = std::fs::read_to_string(directory.join("formula_student_front.toml")).unwrap();
    let study = Study::from_text("front", &text, &directory).unwrap();
    let tuned = crate::optimise::tune(
        &study.vehicle,
        study.optimise.as_ref().unwrap(),
        Default::default(),
    );
    let study = study.moved(&tuned.unwrap().best.unwrap().offsets);
    let free = tuned_coordinates(&study);
    let ranges = vec![[f64::NEG_INFINITY, f64::INFINITY]; free.len()];
    let unit = LengthUnit::Millimetre;
    let problem = Problem::new(&study, Grid { step: 0.5, unit }, &free, &ranges);
    let rounded = rounded(&study, problem.grid, &free, &ranges).unwrap();
    let best = rounded.loss.unwrap().best;
    let chosen: Vec<f64> = rounded
        .coordinates
        .iter()
        .flatten()
        .map(|x| x / 0.5)
        .collect();
    let targets = problem.targets(study.optimise.as_ref().unwrap());
    let movable: Vec<usize> = (0..free.len())
        .filter(|k| free[*k] && problem.neighbours(*k).0 < problem.neighbours(*k).1)
        .collect();
    assert!(movable.len() > 5, "{movable:?}");
    for (k, one) in movable.iter().enumerate() {
        for other in &movable[..=k] {
            let mut steps = chosen.clone();
            for coordinate in if one == other {
                vec![*one]
            } else {
                vec![*one, *other]
            } {
                let (least, most) = problem.neighbours(coordinate);
                steps[coordinate] = least + most - steps[coordinate];
            }
            if let Some(candidate) = targets.candidate(&problem, steps) {
                assert!(
                    candidate.violation > 0.0 || candidate.misfit >= best,
                    "{one} {other}"
                );
            }
        }
    }
}
