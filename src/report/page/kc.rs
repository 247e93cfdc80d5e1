//! The page of `kc` tests: key results, a chart of each load with its tests, and the results of every station. It has no script.

use super::charts::Charts;
use super::escape::prose;
use super::sheet::{Section, sheet};
use crate::compliance::{KcLevel, KcOutcome, KcTest, KcWheelState, TestLoad, TestMode};
use crate::report::chart::{Chart, Line, Quantity, Source, hue};
use crate::report::curve_table::CurveTable;
use crate::report::{KcResults, with_minus_signs};

/// Results that the verdict states, in this order.
const FIRST: [&str; 5] = [
    "toe_by_lateral_force",
    "camber_by_lateral_force",
    "recession_by_braking",
    "toe_by_aligning_moment",
    "compliant_wheel_rate",
];

/// Columns of a table of load levels. `shift` is the inboard displacement, the recession or the rise of the wheel, according to the
/// load.
const COLUMNS: [&str; 4] = ["load", "toe", "camber", "shift"];

/// Note on the charts of one wheel.
const OF_WHEEL: &str = "Equilibria under increasing load. Positive toe is toe-in; positive camber leans the top of the wheel outboard.";
/// Note on the charts of an axle.
const OF_AXLE: &str = "Equilibria under increasing load, of the left wheel, or of the right wheel if only the right wheel is loaded. \
                       Toe-in and top outboard are positive.";

/// Page with the tests of a study.
pub fn kc_page(study: &str, results: &KcResults<'_>) -> String {
    let mut sections = Vec::new();
    let (place, charts) = charts(results);
    if !charts.is_empty() {
        sections.push(Section {
            title: format!("Toe, camber and displacement by load, at {place}"),
            note: if results.is_axle { OF_AXLE } else { OF_WHEEL }.to_owned(),
            table: format!("<div class=\"plots\">{charts}</div>"),
        });
    }
    for (place, table) in results.tables_for_readers() {
        sections.push(Section {
            title: format!("Results at {place}"),
            note: "Value: derivative at the station. Secant: over the whole window of the load."
                .to_owned(),
            table: table.html(),
        });
    }
    let lines = |class: &str, lines: Vec<String>| -> String {
        let line = |line: &String| format!("<p class=\"{class}\">{}</p>", prose(line));
        lines.iter().map(line).collect()
    };
    let remarks = lines("unmet", results.failures()) + &lines("note", results.warnings());
    if !remarks.is_empty() {
        sections.push(Section {
            title: "Remarks".to_owned(),
            note: String::new(),
            table: remarks,
        });
    }
    sheet(study, "kc", &verdict(results), &sections)
}

/// Sentences on the number of states without equilibrium, and on the main results. Each result comes from the station nearest to
/// the design position that has the result.
fn verdict(results: &KcResults<'_>) -> String {
    let failed = match results.failures().len() {
        0 => "Every state has an equilibrium.".to_owned(),
        1 => "1 state has no equilibrium.".to_owned(),
        count => format!("{count} states have no equilibrium."),
    };
    let shown: Vec<String> = FIRST
        .iter()
        .filter_map(|name| {
            let [value, unit] = results.first_figure(name)?;
            Some(format!("{} {value} {unit}", name.replace('_', " ")))
        })
        .collect();
    if shown.is_empty() {
        failed
    } else {
        let mut figures = with_minus_signs(&shown.join("; "));
        figures[..1].make_ascii_uppercase();
        format!("{failed} {figures}.")
    }
}

/// Name of one station, and HTML with the charts of its tests. It is the station nearest to the design position that has load
/// levels. Both texts are empty without such a station.
fn charts(results: &KcResults<'_>) -> (String, String) {
    let stations = results.nearest_stations();
    let found = stations
        .into_iter()
        .filter_map(|station| Some((station, station.outcomes.as_ref().ok()?)))
        .find(|(_, outcomes)| outcomes.iter().any(|outcome| !outcome.levels.is_empty()));
    let Some((station, outcomes)) = found else {
        return Default::default();
    };
    let mut charts = Charts::default();
    let mut figures = String::new();
    for (_, load) in TestLoad::ALL {
        let of_load =
            |outcome: &&KcOutcome| outcome.test.load == load && !outcome.levels.is_empty();
        let tests: Vec<&KcOutcome> = outcomes.iter().filter(of_load).collect();
        if !tests.is_empty() {
            figures += &charts_of_load(results, load, &tests, &mut charts);
        }
    }
    (results.station_name(station), figures)
}

/// Adds the load levels of a test to the columns of a table: load, toe and camber in degrees, and displacement in the study's
/// length unit. Loads are divided by `scale`.
fn add_levels(test: &KcOutcome, load: TestLoad, scale: f64, columns: &mut [Vec<Option<f64>>]) {
    let wheel = match test.test.mode {
        TestMode::Single(side) => side as usize,
        _ => 0,
    };
    let of_level = |level: &KcLevel| Some(level.state.as_ref().ok()?.wheels[wheel].clone());
    let unloaded = test.levels.iter().find(|level| level.level == 0);
    let unloaded = unloaded.and_then(of_level);
    for level in &test.levels {
        let state = of_level(level);
        let angle = |of: fn(&KcWheelState) -> f64| Some(of(state.as_ref()?).to_degrees());
        let cells = [
            Some(level.load / scale),
            angle(|state| state.figures.toe),
            angle(|state| state.figures.camber),
            state
                .as_ref()
                .zip(unloaded.as_ref())
                .map(|(state, from)| moved(load, state, from)),
        ];
        for (column, cell) in columns.iter_mut().zip(cells) {
            column.push(cell);
        }
    }
}

/// Charts of toe, camber and displacement over one load, with one line per test.
fn charts_of_load(
    results: &KcResults<'_>,
    load: TestLoad,
    tests: &[&KcOutcome],
    charts: &mut Charts,
) -> String {
    let length = results.suspension.length_unit;
    let is_moment = load == TestLoad::Aligning;
    let scale = if is_moment { length.per_metre() } else { 1.0 };
    let mut columns = vec![Vec::new(); COLUMNS.len()];
    let mut rows = Vec::new();
    for test in tests {
        let start = columns[0].len();
        add_levels(test, load, scale, &mut columns);
        rows.push((start..columns[0].len()).collect::<Vec<usize>>());
    }
    let table = charts.tables.len();
    charts.tables.push(CurveTable {
        header: COLUMNS.map(str::to_owned).to_vec(),
        columns,
        status: Vec::new(),
    });
    let unit = if is_moment { "N m" } else { "N" };
    let name = match load {
        TestLoad::Aligning => "aligning moment".to_owned(),
        load => format!("{} force", load.name()),
    };
    let shift = match load {
        TestLoad::Lateral => "inboard displacement",
        TestLoad::Braking | TestLoad::Traction => "recession",
        _ => "rise",
    };
    let quantities = [
        ("toe", "toe", "°"),
        ("camber", "camber", "°"),
        ("shift", shift, length.symbol()),
    ];
    // A moment turns the wheel, and the test keeps the height of the wheel constant. So there is no chart of displacement.
    let count = if is_moment { 2 } else { 3 };
    let mut figures = String::new();
    for (column, title, of) in quantities.into_iter().take(count) {
        let line = |(k, rows): (usize, &Vec<usize>)| Line {
            label: label(results, &tests[k].test, tests.len()),
            told: results.test_name(&tests[k].test),
            class: format!("main {} strong", hue(k)),
            is_main: k == 0,
            in_strip: k == 0,
            has_dots: false,
            source: Source {
                table,
                x: "load".to_owned(),
                y: column.to_owned(),
                rows: rows.clone(),
            },
        };
        let chart = Chart {
            key: format!("{}_{column}", load.name()),
            x: Quantity::new("load", &name, unit),
            y: Quantity::new(column, &format!("{title} by {name}"), of),
            lines: rows.iter().enumerate().map(line).collect(),
            ..Chart::default()
        };
        figures += &charts.figure(chart, "", "");
    }
    figures
}

/// Label of the line of a test among `count` tests of the same load. A single test without special properties needs no label.
fn label(results: &KcResults<'_>, test: &KcTest, count: usize) -> Option<String> {
    let apart = results.test_apart(test);
    match test.load {
        _ if !apart.is_empty() => Some(apart),
        _ if count < 2 => None,
        TestLoad::Lateral => {
            let unit = results.suspension.length_unit.symbol();
            Some(format!("trail 0 {unit}"))
        }
        load => Some(load.name().to_owned()),
    }
}

/// Displacement of the wheel centre from the unloaded state: inboard for a lateral force, rearward for braking and traction,
/// otherwise upward. Positions are in the kernel's frame of a left wheel.
fn moved(load: TestLoad, state: &KcWheelState, from: &KcWheelState) -> f64 {
    let by = state.figures.centre - from.figures.centre;
    match load {
        TestLoad::Lateral => -by.y,
        TestLoad::Braking | TestLoad::Traction => -by.x,
        _ => by.z,
    }
}
