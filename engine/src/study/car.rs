//! Studies of a car: `[car]` with two studies of axles, load cases, and outputs.

mod asked;
mod tuned;
mod tuning;
mod variables;

pub use tuned::TunedCar;

use super::error::Problems;
use super::names::{choose, choose_or};
use super::suspension::{above_zero, mass_unit, positive, three};
use super::{
    FileFormat, Law, Sampled, Study, StudyError, StudyErrors, Tolerance, overrides, parse, source,
};
use crate::ask::Need;
use crate::axle::Axle;
use crate::car::{
    Air, AirForce, Car, CarConstraint, CarGoals, CarQuantity, CarRun, CarTarget, CarVariable, Case,
    LateralShares, Longitudinal, LongitudinalShares, Masses, Moves, RigGoals, Tyre, TyreAxes,
};
use crate::model::{Axis, AxlePosition, Frame, LengthUnit, MassUnit, Side};
use crate::number::Vector3;
use hardpoint_study_file::car_file::{self, CarFile};
use hardpoint_study_file::error::Source;
use hardpoint_study_file::file::Coordinates;
use hardpoint_study_file::value::{Number, Text};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// The study of a car, resolved and validated.
#[derive(Clone, Debug)]
pub struct CarStudy {
    /// Name, from the file's name.
    pub name: String,
    /// The text the study was read from, with `--set` applied.
    pub text: String,
    /// The studies of front and rear axle.
    pub axles: [Study; 2],
    /// The files that were read.
    pub inputs: Vec<PathBuf>,
    /// The car.
    pub car: Car,
    /// Load cases, the one at rest first.
    pub cases: Vec<Case>,
    /// Requested results.
    pub quantities: Vec<CarQuantity>,
    /// True if the study asks for derivatives by parameters and hardpoints.
    pub sensitivities: bool,
    /// True if the study asks for forces in members.
    pub member_loads: bool,
    /// States over ax and ay.
    pub gg_map: Option<GgMap>,
    /// Sweep.
    pub sweep: Option<CarSweep>,
    /// Tuning.
    pub optimise: Option<CarOptimise>,
    /// Scatter of parts, rates and masses.
    pub tolerance: Option<CarTolerance>,
}

/// States over ax and ay.
#[derive(Clone, Debug)]
pub struct GgMap {
    /// Accelerations forward.
    pub ax: Vec<f64>,
    /// Accelerations to the left.
    pub ay: Vec<f64>,
    /// The rest of every case.
    pub case: Case,
}

/// Tuning of a car.
#[derive(Clone, Debug)]
pub struct CarOptimise {
    /// Budget and starts.
    pub run: CarRun,
    /// Design variables.
    pub variables: Vec<CarVariable>,
    /// Targets of cases.
    pub targets: Vec<CarTarget>,
    /// Constraints of cases.
    pub constraints: Vec<CarConstraint>,
    /// Targets and constraints of the front and of the rear axle by themselves.
    pub rigs: [Option<RigGoals>; 2],
    /// True if changes that no target asks for are reported beside the tuned car.
    pub side_effects: bool,
}

/// Sweep of a car.
#[derive(Clone, Debug, PartialEq)]
pub struct CarSweep {
    /// Sampling of the variables' values.
    pub sampled: Sampled,
    /// Part of the car that each variable moves.
    pub variables: Vec<CarVariable>,
    /// File format of the results.
    pub format: FileFormat,
}

/// Scatter of a car's parts, rates and masses.
#[derive(Clone, Debug, PartialEq)]
pub struct CarTolerance {
    /// Number of builds.
    pub builds: u64,
    /// Seed, as the study gives it.
    pub seed: u32,
    /// Seed of the figures' random numbers.
    pub figure_seed: u32,
    /// Parts of the front and of the rear axle that scatter.
    pub axles: [Tolerance; 2],
    /// Everything that scatters, in the order of the study.
    pub contributors: Vec<CarContributor>,
    /// Limits for the yield.
    pub bands: Vec<CarBand>,
}

/// Something of a car that scatters.
#[derive(Clone, Debug, PartialEq)]
pub enum CarContributor {
    /// Parts of an axle.
    Part {
        /// Name.
        name: String,
        /// The axle, 0 the front one.
        axle: usize,
        /// Number in the scatter of the axle.
        number: usize,
    },
    /// A rate or a figure of the car.
    Figure {
        /// Name.
        name: String,
        /// The rate or figure.
        moves: Moves,
        /// Distribution of its deviation.
        law: Law,
    },
}

impl CarContributor {
    /// Name.
    pub fn name(&self) -> &str {
        match self {
            CarContributor::Part { name, .. } | CarContributor::Figure { name, .. } => name,
        }
    }
}

/// Limits of a result in a case, as printed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CarBand {
    /// The result.
    pub quantity: CarQuantity,
    /// Number of the case.
    pub case: usize,
    /// Lower and upper limit.
    pub between: [f64; 2],
}

/// Names of the axles.
const ENDS: [(&str, usize); 2] = [("front", 0), ("rear", 1)];

/// Names that are no names of cases.
const RESERVED: [&str; 5] = ["front", "rear", "left", "right", "static"];

/// The most states of a map.
const MOST_STATES: i64 = 100_000;

impl CarStudy {
    /// True if a file is the study of a car.
    pub fn is_at(path: &Path) -> bool {
        path != Path::new("-")
            && source::read_text(path, source::LONGEST_TEXT)
                .is_ok_and(|text| parse::car_section(&text).is_some())
    }

    /// Reads the study of a car, with the changes of `--set`. Changes of `front.` and `rear.` apply to the studies of the
    /// axles.
    pub fn read(path: &Path, changes: &[String]) -> Result<CarStudy, StudyErrors> {
        let shown = path.display().to_string();
        let text = source::read_text(path, source::LONGEST_TEXT)
            .map_err(|reason| StudyError::of_file(&shown, format!("cannot be read: {reason}")))?;
        let of_axle = |end: &str| -> Vec<String> {
            let own = changes.iter().filter_map(|change| change.strip_prefix(end));
            own.map(str::to_owned).collect()
        };
        let of_axles = [of_axle("front."), of_axle("rear.")];
        let own: Vec<String> = changes
            .iter()
            .filter(|change| !change.starts_with("front.") && !change.starts_with("rear."))
            .cloned()
            .collect();
        let text = match own.is_empty() {
            true => text,
            false => overrides::apply(&shown, &text, &own)?,
        };
        let source = Arc::new(Source { name: shown, text });
        let file = parse::parse_car(&source)?;
        let directory = path.parent().unwrap_or(Path::new(""));
        let written = [&file.car.get_ref().front, &file.car.get_ref().rear];
        let paths = written.map(|written| directory.join(written.get_ref()));
        let [front, rear] = [0, 1].map(|end| Study::read(&paths[end], &of_axles[end]));
        let axles = [front?, rear?];
        let stem = path
            .file_stem()
            .map(|stem| stem.to_string_lossy().into_owned());
        let [front, rear] = paths;
        let inputs = vec![path.to_owned(), front, rear];
        CarStudy::of_file(&source, &file, axles, stem.unwrap_or_default(), inputs)
    }

    /// The study of a car from its text and the studies of both axles, whatever files the text names.
    pub fn of_axles(name: &str, text: &str, axles: [Study; 2]) -> Result<CarStudy, StudyErrors> {
        let source = Arc::new(Source {
            name: format!("{name}.toml"),
            text: text.to_owned(),
        });
        let file = parse::parse_car(&source)?;
        CarStudy::of_file(&source, &file, axles, name.to_owned(), Vec::new())
    }

    fn of_file(
        source: &Arc<Source>,
        file: &CarFile,
        axles: [Study; 2],
        name: String,
        inputs: Vec<PathBuf>,
    ) -> Result<CarStudy, StudyErrors> {
        let mut problems = Problems::new(source.clone());
        let found = Resolver {
            file,
            axles: &axles,
            problems: &mut problems,
        }
        .resolve();
        let study = found.map(|found| CarStudy {
            name,
            text: source.text.clone(),
            inputs,
            axles: axles.clone(),
            car: found.car,
            cases: found.cases,
            quantities: found.quantities,
            member_loads: file
                .outputs
                .member_loads
                .as_ref()
                .is_some_and(|loads| *loads.get_ref()),
            sensitivities: file
                .outputs
                .sensitivities
                .as_ref()
                .is_some_and(|s| *s.get_ref()),
            gg_map: found.gg_map,
            sweep: found.sweep,
            optimise: found.optimise,
            tolerance: found.tolerance,
        });
        problems.finish(study)
    }

    /// The results that sweeps and tolerances keep of each design: those that the study asks for, else the key ones.
    pub fn kept_quantities(&self) -> Vec<CarQuantity> {
        match self.quantities == CarQuantity::default_columns(&self.car) {
            true => CarQuantity::key_columns(&self.car),
            false => self.quantities.clone(),
        }
    }

    /// The goals of a tuning.
    pub fn goals<'s>(&'s self, optimise: &'s CarOptimise) -> CarGoals<'s> {
        let rig = |end: usize| {
            let goals = optimise.rigs[end].as_ref()?;
            Some((&self.axles[end].vehicle, goals))
        };
        CarGoals {
            cases: &self.cases,
            variables: &optimise.variables,
            targets: &optimise.targets,
            constraints: &optimise.constraints,
            rigs: [rig(0), rig(1)],
        }
    }

    /// The front study's axes, in which the car's points are written.
    pub fn frame(&self) -> Frame {
        self.axles[0].wheel().frame
    }
}

/// The sections of a study, resolved.
struct Resolved {
    car: Car,
    cases: Vec<Case>,
    quantities: Vec<CarQuantity>,
    gg_map: Option<GgMap>,
    sweep: Option<CarSweep>,
    optimise: Option<CarOptimise>,
    tolerance: Option<CarTolerance>,
}

struct Resolver<'a> {
    file: &'a CarFile,
    axles: &'a [Study; 2],
    problems: &'a mut Problems,
}

impl Resolver<'_> {
    fn resolve(mut self) -> Option<Resolved> {
        let car = self.car()?;
        let cases = self.cases(&car);
        let quantities = self.quantities(&car);
        let gg_map = self.gg_map(&car);
        let cases = cases?;
        let sweep = self.sweep(&car);
        let optimise = self.optimise(&car, &cases);
        let tolerance = self.tolerance(&car, &cases);
        Some(Resolved {
            cases,
            quantities: quantities?,
            gg_map: gg_map?,
            sweep: sweep?,
            optimise: optimise?,
            tolerance: tolerance?,
            car,
        })
    }

    fn frame(&self) -> Frame {
        self.axles[0].wheel().frame
    }

    fn point(&mut self, written: &Coordinates) -> Option<Vector3<f64>> {
        let point = three(written, "coordinates [x, y, z]", self.problems)?;
        Some(self.frame().vector(point))
    }

    fn maybe_point(&mut self, written: &Option<Coordinates>) -> Option<Option<Vector3<f64>>> {
        match written {
            Some(written) => self.point(written).map(Some),
            None => Some(None),
        }
    }

    fn axle(&mut self, end: usize) -> Option<Axle> {
        let section = self.file.car.get_ref();
        let place = [&section.front, &section.rear][end].span();
        let name = ["front", "rear"][end];
        let Some(both) = self.axles[end].axle() else {
            let message =
                format!("the {name} study describes one wheel; expected a study with [axle]");
            let error = self.problems.add(place, message);
            error.help("[axle] with right = \"mirrored\" makes it a study of both wheels");
            return None;
        };
        let axle = both.axle.clone();
        let wanted = [AxlePosition::Front, AxlePosition::Rear][end];
        if axle
            .setup
            .position
            .is_some_and(|position| position != wanted)
        {
            let message = format!(
                "the {name} study describes the other axle: its [vehicle] position differs"
            );
            return self.problems.refuse(place, message);
        }
        let needed = [
            (Need::WheelRadius, "radius in [wheel]"),
            (Need::Springs, "[spring], [heave_spring] or [heave_bar]"),
            (Need::UnsprungMass, "unsprung_mass in [vehicle]"),
        ];
        for (need, key) in needed {
            if !axle.meets(need) {
                let message =
                    format!("a car needs {key} of its {name} axle, which the study does not give");
                return self.problems.refuse(place, message);
            }
        }
        Some(axle)
    }

    fn car(&mut self) -> Option<Car> {
        let file = self.file;
        let section = file.car.get_ref();
        let (front, rear) = (self.axle(0), self.axle(1));
        let axles = [front?, rear?];
        let [unit, of_rear] = axles.each_ref().map(|axle| axle.left.length_unit);
        if of_rear != unit {
            let words = |unit: LengthUnit| format!("{} and {}", unit.symbol(), unit.force_symbol());
            let message = format!(
                "the rear study is in {}, the front study in {}: both axles of a car need one length_unit and one force_unit",
                words(of_rear),
                words(unit)
            );
            return self.problems.refuse(section.rear.span(), message);
        }
        let mass_unit = mass_unit(&section.mass_unit, self.problems)?;
        let rear_offset = self.rear_offset(&axles)?;
        let (masses, mass, cg) = self.masses(mass_unit)?;
        let share = |written: &Option<Number>, problems: &mut Problems| match written {
            Some(share) if !(0.0..=1.0).contains(&share.value) => {
                let message = format!("expected a share from 0 to 1, found {}", share.value);
                problems.refuse(share.span.clone(), message)
            }
            other => Some(other.as_ref().map(|share| share.value)),
        };
        let brake_share_front = share(&section.brake_share_front, self.problems)?;
        let drive_share_front = share(&section.drive_share_front, self.problems)?;
        let yaw_inertia = positive(&section.yaw_inertia, self.problems)?;
        let pitch_inertia = positive(&section.pitch_inertia, self.problems)?;
        let points = [
            self.maybe_point(&section.ride_height_point_front)?,
            self.maybe_point(&section.ride_height_point_rear)?,
        ];
        let air = self.air(points)?;
        let tyres = self.tyres(&axles)?;
        Some(Car {
            axles,
            rear_offset,
            masses,
            mass,
            mass_unit,
            cg,
            brake_share_front,
            drive_share_front,
            yaw_inertia,
            pitch_inertia,
            ride_height_points: points,
            tyres,
            air,
            length_unit: unit,
        })
    }

    fn rear_offset(&mut self, axles: &[Axle; 2]) -> Option<Vector3<f64>> {
        let file = self.file;
        let section = file.car.get_ref();
        let mid = |axle: &Axle| {
            let centre = |side: Side| {
                let wheel = axle.suspension(side);
                wheel.design[wheel.mechanism.wheel_centre.0].x
            };
            0.5 * (centre(Side::Left) + centre(Side::Right))
        };
        match (&section.wheelbase, &section.rear_offset) {
            (Some(wheelbase), None) => {
                let length = above_zero(wheelbase, self.problems)?;
                let x = mid(&axles[0]) - length - mid(&axles[1]);
                Some(Vector3::new(x, 0.0, 0.0))
            }
            (None, Some(offset)) => {
                let place = offset.span();
                let offset = self.point(offset)?;
                if mid(&axles[0]) <= mid(&axles[1]) + offset.x {
                    let message = "rear_offset puts the rear axle ahead of the front axle";
                    return self.problems.refuse(place, message);
                }
                Some(offset)
            }
            _ => {
                let message = "expected wheelbase or rear_offset, and only one of them";
                self.problems.refuse(file.car.span(), message)
            }
        }
    }

    fn masses(&mut self, unit: MassUnit) -> Option<(Masses, f64, Vector3<f64>)> {
        let file = self.file;
        let section = file.car.get_ref();
        let whole = section.mass.as_ref().zip(section.cg.as_ref());
        let sprung = section.sprung_mass.as_ref().zip(section.sprung_cg.as_ref());
        let count = [
            section.mass.is_some(),
            section.cg.is_some(),
            section.sprung_mass.is_some(),
            section.sprung_cg.is_some(),
        ];
        let (masses, (mass, cg)) = match (whole, sprung, count.iter().filter(|c| **c).count()) {
            (Some(whole), None, 2) => (Masses::Whole, whole),
            (None, Some(sprung), 2) => (Masses::Sprung, sprung),
            _ => {
                let message =
                    "expected mass with cg of the whole car, or sprung_mass with sprung_cg";
                return self.problems.refuse(file.car.span(), message);
            }
        };
        let place = mass.span.clone();
        let mass = above_zero(mass, self.problems)? * unit.kilograms();
        let unsprung: f64 = self
            .axles
            .iter()
            .filter_map(|a| a.axle()?.axle.setup.unsprung_mass)
            .sum();
        if masses == Masses::Whole && mass <= unsprung {
            let message = format!(
                "the mass of the whole car is not above the {} {} of its axles",
                unsprung / unit.kilograms(),
                unit.symbol()
            );
            return self.problems.refuse(place, message);
        }
        Some((masses, mass, self.point(cg)?))
    }

    fn tyres(&mut self, axles: &[Axle; 2]) -> Option<Option<[Tyre; 2]>> {
        let file = self.file;
        let section = file.car.get_ref();
        let names = [("elastic", true), ("rigid", false)];
        let wanted = match &section.tyres {
            Some(text) => Some(choose(text, "kind of tyres", &names, self.problems)?),
            None => None,
        };
        let rates = axles.each_ref().map(|axle| axle.setup.tyre_rate);
        match (wanted, rates) {
            (Some(false), _) | (None, [None, None]) => Some(None),
            (_, [Some(front), Some(rear)]) => {
                let tyre = |end: usize, rate: f64| Tyre {
                    rate,
                    load: axles[end].setup.tyre_load,
                };
                Some(Some([tyre(0, front), tyre(1, rear)]))
            }
            (_, [front, _]) => {
                let place = match front {
                    None => section.front.span(),
                    Some(_) => section.rear.span(),
                };
                let message = "elastic tyres need [tyre] rate in both axle studies";
                let error = self.problems.add(place, message);
                error.help("tyres = \"rigid\" in [car] leaves tyre rates out");
                None
            }
        }
    }

    fn air(&mut self, points: [Option<Vector3<f64>>; 2]) -> Option<Option<Air>> {
        let file = self.file;
        let Some(section) = &file.car.get_ref().aero else {
            return Some(None);
        };
        let written = section.get_ref();
        let density = match &written.density {
            Some(density) => above_zero(density, self.problems)?,
            None => 1.225,
        };
        let mut downforce = [None; 2];
        for (end, force) in [&written.front, &written.rear].into_iter().enumerate() {
            let Some(force) = force else { continue };
            let list = &force.get_ref().downforce;
            let count = list.get_ref().len();
            if !(1..=6).contains(&count) {
                let message =
                    format!("expected 1 to 6 factors of 1, hf, hr, hf2, hf hr, hr2, found {count}");
                return self.problems.refuse(list.span(), message);
            }
            if count > 1 && points.iter().any(Option::is_none) {
                let message = "factors of ride heights need ride_height_point_front and ride_height_point_rear in [car]";
                return self.problems.refuse(list.span(), message);
            }
            let mut area = [0.0; 6];
            for (factor, number) in area.iter_mut().zip(list.get_ref()) {
                *factor = number.value;
            }
            let point = self.point(&force.get_ref().point)?;
            downforce[end] = Some(AirForce { point, area });
        }
        let drag = match &written.drag {
            Some(drag) => Some(AirForce {
                point: self.point(&drag.get_ref().point)?,
                area: [drag.get_ref().drag_area.value, 0.0, 0.0, 0.0, 0.0, 0.0],
            }),
            None => None,
        };
        Some(Some(Air {
            density,
            downforce,
            drag,
        }))
    }

    fn cases(&mut self, car: &Car) -> Option<Vec<Case>> {
        let mut rest = Case::at_rest("static");
        rest.setting.elastic_tyres = car.tyres.is_some();
        let mut cases = vec![rest];
        let mut sound = true;
        for written in &self.file.cases {
            match self.case(car, written.get_ref()) {
                Some(case) if cases.iter().any(|known| known.name == case.name) => {
                    let place = written.get_ref().name.span();
                    let message = format!("{:?} is the name of another case", case.name);
                    self.problems.add(place, message);
                    sound = false;
                }
                Some(case) => cases.push(case),
                None => sound = false,
            }
        }
        sound.then_some(cases)
    }

    fn case(&mut self, car: &Car, written: &car_file::Case) -> Option<Case> {
        let name = written.name.get_ref();
        let plain = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_';
        if name.is_empty() || !name.chars().all(plain) || RESERVED.contains(&name.as_str()) {
            let message = format!(
                "expected a name of lower-case letters, digits and _, other than front, rear, left, right and static; found {name:?}"
            );
            return self.problems.refuse(written.name.span(), message);
        }
        let figure = |number: &Option<Number>| number.as_ref().map_or(0.0, |n| n.value);
        let mut case = Case::at_rest(name);
        (case.ax, case.ay) = (figure(&written.ax), figure(&written.ay));
        case.az = figure(&written.az);
        case.speed = figure(&written.speed);
        case.yaw_acceleration = figure(&written.yaw_acceleration);
        if let (Some(number), None) = (&written.yaw_acceleration, car.yaw_inertia) {
            let message = "yaw_acceleration needs yaw_inertia in [car]";
            return self.problems.refuse(number.span.clone(), message);
        }
        let side = self.frame().sign(Axis::Y);
        case.racks = [
            side * figure(&written.rack),
            side * figure(&written.rack_rear),
        ];
        if let Some(angle) = &written.steering_wheel_angle {
            if let Some(rack) = &written.rack {
                let message = "steering_wheel_angle already gives the rack";
                return self.problems.refuse(rack.span.clone(), message);
            }
            let Some(per_turn) = car.axles[0].setup.c_factor else {
                let message =
                    "steering_wheel_angle needs c_factor in [steering] of the front study";
                return self.problems.refuse(angle.span.clone(), message);
            };
            case.racks[0] = per_turn * angle.value / 360.0;
        }
        let setting = &mut case.setting;
        let kinds = [
            ("brake", Longitudinal::Brake),
            ("drive", Longitudinal::Drive),
        ];
        let default = match case.ax < 0.0 {
            true => Longitudinal::Brake,
            false => Longitudinal::Drive,
        };
        setting.longitudinal = choose_or(
            &written.longitudinal,
            default,
            "longitudinal force",
            &kinds,
            self.problems,
        )?;
        setting.lateral_shares = lateral_shares(
            &written.lateral_shares,
            LateralShares::ByLoad,
            self.problems,
        )?;
        if let Some(list) = &written.lateral_share_left {
            let shares: Vec<f64> = list.get_ref().iter().map(|n| n.value).collect();
            setting.lateral_shares = match (shares.as_slice(), &written.lateral_shares) {
                ([front, rear], None) => LateralShares::Left([*front, *rear]),
                _ => {
                    let message = "expected two shares [front, rear] of the left wheels, without lateral_shares";
                    return self.problems.refuse(list.span(), message);
                }
            };
        }
        let equal = LongitudinalShares::Equal;
        setting.longitudinal_shares =
            longitudinal_shares(&written.longitudinal_shares, equal, self.problems)?;
        let axes = [("wheel", TyreAxes::Wheel), ("road", TyreAxes::Road)];
        setting.tyre_axes = choose_or(
            &written.tyre_axes,
            TyreAxes::Wheel,
            "tyre axes",
            &axes,
            self.problems,
        )?;
        let tyres = [("elastic", true), ("rigid", false)];
        let default = car.tyres.is_some();
        setting.elastic_tyres = choose_or(
            &written.tyres,
            default,
            "kind of tyres",
            &tyres,
            self.problems,
        )?;
        if let (Some(text), true, None) = (&written.tyres, setting.elastic_tyres, car.tyres) {
            let message = "elastic tyres need [tyre] rate in both axle studies";
            return self.problems.refuse(text.span(), message);
        }
        let place = written.name.span();
        self.share_is_given(car, case.setting.longitudinal, place)?;
        Some(case)
    }

    /// Refuses a case whose longitudinal forces have no share. A car at rest needs none.
    fn share_is_given(
        &mut self,
        car: &Car,
        longitudinal: Longitudinal,
        place: std::ops::Range<usize>,
    ) -> Option<()> {
        let (share, key) = match longitudinal {
            Longitudinal::Brake => (car.brake_share_front, "brake_share_front"),
            Longitudinal::Drive => (car.drive_share_front, "drive_share_front"),
        };
        match share {
            Some(_) => Some(()),
            None => {
                let message = format!("this case needs {key} in [car]");
                let error = self.problems.add(place, message);
                error.help(
                    "drag and the drag of steered tyres take longitudinal force also at ax = 0",
                );
                None
            }
        }
    }

    fn gg_map(&mut self, car: &Car) -> Option<Option<GgMap>> {
        let file = self.file;
        let Some(section) = &file.gg_map else {
            return Some(None);
        };
        let written = section.get_ref();
        let (ax, ay) = (&written.ax, &written.ay);
        let count = [ax, ay].map(|range| *range.get_ref().steps.get_ref());
        for (range, steps) in [ax, ay].into_iter().zip(count) {
            if !(1..=MOST_STATES).contains(&steps) {
                let message = format!("expected 1 to {MOST_STATES} steps, found {steps}");
                return self.problems.refuse(range.get_ref().steps.span(), message);
            }
        }
        if count[0] * count[1] > MOST_STATES {
            let message = format!(
                "at most {MOST_STATES} states, found {}",
                count[0] * count[1]
            );
            return self.problems.refuse(section.span(), message);
        }
        let mut case = Case::at_rest("gg");
        let figure = |number: &Option<Number>| number.as_ref().map_or(0.0, |n| n.value);
        (case.az, case.speed) = (figure(&written.az), figure(&written.speed));
        case.racks[0] = self.frame().sign(Axis::Y) * figure(&written.rack);
        case.setting.elastic_tyres = car.tyres.is_some();
        case.setting.lateral_shares = lateral_shares(
            &written.lateral_shares,
            LateralShares::ByLoad,
            self.problems,
        )?;
        let by_load = LongitudinalShares::ByLoad;
        case.setting.longitudinal_shares =
            longitudinal_shares(&written.longitudinal_shares, by_load, self.problems)?;
        let values = |range: &car_file::Steps, steps: i64| -> Vec<f64> {
            let (from, to) = (range.from.value, range.to.value);
            let last = (steps - 1).max(1) as f64;
            (0..steps)
                .map(|k| from + (to - from) * k as f64 / last)
                .collect()
        };
        let (ax, ay) = (
            values(ax.get_ref(), count[0]),
            values(ay.get_ref(), count[1]),
        );
        let place = section.span();
        if ax.iter().any(|ax| *ax < 0.0) {
            self.share_is_given(car, Longitudinal::Brake, place.clone())?;
        }
        if ax.iter().any(|ax| *ax >= 0.0) {
            self.share_is_given(car, Longitudinal::Drive, place)?;
        }
        Some(Some(GgMap { ax, ay, case }))
    }
}

/// A text with edits `path=value`, as `--set` makes them; as it is if one of them does not fit.
pub fn edited(text: &str, edits: &[String]) -> String {
    overrides::apply("study", text, edits).unwrap_or_else(|_| text.to_owned())
}

fn lateral_shares(
    text: &Option<Text>,
    default: LateralShares,
    problems: &mut Problems,
) -> Option<LateralShares> {
    let names = [
        ("by_load", LateralShares::ByLoad),
        ("equal", LateralShares::Equal),
    ];
    choose_or(text, default, "shares", &names, problems)
}

fn longitudinal_shares(
    text: &Option<Text>,
    default: LongitudinalShares,
    problems: &mut Problems,
) -> Option<LongitudinalShares> {
    let names = [
        ("by_load", LongitudinalShares::ByLoad),
        ("equal", LongitudinalShares::Equal),
    ];
    choose_or(text, default, "shares", &names, problems)
}
