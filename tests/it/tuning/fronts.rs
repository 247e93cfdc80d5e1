//! Tests of Pareto fronts, and of the misfit against the size of the change.

use super::*;

/// The Pareto front of two targets of a strut has at least forty points. No point dominates another. Each point is within its
/// ranges. The amounts of the middle point equal the amounts of its design. For four of five points, the ratio of the weights
/// is the slope of the front.
#[test]
fn a_front_of_two_targets_is_traced() {
    let goals = "optimise.front=[\"camber\", \"kingpin_inclination\"]";
    let study = two_curves(edited("macpherson_front.toml", &[SIX, goals]));
    // The test changes the target curves so that both targets cannot be met.
    let optimise = study.optimise.as_ref().unwrap();
    let (suspension, vehicle) = (study.wheel(), &study.vehicle);
    let wanted = |target: &Target| match &target.wanted {
        Wanted::Curve {
            points,
            interpolation,
        } => Wanted::Curve {
            points: points
                .iter()
                .map(|[x, y]| [*x, 1.05 * y + 2e-4 * x])
                .collect(),
            interpolation: *interpolation,
        },
        other => other.clone(),
    };
    let targets = optimise.targets.iter().map(|t| Target {
        wanted: wanted(t),
        ..t.clone()
    });
    let optimise = Optimise {
        targets: targets.collect(),
        variables: optimise.variables[..3].to_vec(),
        ..optimise.clone()
    };
    let control = Control::default();
    let tuning = tune(vehicle, &optimise, control).unwrap();
    let found = front(vehicle, &optimise, &tuning, control).unwrap();
    assert!(found.choices.len() >= 40, "{}", found.choices.len());
    for pair in found.choices.windows(2) {
        let ([a, b], [c, d]) = (&pair[0].amounts[..], &pair[1].amounts[..]) else {
            panic!()
        };
        assert!(a < c && b > d, "{pair:?}");
    }
    for choice in &found.choices {
        for (offset, variable) in choice.offsets.iter().zip(&optimise.variables) {
            assert!((variable.range[0]..=variable.range[1]).contains(offset));
        }
    }
    // The amounts of a point equal the evaluation of the point's design.
    let middle = &found.choices[found.choices.len() / 2];
    let layout = TargetLayout::of(&optimise, vehicle);
    let mut problem = Objective::new(suspension, &optimise.variables, &layout).unwrap();
    let x = nalgebra::DVector::from_column_slice(&middle.offsets);
    let mut at = Assessment::new(&Constrained::shape(&problem));
    problem.assess(&x, &mut at).unwrap();
    for (deviation, amount) in layout
        .deviations(&at.goal.residuals)
        .iter()
        .zip(&middle.amounts)
    {
        assert!((deviation.rms - amount).abs() < 1e-9 * amount.max(1.0));
    }
    // The ratio of the weights equals the slope between neighbouring points of the Pareto front.
    let near = found.choices.windows(3).map(|three| {
        let [a, b, c] = three else { panic!() };
        let rise = (c.amounts[1] - a.amounts[1]) / (c.amounts[0] - a.amounts[0]);
        (rise, -b.weights[0] / b.weights[1])
    });
    let off = near.filter(|(rise, slope)| (rise - slope).abs() > 0.25 * rise.abs());
    assert!(off.count() <= found.choices.len() / 5);

    // Misfit against the size of the design change: the misfit falls as the change grows. The first design is the nominal
    // one.
    let list = price_list(vehicle, &optimise, &tuning, control).unwrap();
    assert!(list.len() >= 10, "{}", list.len());
    assert_eq!(list[0].amounts[1], 0.0);
    for pair in list.windows(2) {
        assert!(pair[1].amounts[1] > pair[0].amounts[1]);
        assert!(pair[1].amounts[0] <= pair[0].amounts[0] * (1.0 + 1e-9));
    }
    // The misfit of each entry is the misfit of its own design.
    for choice in &list {
        let x = nalgebra::DVector::from_column_slice(&choice.offsets);
        problem.assess(&x, &mut at).unwrap();
        let misfit = at.goal.misfit();
        assert!((choice.amounts[0] - misfit).abs() < 1e-9 * misfit.max(1.0));
    }
}

/// The program writes a Pareto front as a file, a table and a part of the page. It also prints the misfit against the size
/// of the design change, and writes this list into the summary.
#[test]
fn fronts_and_price_lists_are_written_and_shown() {
    let directory = tempfile::tempdir().unwrap();
    let out = directory.path().join("run");
    let variables = "optimise.variables=[\
        { hardpoint = \"strut_top\", axis = \"y\", range = [-20.0, 20.0] }, \
        { hardpoint = \"lower_arm_front\", axis = \"z\", range = [-20.0, 20.0] }]";
    let front = "optimise.front=[\"camber\", \"kingpin_inclination\"]";
    let travel = "motion.travel={ from = -80.0, to = 80.0, steps = 5 }";
    let study = "studies/macpherson_front.toml";
    let said = hardpoint(&[
        "optimise",
        study,
        "--set",
        variables,
        "--set",
        front,
        "--set",
        travel,
        "--prices",
        "--report",
        "--out",
        out.to_str().unwrap(),
    ])
    .success();
    let said = String::from_utf8(said.get_output().stdout.clone()).unwrap();
    assert!(
        said.contains("Trade-off between camber and kingpin_inclination"),
        "{said}"
    );
    assert!(
        said.contains("Smallest misfit by the size of the change"),
        "{said}"
    );
    let text = std::fs::read_to_string(out.join("front.csv")).unwrap();
    let mut lines = text.lines();
    assert_eq!(
        lines.next().unwrap(),
        "point,misfit_camber,misfit_kingpin_inclination,weight_camber,weight_kingpin_inclination,\
         strut_top_dy_mm,lower_arm_front_dz_mm,broken_behind"
    );
    let rows: Vec<Vec<f64>> = lines
        .map(|line| {
            line.split(',')
                .take(3)
                .map(|cell| cell.parse().unwrap())
                .collect()
        })
        .collect();
    assert!(rows.len() > 20, "{}", rows.len());
    assert!(
        rows.windows(2)
            .all(|w| w[0][1] < w[1][1] && w[0][2] > w[1][2])
    );
    let page = std::fs::read_to_string(out.join("report.html")).unwrap();
    assert!(page.contains("\"key\":\"front01\"") && page.contains("\"key\":\"prices\""));
    let summary: serde_json::Value =
        serde_json::from_slice(&std::fs::read(out.join("summary.json")).unwrap()).unwrap();
    assert!(summary["prices"].as_array().unwrap().len() >= 10);
    curves_of_a_point_are_those_of_its_study(&out);
}

/// A fit has no list of misfit against size of change, so it refuses `--prices` instead of ignoring it.
#[test]
fn a_fit_refuses_prices() {
    let directory = tempfile::tempdir().unwrap();
    let out = directory.path().join("run");
    let refused = hardpoint(&[
        "optimise",
        "studies/macpherson_front.toml",
        "--set",
        "optimise.fit=true",
        "--prices",
        "--out",
        out.to_str().unwrap(),
    ])
    .code(2);
    let said = String::from_utf8(refused.get_output().stderr.clone()).unwrap();
    assert!(
        said.contains("--prices is not available with fit = true"),
        "{said}"
    );
    assert!(!out.exists());
}

/// A point of the Pareto front has the same curves as its study, to six digits.
fn curves_of_a_point_are_those_of_its_study(run: &std::path::Path) {
    let record = std::fs::read(run.join("report.json")).unwrap();
    let record: serde_json::Value = serde_json::from_slice(&record).unwrap();
    let front = &record["front"];
    let points = front["points"].as_array().unwrap();
    let point = &points[points.len() / 2];
    let text = |value: &serde_json::Value| value.as_str().unwrap().to_owned();
    let mut lines: Vec<String> = front["study"]
        .as_array()
        .unwrap()
        .iter()
        .map(text)
        .collect();
    for changed in point["lines"].as_array().unwrap() {
        lines[changed[0].as_u64().unwrap() as usize] = text(&changed[1]);
    }
    let study = run.with_file_name("point.toml");
    std::fs::write(&study, lines.join("\n")).unwrap();
    let solved = run.with_file_name("solved");
    let [study, out] = [&study, &solved].map(|path| path.to_str().unwrap());
    hardpoint(&["solve", study, "--out", out]).success();
    let table = std::fs::read(solved.join("curves.csv")).unwrap();
    let table = hardpoint::report::CurveTable::read(&table).unwrap();
    let curves = &point["curves"];
    let names: Vec<String> = curves["header"]
        .as_array()
        .unwrap()
        .iter()
        .map(text)
        .collect();
    let mut compared = 0;
    for (name, column) in table.header.iter().zip(&table.columns) {
        let Some(place) = names.iter().position(|known| known == name) else {
            continue;
        };
        let drawn = curves["columns"][place].as_array().unwrap();
        assert_eq!(drawn.len(), column.len());
        for (drawn, wanted) in drawn.iter().zip(column) {
            let (drawn, wanted) = (drawn.as_f64().unwrap(), wanted.unwrap());
            assert!(
                (drawn - wanted).abs() <= 1e-5 * wanted.abs(),
                "{name}: {drawn} {wanted}"
            );
        }
        compared += 1;
    }
    assert!(compared > 4, "{names:?}");
}
