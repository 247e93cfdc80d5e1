//! Columns of a sweep's curves that give the position of a station.

use crate::model::Axis;
use crate::report::given_columns::GivenColumns;
use crate::study::{AxleStudy, Study};
use crate::sweep::SweepPlan;
use crate::sweep::csv::CurvesCsv;

/// Names of the columns that give the position of a station, and a list of the stations of the motion. A list entry has the index
/// of the station among all evaluated stations, and its values in these columns.
type Places = (Vec<String>, Vec<(usize, Vec<f64>)>);

/// Columns of a wheel's stations: drive value (travel or angle), rack displacement (if the rack moves) and time (for a time law).
/// Values are in printed units and in the study's axes.
fn of_wheel(plan: &SweepPlan, study: &Study) -> Places {
    let (motion, suspension) = (study.motion(), study.wheel());
    let mut names = vec![plan.record.drive.clone()];
    names.extend(
        motion
            .rack_moves
            .then(|| format!("rack_{}", suspension.length_unit.symbol())),
    );
    names.extend(motion.time.is_some().then(|| "time_s".to_owned()));
    let sign = suspension.frame.sign(Axis::Y);
    let stations = plan.stations();
    let place = |station: usize| {
        let (rack, value) = (stations.rack_of(station), stations.value_of(station));
        let mut values = vec![motion.drive.printed(stations.values()[value])];
        values.extend(motion.rack_moves.then(|| stations.racks[rack] * sign));
        values.extend(motion.time.as_ref().map(|law| law.times[value]));
        (station, values)
    };
    (names, stations.of_motion().map(place).collect())
}

/// Columns of an axle's stations: the coordinates that define the motion. Results, such as the wheel travels in roll, are left out.
fn of_axle(AxleStudy { axle, plan, .. }: &AxleStudy) -> Places {
    let columns = GivenColumns { plan, axle };
    let placements = plan.motion.placements().into_iter().enumerate();
    let stations = placements.map(|(number, at)| (number, columns.values(number, &at)));
    (columns.names(), stations.collect())
}

/// Makes the writer of a sweep's curves.
pub(super) fn curves_csv(plan: &SweepPlan, study: &Study) -> CurvesCsv {
    let (places, stations) = match study.axle() {
        Some(both) => of_axle(both),
        None => of_wheel(plan, study),
    };
    CurvesCsv::of(plan, places, stations)
}
