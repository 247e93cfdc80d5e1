//! Tests of measured sheets of both wheels as targets of an axle.

use super::super::support::{elastic, sheet as noisy, with};
use hardpoint::optimise::{Control, tune};
use hardpoint::rig::RigTests;
use hardpoint::study::Study;

const NAME: &str = "subframe_axle_compliance.toml";
/// Rates that the tuning fits to the sheet.
const RATES: [(&str, &str); 5] = [
    ("lower_arm_front", "y"),
    ("lower_arm_rear", "y"),
    ("upper_arm_front", "y"),
    ("subframe_front", "y"),
    ("subframe_rear", "y"),
];
/// Factors on the elastic rates. The test computes its K&C sheet with the changed rates.
const FACTORS: [f64; 5] = [0.8, 1.3, 1.2, 0.75, 1.15];

fn asked(targets: &str) -> String {
    let variables = RATES.map(|(bushing, axis)| {
        format!("{{ bushing = \"{bushing}\", stiffness = \"{axis}\", range = [0.3, 3.0], relative = true }}")
    });
    let variables = variables.join(",\n");
    with(
        NAME,
        &format!("\n[optimise]\nfit = true\nvariables = [{variables}]\ntargets = [{targets}]\n"),
    )
}

/// Returns `kc.csv` of the axle with other rates, as a measured sheet with relative noise.
fn sheet(share: f64, seed: u64) -> String {
    let study = elastic(&asked(
        "{ figure = \"steer_by_roll\", value = 0.0, tolerance = 1.0 }",
    ));
    let offsets = FACTORS.map(f64::ln);
    let planted = study.moved(&offsets);
    let csv = RigTests::of(&planted, None).unwrap().results.kc_csv();
    let text = noisy(&csv, share, seed);
    // Every row has a value.
    assert_eq!(
        text.lines().count(),
        String::from_utf8_lossy(&csv).lines().count()
    );
    text
}

fn study_of(sheet: &str, targets: &str) -> Result<Study, String> {
    let directory = tempfile::tempdir().unwrap();
    std::fs::write(directory.path().join("sheet.csv"), sheet).unwrap();
    let read = Study::elastic_from_text("case.toml", &asked(targets), directory.path());
    read.map_err(|errors| errors.to_string())
}

const WHOLE: &str = "{ file = \"sheet.csv\", tolerance = 1.0 }";

/// A tuning finds the rates from which a sheet was computed: exactly without noise, and within their standard errors with
/// noise.
#[test]
fn rates_of_an_axle_are_identified_from_a_sheet() {
    for (share, seed) in [(0.0, 1), (1.0, 2), (1.0, 3)] {
        let sheet = sheet(share, seed);
        let rows = sheet.lines().count() - 1;
        let study = study_of(&sheet, WHOLE).unwrap();
        let optimise = study.optimise.as_ref().unwrap();
        assert_eq!(optimise.targets.len(), rows, "a target for each value");
        let tuning = tune(&study.vehicle, optimise, Control::default()).unwrap();
        let best = tuning.best.unwrap();
        for (k, factor) in FACTORS.iter().enumerate() {
            let off = best.offsets[k] - factor.ln();
            if share == 0.0 {
                assert!(off.abs() < 1e-5, "{:?}: {off}", RATES[k]);
                continue;
            }
            let errors = best.errors.as_ref().unwrap();
            assert!((0.7..1.4).contains(&errors.scatter), "{}", errors.scatter);
            let sigma = errors.sigmas[k].unwrap();
            assert!(
                off.abs() < 4.5 * sigma && sigma < 0.3,
                "{seed} {:?}: {off} {sigma}",
                RATES[k]
            );
        }
    }
}

/// The written study does not need its sheet, because it contains the targets of the sheet.
#[test]
fn targets_of_a_sheet_are_written_out() {
    let study = study_of(&sheet(0.0, 1), WHOLE).unwrap();
    let alone = elastic(&study.text);
    let [own, written] = [&study, &alone].map(|study| &study.optimise.as_ref().unwrap().targets);
    assert_eq!(own.len(), written.len());
    let places = |study: &Study, k: usize| {
        let axle = &study.axle().unwrap().axle;
        study.optimise.as_ref().unwrap().targets[k].axle_samples(axle)
    };
    for k in 0..own.len() {
        assert_eq!(own[k].of, written[k].of, "{k}");
        assert_eq!(
            (own[k].tolerance, own[k].weight),
            (written[k].tolerance, written[k].weight)
        );
        let [a, b] = [places(&study, k), places(&alone, k)];
        assert_eq!(a.len(), b.len());
        for (a, b) in a.iter().zip(&b) {
            assert_eq!((a.quantity, a.placement), (b.quantity, b.placement), "{k}");
            assert_eq!(a.wanted, b.wanted, "{k}");
        }
    }
}

/// A row without a wheel applies to both wheels. The program refuses rows that do not identify the wheel or the test.
#[test]
fn rows_say_which_wheel_and_test_they_are_of() {
    let target =
        "{ file = \"sheet.csv\", figure = \"toe_by_lateral_force_trail_30\", tolerance = 0.001 }";
    let both = "load,mode,quantity,value\nlateral,parallel,toe_by_lateral_force,-0.01\n";
    let study = study_of(both, target).unwrap();
    let [only] = &study.optimise.as_ref().unwrap().targets[..] else {
        panic!("one target")
    };
    assert_eq!(only.of.column, "toe_by_lateral_force_trail_30_deg_per_kN");
    assert_eq!(only.axle_samples(&study.axle().unwrap().axle).len(), 2);
    for (text, why) in [
        (
            "load,quantity,value\nlateral,toe_by_lateral_force,-0.01\n",
            "several tests",
        ),
        (
            "load,mode,wheel,quantity,value\nlateral,parallel,middle,toe_by_lateral_force,-0.01\n",
            "left, right or axle",
        ),
        (
            "load,mode,trail_mm,quantity,value\nlateral,parallel,10.0,toe_by_lateral_force,-0.01\n",
            "no test of the study",
        ),
        (
            "load,mode,quantity,value,travel_left_mm,travel_right_mm\nlateral,parallel,toe_by_lateral_force,-0.01,5.0,0.0\n",
            "expected equal travels",
        ),
        (
            "load,mode,quantity,value,travel_mm\nlateral,parallel,toe_by_lateral_force,-0.01,40.0\n",
            "40 is outside of the motion, which runs from -30 to 30",
        ),
        (
            "load,mode,quantity,value,unit\nlateral,parallel,toe_by_lateral_force,-0.01,rad\n",
            "as the unit",
        ),
        (
            "load,quantity,value\nsideways,toe_by_lateral_force,-0.01\n",
            "not a load of a test",
        ),
    ] {
        let said = study_of(text, target).unwrap_err();
        assert!(
            said.contains(why) && said.contains("sheet.csv"),
            "{why}: {said}"
        );
    }
}

/// The written study has the stations of the sheet in each motion. A motion of rows has no place for the rows of a sheet, so the
/// program refuses it.
#[test]
fn rows_of_a_sheet_keep_their_stations_in_the_written_study() {
    let sheet = "load,mode,quantity,value,travel_left_mm,travel_right_mm\n\
                 lateral,parallel,toe_by_lateral_force,-0.01,10.0,10.0\n";
    let target =
        "{ file = \"sheet.csv\", figure = \"toe_by_lateral_force_trail_30\", tolerance = 0.001 }";
    let heave = "heave = { from = -30.0, to = 30.0, steps = 3 }";
    let read = |motion: &str| {
        let directory = tempfile::tempdir().unwrap();
        std::fs::write(directory.path().join("sheet.csv"), sheet).unwrap();
        let text = asked(target);
        assert_eq!(text.matches(heave).count(), 1);
        Study::elastic_from_text("case.toml", &text.replace(heave, motion), directory.path())
    };
    for motion in [
        heave,
        "heave = [10.0, 20.0]\nsteering_wheel_angle = 30.0",
        "travel_left = [0.0, 10.0]\ntravel_right = [0.0, 10.0]\nrack = [-5.0, 5.0]",
    ] {
        let study = read(motion).unwrap_or_else(|e| panic!("{motion}: {e}"));
        let again = elastic(&study.text);
        let [own, written] = [&study, &again].map(|study| {
            let axle = &study.axle().unwrap().axle;
            study.optimise.as_ref().unwrap().targets[0].axle_samples(axle)
        });
        assert_eq!(own.len(), 2, "{motion}");
        for (own, written) in own.iter().zip(&written) {
            assert_eq!(own.placement, written.placement, "{motion}");
        }
    }
    let refused = read("heave = [-30.0, 10.0]\ncombine = \"rows\"").unwrap_err();
    assert_eq!(refused.all()[0].position(), Some((2, 1)), "{refused}");
    assert!(
        refused.to_string().contains("without \"combine\""),
        "{refused}"
    );
}
