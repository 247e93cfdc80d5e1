//! Results of rig tests on one wheel: `kc.csv`, `levels.csv`, `compliance_matrix.csv` and the table of the terminal.

use super::shortest;
use super::table::{Cell, Table};
use crate::ask::Unit;
use crate::compliance::{
    BushingReading, HeldQuantity, KcFigure, KcLevel, KcOutcome, KcState, KcStation, KcTest, Motion,
    NoEquilibrium, TestLoad, TestPlace,
};
use crate::model::{Axis, LengthUnit, Suspension};
use crate::number::Vector3;
use crate::study::Study;

/// Results of the tests of a study, with what they are written in.
pub struct KcResults<'a> {
    /// The suspension.
    pub suspension: &'a Suspension,
    /// Names of the bushings, in the order of their readings.
    pub bushings: Vec<String>,
    /// Names of the links, in the order of their tensions.
    pub links: Vec<String>,
    /// The vertical force at the contact point in the design position, if that is an equilibrium.
    pub design_load: Option<f64>,
    /// The stations.
    pub stations: Vec<KcStation>,
}

/// Why a state has no equilibrium, in words.
pub fn no_equilibrium(why: &NoEquilibrium) -> String {
    let motion = why.softest.as_ref().map(|(part, motion)| match motion {
        Motion::Turn(axis) => format!("{part} turns about {}", axis.name()),
        Motion::Shift(axis) => format!("{part} moves along {}", axis.name()),
    });
    let motion = motion.unwrap_or_else(|| "no equilibrium is found".to_owned());
    match why.is_unstable {
        true => format!("found, but not stable: {motion}"),
        false => format!("holds {:.6} of the way; then {motion}", why.share),
    }
}

/// The status word of a state without equilibrium.
fn status(why: &NoEquilibrium) -> &'static str {
    match why.is_unstable {
        true => "unstable",
        false => "no_equilibrium",
    }
}

/// The unit for a reader.
fn unit_shown(unit: Unit, length: LengthUnit) -> String {
    let u = length.symbol();
    match unit {
        Unit::AnglePerForce => "deg/kN".to_owned(),
        Unit::LengthPerForce => format!("{u}/kN"),
        Unit::AnglePerTorque => "deg/(100 N m)".to_owned(),
        Unit::Stiffness => "N/mm".to_owned(),
        Unit::AnglePerLength => format!("deg/{u}"),
        Unit::Ratio => "-".to_owned(),
        unit => unit.suffix(length),
    }
}

fn place(place: TestPlace) -> &'static str {
    match place {
        TestPlace::Nowhere => "",
        TestPlace::ContactPoint => "contact_point",
        TestPlace::WheelCentre => "wheel_centre",
        TestPlace::Moment => "moment",
    }
}

pub(super) fn held(test: &KcTest) -> &'static str {
    match (test.load.is_motion(), test.held) {
        (true, _) => "",
        (false, HeldQuantity::WheelHeight) => "wheel_height",
        (false, HeldQuantity::WheelLoad) => "wheel_load",
    }
}

fn optional(value: Option<f64>) -> String {
    value.map_or_else(String::new, shortest)
}

/// A CSV file of rows of text.
pub(super) fn csv(header: &[String], rows: impl IntoIterator<Item = Vec<String>>) -> Vec<u8> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    let written = "written to memory";
    writer.write_record(header).expect(written);
    for row in rows {
        writer.write_record(&row).expect(written);
    }
    writer.into_inner().expect(written)
}

impl KcResults<'_> {
    fn length(&self) -> LengthUnit {
        self.suspension.length_unit
    }

    pub(super) fn columns(&self, names: &[&str]) -> Vec<String> {
        let u = self.length().symbol();
        names
            .iter()
            .map(|name| name.replace("_U", &format!("_{u}")))
            .collect()
    }

    fn station(&self, station: &KcStation) -> Vec<String> {
        vec![shortest(station.travel), shortest(station.rack)]
    }

    /// `kc.csv`: a row for each station, test and quantity.
    pub fn kc_csv(&self) -> Vec<u8> {
        let header = self.columns(&[
            "travel_U",
            "rack_U",
            "load",
            "at",
            "trail_U",
            "mode",
            "hold",
            "anti_roll_bar",
            "wheel",
            "quantity",
            "value",
            "secant",
            "window",
            "unit",
            "reason",
            "status",
        ]);
        let mut rows = Vec::new();
        for station in &self.stations {
            match &station.outcomes {
                Ok(outcomes) => {
                    for outcome in outcomes {
                        self.figure_rows(station, outcome, &mut rows);
                    }
                }
                Err(why) => {
                    for (test, at) in &station.tests {
                        let mut row = self.test_cells(station, test, *at);
                        row.extend([const { String::new() }; 5]);
                        row.extend([no_equilibrium(why), status(why).to_owned()]);
                        rows.push(row);
                    }
                }
            }
        }
        csv(&header, rows)
    }

    /// Cells from the station to the wheel.
    fn test_cells(&self, station: &KcStation, test: &KcTest, at: TestPlace) -> Vec<String> {
        let trail = (test.load == TestLoad::Lateral).then_some(test.trail);
        let mut cells = self.station(station);
        cells.extend([
            test.load.name().to_owned(),
            place(at).to_owned(),
            optional(trail),
        ]);
        cells.extend(["", held(test), "", ""].map(str::to_owned));
        cells
    }

    /// A value of a figure as it is printed.
    fn printed(&self, figure: &KcFigure, value: Option<f64>) -> Option<f64> {
        value.map(|value| value * figure.unit.printed_factor(self.length()))
    }

    fn figure_rows(&self, station: &KcStation, outcome: &KcOutcome, rows: &mut Vec<Vec<String>>) {
        let failed = outcome.levels.iter().find_map(|l| l.state.as_ref().err());
        for figure in &outcome.figures {
            let mut row = self.test_cells(station, &outcome.test, outcome.place);
            let has_window = !outcome.levels.is_empty();
            let reason = match (figure.value, failed) {
                (None, _) if figure.unit == Unit::Stiffness => {
                    "nothing moves: the stiffness has no bound".to_owned()
                }
                (None, _) => "no value here".to_owned(),
                (_, Some(why)) => format!("no secant: {}", no_equilibrium(why)),
                _ => String::new(),
            };
            row.extend([
                figure.quantity.to_owned(),
                optional(self.printed(figure, figure.value)),
                optional(self.printed(figure, figure.secant)),
                optional(has_window.then_some(outcome.test.window)),
                figure.unit.suffix(self.length()),
                reason,
                "ok".to_owned(),
            ]);
            rows.push(row);
        }
    }

    /// `levels.csv`: a row for each level; `None` if no test has levels.
    pub fn levels_csv(&self) -> Option<Vec<u8>> {
        let mut header = self.columns(&[
            "travel_U",
            "rack_U",
            "load",
            "trail_U",
            "mode",
            "hold",
            "anti_roll_bar",
            "side",
            "level",
            "force_N",
            "moment_N_m",
            "vertical_force_N",
            "toe_deg",
            "camber_deg",
            "caster_deg",
            "spin_deg",
            "wheel_centre_x_U",
            "wheel_centre_y_U",
            "wheel_centre_z_U",
            "contact_point_x_U",
            "contact_point_y_U",
            "contact_point_z_U",
            "spring_force_N",
        ]);
        for name in &self.bushings {
            for (part, unit) in [
                ("deflection", "_U"),
                ("rotation", "_deg"),
                ("force", "_N"),
                ("torque", "_N_m"),
            ] {
                let of = Axis::ALL.map(|axis| format!("{name}_{part}_{}{unit}", axis.name()));
                header.extend(self.columns(&of.each_ref().map(String::as_str)));
            }
        }
        header.extend(self.links.iter().map(|name| format!("{name}_tension_N")));
        header.extend(["share", "reason", "status"].map(str::to_owned));
        let mut rows = Vec::new();
        for station in &self.stations {
            for outcome in station.outcomes.iter().flatten() {
                for level in &outcome.levels {
                    rows.push(self.level_row(station, &outcome.test, level, header.len()));
                }
            }
        }
        (!rows.is_empty()).then(|| csv(&header, rows))
    }

    fn level_row(
        &self,
        station: &KcStation,
        test: &KcTest,
        level: &KcLevel,
        width: usize,
    ) -> Vec<String> {
        let trail = (test.load == TestLoad::Lateral).then_some(test.trail);
        let per_metre = self.length().per_metre();
        let is_moment = test.load == TestLoad::Aligning;
        let mut row = self.station(station);
        row.extend([test.load.name().to_owned(), optional(trail)]);
        row.extend(["", held(test), "", ""].map(str::to_owned));
        row.extend([
            level.level.to_string(),
            optional((!is_moment).then_some(level.load)),
            optional(is_moment.then_some(level.load / per_metre)),
        ]);
        match &level.state {
            Ok(state) => {
                row.extend(self.state_cells(state).into_iter().map(optional));
                row.extend([shortest(1.0), String::new(), "ok".to_owned()]);
            }
            Err(why) => {
                row.resize(width - 3, String::new());
                row.extend([
                    shortest(why.share),
                    no_equilibrium(why),
                    status(why).to_owned(),
                ]);
            }
        }
        row
    }

    fn state_cells(&self, state: &KcState) -> Vec<Option<f64>> {
        let per_metre = self.length().per_metre();
        let figures = &state.figures;
        let degrees = |angle: f64| Some(angle.to_degrees());
        let point = |v: Vector3<f64>| self.suspension.frame.vector(v).to_array().map(Some);
        let mut cells = vec![
            Some(state.wheel_load),
            degrees(figures.toe),
            degrees(figures.camber),
            figures.steering.and_then(|[caster, _]| degrees(caster)),
            degrees(figures.spin),
        ];
        cells.extend(point(figures.centre));
        cells.extend(point(figures.contact));
        cells.push(state.spring.map(|spring| spring.force));
        for BushingReading {
            deflection,
            rotation,
            force,
            torque,
            ..
        } in &state.bushings
        {
            cells.extend(deflection.to_array().map(Some));
            cells.extend(rotation.to_array().map(degrees));
            cells.extend(force.to_array().map(Some));
            cells.extend(torque.to_array().map(|torque| Some(torque / per_metre)));
        }
        cells.extend(state.tensions.iter().copied().map(Some));
        cells
    }

    /// `compliance_matrix.csv`: six rows for each station; `None` if the wheel load cannot be held anywhere.
    pub fn matrix_csv(&self) -> Option<Vec<u8>> {
        let u = self.length().symbol();
        let mut header = self.columns(&["travel_U", "rack_U", "output", "unit"]);
        header.extend(["fx", "fy", "fz", "mx", "my", "mz", "reason", "status"].map(str::to_owned));
        let mut rows = Vec::new();
        for station in &self.stations {
            let Some(matrix) = &station.matrix else {
                continue;
            };
            for (k, values) in matrix.iter().enumerate() {
                let axis = Axis::ALL[k % 3].name();
                let (output, unit) = match k < 3 {
                    true => (format!("wheel_centre_{axis}"), u),
                    false => (format!("rotation_{axis}"), "rad"),
                };
                let mut row = self.station(station);
                row.extend([output, unit.to_owned()]);
                row.extend(values.iter().map(|value| shortest(*value)));
                row.extend([String::new(), "ok".to_owned()]);
                rows.push(row);
            }
        }
        (!rows.is_empty()).then(|| csv(&header, rows))
    }

    /// The figures of all stations, for programs.
    pub fn table(&self) -> Table {
        let u = self.length().symbol();
        let mut columns = vec!["test".to_owned()];
        columns.extend([format!("travel {u}"), format!("rack {u}")]);
        columns.extend(["quantity", "value", "secant", "unit"].map(str::to_owned));
        let mut table = Table::with_columns(columns).keyed(4);
        for station in &self.stations {
            for outcome in station.outcomes.iter().flatten() {
                let name = self.test_name(&outcome.test);
                for figure in &outcome.figures {
                    let mut row = vec![Cell::from(name.as_str())];
                    row.extend([Cell::from(station.travel), Cell::from(station.rack)]);
                    row.extend(self.figure_cells(figure));
                    table.push_row(row);
                }
            }
        }
        table
    }

    /// The place of each station that has figures, and its table for a reader: tests with their figures below them.
    pub fn tables_for_readers(&self) -> Vec<(String, Table)> {
        let u = self.length().symbol();
        let mut tables = Vec::new();
        for station in &self.stations {
            let Ok(outcomes) = &station.outcomes else {
                continue;
            };
            let mut table = Table::new(["quantity", "value", "secant", "unit"]);
            for outcome in outcomes {
                let name = self.test_name(&outcome.test);
                table.push([Cell::from(name), "".into(), "".into(), "".into()]);
                for figure in &outcome.figures {
                    table.push_row(self.figure_cells(figure));
                }
            }
            let [travel, rack] = [station.travel, station.rack].map(super::brief);
            tables.push((format!("travel {travel} {u}, rack {rack} {u}"), table));
        }
        tables
    }

    /// Name, value, secant and unit of a figure.
    fn figure_cells(&self, figure: &KcFigure) -> [Cell; 4] {
        let number = |value: Option<f64>| Cell::by(value, four_figures);
        [
            Cell::from(figure.quantity),
            number(self.printed(figure, figure.value)),
            number(self.printed(figure, figure.secant)),
            Cell::from(unit_shown(figure.unit, self.length())),
        ]
    }

    /// A test in words: `lateral, trail 30 mm`, `braking, wheel load held`.
    fn test_name(&self, test: &KcTest) -> String {
        let mut name = test.load.name().to_owned();
        if test.trail != 0.0 {
            name += &format!(
                ", trail {} {}",
                super::brief(test.trail),
                self.length().symbol()
            );
        }
        if test.held == HeldQuantity::WheelLoad && test.load != TestLoad::Vertical {
            name += ", wheel load held";
        }
        name
    }

    /// Returns true if every station and level has an equilibrium.
    pub fn is_complete(&self) -> bool {
        self.failures().is_empty()
    }

    /// Stations and levels without equilibrium, a line each.
    pub fn failures(&self) -> Vec<String> {
        let u = self.length().symbol();
        let mut failures = Vec::new();
        for station in &self.stations {
            let at = format!(
                "travel {} {u}, rack {} {u}",
                super::brief(station.travel),
                super::brief(station.rack)
            );
            match &station.outcomes {
                Err(why) => failures.push(format!("{at}: {}", no_equilibrium(why))),
                Ok(outcomes) => {
                    for outcome in outcomes {
                        let first = outcome
                            .levels
                            .iter()
                            .filter_map(|level| Some((level.load, level.state.as_ref().err()?)));
                        let nearest = first.min_by(|(a, _), (b, _)| a.abs().total_cmp(&b.abs()));
                        if let Some((load, why)) = nearest {
                            let unit = match outcome.test.load {
                                TestLoad::Aligning => format!("N {u}"),
                                _ => "N".to_owned(),
                            };
                            failures.push(format!(
                                "{at}, {} at {} {unit}: {}",
                                self.test_name(&outcome.test),
                                super::brief(load),
                                no_equilibrium(why)
                            ));
                        }
                    }
                }
            }
        }
        failures
    }

    /// Warnings: values that stand on a continued curve, wheels that lift.
    pub fn warnings(&self) -> Vec<String> {
        let outcomes = self
            .stations
            .iter()
            .flat_map(|s| s.outcomes.iter().flatten());
        let states = outcomes
            .flat_map(|outcome| &outcome.levels)
            .filter_map(|level| level.state.as_ref().ok());
        let states: Vec<&KcState> = states.collect();
        let mut warnings = Vec::new();
        for (k, name) in self.bushings.iter().enumerate() {
            let beyond = states.iter().filter(|s| s.bushings[k].is_extrapolated);
            let count = beyond.count();
            if count > 0 {
                warnings.push(format!(
                    "warning: {name} is beyond its curve, or turned by more than 60 degrees, in {} of {} states; its law is continued straight",
                    count,
                    states.len()
                ));
            }
        }
        let lifted = states.iter().filter(|s| s.wheel_load < 0.0).count();
        let carries = states.iter().any(|s| s.spring.is_some());
        if lifted > 0 && carries {
            warnings.push(format!(
                "warning: the wheel load is below 0 in {lifted} of {} states: the wheel lifts",
                states.len()
            ));
        }
        let stopped = states
            .iter()
            .filter(|s| s.spring.is_some_and(|s| s.meets_stop));
        let stopped = stopped.count();
        if stopped > 0 {
            warnings.push(format!(
                "the bump stop is met in {stopped} of {} states",
                states.len()
            ));
        }
        warnings
    }
}

/// A number with the four figures that a rig sheet has.
fn four_figures(value: f64) -> String {
    let rounded = format!("{value:.3e}").parse().unwrap_or(value);
    super::brief(rounded)
}

/// What is elastic in a study, a line each.
pub fn elastic_parts(study: &Study) -> Table {
    let mut table = Table::new(["part", "elastic", "rates", "torsional rates", "unit"]);
    let Some(elastic) = study.compliance() else {
        return table;
    };
    let u = study.wheel().length_unit.symbol();
    let joined = |rates: [f64; 3]| rates.map(super::brief).join(", ");
    for part in &elastic.parts.bushings {
        let slopes = part
            .shapes
            .each_ref()
            .map(crate::compliance::Shape::initial_rate);
        let [a, b, c, d, e, f] = slopes;
        table.push([
            Cell::from(study.wheel().mechanism.name(part.point)),
            Cell::from("bushing"),
            Cell::from(joined([a, b, c])),
            Cell::from(joined([d, e, f])),
            Cell::from(format!("N/{u}, N {u}/rad")),
        ]);
    }
    for (name, part) in elastic.link_names.iter().zip(&elastic.parts.links) {
        use crate::compliance::AxialStiffness;
        let (rate, unit) = match part.stiffness {
            AxialStiffness::Rate(rate) => (rate, format!("N/{u}")),
            AxialStiffness::PerStrain(force) => (force, "N per strain".to_owned()),
        };
        table.push([
            Cell::from(name.as_str()),
            Cell::from("axial"),
            Cell::from(super::brief(rate)),
            Cell::from(""),
            Cell::from(unit),
        ]);
    }
    table
}
