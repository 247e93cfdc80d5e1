//! Values of one wheel, for the comparison of a design before and after a tuning.

use super::observed::{Gain, Grid, Observed, Series, Station};
use super::{PlaceCoordinate, customary};
use crate::ask::Unit;
use crate::characteristics::{Characteristic, Measure, Quantity};
use crate::compliance::not_of_equilibrium;
use crate::curves::{Curves, wheel_curves};
use crate::mechanism::DesignFault;
use crate::model::LengthUnit;
use crate::plan::{Output, Plan};
use crate::study::{
    Constraint, ElasticFigure, Motion, Optimise, Order, Outputs, Site, Study, Target, WheelStudy,
};

/// Characteristics that are compared in addition to the study's outputs.
const COMPARED: [Characteristic; 8] = [
    Characteristic::Camber,
    Characteristic::Toe,
    Characteristic::Caster,
    Characteristic::KingpinInclination,
    Characteristic::ScrubRadius,
    Characteristic::HalfTrackChange,
    Characteristic::RollCentreHeight,
    Characteristic::MotionRatio,
];

/// Computes the study's outputs and the compared characteristics over a motion.
pub(super) fn observe(
    study: &Study,
    own: &WheelStudy,
    name: Option<&str>,
) -> Result<Observed, DesignFault> {
    let motion = &own.motion;
    let gains = gains(study);
    let asked = WheelStudy {
        outputs: outputs(own, &gains),
        ..own.clone()
    };
    let plan = Plan::of(&asked);
    let found = wheel_curves(&asked, &plan)?;
    let length = asked.suspension.length_unit;
    let (stations, grid) = stations(motion, length);
    let optimise = study.optimise.as_ref();
    let shown = outputs(own, &[]).characteristics;
    let mut series = Vec::new();
    for (number, column) in found.columns.iter().enumerate() {
        let output = plan.outputs.get(number);
        let quantity = output.and_then(Output::quantity);
        let further = number.checked_sub(plan.outputs.len());
        let figure = further.and_then(|place| plan.figures.get(place));
        // A gain that the study does not compare is used only as the slope of another output.
        let is_hidden = |quantity| match quantity {
            Quantity::Characteristic(of) => !shown.contains(&of),
            _ => false,
        };
        let is_moved = |quantity| match quantity {
            Quantity::Coordinate(point, _) => {
                let variables = optimise.iter().flat_map(|o| &o.variables);
                variables.flat_map(|v| v.points()).any(|p| p == point)
            }
            _ => false,
        };
        // If a variable moves this point, the move is intended, so it is not a side effect. A hidden gain has no separate series,
        // either.
        if quantity.is_some_and(|own| is_moved(own) || is_hidden(own)) {
            continue;
        }
        let unit = match (quantity, output) {
            (Some(Quantity::Characteristic(c)), _) => c.info().unit,
            (Some(Quantity::Coordinate(..)), _) => Unit::Length,
            (None, Some(measured)) => measured.of.shown_unit(),
            // The results contain no angular velocities. All other columns are test results, or forces under a load.
            _ => figure.map_or(Unit::Force, |figure| figure.unit),
        };
        let at = Looked {
            motion,
            name,
            grid: &grid,
        };
        let wanted = optimise.map(|optimise| match (output, figure) {
            (Some(output), _) => at.wanted(&output.of, optimise),
            (None, Some(figure)) => at.wanted_figure(figure, optimise),
            (None, None) => Vec::new(),
        });
        let as_slope = |gain: &Characteristic| {
            let of = quantity?.characteristic()?;
            let factor = customary::slope_by_gain(*gain, of, &own.suspension)?;
            let gain = Quantity::Characteristic(*gain);
            let mut outputs = plan.outputs.iter();
            let number = outputs.position(|output| output.quantity() == Some(gain))?;
            Some(at.gain(gain, (&found, number, factor), optimise?))
        };
        series.push(Series {
            gains: gains.iter().filter_map(as_slope).collect(),
            unit: column.unit.clone(),
            wanted: wanted.unwrap_or_default(),
            values: found.stations.iter().map(|s| s.value(number)).collect(),
            ..Series::new(&column.output, unit, length, &stations)
        });
    }
    Ok(Observed {
        motion: None,
        stations,
        series,
    })
}

/// Outputs whose values are compared: the study's outputs, the compared characteristics that exist for this wheel, and
/// `gains`. The outputs have no derivatives.
fn outputs(own: &WheelStudy, gains: &[Characteristic]) -> Outputs {
    let mut characteristics = own.outputs.characteristics.clone();
    for more in Characteristic::available(&own.suspension) {
        let is_there = own.compliance.is_none() || not_of_equilibrium(more).is_none();
        if COMPARED.contains(&more) && is_there && !characteristics.contains(&more) {
            characteristics.push(more);
        }
    }
    let further = gains.iter().filter(|gain| !characteristics.contains(gain));
    let further: Vec<_> = further.copied().collect();
    characteristics.extend(further);
    Outputs {
        characteristics,
        knuckle: false,
        order: Order::Position,
        sensitivities: Vec::new(),
        certify: false,
        ..own.outputs.clone()
    }
}

/// Gains with targets or constraints, each once.
fn gains(study: &Study) -> Vec<Characteristic> {
    let optimise = study.optimise.iter();
    let parts = |optimise: &&Optimise| {
        let parts = optimise.constraints.iter().flat_map(|own| &own.parts);
        let limited = parts.filter_map(|part| part.of.quantity()?.characteristic());
        let targets = optimise.targets.iter();
        let wanted = targets.filter_map(|target| target.of.as_characteristic());
        wanted.chain(limited).collect::<Vec<_>>()
    };
    let all = optimise.flat_map(|own| parts(&own));
    let mut gains = Vec::new();
    for gain in all.filter(|own| customary::integral_of(*own).is_some()) {
        if !gains.contains(&gain) {
            gains.push(gain);
        }
    }
    gains
}

/// Stations of a motion, one rack displacement after another, and the grid of these stations over drive and rack.
fn stations(motion: &Motion, length: LengthUnit) -> (Vec<Station>, Grid) {
    let racks = motion.rack.iter();
    let places = racks.flat_map(|rack| motion.values.iter().map(|value| vec![*value, *rack]));
    let places: Vec<Vec<f64>> = places.collect();
    let grid = Grid::of(&places);
    let station = |place: &Vec<f64>| {
        let (drive, rack) = (motion.drive, place[1]);
        let mut coordinates = vec![PlaceCoordinate {
            name: drive.key().to_owned(),
            value: drive.printed(place[0]),
            unit: drive.unit(length).to_owned(),
        }];
        if motion.rack_moves || rack != 0.0 {
            coordinates.push(PlaceCoordinate {
                name: "rack".to_owned(),
                value: rack,
                unit: length.symbol().to_owned(),
            });
        }
        Station {
            position: grid.shares(place),
            place: coordinates,
            case: None,
            is_straight: rack == 0.0,
        }
    };
    (places.iter().map(station).collect(), grid)
}

/// Stations of a motion. Used to find the stations at which targets and constraints apply.
struct Looked<'a> {
    motion: &'a Motion,
    name: Option<&'a str>,
    grid: &'a Grid,
}

impl Looked<'_> {
    /// Stations at which a target or a constraint concerns a measure.
    fn wanted(&self, measure: &Measure, optimise: &Optimise) -> Vec<usize> {
        let characteristic = |measure: &Measure| measure.quantity()?.characteristic();
        let is_about = |other: &Measure| match (characteristic(other), characteristic(measure)) {
            (Some(target), Some(of)) => customary::determines(target, of),
            _ => other == measure,
        };
        self.stations_of(optimise, is_about)
    }

    /// Stations of the targets and constraints whose measure satisfies `is_about`.
    fn stations_of(&self, optimise: &Optimise, is_about: impl Fn(&Measure) -> bool) -> Vec<usize> {
        let targets = optimise.targets.iter();
        let of_targets = targets.filter(|target| {
            let characteristic = target.of.as_characteristic();
            let own = characteristic.map(|c| Measure::Quantity(Quantity::Characteristic(c)));
            let measure = target.of.of_wheel().or(own.as_ref());
            measure.is_some_and(&is_about)
        });
        let mut places = self.of_targets(of_targets);
        let limits = |c: &&Constraint| c.parts.iter().any(|part| is_about(&part.of));
        for constraint in optimise.constraints.iter().filter(limits) {
            match &constraint.site {
                Some(site) => places.extend(self.at(site, &self.motion.values)),
                None => places.extend(self.at(&Site::default(), &[0.0])),
            }
        }
        places
    }

    /// Slope of a curve: `factor` times the gain in a column of the results.
    fn gain(
        &self,
        gain: Quantity,
        (found, column, factor): (&Curves, usize, f64),
        optimise: &Optimise,
    ) -> Gain {
        let wanted = self.stations_of(optimise, |of| of.quantity() == Some(gain));
        let values = found.stations.iter().map(|s| s.value(column));
        Gain {
            wanted: wanted.into_iter().collect(),
            slopes: values.map(|value| Some(factor * value?)).collect(),
            travels: found.along("travel").collect(),
        }
    }

    /// Stations at which a target concerns a test result.
    fn wanted_figure(&self, figure: &ElasticFigure, optimise: &Optimise) -> Vec<usize> {
        let targets = optimise.targets.iter();
        self.of_targets(targets.filter(|t| t.of.as_figure().as_ref() == Some(figure)))
    }

    /// Stations at which these targets apply.
    fn of_targets<'t>(&self, targets: impl Iterator<Item = &'t Target>) -> Vec<usize> {
        let mut places = Vec::new();
        for target in targets {
            let samples = target.wanted.samples(&target.stations_in(self.motion));
            let drives: Vec<f64> = samples.iter().map(|sample| sample.drive).collect();
            places.extend(self.at(&target.site, &drives));
        }
        places
    }

    /// Stations nearest to these drive values, at the rack displacements of `site`, the place of a target or constraint. Empty if
    /// `site` is on another motion. Leaves out rack displacements that the motion does not have.
    fn at(&self, site: &Site, drives: &[f64]) -> Vec<usize> {
        if site.motion.as_ref().map(|(name, _)| name.as_str()) != self.name {
            return Vec::new();
        }
        let home = self.motion.design_rack();
        let racks = match site.racks.as_slice() {
            [] => vec![home],
            racks => racks.to_vec(),
        };
        let places = racks
            .iter()
            .flat_map(|rack| drives.iter().map(move |drive| [*drive, *rack]));
        let station = |place: [f64; 2]| self.grid.station(&place, 0);
        places.filter_map(station).collect()
    }
}
