//! Stations at which every design of a sweep is solved.

use crate::model::{Axis, Drive, Frame};
use crate::solve::StationOrder;
use crate::study::Motion;

/// All combinations of drive values and rack displacements. In both lists, the values of the motion come first. Further
/// values follow, for the design position and for targets.
#[derive(Clone, Debug, PartialEq)]
pub struct Stations {
    /// Kind of drive.
    pub drive: Drive,
    /// Drive values, and the order in which the solver visits them.
    pub station_order: StationOrder,
    /// Rack displacements, towards the kernel's +y.
    pub racks: Vec<f64>,
    /// Number of drive values of the motion.
    of_motion: usize,
    /// Number of rack displacements of the motion.
    racks_of_motion: usize,
    /// Index of the rack displacement that the design position and targets without rack displacements use.
    home: usize,
    /// Index of the drive value of the design position.
    design: usize,
}

impl Stations {
    /// Stations of a motion, and stations at `further` drive values, in all combinations with the rack displacements. The
    /// design position and targets without rack displacements use the displacement [`Motion::design_rack`].
    pub fn of(motion: &Motion, frame: &Frame, further: &[f64]) -> Self {
        let mut values = motion.values.clone();
        for value in further {
            index_or_push(&mut values, *value);
        }
        let design = index_or_push(&mut values, 0.0);
        let mut racks = motion.rack.clone();
        let home = index_or_push(&mut racks, motion.design_rack());
        let sign = frame.sign(Axis::Y);
        Stations {
            drive: motion.drive.in_kernel(),
            station_order: StationOrder::through(&values),
            racks: racks.iter().map(|rack| rack * sign).collect(),
            of_motion: motion.values.len(),
            racks_of_motion: motion.rack.len(),
            home,
            design,
        }
    }

    /// Stations from a list instead of combinations. `values` are their drive values. The first `of_motion` stations
    /// belong to the motion, and the station with index `design` is the design position.
    pub(super) fn listed(values: &[f64], of_motion: usize, design: usize) -> Self {
        Stations {
            of_motion,
            design,
            ..Stations::at_rack(Drive::Travel, &StationOrder::through(values), 0.0)
        }
    }

    /// Stations in the given order, all at one rack displacement (towards the kernel's +y). No station counts as the design
    /// position.
    pub(crate) fn at_rack(drive: Drive, order: &StationOrder, rack: f64) -> Self {
        let values = order.values().len();
        Stations {
            drive,
            station_order: order.clone(),
            racks: vec![rack],
            of_motion: values,
            racks_of_motion: 1,
            home: 0,
            design: values,
        }
    }

    /// Number of stations: drive values times rack displacements.
    pub fn count(&self) -> usize {
        self.values().len() * self.racks.len()
    }

    /// Drive values. The drive values of the motion come first.
    pub fn values(&self) -> &[f64] {
        self.station_order.values()
    }

    /// Index of the station with this rack displacement and this drive value, both given by their indices.
    #[inline]
    pub fn number(&self, rack: usize, value: usize) -> usize {
        rack * self.values().len() + value
    }

    /// Index of the drive value of a station.
    #[inline]
    pub fn value_of(&self, station: usize) -> usize {
        station % self.values().len()
    }

    /// Index of the rack displacement of a station.
    pub fn rack_of(&self, station: usize) -> usize {
        station / self.values().len()
    }

    /// Index of the station of the design position.
    pub fn design(&self) -> usize {
        self.number(self.home, self.design)
    }

    /// Index of the station at which a target evaluates this drive value. `None` if no station has this drive value.
    pub fn at(&self, value: f64) -> Option<usize> {
        let value = self.values().iter().position(|v| *v == value)?;
        Some(self.number(self.home, value))
    }

    /// Indices of the stations at which a target evaluates this drive value, one for each rack displacement of the target.
    /// The displacements are towards the kernel's +y. A target without rack displacements uses the rack displacement of the
    /// design position. The list omits stations that do not exist.
    pub fn at_racks(&self, value: f64, racks: &[f64]) -> Vec<usize> {
        let Some(value) = self.values().iter().position(|v| *v == value) else {
            return Vec::new();
        };
        if racks.is_empty() {
            return vec![self.number(self.home, value)];
        }
        let rack_of = |rack: &f64| self.racks.iter().position(|own| own == rack);
        let racks = racks.iter().filter_map(rack_of);
        racks.map(|rack| self.number(rack, value)).collect()
    }

    /// Indices of the motion's own stations, rack displacement by rack displacement.
    pub fn of_motion(&self) -> impl Iterator<Item = usize> + '_ {
        let racks = 0..self.racks_of_motion;
        racks.flat_map(move |rack| (0..self.of_motion).map(move |value| self.number(rack, value)))
    }
}

/// Returns the index of `place` in the list. Appends `place` if it is missing.
pub(crate) fn index_or_push<P: PartialEq>(places: &mut Vec<P>, place: P) -> usize {
    let known = places.iter().position(|p| *p == place);
    known.unwrap_or_else(|| {
        places.push(place);
        places.len() - 1
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::{FrameConvention, Side};

    fn motion(values: &[f64], rack: &[f64]) -> Motion {
        Motion {
            drive: crate::study::Drive::Travel,
            values: values.to_vec(),
            rack: rack.to_vec(),
            rack_moves: rack.len() > 1,
            time: None,
        }
    }

    #[test]
    fn design_position_and_targets_are_visited_besides_the_motion() {
        let frame = Frame::new(FrameConvention::Iso8855, Side::Right);
        let stations = Stations::of(&motion(&[10.0, 20.0], &[-5.0, 5.0]), &frame, &[15.0, 20.0]);
        assert_eq!(stations.values(), [10.0, 20.0, 15.0, 0.0]);
        assert_eq!(stations.racks, [5.0, -5.0, 0.0]);
        assert_eq!(stations.count(), 12);
        assert_eq!(stations.design(), 11);
        assert_eq!(stations.at(20.0), Some(9));
        assert_eq!(stations.at(1.0), None);
        let own: Vec<_> = stations.of_motion().collect();
        assert_eq!(own, [0, 1, 4, 5]);
        let fixed = Stations::of(&motion(&[0.0], &[3.0]), &frame, &[]);
        assert_eq!((fixed.count(), fixed.design()), (1, 0));
    }
}
