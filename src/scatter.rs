//! Results of builds that the command line and embedding programs share.

use crate::assembly::SetUpError;
use crate::solved::{Labelled, Solved};
use crate::study::{Formulation, Outputs, Study, Vehicle};
use crate::tolerance::{MonteCarlo, Problem};

/// The curves of percentiles of builds, by their place among [`crate::tolerance::PERCENTILES`].
const FANS: [(&str, &str, usize); 4] = [
    ("1 %", FAN_FILES[0], 1),
    ("5 %", FAN_FILES[1], 2),
    ("95 %", FAN_FILES[2], 4),
    ("99 %", FAN_FILES[3], 5),
];

/// The files of those curves, in the order of [`with_fans`].
pub const FAN_FILES: [&str; 5] = [
    "curves_p1.csv",
    "curves_p5.csv",
    "curves_p95.csv",
    "curves_p99.csv",
    "curves.csv",
];

/// The study with the curves of its nominal design alone, in the quantities that builds are evaluated for.
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

/// Hands over the curves of percentiles of builds, each station by itself, and those of the nominal design, which are the
/// last.
///
/// # Errors
/// The reason in words, if the nominal design cannot be solved.
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

/// Describes why builds cannot be aligned, or not be made.
pub fn refusal(study: &Study, reason: SetUpError) -> String {
    match reason {
        SetUpError::Fault(reason) => reason.describe(&study.wheel().mechanism),
        SetUpError::AssemblyError(reject) => reject.to_string(),
        SetUpError::Unsettled | SetUpError::OutOfReach(_) | SetUpError::Absurd { .. } => {
            "aligned = true, but the adjustments of [setup] do not move toe and camber independently"
                .to_owned()
        }
    }
}
