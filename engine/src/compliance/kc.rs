//! Tests of a kinematics and compliance rig on one wheel.
//!
//! At a station (travel, rack) the wheel stands in equilibrium without horizontal loads, its height held. About this
//! state a test changes a load, or travel or rack, and figures are the derivatives by it. Windows give secants, levels
//! the equilibria between their ends. All figures are those of a left wheel in ISO 8855 axes, in the units of
//! [`KcUnit`].

use super::definition::Compliance;
use super::loads::WheelLoads;
use super::reading::WheelFigures;
use super::wheel::{
    BushingReading, Change, ElasticFault, ElasticWheel, Equilibrium, HeldQuantity, NoEquilibrium,
    SpringReading,
};
use crate::model::{Axis, LengthUnit, Side, Suspension, TorquePath};
use crate::number::Vector3;

/// A displacement per force below this share of a millimetre per kilonewton has no stiffness as its reciprocal.
const LEAST_COMPLIANCE: f64 = 1e-9;

/// Load or motion of a test.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TestLoad {
    /// Wheel travel.
    Heave,
    /// Displacement of the rack.
    Steering,
    /// Side force towards the inside of the car.
    Lateral,
    /// Rearward force.
    Braking,
    /// Forward force.
    Traction,
    /// Moment about the vertical.
    Aligning,
    /// Upward force.
    Vertical,
}

impl TestLoad {
    /// Every test, with its name in studies.
    pub const ALL: [(&'static str, TestLoad); 7] = [
        ("heave", TestLoad::Heave),
        ("steering", TestLoad::Steering),
        ("lateral", TestLoad::Lateral),
        ("braking", TestLoad::Braking),
        ("traction", TestLoad::Traction),
        ("aligning", TestLoad::Aligning),
        ("vertical", TestLoad::Vertical),
    ];

    /// Name in studies and results.
    pub fn name(self) -> &'static str {
        let found = Self::ALL.iter().find(|(_, load)| *load == self);
        found.map_or("", |(name, _)| name)
    }

    /// Returns true if a motion and no load drives the test.
    pub fn is_motion(self) -> bool {
        matches!(self, TestLoad::Heave | TestLoad::Steering)
    }
}

/// Where a test load acts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TestPlace {
    /// A motion acts nowhere.
    Nowhere,
    /// At the contact point, or behind it by the trail.
    ContactPoint,
    /// At the wheel centre.
    WheelCentre,
    /// A moment.
    Moment,
}

/// One test.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KcTest {
    /// Load or motion.
    pub load: TestLoad,
    /// Distance of the side force behind the contact point.
    pub trail: f64,
    /// What stays while the load changes.
    pub held: HeldQuantity,
    /// Half-width of the range of the load: force, or force times length.
    pub window: f64,
    /// Number of equilibria on either side of the station.
    pub levels: usize,
    /// True for all stations, false for the one nearest to travel 0 and rack 0.
    pub at_all_stations: bool,
}

impl KcTest {
    /// A test with the defaults of studies.
    pub fn new(load: TestLoad, length: LengthUnit) -> Self {
        KcTest {
            load,
            trail: 0.0,
            held: match load {
                TestLoad::Vertical => HeldQuantity::WheelLoad,
                _ => HeldQuantity::WheelHeight,
            },
            window: match load {
                TestLoad::Aligning => 100.0 * length.per_metre(),
                _ => 1000.0,
            },
            levels: if load.is_motion() { 0 } else { 5 },
            at_all_stations: false,
        }
    }

    /// The tests of a study that names none: motions, and loads if parts are elastic. Without elastic parts, the loads
    /// whose jacking the mechanism has.
    pub fn defaults(is_rigid: bool, has_spring: bool, length: LengthUnit) -> Vec<KcTest> {
        let test = |load| KcTest::new(load, length);
        let mut tests = vec![
            test(TestLoad::Heave),
            test(TestLoad::Steering),
            test(TestLoad::Lateral),
        ];
        if is_rigid {
            tests.push(test(TestLoad::Braking));
            tests.iter_mut().for_each(|test| test.levels = 0);
            return tests;
        }
        tests.push(KcTest {
            trail: 0.03 * length.per_metre(),
            ..test(TestLoad::Lateral)
        });
        tests.extend([TestLoad::Aligning, TestLoad::Braking, TestLoad::Traction].map(test));
        tests.extend(has_spring.then(|| test(TestLoad::Vertical)));
        tests
    }
}

/// Unit of a figure.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum KcUnit {
    /// Degrees per kilonewton.
    AnglePerKilonewton,
    /// Length per kilonewton.
    LengthPerKilonewton,
    /// Degrees per 100 N m.
    AnglePerMoment,
    /// Newtons per millimetre.
    Rate,
    /// Degrees per length.
    AnglePerLength,
    /// Newtons.
    Force,
    /// A plain number.
    Ratio,
}

/// A figure of a test.
#[derive(Clone, Debug, PartialEq)]
pub struct KcFigure {
    /// Name.
    pub quantity: &'static str,
    /// Unit of value and secant.
    pub unit: KcUnit,
    /// Derivative at the station; `None` if it has no value.
    pub value: Option<f64>,
    /// Quotient of differences over the window.
    pub secant: Option<f64>,
}

/// An equilibrium under a level of a test load.
#[derive(Clone, Debug, PartialEq)]
pub struct KcState {
    /// Angles and positions.
    pub figures: WheelFigures,
    /// Vertical force at the contact point.
    pub wheel_load: f64,
    /// The spring.
    pub spring: Option<SpringReading>,
    /// The bushings, in the order of the definition.
    pub bushings: Vec<BushingReading>,
    /// Tensions of the links, in the order of the definition.
    pub tensions: Vec<f64>,
}

/// A level of a test.
#[derive(Clone, Debug, PartialEq)]
pub struct KcLevel {
    /// Number of the level, 0 without load.
    pub level: i64,
    /// The load.
    pub load: f64,
    /// The equilibrium, or why there is none.
    pub state: Result<KcState, NoEquilibrium>,
}

/// Outcome of a test at a station.
#[derive(Clone, Debug, PartialEq)]
pub struct KcOutcome {
    /// The test.
    pub test: KcTest,
    /// Where its load acts.
    pub place: TestPlace,
    /// Its figures.
    pub figures: Vec<KcFigure>,
    /// Its levels, from the lowest load to the highest; empty without levels.
    pub levels: Vec<KcLevel>,
}

/// Outcome of a station.
#[derive(Clone, Debug, PartialEq)]
pub struct KcStation {
    /// Wheel travel.
    pub travel: f64,
    /// Rack displacement along the study's +y.
    pub rack: f64,
    /// Tests, or why the station has no equilibrium.
    pub outcomes: Result<Vec<KcOutcome>, NoEquilibrium>,
    /// Tests that belong to a station without equilibrium.
    pub tests: Vec<(KcTest, TestPlace)>,
    /// Displacement and rotation of the wheel centre by forces and moments there, in the study's axes: rows x, y, z,
    /// rotations, columns forces, moments. `None` if the wheel load cannot be held.
    pub matrix: Option<[[f64; 6]; 6]>,
}

/// The tests of a study.
#[derive(Clone, Debug)]
pub struct KcRun<'a> {
    suspension: &'a Suspension,
    wheel: ElasticWheel,
    is_rigid: bool,
    tyre_rate: Option<f64>,
}

impl<'a> KcRun<'a> {
    /// Prepares the tests of a suspension.
    pub fn new(
        suspension: &'a Suspension,
        compliance: &Compliance,
        tyre_rate: Option<f64>,
    ) -> Result<Self, ElasticFault> {
        Ok(KcRun {
            suspension,
            wheel: ElasticWheel::new(suspension, compliance)?,
            is_rigid: compliance.is_rigid(),
            tyre_rate,
        })
    }

    /// The elastic wheel.
    pub fn wheel(&self) -> &ElasticWheel {
        &self.wheel
    }

    /// The tests at every station that has any, in the order of the stations.
    pub fn run(&self, travels: &[f64], racks: &[f64], tests: &[KcTest]) -> Vec<KcStation> {
        let stations = travels
            .iter()
            .flat_map(|travel| racks.iter().map(move |rack| (*travel, *rack)));
        let stations: Vec<(f64, f64)> = stations.collect();
        let distance = |(travel, rack): &(f64, f64)| travel.abs() + rack.abs();
        let nearest = stations
            .iter()
            .enumerate()
            .min_by(|(_, a), (_, b)| distance(a).total_cmp(&distance(b)))
            .map_or(0, |(k, _)| k);
        let mut found = Vec::new();
        for (k, (travel, rack)) in stations.into_iter().enumerate() {
            let here = |test: &&KcTest| test.at_all_stations || k == nearest;
            let here: Vec<KcTest> = tests.iter().filter(here).copied().collect();
            if !here.is_empty() {
                found.push(self.station(travel, rack, &here));
            }
        }
        found
    }

    fn station(&self, travel: f64, rack: f64, tests: &[KcTest]) -> KcStation {
        let along = self.suspension.frame.sign(Axis::Y);
        let at = self.wheel.at(travel, along * rack);
        let matrix = at.as_ref().ok().and_then(|at| self.matrix(at));
        KcStation {
            travel,
            rack,
            tests: tests
                .iter()
                .map(|test| (*test, self.load(test).1))
                .collect(),
            outcomes: at.map(|at| tests.iter().map(|test| self.outcome(&at, test)).collect()),
            matrix,
        }
    }

    /// The unit load of a test, and where it acts.
    fn load(&self, test: &KcTest) -> (WheelLoads, TestPlace) {
        let mut load = WheelLoads::none(0.0);
        let vehicle = &self.suspension.vehicle;
        let place = match test.load {
            TestLoad::Heave | TestLoad::Steering => TestPlace::Nowhere,
            TestLoad::Lateral => {
                (load.side, load.trail) = (1.0, test.trail);
                TestPlace::ContactPoint
            }
            TestLoad::Braking if vehicle.brakes == Some(TorquePath::Shafts) => {
                load.centre.x = -1.0;
                TestPlace::WheelCentre
            }
            TestLoad::Braking => {
                load.contact.x = -1.0;
                TestPlace::ContactPoint
            }
            TestLoad::Traction if vehicle.drive_torque == Some(TorquePath::Carrier) => {
                load.contact.x = 1.0;
                TestPlace::ContactPoint
            }
            TestLoad::Traction => {
                load.centre.x = 1.0;
                TestPlace::WheelCentre
            }
            TestLoad::Aligning => {
                load.moment.z = 1.0;
                TestPlace::Moment
            }
            TestLoad::Vertical => {
                load.contact.z = 1.0;
                TestPlace::ContactPoint
            }
        };
        (load, place)
    }

    fn outcome(&self, at: &Equilibrium, test: &KcTest) -> KcOutcome {
        let (load, place) = self.load(test);
        let change = match test.load {
            TestLoad::Heave => Change::Travel,
            TestLoad::Steering => Change::Rack,
            _ => Change::Load(load),
        };
        let by = self.wheel.figures_by(at, &change, test.held);
        let levels = match test.load.is_motion() || test.levels == 0 {
            true => Vec::new(),
            false => self.levels(at, test, &load),
        };
        let secant = secant(&levels);
        let values = self.figures(at, test, by.as_ref());
        let secants = self.figures(at, test, secant.as_ref());
        let figures = values.into_iter().zip(secants);
        let figures = figures.map(|((quantity, unit, value), (.., secant))| KcFigure {
            quantity,
            unit,
            value: value.filter(|value| value.is_finite()),
            secant: secant.filter(|value| value.is_finite() && !levels.is_empty()),
        });
        KcOutcome {
            test: *test,
            place,
            figures: figures.collect(),
            levels,
        }
    }

    /// The figures of a test from derivatives or secants by one newton, one newton times length, or one length.
    fn figures(
        &self,
        at: &Equilibrium,
        test: &KcTest,
        by: Option<&WheelFigures>,
    ) -> Vec<(&'static str, KcUnit, Option<f64>)> {
        use KcUnit::{
            AnglePerKilonewton, AnglePerLength, AnglePerMoment, Force, LengthPerKilonewton, Rate,
            Ratio,
        };
        let per_metre = self.suspension.length_unit.per_metre();
        let millimetre = per_metre / 1000.0;
        let kilo = |value: f64| value * 1000.0;
        let angle = |f: fn(&WheelFigures) -> f64| by.map(|by| f(by).to_degrees());
        let caster = by
            .and_then(|by| by.steering)
            .map(|[caster, _]| caster.to_degrees());
        let stiffness = |displacement: Option<f64>| {
            let per_millimetre = displacement.map(|d| d / millimetre);
            let stiff = per_millimetre.filter(|d| d.abs() > LEAST_COMPLIANCE / 1000.0);
            stiff.map(|d| 1.0 / d)
        };
        let (toe, camber, spin) = (
            angle(|by| by.toe),
            angle(|by| by.camber),
            angle(|by| by.spin),
        );
        let vertical = by.map(|by| by.vertical);
        let holds_height = test.held == HeldQuantity::WheelHeight;
        let has_axis = self.wheel.figures(at).steering.is_some();
        let mut found = Vec::new();
        let angles = |names: [&'static str; 4]| {
            let values = [toe, camber, caster, spin].map(|value| value.map(kilo));
            let all = names.into_iter().zip(values);
            all.filter(|(name, _)| has_axis || !name.starts_with("caster"))
                .map(|(name, value)| (name, AnglePerKilonewton, value))
                .collect::<Vec<_>>()
        };
        match test.load {
            TestLoad::Heave => {
                found.push(("toe_by_heave", AnglePerLength, toe));
                found.push(("camber_by_heave", AnglePerLength, camber));
                if has_axis {
                    found.push(("caster_by_heave", AnglePerLength, caster));
                }
                found.push(("half_track_by_heave", Ratio, by.map(|by| by.contact.y)));
                found.push(("wheelbase_by_heave", Ratio, by.map(|by| by.contact.x)));
                if self.tyre_rate.is_some() {
                    let rate = self.ride_rate(self.wheel_rate(at));
                    found.push(("compliant_ride_rate", Rate, rate));
                }
            }
            TestLoad::Steering => {
                let along = self.suspension.frame.sign(Axis::Y);
                let side = self.suspension.frame.meaning().1;
                // Toe-in is a turn to the right at a left wheel.
                let to_left = match side {
                    Side::Left => -1.0,
                    Side::Right => 1.0,
                };
                found.push((
                    "steer_by_rack",
                    AnglePerLength,
                    toe.map(|toe| toe * to_left * along),
                ));
                if has_axis {
                    let caster = caster.map(|caster| caster * along);
                    found.push(("caster_by_rack", AnglePerLength, caster));
                }
                // Without a spring nothing loads the rack.
                if self.wheel.spring(at).is_some() {
                    let force = along * self.wheel.rack_force(at);
                    found.push(("rack_force", Force, Some(force)));
                }
            }
            TestLoad::Lateral => {
                let inboard = by.map(|by| -by.centre.y);
                let contact = by.map(|by| -by.contact.y);
                if !self.is_rigid {
                    found.extend(angles([
                        "toe_by_lateral_force",
                        "camber_by_lateral_force",
                        "caster_by_lateral_force",
                        "spin_by_lateral_force",
                    ]));
                    found.push((
                        "wheel_centre_by_lateral_force",
                        LengthPerKilonewton,
                        inboard.map(kilo),
                    ));
                    found.push((
                        "contact_by_lateral_force",
                        LengthPerKilonewton,
                        contact.map(kilo),
                    ));
                    found.push(("lateral_stiffness_wheel_centre", Rate, stiffness(inboard)));
                    found.push(("lateral_stiffness_contact", Rate, stiffness(contact)));
                }
                if holds_height {
                    found.push(("jacking_by_lateral_force", Ratio, vertical));
                }
            }
            TestLoad::Braking | TestLoad::Traction => {
                let is_braking = test.load == TestLoad::Braking;
                let rearward = by.map(|by| -by.centre.x);
                if !self.is_rigid {
                    found.extend(angles(match is_braking {
                        true => [
                            "toe_by_braking",
                            "camber_by_braking",
                            "caster_by_braking",
                            "spin_by_braking",
                        ],
                        false => [
                            "toe_by_traction",
                            "camber_by_traction",
                            "caster_by_traction",
                            "spin_by_traction",
                        ],
                    }));
                    let name = match is_braking {
                        true => "recession_by_braking",
                        false => "recession_by_traction",
                    };
                    found.push((name, LengthPerKilonewton, rearward.map(kilo)));
                    let along = match is_braking {
                        true => rearward,
                        false => rearward.map(|d| -d),
                    };
                    found.push((
                        "longitudinal_stiffness_wheel_centre",
                        Rate,
                        stiffness(along),
                    ));
                }
                if holds_height && is_braking {
                    found.push(("jacking_by_braking", Ratio, vertical));
                }
            }
            TestLoad::Aligning => {
                let moment = 100.0 * per_metre;
                let of = |angle: Option<f64>| angle.map(|angle| angle * moment);
                found.push(("toe_by_aligning_moment", AnglePerMoment, of(toe)));
                found.push(("camber_by_aligning_moment", AnglePerMoment, of(camber)));
            }
            TestLoad::Vertical => {
                let rate = stiffness(by.map(|by| by.contact.z));
                found.push(("compliant_wheel_rate", Rate, rate));
                if self.tyre_rate.is_some() {
                    found.push(("compliant_ride_rate", Rate, self.ride_rate(rate)));
                }
            }
        }
        found
    }

    /// Rate of the wheel at the contact point, in N/mm: wheel load by height of the contact point.
    fn wheel_rate(&self, at: &Equilibrium) -> Option<f64> {
        let mut load = WheelLoads::none(0.0);
        load.contact.z = 1.0;
        let by = self
            .wheel
            .figures_by(at, &Change::Load(load), HeldQuantity::WheelLoad)?;
        let millimetre = self.suspension.length_unit.per_metre() / 1000.0;
        Some(millimetre / by.contact.z)
    }

    /// The wheel's rate with the tyre's in series, both in N/mm.
    fn ride_rate(&self, rate: Option<f64>) -> Option<f64> {
        let millimetre = self.suspension.length_unit.per_metre() / 1000.0;
        let tyre = self.tyre_rate? * millimetre;
        let rate = rate?;
        Some(rate * tyre / (rate + tyre))
    }

    /// Equilibria from the lowest load to the highest. Each starts from its neighbour nearer to no load.
    fn levels(&self, at: &Equilibrium, test: &KcTest, load: &WheelLoads) -> Vec<KcLevel> {
        let count = test.levels as i64;
        let level_load = |level: i64| test.window * level as f64 / count as f64;
        let mut sides = [Vec::new(), Vec::new()];
        for (sign, side) in [-1, 1].into_iter().zip(&mut sides) {
            let mut before = Ok(*at);
            // Levels that are reached, with the share of the next one.
            let mut reached = 0.0;
            for step in 1..=count {
                let level = sign * step;
                let mut loads = WheelLoads::none(0.0).plus(load, level_load(level));
                loads.trail = load.trail;
                before = match before {
                    Ok(from) => {
                        let next = self.wheel.loaded_about(at, &from, &loads, test.held);
                        reached += next.as_ref().map_or_else(|why| why.share, |_| 1.0);
                        next
                    }
                    failed => failed,
                };
                if let Err(why) = &mut before {
                    why.share = reached / step as f64;
                }
                side.push(self.level(level, level_load(level), &before));
            }
        }
        let [mut low, high] = sides;
        low.reverse();
        low.push(self.level(0, 0.0, &Ok(*at)));
        low.extend(high);
        low
    }

    fn level(&self, level: i64, load: f64, at: &Result<Equilibrium, NoEquilibrium>) -> KcLevel {
        let state = at.as_ref().map_err(Clone::clone).map(|at| KcState {
            figures: self.wheel.figures(at),
            wheel_load: self.wheel.wheel_load(at),
            spring: self.wheel.spring(at),
            bushings: self.wheel.bushings(at),
            tensions: self.wheel.tensions(at),
        });
        KcLevel { level, load, state }
    }

    /// The matrix of the wheel centre, in the study's axes.
    fn matrix(&self, at: &Equilibrium) -> Option<[[f64; 6]; 6]> {
        let frame = self.suspension.frame;
        let signs: [f64; 6] = std::array::from_fn(|k| {
            let axis = Axis::ALL[k % 3];
            if k < 3 {
                frame.sign(axis)
            } else {
                frame.turn_sign(axis)
            }
        });
        let mut matrix = [[0.0; 6]; 6];
        for column in 0..6 {
            let mut unit = Vector3::new(0.0, 0.0, 0.0);
            unit[Axis::ALL[column % 3]] = 1.0;
            let mut load = WheelLoads::none(0.0);
            if column < 3 {
                load.centre = unit;
            } else {
                load.moment = unit;
            }
            let [shift, turn] = self.wheel.twist_by(at, &load, HeldQuantity::WheelLoad)?;
            let twist = shift.to_array().into_iter().chain(turn.to_array());
            for (row, value) in twist.enumerate() {
                let value = value * signs[row] * signs[column];
                matrix[row][column] = value.is_finite().then_some(value)?;
            }
        }
        Some(matrix)
    }
}

/// Quotients of differences between the ends of the window; `None` if an end has no equilibrium.
fn secant(levels: &[KcLevel]) -> Option<WheelFigures> {
    let (low, high) = (levels.first()?, levels.last()?);
    let (a, b) = (low.state.as_ref().ok()?, high.state.as_ref().ok()?);
    let inverse = 1.0 / (high.load - low.load);
    let of = |f: fn(&WheelFigures) -> f64| (f(&b.figures) - f(&a.figures)) * inverse;
    let between = |p: Vector3<f64>, q: Vector3<f64>| (q - p) * inverse;
    let steering = match (a.figures.steering, b.figures.steering) {
        (Some(a), Some(b)) => Some([0, 1].map(|k| (b[k] - a[k]) * inverse)),
        _ => None,
    };
    Some(WheelFigures {
        toe: of(|f| f.toe),
        camber: of(|f| f.camber),
        steering,
        spin: of(|f| f.spin),
        centre: between(a.figures.centre, b.figures.centre),
        contact: between(a.figures.contact, b.figures.contact),
        vertical: (b.wheel_load - a.wheel_load) * inverse,
    })
}
