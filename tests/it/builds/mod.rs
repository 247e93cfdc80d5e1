//! Tests of built mechanisms: their properties and their values.

mod axle;
mod axle_derivatives;
mod independent;
mod instructions;
mod lanes;
mod legs;
mod one_build;
mod other_equations;
mod reference;
mod same_as_design;
mod set_up;
mod spin_axis;
mod tolerance;
mod whole_shims;

use hardpoint::assembly::{Assembler, BuildParameter, Member};
use hardpoint::model::Axis;
use hardpoint::plan::Plan;
use hardpoint::study::Study;

/// Sample study with some of its keys changed.
fn study(name: &str, overrides: &[&str]) -> Study {
    crate::support::study(&format!("{name}.toml"), overrides)
}

fn assembler(study: &Study) -> Assembler {
    Assembler::new(study.wheel()).unwrap()
}

/// Dimension with this name: a coordinate, or a length if `axis` is absent.
fn parameter(assembler: &Assembler, of: &str, axis: Option<&str>) -> BuildParameter {
    let mechanism = &assembler.suspension().mechanism;
    match axis {
        Some(axis) => {
            let axis = Axis::ALL.into_iter().find(|a| a.name() == axis).unwrap();
            BuildParameter::Coordinate(mechanism.point(of).unwrap(), axis)
        }
        None => {
            let members = Member::all(mechanism);
            let member = members.iter().find(|(name, _)| name == of);
            BuildParameter::Length(member.unwrap_or_else(|| panic!("no member {of}")).1)
        }
    }
}

/// Plan with the outputs of the study.
fn plan(study: &Study) -> Plan {
    Plan::of(study.one_wheel().unwrap())
}
