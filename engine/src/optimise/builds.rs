//! Scattered builds of a robust tuning, with their derivatives with respect to the design variables. A build is a produced
//! vehicle: its dimensions and rates differ from the nominal ones by random amounts.
//!
//! At x the nominal design of a wheel is p(x), and its parts are a(p). Build number s has the scatter z_s, which is the same at
//! every x. It is assembled from a(p(x)) + z_s. The result is a design b_s again (see [`crate::assembly`]), and
//!
//! ```text
//! db_s/dx = db/da da/dp dp/dx + db/dp dp/dx
//! ```
//!
//! The second term comes from the axes in which the points of carriers are given: these axes move with the nominal design. The
//! same code processes plain numbers and derivative numbers, the latter for a few variables at a time.
//!
//! Each wheel of an axle is assembled separately, from the numbers of z_s that belong to it.
//!
//! In a build, the rate k(x) of an elastic part becomes k(x) (1 + z) or k(x) + z.

use super::Infeasible;
use super::axle::ScatteredRate;
use super::moved_wheel::{AT_ONCE, ByVariables, WheelMoved, along_variables, append_rates};
use super::moves::PointRate;
use super::station_reader::refused;
use crate::assembly::{Alignment, Assembler, AssemblyError, BuildParameter, Parts, Rest};
use crate::compliance::AxleParameter;
use crate::mechanism::DesignFault;
use crate::model::{Mechanism, Side, Suspension};
use crate::number::Vector3;
use crate::study::{Scatter, Source, Vehicle};
use crate::sweep::sobol;

/// The builds of a robust tuning.
pub(super) struct Builds<'a> {
    scatter: &'a Scatter,
    /// Random numbers of the builds, `[build][tolerance source]`.
    draws: Vec<Vec<f64>>,
    /// The only wheel, or left and right wheel.
    pub wheels: Vec<BuiltWheel<'a>>,
}

/// Builds of one wheel.
pub(super) struct BuiltWheel<'a> {
    scatter: &'a Scatter,
    assembler: Assembler,
    /// Wheel of an axle. `None` for the only wheel of a study.
    side: Option<Side>,
    /// Adjustments that keep toe and camber of the builds at their nominal values. They belong to the latest nominal
    /// design. `None` if the builds are not aligned.
    alignment: Option<Alignment>,
    moved: Vec<Vector3<ByVariables>>,
    /// Design of the latest build.
    pub design: Vec<Vector3<f64>>,
    /// Rates at which the variables move the points of the latest build, in the order of the point numbers.
    pub point_rates: Vec<PointRate>,
}

impl<'a> Builds<'a> {
    /// Prepares the builds of a vehicle that [`Vehicle::assembled`] returned.
    pub(super) fn new(vehicle: &Vehicle, scatter: &'a Scatter) -> Result<Self, DesignFault> {
        let wheel = |suspension, side| BuiltWheel::new(suspension, side, scatter);
        Ok(Builds {
            scatter,
            draws: (0..scatter.builds)
                .map(|build| draw(scatter, build))
                .collect(),
            wheels: match vehicle {
                Vehicle::Wheel(own) => vec![wheel(&own.suspension, None)?],
                Vehicle::Axle(both) => {
                    let own = |side| wheel(both.axle.suspension(side), Some(side));
                    vec![own(Side::Left)?, own(Side::Right)?]
                }
            },
        })
    }

    /// Random numbers of the builds, `[build][tolerance source]`.
    pub(super) fn draws(&self) -> &[Vec<f64>] {
        &self.draws
    }

    /// Scatter of the rates of elastic parts in a build.
    pub(super) fn scattered_rates(&self, number: usize) -> Vec<ScatteredRate> {
        let sources = sources(self.scatter).zip(&self.draws[number]);
        let scattered = sources.filter_map(|(source, z)| {
            let rate = source.rate.as_ref()?;
            Some(ScatteredRate {
                of: AxleParameter {
                    parameter: rate.parameter,
                    side: source.side,
                },
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

    /// Replaces the nominal designs from which the builds are made, one for each wheel.
    pub(super) fn redraw<'d>(
        &mut self,
        designs: impl IntoIterator<Item = &'d [Vector3<f64>]>,
    ) -> Result<(), Infeasible> {
        let mut wheels = self.wheels.iter_mut().zip(designs);
        wheels.try_for_each(|(wheel, design)| wheel.redraw(design))
    }

    /// Assembles all wheels of a build. Writes the designs of the wheels, and the rates at which the variables move their
    /// points. `nominal` contains the same data for the nominal wheels.
    pub(super) fn build<'d>(
        &mut self,
        number: usize,
        nominal: impl IntoIterator<Item = WheelMoved<'d>>,
        variables: usize,
    ) -> Result<(), Infeasible> {
        for (wheel, (_, rates)) in self.wheels.iter_mut().zip(nominal) {
            wheel
                .build(&self.draws[number], rates, variables)
                .map_err(|reject| {
                    let of = wheel
                        .side
                        .map_or(String::new(), |side| format!(", {} wheel", side.name()));
                    let reason = format!("build {number}{of} cannot be assembled: {reject}");
                    Infeasible::Refused(reason)
                })?;
        }
        Ok(())
    }
}

impl<'a> BuiltWheel<'a> {
    fn new(
        suspension: &Suspension,
        side: Option<Side>,
        scatter: &'a Scatter,
    ) -> Result<Self, DesignFault> {
        Ok(BuiltWheel {
            scatter,
            assembler: Assembler::new(suspension)?,
            side,
            alignment: None,
            moved: Vec::new(),
            design: suspension.design.clone(),
            point_rates: Vec::new(),
        })
    }

    /// Assembler for builds of the latest nominal design.
    pub(super) fn assembler(&self) -> &Assembler {
        &self.assembler
    }

    /// Adjustments that keep toe and camber of the builds at their nominal values. They belong to the latest nominal
    /// design. `None` if the builds are not aligned.
    pub(super) fn alignment(&self) -> Option<&Alignment> {
        self.alignment.as_ref()
    }

    /// Mechanism of this wheel.
    pub(super) fn mechanism(&self) -> &Mechanism {
        &self.assembler.suspension().mechanism
    }

    /// Dimensions of this wheel that each tolerance source changes, in the order of the random numbers.
    pub(super) fn changes(&self) -> impl Iterator<Item = &'a [(BuildParameter, f64)]> + use<'a> {
        let side = self.side;
        sources(self.scatter).map(move |source| source.changes_in(side))
    }

    fn redraw(&mut self, design: &[Vector3<f64>]) -> Result<(), Infeasible> {
        let redrawn = self.assembler.redraw(design);
        redrawn.map_err(refused(self.mechanism()))?;
        let aligned = self.scatter.adjust.as_ref();
        let alignment = aligned.map(|adjust| Alignment::of(adjust, self.side, &self.assembler));
        self.alignment = alignment.transpose().map_err(|_| {
            Infeasible::Refused("the adjustments of [setup] do not move toe and camber".to_owned())
        })?;
        Ok(())
    }

    /// Assembles a build from its random numbers. `nominal` contains the rates at which the variables move the points of the
    /// nominal design.
    fn build(
        &mut self,
        draws: &[f64],
        nominal: &[PointRate],
        variables: usize,
    ) -> Result<(), AssemblyError> {
        let changes = self.changes();
        let BuiltWheel {
            assembler,
            alignment,
            moved,
            design: into,
            point_rates,
            ..
        } = self;
        let mechanism = &assembler.suspension().mechanism;
        let mut parts = assembler.drawn().clone();
        for (changes, z) in changes.zip(draws) {
            for (parameter, share) in changes {
                parts.change(mechanism, *parameter, share * z);
            }
        }
        if let Some(alignment) = alignment {
            alignment.assemble(assembler, &mut parts, into)?;
        }
        let built = assembler.build(&parts, Rest::Height(0.0))?;
        into.copy_from_slice(&built.suspension.design);
        let alignment = alignment.as_ref();
        let alignment = alignment.and_then(|alignment| alignment.about(assembler, &built));
        point_rates.clear();
        for first in (0..variables).step_by(AT_ONCE) {
            // The nominal design with its derivatives with respect to the next few variables, and the parts made from it.
            along_variables(&parts.drawn, nominal, first, moved);
            let mut along = Parts::of_drawing(mechanism, moved);
            // Replaces the nominal values by the build's values. The derivatives stay, because the scatter of the build is
            // the same at every x. [`Alignment::design`] adds the derivatives of the adjustments.
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
            append_rates(&design, first, variables, point_rates);
        }
        point_rates.sort_by_key(|rate| (rate.point, rate.column));
        Ok(())
    }
}

/// Scatter of a build. The random numbers come from a low-discrepancy sequence, so that few builds represent many.
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
