//! Curves of an axle as files, tables and words.

use super::accuracy::{CertificateSummary, at_toggle, stations_in_words};
use super::completeness::Completeness;
use super::failures::FailureRange;
use super::files::csv_of;
use super::ranges::Range;
use super::{Cell, Table, brief, optional, shortest};
use crate::ask::Need;
use crate::axle::{
    Axle, AxleColumn, AxleCurves, AxlePlan, AxleProof, AxleStation, BeyondCurve, Coordinate,
    ForcePart, Placement, Void, WheelMotion,
};
use crate::curves::{Proof, Status};
use crate::model::{Axis, Rod, Side};
use serde::{Deserialize, Serialize};

/// Names and values of the columns that say where a station is.
pub(super) struct StationColumns<'a> {
    pub plan: &'a AxlePlan,
    pub axle: &'a Axle,
}

impl StationColumns<'_> {
    fn names(&self) -> Vec<String> {
        let unit = self.axle.left.length_unit.symbol();
        let course = &self.plan.course;
        let mut names = Vec::new();
        names.extend(course.shows_roll().then(|| "roll_deg".to_owned()));
        names.extend(course.shows_heave().then(|| format!("heave_{unit}")));
        names.extend(["left", "right"].map(|side| format!("travel_{side}_{unit}")));
        names.extend(course.shows_rack.then(|| format!("rack_{unit}")));
        let angle = course.steering_wheel.is_some();
        names.extend(angle.then(|| "steering_wheel_angle_deg".to_owned()));
        names
    }

    fn values(&self, number: usize, station: &AxleStation) -> Vec<Option<f64>> {
        let course = &self.plan.course;
        let (roll, heave, travels) = match station.placement {
            Placement::Roll { heave, roll, .. } | Placement::AtLoad { heave, roll, .. } => {
                (Some(roll), Some(heave), None)
            }
            Placement::Travels { travels, .. } => (None, Some(travels[0]), Some(travels)),
        };
        let placed = station.placed.as_ref().ok();
        // Written as degrees, an angle is the shortest decimal that means it.
        let roll = roll.or(placed.map(|p| p.roll)).map(degrees);
        let travels = placed.map(|p| p.travels).or(travels);
        let mut values = Vec::new();
        values.extend(course.shows_roll().then_some(roll));
        values.extend(course.shows_heave().then_some(heave));
        values.extend([0, 1].map(|side| travels.map(|t| t[side])));
        let rack = station.placement.rack() * self.axle.left.frame.sign(Axis::Y);
        values.extend(course.shows_rack.then_some(Some(rack)));
        let angle = course.steering_wheel_at(number).map(degrees);
        values.extend(course.steering_wheel.is_some().then_some(angle));
        values
    }

    /// What the travels, or the roll angle, follow from.
    fn results(&self) -> [bool; 2] {
        let wheels = &self.plan.course.wheels;
        let rolls = matches!(wheels, WheelMotion::Roll { .. });
        [rolls, self.plan.course.shows_roll() && !rolls]
    }

    /// Names of the columns that say what is proved.
    fn proof_names(&self) -> Vec<String> {
        if !self.plan.certify {
            return Vec::new();
        }
        let unit = self.axle.left.length_unit.symbol();
        let [travels, roll] = self.results();
        let mut names = ["left", "right"]
            .map(|side| format!("{side}_position_error_{unit}"))
            .to_vec();
        names.extend(travels.then(|| format!("travel_error_{unit}")));
        names.extend(roll.then(|| "roll_error_deg".to_owned()));
        names.push(format!("uniqueness_{unit}"));
        names
    }

    fn proof_values(&self, station: &AxleStation) -> Vec<Option<f64>> {
        if !self.plan.certify {
            return Vec::new();
        }
        let [travels, roll] = self.results();
        let of = |value: fn(&AxleProof) -> f64| station.proof.as_ref().map(value);
        let mut values = vec![of(|p| p.position_errors[0]), of(|p| p.position_errors[1])];
        values.extend(travels.then(|| of(|p| p.travel_error)));
        values.extend(roll.then(|| of(|p| p.roll_error.to_degrees() * (1.0 + 1e-12))));
        values.push(of(|p| p.uniqueness));
        values
    }

    /// The names of the numbers that the motion gives.
    pub(super) fn given_names(&self) -> Vec<String> {
        let length = self.axle.left.length_unit;
        let given = self.given_coordinates().into_iter();
        given.map(|c| c.column(length)).collect()
    }

    /// These numbers at a station, as the study writes them.
    pub(super) fn given(&self, number: usize, placement: &Placement) -> Vec<f64> {
        let value = |coordinate: Coordinate| match coordinate {
            Coordinate::Roll => degrees(placement.along(coordinate)),
            Coordinate::SteeringWheel => {
                let angle = self.plan.course.steering_wheel_at(number);
                degrees(angle.unwrap_or(f64::NAN))
            }
            Coordinate::Rack => placement.rack() * self.axle.left.frame.sign(Axis::Y),
            _ => placement.along(coordinate),
        };
        self.given_coordinates().into_iter().map(value).collect()
    }

    /// The same of a position that need not be one of the motion's.
    pub(super) fn given_anywhere(&self, placement: &Placement) -> Vec<f64> {
        let value = |coordinate: Coordinate| match coordinate {
            Coordinate::SteeringWheel | Coordinate::Roll => {
                coordinate.written(placement.along(coordinate), self.axle)
            }
            Coordinate::Rack => placement.rack() * self.axle.left.frame.sign(Axis::Y),
            _ => placement.along(coordinate),
        };
        let given = self.given_coordinates().into_iter();
        given.map(|coordinate| value(coordinate) + 0.0).collect()
    }

    fn given_coordinates(&self) -> Vec<Coordinate> {
        let mut course = self.plan.course.clone();
        let mut given = Coordinate::ALL.to_vec();
        given.retain(|c| match c {
            Coordinate::Rack => course.shows_rack && course.steering_wheel.is_none(),
            Coordinate::SteeringWheel => course.steering_wheel.is_some(),
            _ => course.along(*c).is_some(),
        });
        given
    }

    /// In words, as in `roll_deg 2, heave_mm 0`.
    pub(super) fn words(&self, number: usize, station: &AxleStation) -> String {
        let values = self.values(number, station);
        let known = self.names().into_iter().zip(values);
        let parts = known.filter_map(|(name, value)| Some(format!("{name} {}", shortest(value?))));
        parts.collect::<Vec<_>>().join(", ")
    }
}

fn degrees(angle: f64) -> f64 {
    let exact = angle.to_degrees();
    let short: f64 = format!("{exact:.13e}").parse().unwrap_or(exact);
    match short.to_radians() == angle {
        true => short,
        false => exact,
    }
}

/// Where the stations of an axle's motion are: the columns that curves begin with, as `heave_mm`, each with a value
/// for every station where there is one.
pub fn axle_motion(
    axle: &Axle,
    plan: &AxlePlan,
    curves: &AxleCurves,
) -> Vec<(String, Vec<Option<f64>>)> {
    let of_stations = StationColumns { plan, axle };
    let mut columns: Vec<_> = of_stations
        .names()
        .into_iter()
        .map(|n| (n, Vec::new()))
        .collect();
    for (number, station) in curves.stations.iter().enumerate() {
        for ((_, column), value) in columns.iter_mut().zip(of_stations.values(number, station)) {
            column.push(value);
        }
    }
    columns
}

/// Bounds that the proofs of an axle's stations give, as columns; none where the plan asks for no proofs.
pub fn axle_proofs(
    axle: &Axle,
    plan: &AxlePlan,
    curves: &AxleCurves,
) -> Vec<(String, Vec<Option<f64>>)> {
    let of_stations = StationColumns { plan, axle };
    let names = of_stations.proof_names().into_iter().enumerate();
    let column = |place: usize| -> Vec<Option<f64>> {
        let value = |station| of_stations.proof_values(station)[place];
        curves.stations.iter().map(value).collect()
    };
    names.map(|(place, name)| (name, column(place))).collect()
}

/// `curves.csv` of an axle: a row for each station, `status` last.
pub fn axle_curves_csv(axle: &Axle, plan: &AxlePlan, curves: &AxleCurves) -> Vec<u8> {
    let of_stations = StationColumns { plan, axle };
    csv_of(|writer| {
        let mut header = of_stations.names();
        header.extend(curves.columns.iter().map(|c| c.name.clone()));
        header.extend(of_stations.proof_names());
        header.push("status".to_owned());
        writer.write_record(&header)?;
        for (number, station) in curves.stations.iter().enumerate() {
            let mut record: Vec<_> = of_stations
                .values(number, station)
                .into_iter()
                .map(optional)
                .collect();
            let values = (0..curves.columns.len()).map(|k| station.value(k));
            record.extend(values.map(optional));
            record.extend(of_stations.proof_values(station).into_iter().map(optional));
            record.push(station.status.to_owned());
            writer.write_record(&record)?;
        }
        Ok(())
    })
}

/// `sensitivities.csv` of an axle; names and units of outputs as in that of one wheel.
pub fn axle_sensitivities_csv(axle: &Axle, plan: &AxlePlan, curves: &AxleCurves) -> Vec<u8> {
    let of_stations = StationColumns { plan, axle };
    let length = axle.left.length_unit;
    csv_of(|writer| {
        let mut header = of_stations.names();
        header.extend(["output", "side", "hardpoint", "axis", "value", "unit"].map(str::to_owned));
        writer.write_record(&header)?;
        for s in &curves.sensitivities {
            let station = &curves.stations[s.station];
            let column = &curves.columns[s.column];
            let values = of_stations.values(s.station, station);
            let mut record: Vec<_> = values.into_iter().map(optional).collect();
            record.extend([
                column.output(),
                s.side.map_or("both", |side| side.name()).to_owned(),
                axle.left.mechanism.name(s.point).to_owned(),
                s.axis.name().to_owned(),
                optional(s.value),
                column.unit_per(length),
            ]);
            writer.write_record(&record)?;
        }
        Ok(())
    })
}

/// `summary.json` of an axle's curves.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct AxleSummary {
    command: String,
    version: String,
    study: String,
    topology: String,
    axle: String,
    stations: usize,
    solved: usize,
    failed: Vec<FailedStation>,
    outputs: Vec<Range>,
    completeness: Completeness,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    certificate: Option<CertificateSummary<String>>,
}

#[derive(Clone, Debug, Serialize, Deserialize)]
struct FailedStation {
    station: usize,
    at: String,
    status: String,
    reason: String,
}

impl AxleSummary {
    /// Summary of an axle's curves; `design` are the curves of the design position alone.
    pub fn of(
        name: &str,
        axle: &Axle,
        plan: &AxlePlan,
        curves: &AxleCurves,
        design: &AxleCurves,
    ) -> Self {
        let failed = axle_failures(axle, plan, curves).into_iter();
        let failed = failed.map(|f| FailedStation {
            station: f.first,
            at: f.place,
            status: f.status,
            reason: f.reason,
        });
        let failed: Vec<_> = failed.collect();
        let outputs = curves.columns.iter().enumerate().map(|(k, column)| {
            let values = curves.stations.iter().filter_map(move |s| s.value(k));
            let at_design = design.stations.first().and_then(|s| s.value(k));
            Range::of([&column.name, &column.unit], at_design, values)
        });
        AxleSummary {
            command: "solve".to_owned(),
            version: env!("CARGO_PKG_VERSION").to_owned(),
            study: name.to_owned(),
            topology: axle.left.mechanism.topology.name.to_owned(),
            axle: right_wheel(axle),
            stations: curves.stations.len(),
            solved: curves.stations.len() - failed.len(),
            outputs: outputs.collect(),
            completeness: Completeness::of_axle(curves),
            failed,
            certificate: certificate(&StationColumns { plan, axle }, curves),
        }
    }

    /// One line on the whole.
    pub fn headline(&self) -> String {
        let stations = self.completeness.headline().unwrap_or_default();
        format!(
            "{}: {} axle, {}; {stations}",
            self.study, self.topology, self.axle
        )
    }

    /// The range of every column.
    pub fn table(&self) -> Table {
        Range::table(&self.outputs)
    }

    /// For programs: how many stations there are of each status.
    pub fn stations_table(&self) -> Table {
        self.completeness.table()
    }

    /// For programs: the stations without a position.
    pub fn failures_table(&self) -> Table {
        let mut table = Table::new(["station", "at", "status", "reason"]);
        for failed in &self.failed {
            let words =
                [&failed.at, &failed.status, &failed.reason].map(|text| text.as_str().into());
            table.push_row([Cell::from(failed.station)].into_iter().chain(words));
        }
        table
    }
}

/// What has to be said of an axle's curves, a line each: of their accuracy, and of what has no value.
pub fn axle_remarks(axle: &Axle, plan: &AxlePlan, curves: &AxleCurves) -> Vec<String> {
    let of_stations = StationColumns { plan, axle };
    let unit = axle.left.length_unit.symbol();
    let proved = certificate(&of_stations, curves).map(|c| c.remark(curves.stations.len(), unit));
    let lacking = unsupported(&of_stations, curves).into_iter();
    let lacking = lacking.chain(toggled(&of_stations, curves));
    let empty = Completeness::of_axle(curves);
    proved
        .into_iter()
        .chain(lacking)
        .chain(empty.remarks())
        .collect()
}

/// Stations of an axle without a position, each by itself.
pub fn axle_failures(axle: &Axle, plan: &AxlePlan, curves: &AxleCurves) -> Vec<FailureRange> {
    let of_stations = StationColumns { plan, axle };
    let stations = curves.stations.iter().enumerate();
    let failed = stations.filter_map(|(number, station)| {
        let failure = station.placed.as_ref().err()?;
        Some(FailureRange {
            first: number,
            last: number,
            status: station.status.to_owned(),
            reason: failure.describe(axle),
            place: of_stations.words(number, station),
        })
    });
    failed.collect()
}

/// Where nothing carries the loads.
fn unsupported(of_stations: &StationColumns<'_>, curves: &AxleCurves) -> Option<String> {
    let stations = curves.stations.iter().enumerate();
    let mut lacking = stations.filter(|(_, s)| s.values.contains(&Err(Void::Unsupported)));
    let (number, first) = lacking.next()?;
    Some(format!(
        "warning: loads not carried at {}, the first at {}: {}",
        stations_in_words(1 + lacking.count()),
        of_stations.words(number, first),
        Void::Unsupported.reason(),
    ))
}

/// Where a rod of a rocker comes to a toggle, a sentence for each rod.
fn toggled(of_stations: &StationColumns<'_>, curves: &AxleCurves) -> Vec<String> {
    let mut said = Vec::new();
    for side in Side::ALL {
        for rod in [Rod::Pushrod, Rod::Pullrod, Rod::DropLink] {
            let stations = curves.stations.iter().enumerate();
            let stuck = stations.filter(|(_, s)| {
                s.status == Status::Toggle(rod).word() && s.toggles[side as usize] == Some(rod)
            });
            let stuck: Vec<_> = stuck.collect();
            let travel = |s: &AxleStation| {
                s.placed
                    .map_or(f64::INFINITY, |p| p.travels[side as usize].abs())
            };
            let nearest = stuck
                .iter()
                .min_by(|a, b| travel(a.1).total_cmp(&travel(b.1)));
            said.extend(nearest.map(|(number, station)| {
                let (wheel, nearest) = (side.name(), of_stations.words(*number, station));
                at_toggle(&format!("{wheel} wheel's "), rod, stuck.len(), nearest)
            }));
        }
    }
    said
}

/// What was proved of some curves, where that was asked for: of the worse wheel.
pub(super) fn certificate(
    of_stations: &StationColumns<'_>,
    curves: &AxleCurves,
) -> Option<CertificateSummary<String>> {
    if !of_stations.plan.certify {
        return None;
    }
    let stations = || curves.stations.iter().enumerate();
    let proofs = stations().filter_map(|(number, station)| {
        let AxleProof {
            position_errors: [left, right],
            uniqueness,
            ..
        } = station.proof?;
        let worse = Proof {
            position_error: left.max(right),
            uniqueness,
        };
        Some(((number, station), worse))
    });
    let unproved = |(_, s): &(usize, &AxleStation)| {
        let failure = s.placed.as_ref().err();
        failure.is_some_and(|f| f.is_unproven())
    };
    let unproved = stations().filter(unproved).count();
    let summary = CertificateSummary::of_proofs(proofs, unproved, curves.stations.len());
    Some(summary.at(|(number, station)| of_stations.words(number, station)))
}

/// What of the right wheel is not the mirror image.
fn right_wheel(axle: &Axle) -> String {
    let (left, right) = (&axle.left, axle.suspension(Side::Right));
    let springs = axle.setup.springs.as_ref();
    let own = [
        ("hardpoints", left.design != right.design),
        (
            "wheel",
            left.mechanism.spin_axis != right.mechanism.spin_axis,
        ),
        ("bodies", left.mechanism.points != right.mechanism.points),
        ("spring", springs.is_some_and(|[left, right]| left != right)),
    ];
    let own: Vec<_> = own
        .iter()
        .filter(|(_, own)| *own)
        .map(|(of, _)| *of)
        .collect();
    match own.as_slice() {
        [] => "mirrored".to_owned(),
        [one] => format!("own {one} on the right"),
        [most @ .., last] => format!("own {} and {last} on the right", most.join(", ")),
    }
}

/// What is possible but seldom meant in a study of an axle, a line each.
pub fn axle_plausibility(axle: &Axle, curves: &AxleCurves, turns_against: bool) -> Vec<String> {
    let mut remarks = Vec::new();
    if turns_against {
        let c_factor = axle.setup.c_factor.unwrap_or(0.0) * axle.left.frame.sign(Axis::Y);
        remarks.push(format!(
            "doubtful: with c_factor = {c_factor} the wheels turn against the steering wheel; behind the \
             wheel centres a rack moves to the right in a left turn"
        ));
    }
    if let Some((load, _)) = curves.least_wheel_load().filter(|(load, _)| *load < 0.0) {
        remarks.push(format!(
            "warning: a wheel load falls to {} N: there the wheel would lift off the ground",
            shortest(load.round())
        ));
    }
    let reads_springs = |column: &AxleColumn| {
        column
            .quantity()
            .is_some_and(|quantity| quantity.info().needs.contains(&Need::SpringForce))
    };
    if curves.columns.iter().any(reads_springs) {
        let beyond = axle.beyond_force_curves(curves);
        remarks.extend(beyond.iter().map(|beyond| beyond_curve(axle, beyond)));
    }
    remarks
}

/// A doubt about a spring or bump stop that is beyond an end of its force curve.
fn beyond_curve(axle: &Axle, beyond: &BeyondCurve) -> String {
    let unit = axle.left.length_unit.symbol();
    let [value, end, travel] = [beyond.value, beyond.end, beyond.travel].map(brief);
    let side = beyond.side.name();
    let (part, is) = match beyond.part {
        ForcePart::Spring => ("spring", format!("{value} {unit} long")),
        ForcePart::BumpStop => ("bump stop", format!("compressed by {value} {unit}")),
    };
    format!(
        "doubtful: {side} wheel at travel {travel} {unit}: the {part} is {is}, beyond the end of its force_curve at \
         {end} {unit}. There its force follows the straight line through that end. Add points to the curve"
    )
}
