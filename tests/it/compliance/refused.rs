//! Tests of mistakes in studies with elastic parts that would make a result wrong without a message.

use super::support::{elastic, with};
use hardpoint::study::{DesignTable, Designs, Study, SweepVariable};
use std::path::Path;

const NAME: &str = "double_wishbone_compliance.toml";

/// Asserts that this text has one mistake, with this phrase in its message.
fn assert_refused(text: &str, phrase: &str) {
    let read = Study::elastic_from_text("case.toml", text, Path::new(""));
    let errors = read.map(|_| ()).unwrap_err();
    let said = errors.render(false);
    assert_eq!(errors.all().len(), 1, "{said}");
    assert!(said.contains(phrase), "{phrase}: {said}");
}

/// Entry for the stiffness of the lower arm's rear bushing.
fn rear(more: &str) -> String {
    format!("{{ bushing = \"lower_arm_rear\", stiffness = \"y\", {more} }}")
}

fn sweep(variables: &[String]) -> String {
    format!(
        "\n[outputs]\ncharacteristics = [\"toe\"]\n[sweep]\nmethod = \"sobol\"\nsamples = 4\nvariables = [{}]\n",
        variables.join(", ")
    )
}

fn tuning(variables: &[String]) -> String {
    format!(
        "\n[optimise]\nvariables = [{}]\ntargets = [{{ characteristic = \"toe\", at = 0.0, value = 0.0, tolerance = 0.1 }}]\n",
        variables.join(", ")
    )
}

fn scatter(entries: &[String]) -> String {
    format!("\n[tolerance]\nscatter = [{}]\n", entries.join(", "))
}

/// A rate has one value. So two variables, or two entries of `scatter`, cannot have the same rate, even if one of them
/// contains factors and the other one rates.
#[test]
fn a_rate_varies_only_once() {
    for (more, phrase) in [
        (
            sweep(&[
                rear("range = [0.5, 2.0], relative = true, name = \"a\""),
                rear("range = [1000.0, 4000.0], name = \"b\""),
            ]),
            "a already varies this rate",
        ),
        (
            tuning(&[
                rear("range = [0.5, 2.0], relative = true"),
                rear("range = [1000.0, 4000.0]"),
            ]),
            "stiffness y of bushing:lower_arm_rear is already a variable",
        ),
        (
            scatter(&[rear("sigma = 0.02, relative = true"), rear("sigma = 20.0")]),
            "lower_arm_rear stiffness y already scatters",
        ),
    ] {
        assert_refused(&with(NAME, &more), phrase);
    }
    // Both wheels of an axle scatter independently, so each may have an entry.
    let axle = "subframe_axle_compliance.toml";
    let one = |side: &str| rear(&format!("sigma = 0.02, relative = true, side = \"{side}\""));
    elastic(&with(axle, &scatter(&[one("left"), one("right")])));
    let both = rear("sigma = 20.0");
    let phrase = "left lower_arm_rear stiffness y already scatters";
    assert_refused(&with(axle, &scatter(&[both, one("left")])), phrase);
}

/// Rows of designs may have several rates. The digest of the rows distinguishes the rates.
#[test]
fn rows_of_designs_have_rates() {
    let front = "{ bushing = \"upper_arm_front\", stiffness = \"tx\", range = [3.0e4, 9.0e4] }";
    let variables = [
        rear("range = [0.5, 2.0], relative = true"),
        front.to_owned(),
    ];
    let study = elastic(&with(NAME, &sweep(&variables)));
    let Some(Designs::Sampled(sampled)) = study.sweep.map(|sweep| sweep.designs) else {
        panic!("a sweep with variables");
    };
    let table = |variables: &[&SweepVariable]| {
        let variables = variables.iter().copied().cloned();
        DesignTable::of(variables.collect(), vec![1.0, 2.0])
    };
    let [rear, front] = [0, 1].map(|k| &sampled.variables[k]);
    let both = table(&[rear, front]).unwrap();
    assert_eq!(both.row(0), [1.0, 2.0]);
    let digests = [&[rear, front][..], &[front, rear], &[rear], &[front]].map(|own| {
        let table = table(own).unwrap();
        (own.len(), table.digest)
    });
    for (k, digest) in digests.iter().enumerate() {
        assert!(!digests[..k].contains(digest), "{k}");
    }
    let renamed = SweepVariable {
        name: "again".to_owned(),
        ..rear.clone()
    };
    let said = table(&[rear, &renamed]).unwrap_err();
    assert_eq!(
        said,
        "again and lower_arm_rear_stiffness_y give the same rate"
    );
}

/// Keys for the moves of hardpoints have no effect on a rate. The formulation in point coordinates has no elastic parts.
#[test]
fn keys_of_rigid_parts_are_refused() {
    let shifted = rear("sigma = 0.02, relative = true, shift = 0.1");
    let turned = rear("sigma = 0.02, relative = true, turn = 0.1");
    let tuned = rear("range = [0.5, 2.0], relative = true, turn = 1.0");
    let phrase = "this key moves hardpoints, not a rate";
    for more in [scatter(&[shifted]), scatter(&[turned]), tuning(&[tuned])] {
        assert_refused(&with(NAME, &more), phrase);
    }
    let solver = "\n[solver]\nformulation = \"point_coordinates\"\n";
    assert_refused(
        &with("macpherson_compliance.toml", solver),
        "those of a rigid mechanism, without [compliance]",
    );
}

/// Loads with the same name on both wheels keep the same quantity constant. The default of `hold` counts like the same
/// written value.
#[test]
fn the_default_quantity_of_a_load_equals_the_written_one() {
    let loads = |hold: &str| {
        let one = "{ name = \"turn\", at = \"wheel_centre\", force = [0.0, 900.0, 0.0], side =";
        let more = format!(
            "\n[outputs]\ncharacteristics = [\"toe\"]\nloads = [\n  {one} \"left\" }},\n  {one} \"right\", hold = \"{hold}\" }},\n]\n"
        );
        with("subframe_axle_compliance.toml", &more)
    };
    elastic(&loads("wheel_load"));
    assert_refused(&loads("wheel_height"), "expected the same hold for both");
}
