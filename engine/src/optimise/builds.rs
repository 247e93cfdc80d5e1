//! Scattered builds of a robust tuning, with their derivatives by the design variables.
//!
//! At x the nominal design is p(x), and its parts are a(p). Build number s has the scatter z_s, which is the same at every
//! x. It is assembled from a(p(x)) + z_s. The result is a design b_s again (see [`crate::assembly`]), and
//!
//! ```text
//! db_s/dx = db/da da/dp dp/dx + db/dp dp/dx
//! ```
//!
//! The second term is the movement of the axes in which carriers are drawn: they move with the nominal design. Derivative
//! numbers pass through the same code as plain numbers, for a few variables at a time.
//!
//! The rate k(x) of an elastic part is k(x) (1 + z) or k(x) + z in a build.

use super::Infeasible;
use super::axle::ScatteredRate;
use super::moves::PointRate;
use super::station_reader::refused;
use crate::assembly::{Alignment, Assembler, Parts, Rest};
use crate::mechanism::DesignFault;
use crate::model::{Mechanism, PointId, Suspension};
use crate::number::{Dual, Vector3};
use crate::study::{Scatter, Source};
use crate::sweep::sobol;

/// Number of variables that one pass differentiates by.
const AT_ONCE: usize = 4;

/// The builds of a robust tuning.
pub(super) struct Builds<'a> {
    assembler: Assembler,
    scatter: &'a Scatter,
    /// Random numbers of the builds, `[build][source]`.
    draws: Vec<Vec<f64>>,
    moved: Vec<Vector3<Dual<f64, AT_ONCE>>>,
    /// Rates at which the variables move the points of the latest build, in the order of the point numbers.
    pub point_rates: Vec<PointRate>,
}

impl<'a> Builds<'a> {
    /// Prepares the builds of a suspension that [`Assembler::suspension`] returned.
    pub(super) fn new(suspension: &Suspension, scatter: &'a Scatter) -> Result<Self, DesignFault> {
        Ok(Builds {
            assembler: Assembler::new(suspension)?,
            scatter,
            draws: (0..scatter.builds)
                .map(|build| draw(scatter, build))
                .collect(),
            moved: Vec::new(),
            point_rates: Vec::new(),
        })
    }

    /// The assembler of builds of the latest nominal design.
    pub(super) fn assembler(&self) -> &Assembler {
        &self.assembler
    }

    /// The mechanism.
    pub(super) fn mechanism(&self) -> &Mechanism {
        &self.assembler.suspension().mechanism
    }

    /// Sources of scatter, in the order of the random numbers.
    pub(super) fn sources(&self) -> impl Iterator<Item = &'a Source> + use<'a> {
        sources(self.scatter)
    }

    /// Random numbers of the builds, `[build][source]`.
    pub(super) fn draws(&self) -> &[Vec<f64>] {
        &self.draws
    }

    /// Scatter of the rates of elastic parts in a build.
    pub(super) fn scattered_rates(&self, number: usize) -> Vec<ScatteredRate> {
        let sources = self.sources().zip(&self.draws[number]);
        let scattered = sources.filter_map(|(source, z)| {
            let rate = source.rate.as_ref()?;
            Some(ScatteredRate {
                parameter: rate.parameter,
                change: *z,
                is_relative: rate.is_relative,
            })
        });
        scattered.collect()
    }

    /// Number of builds.
    pub(super) fn count(&self) -> usize {
        self.draws.len()
    }

    /// Makes these the builds of a nominal design. Returns their alignment, if they are aligned.
    pub(super) fn redraw(
        &mut self,
        design: &[Vector3<f64>],
    ) -> Result<Option<Alignment>, Infeasible> {
        let redrawn = self.assembler.redraw(design);
        redrawn.map_err(refused(self.mechanism()))?;
        let aligned = self.scatter.adjust.as_ref();
        let alignment = aligned.map(|adjust| Alignment::of(adjust, &self.assembler));
        alignment.transpose().map_err(|_| {
            Infeasible::Refused("the adjustments of [setup] do not move toe and camber".to_owned())
        })
    }

    /// Assembles a build, and writes its design and [`Builds::point_rates`]. `drawn` are the rates of the nominal
    /// design.
    pub(super) fn build(
        &mut self,
        number: usize,
        alignment: Option<&Alignment>,
        drawn: &[PointRate],
        variables: usize,
        into: &mut [Vector3<f64>],
    ) -> Result<(), Infeasible> {
        let Builds {
            assembler,
            scatter,
            draws,
            moved,
            point_rates,
        } = self;
        let mechanism = &assembler.suspension().mechanism;
        let refused = |reject: crate::assembly::AssemblyError| {
            Infeasible::Refused(format!("build {number} cannot be assembled: {reject}"))
        };
        let mut parts = assembler.drawn().clone();
        for (source, z) in sources(scatter).zip(&draws[number]) {
            for (parameter, share) in &source.changes {
                parts.change(mechanism, *parameter, share * z);
            }
        }
        if let Some(alignment) = alignment {
            alignment
                .assemble(assembler, &mut parts, into)
                .map_err(refused)?;
        }
        let built = assembler
            .build(&parts, Rest::Height(0.0))
            .map_err(refused)?;
        into.copy_from_slice(&built.suspension.design);
        let alignment = alignment.and_then(|alignment| alignment.about(assembler, &built));
        point_rates.clear();
        let mut first = 0;
        while first < variables {
            let own = first..first + AT_ONCE;
            // The nominal design with its derivatives by these variables, and the parts made from it.
            moved.clear();
            moved.extend(parts.drawn.iter().map(|p| p.map(Dual::constant)));
            for rate in drawn.iter().filter(|rate| own.contains(&rate.column)) {
                let point = &mut moved[rate.point];
                let k = rate.column - first;
                point.x.partials[k] += rate.by.x;
                point.y.partials[k] += rate.by.y;
                point.z.partials[k] += rate.by.z;
            }
            let mut along = Parts::of_drawing(mechanism, moved);
            // Values of the build itself. Its scatter and adjustments are the same at every x, to first order.
            for (dual, value) in along.points.iter_mut().zip(&parts.points) {
                (dual.x.value, dual.y.value, dual.z.value) = (value.x, value.y, value.z);
            }
            for (dual, value) in along.lengths.iter_mut().zip(&parts.lengths) {
                dual.value = *value;
            }
            let design = match &alignment {
                None => assembler.design_of(&built, &along, 1),
                Some(alignment) => alignment.design(assembler, &built, &mut along, 1),
            };
            for (point, series) in design.iter().enumerate() {
                for k in 0..AT_ONCE.min(variables - first) {
                    let by = series.map(|c| c.partials[k]);
                    if by.norm_squared() > 0.0 {
                        let column = first + k;
                        point_rates.push(PointRate { column, point, by });
                    }
                }
            }
            first += AT_ONCE;
        }
        point_rates.sort_by_key(|rate| (rate.point, rate.column));
        Ok(())
    }
}

/// Scatter of a build, from a low-discrepancy sequence, so that few builds represent many.
fn draw(scatter: &Scatter, build: usize) -> Vec<f64> {
    let count = sources(scatter).count();
    let number = |(k, source): (usize, &Source)| {
        // Uses the middle of one of 2^24 intervals, so that the fraction is never 0 or 1.
        let fraction = sobol(build as u64, k, count, scatter.seed) + 0.5_f64.powi(25);
        source.law.quantile(fraction)
    };
    sources(scatter).enumerate().map(number).collect()
}

fn sources(scatter: &Scatter) -> impl Iterator<Item = &Source> {
    scatter.contributors.iter().flat_map(|c| &c.sources)
}

/// Returns the point that stands for the spin axis of a carrier without such a point, and the wheel centre that it follows.
/// The point keeps the study's direction wherever the wheel centre moves.
pub(super) fn follower(study: &Suspension, assembled: &Suspension) -> Option<(PointId, PointId)> {
    let added = assembled.design.len() > study.design.len();
    added.then_some((PointId(study.design.len()), study.mechanism.wheel_centre))
}
