//! Elastic parts of a study, as a table.

use super::super::table::{Cell, Table};
use crate::compliance::{AxialStiffness, Shape};
use crate::study::Study;

/// Table of the elastic parts of a study, one part per row. The rates of a bushing with a force curve are its slopes at zero
/// deflection. For an axle, the order of the rows is: bushings of the left wheel, mounts of the subframe, links of the left
/// wheel. Parts of the right wheel that differ, the rack and the steering column follow.
pub fn elastic_parts(study: &Study) -> Table {
    let mut table = Table::new(["part", "elastic", "rates", "torsional rates", "unit"]);
    let u = study.wheel().length_unit.symbol();
    let Some(parts) = study.elastic_parts() else {
        return table;
    };
    for part in &parts.bushings {
        push_bushing(&mut table, part.name, part.shapes, u);
    }
    for link in &parts.links {
        push_link(&mut table, link.name, link.stiffness, u);
    }
    let of_axle = study.axle().and_then(|both| both.axle.elastic.as_ref());
    if let Some(elastic) = of_axle {
        let [left, right] = &elastic.parts.wheels;
        let both = left.bushings.iter().zip(&right.bushings);
        for ((left, right), part) in both.zip(&parts.bushings) {
            if left.shapes != right.shapes {
                push_bushing(
                    &mut table,
                    &format!("right {}", part.name),
                    &right.shapes,
                    u,
                );
            }
        }
        for (right, left) in right.links.iter().zip(&parts.links) {
            if right.stiffness != left.stiffness {
                let name = format!("right {}", left.name);
                push_link(&mut table, &name, right.stiffness, u);
            }
        }
        if let Some(rate) = elastic.parts.rack_rate {
            push_axial(&mut table, "rack", rate, format!("N/{u}"));
        }
        if let Some(column) = elastic.parts.column {
            table.push([
                Cell::from("steering column"),
                Cell::from("torsional"),
                Cell::from(""),
                Cell::from(super::super::brief(column.rate)),
                Cell::from(format!("N {u}/rad")),
            ]);
        }
    }
    table
}

fn push_bushing(table: &mut Table, name: &str, shapes: &[Shape; 6], u: &str) {
    let joined = |rates: [f64; 3]| rates.map(super::super::brief).join(", ");
    let [a, b, c, d, e, f] = shapes.each_ref().map(Shape::initial_rate);
    table.push([
        Cell::from(name),
        Cell::from("bushing"),
        Cell::from(joined([a, b, c])),
        Cell::from(joined([d, e, f])),
        Cell::from(format!("N/{u}, N {u}/rad")),
    ]);
}

fn push_link(table: &mut Table, name: &str, stiffness: AxialStiffness, u: &str) {
    let (rate, unit) = match stiffness {
        AxialStiffness::Rate(rate) => (rate, format!("N/{u}")),
        AxialStiffness::PerStrain(force) => (force, "N per strain".to_owned()),
    };
    push_axial(table, name, rate, unit);
}

fn push_axial(table: &mut Table, name: &str, rate: f64, unit: String) {
    table.push([
        Cell::from(name),
        Cell::from("axial"),
        Cell::from(super::super::brief(rate)),
        Cell::from(""),
        Cell::from(unit),
    ]);
}
