//! The page of a car. It has no script, because this module draws every picture.

mod charts;
mod views;

use super::STYLE;
use super::escape::{html, prose};
use super::policy::policy;
use super::run::PageDesign;
use crate::report::car::{CarCase, CarRecord, CarStateRecord};
use crate::report::table::{Cell, Column, Table};
use crate::report::{
    ConstraintStatus, car_constraints_table, car_variables_table, counted, figure,
    shown_side_effects, side_effects_in_words, side_effects_table, starts_table, unit_in_words,
    visible_side_effects, with_decimals, with_minus_signs,
};
use crate::side_effects::SideEffect;

/// Styles of the pictures.
const CAR_STYLE: &str = include_str!("car.css");

/// Names of the wheels, front left first.
const WHEELS: [&str; 4] = ["front left", "front right", "rear left", "rear right"];

/// Formats a number for people: the number of decimals depends on the unit.
fn shown(value: f64, unit: &str) -> String {
    let text = match unit {
        "N" | "lbf" => with_decimals(value, 0),
        "percent" | "mm" => with_decimals(value, 1),
        "deg" | "deg_per_g" | "in" | "tolerances" => with_decimals(value, 2),
        "m" => with_decimals(value, 4),
        _ => figure(value, unit),
    };
    with_minus_signs(&text)
}

/// Displayed name of a load case, as HTML.
fn titled(case: &CarCase) -> String {
    html(&case.name.replace('_', " "))
}

/// HTML of the page of a car.
pub fn car_page(record: &CarRecord) -> String {
    with_design(record, None)
}

/// Report page of a car's design from the live page. The page begins with the misfit and the hardpoints of the design.
pub fn car_page_of_design(record: &CarRecord, design: &PageDesign) -> String {
    with_design(record, Some(design))
}

fn with_design(record: &CarRecord, design: Option<&PageDesign>) -> String {
    let misfit = record.tuning.iter().map(|tuning| {
        let misfits = html(&tuning.misfits_in_words().replace("->", "→"));
        format!("<div><dt>Misfit</dt><dd>{misfits} <small>tolerances</small></dd></div>")
    });
    let of_design = design.and_then(PageDesign::fact);
    let of_design =
        of_design.map(|(name, value)| format!("<div><dt>{name}</dt><dd>{value}</dd></div>"));
    let facts = record.facts.iter().map(|fact| {
        let name = fact.name.replace('_', " ");
        let value = shown(fact.value, &fact.unit);
        let unit = fact.unit.replace("_per_", "/").replace("percent", "%");
        let unit = html(&unit);
        format!(
            "<div><dt>{}</dt><dd>{value} <small>{unit}</small></dd></div>",
            html(&name)
        )
    });
    let failures = record.cases.iter().filter_map(|case| {
        let reason = case.reason.as_ref()?;
        Some(format!("<li>{}: {}</li>", titled(case), prose(reason)))
    });
    let failures: String = failures.collect();
    let failures = if failures.is_empty() {
        String::new()
    } else {
        format!(
            "<div class=\"failures\"><h2>Cases without equilibrium</h2><ul>{failures}</ul></div>"
        )
    };
    let remarks: String = record
        .remarks
        .iter()
        .map(|remark| format!("<p class=\"note\">{}</p>", prose(remark)))
        .collect();
    let sections = [
        design.map_or_else(String::new, PageDesign::section),
        targets(record),
        constraints(record),
        variables(record),
        starts(record),
        side_effects(record),
        corner_weights(record),
        transfer(record),
        map(record),
        roll_axis(record),
        attitude(record),
        cases(record),
    ];
    let style = [STYLE, CAR_STYLE].concat();
    format!(
        include_str!("car.html"),
        policy = html(&policy(&[], &style)),
        study = html(&record.study),
        heading = super::table::breakable(&record.study),
        style = style,
        about = html(&about(record)),
        verdict = prose(&verdict(record)),
        facts = of_design
            .into_iter()
            .chain(misfit)
            .chain(facts)
            .collect::<String>(),
        failures = failures,
        remarks = remarks,
        main = sections.concat(),
        files = html(&record.files.join(", ")),
    )
}

fn about(record: &CarRecord) -> String {
    let tyres = if record.elastic_tyres {
        "tyre springs"
    } else {
        "rigid tyres"
    };
    let cases = counted(record.cases.len(), "case");
    format!(
        "hardpoint {} {}: {cases}, {tyres}, lengths in {}",
        record.version,
        record.command,
        unit_in_words(&record.length_unit)
    )
}

/// Main result in one or two sentences.
fn verdict(record: &CarRecord) -> String {
    let mut sentences = Vec::new();
    let met = record.targets.iter().filter(|target| target.is_met());
    match (met.count(), record.targets.len()) {
        (_, 0) => {}
        (met, all) if met == all => {
            sentences.push("All targets are met within their tolerances.".to_owned());
        }
        (met, all) => sentences.push(format!(
            "{met} of {all} targets are met within their tolerances."
        )),
    }
    if let Some(words) = side_effects_in_words(&record.side_effects) {
        sentences.push(format!("{}{}.", words[..1].to_uppercase(), &words[1..]));
    }
    let fact = |name: &str| record.facts.iter().find(|fact| fact.name == name);
    if let Some(roll) = fact("roll_gradient") {
        let mut text = format!("The car rolls {} deg/g", shown(roll.value, &roll.unit));
        if let Some(share) = fact("lateral_load_transfer_distribution_local") {
            text += &format!(
                ", and the front axle takes {} % of the lateral load transfer",
                shown(share.value, &share.unit)
            );
        }
        sentences.push(text + " (at the static state).");
    }
    let lifts = solved(record).filter_map(|(case, state)| {
        let wheels = WHEELS.iter().zip(state.lifted);
        let wheels: Vec<&str> = wheels.filter(|(_, lifted)| *lifted).map(|w| *w.0).collect();
        let lift = match wheels.len() {
            0 => return None,
            1 => "lifts",
            _ => "lift",
        };
        let case = case.name.replace('_', " ");
        Some(format!("{} {lift} in {case}", wheels.join(" and ")))
    });
    let lifts: Vec<String> = lifts.collect();
    if !lifts.is_empty() {
        sentences.push(format!("Lifted wheels: {}.", lifts.join("; ")));
    }
    let failed = record.cases.iter().filter(|case| case.reason.is_some());
    match failed.count() {
        0 => sentences.push("Every case is in equilibrium.".to_owned()),
        count => sentences.push(format!(
            "{} of {} cases have no equilibrium.",
            count,
            record.cases.len()
        )),
    }
    sentences.join(" ")
}

fn section(id: &str, title: &str, note: &str, content: &str) -> String {
    format!(
        "<section id=\"{id}\"><h2>{title}</h2><p class=\"note\">{note}</p>{content}</section>\n"
    )
}

/// Load cases that have a state.
fn solved(record: &CarRecord) -> impl Iterator<Item = (&CarCase, &CarStateRecord)> {
    let cases = record.cases.iter();
    cases.filter_map(|case| Some((case, case.state.as_ref()?)))
}

fn targets(record: &CarRecord) -> String {
    if record.targets.is_empty() {
        return String::new();
    }
    let names = ["target", "case", "wanted", "before", "after", "deviation"];
    let mut table = Table::with_columns(names.map(Column::from));
    for target in &record.targets {
        let unit = target.unit();
        let cell = |value: Option<f64>| Cell::by(value, |value| shown(value, unit));
        table.push_row([
            Cell::from(target.output.as_str()),
            target.case.as_str().into(),
            target.wanted_cell(),
            cell(target.values[0]),
            cell(target.values[1]),
            Cell::by(target.deviation, |value| shown(value, "tolerances")),
        ]);
    }
    let missed = |row: usize| (!record.targets[row].is_met()).then_some("unmet");
    let note =
        "Deviations are multiples of the tolerance. A target is met if its deviation is at most 1.";
    section(
        "targets",
        "Targets",
        note,
        &super::table::table(&table, missed),
    )
}

/// Section with the tuned variables, the misfit, and the reason why the search ended.
fn variables(record: &CarRecord) -> String {
    let Some(tuning) = &record.tuning else {
        return String::new();
    };
    let note = format!(
        "Misfit {} (root mean square of the targets, in multiples of the tolerance); {}. Values of hardpoints are offsets from the design in the files.",
        tuning.misfits_in_words(),
        tuning.ended
    );
    section(
        "variables",
        "Variables",
        &prose(&note.replace("->", "→")),
        &car_variables_table(&tuning.variables).html(),
    )
}

/// Section with the constraints of a tuning and their margins.
fn constraints(record: &CarRecord) -> String {
    let tuning = record.tuning.as_ref();
    let constraints = tuning.map_or(&[][..], |tuning| &tuning.constraints);
    let Some(table) = car_constraints_table(constraints) else {
        return String::new();
    };
    let violated = |row: usize| {
        let status = constraints[row].status;
        let is_violated = status.is_some_and(ConstraintStatus::is_violated);
        is_violated.then_some("unmet")
    };
    let note = "Margin: distance to the nearer limit, negative if it is violated. Price: decrease of the misfit if the \
                limit moves outward by one unit.";
    let content = super::table::table(&table, violated);
    section("constraints", "Constraints", note, &content)
}

/// Section about the starts of a tuning (points at which the search begins). Empty if there is only one start.
fn starts(record: &CarRecord) -> String {
    match &record.tuning {
        Some(tuning) if tuning.starts.len() > 1 => section(
            "starts",
            "Starts",
            "The tuning keeps the start with the smallest misfit that satisfies the constraints.",
            &starts_table(&tuning.starts, tuning.best_start).html(),
        ),
        _ => String::new(),
    }
}

/// Section with the changes by a tuning that no target requests. Important changes come first. Other visible changes are in a part
/// that can be opened.
fn side_effects(record: &CarRecord) -> String {
    let effects = &record.side_effects;
    if effects.is_empty() {
        return String::new();
    }
    let table = |effects: &[SideEffect]| {
        let flagged = |row: usize| effects[row].flagged.then_some("unmet");
        super::table::table(&side_effects_table(effects), flagged)
    };
    let seen = visible_side_effects(effects);
    let (shown, more) = shown_side_effects(effects);
    let mut content = table(&shown);
    if more > 0 {
        let words = counted(more, "further change");
        let rest = table(&seen[shown.len()..]);
        content += &format!("<details><summary>{words}</summary>{rest}</details>");
    }
    let note = "Changes that no target asks for: in the load cases, and for each changed axle over \
                the motion of its study. Changes beyond a customary tolerance come first.";
    section("side_effects", "Side effects", note, &content)
}

fn corner_weights(record: &CarRecord) -> String {
    let Some((_, state)) = solved(record).next() else {
        return String::new();
    };
    let unit = record.force_unit.as_str();
    let total: f64 = state.loads.iter().sum();
    let cells = state.loads.iter().zip(WHEELS).map(|(load, name)| {
        format!(
            "<div><dt>{name}</dt><dd>{} <small>{unit}</small></dd><dd class=\"share\">{} %</dd></div>",
            shown(*load, unit),
            shown(100.0 * load / total, "percent")
        )
    });
    let cells: String = cells.collect();
    let note = "Static wheel loads of the car, seen from above with the front at the top.";
    let total = format!("<p>Sum {} {unit}.</p>", shown(total, unit));
    let content = format!("<dl class=\"corners\">{cells}</dl>{total}");
    section("weights", "Corner weights", note, &content)
}

fn transfer(record: &CarRecord) -> String {
    let turning: Vec<_> = solved(record).filter(|(case, _)| case.ay != 0.0).collect();
    if turning.is_empty() {
        return String::new();
    }
    let scale = charts::transfer_scale(turning.iter().map(|(_, state)| *state));
    let figures = turning.iter().map(|(case, state)| {
        let share = state.front_share.map_or_else(String::new, |share| {
            format!("{} % of the load transfer at the front", shown(share, "percent"))
        });
        format!(
            "<figure><figcaption>{} <small>ax {} g, ay {} g; {share}</small></figcaption>{}</figure>",
            titled(case),
            shown(case.ax, "g"),
            shown(case.ay, "g"),
            charts::transfer(state, &scale, &record.force_unit)
        )
    });
    let figures: String = figures.collect();
    let note = format!(
        "Half the difference between the wheel loads, right minus left, in {}. The parts add up to the total: springs, \
         stops and bars (elastic), side forces through the links (geometric), brake and drive forces through the links \
         (longitudinal), weight and inertia of the wheels (unsprung).",
        record.force_unit
    );
    let content = format!("{}<div class=\"plots\">{figures}</div>", charts::key());
    section("transfer", "Load transfer by part", &note, &content)
}

fn map(record: &CarRecord) -> String {
    let Some(map) = &record.map else {
        return String::new();
    };
    let note = "Largest friction coefficient that a wheel needs in each state. The map has no \
                grip limit, because the study has no tyre characteristics. A dot marks states with a \
                lifted wheel, a cross states without equilibrium.";
    section(
        "map",
        "g-g map",
        note,
        &format!("<figure class=\"map\">{}</figure>", charts::map(map)),
    )
}

fn roll_axis(record: &CarRecord) -> String {
    let mut shown: Vec<_> = solved(record).take(1).collect();
    let turning = solved(record).filter(|(case, _)| case.ay != 0.0);
    let hardest = turning.max_by(|a, b| a.0.ay.abs().total_cmp(&b.0.ay.abs()));
    shown.extend(hardest);
    let figures = shown.iter().map(|(case, state)| {
        format!(
            "<figure><figcaption>{} <small>forward is to the left</small></figcaption>{}</figure>",
            titled(case),
            views::side(record, state)
        )
    });
    let figures: String = figures.collect();
    let note = "The roll axis joins the heights at which the side forces of each axle act on the body, with the left and right shares of these forces in the load case. \
                The dashed line joins the kinematic roll centres. The dot is the centre of gravity of the sprung mass.";
    section(
        "roll-axis",
        "Roll axis",
        note,
        &format!("<div class=\"plots\">{figures}</div>"),
    )
}

fn attitude(record: &CarRecord) -> String {
    let figures = solved(record).flat_map(|(case, state)| {
        [0, 1].map(|axle| {
            let attitude = format!(
                "roll {} deg, pitch {} deg",
                shown(state.attitude[0], "deg"),
                shown(state.attitude[1], "deg")
            );
            format!(
                "<figure><figcaption>{}, {} axle <small>{attitude}</small></figcaption>{}</figure>",
                titled(case),
                crate::car::AXLE_NAMES[axle],
                views::front(record, state, axle)
            )
        })
    });
    let figures: String = figures.collect();
    let note = "Both axles from the front on level ground, true to scale: the left wheel is on the right. Below each wheel are its load \
                and its camber to the road.";
    section(
        "attitude",
        "Axles and attitude",
        note,
        &format!("<div class=\"plots pairs\">{figures}</div>"),
    )
}

fn cases(record: &CarRecord) -> String {
    let mut names = vec!["case", "ax g", "ay g", "roll deg", "pitch deg"];
    names.extend(WHEELS);
    names.extend(["load transfer front %", "lifted", "reason"]);
    let mut table = Table::with_columns(names.into_iter().map(Column::from));
    for case in &record.cases {
        let state = case.state.as_ref();
        let number = |value: Option<f64>, unit: &str| Cell::by(value, |value| shown(value, unit));
        let head = [
            Cell::from(case.name.as_str()),
            number(Some(case.ax), "g"),
            number(Some(case.ay), "g"),
            number(state.map(|state| state.attitude[0]), "deg"),
            number(state.map(|state| state.attitude[1]), "deg"),
        ];
        let loads = [0, 1, 2, 3]
            .map(|wheel| number(state.map(|state| state.loads[wheel]), &record.force_unit));
        let lifted = state.map_or_else(String::new, CarStateRecord::lifted_in_words);
        let tail = [
            number(state.and_then(|state| state.front_share), "percent"),
            lifted.as_str().into(),
            case.reason.as_deref().unwrap_or("").into(),
        ];
        table.push_row(head.into_iter().chain(loads).chain(tail));
    }
    let failed = |row: usize| record.cases[row].reason.as_ref().map(|_| "unmet");
    let note = format!(
        "Wheel loads in {}. cases.csv has all results.",
        record.force_unit
    );
    section(
        "cases",
        "Cases",
        &note,
        &super::table::table(&table, failed),
    )
}
