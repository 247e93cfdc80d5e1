//! Pictures of curves and of the mechanism for documents, with their own background. Equal runs give identical files. The formats
//! are SVG and PNG. The PNG has two pixels per unit of the SVG: `resvg` draws the SVG, with its text as outlines.

mod labels;
mod raster;
mod view;

use super::chart::{
    ChartGroup, Charted, Layout, Lettering, SIZE, chart_groups, charts_over, picture_style,
};
use super::curve_table::CurveTable;
use super::record::Record;
use super::run::{Run, Summary};
use super::scene::Sight;
use crate::SideEffect;
use serde::Serialize;
use std::iter;
use view::View;

/// A file with a picture.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// Name of the file, such as `camber_deg.svg`.
    pub name: String,
    /// Content of the file.
    pub contents: Vec<u8>,
}

/// Name of the picture that shows several outputs together.
const OVERVIEW: &str = "overview";
/// Name of the drawing of the mechanism.
const MECHANISM: &str = "mechanism";
/// Name of the picture of a tuning: mechanism, targets and side effects, before and after.
const TUNING: &str = "tuning";

/// Number of panels in a row.
const COLUMNS: usize = 3;
/// Largest number of panels of the overview.
const MOST_PANELS: usize = 15;
/// Width and height of a view with names.
const NAMED_VIEW: [f64; 2] = [560.0, 560.0];

/// Name of the file with the layouts of all charts.
const LAYOUTS: &str = "charts.json";

/// Style of the views of the mechanism.
const STYLE: &str = "text{font:12px system-ui,-apple-system,Segoe UI,Roboto,Helvetica,Arial,sans-serif;fill:#3d454d}\
.label{font-size:13px;fill:#1b1f24}path{fill:none;stroke-linejoin:round;stroke-linecap:round}";

/// Style of letters that are drawn as outlines.
const LETTERS: &str = ".letters{fill:#3d454d}.letters.label{fill:#1b1f24}.axis-text,.note,.end,.name{fill:currentColor}";

/// Names of the pictures of a run with this record.
pub fn picture_names(record: &Record) -> Vec<String> {
    let motions = MotionCharts::all(record, &[]);
    let mut names: Vec<String> = Vec::new();
    for motion in &motions {
        names.extend(motion.names.iter().cloned());
        names.extend(motion.overview_name());
    }
    names.push(MECHANISM.to_owned());
    names.extend((record.command == "optimise").then(|| TUNING.to_owned()));
    let files = |name: &String| ["svg", "png"].map(|kind| format!("{name}.{kind}"));
    let files = names.iter().flat_map(files);
    files.chain([LAYOUTS.to_owned()]).collect()
}

/// Charts of one motion of a run.
struct MotionCharts<'r> {
    /// Name of the motion. Empty for the study's own motion.
    motion: &'r str,
    of: Charted<'r>,
    groups: Vec<ChartGroup<'r>>,
    /// Names of the charts' files, without extension. The names of a named motion begin with its name.
    names: Vec<String>,
}

impl<'r> MotionCharts<'r> {
    /// Charts of the study's own motion, then of its named motions. `tables` has the tables of all motions.
    fn all(record: &'r Record, tables: &'r [CurveTable]) -> Vec<Self> {
        let mut taken = Vec::new();
        let own = iter::once(("", Charted::of(record, tables)));
        let motions = own.chain(Charted::of_named(record, tables));
        let charts = motions.map(|(motion, of)| {
            let groups = chart_groups(&of.motion.outputs);
            let names = groups.iter().map(|group| in_motion(motion, &group.key));
            MotionCharts {
                motion,
                of,
                names: names.map(|name| free_name(name, &mut taken)).collect(),
                groups,
            }
        });
        charts.collect()
    }

    /// Name of the picture with several outputs. `None` without outputs.
    fn overview_name(&self) -> Option<String> {
        (!self.groups.is_empty()).then(|| in_motion(self.motion, OVERVIEW))
    }

    /// Layouts of all charts. `tables` has the tables of all motions.
    fn layouts(&self, tables: &[CurveTable]) -> Vec<Layout> {
        let groups = self.groups.iter();
        groups.map(|group| self.layout(group, tables)).collect()
    }

    /// Chart of a group of outputs over the usual column of its horizontal axis. A chart of a named motion begins with the name of
    /// the motion.
    fn layout(&self, group: &ChartGroup<'_>, tables: &[CurveTable]) -> Layout {
        let abscissa = self.of.motion.usual_abscissa(group.column());
        let mut chart = charts_over(self.of, tables, group, abscissa);
        chart.key = in_motion(self.motion, &group.key);
        let layout = chart.layout(tables);
        match self.motion {
            "" => layout,
            motion => layout.named(&format!("motion {motion}: ")),
        }
    }

    /// True if a target or a band applies to an output of the group.
    fn has_target(&self, group: &ChartGroup<'_>) -> bool {
        let targets = self.of.motion.targets.iter().map(|t| &t.column);
        let mut columns = targets.chain(self.of.motion.bands.iter().map(|b| &b.column));
        columns.any(|column| group.outputs.iter().any(|o| o.column == *column))
    }

    /// Picture of each chart, and the overview. `layouts` has the layouts of the charts.
    fn sheets(&self, layouts: &[Layout]) -> Vec<Sheet<'r>> {
        let alone =
            |(name, layout): (&String, &Layout)| Sheet::of_charts(name.clone(), [layout.clone()]);
        let mut sheets: Vec<Sheet> = self.names.iter().zip(layouts).map(alone).collect();
        let numbered = self.groups.iter().zip(layouts);
        let chosen = numbered.filter(|(group, _)| self.has_target(group));
        let mut chosen: Vec<&Layout> = chosen.map(|(_, layout)| layout).collect();
        if chosen.is_empty() {
            chosen = layouts.iter().collect();
        }
        let charts = chosen.into_iter().take(MOST_PANELS).cloned();
        let overview = self.overview_name();
        sheets.extend(overview.map(|name| Sheet::of_charts(name, charts)));
        sheets
    }
}

/// Content of one cell (panel) of a picture.
enum Cell<'r> {
    Chart(Box<Layout>),
    View(View<'r>),
    /// Legend of the lines in the views.
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
    fn of_charts(name: String, charts: impl IntoIterator<Item = Layout>) -> Self {
        let cells = charts.into_iter().map(|chart| Cell::Chart(Box::new(chart)));
        Sheet {
            name,
            columns: COLUMNS,
            cell: SIZE,
            cells: cells.collect(),
        }
    }

    /// Picture of the mechanism in front, side and top view, with the names of its points.
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

    /// Picture of a tuning: mechanism, all targets, and all side effects beyond their tolerances.
    fn tuning(run: &'r Run) -> Self {
        let record = &run.record;
        let flagged: Vec<String> = match &run.summary {
            Summary::Optimise(tuning) => {
                let flagged = tuning.side_effects.iter().filter(|e| e.flagged);
                flagged.map(SideEffect::column).collect()
            }
            Summary::Solve(_) | Summary::Tolerance(_) => Vec::new(),
        };
        let motions = MotionCharts::all(record, &run.curves);
        let layout = |of: &MotionCharts, group: &ChartGroup| of.layout(group, &run.curves);
        let targets = motions.iter().flat_map(|of| {
            let wanted = of.groups.iter().filter(|group| of.has_target(group));
            wanted.map(|group| layout(of, group))
        });
        // The columns of an axle begin with the name of the wheel. The names of side effects do not.
        let own = &motions[0];
        let is_flagged = |group: &&ChartGroup| {
            let column = group.column().trim_start_matches("left_");
            let column = column.trim_start_matches("right_");
            !own.has_target(group) && flagged.iter().any(|name| name == column)
        };
        let effects = own.groups.iter().filter(is_flagged);
        let effects = effects.map(|group| layout(own, group).named("side effect: "));
        let charts: Vec<Layout> = targets.chain(effects).collect();
        let rest = COLUMNS - charts.len() % COLUMNS;
        let views = Sight::ALL.into_iter().take(rest);
        let views = views.filter_map(|sight| View::of(record, sight, false, SIZE));
        let charts = charts.into_iter().map(|chart| Cell::Chart(Box::new(chart)));
        Sheet {
            name: TUNING.to_owned(),
            columns: COLUMNS,
            cell: SIZE,
            cells: views.map(Cell::View).chain(charts).collect(),
        }
    }

    /// SVG of the picture.
    fn svg(&self, style: &str, lettering: &Lettering) -> String {
        let columns = self.columns.min(self.cells.len()).max(1);
        let rows = self.cells.len().div_ceil(columns);
        let row = self.cell[1];
        let [width, height] = [self.cell[0] * columns as f64, row * rows as f64];
        let mut svg = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" width=\"{width}\" \
             height=\"{height}\">\n<style>{style}</style>\n<rect width=\"{width}\" height=\"{height}\" \
             rx=\"6\" fill=\"#ffffff\"/>\n"
        );
        for (number, cell) in self.cells.iter().enumerate() {
            let (column, above) = (number % columns, (number / columns) as f64 * row);
            let shift = [column as f64 * self.cell[0], above];
            svg += &match cell {
                Cell::Chart(chart) => chart.group(shift, lettering),
                Cell::View(view) => view.svg(shift, lettering),
                Cell::Key(record) => view::key(record, shift, lettering),
            };
        }
        svg + "</svg>\n"
    }

    /// CSS styles for the parts that the picture contains.
    fn style(&self) -> String {
        let is_view = |cell: &Cell| !matches!(cell, Cell::Chart(_));
        let mut style = String::new();
        if self.cells.iter().any(is_view) {
            style = [STYLE, view::STYLE].concat();
        }
        style + &picture_style()
    }

    /// Files of the picture, as SVG and PNG.
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

/// Content of `charts.json`.
#[derive(Serialize)]
struct Layouts<'a> {
    /// Names of the files with the curves. A table index in a layout refers to this list.
    tables: Vec<&'a str>,
    charts: Vec<&'a Layout>,
}

/// Makes the pictures of a run, each as SVG and as PNG:
///
/// - one for each output, or for the same output of both wheels;
/// - `overview` with the outputs that have targets, or with all outputs if there are no targets;
/// - the same pictures for each named motion; their names begin with the name of the motion;
/// - `mechanism`;
/// - for a tuning also `tuning`.
///
/// `charts.json` has the layouts of all charts.
pub fn pictures(run: &Run) -> Vec<Picture> {
    let record = &run.record;
    let motions = MotionCharts::all(record, &run.curves);
    let mut sheets = Vec::new();
    let mut layouts = Vec::new();
    for motion in &motions {
        let own = motion.layouts(&run.curves);
        sheets.extend(motion.sheets(&own));
        layouts.extend(own);
    }
    sheets.push(Sheet::mechanism(record));
    if record.command == "optimise" {
        sheets.push(Sheet::tuning(run));
    }
    let outlines = Lettering::outlines();
    let files = sheets.iter().flat_map(|sheet| sheet.files(&outlines));
    let data = Layouts {
        tables: motions
            .iter()
            .flat_map(|motion| &motion.of.motion.designs)
            .map(|design| design.curves.as_str())
            .collect(),
        charts: layouts.iter().collect(),
    };
    let json = Picture {
        name: LAYOUTS.to_owned(),
        contents: serde_json::to_vec(&data).expect("the layouts contain only numbers and text"),
    };
    files.chain([json]).collect()
}

/// Name of a chart of a motion. The chart of a named motion begins with the name of the motion.
fn in_motion(motion: &str, chart: &str) -> String {
    match motion {
        "" => chart.to_owned(),
        motion => format!("{motion}_{chart}"),
    }
}

/// File name of a chart that differs from the names in `taken`. Names that differ only in letter case count as equal.
fn free_name(chart: String, taken: &mut Vec<String>) -> String {
    let name = file_name(&chart);
    let numbered = (2..).map(|number| format!("{name}_{number}"));
    let mut all = iter::once(name.clone()).chain(numbered);
    let name = all.find(|name| !taken.contains(&name.to_lowercase()));
    let name = name.expect("there is always another number");
    taken.push(name.to_lowercase());
    name
}

/// File name for a column. Names of points may contain any characters.
fn file_name(column: &str) -> String {
    let kept = |c: char| {
        if c.is_alphanumeric() || "_-.".contains(c) {
            c
        } else {
            '_'
        }
    };
    let name: String = column.chars().map(kept).collect();
    name.trim_start_matches('.').to_owned()
}
