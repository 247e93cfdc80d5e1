//! JSON schema of studies.

use crate::car::CarQuantity;
use crate::compliance::{TestLoad, figure_names};
use crate::model::{FrameConvention, LengthUnit, Side, Topology};
use crate::number::Each;
use hardpoint_study_file::schema::{self, Allowed, Root};

/// Sections of a study of a suspension, with the names of their keys.
pub fn keys() -> Vec<(String, String)> {
    schema::keys(Root::Suspension)
}

/// JSON schema (draft 4) of studies, for editors. It contains keys, required keys, types of values, and permitted names.
pub fn schema() -> serde_json::Value {
    schema::schema(allowed)
}

/// Permitted texts, or keys of a table, at a position in a kind of study.
fn allowed(root: Root, path: &str) -> Option<Allowed> {
    let has_figures = root == Root::Suspension
        && matches!(
            path,
            "outputs.characteristics[]" | "optimise.targets[].figure"
        );
    Some(Allowed {
        names: names(root, path)?,
        pattern: has_figures.then(figure_pattern),
    })
}

/// Regular expression for names of test results. The names contain differences from the default test, in the form of
/// [`TestFigure::stem`](crate::axle::TestFigure::stem).
fn figure_pattern() -> String {
    let loads = TestLoad::ALL.map(|(name, _)| format!("_{name}")).join("|");
    format!(
        "^({})(_trail_-?[0-9.]+)?(_wheel_height|_wheel_load)?(_opposed|_left_loaded|_right_loaded)?(_without_bar)?(_locked_rack)?\
         (_secant)?({loads})?$",
        figure_names().join("|")
    )
}

/// Permitted names for a text, or keys of a table, at a position in a kind of study.
fn names(root: Root, path: &str) -> Option<Vec<String>> {
    let owned = |names: &[&str]| names.iter().map(|name| (*name).to_owned()).collect();
    Some(match root {
        Root::Suspension => owned(&match path {
            "suspension.topology" => Topology::ALL.iter().map(|t| t.name).collect(),
            "suspension.side" => Side::ALL.each(Side::name).to_vec(),
            "suspension.length_unit" => LengthUnit::ALL.each(LengthUnit::symbol).to_vec(),
            "suspension.force_unit" => vec!["N", "lbf"],
            "suspension.mass_unit" => vec!["kg", "lb"],
            "suspension.frame" => FrameConvention::ALL.each(FrameConvention::name).to_vec(),
            "outputs.characteristics[]" => {
                let mut names = crate::axle::Quantity::names();
                names.extend(figure_names());
                names
            }
            "optimise.targets[].figure" => figure_names(),
            "setup.want" => crate::axle::Quantity::names(),
            _ => return None,
        }),
        Root::Car => match path {
            "outputs.characteristics[]" | "tolerance.bands[].characteristic" => {
                CarQuantity::names()
            }
            // Results of cases, and quantities of a single axle.
            "optimise.targets[].characteristic" => {
                let mut names = CarQuantity::names();
                let own = crate::axle::Quantity::names()
                    .into_iter()
                    .map(str::to_owned);
                let further: Vec<String> = own.filter(|name| !names.contains(name)).collect();
                names.extend(further);
                names
            }
            _ => return None,
        },
    })
}
