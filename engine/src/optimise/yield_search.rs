//! Robust tuning for yield. The yield is the share of builds (produced vehicles) that are within every band. A band is a
//! lower and an upper limit of a result.
//!
//! A build is within its bands if every value q lies between its limits. The share of such builds is a step function of the
//! variables, so it has no useful slope. The search uses a smooth surrogate instead. With a width tau for each band,
//!
//! ```text
//! h = max(0, q - (upper - tau), (lower + tau) - q) / tau               for each value of a build      (1)
//! H = sum of h^2 over the values of a build                                                           (2)
//! surrogate = mean over the builds of 1/(1 + H)                                                       (3)
//! ```
//!
//! A value at its limit has h = 1, so a build with one such value counts as half a build. As tau goes to 0, (3) becomes the
//! share of builds within all bands. The search minimises 1 - (3) by least squares, with one residual for each build:
//!
//! ```text
//! r = sqrt(H/(1 + H)),     dr = (sum h dh) / (sqrt(H) (1 + H)^(3/2)),     r = dr = 0 where H = 0      (4)
//! ```
//!
//! If most builds are far outside, (3) is flat. In this case a first step lowers the mean of H, with the residuals
//!
//! ```text
//! r = sqrt(H)                                                                                         (5)
//! ```
//!
//! tau is a multiple of the standard deviation of the band's values over the builds, but at most a quarter of the band's
//! width. The search starts at the optimum without scatter, with a large tau, and reduces tau in steps ([`WIDTHS`]). The code
//! then evaluates the end of each step with [`JUDGED`] further builds, which the search has not used. It keeps the end with
//! the most builds within all bands. The optimum without scatter is one of the ends. So only sampling error can make the
//! yield lower than the yield of this optimum.

use super::constrained::{Assessment, Constrained, Shape, constrained_fit};
use super::station_reader::refused;
use super::tune::{Tuner, Tuning, TuningRequest};
use super::{
    Bounds, ConstrainedFit, Control, Infeasible, LeastSquares, Linearisation, Objective, Options,
    TargetLayout,
};
use crate::mechanism::DesignFault;
use crate::number::Width;
use crate::study::{
    AxleSite, AxleStudy, Band, Limit, Optimise, Scatter, Site, Target, Vehicle, Wanted,
};
use crate::tolerance::with_rounding;
use nalgebra::DVector;
use rayon::iter::{IntoParallelIterator, ParallelIterator};

/// Widths tau of equation (1) of this module in the steps of the search, in standard deviations of the values of a band.
const WIDTHS: [f64; 4] = [2.0, 1.0, 0.5, 0.25];
/// Largest width tau of equation (1) of this module, as a share of the band's width.
const WIDEST: f64 = 0.25;
/// If a smaller share of the builds is within all bands, the search first lowers the distance of the builds from the bands.
const FEW: f64 = 0.5;
/// Smallest standard deviation of a band, for values that are the same in all builds. It is far below the rounding error by
/// which [`with_rounding`] moves the limits, so a value at a limit counts as within the band. All residuals stay finite.
const STILL: f64 = 1e-15;
/// Number of further builds with which the designs at the ends of the search's steps are evaluated.
const JUDGED: usize = 1 << 16;
/// Number of further builds with which a design with elastic parts is evaluated. This number is smaller, because equilibria
/// take longer than poses.
const JUDGED_ELASTIC: usize = 1 << 10;
/// Number of further builds with which an axle is evaluated. This number is smaller than [`JUDGED`], because these builds are
/// solved without SIMD lanes.
const JUDGED_AXLE: usize = 1 << 12;
/// Number of parts into which an axle's further builds are divided, so that several CPU threads share the work.
const AXLE_PARTS: usize = 8;
/// Largest number of builds whose designs one CPU thread has in memory at once.
const AT_ONCE: usize = 1 << 12;

/// Expected yield of a robust tuning.
#[derive(Clone, Debug, PartialEq)]
pub struct ExpectedYield {
    /// Offsets of the optimum without scatter, where the search started.
    pub plain: Vec<f64>,
    /// Number of builds in the surrogate, the smooth function that the search maximises in place of the yield.
    pub builds: usize,
    /// Value of the surrogate at the kept design: about the share of builds within all bands, from 0 to 1.
    pub surrogate: f64,
    /// Shares of builds that are within all bands, from further builds that the search has not used: [optimum without
    /// scatter, kept design].
    pub judged: [f64; 2],
    /// Number of further builds for the shares in `judged`.
    pub judged_builds: usize,
    /// True if no end of the search that satisfies the constraints has more builds within the bands than the optimum without
    /// scatter. The result is then the optimum without scatter.
    pub keeps_plain: bool,
}

/// A search for the largest yield.
struct YieldSearch<'a> {
    vehicle: &'a Vehicle,
    assembled: Vehicle,
    optimise: &'a Optimise,
    scatter: &'a Scatter,
    bands: &'a [Band],
    bounds: &'a Bounds,
    options: Options,
    control: Control<'a>,
}

/// Result of a search for the largest yield.
struct Found {
    /// Run that ended at the kept design. `None` if the optimum without scatter is kept.
    fit: Option<ConstrainedFit>,
    /// Expected yield at the kept design.
    expected: ExpectedYield,
}

impl<'a> YieldSearch<'a> {
    /// Makes a search with the variables and constraints of a tuning.
    fn new(
        vehicle: &'a Vehicle,
        optimise: &'a Optimise,
        (scatter, bands): (&'a Scatter, &'a [Band]),
        bounds: &'a Bounds,
        options: Options,
        control: Control<'a>,
    ) -> Result<Self, DesignFault> {
        Ok(YieldSearch {
            vehicle,
            assembled: vehicle.assembled()?,
            optimise,
            scatter,
            bands,
            bounds,
            options,
            control,
        })
    }

    /// Raises the yield from the optimum without scatter. An error gives the reason why a build of that optimum, or of the
    /// builds of the search, has no values. A request to stop can also be the reason.
    fn run(&self, plain: &DVector<f64>) -> Result<Found, Infeasible> {
        let sigmas = self.sigmas(plain)?;
        let plain_share = self.share(plain)?;
        let mut kept = (plain_share, plain.clone(), None);
        let mut from = plain.clone();
        let approach = (plain_share < FEW).then_some((WIDTHS[0], Residual::Distance));
        let steps = WIDTHS.map(|width| (width, Residual::Share));
        for (width, residual) in approach.into_iter().chain(steps) {
            let widths: Vec<f64> = sigmas.iter().map(|sigma| width * sigma).collect();
            let goals = self.goals(self.smoothed(&widths), self.scatter);
            let layout = TargetLayout::of(&goals, self.vehicle);
            let problem = self.problem(&goals, &layout, residual);
            let (bounds, control) = (self.bounds, self.control);
            let fit = constrained_fit(0, problem, bounds, &from, &self.options, control)?;
            from.clone_from(&fit.x);
            if self.control.is_interrupted() {
                break;
            }
            if !fit.is_feasible() {
                continue;
            }
            // A further build of this end may have no values. This rejects only this end.
            let Ok(share) = self.share(&fit.x) else {
                continue;
            };
            if share > kept.0 {
                kept = (share, fit.x.clone(), Some(fit));
            }
        }
        let (share, x, fit) = kept;
        let last = WIDTHS[WIDTHS.len() - 1];
        let widths: Vec<f64> = sigmas.iter().map(|sigma| last * sigma).collect();
        Ok(Found {
            expected: ExpectedYield {
                plain: plain.iter().copied().collect(),
                builds: self.scatter.builds,
                surrogate: self.surrogate(&x, &widths)?,
                judged: [plain_share, share],
                judged_builds: self.judged(),
                keeps_plain: fit.is_none(),
            },
            fit,
        })
    }

    /// Surrogate of the yield at a design, by equation (3) of this module. `widths` has the width tau of each band.
    fn surrogate(&self, x: &DVector<f64>, widths: &[f64]) -> Result<f64, Infeasible> {
        let goals = self.goals(self.smoothed(widths), self.scatter);
        let layout = TargetLayout::of(&goals, self.vehicle);
        let mut problem = self.problem(&goals, &layout, Residual::Share);
        let mut assessment = Assessment::new(&problem.shape());
        problem.assess(x, &mut assessment)?;
        let outside = assessment.goal.residuals.norm_squared();
        Ok(1.0 - outside / self.scatter.builds as f64)
    }

    /// The bands as targets. Limits move inwards by the widths, and the widths are the tolerances. So the residuals equal
    /// the values h of equation (1) of this module.
    fn smoothed(&self, widths: &[f64]) -> Vec<Target> {
        let target = |(band, width): (&Band, &f64)| {
            let [low, high] = with_rounding(band.between);
            let width = if high > low {
                width.min(WIDEST * (high - low))
            } else {
                *width
            };
            self.target(band, [low + width, high - width], width)
        };
        self.bands.iter().zip(widths).map(target).collect()
    }

    /// A band as a target. If both values of `between` are equal, residuals are distances from this value.
    fn target(&self, band: &Band, between: [f64; 2], tolerance: f64) -> Target {
        let limit = |value: f64| value.is_finite().then_some(Limit::Value(value));
        let site = match self.vehicle {
            Vehicle::Wheel(own) => {
                // A band of a test result applies to the design position. Any other band without `at` applies to the whole
                // motion.
                let applies_everywhere = band.at.is_none() && band.of.as_figure().is_none();
                let motion = &own.motion;
                Site {
                    racks: if applies_everywhere && motion.rack_moves {
                        motion.rack.clone()
                    } else {
                        Vec::new()
                    },
                    ..Site::default()
                }
            }
            Vehicle::Axle(both) => Site {
                axle: Some(site_of(band, both)),
                ..Site::default()
            },
        };
        let is_figure = band.of.as_figure().is_some();
        let at = band.at.or_else(|| is_figure.then_some(0.0));
        Target {
            of: band.of.clone(),
            wanted: Wanted::Band {
                at,
                lower: limit(between[0]),
                upper: limit(between[1]),
            },
            tolerance,
            weight: 1.0,
            site,
            stations: at.into_iter().collect(),
        }
    }

    /// Describes a tuning of builds towards these targets. The weight of a target is its number of residuals, so all
    /// residuals have the same weight.
    fn goals(&self, targets: Vec<Target>, scatter: &Scatter) -> Optimise {
        let mut goals = Optimise {
            targets,
            scatter: Some(scatter.clone()),
            ..self.optimise.clone()
        };
        let of_rows = TargetLayout::of(&goals, self.vehicle).targets_of_rows();
        for (number, target) in goals.targets.iter_mut().enumerate() {
            let own = of_rows.iter().filter(|of| **of == number).count();
            target.weight = own as f64;
        }
        goals
    }

    /// Makes the problem of the search's builds.
    fn problem<'o>(
        &'o self,
        goals: &'o Optimise,
        layout: &'o TargetLayout,
        residual: Residual,
    ) -> SmoothYield<'o> {
        let width = Width::widest();
        let (assembled, variables) = (&self.assembled, &goals.variables);
        let scatter = self.scatter;
        let builds = Objective::of_builds(assembled, variables, layout, scatter, width);
        let builds = builds.expect("this design was accepted earlier in the run");
        SmoothYield::new(builds, residual)
    }

    /// Standard deviation of the values of each band over the builds, as root mean square over the stations of the band.
    fn sigmas(&self, x: &DVector<f64>) -> Result<Vec<f64>, Infeasible> {
        let values: Vec<Target> = self
            .bands
            .iter()
            .map(|band| self.target(band, [0.0; 2], 1.0))
            .collect();
        let (builds, goals) = (self.scatter.builds, self.goals(values, self.scatter));
        let layout = TargetLayout::of(&goals, self.vehicle);
        let found = self.values(&goals, self.scatter, x)?;
        let of_rows = layout.targets_of_rows();
        let rows = of_rows.len() / builds;
        let variance = |row: usize| {
            let own = (0..builds).map(|build| found[build * rows + row]);
            let mean = own.clone().sum::<f64>() / builds as f64;
            own.map(|value| (value - mean).powi(2)).sum::<f64>() / (builds - 1) as f64
        };
        let sigma = |band: usize| {
            let own = (0..rows).filter(|row| of_rows[*row] == band);
            let variances: Vec<f64> = own.map(variance).collect();
            let mean = variances.iter().sum::<f64>() / variances.len().max(1) as f64;
            mean.sqrt().max(STILL)
        };
        Ok((0..self.bands.len()).map(sigma).collect())
    }

    /// Share of the further builds that are within all bands.
    fn share(&self, x: &DVector<f64>) -> Result<f64, Infeasible> {
        let bands: Vec<Target> = self
            .bands
            .iter()
            .map(|band| self.target(band, with_rounding(band.between), 1.0))
            .collect();
        let judged = self.judged();
        let parts = match self.vehicle {
            Vehicle::Wheel(_) => judged.div_ceil(AT_ONCE),
            Vehicle::Axle(_) => AXLE_PARTS,
        };
        let at_once = judged / parts;
        let of_part = |part: usize| {
            if self.control.is_interrupted() {
                return Err(Infeasible::Refused("interrupted".to_owned()));
            }
            let further = Scatter {
                builds: at_once,
                // The builds are divided into parts. Each part has a separate seed.
                seed: self.scatter.seed.wrapping_add(1 + part as u32),
                ..self.scatter.clone()
            };
            let goals = self.goals(bands.clone(), &further);
            let found = self.values(&goals, &further, x)?;
            let builds = found.as_slice().chunks_exact(found.len() / at_once);
            Ok(builds.filter(|own| own.iter().all(|h| *h == 0.0)).count())
        };
        let counts: Vec<_> = (0..parts).into_par_iter().map(of_part).collect();
        let inside: usize = counts.into_iter().sum::<Result<_, Infeasible>>()?;
        Ok(inside as f64 / judged as f64)
    }

    /// Number of further builds with which a design is evaluated.
    fn judged(&self) -> usize {
        match self.vehicle {
            _ if self.vehicle.is_elastic() => JUDGED_ELASTIC,
            Vehicle::Wheel(_) => JUDGED,
            Vehicle::Axle(_) => JUDGED_AXLE,
        }
    }

    /// Residuals of the builds of a nominal design, without derivatives.
    fn values(
        &self,
        goals: &Optimise,
        scatter: &Scatter,
        x: &DVector<f64>,
    ) -> Result<DVector<f64>, Infeasible> {
        let vehicle = self.vehicle.moved(&self.optimise.variables, x);
        let layout = TargetLayout::of(goals, &vehicle);
        let refused = refused(&vehicle.wheel().mechanism);
        let assembled = vehicle.assembled().map_err(&refused)?;
        let width = Width::widest();
        let builds = Objective::of_builds(&assembled, &[], &layout, scatter, width);
        let mut builds = builds.map_err(&refused)?;
        let mut found = Linearisation::new(layout.residuals(), 0);
        LeastSquares::evaluate(&mut builds, &DVector::zeros(0), &mut found)?;
        Ok(found.residuals)
    }
}

/// Stations of a band of an axle. A band without stations applies to the whole motion. A band of a test result without
/// stations applies to the design position.
fn site_of(band: &Band, study: &AxleStudy) -> AxleSite {
    if let Some(site) = &band.site {
        return site.clone();
    }
    let motion = &study.plan.motion;
    if band.of.is_figure() {
        AxleSite::whole(None, &motion.at_design(), &study.axle)
    } else {
        AxleSite::whole(None, motion, &study.axle)
    }
}

/// Form of the residual of a build.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Residual {
    /// Residual by equation (4) of this module, from which the share of builds within the bands follows.
    Share,
    /// Residual by equation (5) of this module: distance of a build from the bands.
    Distance,
}

/// Problem with the residuals of equation (4) or (5) of this module.
struct SmoothYield<'a> {
    residual: Residual,
    builds: Objective<'a>,
    /// Values h of equation (1) of this module, for all builds.
    values: Linearisation,
    count: usize,
}

impl<'a> SmoothYield<'a> {
    fn new(builds: Objective<'a>, residual: Residual) -> Self {
        let shape = Constrained::shape(&builds);
        let count = builds.build_count();
        SmoothYield {
            residual,
            values: Linearisation::new(shape.goal, shape.variables),
            builds,
            count,
        }
    }
}

impl Constrained for SmoothYield<'_> {
    fn shape(&self) -> Shape {
        Shape {
            goal: self.count,
            ..self.builds.shape()
        }
    }

    fn row_limits(&self) -> Vec<f64> {
        self.builds.row_limits()
    }

    fn assess(&mut self, x: &DVector<f64>, into: &mut Assessment) -> Result<(), Infeasible> {
        let rows = Some(&mut into.rows);
        self.builds.evaluate_all(x, &mut self.values, rows)?;
        let own = self.values.residuals.len() / self.count;
        for build in 0..self.count {
            let h = self.values.residuals.rows(build * own, own);
            let dh = self.values.jacobian.rows(build * own, own);
            let squares = h.norm_squared();
            let mut slopes = into.goal.jacobian.row_mut(build);
            slopes.fill(0.0);
            let (residual, scale) = match self.residual {
                Residual::Share => ((squares / (1.0 + squares)).sqrt(), 1.0 + squares),
                Residual::Distance => (squares.sqrt(), 1.0),
            };
            into.goal.residuals[build] = residual;
            if squares > 0.0 {
                let factor = 1.0 / (squares.sqrt() * scale.powf(1.5));
                for (column, slope) in slopes.iter_mut().enumerate() {
                    *slope = factor * dh.column(column).dot(&h);
                }
            }
        }
        Ok(())
    }
}

/// Tunes the nominal design towards the targets, then raises the yield, starting from the tuned design.
pub(super) fn tune_for_yield(
    vehicle: &Vehicle,
    optimise: &Optimise,
    (scatter, bands): (&Scatter, &[Band]),
    control: Control<'_>,
) -> Result<Tuning, DesignFault> {
    let plain = Optimise {
        scatter: None,
        ..optimise.clone()
    };
    let asked = TuningRequest::new(vehicle, &plain, control)?;
    let tuner = Tuner::new(&asked)?;
    let mut tuning = tuner.run()?;
    let end = tuning.starts.best_fit().filter(|fit| fit.is_feasible());
    let Some(end) = end.filter(|_| !control.is_interrupted()) else {
        return Ok(tuning);
    };
    let (aim, options) = ((scatter, bands), tuner.options());
    let search = YieldSearch::new(vehicle, &plain, aim, &tuner.bounds, options, control)?;
    tuning.expected_yield = Some(match search.run(&end.x) {
        Ok(Found { fit, expected, .. }) => {
            if let Some(fit) = fit {
                tuner.keep(&mut tuning, &fit);
            }
            Ok(expected)
        }
        Err(reason) => Err(reason),
    });
    if let Some(best) = &mut tuning.best {
        // The nominal misfit determined these directions. A move along them can lower the yield.
        best.identifiability.unseen.clear();
    }
    Ok(tuning)
}
