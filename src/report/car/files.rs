//! `cases.csv` and `gg.csv` of a car.

use super::{CarMap, CarResults, CarState, lifted_wheels, state};
use crate::car::{CarMember, CarSolver, Case, Longitudinal, RowResult};
use crate::model::Axis;
use crate::report::files::csv_of_rows;
use crate::report::{optional, shortest};
use crate::study::GgMap;
use crate::threads::stoppable;
use rayon::prelude::*;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

/// Makes a CSV file with a header.
pub(super) fn csv(header: &[String], rows: impl IntoIterator<Item = Vec<String>>) -> Vec<u8> {
    csv_of_rows(std::iter::once(header.to_vec()).chain(rows))
}

/// Results of a g-g map: states of the car over forward acceleration ax and lateral acceleration ay.
pub struct GgResults {
    /// Content of `gg.csv`.
    pub csv: Vec<u8>,
    /// States of the map in the form for the page.
    pub map: CarMap,
    /// Number of states without equilibrium in the finished rows.
    pub failures: usize,
    /// Number of finished rows, and total number of rows. In an interrupted map, rows are missing.
    pub rows: [usize; 2],
}

impl GgResults {
    /// Describes the missing rows of an interrupted map. `None` for a complete map.
    pub fn unfinished_in_words(&self) -> Option<String> {
        let [finished, all] = self.rows;
        (finished < all).then(|| {
            format!("interrupted: gg.csv has {finished} of {all} rows of gg_map (one row for each ax); run the study again for all rows")
        })
    }
}

impl<'s> CarResults<'s> {
    /// Names of the columns of the requested results.
    fn columns(&self) -> Vec<String> {
        let unit = self.study.car.length_unit;
        self.study
            .quantities
            .iter()
            .map(|q| q.column(unit))
            .collect()
    }

    /// Cells of the requested results in a state. Cells of undefined results are empty. If the case has no equilibrium, all cells
    /// are empty.
    fn values(&self, state: &CarState<'_>, case: &Case) -> Vec<String> {
        let quantities = self.study.quantities.iter();
        match state {
            CarState::Solved { solved, .. } => quantities
                .map(|q| optional(q.printed(solved, case)))
                .collect(),
            CarState::Failed(_) => quantities.map(|_| String::new()).collect(),
        }
    }

    /// Reason why a case has no equilibrium (empty if it has one), and its status. They are the last two cells of its row.
    pub(super) fn end(&self, state: &CarState<'_>) -> [String; 2] {
        match state {
            CarState::Solved { .. } => [String::new(), "ok".to_owned()],
            CarState::Failed(why) => {
                let reason = why.describe(&self.study.car);
                [reason, why.status().to_owned()]
            }
        }
    }

    /// Rack displacement of a case, in the study's axes.
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
                row.extend(self.end(state));
                row
            });
        csv(&header, rows)
    }

    /// States of a g-g map, on the threads of the current rayon pool. Each row has one ax and its own copy of the solver, and each
    /// state of a row starts from the previous one. So the results do not depend on the number of threads. If `flag` is set, rows
    /// that are not finished are left out.
    pub fn gg(&self, solver: CarSolver<'s>, map: &GgMap, flag: &Arc<AtomicBool>) -> GgResults {
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
        let row = |ax: &f64| map.ay.iter().map(|ay| map.at(*ax, *ay)).collect();
        let cases: Vec<Vec<Case>> = map.ax.iter().map(row).collect();
        let cases: Vec<&[Case]> = cases.iter().map(Vec::as_slice).collect();
        let mut first = 0;
        let blocks = CarSolver::blocks_of(&cases).map(|block| {
            first += block.len();
            (first - block.len(), block)
        });
        let blocks: Vec<_> = blocks.collect();
        let blocks = blocks.par_iter().map_with(solver, |own, (first, block)| {
            let states = stoppable(flag, || states_of(own.clone(), block)).unwrap_or_default();
            let rows = map.ax[*first..].par_iter().zip(states);
            let rows = rows.map_with(own.clone(), |own, (ax, states)| {
                stoppable(flag, || self.gg_row(own.clone(), (map, *ax), states))
            });
            rows.collect()
        });
        let rows: Vec<Vec<Option<GgRow>>> = blocks.collect();
        let rows = rows.into_iter().flatten();
        let rows: Vec<GgRow> = rows.flatten().collect();
        let finished = rows.len();
        let mut shown = CarMap::of(&[], &map.ay);
        let mut csv = csv_of_rows(std::iter::once(header));
        let mut failures = 0;
        for row in rows {
            failures += row.failures;
            shown.append(row.shown);
            csv.extend(row.csv);
        }
        GgResults {
            csv,
            map: shown,
            failures,
            rows: [finished, map.ax.len()],
        }
    }

    /// Results of the states of a g-g map with the same ax.
    fn gg_row(
        &self,
        mut solver: CarSolver<'s>,
        (map, ax): (&GgMap, f64),
        states: Vec<RowResult>,
    ) -> GgRow {
        let mut rows = Vec::with_capacity(map.ay.len());
        let mut row = GgRow {
            csv: Vec::new(),
            shown: CarMap::of(&[ax], &map.ay),
            failures: 0,
        };
        for (ay, found) in map.ay.iter().zip(states) {
            let case = map.at(ax, *ay);
            let state = state(&mut solver, &case, found.map(|of| of.found));
            row.shown.push(&state, &case);
            let mut cells = vec![
                shortest(ax),
                shortest(*ay),
                shortest(case.az),
                shortest(case.speed),
                shortest(self.rack(&case)),
            ];
            match &state {
                CarState::Solved { found, .. } => cells.push(lifted_wheels(&found.lifted)),
                CarState::Failed(_) => {
                    cells.push(String::new());
                    row.failures += 1;
                }
            }
            cells.extend(self.values(&state, &case));
            cells.extend(self.end(&state));
            rows.push(cells);
        }
        row.csv = csv_of_rows(rows.into_iter());
        row
    }
}

/// Solves the states of a block of rows, several states at once in SIMD lanes.
fn states_of(mut solver: CarSolver<'_>, rows: &[&[Case]]) -> Vec<Vec<RowResult>> {
    let mut states: Vec<Vec<RowResult>> = rows
        .iter()
        .map(|row| Vec::with_capacity(row.len()))
        .collect();
    solver.solve_rows(rows, &mut |_, [row, _], state| states[row].push(state));
    states
}

/// States of a g-g map with the same ax.
struct GgRow {
    /// Lines of `gg.csv`, one per state.
    csv: Vec<u8>,
    shown: CarMap,
    failures: usize,
}

fn longitudinal(case: &Case) -> &'static str {
    match case.setting.longitudinal {
        Longitudinal::Brake => "brake",
        Longitudinal::Drive => "drive",
    }
}
