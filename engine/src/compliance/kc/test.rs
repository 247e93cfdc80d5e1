//! Tests of a rig: loaded or moved quantities, and their ranges.

use crate::compliance::{Change, HeldQuantity, WheelLoads};
use crate::model::{LengthUnit, Side, TorquePath, VehicleFigures};

/// Load or motion of a test.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TestLoad {
    /// Wheel travel.
    Heave,
    /// Equal opposite travels of both wheels.
    Roll,
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
    pub const ALL: [(&'static str, TestLoad); 8] = [
        ("heave", TestLoad::Heave),
        ("roll", TestLoad::Roll),
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
        matches!(self, TestLoad::Heave | TestLoad::Roll | TestLoad::Steering)
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

/// Wheels that a load acts on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TestMode {
    /// The only one.
    OneWheel,
    /// Both, in the same direction of the vehicle.
    Parallel,
    /// Both, mirrored or in opposite directions.
    Opposed,
    /// One of both.
    Single(Side),
}

impl TestMode {
    /// Name in results.
    pub fn name(self) -> &'static str {
        match self {
            TestMode::OneWheel => "",
            TestMode::Parallel => "parallel",
            TestMode::Opposed => "opposed",
            TestMode::Single(_) => "single",
        }
    }
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
    /// Wheels that it loads.
    pub mode: TestMode,
    /// True if the anti-roll bar acts between the wheels.
    pub has_bar: bool,
    /// True if the rack is held in its housing, false if the steering wheel holds it.
    pub locks_rack: bool,
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
            mode: TestMode::OneWheel,
            has_bar: false,
            locks_rack: false,
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

    /// The tests of an axle that names none: motions, and loads on both wheels, parallel and opposed.
    pub fn defaults_of_axle(
        is_rigid: bool,
        has_spring: bool,
        steers: bool,
        length: LengthUnit,
    ) -> Vec<KcTest> {
        let mut tests = Vec::new();
        for test in KcTest::defaults(is_rigid, has_spring, length) {
            if test.load == TestLoad::Steering && !steers {
                continue;
            }
            let modes: &[TestMode] = match test.load.is_motion() {
                true => &[TestMode::Parallel],
                false => &[TestMode::Parallel, TestMode::Opposed],
            };
            let in_mode = |mode: &TestMode| KcTest {
                mode: *mode,
                has_bar: true,
                ..test
            };
            tests.extend(modes.iter().map(in_mode));
            if test.load == TestLoad::Heave {
                tests.push(KcTest {
                    load: TestLoad::Roll,
                    ..in_mode(&TestMode::Parallel)
                });
            }
        }
        tests
    }

    /// Conditions of an axle: bar connected, rack locked.
    pub(crate) fn conditions(&self) -> (bool, bool) {
        (self.has_bar, self.locks_rack)
    }

    /// Multiples of the unit load on left and right wheel, each in the frame of its side.
    pub(super) fn factors(&self) -> [f64; 2] {
        let is_lateral = matches!(self.load, TestLoad::Lateral | TestLoad::Aligning);
        match self.mode {
            TestMode::OneWheel | TestMode::Single(Side::Left) => [1.0, 0.0],
            TestMode::Single(Side::Right) => [0.0, 1.0],
            // The mirror image of a load to the left is one to the right.
            TestMode::Parallel => [1.0, if is_lateral { -1.0 } else { 1.0 }],
            TestMode::Opposed => [1.0, if is_lateral { 1.0 } else { -1.0 }],
        }
    }

    /// The unit load of a test, and where it acts.
    pub(super) fn unit_load(&self, vehicle: &VehicleFigures) -> (WheelLoads, TestPlace) {
        let mut load = WheelLoads::none(0.0);
        let place = match self.load {
            TestLoad::Heave | TestLoad::Roll | TestLoad::Steering => TestPlace::Nowhere,
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
            // One wheel has no roll: studies refuse it.
            TestLoad::Heave | TestLoad::Roll => Change::Travel,
            TestLoad::Steering => Change::Rack,
            _ => Change::Load(self.unit_load(vehicle).0),
        }
    }
}
