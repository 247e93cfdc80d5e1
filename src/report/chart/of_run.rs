//! Charts of a run: an output, or the same output of both wheels, over a column of the motion.

use super::families::{Family, families, moving_beside, nearest_to_zero};
use super::style::HUES;
use super::{Chart, Fan, Line, Quantity, Source, Wanted};
use crate::curves::Status;
use crate::report::curve_table::CurveTable;
use crate::report::figure::{brief, with_minus_signs};
use crate::report::record::{MotionRecord, OutputRecord, Record, TargetRecord};

/// Largest number of curves per wheel for which every curve has a label.
const MOST_OF_EACH_WHEEL: usize = 3;

/// Outputs that share a chart: one output, or the same output of both wheels.
#[derive(Clone, Debug)]
pub(in crate::report) struct ChartGroup<'r> {
    /// Name of the chart. Each group has its own name.
    pub key: String,
    /// The output of the chart, or the same output of the left and the right wheel.
    pub outputs: Vec<&'r OutputRecord>,
}

impl ChartGroup<'_> {
    /// Column of the first output.
    pub(in crate::report) fn column(&self) -> &str {
        &self.outputs[0].column
    }
}

/// Groups the outputs of a motion by chart: the same output of the left and the right wheel shares one chart.
pub(in crate::report) fn chart_groups(outputs: &[OutputRecord]) -> Vec<ChartGroup<'_>> {
    let mut groups: Vec<ChartGroup> = Vec::new();
    for output in outputs {
        let other = side_of(&output.column).and_then(|(side, name)| {
            groups.iter().position(|group| {
                let known = side_of(group.column());
                group.outputs.len() == 1 && known.is_some_and(|(s, n)| s != side && n == name)
            })
        });
        match other {
            Some(group) => groups[group].outputs.push(output),
            None => groups.push(ChartGroup {
                key: output.column.clone(),
                outputs: vec![output],
            }),
        }
    }
    for group in groups.iter_mut().filter(|g| g.outputs.len() > 1) {
        let name = side_of(&group.key).map_or("", |(_, name)| name);
        // The axle and its wheels may have outputs of the same name, such as roll steer.
        let is_of_axle = outputs.iter().any(|own| own.column == name);
        let more = if is_of_axle { "_of_each_wheel" } else { "" };
        group.key = format!("{name}{more}");
    }
    groups
}

/// Wheel in the name of a column ("left" or "right"), and the name without it. `None` if the name has no wheel.
fn side_of(column: &str) -> Option<(&'static str, &str)> {
    ["left", "right"].into_iter().find_map(|side| {
        let name = column.strip_prefix(side)?.strip_prefix('_')?;
        Some((side, name))
    })
}

/// Curves of a run over one of its motions, as the input of charts.
#[derive(Clone, Copy)]
pub(in crate::report) struct Charted<'r> {
    /// Command of the run.
    pub command: &'r str,
    /// Curves over the motion.
    pub motion: &'r MotionRecord,
    /// Index of the table of the first design. The tables of the other designs follow.
    pub first_table: usize,
    /// Tables with all stations, in which missed targets are looked up. A page may draw fewer stations.
    pub whole: &'r [CurveTable],
}

impl<'r> Charted<'r> {
    /// Curves over the study's own motion, whose tables come first. `whole` has the tables with all stations.
    pub(in crate::report) fn of(record: &'r Record, whole: &'r [CurveTable]) -> Self {
        Charted {
            command: &record.command,
            motion: &record.motion,
            first_table: 0,
            whole,
        }
    }

    /// Curves over the named motions, with the names of the motions. The tables of the study's own motion come first.
    pub(in crate::report) fn of_named(
        record: &'r Record,
        whole: &'r [CurveTable],
    ) -> Vec<(&'r str, Self)> {
        let mut first_table = record.motion.designs.len();
        let named = record.motions.iter().map(|named| {
            let own = Charted {
                motion: &named.motion,
                first_table,
                ..Charted::of(record, whole)
            };
            first_table += named.motion.designs.len();
            (named.name.as_str(), own)
        });
        named.collect()
    }

    /// Tables of the designs.
    fn tables<'t>(&self, all: &'t [CurveTable]) -> &'t [CurveTable] {
        let last = (self.first_table + self.motion.designs.len()).min(all.len());
        &all[self.first_table.min(last)..last]
    }
}

/// Chart of a group of outputs over a column of the motion. `tables` has the tables of all motions.
pub(in crate::report) fn charts_over(
    record: Charted<'_>,
    tables: &[CurveTable],
    group: &ChartGroup<'_>,
    abscissa: &str,
) -> Chart {
    let outputs = &group.outputs;
    let first = outputs[0];
    let tables = record.tables(tables);
    let is_pair = outputs.len() > 1;
    let mut title = title_of(first, is_pair).to_owned();
    // Some names, such as roll steer, denote a quantity of the axle and one of each wheel.
    if is_pair && record.motion.outputs.iter().any(|own| own.title == title) {
        title.push_str(" of each wheel");
    }
    let mut chart = Chart {
        key: group.key.clone(),
        x: Quantity::of_column(abscissa),
        y: Quantity::new(&first.column, &title, &first.unit),
        ..Chart::default()
    };
    for output in outputs {
        let side = side_of(&output.column)
            .filter(|_| is_pair)
            .map(|(side, _)| side);
        chart.add_output(record, tables, &output.column, abscissa, side);
        chart.add_wanted(record, tables, output, abscissa);
    }
    // The most important curves are drawn last, on top of the others.
    chart
        .lines
        .sort_by_key(|line| (line.is_main, line.class.contains("strong")));
    chart.failed = failed(record, tables, abscissa);
    if let Some(positive) = first.positive.as_ref().filter(|p| *p != "always") {
        chart.notes.push(("", format!("positive: {positive}")));
    }
    chart
}

fn title_of(output: &OutputRecord, is_pair: bool) -> &str {
    let title = output.title.as_str();
    if is_pair {
        title
            .trim_start_matches("left ")
            .trim_start_matches("right ")
    } else {
        title
    }
}

/// Curves of one design and one output in a chart. Their CSS classes and labels depend on these common properties.
struct DesignCurves<'a> {
    /// Label of the design in the run.
    design: &'a str,
    /// True for the last design of the run.
    is_last: bool,
    /// True if the chart shows no other design.
    is_alone: bool,
    /// Wheel of the output, if the chart shows both wheels.
    side: Option<&'static str>,
    /// Column of the second moving coordinate. `None` if only one coordinate moves.
    beside: Option<&'a str>,
    /// Number of curves, one for each value of the second moving coordinate.
    count: usize,
    /// True if the run is a tolerance analysis, whose curves show percentiles.
    is_scatter: bool,
}

impl DesignCurves<'_> {
    fn has_several(&self) -> bool {
        self.count > 1
    }

    /// CSS classes for colour and stroke of a curve.
    fn class(&self, family: &Family) -> String {
        let colour = match (self.is_last, self.side, self.has_several()) {
            (true, Some(side), _) => side.to_owned(),
            (true, None, true) => format!("shade{}", family.shade),
            (true, None, false) => "main".to_owned(),
            (false, ..) => "former".to_owned(),
        };
        let stroke = match (self.is_last, family.is_present) {
            (true, true) => " strong",
            (true, false) if self.side.is_some() => " faint",
            (false, false) => " faint",
            _ if self.is_scatter && !self.is_last => " fine",
            _ => "",
        };
        colour + stroke
    }

    /// Label at the end of a curve. `None` if the curve needs no label.
    fn label(&self, family: &Family) -> Option<String> {
        let own = || self.beside.map(|name| in_short(name, family.place));
        let design = || self.design.to_owned();
        match (self.is_last, self.side, self.has_several()) {
            (true, Some(side), _) if family.is_present => Some(side.to_owned()),
            (true, Some(side), _) if self.count <= MOST_OF_EACH_WHEEL => {
                own().map(|own| format!("{} {own}", &side[..1].to_uppercase()))
            }
            (true, Some(_), _) => None,
            (true, None, true) => own(),
            (true, None, false) => (!self.is_alone).then(design),
            (false, side, _) => (family.is_present && side != Some("right")).then(design),
        }
    }

    /// Name of a curve in the list of values at the crosshair.
    fn told(&self, family: &Family) -> String {
        let beside = self.beside.filter(|_| self.has_several());
        let own = beside.map(|name| in_words(name, family.place));
        let names = [self.side.map(str::to_owned), own];
        let main: Vec<String> = names.into_iter().flatten().collect();
        let main = (!main.is_empty()).then(|| main.join(", "));
        match (main, self.is_alone) {
            (Some(main), true) => main,
            (Some(main), false) => format!("{}, {main}", self.design),
            (None, _) => self.design.to_owned(),
        }
    }
}

/// Remark on the second moving coordinate. If the curves are fewer than its `all` values, the remark gives both numbers. If there
/// are several curves whose labels do not name the coordinate, the remark names it. Otherwise there is no remark.
fn family_note(curves: &DesignCurves<'_>, all: usize) -> Option<(&'static str, String)> {
    if all > curves.count {
        let name = curves.beside.map_or("", |name| split(name).0);
        let name = name.replace('_', " ");
        return Some(("", format!("{} of {all} values of {name}", curves.count)));
    }
    // A long column name does not fit into a short label, so a remark contains it instead.
    let name = curves
        .beside
        .filter(|name| curves.has_several() && !has_short_name(name))?;
    let note = format!("one line for each {}", Quantity::of_column(name).name);
    Some(("", note))
}

impl Chart {
    /// Adds the curves of a column, for each design and each value of the second moving coordinate.
    fn add_output(
        &mut self,
        record: Charted<'_>,
        tables: &[CurveTable],
        column: &str,
        abscissa: &str,
        side: Option<&'static str>,
    ) {
        let moving = moving_beside(record.motion, abscissa);
        let designs = &record.motion.designs;
        for (number, (design, table)) in designs.iter().zip(tables).enumerate() {
            let (families, all) = families(&moving, table);
            let curves = DesignCurves {
                design: &design.label,
                is_last: number + 1 == designs.len(),
                is_alone: designs.len() == 1,
                side,
                beside: moving.first().map(|name| name.as_str()),
                count: families.len(),
                is_scatter: record.command == "tolerance",
            };
            if curves.is_last && self.notes.is_empty() {
                self.notes.extend(family_note(&curves, all));
            }
            for family in families {
                let class = curves.class(&family);
                let (label, told) = (curves.label(&family), curves.told(&family));
                let source = Source {
                    table: record.first_table + number,
                    x: abscissa.to_owned(),
                    y: column.to_owned(),
                    rows: family.rows,
                };
                if curves.is_scatter && number < 2 && designs.len() == 5 {
                    // The percentile curves form two pairs around the nominal design: 1 % with 99 %, and 5 % with 95 %.
                    let other = Source {
                        table: record.first_table + 3 - number,
                        ..source.clone()
                    };
                    self.fans.push(Fan {
                        class: "fan",
                        edges: [source.clone(), other],
                    });
                }
                self.lines.push(Line {
                    label,
                    told,
                    class,
                    is_main: curves.is_last && family.is_present,
                    // The page of a sweep can show any design, so each design has a strip of deviations.
                    in_strip: family.is_present && (curves.is_last || record.command == "sweep"),
                    has_dots: false,
                    source,
                });
            }
        }
    }

    /// Adds the targets and bands of an output that apply over this column of the motion.
    fn add_wanted(
        &mut self,
        record: Charted<'_>,
        tables: &[CurveTable],
        output: &OutputRecord,
        abscissa: &str,
    ) {
        let (motion, column) = (record.motion, &output.column);
        let own = motion.targets.iter().filter(|t| t.column == *column);
        for target in own.filter(|t| t.over.as_ref().unwrap_or(&motion.drive) == abscissa) {
            let (points, tolerance) = (target.points.clone(), target.tolerance);
            let limits = points
                .iter()
                .map(|[drive, value]| (*drive, Some(*value), Some(*value)));
            self.missed
                .extend(outside(record, column, limits, tolerance));
            self.wanted.push(Wanted::Values {
                points,
                tolerance,
                column: is_at_zero(target, tables).then(|| column.clone()),
            });
            let note = target
                .held_in_words()
                .map(|held| ("", format!("target at {held}")));
            let note = note.filter(|note| !self.notes.contains(note));
            self.notes.extend(note);
        }
        let bands = motion.bands.iter().filter(|b| b.column == *column);
        for band in bands.filter(|_| motion.drive == abscissa) {
            let limits = band.limits.iter().copied();
            self.missed
                .extend(outside(record, column, limits, band.tolerance));
            self.wanted.push(Wanted::Limits(band.limits.clone()));
        }
    }
}

/// True if the main curves of a chart can be compared with a target. Both must have the same values of the coordinates that the
/// target holds fixed (`target.held`). The main curves have the values nearest to zero.
fn is_at_zero(target: &TargetRecord, tables: &[CurveTable]) -> bool {
    let column = |name: &str| tables.last().and_then(|table| table.column(name));
    let mut held = target.held.iter();
    held.all(|(name, at)| column(name).and_then(nearest_to_zero) == Some(*at))
}

/// Splits a column's name into name and unit.
fn split(column: &str) -> (&str, &str) {
    column.rsplit_once('_').unwrap_or((column, ""))
}

/// Value of a column in words: `rack −30 mm`.
pub(in crate::report) fn in_words(column: &str, value: f64) -> String {
    let unit = Quantity::of_column(column).unit;
    let name = split(column).0.replace('_', " ");
    let words = format!("{name} {} {unit}", brief(value));
    with_minus_signs(words.trim_end())
}

/// Value of a column as a short label: `rack −30 mm`, or `−270 °` if the name is long.
fn in_short(column: &str, value: f64) -> String {
    if has_short_name(column) {
        return in_words(column, value);
    }
    let unit = Quantity::of_column(column).unit;
    with_minus_signs(format!("{} {unit}", brief(value)).trim_end())
}

/// True if labels contain the name of a column.
fn has_short_name(column: &str) -> bool {
    split(column).0.len() <= 5
}

/// Positions on the horizontal axis at which some design has no pose, in rising order.
fn failed(record: Charted<'_>, tables: &[CurveTable], abscissa: &str) -> Vec<f64> {
    let mut failed: Vec<f64> = Vec::new();
    for (_, table) in record.motion.designs.iter().zip(tables) {
        let motion = table.column(abscissa).unwrap_or_default();
        let missing = (motion.iter().zip(&table.status)).filter(|(_, status)| !is_solved(status));
        failed.extend(missing.filter_map(|(value, _)| *value));
    }
    failed.sort_by(f64::total_cmp);
    failed.dedup();
    failed
}

fn is_solved(status: &str) -> bool {
    let solved = [
        Status::Ok,
        Status::IllConditioned,
        Status::Unsupported,
        Status::Toggle([None; 2]),
    ];
    solved.iter().any(|s| s.word() == status)
}

/// Points (drive value, column value) at which the last design of a tuning exceeds `limits` (drive value, minimum, maximum) by more
/// than `tolerance`. A rack that moves must be at 0. Empty for other commands, and if an axle moves in several coordinates.
fn outside(
    record: Charted<'_>,
    column: &str,
    limits: impl Iterator<Item = (f64, Option<f64>, Option<f64>)>,
    tolerance: f64,
) -> Vec<[f64; 2]> {
    // Targets of an axle depend on several coordinates, so only the tables show which targets are missed.
    if record.command != "optimise" || !record.motion.further.is_empty() {
        return Vec::new();
    }
    let column_of = |name: &str| record.tables(record.whole).last()?.column(name);
    let Some((drives, values)) = column_of(&record.motion.drive).zip(column_of(column)) else {
        return Vec::new();
    };
    let racks = record.motion.rack.as_deref().and_then(column_of);
    let ahead = |row: &usize| racks.is_none_or(|racks| racks[*row] == Some(0.0));
    let value_at = |drive: f64| {
        let mut rows = (0..drives.len()).filter(ahead);
        rows.find(|row| drives[*row] == Some(drive))
            .and_then(|row| values[row])
    };
    let places = limits.filter_map(|(drive, low, high)| {
        let value = value_at(drive)?;
        let is_below = low.is_some_and(|low| value < low - tolerance);
        let is_above = high.is_some_and(|high| value > high + tolerance);
        (is_below || is_above).then_some([drive, value])
    });
    places.collect()
}

/// CSS class for the colour of the design with this index. The colours repeat.
pub(in crate::report) fn hue(design: usize) -> String {
    format!("hue{}", design % HUES)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::record::DesignRecord;

    /// A page draws only some stations of a long run. A target that is missed at another station has its mark.
    #[test]
    fn missed_targets_are_marked_at_all_stations() {
        let column = "toe_deg".to_owned();
        let output = OutputRecord {
            column: column.clone(),
            title: "toe".to_owned(),
            unit: "°".to_owned(),
            positive: None,
        };
        let target = TargetRecord {
            column,
            tolerance: 0.1,
            points: vec![[1.0, 0.0], [2.0, 0.0]],
            over: None,
            held: Vec::new(),
        };
        let design = DesignRecord {
            label: "after".to_owned(),
            curves: "curves.csv".to_owned(),
            stations: 4,
            remarks: Vec::new(),
            failures: Vec::new(),
            frames: Vec::new(),
        };
        let motion = MotionRecord {
            drive: "travel_mm".to_owned(),
            abscissae: Vec::new(),
            rack: None,
            further: Vec::new(),
            outputs: vec![output],
            targets: vec![target],
            bands: Vec::new(),
            designs: vec![design],
        };
        let csv = b"travel_mm,toe_deg,status\n0,0,ok\n1,0.5,ok\n2,0.05,ok\n3,0,ok\n";
        let whole = [CurveTable::read(csv).unwrap()];
        let few = [whole[0].thinned(2)];
        let of = Charted {
            command: "optimise",
            motion: &motion,
            first_table: 0,
            whole: &whole,
        };
        let groups = chart_groups(&motion.outputs);
        let chart = charts_over(of, &few, &groups[0], "travel_mm");
        assert_eq!(chart.missed, [[1.0, 0.5]]);
    }
}
