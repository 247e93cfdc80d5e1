//! Methods that run a study: curves, tuning and sweep.

use super::Error;
use crate::axle::axle_curves;
use crate::curves::{Curves, wheel_curves};
use crate::optimise::{Control, Tuning, tune};
use crate::plan::Plan;
use crate::study::{Designs, MOST_DESIGNS, MOST_EXCHANGED, Sampled, Sampling, Study, Vehicle};
use crate::sweep::{Rows, SweepPlan};
use crate::threads::{self, Interrupt};
use std::num::NonZeroUsize;
use std::ops::ControlFlow;
use std::sync::atomic::AtomicBool;

/// CPU threads of a sweep, and a flag that stops the sweep.
#[derive(Clone, Copy, Debug, Default)]
pub struct SweepControl<'a> {
    /// Number of CPU threads. `None` for rayon's default, usually one per core. Results do not depend on the number of threads.
    pub threads: Option<NonZeroUsize>,
    /// Flag that stops the sweep. Once the flag is true, the sweep ends after the current designs.
    pub interrupt: Option<&'a AtomicBool>,
}

impl Study {
    /// Computes the requested curves at every station of the motion, of one wheel or of an axle. If a station has no pose,
    /// the status of the station gives the reason.
    ///
    /// ```
    /// # extern crate hardpoint_engine as hardpoint;
    /// use hardpoint::{Characteristic, Motion, Order, Study, Topology};
    ///
    /// let template = Topology::named("macpherson").unwrap().template;
    /// let suspension = Study::from_text("mine", template, ".".as_ref())?.into_wheel();
    /// let study = Study::of(suspension)
    ///     .over(Motion::travel(-40.0..=40.0, 9)?)
    ///     .asking(&[Characteristic::Camber, Characteristic::Toe], Order::Velocity)?;
    /// let curves = study.curves()?;
    /// assert_eq!(curves.columns[1].name, "camber_d1_deg_per_mm");
    /// assert_eq!(curves.stations.len(), 9);
    /// assert!(curves.stations[8].values[0].is_ok());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::Design`] if the design position itself cannot be solved.
    pub fn curves(&self) -> Result<Curves, Error> {
        match &self.vehicle {
            Vehicle::Axle(both) => axle_curves(&both.axle, &both.plan)
                .map(|found| found.curves)
                .map_err(|fault| Error::Design(both.axle.describe_fault(fault))),
            Vehicle::Wheel(own) => wheel_curves(own, &Plan::of(own))
                .map_err(|fault| Error::design(&own.suspension, &fault)),
        }
    }

    /// Tunes the variables towards the targets. [`Tuning::best`] is the tuned design; it is `None` if no start has a
    /// solution at all stations. The starts run in parallel, on separate CPU threads with large stacks. There are at most as
    /// many threads as in the current rayon pool. Outside of a pool, rayon's global pool sets this limit.
    ///
    /// ```
    /// # extern crate hardpoint_engine as hardpoint;
    /// use hardpoint::{Axis, Characteristic, Control, Motion, Study, Target, Topology, Variable};
    ///
    /// let template = Topology::named("double_wishbone").unwrap().template;
    /// let suspension = Study::from_text("mine", template, ".".as_ref())?.into_wheel();
    /// let study = Study::of(suspension.clone())
    ///     .over(Motion::travel(-30.0..=30.0, 7)?)
    ///     .tuning(
    ///         vec![Variable::offset(&suspension, "tie_rod_inner", Axis::Z, -20.0..=20.0)?],
    ///         vec![Target::curve(&suspension, Characteristic::Toe, &[[-30.0, 0.0], [30.0, 0.0]], 0.02)?],
    ///     );
    /// let tuning = study.tune(Control::default())?;
    /// let best = tuning.best.expect("the tuning has a result");
    /// assert!(best.after.misfit <= tuning.before.expect("the design can be solved").misfit);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::NotAsked`] without a call of [`Study::tuning`]. [`Error::Empty`] if the tuning has no variable or no target.
    /// [`Error::Design`] if the design cannot be solved.
    pub fn tune(&self, control: Control<'_>) -> Result<Tuning, Error> {
        let optimise = self
            .optimise
            .as_ref()
            .ok_or(Error::NotAsked("nothing to tune"))?;
        if optimise.variables.is_empty() {
            return Err(Error::Empty("variable to tune"));
        }
        if optimise.targets.is_empty() {
            return Err(Error::Empty("target"));
        }
        tune(&self.vehicle, optimise, control).map_err(|fault| Error::design(self.wheel(), &fault))
    }

    /// Solves the designs of the sweep on CPU threads. While it runs, it passes the rows of the designs to `sink`, block
    /// by block in the order of the designs. Memory holds only a few blocks, for any number of designs. Returns the
    /// names of the columns: first the variables, then the outputs. The sweep ends early if `sink` breaks or the
    /// control stops it. `sink` has then received all earlier rows, and the method still returns the names. The sweep
    /// is complete if the sum of the received [`Rows::designs`] equals the number of requested designs. That number is
    /// [`Sampled::designs`], or the number of rows of the file or table.
    ///
    /// ```
    /// # extern crate hardpoint_engine as hardpoint;
    /// use hardpoint::{Axis, Characteristic, Motion, Order, Sampling, Study, SweepControl, Topology, Variable};
    /// use std::ops::ControlFlow;
    ///
    /// let template = Topology::named("macpherson").unwrap().template;
    /// let suspension = Study::from_text("mine", template, ".".as_ref())?.into_wheel();
    /// let height = Variable::offset(&suspension, "tie_rod_inner", Axis::Z, -5.0..=5.0)?;
    /// let study = Study::of(suspension)
    ///     .over(Motion::travel(-40.0..=40.0, 9)?)
    ///     .asking(&[Characteristic::Toe], Order::Position)?
    ///     .sampling(Sampling::Sobol, 100, 1, &[height]);
    /// let mut largest = f64::NEG_INFINITY;
    /// let columns = study.sweep(SweepControl::default(), |rows| {
    ///     for design in 0..rows.designs() {
    ///         largest = largest.max(rows.outputs(design)[1]);
    ///     }
    ///     ControlFlow::Continue(())
    /// })?;
    /// assert_eq!(columns[..3], ["tie_rod_inner_dz_mm", "toe_min_deg", "toe_max_deg"]);
    /// assert!(largest > 0.0);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::NotAsked`] without a call of [`Study::sampling`]. [`Error::Empty`] if the sampling has no variable.
    /// [`Error::Number`] if the number of samples is 0, too large or does not fit a grid, or if the method allows fewer variables.
    /// [`Error::MovesNothing`] if a variable moves no coordinate. [`Error::Design`] if the design itself cannot be solved.
    /// [`Error::File`] if the file of designs has an error. [`Error::Columns`] if two columns have the same name.
    /// [`Error::Threads`] if the CPU threads cannot start.
    pub fn sweep(
        &self,
        control: SweepControl<'_>,
        sink: impl FnMut(&Rows) -> ControlFlow<()> + Send,
    ) -> Result<Vec<String>, Error> {
        let sweep = self
            .sweep
            .as_ref()
            .ok_or(Error::NotAsked("no designs to sweep"))?;
        if let Designs::Sampled(sampled) = &sweep.designs {
            refuse_wrong(sampled)?;
        }
        let threads = control.threads.map_or(0, NonZeroUsize::get);
        let pool = threads::pool(threads).map_err(|error| Error::Threads {
            threads,
            reason: error.to_string(),
        })?;
        let go_on = || !Interrupt(control.interrupt).is_raised();
        // The plan solves the design itself, which needs the large stack of a thread of the pool.
        pool.install(|| {
            let plan = SweepPlan::of(self, sweep)
                .map_err(|reason| Error::not_begun(self.wheel(), reason))?;
            plan.run(0..plan.record.blocks(), go_on, sink);
            Ok(plan.record.value_columns())
        })
    }
}

// The message of `refuse_wrong` contains this number.
const _: () = assert!(MOST_EXCHANGED == 126);

/// Returns an error if the sampling has a fault. A study file with the same fault is refused, too.
fn refuse_wrong(sampled: &Sampled) -> Result<(), Error> {
    let variables = &sampled.variables;
    if variables.is_empty() {
        return Err(Error::Empty("variable to sweep over"));
    }
    if let Some(still) = variables
        .iter()
        .find(|v| v.moves.is_empty() && v.rate.is_none())
    {
        return Err(Error::MovesNothing(still.name.clone()));
    }
    let count = variables.len() as u64;
    let number = |what: &str, value: u64, expected| {
        Err(Error::Number {
            what: what.to_owned(),
            value: value as f64,
            expected,
        })
    };
    let most = match sampled.method {
        Sampling::Grid => MOST_DESIGNS,
        _ => MOST_DESIGNS / (count + 2),
    };
    if !(1..=most).contains(&sampled.samples) {
        let expected = "at least 1, and no more than 1e12 designs in all";
        return number("the number of samples", sampled.samples, expected);
    }
    match sampled.method {
        Sampling::Grid => {
            let steps = variables.iter().map(|v| v.steps);
            let points = steps.reduce(|product, steps| product?.checked_mul(steps?));
            if points.flatten() == Some(sampled.samples) {
                Ok(())
            } else {
                number(
                    "the number of samples of a grid",
                    sampled.samples,
                    "the product of the numbers of steps of its variables, for example 125 for 3 variables with 5 steps each",
                )
            }
        }
        Sampling::Saltelli if variables.len() > MOST_EXCHANGED => number(
            "the number of variables for the method \"saltelli\"",
            count,
            "at most 126",
        ),
        _ => Ok(()),
    }
}
