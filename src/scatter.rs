//! Results of builds (assembled parts with random deviations), for the command line and for other programs.

use crate::assembly::SetUpError;
use crate::solved::{Labelled, Solved};
use crate::study::{Formulation, Outputs, Study, Vehicle};
use crate::tolerance::{MonteCarlo, Problem};

/// Percentile curves of builds: label, file, and index among [`crate::tolerance::PERCENTILES`].
const FANS: [(&str, &str, usize); 4] = [
    ("1 %", FAN_FILES[0], 1),
    ("5 %", FAN_FILES[1], 2),
    ("95 %", FAN_FILES[2], 4),
    ("99 %", FAN_FILES[3], 5),
];

/// Names of the files with the percentile curves and with the curves of the nominal design, in the order of [`with_fans`].
pub const FAN_FILES: [&str; 5] = [
    "curves_p1.csv",
    "curves_p5.csv",
    "curves_p95.csv",
    "curves_p99.csv",
    "curves.csv",
];

/// Copy of the study that computes curves of the nominal design only. It outputs the same quantities as the builds of the
/// study.
pub fn curves_alone(study: &Study) -> Study {
    let mut plain = study.clone();
    match &mut plain.vehicle {
        Vehicle::Wheel(own) => {
            own.formulation = Formulation::KnucklePose;
            own.outputs = Outputs {
                figures: std::mem::take(&mut own.outputs.figures),
                ..Outputs::of(std::mem::take(&mut own.outputs.characteristics))
            };
        }
        Vehicle::Axle(both) => both.plan = both.plan.quantities_alone(),
    }
    plain
}

/// Passes curves to a function: first the percentile curves of builds, then the curves of the nominal design. Percentiles are
/// computed separately at each station.
///
/// # Errors
/// Returns the reason in words if the nominal design cannot be solved.
pub fn with_fans<R>(
    problem: &Problem,
    builds: &MonteCarlo,
    take: impl FnOnce(&[Labelled<'_>]) -> R,
) -> Result<R, String> {
    let plain = curves_alone(problem.study);
    let drawn = Solved::of(&plain)?;
    let stations: Vec<usize> = problem.stations().of_motion().collect();
    let fans = FANS.map(|(name, file, percentile)| {
        let found = drawn.with_values(|output, station| {
            builds.spreads[problem.cell(output, stations[station])].percentiles[percentile]
        });
        (name, file, found)
    });
    let fans = fans.iter().map(|(name, file, found)| (*name, *file, found));
    let designs: Vec<_> = fans.chain([("nominal", FAN_FILES[4], &drawn)]).collect();
    Ok(take(&designs))
}

/// Reason in words why builds cannot be assembled, or why their toe and camber cannot be aligned.
pub fn refusal(study: &Study, reason: SetUpError) -> String {
    match reason {
        SetUpError::Fault(reason) => reason.describe(&study.wheel().mechanism),
        SetUpError::NoEquilibrium(reason) => {
            reason.describe(study.wheel().length_unit, study.wheel().frame)
        }
        SetUpError::AssemblyError(reject) => reject.to_string(),
        SetUpError::Unsettled | SetUpError::OutOfReach(_) | SetUpError::Absurd { .. } => {
            "aligned = true needs adjustments in [setup] that move toe and camber independently"
                .to_owned()
        }
    }
}
