//! Finds the sheet of a workbook that has the points: the named sheet, the only sheet with points, or the sheet of the requested
//! axle.

use super::corner::name_of;
use super::names::{cut, marks_of_title};
use super::refusal::{Question, Refusal};
use super::source::NO_POINTS;
use super::table::PointTable;
use super::{points, workbook};
use crate::model::AxlePosition;

/// Reads the points of a workbook, from the bytes of its file. `wanted` is the name of the requested sheet, and `axle` is the
/// requested axle.
///
/// # Errors
/// As for [`of_book`]. The bytes are not a workbook.
pub(super) fn of_workbook(
    bytes: Vec<u8>,
    wanted: Option<&str>,
    axle: Option<AxlePosition>,
) -> Result<PointTable, Refusal> {
    of_book(&workbook::Workbook::open(bytes)?, wanted, axle)
}

/// Reads the points of both axles of a workbook: one sheet for each axle, or otherwise the sheet with points.
///
/// # Errors
/// As for [`of_book`]. The bytes are not a workbook. One of the sheets of the two axles cannot be read, or these sheets state
/// different units or axes.
pub(super) fn of_car(bytes: Vec<u8>) -> Result<PointTable, Refusal> {
    let book = workbook::Workbook::open(bytes)?;
    match by_axle(&book)? {
        Some(table) => Ok(table),
        None => of_book(&book, None, None),
    }
}

/// Reads the points of a workbook. `wanted` is the name of the requested sheet, and `axle` is the requested axle.
///
/// # Errors
/// No sheet has points, or the named sheet has none. Several sheets have points, and none is named. The only sheet with points is
/// for the other axle.
fn of_book(
    book: &workbook::Workbook,
    wanted: Option<&str>,
    axle: Option<AxlePosition>,
) -> Result<PointTable, Refusal> {
    let names: Vec<String> = book.names().map(str::to_owned).collect();
    if let Some(wanted) = wanted {
        let Some(number) = names.iter().position(|name| name == wanted) else {
            return Err(Refusal::Wrong(format!(
                "there is no sheet {wanted:?}; there are {}",
                quoted(names.iter().map(String::as_str))
            )));
        };
        let table = read(book, number).map_err(|reason| format!("sheet {wanted:?}: {reason}"))?;
        let table = table.ok_or_else(|| format!("sheet {wanted:?}: {NO_POINTS}"))?;
        return Ok(table);
    }
    let mut found: Vec<(&str, PointTable)> = Vec::new();
    let mut unreadable: Vec<String> = Vec::new();
    for (number, name) in names.iter().enumerate() {
        match read(book, number) {
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

/// Points of the sheet with this index. `None` if the sheet has no points.
fn read(book: &workbook::Workbook, number: usize) -> Result<Option<PointTable>, String> {
    let sheet = book.sheet(number)?;
    points::read(&sheet)
}

/// Points of both axles of a workbook whose sheet names show one sheet with points for each axle. `None` for other workbooks.
///
/// # Errors
/// One of the two sheets cannot be read, or the sheets state different units or axes.
fn by_axle(book: &workbook::Workbook) -> Result<Option<PointTable>, Refusal> {
    let names: Vec<String> = book.names().map(str::to_owned).collect();
    let mut car = PointTable::default();
    let mut of_axles = Vec::new();
    for axle in [AxlePosition::Front, AxlePosition::Rear] {
        let (mut own, mut unreadable) = (Vec::new(), Vec::new());
        let numbers = (0..names.len()).filter(|number| axle_of(&names[*number]) == Some(axle));
        for number in numbers {
            let place = format!("sheet {:?}", names[number]);
            match read(book, number) {
                Ok(None) => (),
                Ok(Some(table)) => own.push((names[number].as_str(), place, table)),
                Err(reason) => unreadable.push(format!("{place}: {reason}")),
            }
        }
        if let (true, Some(reason)) = (own.is_empty(), unreadable.first()) {
            return Err(Refusal::Wrong(reason.clone()));
        }
        car.left_out.extend(unreadable);
        let [(name, place, table)] = &mut own[..] else {
            return Ok(None);
        };
        if table.axles().iter().any(|own| *own != axle) {
            return Ok(None);
        }
        car.add_axle(std::mem::take(table), axle, place)?;
        of_axles.push(*name);
    }
    let others = names.iter().map(String::as_str);
    let others: Vec<&str> = others.filter(|name| !of_axles.contains(name)).collect();
    let not_read = match others.as_slice() {
        [] => String::new(),
        others => format!("; not read: {}", quoted(others.iter().copied())),
    };
    car.notes.push(format!(
        "sheets {}: one for each axle{not_read}",
        quoted(of_axles.into_iter())
    ));
    Ok(Some(car))
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
