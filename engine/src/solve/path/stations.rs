//! Order in which the solver visits stations.

use crate::sorting::sort_by;

/// Order in which the solver visits stations: outward from the design position, so that every step starts at a neighbour.
#[derive(Clone, Debug, PartialEq)]
pub struct StationOrder {
    /// Drive value of each station.
    pub(crate) values: Vec<f64>,
    /// Stations at and above the design position, in upward order.
    pub(crate) up: Vec<usize>,
    /// Stations below the design position, in downward order.
    pub(crate) down: Vec<usize>,
}

impl StationOrder {
    /// Makes the order for these drive values, one for each station.
    pub fn through(values: &[f64]) -> Self {
        let (mut up, mut down): (Vec<_>, Vec<_>) =
            (0..values.len()).partition(|i| values[*i] >= 0.0);
        sort_by(&mut up, |a, b| values[*a].total_cmp(&values[*b]));
        sort_by(&mut down, |a, b| values[*b].total_cmp(&values[*a]));
        StationOrder {
            values: values.to_vec(),
            up,
            down,
        }
    }

    /// Returns the order that visits only these stations. Indices of stations do not change.
    pub(crate) fn only(&self, is_visited: impl Fn(usize) -> bool) -> Self {
        let mut order = self.clone();
        order.up.retain(|station| is_visited(*station));
        order.down.retain(|station| is_visited(*station));
        order
    }

    /// Returns true if the order visits no station.
    pub(crate) fn is_empty(&self) -> bool {
        self.up.is_empty() && self.down.is_empty()
    }

    /// Stations of each side, in outward order.
    pub fn sides(&self) -> [&[usize]; 2] {
        [&self.up, &self.down]
    }

    /// Drive value of each station.
    pub fn values(&self) -> &[f64] {
        &self.values
    }
}
