//! The elastic parts of a study, as a table.

use super::super::table::{Cell, Table};
use crate::compliance::{AxialStiffness, LinkPart, Shape};
use crate::study::Study;

/// Returns the elastic parts of a study, one in a row; of an axle those of the left side, those
/// that differ on the right, and the rack.
pub fn elastic_parts(study: &Study) -> Table {
    let mut table = Table::new(["part", "elastic", "rates", "torsional rates", "unit"]);
    let u = study.wheel().length_unit.symbol();
    let mechanism = &study.wheel().mechanism;
    if let Some(elastic) = study.compliance() {
        for part in &elastic.parts.bushings {
            push_bushing(&mut table, mechanism.name(part.point), &part.shapes, u);
        }
        push_links(&mut table, &elastic.link_names, &elastic.parts.links, u);
    }
    let of_axle = study.axle().and_then(|both| both.axle.elastic.as_ref());
    if let Some(elastic) = of_axle {
        let [left, right] = &elastic.parts.wheels;
        for part in &left.bushings {
            push_bushing(&mut table, mechanism.name(part.point), &part.shapes, u);
        }
        for mount in elastic.parts.subframe.iter().flat_map(|own| &own.mounts) {
            push_bushing(&mut table, &mount.name, &mount.shapes, u);
        }
        push_links(&mut table, &elastic.link_names, &left.links, u);
        let own = left.bushings.iter().zip(&right.bushings);
        for (_, part) in own.filter(|(left, right)| left.shapes != right.shapes) {
            let name = format!("right {}", mechanism.name(part.point));
            push_bushing(&mut table, &name, &part.shapes, u);
        }
        let own = left.links.iter().zip(&right.links);
        for ((_, part), name) in own.zip(&elastic.link_names).filter(|((l, r), _)| l != r) {
            let names = [format!("right {name}")];
            push_links(&mut table, &names, std::slice::from_ref(part), u);
        }
        if let Some(rate) = elastic.parts.rack_rate {
            push_axial(&mut table, "rack", rate, format!("N/{u}"));
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

fn push_links(table: &mut Table, names: &[String], links: &[LinkPart], u: &str) {
    for (name, part) in names.iter().zip(links) {
        let (rate, unit) = match part.stiffness {
            AxialStiffness::Rate(rate) => (rate, format!("N/{u}")),
            AxialStiffness::PerStrain(force) => (force, "N per strain".to_owned()),
        };
        push_axial(table, name, rate, unit);
    }
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
