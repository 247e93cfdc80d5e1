//! CSV files of a run.

use super::optional;
use crate::curves::{Curves, MotionColumn, Station};
use crate::optimise::Multistart;
use crate::study::Study;

/// Makes a CSV file in memory.
pub(super) fn csv_of(write: impl FnOnce(&mut csv::Writer<Vec<u8>>) -> csv::Result<()>) -> Vec<u8> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    // Writing to memory cannot fail, and every record has the length of its header.
    write(&mut writer).expect("all records have the same length");
    writer
        .into_inner()
        .expect("writing to memory does not fail")
}

/// Makes a CSV file from rows.
pub(super) fn csv_of_rows(mut rows: impl Iterator<Item = Vec<String>>) -> Vec<u8> {
    csv_of(|writer| rows.try_for_each(|row| writer.write_record(row)))
}

/// Names of the motion's columns in files.
pub fn motion_names(curves: &Curves) -> Vec<String> {
    let written = curves.motion.iter().filter(|column| column.is_written);
    written.map(MotionColumn::name).collect()
}

/// Values of the motion's columns at one station, as cells of CSV files.
fn motion_values(curves: &Curves, station: &Station) -> Vec<String> {
    let all = curves.motion.iter().zip(&station.at);
    let written = all.filter(|(column, _)| column.is_written);
    written.map(|(_, value)| optional(*value)).collect()
}

/// Content of `curves.csv`: one row per station, with `status` as the last column. A missing value is an empty cell.
pub fn curves_csv(curves: &Curves) -> Vec<u8> {
    csv_of(|writer| {
        let mut header = motion_names(curves);
        header.extend(curves.columns.iter().map(|c| c.name.clone()));
        header.extend_from_slice(&curves.bounds);
        header.push("status".to_owned());
        writer.write_record(&header)?;
        for station in &curves.stations {
            let mut record = motion_values(curves, station);
            record.extend(station.values.iter().map(|v| optional(v.ok())));
            let bound = |k: usize| optional(station.proof.as_ref().map(|proof| proof.bounds[k]));
            record.extend((0..curves.bounds.len()).map(bound));
            record.push(station.status.word().to_owned());
            writer.write_record(&record)?;
        }
        Ok(())
    })
}

/// Content of `sensitivities.csv`: one row for each station, output, hardpoint and axis. For one wheel there is a column with
/// the order of the derivative. For an axle there is a column with the side whose hardpoint moves.
pub fn sensitivities_csv(study: &Study, curves: &Curves) -> Vec<u8> {
    let (wheel, is_axle) = (study.wheel(), study.axle().is_some());
    csv_of(|writer| {
        let mut header = motion_names(curves);
        let own: &[&str] = if is_axle {
            &["output", "side", "hardpoint", "axis", "value", "unit"]
        } else {
            &["output", "hardpoint", "axis", "order", "value", "unit"]
        };
        header.extend(own.iter().map(|name| (*name).to_owned()));
        writer.write_record(&header)?;
        for s in &curves.sensitivities {
            let column = &curves.columns[s.column];
            let mut record = motion_values(curves, &curves.stations[s.station]);
            let point = wheel.mechanism.name(s.point).to_owned();
            let (axis, value) = (s.axis.name().to_owned(), optional(s.value));
            let unit = column.unit_per(wheel.length_unit);
            let output = column.output.clone();
            record.extend(if is_axle {
                let side = s.side.map_or("both", |side| side.name()).to_owned();
                [output, side, point, axis, value, unit]
            } else {
                [output, point, axis, column.order.to_string(), value, unit]
            });
            writer.write_record(&record)?;
        }
        Ok(())
    })
}

/// Content of `history.csv`: one row for each iteration of each start. A number that is not finite is an empty cell.
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
                    optional(i.misfit),
                    optional(i.cost),
                    optional(i.step),
                    optional(i.damping),
                    i.held.to_string(),
                    i.evaluations.to_string(),
                    i.infeasible.to_string(),
                ])?;
            }
        }
        Ok(())
    })
}
