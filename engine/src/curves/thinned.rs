//! Plans with fewer stations, for drawings.

use crate::plan::Plan;
use crate::solve::StationOrder;
use crate::study::TimeLaw;

impl Plan {
    /// Returns the plan with at most `most` stations, among them at most `most_racks` rack displacements, and without loads. If
    /// the motion follows a time law, each station keeps its own time.
    pub fn thinned(&self, most: usize, most_racks: usize) -> Plan {
        let racks = evenly(&self.racks, most_racks);
        let most = most / racks.len();
        let values = evenly(self.station_order.values(), most);
        let time = self.time.as_ref().map(|law| TimeLaw {
            times: evenly(&law.times, most),
            ..law.clone()
        });
        Plan {
            time,
            station_order: StationOrder::through(&values),
            racks,
            loads: Vec::new(),
            ..self.clone()
        }
    }
}

/// Selects at most `most` of the values, evenly spaced by index, including the first and the last.
pub fn evenly(values: &[f64], most: usize) -> Vec<f64> {
    match values.len() {
        few if few <= most => values.to_vec(),
        many => (0..most)
            .map(|i| values[i * (many - 1) / (most - 1)])
            .collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn thinning_keeps_the_ends() {
        let values: Vec<f64> = (0..1000).map(f64::from).collect();
        let few = evenly(&values, 41);
        assert_eq!((few.len(), few[0], few[40]), (41, 0.0, 999.0));
        assert_eq!(evenly(&values, 1000), values);
    }
}
