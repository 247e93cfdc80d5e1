//! Results of `kc` tests (kinematics and compliance under load) on one wheel or an axle: `kc.csv` and `compliance_matrix.csv`. The
//! submodules write the load levels, tables, sensitivities and remarks.

mod levels;
mod names;
mod parts;
mod remarks;
mod sensitivities;
mod tables;

pub use names::OtherProgram;
pub use parts::elastic_parts;
pub(in crate::report) use tables::four_figures;

use super::files::csv_of_rows;
use super::{optional, shortest};
use crate::ask::Unit;
use crate::compliance::{
    HeldQuantity, KcFigure, KcOutcome, KcStation, KcSubject, KcTest, Lack, Motion, NoEquilibrium,
    TestLoad, TestMode, TestPlace,
};
use crate::model::{Axis, LengthUnit, Suspension};
use names::{OtherFigure, StationMatrix};

/// Results of the tests of a study, with their units.
pub struct KcResults<'a> {
    /// Suspension of the tested wheel, or of the left wheel of an axle.
    pub suspension: &'a Suspension,
    /// Names of the bushings, in the order of the bushing values in the results.
    pub bushings: Vec<String>,
    /// Names of the links, in the order of the link tensions in the results.
    pub links: Vec<String>,
    /// Vertical force at each contact point in the design position, in newtons. Empty if the design position is not an
    /// equilibrium.
    pub design_loads: Vec<f64>,
    /// True for an axle with both wheels, false for a single wheel.
    pub is_axle: bool,
    /// Stations of the tests.
    pub stations: Vec<KcStation>,
    /// Rate of the tyre, in newtons per length unit.
    pub tyre_rate: Option<f64>,
    /// Other program whose results are added, with its names and definitions, to the results of hardpoint. `None` without such
    /// results.
    pub other: Option<OtherProgram>,
}

/// Reason in words why a state has no equilibrium.
pub fn no_equilibrium(why: &NoEquilibrium) -> String {
    let softest = why.softest.as_ref();
    let motion = softest.map(|(part, motion)| weakest_motion(part, *motion));
    match (&why.lack, motion) {
        (Lack::Stability, Some(motion)) => {
            format!("an equilibrium was found, but it is not stable: {motion}")
        }
        (Lack::Stability, None) => "an equilibrium was found, but it is not stable".to_owned(),
        (Lack::Stiffness(part), _) => format!(
            "an equilibrium was found, but it is not stable, because at most the torsional stiffness of bushings \
             holds {part}: expected stiffness of its bushings along all axes"
        ),
        (Lack::Derivatives, _) => {
            "an equilibrium was found, but it has no derivatives: its equations are singular"
                .to_owned()
        }
        (Lack::Model(reason), _) => reason.clone(),
        (Lack::Equilibrium, motion) => {
            let motion = motion.unwrap_or_else(|| "no equilibrium is found".to_owned());
            format!(
                "equilibria exist only for the first {:.1} % of the change from the last state; then {motion}",
                100.0 * why.share
            )
        }
    }
}

/// Motion of the part with the least stiffness, in words, such as "... turns about z".
pub fn weakest_motion(part: &str, motion: Motion) -> String {
    match motion {
        Motion::Turn(axis) => format!("{part} turns about {}", axis.name()),
        Motion::Shift(axis) => format!("{part} moves along {}", axis.name()),
    }
}

/// Status of a state without equilibrium, in one word.
fn status(why: &NoEquilibrium) -> &'static str {
    match why.lack {
        Lack::Stability | Lack::Stiffness(_) => "unstable",
        Lack::Derivatives => "singular",
        Lack::Equilibrium | Lack::Model(_) => "no_equilibrium",
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

/// State of the anti-roll bar in a test: `connected` or `disconnected`. Empty for a study of one wheel.
fn bar(test: &KcTest) -> &'static str {
    match (test.mode, test.has_bar) {
        (TestMode::OneWheel, _) => "",
        (_, true) => "connected",
        (_, false) => "disconnected",
    }
}

/// Part of the steering that is fixed in a test of an axle.
fn steering(test: &KcTest) -> &'static str {
    if test.locks_rack {
        "locked_rack"
    } else {
        "locked_wheel"
    }
}

/// Mode of a test, in one word: `parallel` or `opposed` loads on both wheels, or a load on a `single` wheel. Empty for a test with
/// a motion, and for a study of one wheel.
fn mode(test: &KcTest) -> &'static str {
    if test.load.is_motion() {
        ""
    } else {
        test.mode.name()
    }
}

/// Part to which a result belongs: a wheel or the axle. Empty for a study of one wheel.
fn subject(of: KcSubject) -> &'static str {
    match of {
        KcSubject::OneWheel => "",
        KcSubject::Wheel(side) => side.name(),
        KcSubject::Axle => "axle",
    }
}

fn held(test: &KcTest) -> &'static str {
    match (test.load.is_motion(), test.held) {
        (true, _) => "",
        (false, HeldQuantity::WheelHeight) => "wheel_height",
        (false, HeldQuantity::WheelLoad) => "wheel_load",
    }
}

/// Makes a CSV file from rows of text.
fn csv(header: Vec<String>, rows: Vec<Vec<String>>) -> Vec<u8> {
    csv_of_rows(std::iter::once(header).chain(rows))
}

impl KcResults<'_> {
    fn length(&self) -> LengthUnit {
        self.suspension.length_unit
    }

    fn columns(&self, names: &[&str]) -> Vec<String> {
        let u = self.length().symbol();
        names
            .iter()
            .map(|name| name.replace("_U", &format!("_{u}")))
            .collect()
    }

    fn station(&self, station: &KcStation) -> Vec<String> {
        let mut cells = vec![shortest(station.travel)];
        cells.extend(station.right_travel.map(shortest));
        cells.push(shortest(station.rack));
        cells
    }

    /// Names of the columns that give the station of a test.
    fn station_columns(&self) -> Vec<String> {
        if self.is_axle {
            self.columns(&["travel_left_U", "travel_right_U", "rack_U"])
        } else {
            self.columns(&["travel_U", "rack_U"])
        }
    }

    /// Name of a station in words: its travels and its rack displacement.
    pub(in crate::report) fn station_name(&self, station: &KcStation) -> String {
        let u = self.length().symbol();
        let [travel, rack] = [station.travel, station.rack].map(super::brief);
        match station.right_travel.map(super::brief) {
            Some(right) if right != travel => {
                format!("travel {travel} and {right} {u}, rack {rack} {u}")
            }
            _ => format!("travel {travel} {u}, rack {rack} {u}"),
        }
    }

    /// Content of `kc.csv`: one row for each station, test and quantity. A station without equilibrium has one row for each test.
    pub fn kc_csv(&self) -> Vec<u8> {
        let mut header = self.station_columns();
        header.extend(self.columns(&["load", "at", "trail_U", "mode", "hold", "anti_roll_bar"]));
        header.extend(self.is_axle.then(|| "steering".to_owned()));
        header.extend(self.columns(&["wheel", "quantity", "value", "secant", "window", "unit"]));
        if self.other.is_some() {
            header.extend(["other_name", "other_value", "other_unit"].map(str::to_owned));
        }
        header.extend(["reason", "status"].map(str::to_owned));
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
                        let mut row = self.test_cells(station, test, *at, KcSubject::OneWheel);
                        row.resize(header.len() - 2, String::new());
                        row.extend([no_equilibrium(why), status(why).to_owned()]);
                        rows.push(row);
                    }
                }
            }
        }
        csv(header, rows)
    }

    /// Cells of a row from the columns of the station up to the column `wheel`, before the quantity.
    fn test_cells(
        &self,
        station: &KcStation,
        test: &KcTest,
        at: TestPlace,
        of: KcSubject,
    ) -> Vec<String> {
        let trail = (test.load == TestLoad::Lateral).then_some(test.trail);
        let mut cells = self.station(station);
        cells.extend([
            test.load.name().to_owned(),
            place(at).to_owned(),
            optional(trail),
        ]);
        cells.extend([mode(test), held(test), bar(test)].map(str::to_owned));
        cells.extend(self.is_axle.then(|| steering(test).to_owned()));
        cells.push(subject(of).to_owned());
        cells
    }

    /// Value of a result, converted to the unit that is printed.
    fn printed(&self, figure: &KcFigure, value: Option<f64>) -> Option<f64> {
        value.map(|value| value * figure.unit.printed_factor(self.length()))
    }

    /// Result by the definition of another program. `None` if that program has no such result, or if an input is missing: the
    /// compliance matrix, or the wheel radius. Also `None` if the anti-roll bar or the steering has another state in the test than
    /// in the compliance matrix.
    fn other_figure(
        &self,
        program: OtherProgram,
        station: &KcStation,
        outcome: &KcOutcome,
        figure: &KcFigure,
    ) -> Option<OtherFigure> {
        let (first, _) = station.tests.first()?;
        if first.conditions() != outcome.test.conditions() {
            return None;
        }
        let of = StationMatrix {
            matrix: station.matrix.as_ref()?,
            frame: self.suspension.frame,
            length: self.length(),
            radius: self.suspension.wheel_radius?,
            tyre_rate: self.tyre_rate,
            centre_distance: station.centre_distance,
        };
        let test = (&outcome.test, outcome.place);
        of.other(program, figure.quantity, test, figure.of)
    }

    fn figure_rows(&self, station: &KcStation, outcome: &KcOutcome, rows: &mut Vec<Vec<String>>) {
        let failed = outcome.levels.iter().find_map(|l| l.state.as_ref().err());
        for figure in &outcome.figures {
            let mut row = self.test_cells(station, &outcome.test, outcome.place, figure.of);
            let has_window = !outcome.levels.is_empty();
            let reason = match (figure.value, failed) {
                (None, _) if figure.unit == Unit::Stiffness => {
                    "no displacement: the stiffness is infinite".to_owned()
                }
                (None, _) => "no value at this position".to_owned(),
                (_, Some(why)) => format!("no secant: {}", no_equilibrium(why)),
                _ => String::new(),
            };
            row.extend([
                figure.quantity.to_owned(),
                optional(self.printed(figure, figure.value)),
                optional(self.printed(figure, figure.secant)),
                optional(has_window.then_some(outcome.test.window)),
                figure.unit.suffix(self.length()),
            ]);
            if let Some(program) = self.other {
                let other = self.other_figure(program, station, outcome, figure);
                row.extend(match other {
                    Some(other) => [other.name, shortest(other.value), other.unit.to_owned()],
                    None => [const { String::new() }; 3],
                });
            }
            row.extend([reason, "ok".to_owned()]);
            rows.push(row);
        }
    }

    /// Content of `compliance_matrix.csv`: six rows per station, or twelve for an axle. Displacements are in length units, and
    /// rotations in radians. Both are per newton, or per newton times length unit. `None` if no station has a matrix: there is no
    /// equilibrium, or the wheel load cannot be kept constant.
    pub fn matrix_csv(&self) -> Option<Vec<u8>> {
        let u = self.length().symbol();
        let sides: &[&str] = if self.is_axle {
            &["left_", "right_"]
        } else {
            &[""]
        };
        let mut header = self.station_columns();
        header.extend(["output", "unit"].map(str::to_owned));
        for side in sides {
            let loads = ["fx", "fy", "fz", "mx", "my", "mz"];
            header.extend(loads.map(|load| format!("{side}{load}")));
        }
        header.extend(["reason", "status"].map(str::to_owned));
        let mut rows = Vec::new();
        for station in &self.stations {
            let Some(matrix) = &station.matrix else {
                continue;
            };
            for (k, values) in matrix.iter().enumerate() {
                let (side, axis) = (sides[k / 6], Axis::ALL[k % 3].name());
                let (output, unit) = if k % 6 < 3 {
                    (format!("{side}wheel_centre_{axis}"), u)
                } else {
                    (format!("{side}rotation_{axis}"), "rad")
                };
                let mut row = self.station(station);
                row.extend([output, unit.to_owned()]);
                row.extend(values.iter().map(|value| shortest(*value)));
                row.extend([String::new(), "ok".to_owned()]);
                rows.push(row);
            }
        }
        (!rows.is_empty()).then(|| csv(header, rows))
    }

    /// Name of a test in words: `lateral, trail 30 mm`, `braking, wheel load held`.
    pub(in crate::report) fn test_name(&self, test: &KcTest) -> String {
        let apart = self.test_apart(test);
        if apart.is_empty() {
            test.load.name().to_owned()
        } else {
            format!("{}, {apart}", test.load.name())
        }
    }

    /// Properties that distinguish tests with the same load, such as `trail 30 mm` (the force acts 30 mm behind the contact
    /// point). Empty if the test has no such property.
    pub(in crate::report) fn test_apart(&self, test: &KcTest) -> String {
        let mut parts = Vec::new();
        if test.trail != 0.0 {
            let trail = super::brief(test.trail);
            parts.push(format!("trail {trail} {}", self.length().symbol()));
        }
        if test.held == HeldQuantity::WheelLoad && test.load != TestLoad::Vertical {
            parts.push("wheel load held".to_owned());
        }
        if let (TestMode::Single(side), false) = (test.mode, test.load.is_motion()) {
            parts.push(format!("{} wheel alone", side.name()));
        } else if !mode(test).is_empty() {
            parts.push(mode(test).to_owned());
        }
        if bar(test) == "disconnected" {
            parts.push("bar disconnected".to_owned());
        }
        if test.locks_rack {
            parts.push("rack locked".to_owned());
        }
        parts.join(", ")
    }
}
