//! Tests of a kinematics and compliance rig (`hardpoint kc`) on a study: tables and summary for the command line and for other
//! programs.

use crate::axle::Placement;
use crate::compliance::{AxleCompliance, AxleKcRun, Compliance, KcRun, KcTest};
use crate::model::{Axis, Constraint, Suspension};
use crate::report::{KcResults, OtherProgram};
use crate::study::{AxleComplianceStudy, AxleStudy, ComplianceStudy, Drive, Study};
use serde_json::{Value, json};
use std::borrow::Cow;

/// Name of a file and its contents.
pub type RigFile = (&'static str, Vec<u8>);

/// File names of the tables in addition to `kc.csv`. Only some studies have these tables.
pub const OTHER_TABLES: [&str; 3] = ["levels.csv", "compliance_matrix.csv", "sensitivities.csv"];

/// Rig tests of a study at the stations of its motion.
pub struct RigTests<'s> {
    study: &'s Study,
    /// Number that [`RigTests::elastic_parts`] returns.
    elastic_parts: usize,
    /// Results of the tests.
    pub results: KcResults<'s>,
    sensitivities: Option<Vec<u8>>,
}

impl<'s> RigTests<'s> {
    /// Runs the rig tests of a study with its elastic parts, or with its rigid mechanism. `other` is a program whose names for the
    /// results are added to the names of this program. An error explains why the tests are not available for the study.
    pub fn of(study: &'s Study, other: Option<OtherProgram>) -> Result<Self, String> {
        if let Some(axle) = study.axle() {
            return RigTests::of_axle(study, axle, other);
        }
        let elastic = elastic_or_rigid(study)?;
        let (suspension, parts) = (study.wheel(), &elastic.parts);
        let run =
            KcRun::new(suspension, parts, elastic.tyre_rate).map_err(|fault| fault.describe())?;
        let mechanism = &suspension.mechanism;
        let bushings = parts.bushings.iter();
        let results = KcResults {
            suspension,
            design_loads: run.wheel().design_load().into_iter().collect(),
            is_axle: false,
            bushings: bushings
                .map(|part| mechanism.name(part.point).to_owned())
                .collect(),
            links: elastic.link_names.clone(),
            stations: run.run(&study.motion().values, &study.motion().rack, &elastic.tests),
            tyre_rate: elastic.tyre_rate,
            other,
        };
        let points = study.one_wheel().map(|own| &own.outputs.sensitivities[..]);
        let sensitivities = results.sensitivities_csv(&run, parts, points.unwrap_or_default());
        Ok(RigTests {
            study,
            results,
            sensitivities,
            elastic_parts: parts.bushings.len() + parts.links.len(),
        })
    }

    /// Runs the rig tests of an axle.
    fn of_axle(
        study: &'s Study,
        axle: &'s AxleStudy,
        other: Option<OtherProgram>,
    ) -> Result<Self, String> {
        let elastic = match &axle.axle.elastic {
            Some(elastic) => Cow::Borrowed(&**elastic),
            None => Cow::Owned(rigid_axle(axle)?),
        };
        let vehicle = axle.axle.on_rig(elastic.tyre_rate);
        let suspension = &axle.axle.left;
        let run = AxleKcRun::new(vehicle, &elastic.parts).map_err(|fault| fault.describe())?;
        let loads = run.design_loads();
        let bushings = elastic.bushing_names(suspension);
        let rack = usize::from(elastic.parts.rack_rate.is_some())
            + usize::from(elastic.parts.column.is_some());
        let results = KcResults {
            suspension,
            design_loads: loads.into_iter().flatten().collect(),
            is_axle: true,
            links: elastic.link_names.clone(),
            stations: run.run(&stations(axle), &elastic.tests),
            tyre_rate: elastic.tyre_rate,
            other,
            bushings,
        };
        Ok(RigTests {
            study,
            elastic_parts: results.bushings.len() + results.links.len() + rack,
            sensitivities: results.axle_sensitivities_csv(
                &run,
                &elastic.parts,
                &axle.plan.sensitivities,
            ),
            results,
        })
    }

    /// Number of bushings and elastic links. For an axle it counts the parts of one wheel, the mounts of the subframe, an elastic
    /// rack and an elastic steering column.
    pub fn elastic_parts(&self) -> usize {
        self.elastic_parts
    }

    /// `kc.csv`, and the other tables of this study.
    pub fn tables(&self) -> Vec<RigFile> {
        let mut files = vec![("kc.csv", self.results.kc_csv())];
        let others = OTHER_TABLES.into_iter().zip([
            self.results.levels_csv(),
            self.results.matrix_csv(),
            self.sensitivities.clone(),
        ]);
        files.extend(others.filter_map(|(name, csv)| Some((name, csv?))));
        files
    }

    /// Content of `summary.json` of `hardpoint kc`.
    pub fn summary(&self) -> Value {
        json!({
            "command": "kc",
            "study": self.study.name,
            "is_rigid": self.elastic_parts == 0,
            "design_load_N": if self.results.is_axle { json!(self.results.design_loads) } else { json!(self.results.design_loads.first()) },
            "stations": self.results.stations.len(),
            "without_equilibrium": self.results.failures(),
            "warnings": self.results.warnings(),
        })
    }
}

/// Travels of both wheels and rack displacement along the study's +y, at each station of an axle's motion on level pads.
fn stations(both: &AxleStudy) -> Vec<([f64; 2], f64)> {
    let placements = both.plan.motion.placements();
    let along = both.axle.left.frame.sign(Axis::Y);
    // Motions of axles with elastic parts always have level wheel pads. For other axles the motion may have none. Then the list is
    // empty, and `rigid_axle` refuses the motion.
    let on_pads = placements.iter().filter_map(Placement::on_level_pads);
    let in_study = |(travels, rack): ([f64; 2], f64)| (travels, along * rack + 0.0);
    on_pads.map(in_study).collect()
}

/// Returns an error for a rigid mechanism that the rig tests do not support.
fn check_rigid(suspension: &Suspension) -> Result<(), String> {
    let mechanism = &suspension.mechanism;
    let holds_twice = |c: &Constraint| mechanism.arm_under(c).is_some();
    if mechanism.constraints.iter().any(holds_twice) {
        return Err(format!(
            "`hardpoint kc` is not available for {}: its lower arm is joined to the wheel carrier \
             at two points. `hardpoint solve` computes its curves",
            mechanism.topology.name
        ));
    }
    match suspension.wheel_radius {
        Some(_) => Ok(()),
        None => {
            Err("`hardpoint kc` needs radius in [wheel]: loads act at the contact point".to_owned())
        }
    }
}

/// Rigid mechanism of an axle, with the default rig tests. The error explains why the tests are not available.
fn rigid_axle(study: &AxleStudy) -> Result<AxleComplianceStudy, String> {
    if study.axle.is_rigid() {
        return Err(match study.axle.left.mechanism.why_not_elastic() {
            Some(reason) => format!(
                "`hardpoint kc` is not available: {reason}. `hardpoint solve` computes the curves"
            ),
            None => {
                "`hardpoint kc` of a solid axle needs elastic links: expected [compliance], and \
                     axial_stiffness in [links.NAME]"
                    .to_owned()
            }
        });
    }
    let suspension = &study.axle.left;
    check_rigid(suspension)?;
    let motion = &study.plan.motion;
    if motion.time.is_some() || stations(study).is_empty() {
        return Err(
            "`hardpoint kc` of an axle needs stations on level pads: expected heave, or travel_left and travel_right, in [motion]"
                .to_owned(),
        );
    }
    let rigid = || Compliance::rigid(None);
    Ok(AxleComplianceStudy {
        parts: AxleCompliance {
            wheels: [rigid(), rigid()],
            subframe: None,
            rack_rate: None,
            column: None,
            bar_rate: None,
        },
        link_names: Vec::new(),
        figures: Vec::new(),
        tests: KcTest::defaults_of_axle(
            true,
            false,
            suspension.mechanism.has_rack(),
            suspension.length_unit,
        ),
        tyre_rate: None,
    })
}

/// Elastic parts of a study of one wheel with its rig tests. Without elastic parts: the rigid mechanism with the default tests.
/// The error explains why the tests are not available.
fn elastic_or_rigid(study: &Study) -> Result<Cow<'_, ComplianceStudy>, String> {
    if let Some(elastic) = study.compliance() {
        return Ok(Cow::Borrowed(elastic));
    }
    check_rigid(study.wheel())?;
    if study.motion().drive != Drive::Travel {
        return Err(
            "`hardpoint kc` needs stations of wheel travel: expected travel in [motion]".to_owned(),
        );
    }
    Ok(Cow::Owned(ComplianceStudy {
        parts: Compliance::rigid(None),
        link_names: Vec::new(),
        tests: KcTest::defaults(true, false, study.wheel().length_unit),
        tyre_rate: None,
    }))
}
