//! Side effects of a tuning, as tables and in words.

use super::figure::{as_written, brief, has_digits, with_decimals, with_plus};
use super::table::{Cell, Column, Table};
use super::text::counted;
use crate::{PlaceCoordinate, SideEffect};

/// Significant digits for an output without a tolerance.
const DIGITS: f64 = 3.0;
/// Largest number of side effects in the table on the terminal. If more side effects are flagged, all flagged ones are shown.
const MOST_ROWS: usize = 10;

/// Number of decimals for values with this tolerance: one more than the first digit of the tolerance needs.
pub(super) fn decimals_beside(tolerance: f64) -> usize {
    (1.0 + (-tolerance.log10()).ceil()).clamp(0.0, 9.0) as usize
}

/// Range of values in words: `-1.5 .. 2.0`. A single value if both ends have the same digits.
pub(super) fn range_in_words(ends: [f64; 2], decimals: usize) -> String {
    let [low, high] = ends.map(|end| with_decimals(end, decimals));
    if low == high {
        low
    } else {
        format!("{low} .. {high}")
    }
}

/// Number of decimals for the values of a side effect, as in [`decimals_beside`]. Without a tolerance, the largest value has three
/// significant digits.
fn decimals(effect: &SideEffect) -> usize {
    let ends = [
        effect.before_min,
        effect.before_max,
        effect.after_min,
        effect.after_max,
    ];
    let magnitude = ends
        .iter()
        .flatten()
        .fold(0.0, |most: f64, v| most.max(v.abs()));
    let decimals = match effect.tolerance {
        Some(tolerance) => return decimals_beside(tolerance),
        None if magnitude > 0.0 => DIGITS - 1.0 - magnitude.log10().floor(),
        None => 0.0,
    };
    decimals.clamp(0.0, 9.0) as usize
}

/// Tolerance with three significant digits: 1 mm is 0.0394 in.
fn in_three_digits(tolerance: f64) -> String {
    let digits = 10f64.powi(2 - tolerance.abs().log10().floor() as i32);
    brief((tolerance * digits).round() / digits)
}

/// Largest change of the output that no target requests, as text with its sign. `None` without such a change.
fn change(effect: &SideEffect) -> Option<String> {
    let change = effect.largest_change?;
    let text = with_decimals(change, decimals(effect));
    Some(with_plus(change, text))
}

/// True if a side effect is flagged, or if the printed text shows a change that no target requests.
pub(super) fn is_visible(effect: &SideEffect) -> bool {
    effect.flagged || has_digits(&change(effect).unwrap_or_default())
}

/// True if the printed text shows a change that targets request, and no other change.
fn is_as_asked(effect: &SideEffect) -> bool {
    !is_visible(effect) && has_digits(&with_decimals(effect.asked_change, decimals(effect)))
}

/// Station of the largest change, such as `roll 3 deg, heave -40 mm, left wheel` or `skid_pad, front left wheel`.
fn place(effect: &SideEffect) -> String {
    let coordinate = |c: &PlaceCoordinate| {
        let name = c.name.replace('_', " ");
        format!("{name} {} {}", as_written(c.value), c.unit)
    };
    let wheel = effect.wheel.iter();
    let wheel = wheel.map(|wheel| format!("{} wheel", wheel.replace('_', " ")));
    let case = effect.case.iter().cloned();
    let coordinates = case.chain(effect.at.iter().map(coordinate));
    coordinates.chain(wheel).collect::<Vec<_>>().join(", ")
}

/// Station of the largest change in a short form. If wheel travel is the only coordinate of a single wheel, its name is left out.
/// Otherwise, coordinates that are 0 are left out. If all coordinates are 0, the first one remains.
fn short_place(effect: &SideEffect) -> String {
    match (effect.at.as_slice(), &effect.wheel) {
        ([only], None) if only.name == "travel" => {
            format!("{} {}", as_written(only.value), only.unit)
        }
        (all, _) => {
            let away = || all.iter().filter(|c| c.value != 0.0);
            let at = match away().next() {
                Some(_) => away().cloned().collect(),
                None => all[..all.len().min(1)].to_vec(),
            };
            place(&SideEffect {
                at,
                ..effect.clone()
            })
        }
    }
}

/// Table with one row per side effect. `side_effects.csv` contains this table.
pub fn side_effects_table(effects: &[SideEffect]) -> Table {
    let columns = [
        Column::for_readers("side effect"),
        Column::for_programs("output"),
        Column::for_programs("unit"),
        Column::for_readers("before"),
        Column::for_readers("after"),
        Column::for_readers("unasked"),
        Column::for_readers("tolerance"),
        Column::for_readers("at"),
    ];
    let programs = [
        "before min",
        "before max",
        "after min",
        "after max",
        "largest change",
        "at",
        "tolerance",
        "flagged",
        "lost",
    ];
    let programs = programs.map(Column::for_programs);
    let columns = columns.into_iter().chain(programs);
    let mut table = Table::with_columns(columns);
    for effect in effects {
        let decimals = decimals(effect);
        let range = |ends: [Option<f64>; 2]| match ends {
            [Some(low), Some(high)] => Cell::from(range_in_words([low, high], decimals)),
            _ => Cell::from("no value"),
        };
        let tolerance = effect.tolerance.map(in_three_digits);
        let tolerance = match (effect.flagged, effect.lost) {
            (true, 0) => tolerance.map(|tolerance| format!("{tolerance} exceeded")),
            (true, lost) => Some(format!("no value at {}", counted(lost, "station"))),
            (false, _) => tolerance,
        };
        table.push_row([
            Cell::from(effect.column()),
            effect.output.as_str().into(),
            effect.unit.as_str().into(),
            range([effect.before_min, effect.before_max]),
            range([effect.after_min, effect.after_max]),
            change(effect).into(),
            tolerance.into(),
            short_place(effect).into(),
            effect.before_min.into(),
            effect.before_max.into(),
            effect.after_min.into(),
            effect.after_max.into(),
            effect.largest_change.into(),
            place(effect).into(),
            effect.tolerance.into(),
            effect.flagged.into(),
            effect.lost.into(),
        ]);
    }
    table
}

/// Side effects that are flagged, then others whose printed text shows a change that no target requests.
pub fn visible_side_effects(effects: &[SideEffect]) -> Vec<SideEffect> {
    let mut changed: Vec<SideEffect> = effects.iter().filter(|e| is_visible(e)).cloned().collect();
    changed.sort_by_key(|effect| !effect.flagged);
    changed
}

/// Side effects that tables show: first all flagged ones, then other visible changes up to 10 rows. Also returns the number
/// of visible changes that are left out.
pub fn shown_side_effects(effects: &[SideEffect]) -> (Vec<SideEffect>, usize) {
    let changed = visible_side_effects(effects);
    let flagged = changed.iter().filter(|e| e.flagged).count();
    let shown = changed.len().min(MOST_ROWS.max(flagged));
    let more = changed.len() - shown;
    (changed.into_iter().take(shown).collect(), more)
}

/// Number of flagged side effects, in words. `None` if no output was compared.
pub fn side_effects_in_words(effects: &[SideEffect]) -> Option<String> {
    if effects.is_empty() {
        return None;
    }
    let flagged = effects.iter().filter(|e| e.flagged).count();
    Some(match flagged {
        0 => "no side effect beyond its tolerance".to_owned(),
        1 => "1 side effect beyond its tolerance".to_owned(),
        several => format!("{several} side effects beyond their tolerances"),
    })
}

/// One line with the outputs that change only as targets request, and one line with the outputs without a visible change. A line
/// without outputs is left out.
pub fn further_in_words(effects: &[SideEffect]) -> Vec<String> {
    let line = |heading: &str, is_in: &dyn Fn(&SideEffect) -> bool| {
        let names = effects.iter().filter(|e| is_in(e)).map(SideEffect::column);
        let names: Vec<String> = names.collect();
        (!names.is_empty()).then(|| format!("{heading}: {}", names.join("; ")))
    };
    let as_asked = line("as targets ask", &is_as_asked);
    let unchanged = line("unchanged", &|e| !is_visible(e) && !is_as_asked(e));
    as_asked.into_iter().chain(unchanged).collect()
}
