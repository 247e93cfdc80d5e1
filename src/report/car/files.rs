//! `cases.csv` and `gg.csv` of a car.

use super::{CarMap, CarResults, CarState, lifted_wheels, state};
use crate::car::{CarMember, CarSolver, Case, Equilibrium, Longitudinal};
use crate::model::Axis;
use crate::report::files::csv_of_rows;
use crate::report::{optional, shortest};

/// Makes a CSV file with a header.
pub(super) fn csv(header: &[String], rows: impl IntoIterator<Item = Vec<String>>) -> Vec<u8> {
    csv_of_rows(std::iter::once(header.to_vec()).chain(rows))
}

/// States over ax and ay (g-g map).
pub struct GgResults {
    /// Content of `gg.csv`.
    pub csv: Vec<u8>,
    /// States in the form for the page.
    pub map: CarMap,
    /// Number of states without equilibrium.
    pub failures: usize,
}

impl<'s> CarResults<'s> {
    fn columns(&self) -> Vec<String> {
        let unit = self.study.car.length_unit;
        self.study
            .quantities
            .iter()
            .map(|q| q.column(unit))
            .collect()
    }

    fn values(&self, state: &CarState<'_>, case: &Case) -> Vec<String> {
        let quantities = self.study.quantities.iter();
        match state {
            CarState::Solved { solved, .. } => quantities
                .map(|q| optional(q.printed(solved, case)))
                .collect(),
            CarState::Failed(_) => quantities.map(|_| String::new()).collect(),
        }
    }

    /// Reason and status of a state, as the last two cells of its row.
    pub(super) fn end(state: &CarState<'_>) -> [String; 2] {
        match state {
            CarState::Solved { .. } => [String::new(), "ok".to_owned()],
            CarState::Failed(why) => [why.to_string(), why.status().to_owned()],
        }
    }

    fn rack(&self, case: &Case) -> f64 {
        self.study.frame().sign(Axis::Y) * case.racks[0]
    }

    /// Content of `cases.csv`.
    pub fn cases_csv(&self) -> Vec<u8> {
        let rack = format!("rack_{}", self.unit());
        let fixed = [
            "case",
            "ax_g",
            "ay_g",
            "az_g",
            "speed_m_per_s",
            "yaw_acceleration_rad_per_s2",
            &rack,
            "steering_wheel_angle_deg",
            "longitudinal",
            "tyres",
            "wheels_lifted",
        ];
        let mut header: Vec<String> = fixed.map(str::to_owned).to_vec();
        header.extend(self.columns());
        let members = if self.study.member_loads {
            CarMember::all(&self.study.car)
        } else {
            Vec::new()
        };
        let unit = self.study.car.length_unit;
        let force_unit = unit.force_symbol();
        let column = |member: &CarMember| format!("{}_{force_unit}", member.label());
        header.extend(members.iter().map(column));
        header.extend(["reason".to_owned(), "status".to_owned()]);
        let per_turn = self.study.car.axles[0].setup.c_factor;
        let rows = self
            .study
            .cases
            .iter()
            .zip(self.states.iter().zip(&self.members))
            .map(|(case, (state, forces))| {
                let angle = per_turn.map(|per_turn| 360.0 * case.racks[0] / per_turn);
                let mut row = vec![
                    case.name.clone(),
                    shortest(case.ax),
                    shortest(case.ay),
                    shortest(case.az),
                    shortest(case.speed),
                    shortest(case.yaw_acceleration),
                    shortest(self.rack(case)),
                    optional(angle),
                    longitudinal(case).to_owned(),
                    if case.setting.elastic_tyres {
                        "elastic".to_owned()
                    } else {
                        "rigid".to_owned()
                    },
                    match state {
                        CarState::Solved { found, .. } => lifted_wheels(&found.lifted),
                        CarState::Failed(_) => String::new(),
                    },
                ];
                row.extend(self.values(state, case));
                let force =
                    |number: usize| optional(forces.get(number).map(|f| f / unit.newtons()));
                row.extend((0..members.len()).map(force));
                row.extend(Self::end(state));
                row
            });
        csv(&header, rows)
    }

    /// States of the g-g map, if the study requests it. Each state starts from its neighbour.
    pub fn gg(&self, solver: &mut CarSolver<'s>) -> Option<GgResults> {
        let map = self.study.gg_map.as_ref()?;
        let mut shown = CarMap::of(&map.ax, &map.ay);
        let rack = format!("rack_{}", self.unit());
        let fixed = [
            "ax_g",
            "ay_g",
            "az_g",
            "speed_m_per_s",
            &rack,
            "wheels_lifted",
        ];
        let mut header: Vec<String> = fixed.map(str::to_owned).to_vec();
        header.extend(self.columns());
        header.extend(["reason".to_owned(), "status".to_owned()]);
        let mut rows = Vec::new();
        let mut failures = 0;
        for ax in &map.ax {
            let mut before: Option<Equilibrium> = None;
            for ay in &map.ay {
                let case = map.at(*ax, *ay);
                let state = state(solver, &case, before.as_ref());
                shown.push(&state, &case);
                let mut row = vec![
                    shortest(*ax),
                    shortest(*ay),
                    shortest(case.az),
                    shortest(case.speed),
                    shortest(self.rack(&case)),
                ];
                match &state {
                    CarState::Solved { found, .. } => {
                        row.push(lifted_wheels(&found.lifted));
                        before = Some(Equilibrium::clone(found));
                    }
                    CarState::Failed(_) => {
                        row.push(String::new());
                        failures += 1;
                    }
                }
                row.extend(self.values(&state, &case));
                row.extend(Self::end(&state));
                rows.push(row);
            }
        }
        Some(GgResults {
            csv: csv(&header, rows),
            map: shown,
            failures,
        })
    }
}

fn longitudinal(case: &Case) -> &'static str {
    match case.setting.longitudinal {
        Longitudinal::Brake => "brake",
        Longitudinal::Drive => "drive",
    }
}
