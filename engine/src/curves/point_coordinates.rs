//! Runs a plan with the formulation in point coordinates.

use super::run::{Findings, Run};
use crate::mechanism::{Configuration, DesignFault, Pose};
use crate::number::{Jet, array_of};
use crate::solve::{FormulationMotion, FormulationPose, FormulationVisit, point_coordinates};

impl<const N: usize> Run<'_, N> {
    pub(super) fn by_point_coordinates(&mut self) -> Result<(), DesignFault> {
        let plan = self.plan;
        let racks: Vec<f64> = plan.racks.iter().map(|r| r * plan.rack_sign).collect();
        let motion = FormulationMotion {
            drive: plan.drive,
            values: plan.station_order.values(),
            racks: &racks,
            coefficients: N,
        };
        let formulation = point_coordinates()?;
        self.work = formulation.poses(self.suspension, &motion, &mut |visit| match visit {
            FormulationVisit::Start { pose, rack } => {
                let at = self.configuration(&pose, rack);
                self.toggles.begin_at(&at);
            }
            FormulationVisit::Station {
                rack,
                number,
                found,
            } => {
                let found = found.map(|found| self.findings(&found, number));
                self.note(rack, number, found);
            }
        })?;
        Ok(())
    }

    fn findings(&self, found: &FormulationPose, number: usize) -> Findings {
        let configuration = self.configuration(&found.pose, found.rack);
        Findings {
            condition: Some(found.condition),
            ..self.values(None, &configuration, number, found.drive)
        }
    }

    fn configuration(&self, pose: &Pose<Jet<f64, 3>>, rack: f64) -> Configuration<'_, Jet<f64, N>> {
        let series = pose.map(|c| Jet(array_of(|k| c.0.get(k).copied().unwrap_or(0.0))));
        let rack = Jet::constant(rack);
        self.design_series
            .at(&self.suspension.mechanism, series, rack)
    }
}
