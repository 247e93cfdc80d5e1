//! Tests of the commands for a solid axle on five elastic links: sweep, tuning, and the program as a user runs it.

use super::{Kind, Scatter, made};
use crate::compliance::command::hardpoint;
use crate::compliance::support::{elastic, fourth_order};
use crate::support::larger;
use crate::support::random::Random;
use crate::support::rows_by_column;
use hardpoint::axle::axle_curves;
use hardpoint::curves::Curves;
use hardpoint::optimise::{Control, TargetLayout, assessed_at, tune};
use hardpoint::study::{Study, Wanted};
use hardpoint::sweep::SweepPlan;

const MOTION: &str = "[motion]\ntravel_left = [-30.0, 0.0]\ntravel_right = [0.0, 30.0]\n[outputs]\n\
                      characteristics = [\"pinion_angle\", \"axle_lateral\", \"steer_by_roll\", \"link_roll_stiffness\", \"panhard_tension\"]\n";

const SWEEP: &str = "[sweep]\nmethod = \"random\"\nsamples = 6\nvariables = [\n\
                     { hardpoint = \"upper_link_axle\", axis = \"z\", range = [-8.0, 8.0] },\n\
                     { hardpoint = \"panhard_axle\", axis = \"z\", range = [-8.0, 8.0] },\n\
                     { link = \"lower_link\", range = [0.5, 2.0], relative = true },\n\
                     { link = \"panhard\", range = [0.5, 2.0], relative = true },\n]\n";

fn text(further: &str) -> String {
    let scatter = Scatter {
        points: 15.0,
        differs: true,
        rates: [4.0, 4.5],
        springs: true,
    };
    // Variables change the rates of both halves together, so the right half has no separate rates.
    let made = made(Kind::FiveLink, scatter, &mut Random(9), further);
    let start = made.text.find("[axle.right.links.lower_link]").unwrap();
    let end = made.text.find("[spring]").unwrap();
    format!("{}{}", &made.text[..start], &made.text[end..])
}

fn curves(study: &Study) -> Curves {
    let both = study.axle().unwrap();
    let found = axle_curves(&both.axle, &both.plan).unwrap().curves;
    assert!(found.are_complete());
    found
}

/// A sweep gives each design the same values as a separate study of this design, in the design position.
#[test]
fn a_sweep_reads_designs_as_their_studies_do() {
    let study = elastic(&text(&(MOTION.to_owned() + SWEEP)));
    let plan = SweepPlan::of(&study, study.sweep.as_ref().unwrap()).unwrap();
    let outputs = plan.record.outputs.iter();
    let columns: Vec<String> = outputs.map(|o| o.column.clone()).collect();
    let mut worker = plan.worker().unwrap();
    let rows = worker.rows(0).clone();
    assert!(rows.failing.iter().all(Option::is_none));
    let mut checked = 0;
    for design in 0..6 {
        let alone = curves(&plan.moved(design as u64));
        // The travel of the right wheel is the inner loop of the stations.
        let design_station = 2;
        let value = |name: &str, station: usize| {
            let column = alone.columns.iter().position(|c| c.name == name);
            let column = column.unwrap_or_else(|| panic!("{name} of {:?}", alone.columns));
            alone.stations[station].value(column).unwrap()
        };
        for (k, name) in columns.iter().enumerate() {
            let found = rows.outputs[design * columns.len() + k];
            let all = |name: String| (0..4).map(move |station| value(&name, station));
            let expected = if name.contains("_min") {
                all(name.replacen("_min", "", 1)).fold(f64::INFINITY, f64::min)
            } else if name.contains("_max") {
                all(name.replacen("_max", "", 1)).fold(f64::NEG_INFINITY, larger)
            } else {
                value(&name.replacen("_design", "", 1), design_station)
            };
            checked += 1;
            let error = (found - expected).abs();
            assert!(
                error < 1e-9 * expected.abs().max(1.0),
                "{name} {design}: {found} {expected}"
            );
        }
    }
    // Two quantities with smallest and largest value and value in the design position, and five test results.
    assert_eq!((columns.len(), checked), (11, 6 * 11), "{columns:?}");
}

/// The slopes of a tuning equal difference quotients of fourth order, and the tuning meets its targets.
#[test]
fn a_tuning_meets_its_targets_with_exact_slopes() {
    let tuned = "[optimise]\nvariables = [\n  { hardpoint = \"lower_link_chassis\", axis = \"z\", range = [-40.0, 40.0] },\n\
                 { hardpoint = \"panhard_chassis\", axis = \"z\", range = [-60.0, 60.0] },\n\
                 { link = \"upper_link\", range = [0.2, 5.0], relative = true },\n]\ntargets = [\n\
                 { figure = \"steer_by_roll\", value = 0.0, tolerance = 0.005 },\n\
                 { characteristic = \"axle_lateral\", over = \"travel_left\", travel_right = 30.0, at = -30.0, value = 0.5, tolerance = 0.1 },\n\
                 { figure = \"link_roll_stiffness\", value = 60.0, tolerance = 2.0 },\n]\n";
    let study = elastic(&text(&(MOTION.to_owned() + tuned)));
    let optimise = study.optimise.as_ref().unwrap();
    let layout = TargetLayout::of(optimise, &study.vehicle);
    let at = |x: &[f64]| {
        let found = assessed_at(study.wheel(), &optimise.variables, &layout, x);
        found.unwrap().unwrap().goal
    };
    let x = [2.0, -3.0, 0.2];
    let found = at(&x);
    assert_eq!(found.residuals.len(), 3);
    for (k, step) in [0.5, 0.5, 0.02].into_iter().enumerate() {
        let moved = [-2.0, -1.0, 1.0, 2.0].map(|steps| {
            let mut x = x;
            x[k] += steps * step;
            at(&x).residuals
        });
        for row in 0..3 {
            let expected = fourth_order(moved.each_ref().map(|at| at[row]), step);
            let own = found.jacobian[(row, k)];
            let error = (own - expected).abs();
            assert!(
                error < 2e-6 * expected.abs().max(1e-2),
                "{row} {k}: {own} {expected}"
            );
        }
    }
    // The targets are values of a known design. The tuning starts at the study's design.
    let known = [9.0, -12.0, 0.4];
    let residuals = at(&known).residuals;
    let read: Vec<f64> = (0..3)
        .map(|k| {
            let own = &optimise.targets[layout.targets_of_rows()[k]];
            let Wanted::At { value, .. } = own.wanted else {
                panic!("single values")
            };
            value + residuals[k] / layout.share(layout.targets_of_rows()[k]) * own.tolerance
        })
        .collect();
    let mut study = study.clone();
    let rows = layout.targets_of_rows();
    for (row, value) in rows.iter().zip(read) {
        let target = &mut study.optimise.as_mut().unwrap().targets[*row];
        let Wanted::At { value: own, .. } = &mut target.wanted else {
            panic!("single values")
        };
        *own = value;
    }
    let optimise = study.optimise.as_ref().unwrap();
    let tuning = tune(&study.vehicle, optimise, Control::default()).unwrap();
    let best = tuning.best.as_ref().unwrap();
    let layout = TargetLayout::of(optimise, &study.vehicle);
    let found = assessed_at(study.wheel(), &optimise.variables, &layout, &best.offsets);
    let residuals = found.unwrap().unwrap().goal.residuals;
    // The tuning stops at the smallest change with a misfit of at most `good_enough` (0.1).
    let square = residuals.iter().map(|r| r * r).sum::<f64>() / 3.0;
    assert!(square.sqrt() < 0.1001, "{residuals:?} {:?}", best.offsets);
    let before = at(&[0.0; 3]).residuals.norm();
    assert!(before > 5.0, "{before}");
}

/// The printed template equals the sample of the repository, and every command that supports elastic axles accepts it.
#[test]
fn the_template_runs_in_all_commands() {
    let directory = tempfile::tempdir().unwrap();
    let here = directory.path();
    let new = hardpoint(&["new", "solid_axle", "--with", "five_links"], here);
    assert_eq!(new.status.code(), Some(0));
    let sample = crate::support::studies().join("solid_axle_five_links.toml");
    let body = |text: &str| {
        text.lines()
            .filter(|l| !l.starts_with('#'))
            .map(str::to_owned)
            .collect::<Vec<_>>()
    };
    let printed = String::from_utf8(new.stdout).unwrap();
    assert_eq!(
        body(&printed),
        body(&std::fs::read_to_string(sample).unwrap())
    );
    std::fs::write(here.join("five.toml"), &printed).unwrap();
    for arguments in [
        &["check", "five.toml"][..],
        &["solve", "five.toml", "--out", "solved"],
        &["kc", "five.toml", "--out", "kc"],
        &["limits", "five.toml"],
    ] {
        let ran = hardpoint(arguments, here);
        let said = String::from_utf8_lossy(&ran.stdout).into_owned()
            + &String::from_utf8_lossy(&ran.stderr);
        assert_eq!(ran.status.code(), Some(0), "{arguments:?}: {said}");
        if arguments[0] == "limits" {
            assert!(said.contains("Five rigid links"), "{said}");
            // The output names the parts that give way and the unstable poses.
            assert!(
                said.contains("gives way") && said.contains("unstable"),
                "{said}"
            );
        }
        if arguments[0] == "check" {
            assert!(
                said.contains("panhard") && said.contains("lower_link"),
                "{said}"
            );
        }
    }
    let rows = rows_by_column(&std::fs::read(here.join("kc/kc.csv")).unwrap());
    let of = |quantity: &str, wheel: &str| -> f64 {
        let mut rows = rows.iter();
        let row = rows.find(|row| {
            row["quantity"] == quantity && row["wheel"] == wheel && !row["value"].is_empty()
        });
        row.unwrap_or_else(|| panic!("{quantity} {wheel}"))["value"]
            .parse()
            .unwrap()
    };
    assert!(of("link_roll_stiffness", "axle") > 1.0);
    assert!(of("compliant_roll_stiffness", "axle") > of("link_roll_stiffness", "axle"));
    assert_ne!(
        of("upper_link_tension", "left"),
        of("upper_link_tension", "right")
    );
    assert!(of("panhard_tension", "axle").is_finite());
    // The results of the right wheel have no Panhard rod.
    let levels = rows_by_column(&std::fs::read(here.join("kc/levels.csv")).unwrap());
    let ok = levels.iter().filter(|row| row["status"] == "ok");
    assert!(ok.clone().count() > 10);
    for row in ok {
        assert_eq!(row["right_panhard_tension_N"], "");
        assert_ne!(row["left_panhard_tension_N"], "");
    }
    // A rigid solid axle has no elastic tests. The message tells how to add elastic parts.
    let rigid = hardpoint(&["new", "solid_axle"], here);
    std::fs::write(here.join("rigid.toml"), rigid.stdout).unwrap();
    let ran = hardpoint(&["kc", "rigid.toml"], here);
    assert_ne!(ran.status.code(), Some(0));
    assert!(String::from_utf8_lossy(&ran.stderr).contains("[links.NAME]"));
}

/// The schema knows the names of all test results of elastic axles.
#[test]
fn the_schema_knows_the_figures() {
    let schema = hardpoint::study::schema().to_string();
    let samples = [
        "solid_axle_five_links.toml",
        "subframe_axle_compliance.toml",
    ];
    for name in samples {
        let path = crate::support::studies().join(name);
        let study = elastic(&std::fs::read_to_string(path).unwrap());
        let axle = &study.axle().unwrap().axle;
        assert!(axle.figures().len() > 30);
        for figure in axle.figures() {
            let name = format!("\"{}\"", figure.quantity);
            assert!(schema.contains(&name), "{name}");
        }
    }
}
