//! Tuning a study: from its targets and variables to the best design found.

use super::objective::{Deviation, Objective, TargetLayout, moved_design};
use super::{
    Bounds, Control, Evaluation, Identifiability, Infeasible, LeastSquares, Multistart, Options,
    multistart,
};
use crate::mechanism::DesignFault;
use crate::model::Suspension;
use crate::number::Vector3;
use crate::study::{Motion, Optimise};
use nalgebra::DVector;

/// A direction in which a move across the whole range changes the misfit by less than this (in
/// tolerances) is one that the targets do not see.
const UNSEEN: f64 = 0.01;

/// What came of a tuning.
#[derive(Clone, Debug)]
pub struct Tuning {
    /// Misfit and deviations of the design the study gives, or why it has none.
    pub before: Result<Fulfilment, Infeasible>,
    /// Every start, and the best.
    pub starts: Multistart,
    /// The best design, if any start succeeded.
    pub best: Option<Best>,
}

/// How well the targets are met.
#[derive(Clone, Debug, PartialEq)]
pub struct Fulfilment {
    /// Root of the weighted mean of the targets' squared deviations, in tolerances.
    pub misfit: f64,
    /// Target by target.
    pub targets: Vec<Deviation>,
}

/// The best design found.
#[derive(Clone, Debug)]
pub struct Best {
    /// Offsets of the variables, in the study's axes.
    pub offsets: Vec<f64>,
    /// The tuned hardpoints, in the kernel's frame.
    pub design: Vec<Vector3<f64>>,
    /// How well it meets the targets.
    pub after: Fulfilment,
    /// What the targets tell of the variables there.
    pub identifiability: Identifiability,
}

/// Tunes a suspension. An error says why the design itself cannot be solved.
pub fn tune(
    suspension: &Suspension,
    motion: &Motion,
    optimise: &Optimise,
    control: Control<'_>,
) -> Result<Tuning, DesignFault> {
    let layout = TargetLayout::of(optimise, motion, &suspension.frame);
    match layout.rate_order() {
        0 => tune_at::<1>(suspension, optimise, &layout, control),
        _ => tune_at::<2>(suspension, optimise, &layout, control),
    }
}

fn tune_at<const N: usize>(
    suspension: &Suspension,
    optimise: &Optimise,
    layout: &TargetLayout,
    control: Control<'_>,
) -> Result<Tuning, DesignFault> {
    let variables = &optimise.variables;
    let mut probe = Objective::<N>::new(suspension, variables, layout)?;
    let design = DVector::zeros(variables.len());
    let mut evaluation = Evaluation::new(probe.residuals(), probe.variables());
    let fulfilment = |evaluation: &Evaluation| Fulfilment {
        misfit: evaluation.misfit(),
        targets: layout.deviations(&evaluation.residuals),
    };
    let before = probe
        .evaluate(&design, &mut evaluation)
        .map(|()| fulfilment(&evaluation));

    let ranges: Vec<[f64; 2]> = variables.iter().map(|v| v.range).collect();
    let bounds = Bounds::new(&ranges).expect("a study's ranges are not empty");
    let options = Options {
        max_iterations: optimise.max_iterations,
        ..Options::default()
    };
    let starts = multistart(
        || {
            Objective::<N>::new(suspension, variables, layout)
                .expect("the same design was accepted above")
        },
        &bounds,
        &design,
        optimise.starts,
        optimise.seed,
        &options,
        control,
    );
    let best = starts.best_fit().map(|fit| {
        let mut moved = suspension.design.clone();
        moved_design(
            &suspension.design,
            &suspension.frame,
            variables,
            &fit.x,
            &mut moved,
        );
        Best {
            offsets: fit.x.iter().copied().collect(),
            design: moved,
            after: fulfilment(&fit.evaluation),
            identifiability: Identifiability::new(&fit.evaluation, &bounds, UNSEEN),
        }
    });
    Ok(Tuning {
        before,
        starts,
        best,
    })
}
