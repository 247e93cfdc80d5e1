//! Tests of side effects of a tuned car, against separately solved results and against a tuning of the axle alone.

use hardpoint::SideEffect;
use hardpoint::car::{CarQuantity, CarSolver, moved};
use hardpoint::side_effects::{side_effects, side_effects_of_car};
use hardpoint::study::{CarStudy, Study};
use std::path::Path;

fn study(changes: &[&str]) -> CarStudy {
    let changes: Vec<String> = changes.iter().map(|change| (*change).to_owned()).collect();
    CarStudy::read(Path::new("studies/car.toml"), &changes).unwrap()
}

/// Study with its variables at these values.
fn at(study: &CarStudy, x: &[f64]) -> CarStudy {
    let variables = &study.optimise.as_ref().unwrap().variables;
    CarStudy {
        car: moved(&study.car, variables, x),
        ..study.clone()
    }
}

/// Values of all variables in the original car, with some of them changed.
fn values(study: &CarStudy, changes: &[(usize, f64)]) -> Vec<f64> {
    let variables = &study.optimise.as_ref().unwrap().variables;
    let own = variables.iter().map(|v| v.moves.value(&study.car).unwrap());
    let mut x: Vec<f64> = own.collect();
    for (number, change) in changes {
        x[*number] += change;
    }
    x
}

fn printed(study: &CarStudy, quantity: CarQuantity) -> Vec<Option<f64>> {
    let mut solver = CarSolver::new(&study.car).unwrap();
    let mut value = |case| {
        let found = solver.solve(case).ok()?;
        quantity.printed(&solver.solved(case, &found).ok()?, case)
    };
    study.cases.iter().map(&mut value).collect()
}

fn named<'e>(effects: &'e [SideEffect], name: &str) -> &'e SideEffect {
    let mut found = effects.iter().filter(|effect| effect.output == name);
    let effect = found.next().unwrap_or_else(|| panic!("no {name}"));
    assert!(found.next().is_none(), "{name} twice");
    effect
}

#[test]
fn a_car_that_stays_has_no_side_effect() {
    let study = study(&[]);
    let effects = side_effects_of_car(&study, &at(&study, &values(&study, &[]))).unwrap();
    assert!(effects.len() > 10);
    assert!(effects.iter().all(SideEffect::is_unchanged));
    assert!(effects.iter().all(|effect| !effect.flagged));
}

#[test]
fn largest_changes_are_those_of_the_cases_solved_before_and_after() {
    let before = study(&[]);
    let after = at(&before, &values(&before, &[(0, 2e5), (1, -1e5)]));
    let effects = side_effects_of_car(&before, &after).unwrap();
    let wanted = &before.optimise.as_ref().unwrap().targets;
    let mut compared = 0;
    for name in ["pitch", "camber_to_road", "ride_height_front"] {
        let of_cases = CarQuantity::named(name).into_iter().flat_map(|quantity| {
            assert!(wanted.iter().all(|target| target.quantity != quantity));
            let [from, to] = [&before, &after].map(|study| printed(study, quantity));
            let pairs = from.into_iter().zip(to).enumerate();
            pairs
                .map(|(case, (from, to))| (case, to.unwrap() - from.unwrap()))
                .collect::<Vec<_>>()
        });
        let (case, change) = of_cases
            .reduce(|one, other| {
                if other.1.abs() > one.1.abs() {
                    other
                } else {
                    one
                }
            })
            .unwrap();
        let effect = named(&effects, name);
        let found = effect.largest_change.unwrap();
        assert!(
            (found - change).abs() <= 1e-12 * change.abs(),
            "{name}: {found}, {change}"
        );
        assert_eq!(
            effect.case.as_deref(),
            Some(before.cases[case].name.as_str())
        );
        let is_beyond = change.abs() > effect.tolerance.unwrap();
        assert_eq!(effect.flagged, is_beyond, "{name}");
        compared += 1;
    }
    assert_eq!(compared, 3);
    // Rates change no kinematic result of an axle; they change only its roll stiffness.
    assert!(named(&effects, "camber, front axle").is_unchanged());
}

/// In `turn`, the load transfer of the front axle and the slope of the roll are targets. In other cases, only a change
/// beyond the change in `turn` counts as a side effect.
#[test]
fn a_target_takes_its_change_off_the_other_cases() {
    let before = study(&[]);
    let after = at(&before, &values(&before, &[(0, 2e5)]));
    let effects = side_effects_of_car(&before, &after).unwrap();
    let turn = before
        .cases
        .iter()
        .position(|case| case.name == "turn")
        .unwrap();
    for (name, least) in [("lateral_load_transfer_distribution", 1.0), ("roll", 0.02)] {
        let quantity = CarQuantity::named(name)[0];
        let [from, to] = [&before, &after].map(|study| printed(study, quantity));
        let change = |case: usize| Some(to[case]? - from[case]?);
        let asked = change(turn).unwrap();
        assert!(asked.abs() > least, "{name} in the turn: {asked}");
        let others = (0..before.cases.len()).filter(|case| *case != turn);
        let rest = others.filter_map(|case| {
            let plain = change(case)?;
            Some(plain - plain.clamp(asked.min(0.0), asked.max(0.0)))
        });
        let rest = rest.fold(
            0.0,
            |most: f64, rest| if rest.abs() > most.abs() { rest } else { most },
        );
        let found = named(&effects, name).largest_change;
        assert!(
            (found.unwrap_or(0.0) - rest).abs() <= 1e-12 * asked.abs(),
            "{name}: {found:?}, {rest}"
        );
    }
}

#[test]
fn roll_at_rest_does_not_count_as_changed() {
    // The roll in `turn` is a target. At rest a symmetric car does not roll, before or after.
    let target = "optimise.targets=[{ characteristic = \"roll\", case = \"turn\", value = 1.0, tolerance = 0.01 }]";
    let before = study(&[target, "car.sprung_cg=[-1290.0, 0.0, 560.0]"]);
    let after = at(&before, &values(&before, &[(0, 2e5)]));
    let quantity = CarQuantity::named("roll")[0];
    let [from, to] = [&before, &after].map(|study| printed(study, quantity));
    let roll = |found: &[Option<f64>], name: &str| {
        let case = before.cases.iter().position(|case| case.name == name);
        found[case.unwrap()].unwrap()
    };
    assert!(roll(&from, "braking").abs() < 1e-9 && roll(&to, "braking").abs() < 1e-9);
    let asked = roll(&to, "turn") - roll(&from, "turn");
    assert!(asked.abs() > 0.1, "{asked}");
    let effects = side_effects_of_car(&before, &after).unwrap();
    let effect = named(&effects, "roll");
    // In the other turns the car rolls less than before, as in `turn`. There the roll changes by no more than in
    // `turn`.
    assert!(effect.is_unchanged() && !effect.flagged, "{effect:?}");
    assert!(effect.asked_change * asked > 0.0, "{effect:?}");
    assert!(effect.asked_change.abs() <= asked.abs(), "{effect:?}");
}

#[test]
fn a_changed_axle_is_compared_as_in_its_own_tuning() {
    let before = study(&[]);
    // Raises the inner toe link point of the rear axle by 5 mm; the front axle does not change.
    let after = at(&before, &values(&before, &[(2, 5.0)]));
    let effects = side_effects_of_car(&before, &after).unwrap();
    assert!(
        effects
            .iter()
            .all(|effect| !effect.output.contains("front axle"))
    );
    let text = &before.axles[1].text;
    let tuning = "\n[optimise]\nvariables = [{ hardpoint = \"toe_link_inner\", axis = \"z\", range = [-15.0, 15.0] }]\n\
        targets = [{ characteristic = \"camber\", at = 0.0, value = -1.0, tolerance = 1.0 }]\n";
    let axle = Study::from_text("rear.toml", &(text.clone() + tuning), Path::new("studies"));
    let axle = axle.unwrap_or_else(|e| panic!("{e:?}"));
    let alone = side_effects(&axle, &axle.moved(&[5.0])).unwrap();
    let mut compared = 0;
    // The tuning of the axle alone has a target for camber, so the test omits the side effects on camber.
    for effect in alone
        .iter()
        .filter(|effect| !effect.output.starts_with("camber"))
    {
        let of_car = named(&effects, &format!("{}, rear axle", effect.output));
        let same = SideEffect {
            output: effect.output.clone(),
            ..of_car.clone()
        };
        assert_eq!(same, *effect);
        compared += 1;
    }
    assert!(compared >= 5, "{compared}");
    let toe = named(&effects, "toe, rear axle");
    assert!(toe.flagged, "5 mm of the toe link are bump steer: {toe:?}");
    assert_eq!(toe.column(), "toe_deg, rear axle");
}

#[test]
fn cases_without_equilibrium_are_lost() {
    let before = study(&["optimise.side_effects=true"]);
    let mut after = before.clone();
    // With this centre of gravity the car overturns, so its results are lost.
    after.car.cg.z *= 4.0;
    let effects = side_effects_of_car(&before, &after).unwrap();
    let roll = named(&effects, "roll");
    assert!(roll.lost > 0 && roll.flagged, "{roll:?}");
    assert_eq!(effects[0].lost.min(1), 1, "lost results come first");
    let off = study(&["optimise.side_effects=false"]);
    assert!(side_effects_of_car(&off, &after).unwrap().is_empty());
}
