//! The elastic parts of a study, as a table.

use super::super::table::{Cell, Table};
use crate::study::Study;

/// Returns the elastic parts of a study, one in a row.
pub fn elastic_parts(study: &Study) -> Table {
    let mut table = Table::new(["part", "elastic", "rates", "torsional rates", "unit"]);
    let Some(elastic) = study.compliance() else {
        return table;
    };
    let u = study.wheel().length_unit.symbol();
    let joined = |rates: [f64; 3]| rates.map(super::super::brief).join(", ");
    for part in &elastic.parts.bushings {
        let slopes = part
            .shapes
            .each_ref()
            .map(crate::compliance::Shape::initial_rate);
        let [a, b, c, d, e, f] = slopes;
        table.push([
            Cell::from(study.wheel().mechanism.name(part.point)),
            Cell::from("bushing"),
            Cell::from(joined([a, b, c])),
            Cell::from(joined([d, e, f])),
            Cell::from(format!("N/{u}, N {u}/rad")),
        ]);
    }
    for (name, part) in elastic.link_names.iter().zip(&elastic.parts.links) {
        use crate::compliance::AxialStiffness;
        let (rate, unit) = match part.stiffness {
            AxialStiffness::Rate(rate) => (rate, format!("N/{u}")),
            AxialStiffness::PerStrain(force) => (force, "N per strain".to_owned()),
        };
        table.push([
            Cell::from(name.as_str()),
            Cell::from("axial"),
            Cell::from(super::super::brief(rate)),
            Cell::from(""),
            Cell::from(unit),
        ]);
    }
    table
}
