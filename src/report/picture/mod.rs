//! Curves as pictures for documents, on a background of their own, the same bytes every time: SVG, and PNG
//! at twice its size, which is the SVG drawn by `resvg` with its text as outlines.

mod drawn_target;
mod glyphs;
mod labels;
mod lettering;
mod panel;
mod raster;
mod scale;
mod view;

use super::curve_table::CurveTable;
use super::figure::brief;
use super::record::{OutputRecord, Record};
use super::run::{Run, Summary};
use crate::SideEffect;
use crate::curves::Status;
use drawn_target::DrawnTarget;
use lettering::Lettering;
use panel::{Hue, Line, Look, Panel, SIZE};
use view::{Sight, View};

/// A file with a picture.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// `camber_deg.svg`
    pub name: String,
    /// Content of the file.
    pub contents: Vec<u8>,
}

/// Name of the picture with several outputs.
const OVERVIEW: &str = "overview";
/// Name of the drawing of the mechanism.
const MECHANISM: &str = "mechanism";
/// Name of the picture of a tuning: mechanism, targets and side effects, before and after.
const TUNING: &str = "tuning";

/// Number of panels in a row.
const COLUMNS: usize = 3;
/// The most panels of the overview.
const MOST_PANELS: usize = 15;
/// The most targets of the picture of a tuning.
const MOST_TARGETS: usize = 3;
/// The number of panels of the picture of a tuning.
const TUNING_PANELS: usize = 6;
/// Width and height of a view with names.
const NAMED_VIEW: [f64; 2] = [560.0, 560.0];

const STYLE: &str = "text{font:12px system-ui,-apple-system,Segoe UI,Roboto,Helvetica,Arial,sans-serif;fill:#3d454d}\
.label{font-size:13px;fill:#1b1f24}path{fill:none;stroke-linejoin:round;stroke-linecap:round}\
.grid{stroke:#e3e7eb}.main{stroke:#0b63c5;stroke-width:2.2}\
.former{stroke:#8a929b;stroke-width:1.6;stroke-dasharray:6 4}\
.target{stroke:#b45f06;stroke-width:1.3;stroke-dasharray:1 3}.band{fill:#f0cfa6;stroke:#f0cfa6;stroke-width:1}\
.limit,.bar{stroke:#b45f06;stroke-width:1.6}.spot{fill:#b45f06}\
.failed{stroke:#b3261e;stroke-width:1.5}.missed{fill:none;stroke:#b3261e;stroke-width:1.6}\
.rack0{stroke:#0b63c5}.rack1{stroke:#c2570c}.rack2{stroke:#0b8a8a}.rack3{stroke:#b3267a}\
.rack4{stroke:#6b7d00}.rack5{stroke:#7a4fc9}.rack6{stroke:#8a5a2b}";

/// Largest number of rack positions named in a legend.
const MOST_NAMED: usize = 5;

/// Looks that few pictures need: colours of more lines than `rack0` to `rack6` have, from one end to the other, and the
/// dots of inner percentiles.
const RARE: &str = ".inner{stroke-dasharray:1 4}.shade0{stroke:#b45f06}.shade1{stroke:#9f602c}.shade2{stroke:#8a6052}\
.shade3{stroke:#756179}.shade4{stroke:#60619f}.shade5{stroke:#4a62c5}.shade6{stroke:#3549a8}\
.shade7{stroke:#21308a}.shade8{stroke:#0c176d}";

/// Style of letters as outlines.
const LETTERS: &str = ".letters{fill:#3d454d}.letters.label{fill:#1b1f24}";

/// Names of the pictures of a run that has this record.
pub fn picture_names(record: &Record) -> Vec<String> {
    let outputs = record.outputs.iter();
    let mut names: Vec<String> = outputs.map(|o| file_name(&o.column)).collect();
    names.extend((!names.is_empty()).then(|| OVERVIEW.to_owned()));
    names.push(MECHANISM.to_owned());
    names.extend((record.command == "optimise").then(|| TUNING.to_owned()));
    let files = |name: &String| ["svg", "png"].map(|kind| format!("{name}.{kind}"));
    names.iter().flat_map(files).collect()
}

/// A part of a sheet.
enum Cell<'r> {
    Panel(Box<Panel>),
    View(View<'r>),
    /// Explanation of the lines of the views.
    Key(&'r Record),
}

/// A picture: equal cells in rows.
struct Sheet<'r> {
    name: String,
    columns: usize,
    cell: [f64; 2],
    cells: Vec<Cell<'r>>,
}

impl<'r> Sheet<'r> {
    fn of_panels(name: String, panels: impl IntoIterator<Item = Panel>) -> Self {
        let cells = panels.into_iter().map(|panel| Cell::Panel(Box::new(panel)));
        Sheet {
            name,
            columns: COLUMNS,
            cell: SIZE,
            cells: cells.collect(),
        }
    }

    /// The drawing with the names of the points.
    fn mechanism(record: &'r Record) -> Self {
        let views = Sight::ALL.map(|sight| View::of(record, sight, true, NAMED_VIEW));
        let views = views.into_iter().flatten().map(Cell::View);
        Sheet {
            name: MECHANISM.to_owned(),
            columns: 2,
            cell: NAMED_VIEW,
            cells: views.chain([Cell::Key(record)]).collect(),
        }
    }

    /// Mechanism, targets and side effects of a tuning.
    fn tuning(run: &'r Run) -> Self {
        let record = &run.record;
        let flagged: Vec<String> = match &run.summary {
            Summary::Optimise(tuning) => {
                let flagged = tuning.side_effects.iter().filter(|e| e.flagged);
                flagged.map(SideEffect::column).collect()
            }
            Summary::Solve(_) | Summary::Tolerance(_) => Vec::new(),
        };
        let outputs = record.outputs.iter();
        let targets: Vec<&OutputRecord> = outputs.filter(|o| has_target(record, o)).collect();
        // The columns of an axle also name the wheel.
        let is_flagged = |o: &&OutputRecord| {
            let column = o
                .column
                .trim_start_matches("left_")
                .trim_start_matches("right_");
            !has_target(record, o) && flagged.iter().any(|name| name == column)
        };
        let targets = targets.into_iter().take(MOST_TARGETS);
        let mut panels: Vec<Panel> = targets.map(|o| panel(run, o)).collect();
        for output in record.outputs.iter().filter(is_flagged) {
            if panels.len() + 1 < TUNING_PANELS {
                let mut side_effect = panel(run, output);
                side_effect.value = format!("side effect: {}", side_effect.value);
                panels.push(side_effect);
            }
        }
        let rest = COLUMNS - panels.len() % COLUMNS;
        let views = Sight::ALL.into_iter().take(rest);
        let views = views.filter_map(|sight| View::of(record, sight, false, SIZE));
        let panels = panels.into_iter().map(|panel| Cell::Panel(Box::new(panel)));
        Sheet {
            name: TUNING.to_owned(),
            columns: COLUMNS,
            cell: SIZE,
            cells: views.map(Cell::View).chain(panels).collect(),
        }
    }

    /// The picture, in rows.
    fn svg(&self, style: &str, lettering: &Lettering) -> String {
        // Legends of many rows need more height; all plots of a sheet stand in line.
        let panels = self.cells.iter().filter_map(|cell| match cell {
            Cell::Panel(panel) => Some(panel.legend_beyond()),
            Cell::View(_) | Cell::Key(_) => None,
        });
        let lower = panels.fold(0.0, f64::max);
        let columns = self.columns.min(self.cells.len()).max(1);
        let rows = self.cells.len().div_ceil(columns);
        let row = self.cell[1] + lower;
        let [width, height] = [self.cell[0] * columns as f64, row * rows as f64];
        let mut svg = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" width=\"{width}\" \
             height=\"{height}\">\n<style>{style}</style>\n<rect width=\"{width}\" height=\"{height}\" \
             rx=\"6\" fill=\"#ffffff\"/>\n"
        );
        for (number, cell) in self.cells.iter().enumerate() {
            let (column, above) = (number % columns, (number / columns) as f64 * row);
            let shift = [column as f64 * self.cell[0], above];
            let lowered = [shift[0], above + lower];
            svg += &match cell {
                Cell::Panel(panel) => panel.svg(lowered, lettering),
                Cell::View(view) => view.svg(lowered, lettering),
                Cell::Key(record) => view::key(record, shift, lettering),
            };
        }
        svg + "</svg>\n"
    }

    /// Styles of the parts.
    fn style(&self) -> String {
        let is_rare = |cell: &Cell| matches!(cell, Cell::Panel(p) if p.has_rare_looks());
        let is_view = |cell: &Cell| matches!(cell, Cell::View(_));
        let mut style = STYLE.to_owned();
        if self.cells.iter().any(is_rare) {
            style += RARE;
        }
        if self.cells.iter().any(is_view) {
            style += view::STYLE;
        }
        style
    }

    /// The files of the picture.
    fn files(&self, outlines: &Lettering) -> [Picture; 2] {
        let style = self.style();
        let svg = self.svg(&style, &Lettering::Text);
        let png = raster::png(&self.svg(&[style.as_str(), LETTERS].concat(), outlines));
        let file = |kind: &str, contents| Picture {
            name: format!("{}.{kind}", self.name),
            contents,
        };
        [file("svg", svg.into_bytes()), file("png", png)]
    }
}

fn has_target(record: &Record, output: &OutputRecord) -> bool {
    let targets = record.targets.iter().map(|t| &t.column);
    let bands = record.bands.iter().map(|b| &b.column);
    targets.chain(bands).any(|column| *column == output.column)
}

/// A picture for each output; `overview` with those that have targets side by side (all, where none has); `mechanism`; for a
/// tuning also `tuning`. Each as SVG and as PNG.
pub fn pictures(run: &Run) -> Vec<Picture> {
    let record = &run.record;
    let outputs = &record.outputs;
    let alone = |o: &OutputRecord| Sheet::of_panels(file_name(&o.column), [panel(run, o)]);
    let mut sheets: Vec<Sheet> = outputs.iter().map(alone).collect();
    let chosen = outputs.iter().filter(|o| has_target(record, o));
    let mut chosen: Vec<&OutputRecord> = chosen.collect();
    if chosen.is_empty() {
        chosen = outputs.iter().collect();
    }
    if !chosen.is_empty() {
        let panels = chosen.into_iter().take(MOST_PANELS);
        let panels = panels.map(|output| panel(run, output));
        sheets.push(Sheet::of_panels(OVERVIEW.to_owned(), panels));
    }
    sheets.push(Sheet::mechanism(record));
    if record.command == "optimise" {
        sheets.push(Sheet::tuning(run));
    }
    let outlines = Lettering::outlines();
    let files = sheets.iter().flat_map(|sheet| sheet.files(&outlines));
    files.collect()
}

fn panel(run: &Run, output: &OutputRecord) -> Panel {
    let record = &run.record;
    let by_time = record.abscissae.iter().find(|a| *a == "time_s");
    let natural = record.natural_abscissa(&output.column);
    let abscissa = by_time.map_or(natural, String::as_str);
    let moving = moving_beside(record, abscissa);
    let mut lines = Vec::new();
    let mut failed = Vec::new();
    for (design_number, (design, table)) in record.designs.iter().zip(&run.curves).enumerate() {
        let main = design_number + 1 == record.designs.len();
        let families = families(&moving, table);
        let apart = moving.first();
        let (apart_name, _) = apart.map_or(("rack", ""), |name| split(name));
        let apart_name = apart_name.replace('_', " ");
        for (number, family) in families.iter().enumerate() {
            let several = families.len() > 1;
            let rack = apart.and_then(|name| table.column(name));
            let rack = rack.and_then(|racks| racks[family[0]]).unwrap_or(0.0);
            // If there are more rack positions than colours, the legend names every n-th.
            let named = number.is_multiple_of(families.len().div_ceil(MOST_NAMED));
            lines.push(Line {
                name: match (several, main) {
                    (false, _) => Some(design.label.clone()),
                    (true, true) => named.then(|| format!("{apart_name} {}", brief(rack))),
                    (true, false) => (number == 0).then(|| format!("{} (dashed)", design.label)),
                },
                look: Look {
                    main,
                    hue: several.then(|| Hue::of(number, families.len())),
                    is_inner: is_inner(design_number, record.designs.len()),
                },
                points: points(table, family, abscissa, &output.column),
            });
        }
        let motion = table.column(abscissa).unwrap_or_default();
        let missing = (motion.iter().zip(&table.status)).filter(|(_, status)| !is_solved(status));
        failed.extend(missing.filter_map(|(value, _)| *value));
    }
    // The curves that matter come first in the legend, and are drawn last.
    lines.sort_by_key(|line: &Line| line.look.main);
    failed.sort_by(f64::total_cmp);
    failed.dedup();
    let mut wanted = Vec::new();
    let mut missed = Vec::new();
    for target in record.targets.iter().filter(|t| t.column == output.column) {
        if target.over.as_ref().unwrap_or(&record.drive) == abscissa {
            let (points, tolerance) = (target.points.clone(), target.tolerance);
            let limits = points
                .iter()
                .map(|[drive, value]| (*drive, Some(*value), Some(*value)));
            missed.extend(places_outside(run, &output.column, limits, tolerance));
            wanted.push(DrawnTarget::Values { points, tolerance });
        }
    }
    for band in record.bands.iter().filter(|b| b.column == output.column) {
        let limits = band.limits.iter().copied();
        missed.extend(places_outside(run, &output.column, limits, band.tolerance));
        wanted.push(DrawnTarget::Limits(band.limits.clone()));
    }
    // Targets are by drive value.
    if by_time.is_some() {
        (wanted, missed) = Default::default();
    }
    Panel {
        value: with_unit(&output.title, &output.unit),
        motion: axis_title(abscissa),
        upright: by_time.is_none(),
        lines,
        wanted,
        missed,
        failed,
    }
}

/// Whether a design is of the inner of two pairs of percentiles, which stand about the last design in order.
fn is_inner(design: usize, designs: usize) -> bool {
    designs == 5 && (design == 1 || design == 2)
}

/// Columns of what moves beside the abscissa: the rack of a wheel, of an axle what else it has.
fn moving_beside<'r>(record: &'r Record, abscissa: &str) -> Vec<&'r String> {
    let drive = (!record.further.is_empty()).then_some(&record.drive);
    let all = drive.into_iter().chain(&record.further).chain(&record.rack);
    all.filter(|name| *name != abscissa).collect()
}

/// Rows by the first column of what moves beside the abscissa, the rest nearest to zero.
fn families(moving: &[&String], table: &CurveTable) -> Vec<Vec<usize>> {
    let mut columns = moving.iter().filter_map(|name| table.column(name));
    let apart = columns.next();
    let held: Vec<_> = columns
        .map(|values| {
            let known = values.iter().flatten().copied();
            (values, known.min_by(|a, b| a.abs().total_cmp(&b.abs())))
        })
        .collect();
    let mut families: Vec<(Option<f64>, Vec<usize>)> = Vec::new();
    for row in 0..table.rows() {
        if held.iter().any(|(values, value)| values[row] != *value) {
            continue;
        }
        let place = apart.and_then(|values| values[row]);
        match families.iter_mut().find(|(known, _)| *known == place) {
            Some((_, rows)) => rows.push(row),
            None => families.push((place, vec![row])),
        }
    }
    families.into_iter().map(|(_, rows)| rows).collect()
}

/// Places at which the last design of a tuning exceeds limits by more than the tolerance: drive value and value of
/// the column. The rack is at 0 or at the study's position. A limit has a drive value, a minimum and a maximum.
fn places_outside(
    run: &Run,
    column: &str,
    limits: impl Iterator<Item = (f64, Option<f64>, Option<f64>)>,
    tolerance: f64,
) -> Vec<[f64; 2]> {
    let Some(table) = run
        .curves
        .last()
        .filter(|_| run.record.command == "optimise")
    else {
        return Vec::new();
    };
    let racks = run.record.rack.as_ref().and_then(|name| table.column(name));
    let ahead = |row: &usize| racks.is_none_or(|racks| racks[*row] == Some(0.0));
    if !run.record.further.is_empty() {
        // Targets of an axle are over several numbers; the tables say which are missed.
        return Vec::new();
    }
    let columns = table.column(&run.record.drive).zip(table.column(column));
    let Some((drives, values)) = columns else {
        return Vec::new();
    };
    let value_at = |drive: f64| {
        let mut rows = (0..table.rows()).filter(ahead);
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

fn points(table: &CurveTable, rows: &[usize], motion: &str, value: &str) -> Vec<Option<[f64; 2]>> {
    let (Some(motion), Some(value)) = (table.column(motion), table.column(value)) else {
        return Vec::new();
    };
    let rows = rows.iter();
    rows.map(|row| Some([motion[*row]?, value[*row]?]))
        .collect()
}

fn with_unit(title: &str, unit: &str) -> String {
    match unit {
        "" => title.to_owned(),
        unit => format!("{title} [{unit}]"),
    }
}

/// A column's name and its unit.
fn split(column: &str) -> (&str, &str) {
    column.rsplit_once('_').unwrap_or((column, ""))
}

/// `travel_mm` -> `wheel travel [mm]`
fn axis_title(column: &str) -> String {
    let (name, unit) = split(column);
    let name = match name {
        "travel" => "wheel travel".to_owned(),
        name => name.replace('_', " "),
    };
    with_unit(&name, if unit == "deg" { "°" } else { unit })
}

/// A column's name as that of a file: points may be called anything.
fn file_name(column: &str) -> String {
    let kept = |c: char| match c.is_alphanumeric() || "_-.".contains(c) {
        true => c,
        false => '_',
    };
    let name: String = column.chars().map(kept).collect();
    name.trim_start_matches('.').to_owned()
}
fn is_solved(status: &str) -> bool {
    [
        Status::Ok,
        Status::IllConditioned,
        Status::Unsupported,
        Status::Toggle([None; 2]),
    ]
    .map(|s| s.word())
    .contains(&status)
}
