//! The names that the JSON schema of studies knows.

use crate::characteristics::Characteristic;
use crate::model::{FrameConvention, LengthUnit, Side, Topology};
use hardpoint_study_file::schema;

/// The JSON schema (draft 4) of a study, for editors: its keys, which of them are needed, of what type their values
/// are, and the names that there is a list of.
pub fn schema() -> serde_json::Value {
    schema::schema(names)
}

/// Names that a text may be, or the keys of a table, by the place.
fn names(path: &str) -> Option<Vec<&'static str>> {
    Some(match path {
        "suspension.topology" => Topology::ALL.iter().map(|t| t.name).collect(),
        "suspension.side" => Side::ALL.map(Side::name).to_vec(),
        "suspension.length_unit" => LengthUnit::ALL.map(LengthUnit::symbol).to_vec(),
        "suspension.frame" => FrameConvention::ALL.map(FrameConvention::name).to_vec(),
        "outputs.characteristics[]" => crate::axle::Quantity::names(),
        "setup.want" => Characteristic::ALL.iter().map(|c| c.info().name).collect(),
        _ => return None,
    })
}
