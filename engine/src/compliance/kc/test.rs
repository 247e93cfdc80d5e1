//! Tests of a rig: loaded or moved quantities, and their ranges.

use crate::compliance::{Change, HeldQuantity, WheelLoads};
use crate::model::{LengthUnit, TorquePath, VehicleFigures};

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

/// Place where a test load acts.
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
    /// Quantity that stays fixed while the load changes.
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

    /// The unit load of a test, and where it acts.
    pub(super) fn unit_load(&self, vehicle: &VehicleFigures) -> (WheelLoads, TestPlace) {
        let mut load = WheelLoads::none(0.0);
        let place = match self.load {
            TestLoad::Heave | TestLoad::Steering => TestPlace::Nowhere,
            TestLoad::Lateral => {
                (load.side, load.trail) = (1.0, self.trail);
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

    /// The input that the test changes, per unit.
    pub(super) fn change(&self, vehicle: &VehicleFigures) -> Change {
        match self.load {
            TestLoad::Heave => Change::Travel,
            TestLoad::Steering => Change::Rack,
            _ => Change::Load(self.unit_load(vehicle).0),
        }
    }
}
