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
        let values = self.station_order.values();
        let kept = chosen(values, most);
        let time = self.time.as_ref().map(|law| TimeLaw {
            times: picked(&law.times, &kept),
            ..law.clone()
        });
        Plan {
            time,
            station_order: StationOrder::through(&picked(values, &kept)),
            racks,
            loads: Vec::new(),
            ..self.clone()
        }
    }
}

/// Selects at most `most` of the values, evenly spaced by index. From three values on, they include the first, the last and the one
/// nearest to zero.
pub fn evenly(values: &[f64], most: usize) -> Vec<f64> {
    picked(values, &chosen(values, most))
}

/// Values with these indices.
pub(crate) fn picked(values: &[f64], kept: &[usize]) -> Vec<f64> {
    kept.iter().map(|k| values[*k]).collect()
}

/// Indices of the values that [`evenly`] selects, in rising order.
pub(crate) fn chosen(values: &[f64], most: usize) -> Vec<usize> {
    let all = values.len();
    if all <= most {
        return (0..all).collect();
    }
    let mut chosen: Vec<usize> = (0..most).map(|i| i * (all - 1) / (most - 1)).collect();
    let nearest = (0..all).min_by(|a, b| values[*a].abs().total_cmp(&values[*b].abs()));
    if let Some(nearest) = nearest.filter(|k| !chosen.contains(k)) {
        // Only inner indices may change. So the first and the last value stay in the selection.
        let inner = chosen.iter_mut().skip(1).take(most.saturating_sub(2));
        if let Some(closest) = inner.min_by_key(|k| k.abs_diff(nearest)) {
            *closest = nearest;
        }
    }
    chosen
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

    /// Charts show the curve at the rack displacement nearest to zero as the main curve.
    #[test]
    fn thinning_keeps_the_value_nearest_to_zero() {
        let racks = [-20.0, -10.0, 0.0, 10.0];
        assert_eq!(evenly(&racks, 3), [-20.0, 0.0, 10.0]);
        assert_eq!(evenly(&racks, 2), [-20.0, 10.0]);
        let racks = [-30.0, -20.0, -10.0, 1.0, 10.0];
        assert_eq!(evenly(&racks, 3), [-30.0, 1.0, 10.0]);
        assert_eq!(evenly(&[0.0, 1.0, 2.0, 3.0], 3), [0.0, 1.0, 3.0]);
    }
}
