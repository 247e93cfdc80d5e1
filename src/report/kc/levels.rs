//! `levels.csv`: the equilibrium at each level of a test load.

use super::super::shortest;
use super::{KcResults, bar, csv, held, mode, no_equilibrium, optional, status, steering};
use crate::compliance::{
    BushingReading, KcLevel, KcState, KcStation, KcTest, KcWheelState, TestLoad, TestMode,
};
use crate::model::{Axis, Frame};
use crate::number::Vector3;

/// Number of columns for the state of a wheel, without the columns of its bushings and links.
const WHEEL_CELLS: usize = 12;
/// Number of columns for each bushing.
const BUSHING_CELLS: usize = 12;

impl KcResults<'_> {
    /// Content of `levels.csv`: one row per load level (load at which the equilibrium is computed). `None` if no test has load
    /// levels, or if no station has an equilibrium.
    pub fn levels_csv(&self) -> Option<Vec<u8>> {
        let mut header = self.station_columns();
        header.extend(self.columns(&["load", "trail_U", "mode", "hold", "anti_roll_bar"]));
        header.extend(self.is_axle.then(|| "steering".to_owned()));
        header.extend(self.columns(&["side", "level", "force_N", "moment_N_m"]));
        let sides: &[&str] = if self.is_axle {
            &["left_", "right_"]
        } else {
            &[""]
        };
        for side in sides {
            let own = self.wheel_columns();
            header.extend(own.into_iter().map(|name| format!("{side}{name}")));
        }
        if self.is_axle {
            let of_axle = ["mean_steer_deg", "rack_force_N", "anti_roll_bar_torque_N_m"];
            header.extend(of_axle.map(str::to_owned));
        }
        header.extend(["share", "reason", "status"].map(str::to_owned));
        let mut rows = Vec::new();
        for station in &self.stations {
            for outcome in station.outcomes.iter().flatten() {
                for level in &outcome.levels {
                    rows.push(self.level_row(station, &outcome.test, level, header.len()));
                }
            }
        }
        (!rows.is_empty()).then(|| csv(header, rows))
    }

    /// Names of the columns for a wheel's state. Angles have the signs of a left wheel, and coordinates are in the study's axes.
    /// The values of a bushing are along and about the axes of the bushing.
    fn wheel_columns(&self) -> Vec<String> {
        let mut header = self.columns(&[
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
        header
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
        let side = match test.mode {
            TestMode::Single(side) => side.name(),
            _ => "",
        };
        row.extend([mode(test), held(test), bar(test)].map(str::to_owned));
        row.extend(self.is_axle.then(|| steering(test).to_owned()));
        row.push(side.to_owned());
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
        let frame = self.suspension.frame;
        let frames = [frame, frame.of_other_side()];
        let wheels = state.wheels.iter().zip(frames);
        let mut cells: Vec<Option<f64>> = wheels
            .flat_map(|(wheel, frame)| self.wheel_cells(wheel, frame))
            .collect();
        if let Some(axle) = state.axle {
            let per_metre = self.length().per_metre();
            cells.extend([
                Some(axle.mean_steer.to_degrees()),
                Some(axle.rack_force),
                axle.bar_torque.map(|torque| torque / per_metre),
            ]);
        }
        cells
    }

    fn wheel_cells(&self, state: &KcWheelState, frame: Frame) -> Vec<Option<f64>> {
        let per_metre = self.length().per_metre();
        let figures = &state.figures;
        let degrees = |angle: f64| Some(angle.to_degrees());
        let point = |v: Vector3<f64>| frame.vector(v).to_array().map(Some);
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
        // The last bushings and links of a solid axle exist only once. The cells of the right wheel for these parts stay empty.
        let before_links = WHEEL_CELLS + BUSHING_CELLS * self.bushings.len();
        cells.resize(before_links, None);
        cells.extend(state.tensions.iter().copied());
        cells.resize(before_links + self.links.len(), None);
        cells
    }
}
