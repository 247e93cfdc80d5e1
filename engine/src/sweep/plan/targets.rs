//! Targets of a sweep with their stations.

use super::{Axis, Frame, Sample, Stations, Target};

/// A target with its target value at each station.
#[derive(Clone, Debug)]
pub(super) struct SweptTarget {
    /// Name of the target in column names.
    pub name: String,
    pub tolerance: f64,
    pub weight: f64,
    pub stations: TargetStations,
}

/// Stations at which the sweep compares a quantity with its target.
#[derive(Clone, Debug)]
pub(super) enum TargetStations {
    /// Stations of the sweep, each with the target value.
    OfSweep(Vec<SweptWish>),
    /// Stations outside the sweep. Contains the index of the target among the targets of [`Goals`](super::goals::Goals).
    Own(usize),
}

/// Target value of a quantity at a station. Quantity and station are given by their indices.
#[derive(Clone, Copy, Debug)]
pub(super) struct SweptWish {
    pub quantity: usize,
    pub station: usize,
    pub wanted: Sample,
}

impl SweptWish {
    /// Target values of one wheel at the stations of the target: at each of its drive values and rack displacements.
    pub(super) fn of(
        target: &Target,
        wanted: &[Sample],
        quantity: usize,
        stations: &Stations,
        frame: &Frame,
    ) -> Vec<Self> {
        let sign = frame.sign(Axis::Y);
        let racks: Vec<f64> = target.site.racks.iter().map(|rack| rack * sign).collect();
        let at = |wanted: &Sample| {
            let stations = stations.at_racks(wanted.drive, &racks).into_iter();
            let wanted = *wanted;
            stations.map(move |station| SweptWish {
                quantity,
                station,
                wanted,
            })
        };
        wanted.iter().flat_map(at).collect()
    }
}
