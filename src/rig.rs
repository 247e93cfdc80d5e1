//! Tests of a rig on a study: tables and summary, which the command line and embedding programs share.

use crate::compliance::{Compliance, KcRun, KcTest};
use crate::report::{KcResults, OtherProgram};
use crate::study::{ComplianceStudy, Drive, Study};
use serde_json::{Value, json};
use std::borrow::Cow;

/// Name of a file and its contents.
pub type RigFile = (&'static str, Vec<u8>);

/// Tables that some studies have beside `kc.csv`.
pub const OTHER_TABLES: [&str; 3] = ["levels.csv", "compliance_matrix.csv", "sensitivities.csv"];

/// The tests of a study at its stations.
pub struct RigTests<'s> {
    study: &'s Study,
    elastic: Cow<'s, ComplianceStudy>,
    /// Results of the tests.
    pub results: KcResults<'s>,
    sensitivities: Option<Vec<u8>>,
}

impl<'s> RigTests<'s> {
    /// Runs the tests of a study: with its elastic parts, or those of the rigid mechanism. `other` is the program whose
    /// names stand beside ours. An error says why there are no tests.
    pub fn of(study: &'s Study, other: Option<OtherProgram>) -> Result<Self, String> {
        let elastic = elastic_or_rigid(study)?;
        let (suspension, parts) = (study.wheel(), &elastic.parts);
        let run = KcRun::new(suspension, parts, elastic.tyre_rate)
            .map_err(|fault| fault.describe(parts, suspension))?;
        let mechanism = &suspension.mechanism;
        let bushings = parts.bushings.iter();
        let results = KcResults {
            suspension,
            design_load: run.wheel().design_load(),
            bushings: bushings
                .map(|part| mechanism.name(part.point).to_owned())
                .collect(),
            links: elastic.link_names.clone(),
            stations: run.run(&study.motion().values, &study.motion().rack, &elastic.tests),
            other,
        };
        let points = study.one_wheel().map(|own| &own.outputs.sensitivities[..]);
        let sensitivities = results.sensitivities_csv(&run, parts, points.unwrap_or_default());
        Ok(RigTests {
            study,
            results,
            sensitivities,
            elastic,
        })
    }

    /// Number of bushings and elastic links.
    pub fn elastic_parts(&self) -> usize {
        self.elastic.parts.bushings.len() + self.elastic.parts.links.len()
    }

    /// `kc.csv`, and the other tables that there are.
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

    /// `summary.json`.
    pub fn summary(&self) -> Value {
        json!({
            "command": "kc",
            "study": self.study.name,
            "is_rigid": self.elastic.parts.is_rigid(),
            "design_load_N": self.results.design_load,
            "stations": self.results.stations.len(),
            "without_equilibrium": self.results.failures(),
            "warnings": self.results.warnings(),
        })
    }
}

/// The elastic parts of a study, or the rigid mechanism with its tests.
fn elastic_or_rigid(study: &Study) -> Result<Cow<'_, ComplianceStudy>, String> {
    if study.axle().is_some() {
        return Err(
            "axle: `hardpoint kc` is not available for axles: its tests load one wheel. Remove [axle] to use it on the left \
             wheel"
                .to_owned(),
        );
    }
    if let Some(elastic) = study.compliance() {
        return Ok(Cow::Borrowed(elastic));
    }
    if study.wheel().wheel_radius.is_none() {
        return Err(
            "`hardpoint kc` needs radius in [wheel]: loads act at the contact point".to_owned(),
        );
    }
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
