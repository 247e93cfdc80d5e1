//! Motion of an axle, and the stations of this motion: all combinations of the given values, or the rows of a table.

use super::solver::Placement;
use super::{Axle, AxlePlan, Coordinate, Motion};
use crate::curves::thinned::{chosen, picked};
use crate::study::{AxleStudy, TimeLaw};

/// Rule that combines the values of the coordinates into stations.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Combine {
    /// All combinations of the values.
    #[default]
    All,
    /// Rows of a table: station n has value n of every coordinate, for each n. All lists of values have the same
    /// length.
    Rows,
}

/// Motion of an axle. Lengths are in the study's unit, angles in radians. The rack displacement is positive towards the
/// outside of the left wheel.
#[derive(Clone, Debug, PartialEq)]
pub struct AxleMotion {
    /// Motion of the wheels.
    pub wheels: WheelMotion,
    /// Displacements of the rack.
    pub racks: Vec<f64>,
    /// Rule that combines the values of the coordinates into stations.
    pub combine: Combine,
    /// True if results have a column for the rack.
    pub shows_rack: bool,
    /// Angle of the steering wheel for each displacement of the rack. `None` if the study gives no angles.
    pub steering_wheel: Option<Vec<f64>>,
    /// Law of one coordinate over time, if the study gives such a law. Results are then functions of time.
    pub time: Option<AxleTime>,
}

/// Coordinate that is a function of time. The motion contains the values of this function at the given times.
#[derive(Clone, Debug, PartialEq)]
pub struct AxleTime {
    /// Coordinate that moves. For the steering wheel, the law gives the displacement of the rack.
    pub coordinate: Coordinate,
    /// Function of time, in the units of the motion.
    pub law: TimeLaw,
}

/// Motion of the wheels of an axle.
#[derive(Clone, Debug, PartialEq)]
pub enum WheelMotion {
    /// Equal travels on level pads.
    Heave(Vec<f64>),
    /// Roll on a plane ground: all combinations of heave values and roll angles.
    Roll {
        /// Mean travels of the wheel centres.
        heave: Vec<f64>,
        /// Roll angles of the body.
        roll: Vec<f64>,
        /// True if roll does not change the sum of the wheel loads. This sum is then the sum without roll at this
        /// heave, and the program computes the mean travel from it.
        at_load: bool,
    },
    /// Travels of both wheels, in all combinations.
    Travels {
        /// Travels of the left wheel.
        left: Vec<f64>,
        /// Travels of the right wheel.
        right: Vec<f64>,
        /// True if both wheels stand on one plane, false if each stands on a level pad.
        on_plane: bool,
    },
}

impl AxleMotion {
    /// Returns true if the wheels are on level pads at given heights, and the motion is not a function of time.
    pub fn is_on_level_pads(&self) -> bool {
        let placements = self.placements();
        self.time.is_none() && placements.iter().all(|p| p.on_level_pads().is_some())
    }

    /// Returns true if results have a column for the roll angle.
    pub fn shows_roll(&self) -> bool {
        !matches!(
            self.wheels,
            WheelMotion::Heave(_)
                | WheelMotion::Travels {
                    on_plane: false,
                    ..
                }
        )
    }

    /// Returns true if results have a column for heave.
    pub fn shows_heave(&self) -> bool {
        !matches!(self.wheels, WheelMotion::Travels { .. })
    }

    /// Returns true if the stations are rows of a table: station n has value n of every coordinate, for each n. False
    /// if the stations are all combinations of the values.
    pub fn has_rows(&self) -> bool {
        self.combine == Combine::Rows
    }

    /// Returns a motion with a single station: the row with this index.
    pub fn row(&self, row: usize) -> AxleMotion {
        let mut one = AxleMotion {
            combine: Combine::All,
            ..self.clone()
        };
        for coordinate in Coordinate::ALL {
            if coordinate != Coordinate::SteeringWheel
                && let Some(values) = one.along(coordinate)
            {
                *values = vec![values[row]];
            }
        }
        if let Some(angles) = &mut one.steering_wheel {
            *angles = vec![angles[row]];
        }
        one
    }

    /// Returns the motion with at most `most` stations, evenly chosen from each list of values. `most` must be at least 8, so that
    /// each list keeps its ends. A motion over time stays as it is, because each station has its own time.
    pub fn thinned(&self, most: usize) -> AxleMotion {
        let mut thinned = self.clone();
        if self.time.is_some() || self.stations() <= most {
            return thinned;
        }
        let mut lists = match &mut thinned.wheels {
            WheelMotion::Heave(values) => vec![values],
            WheelMotion::Roll { heave, roll, .. } => vec![heave, roll],
            WheelMotion::Travels { left, right, .. } => vec![left, right],
        };
        lists.push(&mut thinned.racks);
        // In a table of rows, every list keeps the same rows.
        let rows = self.has_rows().then(|| chosen(&self.racks, most));
        // The longest lists are shortened most.
        lists.sort_by_key(|list| list.len());
        let mut share = most;
        for (rest, list) in (1..=lists.len()).rev().zip(lists) {
            let own = (share as f64).powf(1.0 / rest as f64) as usize;
            let kept = rows.clone().unwrap_or_else(|| chosen(list, own));
            *list = picked(list, &kept);
            share /= list.len();
        }
        if let Some(angles) = &mut thinned.steering_wheel {
            *angles = picked(angles, &chosen(&self.racks, thinned.racks.len()));
        }
        thinned
    }

    /// Returns the travels of the left and of the right wheel. `None` in roll, because the travels then depend on the
    /// design.
    pub fn wheel_travels(&self) -> Option<[&[f64]; 2]> {
        match &self.wheels {
            WheelMotion::Heave(values) => Some([values, values]),
            WheelMotion::Travels { left, right, .. } => Some([left, right]),
            WheelMotion::Roll { .. } => None,
        }
    }

    /// Number of stations.
    pub fn stations(&self) -> usize {
        if self.has_rows() {
            return self.racks.len();
        }
        let wheels = match &self.wheels {
            WheelMotion::Heave(values) => values.len(),
            WheelMotion::Roll { heave, roll, .. } => heave.len().saturating_mul(roll.len()),
            WheelMotion::Travels { left, right, .. } => left.len().saturating_mul(right.len()),
        };
        wheels.saturating_mul(self.racks.len())
    }

    /// Returns the placements of all stations. Rows of a table have the order of the study. Combinations of values are
    /// ordered by rack, then heave, then roll angle: the roll angle changes fastest. If both travels are given, the
    /// right travel changes fastest.
    pub fn placements(&self) -> Vec<Placement> {
        if self.has_rows() {
            let rows = 0..self.stations();
            return rows.flat_map(|row| self.row(row).placements()).collect();
        }
        let mut placements = Vec::with_capacity(self.stations());
        for rack in self.racks.iter().copied() {
            let travels = |travels: [f64; 2], on_plane: bool| Placement::Travels {
                travels,
                rack,
                on_plane,
            };
            match &self.wheels {
                WheelMotion::Heave(values) => {
                    placements.extend(values.iter().map(|z| travels([*z; 2], false)));
                }
                WheelMotion::Roll {
                    heave,
                    roll,
                    at_load,
                } => {
                    for heave in heave.iter().copied() {
                        let at = |roll: &f64| {
                            let roll = *roll;
                            match at_load {
                                true => Placement::AtLoad { heave, roll, rack },
                                false => Placement::Roll { heave, roll, rack },
                            }
                        };
                        placements.extend(roll.iter().map(at));
                    }
                }
                WheelMotion::Travels {
                    left,
                    right,
                    on_plane,
                } => {
                    for l in left {
                        placements.extend(right.iter().map(|r| travels([*l, *r], *on_plane)));
                    }
                }
            }
        }
        placements
    }

    /// Returns a motion with only the design position: all coordinates are zero. The wheels are on a plane or on level
    /// pads, as in this motion.
    pub fn at_design(&self) -> AxleMotion {
        let zero = || vec![0.0];
        AxleMotion {
            wheels: match self.wheels {
                WheelMotion::Heave(_) => WheelMotion::Heave(zero()),
                WheelMotion::Roll { .. } => WheelMotion::Roll {
                    heave: zero(),
                    roll: zero(),
                    at_load: false,
                },
                WheelMotion::Travels { on_plane, .. } => WheelMotion::Travels {
                    left: zero(),
                    right: zero(),
                    on_plane,
                },
            },
            racks: zero(),
            combine: Combine::All,
            shows_rack: self.shows_rack,
            steering_wheel: None,
            time: None,
        }
    }

    /// Index of the station's time in the list of times. The result is 0 if the motion is not a function of time.
    pub(super) fn time_at(&self, station: usize) -> usize {
        let Some(time) = &self.time else { return 0 };
        // Number of neighbouring stations with the same value of the coordinate that is a function of time.
        let repeated = match (time.coordinate, &self.wheels) {
            (Coordinate::Rack | Coordinate::SteeringWheel, _) => self.stations() / self.racks.len(),
            (Coordinate::Heave, WheelMotion::Roll { roll, .. }) => roll.len(),
            (Coordinate::TravelLeft, WheelMotion::Travels { right, .. }) => right.len(),
            _ => 1,
        };
        station / repeated % time.law.times.len()
    }

    /// Returns the angle of the steering wheel at the station with this index.
    pub fn steering_wheel_at(&self, station: usize) -> Option<f64> {
        // Number of stations at each rack displacement: 1 if the stations are rows of a table.
        let per_rack = self.stations() / self.racks.len();
        Some(self.steering_wheel.as_ref()?[station / per_rack])
    }

    /// Checks that the axle `other` with the plan `plan` can have this motion. The conditions are the same as for a motion
    /// in the axle's own study. The error is a sentence with the reason.
    fn check_for(&self, other: &Axle, plan: &AxlePlan) -> Result<(), String> {
        let by_time = self.time.as_ref().map(|time| time.coordinate.motion());
        let at_load = matches!(self.wheels, WheelMotion::Roll { at_load: true, .. });
        let why = if self.shows_roll() && other.setup.wheel_radius.is_none() {
            "a plane ground needs radius in [wheel], which this study does not give"
        } else if at_load && !other.setup.is_sprung() {
            "roll at a load needs [spring], which this study does not give"
        } else if at_load && plan.derivatives > 0 {
            "the first study has hold = \"wheel_load\", which does not work with derivatives; expected order = \"position\" in this \
             study, or hold = \"mean_travel\" in the first study"
        } else if at_load && plan.certify {
            "the first study has hold = \"wheel_load\", which does not work with certify; expected no certify in this study, or \
             hold = \"mean_travel\" in the first study"
        } else if by_time == Some(Motion::Rack) && !other.has_steering_gear() {
            "the rack of the first study is a function of time, and this axle has no rack and no drag link; expected another \
             \"drive\" in [motion] of the first study"
        } else if other.elastic.is_some() && !self.is_on_level_pads() {
            "axles with [compliance] are solved on level pads: the first study needs heave, or travel_left and travel_right, in \
             [motion]"
        } else {
            return Ok(());
        };
        Err(why.to_owned())
    }

    /// Converts this motion of the axle `own` to a motion of the study `other`, with the length unit and the steering ratio
    /// of `other`.
    ///
    /// # Errors
    ///
    /// The error is a sentence. It states why the other study cannot have the motion.
    pub fn for_study(&self, own: &Axle, other: &AxleStudy) -> Result<AxleMotion, String> {
        let AxleStudy {
            axle: other, plan, ..
        } = other;
        self.check_for(other, plan)?;
        let mut motion = self.clone();
        let ratio = other.left.length_unit.per_metre() / own.left.length_unit.per_metre();
        for coordinate in Coordinate::ALL {
            for value in motion
                .along(coordinate)
                .filter(|_| coordinate.is_length())
                .into_iter()
                .flatten()
            {
                *value *= ratio;
            }
        }
        let scale = |time: &mut AxleTime, factor: f64| {
            time.law.polynomial.iter_mut().for_each(|c| *c *= factor);
        };
        if let Some(time) = motion.time.as_mut().filter(|t| t.coordinate.is_length()) {
            scale(time, ratio);
        }
        if let Some(angles) = &self.steering_wheel {
            let Some(c_factor) = other.setup.c_factor else {
                let why = "steering_wheel_angle needs c_factor in [steering], which this study does not give";
                return Err(why.to_owned());
            };
            if let (Some(time), Some(own)) = (motion.time.as_mut(), own.setup.c_factor)
                && time.coordinate == Coordinate::SteeringWheel
            {
                scale(time, c_factor / own);
            }
            let turn = std::f64::consts::TAU;
            motion.racks = angles.iter().map(|angle| c_factor * angle / turn).collect();
        }
        Ok(motion)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The longest list loses most of its values, and every list keeps its ends.
    #[test]
    fn a_thinned_motion_keeps_the_ends_of_its_lists() {
        let values = |count: i32| -> Vec<f64> { (0..count).map(f64::from).collect() };
        let motion = AxleMotion {
            wheels: WheelMotion::Roll {
                heave: values(3),
                roll: values(3000),
                at_load: false,
            },
            racks: values(5),
            combine: Combine::All,
            shows_rack: true,
            steering_wheel: Some(values(5)),
            time: None,
        };
        let thinned = motion.thinned(2000);
        let WheelMotion::Roll { heave, roll, .. } = &thinned.wheels else {
            panic!("the motion rolls")
        };
        assert_eq!((heave.len(), roll.len(), thinned.racks.len()), (3, 133, 5));
        assert_eq!([roll[0], roll[132]], [0.0, 2999.0]);
        assert_eq!(motion.thinned(50_000), motion);
        let rows = AxleMotion {
            wheels: WheelMotion::Heave(values(3000)),
            racks: values(3000),
            combine: Combine::Rows,
            steering_wheel: None,
            ..motion
        };
        assert_eq!(rows.thinned(2000).stations(), 2000);
    }

    /// Each list has its value nearest to zero in another row. Stations of the thinned motion are still rows of the table, and
    /// angles of the steering wheel still belong to their rack displacements.
    #[test]
    fn lists_of_a_thinned_motion_keep_the_same_rows() {
        let from = |first: i32| -> Vec<f64> { (first..first + 12).map(f64::from).collect() };
        let rows = AxleMotion {
            wheels: WheelMotion::Travels {
                left: from(-2),
                right: from(-8),
                on_plane: false,
            },
            racks: from(-5),
            combine: Combine::Rows,
            shows_rack: true,
            steering_wheel: Some(from(-10)),
            time: None,
        };
        let thinned = rows.thinned(8);
        let WheelMotion::Travels { left, right, .. } = &thinned.wheels else {
            panic!("the wheels have travels")
        };
        assert_eq!(thinned.racks, [-5.0, -4.0, -2.0, 0.0, 1.0, 2.0, 4.0, 6.0]);
        let apart = |list: &[f64], by: f64| {
            let pairs = list.iter().zip(&thinned.racks);
            pairs.map(|(own, rack)| own - rack).all(|own| own == by)
        };
        assert!(apart(left, 3.0) && apart(right, -3.0));
        let all = AxleMotion {
            wheels: WheelMotion::Heave(vec![0.0]),
            combine: Combine::All,
            ..rows
        };
        for thinned in [thinned.clone(), all.thinned(8)] {
            let angles = thinned.steering_wheel.expect("the motion has angles");
            assert!(apart(&angles, -5.0), "{angles:?}");
        }
    }
}
