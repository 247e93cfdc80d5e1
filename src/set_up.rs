//! Set-up of a study: adjustments that give the target static values. A set-up belongs to one wheel, to both wheels of an axle,
//! or to an axle as a whole.

use crate::assembly::{Assembler, SetUp, SetUpError};
use crate::mechanism::DesignFault;
use crate::model::{Side, Suspension};
use crate::report::{SetUpSide, SetUpSummary, Table, set_up_refusal};
use crate::study::{Formulation, Setup, Study, Vehicle, WheelStudy};
use serde::Serialize;

/// Set-up (adjustments and their results) of all wheels of a study.
pub struct FoundSetUp {
    /// One set-up for a single wheel, for both wheels of a mirrored axle, or for an axle that is set up as a whole. Otherwise one
    /// set-up for each wheel.
    pub wheels: Vec<SetUpSummary>,
    /// Study with the adjusted wheels. Its design position is the new static position.
    pub adjusted: Study,
}

/// Reason in words why there is no set-up.
pub enum Refusal {
    /// The design cannot be solved.
    Design(String),
    /// The target values cannot be met. The second value has one entry for each wheel, with the effects of the adjustments on the
    /// nominal design. It is empty if an effect cannot be computed.
    NotMet(String, Vec<SetUpSummary>),
}

impl Refusal {
    /// Text of the reason.
    pub fn reason(self) -> String {
        match self {
            Refusal::Design(reason) | Refusal::NotMet(reason, _) => reason,
        }
    }
}

/// Content of `summary.json` of a set-up.
#[derive(Serialize)]
#[serde(untagged)]
pub enum SetUpRecord<'s> {
    /// A single set-up: of one wheel, of mirrored wheels, or of an axle as a whole.
    One(&'s SetUpSummary),
    /// A set-up for each wheel of an axle.
    Wheels {
        /// True if the target values of both wheels are met.
        met: bool,
        /// Set-ups of the left and the right wheel.
        wheels: &'s [SetUpSummary],
    },
}

impl FoundSetUp {
    /// True if the target values of all wheels are met.
    pub fn met(&self) -> bool {
        self.wheels.iter().all(|summary| summary.met)
    }

    /// Content of `summary.json`.
    pub fn record(&self) -> SetUpRecord<'_> {
        match &self.wheels[..] {
            [summary] => SetUpRecord::One(summary),
            wheels => SetUpRecord::Wheels {
                met: self.met(),
                wheels,
            },
        }
    }

    /// Table of the adjustment steps of all wheels.
    pub fn steps_table(&self) -> Table {
        stacked(&self.wheels, SetUpSummary::steps_table)
    }

    /// Table of the effects of all adjustments on the static values of each wheel.
    pub fn effects_table(&self) -> Table {
        effects_table(&self.wheels)
    }
}

/// Table of the effects of all adjustments on the static values of each wheel.
pub fn effects_table(wheels: &[SetUpSummary]) -> Table {
    stacked(wheels, SetUpSummary::effects_table)
}

/// Joins the tables of all wheels. For an axle, the column `side` comes first.
fn stacked(wheels: &[SetUpSummary], table: fn(&SetUpSummary) -> Table) -> Table {
    let tables = wheels
        .iter()
        .map(|summary| (summary.side.map(SetUpSide::name), table(summary)));
    Table::stacked("side", tables).expect("a set-up has one wheel at least")
}

/// Writes the name of the wheel before a sentence, if each wheel of an axle has its own set-up.
pub fn about(side: Option<SetUpSide>, sentence: &str) -> String {
    match side {
        None | Some(SetUpSide::Both) => sentence.to_owned(),
        Some(side) => format!("{}: {sentence}", side.wheels()),
    }
}

/// Finds the adjustments that give the target values. If the independent wheels of an axle are not mirror images, each wheel has
/// its own set-up. Two kinds of axle are set up as a whole: a solid axle, and an axle with elastic parts whose wheels differ.
///
/// # Errors
/// A singular design, or target values that the adjustments do not reach.
pub fn set_up(study: &Study, setup: &Setup) -> Result<FoundSetUp, Refusal> {
    let wheels = WheelToSetUp::all(study).map_err(Refusal::Design)?;
    let mut found = Vec::new();
    for wheel in &wheels {
        found.push(
            wheel
                .solve(setup)
                .map_err(|none| refusal(&wheels, wheel, setup, &none))?,
        );
    }
    let pairs = wheels.iter().zip(&found);
    Ok(FoundSetUp {
        wheels: pairs
            .map(|(wheel, found)| wheel.summary(setup, found))
            .collect(),
        adjusted: adjusted(study, &found),
    })
}

fn refusal(
    wheels: &[WheelToSetUp],
    failed: &WheelToSetUp,
    setup: &Setup,
    none: &SetUpError,
) -> Refusal {
    let reason = about(failed.side, &set_up_refusal(&failed.study, setup, none));
    if matches!(none, SetUpError::Fault(_)) {
        return Refusal::Design(reason);
    }
    let nominal = wheels
        .iter()
        .map(|wheel| Ok(wheel.summary(setup, &wheel.drawn(setup)?)));
    let nominal: Result<Vec<SetUpSummary>, SetUpError> = nominal.collect();
    Refusal::NotMet(reason, nominal.unwrap_or_default())
}

/// A wheel that needs a set-up, or an axle that is set up as a whole.
struct WheelToSetUp {
    side: Option<SetUpSide>,
    /// Study of this wheel alone. If the axle is set up as a whole, or if elastic parts can couple the wheels, this is the
    /// study of the axle.
    study: Study,
    assembler: Assembler,
    /// Assembler of the right wheel, if the axle is set up as a whole. Otherwise `None`.
    from_right: Option<Assembler>,
}

impl WheelToSetUp {
    /// Wheels that need a set-up: both wheels of an axle if the right wheel is not a mirror image, otherwise one wheel. An axle
    /// that is set up as a whole counts as one wheel.
    fn all(study: &Study) -> Result<Vec<Self>, String> {
        let assembler = |side: Option<SetUpSide>, suspension: &Suspension| {
            let fault = |fault: DesignFault| about(side, &fault.describe(&suspension.mechanism));
            Assembler::new(suspension).map_err(fault)
        };
        let mut wheels = vec![(None, study.wheel().clone())];
        if let Some(both) = study.axle() {
            let own = |side: Side| {
                let found = Assembler::of_axle(&both.axle, side);
                let mechanism = &both.axle.suspension(side).mechanism;
                found.map_err(|fault| fault.describe(mechanism))
            };
            let is_whole = both.axle.is_set_up_as_a_whole();
            if is_whole || study.is_elastic() {
                let from_right = if is_whole {
                    Some(own(Side::Right)?)
                } else {
                    None
                };
                return Ok(vec![WheelToSetUp {
                    side: (!is_whole).then_some(SetUpSide::Both),
                    study: study.clone(),
                    assembler: own(Side::Left)?,
                    from_right,
                }]);
            }
            wheels[0].0 = Some(SetUpSide::Both);
            if let Some(right) = &both.axle.right {
                wheels[0].0 = Some(SetUpSide::Left);
                wheels.push((Some(SetUpSide::Right), right.clone()));
            }
        }
        let wheel = |(side, suspension)| {
            let compliance = study.compliance().cloned();
            let mut study = study.clone();
            study.vehicle = Vehicle::Wheel(Box::new(WheelStudy {
                compliance,
                ..WheelStudy::of(suspension)
            }));
            Ok(WheelToSetUp {
                side,
                assembler: assembler(side, study.wheel())?,
                from_right: None,
                study,
            })
        };
        wheels.into_iter().map(wheel).collect()
    }

    fn solve(&self, setup: &Setup) -> Result<SetUp, SetUpError> {
        match (self.study.axle(), &self.from_right) {
            (Some(both), Some(right)) => SetUp::solve_axle(both, setup, [&self.assembler, right]),
            _ => SetUp::solve(&self.study, setup, &self.assembler),
        }
    }

    /// Set-up without adjustments: state of the nominal design, with the effect of each adjustment.
    fn drawn(&self, setup: &Setup) -> Result<SetUp, SetUpError> {
        match (self.study.axle(), &self.from_right) {
            (Some(both), Some(right)) => SetUp::drawn_axle(both, setup, [&self.assembler, right]),
            _ => SetUp::drawn(&self.study, setup, &self.assembler),
        }
    }

    fn summary(&self, setup: &Setup, found: &SetUp) -> SetUpSummary {
        SetUpSummary::of(&self.study, setup, self.side, found)
    }
}

/// Copy of the study with the adjusted wheels, whose design position is the new static position.
fn adjusted(study: &Study, found: &[SetUp]) -> Study {
    let mut adjusted = study.clone();
    let mut wheels = found.iter().flat_map(|found| {
        let state = found.last();
        let built = std::iter::once(&state.built).chain(&state.seen_from_right);
        built.map(|built| built.suspension.clone())
    });
    let first = wheels.next().expect("a set-up has one wheel at least");
    match &mut adjusted.vehicle {
        Vehicle::Axle(both) => {
            both.axle = both
                .axle
                .with_kept_springs()
                .with_wheels(first, wheels.next());
            if let [found] = found {
                both.axle.add_tensions(&found.last().built.tensions);
            }
        }
        Vehicle::Wheel(own) => {
            if let Some(elastic) = &mut own.compliance {
                *elastic = elastic.with_kept_spring(&own.suspension);
            }
            own.suspension = first;
            own.formulation = Formulation::KnucklePose;
        }
    }
    adjusted
}
