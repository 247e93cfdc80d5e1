//! Rig tests: loads or motions, with their ranges.

use crate::ask::six_digits;
use crate::compliance::{Change, HeldQuantity, WheelLoads};
use crate::model::{LengthUnit, Side, TorquePath, VehicleFigures};
use crate::number::Each;

/// Load or motion that a test applies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TestLoad {
    /// Wheel travel.
    Heave,
    /// Equal and opposite travels of both wheels.
    Roll,
    /// Displacement of the rack.
    Steering,
    /// Side force to the inside of the car.
    Lateral,
    /// Rearward force on the wheel.
    Braking,
    /// Forward force on the wheel.
    Traction,
    /// Moment about the vertical axis, on the wheel.
    Aligning,
    /// Upward force on the wheel.
    Vertical,
}

impl TestLoad {
    /// All loads and motions of tests, with their names in studies.
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

    /// Returns true if the test changes a motion instead of a load.
    pub fn is_motion(self) -> bool {
        matches!(self, TestLoad::Heave | TestLoad::Roll | TestLoad::Steering)
    }
}

/// Point where a test load acts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TestPlace {
    /// No point, because the test is a motion.
    Nowhere,
    /// Contact point, or a point behind it at the distance of the trail.
    ContactPoint,
    /// Wheel centre.
    WheelCentre,
    /// No point, because the load is a moment.
    Moment,
}

/// Wheels on which a load acts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TestMode {
    /// Single wheel of a study.
    OneWheel,
    /// Both wheels, in the same direction of the vehicle.
    Parallel,
    /// Both wheels, in opposite directions of the vehicle.
    Opposed,
    /// One wheel of an axle.
    Single(Side),
}

impl TestMode {
    /// Name of the mode in results.
    pub fn name(self) -> &'static str {
        match self {
            TestMode::OneWheel => "",
            TestMode::Parallel => "parallel",
            TestMode::Opposed => "opposed",
            TestMode::Single(_) => "single",
        }
    }
}

/// Trail of the second default lateral test, mm.
const DEFAULT_TRAIL: f64 = 30.0;

/// One rig test: its load or motion, and its conditions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KcTest {
    /// Load or motion that the test applies.
    pub load: TestLoad,
    /// Trail: distance from the contact point back to the point where the side force acts.
    pub trail: f64,
    /// Quantity that stays fixed while the load changes.
    pub held: HeldQuantity,
    /// Half the width of the load range (window): force, or force times length.
    pub window: f64,
    /// Number of load levels on each side of zero load. Each level is an equilibrium.
    pub levels: usize,
    /// True if the test runs at all stations; false if it runs only at the station nearest to travel 0 and rack 0.
    pub at_all_stations: bool,
    /// Wheels on which the load acts.
    pub mode: TestMode,
    /// True if the anti-roll bar is connected to the wheels.
    pub has_bar: bool,
    /// True if the rack is locked in its housing; false if the steering wheel is held.
    pub locks_rack: bool,
}

impl KcTest {
    /// Returns true if the test has levels (several load values from the largest negative to the largest positive load). Tests of
    /// motions have no levels.
    pub(super) fn has_levels(&self) -> bool {
        !self.load.is_motion() && self.levels > 0
    }

    /// Returns the suffix of result names for the trail, such as `_trail_30`; empty without a trail. The number is
    /// rounded to six digits, so unit conversions do not change the suffix.
    pub fn trail_suffix(&self) -> String {
        match self.trail {
            0.0 => String::new(),
            trail => format!("_trail_{}", six_digits(trail)),
        }
    }

    /// Makes a test with the default values of a study.
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

    /// Returns the default tests of a study: motions and loads. If no part is elastic, the only loads are the loads that
    /// cause jacking, without levels.
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
            trail: length.convert(DEFAULT_TRAIL, LengthUnit::Millimetre),
            ..test(TestLoad::Lateral)
        });
        tests.extend([TestLoad::Aligning, TestLoad::Braking, TestLoad::Traction].each(test));
        tests.extend(has_spring.then(|| test(TestLoad::Vertical)));
        tests
    }

    /// Default tests of an axle: motions, and loads on both wheels, parallel and opposed. The motions are heave, roll and, if
    /// the axle steers, steering.
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
            let modes: &[TestMode] = if test.load.is_motion() {
                &[TestMode::Parallel]
            } else {
                &[TestMode::Parallel, TestMode::Opposed]
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

    /// Returns the conditions of the test on an axle. The first field is true if the anti-roll bar is connected. The
    /// second field is true if the rack is locked.
    pub fn conditions(&self) -> (bool, bool) {
        (self.has_bar, self.locks_rack)
    }

    /// Returns the factors on the unit load for the left and the right wheel, each in the frame of its side.
    pub(super) fn factors(&self) -> [f64; 2] {
        let is_lateral = matches!(self.load, TestLoad::Lateral | TestLoad::Aligning);
        match self.mode {
            TestMode::OneWheel | TestMode::Single(Side::Left) => [1.0, 0.0],
            TestMode::Single(Side::Right) => [0.0, 1.0],
            // The mirror image of a load to the left is a load to the right.
            TestMode::Parallel => [1.0, if is_lateral { -1.0 } else { 1.0 }],
            TestMode::Opposed => [1.0, if is_lateral { 1.0 } else { -1.0 }],
        }
    }

    /// Unit load of a test, and the point where it acts.
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

    /// Returns the input of the equilibrium that the test changes by one unit.
    pub(super) fn change(&self, vehicle: &VehicleFigures) -> Change {
        match self.load {
            // A study with a single wheel cannot have a roll test.
            TestLoad::Heave | TestLoad::Roll => Change::Travel,
            TestLoad::Steering => Change::Rack,
            _ => Change::Load(self.unit_load(vehicle).0),
        }
    }
}
