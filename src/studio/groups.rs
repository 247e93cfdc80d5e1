//! Groups of stations that belong to the same curve.

/// Groups of stations. Stations of one group differ only in the coordinate on the horizontal axis.
pub(super) struct Groups {
    /// Index of the group of each station.
    pub of_stations: Vec<usize>,
    /// Values of all sliders at the first station of each group. NaN for a value that is not known.
    pub places: Vec<Vec<f64>>,
    /// Index of the group nearest to the slider positions.
    pub shown: usize,
}

impl Groups {
    /// Groups stations. `places` has the values of all sliders at each station. `over` is the index of the slider whose coordinate
    /// is on the horizontal axis. `at` has the present values of the sliders.
    pub(super) fn of(places: &[Vec<f64>], over: usize, at: &[f64]) -> Self {
        let others = |k: &usize| *k != over;
        let mut found: Vec<Vec<f64>> = Vec::new();
        let is_same = |a: &[f64], b: &[f64]| {
            (0..a.len())
                .filter(others)
                .all(|k| a[k] == b[k] || (a[k].is_nan() && b[k].is_nan()))
        };
        let group = |place: &Vec<f64>| {
            let known = found.iter().position(|first| is_same(first, place));
            known.unwrap_or_else(|| {
                found.push(place.clone());
                found.len() - 1
            })
        };
        let of_stations = places.iter().map(group).collect();
        let far = |number: &usize| -> f64 {
            let place = &found[*number];
            let squares = (0..place.len()).filter(others).map(|k| place[k] - at[k]);
            squares.map(|d| d * d).sum()
        };
        let shown = (0..found.len()).min_by(|a, b| far(a).total_cmp(&far(b)));
        Groups {
            of_stations,
            shown: shown.unwrap_or(0),
            places: found,
        }
    }

    /// Makes one group of all stations, for a motion that is given as a table of rows.
    pub(super) fn one(places: &[Vec<f64>]) -> Self {
        Groups {
            of_stations: vec![0; places.len()],
            places: places.first().cloned().into_iter().collect(),
            shown: 0,
        }
    }

    /// Makes one group for each rack displacement of a wheel's motion. Each displacement has `along` stations.
    pub(super) fn by_rack(racks: &[f64], stations: usize, along: usize, rack: f64) -> Self {
        let shown = nearest(racks, rack);
        Groups {
            of_stations: (0..stations).map(|station| station / along).collect(),
            // Within a group only the drive differs between stations, so a group has no common drive value.
            places: racks.iter().map(|rack| vec![f64::NAN, *rack]).collect(),
            shown: shown.unwrap_or(0),
        }
    }

    /// Groups for an answer that contains only the shown group, which has `stations` stations.
    pub(super) fn with_shown_only(self, stations: usize) -> Self {
        Groups {
            of_stations: vec![self.shown; stations],
            ..self
        }
    }

    /// Values of all sliders at the first station of the group nearest to the slider positions. `None` without groups.
    pub(super) fn shown_place(&self) -> Option<&[f64]> {
        self.places.get(self.shown).map(Vec::as_slice)
    }
}

/// Index of the value nearest to `at`. If several values are equally near, the first one counts.
pub(super) fn nearest(values: &[f64], at: f64) -> Option<usize> {
    let far = |k: &usize| (values[*k] - at).abs();
    (0..values.len()).min_by(|a, b| far(a).total_cmp(&far(b)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_group_differs_in_one_number_alone() {
        let mut places = Vec::new();
        for rack in [-10.0, 0.0, 10.0] {
            for heave in [-20.0, 0.0] {
                places.extend([-1.0, 0.0, 1.0].map(|roll| vec![roll, heave, rack]));
            }
        }
        let over_roll = Groups::of(&places, 0, &[0.3, -18.0, 7.0]);
        assert_eq!(over_roll.places.len(), 6);
        assert_eq!(over_roll.shown_place(), Some(&[-1.0, -20.0, 10.0][..]));
        let over_rack = Groups::of(&places, 2, &[0.9, -3.0, 7.0]);
        assert_eq!(over_rack.places.len(), 6);
        assert_eq!(over_rack.shown_place(), Some(&[1.0, 0.0, -10.0][..]));
        for (station, group) in over_rack.of_stations.iter().enumerate() {
            assert_eq!(over_rack.places[*group][..2], places[station][..2]);
        }
        let none = Groups::of(&[], 0, &[0.0]);
        assert!(none.shown_place().is_none() && none.of_stations.is_empty());
    }
}
