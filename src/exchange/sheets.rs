//! Finds the sheet of a workbook that has the points: the named sheet, the only sheet with points, or the sheet of the requested
//! axle.

use super::corner::name_of;
use super::names::{cut, marks_of_title};
use super::refusal::{Question, Refusal};
use super::source::NO_POINTS;
use super::table::PointTable;
use super::{points, workbook};
use crate::model::AxlePosition;

/// Reads the points of a workbook. `wanted` is the name of the requested sheet, and `axle` is the requested axle.
///
/// # Errors
/// No sheet has points, the named sheet has no points, several sheets have points and none is named, or the only sheet with
/// points is that of the other axle.
pub(super) fn of_workbook(
    bytes: Vec<u8>,
    wanted: Option<&str>,
    axle: Option<AxlePosition>,
) -> Result<PointTable, Refusal> {
    let book = workbook::Workbook::open(bytes)?;
    let names: Vec<String> = book.names().map(str::to_owned).collect();
    let read = |number: usize| book.sheet(number).and_then(|sheet| points::read(&sheet));
    if let Some(wanted) = wanted {
        let Some(number) = names.iter().position(|name| name == wanted) else {
            return Err(Refusal::Wrong(format!(
                "there is no sheet {wanted:?}; there are {}",
                quoted(names.iter().map(String::as_str))
            )));
        };
        let table = read(number).map_err(|reason| format!("sheet {wanted:?}: {reason}"))?;
        let table = table.ok_or_else(|| format!("sheet {wanted:?}: {NO_POINTS}"))?;
        return Ok(table);
    }
    let mut found: Vec<(&str, PointTable)> = Vec::new();
    let mut unreadable: Vec<String> = Vec::new();
    for (number, name) in names.iter().enumerate() {
        match read(number) {
            Ok(Some(table)) => found.push((name, table)),
            Ok(None) => (),
            Err(reason) => unreadable.push(format!("sheet {name:?}: {reason}")),
        }
    }
    let with_points: Vec<&str> = found.iter().map(|(name, _)| *name).collect();
    let of_axle = |name: &str| axle.is_some() && axle_of(name) == axle;
    let is_by_axle =
        with_points.len() > 1 && with_points.iter().filter(|name| of_axle(name)).count() == 1;
    if is_by_axle {
        found.retain(|(name, _)| of_axle(name));
    }
    if found.len() > 1 {
        return Err(Question::of(
            format!("the workbook has points in {} sheets", found.len()),
            "--sheet",
            &with_points,
        ));
    }
    let Some((name, mut table)) = found.pop() else {
        let first = unreadable.into_iter().next();
        return Err(Refusal::Wrong(
            first.unwrap_or_else(|| NO_POINTS.to_owned()),
        ));
    };
    // If the points state no axle, the name of the sheet shows it.
    if let (Some(asked), Some(own)) = (axle, axle_of(name))
        && asked != own
        && table.axles().is_empty()
    {
        let reasons: String = unreadable.iter().map(|line| format!("\n{line}")).collect();
        return Err(Refusal::Wrong(format!(
            "--axle {}: the only sheet with points that can be read is {name:?}, which is for the {} axle{reasons}",
            name_of(asked),
            name_of(own)
        )));
    }
    if is_by_axle {
        let others = with_points.into_iter().filter(|other| *other != name);
        table.notes.push(format!(
            "sheet {name:?}: the sheet of the axle given by --axle; not read: {}",
            quoted(others)
        ));
    } else if names.len() > 1 {
        table.notes.push(format!(
            "sheet {name:?}: the only sheet with points that can be read"
        ));
    }
    table.left_out.extend(unreadable);
    Ok(table)
}

fn quoted<'n>(names: impl Iterator<Item = &'n str>) -> String {
    let quoted: Vec<String> = names.map(|name| format!("{name:?}")).collect();
    quoted.join(", ")
}

/// Axle in the name of a sheet. `None` if the name has no axle or both axles.
fn axle_of(name: &str) -> Option<AxlePosition> {
    let words = cut(name);
    let has = |wanted: &str| words.iter().any(|word| word == wanted);
    match (has("front"), has("rear")) {
        (true, false) => Some(AxlePosition::Front),
        (false, true) => Some(AxlePosition::Rear),
        _ => marks_of_title(name).and_then(|marks| marks.axle),
    }
}
