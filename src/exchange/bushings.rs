//! Assigns the bushings of a file to the hardpoints of an imported wheel, and writes their sections of the study.

use super::adams_bushings::{AdamsBushing, Law, Laws};
use super::import::{ImportOptions, Imported};
use super::roles::{self, Letters};
use super::table::PointTable;
use crate::model::{LengthUnit, Side};
use std::fmt::Write;

/// A bushing at a hardpoint of the study.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Bushing {
    hardpoint: &'static str,
    /// Laws of the bushing (force by deflection, torque by angle) in the study's unit of length.
    laws: Laws,
    /// Name of the bushing in the file, and its location there.
    from: String,
}

/// Pivots of arms. The x axis of a bushing there is the axis of the arm.
const PIVOTS: [&str; 6] = [
    "lower_arm_front",
    "lower_arm_rear",
    "upper_arm_front",
    "upper_arm_rear",
    "arm_pivot_inner",
    "arm_pivot_outer",
];

/// Imports the bushings that the study can use, and lists the other bushings of the file with the reasons.
pub(super) fn take(table: &PointTable, options: &ImportOptions<'_>, imported: &mut Imported) {
    let of_wheel = |bushing: &&AdamsBushing| !bushing.is_right || imported.side == Side::Right;
    let mut bushings: Vec<&AdamsBushing> = table.bushings.iter().filter(of_wheel).collect();
    // A bushing of the right wheel alone has priority over the mirror image of a left bushing.
    bushings.sort_by_key(|bushing| !bushing.is_right);
    if bushings.is_empty() {
        return;
    }
    if !options.bushings {
        let names: Vec<&str> = bushings.iter().map(|b| b.usage.as_str()).collect();
        imported.left_out.push(format!(
            "bushings ({}): use --bushings to import them for `hardpoint kc`",
            names.join(", ")
        ));
        return;
    }
    for bushing in bushings {
        let from = format!("{:?}, line {}", bushing.usage, bushing.line);
        match at_hardpoint(bushing, imported) {
            Ok((hardpoint, laws)) => imported.bushings.push(Bushing {
                hardpoint,
                laws,
                from,
            }),
            Err(reason) => imported.left_out.push(format!("bushing {from}: {reason}")),
        }
    }
    if !imported.bushings.is_empty() {
        imported.notes.push(
            "bushings: z of Adams is assumed along the axis of the arm's pivots, which the \
             subsystem does not state. The rates along and about x and y are equal"
                .to_owned(),
        );
        imported.notes.push(
            "relaxed = \"free\" is assumed: bushings without force in the design position. \"at_design_load\" needs [spring]"
                .to_owned(),
        );
    }
}

/// Finds the hardpoint of a bushing. Returns the hardpoint, and the bushing's laws (force by deflection, torque by angle) in the
/// study's unit. The error states why the study cannot use the bushing.
fn at_hardpoint(
    bushing: &AdamsBushing,
    imported: &Imported,
) -> Result<(&'static str, Laws), String> {
    // Adams/Car puts a prefix of three letters before names. The letters mean: bushing; kinematic or not; left, right or
    // single.
    let name = bushing.usage.to_lowercase();
    let plain = name.split_once('_').filter(|(prefix, _)| {
        prefix.len() == 3 && prefix.starts_with('b') && prefix.ends_with(['l', 'r', 's'])
    });
    let plain = plain.map_or(name.as_str(), |(_, rest)| rest);
    let role = roles::read(plain, imported.topology, Letters::default());
    let role = role.filter(|role| imported.hardpoints.iter().any(|h| h.name == role.hardpoint));
    let Some(role) = role else {
        return Err("its name is not a hardpoint of this wheel".to_owned());
    };
    if !PIVOTS.contains(&role.hardpoint) {
        return Err(format!(
            "it is at {}, but the direction of a bushing is known only at the pivots of arms",
            role.hardpoint
        ));
    }
    if imported
        .bushings
        .iter()
        .any(|other| other.hardpoint == role.hardpoint)
    {
        return Err(format!("{} already has a bushing", role.hardpoint));
    }
    let laws = bushing.laws.as_ref().map_err(String::clone)?;
    Ok((role.hardpoint, laws.in_unit(imported.unit)))
}

/// Sections `[compliance]` and `[bushings]` of the study. `unit` is the study's unit of length. Empty if there are no bushings.
pub(super) fn sections(bushings: &[Bushing], unit: LengthUnit) -> String {
    if bushings.is_empty() {
        return String::new();
    }
    let unit = unit.symbol();
    let mut text = format!(
        "\n[compliance]\nrelaxed = \"free\"               # or \"at_design_load\" with [spring]\n\n\
         # Along x (the axis of the pivots), y, z in N/{unit}, and about them in N {unit}/rad.\n"
    );
    for Bushing {
        hardpoint,
        laws,
        from,
    } in bushings
    {
        let rate = |law: &Law| match law {
            Law::Rate(rate) => *rate,
            Law::Curve(_) => 0.0,
        };
        let [along, radial] = laws.along.each_ref().map(rate);
        let [about, tilt] = laws.about.each_ref().map(rate);
        let _ = writeln!(
            text,
            "[bushings.{hardpoint}]   # {}\nstiffness = [{along:?}, {radial:?}, {radial:?}, {about:?}, {tilt:?}, {tilt:?}]",
            super::compose::one_line(from)
        );
        let [x, yz] = &laws.along;
        let [tx, tyz] = &laws.about;
        let curves = [
            ("fx", x),
            ("fy", yz),
            ("fz", yz),
            ("tx", tx),
            ("ty", tyz),
            ("tz", tyz),
        ];
        for (key, law) in curves {
            if let Law::Curve(points) = law {
                let points: Vec<String> = points
                    .iter()
                    .map(|[d, f]| format!("[{d:?}, {f:?}]"))
                    .collect();
                let _ = writeln!(text, "{key} = [{}]", points.join(", "));
            }
        }
        text.push('\n');
    }
    text
}
