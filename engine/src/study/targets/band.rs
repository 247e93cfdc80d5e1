//! Bands of `targets`: a lower limit, an upper limit, or both.

use super::super::error::Problems;
use super::super::file::Target as Written;
use super::super::value::{LimitText, Number};
use super::super::{Limit, Wanted};
use super::stations::added_stations;
use super::{TargetContext, curve};
use std::ops::Range as Span;

impl TargetContext<'_> {
    /// Reads the limits of a band, and checks that the motion has stations at which the band applies.
    pub(super) fn band(
        &self,
        written: &Written,
        at: Option<&Number>,
        problems: &mut Problems,
    ) -> Option<Wanted> {
        let (least, most) = (written.at_least.as_ref(), written.at_most.as_ref());
        let [lower, upper] = match (&written.between, least, most) {
            (Some(between), None, None) => {
                let [lower, upper] = between.get_ref().as_slice() else {
                    let message = format!(
                        "expected two limits [lower, upper], found {}",
                        between.get_ref().len()
                    );
                    return problems.refuse(between.span(), message);
                };
                [Some((lower, between.span())), Some((upper, between.span()))]
            }
            (None, least, most) => {
                [least, most].map(|limit| Some((limit?.get_ref(), limit?.span())))
            }
            (Some(between), _, _) => {
                let message = "\"between\" gives both limits; expected \"between\" alone, or \"at_least\" and \"at_most\"";
                return problems.refuse(between.span(), message);
            }
        };
        let mut limit = |given: Option<(&LimitText, Span<usize>)>| match given {
            None => Some(None),
            Some((LimitText::One(value), _)) => {
                Some(Some(Limit::Value(self.of.from_printed(*value))))
            }
            Some((LimitText::Many(points), place)) => {
                let curve = curve(points, place, false, problems)?;
                let points = curve.iter();
                let points =
                    points.map(|[d, v]| [self.drives.in_kernel(*d), self.of.from_printed(*v)]);
                Some(Some(Limit::Curve {
                    points: points.collect(),
                    interpolation: self.interpolation,
                }))
            }
        };
        let (lower, upper) = (limit(lower)?, limit(upper)?);
        // If the axis has the opposite sign, upper and lower limit are exchanged.
        let [lower, upper] = if self.of.sign < 0.0 {
            [upper, lower]
        } else {
            [lower, upper]
        };
        let limits = [&lower, &upper].into_iter().flatten();
        let is_level = limits
            .into_iter()
            .all(|limit| matches!(limit, Limit::Value(_)));
        let is_placed = written.motion.is_some() || written.over.is_some();
        let at = match at {
            // Without a travel, the band of a test result applies at the design height.
            None if self.of.is_figure() && is_level && !is_placed => Some(0.0),
            None => None,
            Some(at) => Some(self.single(at, problems)?),
        };
        let wanted = Wanted::Band { at, lower, upper };
        let mut stations = self.motion.values.clone();
        stations.extend(added_stations(&wanted, self.motion));
        let samples = wanted.samples(&stations);
        if samples.is_empty() {
            let message = format!(
                "no station of the motion, which {}, is within this band",
                self.drives.range_in_words()
            );
            return problems.refuse(self.place.clone(), message);
        }
        if let Some(sample) = samples.iter().find(|s| s.low > s.high) {
            let message = format!(
                "the band is empty at {}: its lower limit is above the upper one",
                self.drives.as_written(sample.drive)
            );
            return problems.refuse(self.place.clone(), message);
        }
        Some(wanted)
    }
}
