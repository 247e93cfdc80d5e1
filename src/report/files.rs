//! The CSV files of a run.

use super::{optional, shortest};
use crate::curves::{Curves, Station};
use crate::model::{LengthUnit, Mechanism};
use crate::optimise::Multistart;
use crate::plan::Plan;
use crate::study::Drive;

/// A CSV file in memory.
pub(super) fn csv_of(write: impl FnOnce(&mut csv::Writer<Vec<u8>>) -> csv::Result<()>) -> Vec<u8> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    // Writing to memory cannot fail, and every record is written with its header's length.
    write(&mut writer).expect("records of one length");
    writer.into_inner().expect("memory takes everything")
}

/// A CSV file of given rows.
pub(super) fn csv_of_rows(mut rows: impl Iterator<Item = Vec<String>>) -> Vec<u8> {
    csv_of(|writer| rows.try_for_each(|row| writer.write_record(row)))
}

/// The columns that say where on the motion a row is: names and values.
struct MotionColumns {
    drive: Drive,
    rack: bool,
    time: bool,
    length: LengthUnit,
}

impl MotionColumns {
    fn of(plan: &Plan, length: LengthUnit) -> Self {
        MotionColumns {
            drive: plan.drive,
            rack: plan.rack_moves,
            time: plan.time.is_some(),
            length,
        }
    }

    fn names(&self) -> Vec<String> {
        let unit = self.length.symbol();
        let mut names = vec![format!("travel_{unit}")];
        let angle = || self.drive.column(self.length);
        names.extend(self.drive.is_angle().then(angle));
        names.extend(self.rack.then(|| format!("rack_{unit}")));
        names.extend(self.time.then(|| "time_s".to_owned()));
        names
    }

    fn values(&self, station: &Station) -> Vec<String> {
        let mut values = vec![optional(station.travel)];
        let angle = || optional(station.angle);
        values.extend(self.drive.is_angle().then(angle));
        values.extend(self.rack.then(|| shortest(station.rack)));
        values.extend(self.time.then(|| optional(station.time)));
        values
    }
}

/// `curves.csv`: a row for each station, `status` last; a value that does not exist is an empty cell.
pub fn curves_csv(curves: &Curves, plan: &Plan, length: LengthUnit) -> Vec<u8> {
    let motion = MotionColumns::of(plan, length);
    csv_of(|writer| {
        let mut header = motion.names();
        header.extend(curves.columns.iter().map(|c| c.name.clone()));
        let unit = length.symbol();
        if plan.certify {
            header.extend([
                format!("position_error_{unit}"),
                format!("uniqueness_{unit}"),
            ]);
        }
        header.push("status".to_owned());
        writer.write_record(&header)?;
        for station in &curves.stations {
            let mut record = motion.values(station);
            record.extend(station.values.iter().map(|v| optional(*v)));
            if plan.certify {
                record.push(optional(station.proof.map(|p| p.position_error)));
                record.push(optional(station.proof.map(|p| p.uniqueness)));
            }
            record.push(station.status.word().to_owned());
            writer.write_record(&record)?;
        }
        Ok(())
    })
}

/// `sensitivities.csv`: a row for each station, output, order, hardpoint and axis.
pub fn sensitivities_csv(
    curves: &Curves,
    plan: &Plan,
    mechanism: &Mechanism,
    length: LengthUnit,
) -> Vec<u8> {
    let motion = MotionColumns::of(plan, length);
    csv_of(|writer| {
        let mut header = motion.names();
        for name in ["output", "hardpoint", "axis", "order", "value", "unit"] {
            header.push(name.to_owned());
        }
        writer.write_record(&header)?;
        for s in &curves.sensitivities {
            let column = &curves.columns[s.column];
            let mut record = motion.values(&curves.stations[s.station]);
            record.extend([
                column.output.clone(),
                mechanism.name(s.point).to_owned(),
                s.axis.name().to_owned(),
                column.order.to_string(),
                optional(s.value),
                column.unit_per(length),
            ]);
            writer.write_record(&record)?;
        }
        Ok(())
    })
}

/// `history.csv`: a row for each iteration of each start.
pub fn history_csv(starts: &Multistart) -> Vec<u8> {
    csv_of(|writer| {
        writer.write_record([
            "start",
            "iteration",
            "misfit",
            "cost",
            "step",
            "damping",
            "at_bounds",
            "evaluations",
            "infeasible",
        ])?;
        for (number, start) in starts.starts.iter().enumerate() {
            for i in start.outcome.iter().flat_map(|fit| &fit.history) {
                writer.write_record([
                    number.to_string(),
                    i.iteration.to_string(),
                    shortest(i.misfit),
                    shortest(i.cost),
                    shortest(i.step),
                    shortest(i.damping),
                    i.held.to_string(),
                    i.evaluations.to_string(),
                    i.infeasible.to_string(),
                ])?;
            }
        }
        Ok(())
    })
}
