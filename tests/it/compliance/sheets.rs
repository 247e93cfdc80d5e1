//! Tests of measured sheets.

use super::support::{elastic, sheet as noisy, with};
use hardpoint::optimise::{Control, Tuning, tune};
use hardpoint::rig::RigTests;
use hardpoint::study::Study;

const NAME: &str = "double_wishbone_compliance.toml";

fn variables(names: &[(&str, &str)]) -> String {
    let list = names.iter().map(|(bushing, axis)| {
        format!("{{ bushing = \"{bushing}\", stiffness = \"{axis}\", range = [0.3, 3.0], relative = true }}")
    });
    list.collect::<Vec<_>>().join(",\n")
}

/// Makes a measured sheet from test results of the study with random noise and a column of tolerances. `factors`
/// multiplies the rates of the study.
fn sheet(study: &Study, factors: &[f64], seed: u64) -> String {
    let variables = &study.optimise.as_ref().unwrap().variables;
    let mut planted = study.clone();
    let own = planted.one_wheel_mut().unwrap();
    let parts = &mut own.compliance.as_mut().unwrap().parts;
    for (variable, factor) in variables.iter().zip(factors) {
        let rate = variable.rate.as_ref().unwrap();
        parts.set_rate(rate.parameter, rate.design * factor);
    }
    let csv = RigTests::of(&planted, None).unwrap().results.kc_csv();
    noisy(&csv, 1.0, seed)
}

fn fitted(names: &[(&str, &str)], factors: &[f64], seed: u64) -> (Study, Tuning) {
    let asked = |targets: &str| {
        format!(
            "\n[optimise]\nfit = true\nvariables = [{}]\ntargets = [{targets}]\n",
            variables(names)
        )
    };
    let any = "{ figure = \"toe_by_lateral_force\", value = 0.0, tolerance = 1.0 }";
    let study = elastic(&with(NAME, &asked(any)));
    let directory = tempfile::tempdir().unwrap();
    std::fs::write(
        directory.path().join("sheet.csv"),
        sheet(&study, factors, seed),
    )
    .unwrap();
    let text = with(NAME, &asked("{ file = \"sheet.csv\", tolerance = 1.0 }"));
    let study = Study::elastic_from_text("case.toml", &text, directory.path())
        .unwrap_or_else(|e| panic!("{e}"));
    let optimise = study.optimise.as_ref().unwrap();
    let tuning = tune(&study.vehicle, optimise, Control::default()).unwrap();
    (study, tuning)
}

/// A fit finds the rates from which the sheet was computed, within their standard errors. It also estimates the standard
/// deviation of the noise.
#[test]
fn rates_are_identified_from_a_sheet_with_noise() {
    let names = [
        ("lower_arm_front", "x"),
        ("lower_arm_front", "y"),
        ("lower_arm_rear", "y"),
        ("upper_arm_front", "y"),
    ];
    let factors: [f64; 4] = [0.8, 1.3, 0.7, 1.2];
    let mut squares = 0.0;
    for seed in 1..=3 {
        let (study, tuning) = fitted(&names, &factors, seed);
        assert!(study.optimise.as_ref().unwrap().targets.len() > 25);
        let best = tuning.best.unwrap();
        let errors = best.errors.unwrap();
        assert!((0.6..1.5).contains(&errors.scatter), "{}", errors.scatter);
        for (k, factor) in factors.iter().enumerate() {
            let sigma = errors.sigmas[k].unwrap();
            let off = (best.offsets[k] - factor.ln()) / sigma;
            assert!(
                off.abs() < 4.5,
                "{seed} {:?}: {off} standard errors",
                names[k]
            );
            // The sheet determines every rate.
            assert!(sigma < 0.3, "{:?}: {sigma}", names[k]);
            squares += off * off;
        }
    }
    // `squares` is the sum of twelve squared errors, each divided by its standard error. The mean of the twelve is about
    // 1.
    let mean = squares / 12.0;
    assert!((0.15..3.0).contains(&mean), "{mean}");
}

/// The stiffness of an arm along its axis is the sum of the stiffnesses of its two bushings. A sheet cannot separate
/// these two stiffnesses, and the program reports this.
#[test]
fn rates_that_a_sheet_cannot_separate_are_named() {
    let names = [
        ("lower_arm_front", "x"),
        ("lower_arm_rear", "x"),
        ("lower_arm_rear", "y"),
    ];
    let (_, tuning) = fitted(&names, &[1.1, 0.9, 1.2], 5);
    let best = tuning.best.unwrap();
    let unseen = &best.identifiability.unseen;
    let correlated = best
        .errors
        .as_ref()
        .map(|errors| errors.correlations.clone());
    let pair = correlated
        .into_iter()
        .flatten()
        .find(|(a, b, _)| (*a, *b) == (0, 1));
    let is_unseen = unseen.iter().any(|direction| {
        let moves = &direction.change;
        moves[0] * moves[1] < 0.0 && moves[2].abs() < 0.2 * moves[0].abs()
    });
    assert!(
        is_unseen || pair.is_some_and(|(.., r)| r < -0.99),
        "{unseen:?} {pair:?}"
    );
}

/// A fit of a sheet without noise ends at zero misfit from every start. At this solution, residuals and slopes contain
/// only rounding errors.
#[test]
fn a_fit_of_an_exact_sheet_converges() {
    let names = [("lower_arm_rear", "y"), ("lower_arm_front", "x")];
    let asked = |targets: &str| {
        format!(
            "\n[optimise]\nfit = true\nstarts = 8\nvariables = [{}]\ntargets = [{targets}]\n",
            variables(&names)
        )
    };
    let own = elastic(&with(NAME, ""));
    let csv = RigTests::of(&own, None).unwrap();
    let csv = csv.results.kc_csv();
    let directory = tempfile::tempdir().unwrap();
    let exact = noisy(&csv, 0.0, 1);
    std::fs::write(directory.path().join("sheet.csv"), exact).unwrap();
    let text = with(NAME, &asked("{ file = \"sheet.csv\", tolerance = 1.0 }"));
    let study = Study::elastic_from_text("case.toml", &text, directory.path());
    let study = study.unwrap_or_else(|errors| panic!("{errors}"));
    let optimise = study.optimise.as_ref().unwrap();
    let tuning = tune(&study.vehicle, optimise, Control::default()).unwrap();
    assert_eq!(tuning.starts.starts.len(), 8);
    for start in &tuning.starts.starts {
        let fit = start.outcome.as_ref().unwrap();
        assert!(fit.misfit() < 1e-9, "{}", fit.misfit());
        assert!(fit.termination.at_minimum(), "{}", fit.ended());
    }
}

/// The written study contains the targets of its sheet. Read again, it has the same targets.
#[test]
fn a_sheet_is_written_out_in_the_study() {
    let (study, _) = fitted(&[("lower_arm_rear", "y")], &[1.1], 2);
    assert!(!study.text.contains("sheet.csv"));
    let again = elastic(&study.text);
    let (a, b) = (study.optimise.unwrap(), again.optimise.unwrap());
    assert_eq!(a.targets.len(), b.targets.len());
    assert!(a.targets.len() > 25, "{}", a.targets.len());
    for (a, b) in a.targets.iter().zip(&b.targets) {
        assert_eq!((&a.of, &a.wanted, &a.site), (&b.of, &b.wanted, &b.site));
        assert!((a.tolerance - b.tolerance).abs() <= 1e-15 * a.tolerance);
    }
}

#[test]
fn mistakes_in_a_sheet_are_named_with_their_line() {
    let good = "load,trail_mm,quantity,value,unit,tolerance\nlateral,0.0,camber_by_lateral_force,0.02,deg_per_kN,0.001\n";
    let asked = "\n[optimise]\nfit = true\nvariables = [{ bushing = \"lower_arm_rear\", stiffness = \"y\", range = [0.3, 3.0], relative = true }]\ntargets = [{ file = \"sheet.csv\", tolerance = 1.0 }]\n";
    for (from, to, line, phrase) in [
        ("lateral,", "sideways,", 2, "not a load of a test"),
        (
            "camber_by_lateral_force",
            "camber_by_sideforce",
            2,
            "unknown quantity \"camber_by_sideforce\"; did you mean \"camber_by_lateral_force\"?",
        ),
        ("0.02", "two", 2, "as value"),
        ("deg_per_kN", "deg_per_N", 2, "\"deg_per_kN\" as the unit"),
        (
            ",tolerance\n",
            ",tol\n",
            1,
            "unknown column \"tol\"; did you mean \"tolerance\"?",
        ),
        (
            ",tolerance\n",
            ",reason\n",
            2,
            "a number in the column tolerance",
        ),
        // The sheet contains this result twice: with trail 0 and with trail 30 mm.
        ("trail_mm", "reason", 2, "several tests"),
        (
            "lateral,0.0",
            "lateral,15.0",
            2,
            "no test of the study gives",
        ),
        (
            "trail_mm",
            "trail_in",
            1,
            "expected the column trail_mm, found trail_in",
        ),
        (
            ",tolerance\n",
            ",tolerance,value\n",
            1,
            "several columns have the name value",
        ),
        // An empty cell for the travel does not mean travel 0.
        (
            "tolerance\nlateral,0.0,camber_by_lateral_force,0.02,deg_per_kN,0.001\n",
            "tolerance,travel_mm\nlateral,0.0,camber_by_lateral_force,0.02,deg_per_kN,0.001,\n",
            2,
            "travel_mm is empty, but the row has a value",
        ),
        (
            "tolerance\nlateral,0.0,camber_by_lateral_force,0.02,deg_per_kN,0.001\n",
            "tolerance,travel_mm\nlateral,0.0,camber_by_lateral_force,0.02,deg_per_kN,0.001,40.0\n\
             lateral,0.0,camber_by_lateral_force,0.02,deg_per_kN,0.001,80.0\n",
            3,
            "80 is outside of the motion, which runs from -40 to 40",
        ),
        ("0.001", "1e-13", 2, "at least 1e-12, found 1e-13"),
    ] {
        let directory = tempfile::tempdir().unwrap();
        std::fs::write(directory.path().join("sheet.csv"), good.replace(from, to)).unwrap();
        let errors = Study::elastic_from_text("case.toml", &with(NAME, asked), directory.path())
            .unwrap_err();
        let said = errors.render(false);
        assert!(said.contains(phrase), "{phrase}: {said}");
        assert_eq!(errors.all()[0].position().unwrap().0, line, "{said}");
    }
}

/// A sheet replaces most keys of its target. The program refuses these keys, and numbers whose square would overflow.
#[test]
fn keys_that_a_sheet_replaces_are_refused() {
    let sheet = "load,trail_mm,quantity,value,unit,tolerance\nlateral,0.0,camber_by_lateral_force,0.02,deg_per_kN,0.001\n";
    let key = |key: &str| format!("remove the key {key}");
    let least = || "expected a number of at least 1e-12".to_owned();
    for (target, column, phrase) in [
        ("tolerance = 1.0, axis = \"z\"", "0.001", key("axis")),
        (
            "tolerance = 1.0, between = [0.0, 1.0]",
            "0.001",
            key("between"),
        ),
        ("tolerance = 1.0, at_least = 0.0", "0.001", key("at_least")),
        ("tolerance = 1.0, at_most = 1.0", "0.001", key("at_most")),
        ("tolerance = 1.0, roll = 1.0", "0.001", key("roll")),
        (
            "tolerance = 1.0, steering_wheel_angle = 1.0",
            "0.001",
            key("steering_wheel_angle"),
        ),
        (
            "tolerance = 1.0, interpolation = \"linear\"",
            "0.001",
            key("interpolation"),
        ),
        (
            "tolerance = 1.0, figure = \"camber_by_lateral_force\", characteristic = \"camber\"",
            "0.001",
            "found both".to_owned(),
        ),
        ("tolerance = 1e-300", "0.001", least()),
        ("tolerance = 1.0, weight = 1e-300", "0.001", least()),
        (
            "tolerance = 1.0",
            "1e-300",
            format!("tolerance: {}", least()),
        ),
    ] {
        let directory = tempfile::tempdir().unwrap();
        let text = sheet.replace("0.001", column);
        std::fs::write(directory.path().join("sheet.csv"), text).unwrap();
        let asked = format!(
            "\n[optimise]\nvariables = [{}]\ntargets = [{{ file = \"sheet.csv\", {target} }}]\n",
            variables(&[("lower_arm_rear", "y")])
        );
        let read = Study::elastic_from_text("case.toml", &with(NAME, &asked), directory.path());
        let said = read.map(|_| ()).unwrap_err().render(false);
        assert!(said.contains(&phrase), "{target}: {said}");
    }
}

/// If a sheet lacks required columns, the program names the sheet and the missing columns.
#[test]
fn a_sheet_without_its_columns_is_named() {
    let directory = tempfile::tempdir().unwrap();
    let targets = "\n[optimise]\nvariables = [{ bushing = \"lower_arm_rear\", stiffness = \"y\", range = [0.5, 2.0], \
         relative = true }]\ntargets = [{ file = \"sheet.csv\", tolerance = 1.0 }]\n";
    let text = with(NAME, targets);
    for (header, missing) in [
        ("parameter;measured;tol", "no column load, quantity, value."),
        ("load,quantity,unit", "no column value."),
    ] {
        std::fs::write(
            directory.path().join("sheet.csv"),
            format!("{header}\nlateral,1,2\n"),
        )
        .unwrap();
        let refused = Study::elastic_from_text("case.toml", &text, directory.path());
        let said = refused.unwrap_err().to_string();
        assert!(
            said.contains("sheet.csv has") && said.contains(missing),
            "{said}"
        );
    }
}

/// A spreadsheet writes a byte-order mark at the beginning of a file. It changes no sheet.
#[test]
fn a_byte_order_mark_changes_no_sheet() {
    let directory = tempfile::tempdir().unwrap();
    let targets = "\n[optimise]\nvariables = [{ bushing = \"lower_arm_rear\", stiffness = \"y\", range = [0.5, 2.0], \
         relative = true }]\ntargets = [{ file = \"sheet.csv\", tolerance = 1.0 }]\n";
    let sheet = "load,trail_mm,quantity,value,unit,tolerance\nlateral,0.0,camber_by_lateral_force,0.02,deg_per_kN,0.001\n";
    let read = |sheet: &str| {
        std::fs::write(directory.path().join("sheet.csv"), sheet).unwrap();
        Study::elastic_from_text("case.toml", &with(NAME, targets), directory.path())
    };
    let of = |study: Study| study.optimise.unwrap().targets;
    let plain = of(read(sheet).unwrap());
    let marked = of(read(&format!("\u{feff}{sheet}")).unwrap_or_else(|e| panic!("{e}")));
    assert_eq!(plain, marked);
    // Messages count the same lines.
    let wrong = format!("\u{feff}{}", sheet.replace("0.02", "two"));
    let errors = read(&wrong).unwrap_err();
    assert_eq!(errors.all()[0].position(), Some((2, 1)), "{errors}");
}
