//! The order in which stations are visited.

/// The order in which stations are visited: outward from the design position, so that every step
/// starts at a neighbour.
#[derive(Clone, Debug, PartialEq)]
pub struct StationOrder {
    /// Drive values by station.
    pub(crate) values: Vec<f64>,
    /// Stations at and above the design position, upward.
    pub(crate) up: Vec<usize>,
    /// Stations below it, downward.
    pub(crate) down: Vec<usize>,
}

impl StationOrder {
    /// The order for these drive values, one for each station.
    pub fn through(values: &[f64]) -> Self {
        let (mut up, mut down): (Vec<_>, Vec<_>) =
            (0..values.len()).partition(|i| values[*i] >= 0.0);
        up.sort_by(|a, b| values[*a].total_cmp(&values[*b]));
        down.sort_by(|a, b| values[*b].total_cmp(&values[*a]));
        StationOrder {
            values: values.to_vec(),
            up,
            down,
        }
    }

    /// The stations of each side, outward.
    pub fn sides(&self) -> [&[usize]; 2] {
        [&self.up, &self.down]
    }

    /// Drive values by station.
    pub fn values(&self) -> &[f64] {
        &self.values
    }
}
