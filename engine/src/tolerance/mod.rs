//! Tolerance analysis: effect of manufacturing scatter on curves and test results.
//!
//! Deviations of parts are independent random numbers z with mean m and variance s^2 ([`crate::study::Source`]). Near the
//! nominal design, a value y of a build is
//!
//! ```text
//! y = y0 + g.z + z.H z/2 + ...
//! sigma^2 = sum of g_k^2 s_k^2        first order, each term is the part of one deviation
//! mean y - y0 = tr(H S)/2             second order, m = 0
//! sigma^2 grows by tr((H S)^2)/2      for normal z; a uniform z_k adds H_kk^2 s_k^4 (1.8 - 3)/4
//! ```
//!
//! Here y0 is the nominal value, g the gradient, H the Hessian, and S the diagonal matrix of the variances s_k^2. g and H are
//! exact ([`crate::assembly`]), for one wheel and for an axle, without finite differences. H is not computed for elastic parts
//! and for quantities that contain velocities. In addition, a Monte Carlo
//! analysis assembles builds and solves them over the motion. The linear result is valid if the square of the mean shift and
//! the growth of the variance are below 2 % of sigma^2.

mod axle_expansion;
mod axle_second;
mod builds;
mod car;
mod car_second;
mod draw;
mod elastic;
mod elastic_axle;
mod estimate;
mod expansion;
mod histogram;
mod lanes;
mod monte_carlo;
mod order;
mod wheel_assembler;
mod yields;

pub use car::{CarBuilds, CarExpansion, CarProblem};
pub use draw::normal_quantile;
pub use estimate::{Estimate, HOLDS, Remainder, with_rounding};
pub use expansion::Expansion;
pub use histogram::{BINS, Histogram};
pub use monte_carlo::{FEWEST, MonteCarlo, Rejected, Spread, monte_carlo, monte_carlo_in};
pub use yields::{BandYield, Forecast, Ranking, Yields, rank};

use crate::assembly::SetUpError;
use crate::axle::{Axle, Placement};
use crate::characteristics::{Characteristic, Quantity};
use crate::compliance::KcValue;
use crate::curves::Column;
use crate::evaluate::{AxleStations, ElasticAxleParts, Request, Stations};
use crate::model::Side;
use crate::study::{AxleSite, AxleStudy, Band, Study, TargetKind, Tolerance, Vehicle, WheelStudy};
use crate::threads::Interrupt;
use std::borrow::Cow;
use std::sync::atomic::AtomicBool;
use wheel_assembler::WheelAssembler;

/// Percentages for which the results contain percentiles.
pub const PERCENTILES: [f64; 7] = [0.5, 1.0, 5.0, 50.0, 95.0, 99.0, 99.5];

/// Prepared tolerance analysis of a study, for one wheel or for both wheels of an axle.
pub struct Problem<'a> {
    /// The study.
    pub study: &'a Study,
    /// Tolerances of the study: dimensions that scatter, and limits for the builds.
    pub tolerance: &'a Tolerance,
    /// Quantities and stations. They come from the study's outputs and motion, then from the design position and the bands. For
    /// an axle, each wheel has separate hardpoints.
    request: Request<'static>,
    /// For each band: the values that the band limits, each given by its output and its station, and the limits of the band.
    bands: Vec<Banded>,
    /// Assemblers of the wheels: left, then right.
    wheel_assemblers: Vec<WheelAssembler>,
    /// Values of a wheel with elastic parts, in the order of the outputs. Empty for rigid wheels.
    elastic: Vec<KcValue>,
    /// Flag that stops a Monte Carlo analysis.
    interrupt: Interrupt<'a>,
}

/// Values of a band as [output, station], and the limits of the band, moved outwards by the rounding error.
type Banded = (Vec<[usize; 2]>, [f64; 2]);

/// Positions of the axle (placements) at which a band applies. These are the stations with the band's own drive value, if
/// the band has one. Otherwise they are all stations of `site`.
fn placements_of(band: &Band, site: &AxleSite, axle: &Axle) -> Vec<Placement> {
    let values = band
        .at
        .as_ref()
        .map_or(&site.values[..], std::slice::from_ref);
    let values = values.iter();
    values.flat_map(|at| site.placements(*at, axle)).collect()
}

impl<'a> Problem<'a> {
    /// Returns the problem with a flag that stops the builds. The result omits the block that is running when the flag is
    /// raised.
    pub fn interruptible(self, flag: &'a AtomicBool) -> Self {
        Problem {
            interrupt: Interrupt(Some(flag)),
            ..self
        }
    }

    /// Prepares the tolerances of a study. An error says why the study's own design cannot be solved or aligned.
    pub fn of(study: &'a Study, tolerance: &'a Tolerance) -> Result<Self, SetUpError> {
        match &study.vehicle {
            Vehicle::Wheel(own) => Problem::of_wheel(study, own, tolerance),
            Vehicle::Axle(both) => Problem::of_axle(study, both, tolerance),
        }
    }

    fn of_wheel(
        study: &'a Study,
        own: &WheelStudy,
        tolerance: &'a Tolerance,
    ) -> Result<Self, SetUpError> {
        if let Some(elastic) = &own.compliance {
            return elastic::problem(study, own, elastic, tolerance);
        }
        let suspension = &own.suspension;
        let mut characteristics = own.outputs.characteristics.clone();
        for characteristic in tolerance
            .bands
            .iter()
            .filter_map(|b| b.of.as_characteristic())
        {
            if !characteristics.contains(&characteristic) {
                characteristics.push(characteristic);
            }
        }
        let further: Vec<f64> = tolerance.bands.iter().filter_map(|band| band.at).collect();
        let stations = Stations::of(&own.motion, &suspension.frame, &further);
        let banded = |band: &Band| {
            let same = |c: &Characteristic| Some(*c) == band.of.as_characteristic();
            let output = characteristics.iter().position(same);
            let output = output.expect("every band's characteristic is computed");
            let places: Vec<usize> = match band.at {
                Some(at) => stations.at(at).into_iter().collect(),
                None => stations.of_motion().collect(),
            };
            let cells = places.into_iter().map(|station| [output, station]);
            (cells.collect(), with_rounding(band.between))
        };
        let length = suspension.length_unit;
        let output = |c: &Characteristic| Column::of_characteristic(*c, length);
        let bands = tolerance.bands.iter().map(banded).collect();
        let wheel_assembler = WheelAssembler::of(study, tolerance, suspension, None)?;
        let quantities = characteristics.iter().copied();
        let quantities = quantities.map(Quantity::Characteristic).collect();
        let columns = characteristics.iter().map(output).collect();
        let drawn = Cow::Owned(wheel_assembler.assembler.suspension().clone());
        Ok(Problem {
            study,
            tolerance,
            request: Request::of_corner(drawn, stations, quantities, columns),
            bands,
            wheel_assemblers: vec![wheel_assembler],
            elastic: Vec::new(),
            interrupt: Interrupt::default(),
        })
    }

    fn of_axle(
        study: &'a Study,
        both: &AxleStudy,
        tolerance: &'a Tolerance,
    ) -> Result<Self, SetUpError> {
        let mut wheel_assemblers = Vec::new();
        for side in Side::ALL {
            let suspension = both.axle.suspension(side);
            wheel_assemblers.push(WheelAssembler::of(
                study,
                tolerance,
                suspension,
                Some(side),
            )?);
        }
        let drawn = |side: Side| {
            wheel_assemblers[side as usize]
                .assembler
                .suspension()
                .clone()
        };
        let axle = Axle {
            left: drawn(Side::Left),
            right: Some(drawn(Side::Right)),
            setup: both.axle.setup.clone(),
            elastic: both.axle.elastic.clone(),
        };
        let mut plan = both.plan.quantities_alone();
        let of_motion = plan.motion.placements();
        let at_design = plan.motion.at_design().placements();
        let mut wanted = Vec::new();
        for band in &tolerance.bands {
            let (TargetKind::Axle(quantities), between) = (&band.of.kind, band.between) else {
                unreachable!("the band is for an axle");
            };
            for quantity in quantities {
                if !plan.quantities.contains(quantity) {
                    plan.quantities.push(*quantity);
                }
            }
            let placements = match &band.site {
                // Test results apply to the design position.
                None if band.of.is_figure() => at_design.clone(),
                None => of_motion.clone(),
                Some(site) => placements_of(band, site, &axle),
            };
            wanted.push((quantities, placements, between));
        }
        let further = wanted.iter().flat_map(|(_, placements, _)| placements);
        let mut stations = AxleStations::of(Cow::Owned(axle), &plan, further.copied());
        stations.of_builds = true;
        let banded = |(quantities, placements, between): &(&Vec<_>, Vec<_>, [f64; 2])| {
            let places = placements.iter().flat_map(|placement| {
                let own = quantities.iter();
                own.map(|quantity| stations.place(*quantity, *placement))
            });
            (places.collect(), with_rounding(*between))
        };
        let bands: Vec<Banded> = wanted.iter().map(banded).collect();
        if both.axle.elastic.is_some() {
            let cells = bands.iter().flat_map(|(cells, _)| cells);
            stations.elastic = Some(ElasticAxleParts {
                rates: elastic_axle::inputs(tolerance, &wheel_assemblers[0]).collect(),
                further: cells.copied().collect(),
            });
        }
        Ok(Problem {
            study,
            tolerance,
            bands,
            request: Request::of_axle(stations),
            wheel_assemblers,
            elastic: Vec::new(),
            interrupt: Interrupt::default(),
        })
    }

    /// Columns of the results: first the study's outputs, then the outputs that bands limit.
    pub fn outputs(&self) -> &[Column] {
        self.request.columns()
    }

    /// Stations of the results. For an axle: the motion, then the design position, then the stations of bands. For one wheel: all
    /// combinations of these drive values and rack displacements ([`Stations::of`]).
    pub fn stations(&self) -> &Stations {
        self.request.stations()
    }

    /// Characteristics of a study of one wheel, in the order of [`Problem::outputs`]. Empty for an axle and for elastic parts.
    fn characteristics(&self) -> impl Iterator<Item = Characteristic> {
        self.request.of_wheel().iter().filter_map(|q| match q {
            Quantity::Characteristic(c) => Some(*c),
            Quantity::Coordinate(..) | Quantity::AngularVelocity(_) => None,
        })
    }

    /// Number of values of a build: outputs times stations.
    pub fn cells(&self) -> usize {
        self.outputs().len() * self.stations().count()
    }

    /// Index of the value of an output at a station.
    pub fn cell(&self, output: usize, station: usize) -> usize {
        output * self.stations().count() + station
    }

    /// For each band, the indices ([`Problem::cell`]) of the values that must be within the band.
    pub fn cells_of_bands(&self) -> impl Iterator<Item = Vec<usize>> + '_ {
        let cell = |[output, station]: &[usize; 2]| self.cell(*output, *station);
        let bands = self.bands.iter();
        bands.map(move |(places, _)| places.iter().map(cell).collect())
    }

    /// For each band that the nominal design misses: its index, and the output and station of the nominal value that is
    /// farthest outside its limits. A missing value is outside. `nominal` has all values of the nominal design.
    pub fn bands_missed(&self, nominal: &[f64]) -> Vec<(usize, [usize; 2])> {
        let beyond = |[output, station]: [usize; 2], [low, high]: [f64; 2]| {
            let value = nominal[self.cell(output, station)];
            if value.is_nan() {
                f64::INFINITY
            } else {
                (low - value).max(value - high)
            }
        };
        let bands = self.bands.iter().enumerate();
        let missed = bands.filter_map(|(number, (places, limits))| {
            let outside = places.iter().map(|place| (beyond(*place, *limits), *place));
            let (most, place) = outside.max_by(|a, b| a.0.total_cmp(&b.0))?;
            (most > 0.0).then_some((number, place))
        });
        missed.collect()
    }

    /// Positions of the axle (placements) at all stations. Empty for a study of one wheel.
    pub fn placements(&self) -> &[Placement] {
        self.request.axle().map_or(&[], |axle| &axle.placements)
    }
}
