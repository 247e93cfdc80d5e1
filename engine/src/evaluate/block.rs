//! Values of a block of designs.

use super::aligned::Aligned;
use crate::mechanism::{DesignFault, NoPose};
use crate::number::{MOST_LANES, SimdReal};

/// Number of designs in a full block. Sums, shards and resumed sweeps also use whole blocks: block `k` always begins with
/// design `k * BLOCK`, for any number of CPU threads.
pub const BLOCK: usize = 128;
/// Number of designs whose values are stored side by side, in the order in which lanes return them.
pub(super) const SIDE_BY_SIDE: usize = MOST_LANES;
const _: () = assert!(BLOCK.is_multiple_of(SIDE_BY_SIDE));

/// Failure of a design at a station: it has no pose there, or lacks values because of a toggle (a rod in line with its
/// lever).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FailedStation {
    /// Index of the design in the block.
    pub design: usize,
    /// Index of the station.
    pub station: usize,
    /// Reason for the missing pose or values.
    pub failure: NoPose,
}

/// Values of up to [`BLOCK`] designs, in the kernel's frame, in radians and length units. NaN if a value does not exist.
#[derive(Clone, Debug)]
pub struct Block {
    outputs: usize,
    stations: usize,
    /// Number of slopes (derivatives in the design position) of each design.
    gains: usize,
    designs: usize,
    /// Values, `[design / SIDE_BY_SIDE][output][station][design % SIDE_BY_SIDE]`.
    values: Aligned,
    /// Slopes, `[design / SIDE_BY_SIDE][slope][design % SIDE_BY_SIDE]`. For a wheel, slope k is the derivative of output k with
    /// respect to the drive coordinate in the design position. For an axle, slopes are `AxleStations::gains`.
    slopes: Aligned,
    /// Failures in the order of the designs' indices.
    failures: Vec<FailedStation>,
    /// Designs that cannot be solved at all, in the order of their indices.
    faults: Vec<(usize, DesignFault)>,
}

impl Block {
    /// Allocates a block for this number of outputs and stations, with a slope for each output.
    pub fn new(outputs: usize, stations: usize) -> Self {
        Block::with_gains(outputs, stations, outputs)
    }

    /// Allocates a block like [`Block::new`], with `gains` slopes per design.
    pub(super) fn with_gains(outputs: usize, stations: usize, gains: usize) -> Self {
        // `from` points into the slopes, so at least one slope must exist even if no slope is requested.
        let gains = gains.max(1);
        Block {
            outputs,
            stations,
            gains,
            designs: 0,
            values: Aligned::new(f64::NAN, BLOCK * outputs * stations),
            slopes: Aligned::new(f64::NAN, BLOCK * gains),
            failures: Vec::new(),
            faults: Vec::new(),
        }
    }

    /// Prepares for this number of designs. The values of the previous block remain until they are overwritten.
    pub(super) fn clear(&mut self, designs: usize) {
        assert!(designs <= BLOCK);
        self.designs = designs;
        self.failures.clear();
        self.faults.clear();
    }

    /// Number of designs in the block.
    pub fn designs(&self) -> usize {
        self.designs
    }

    /// Value of an output of a design at a station.
    #[inline]
    pub fn value(&self, design: usize, output: usize, station: usize) -> f64 {
        self.values[self.place(design, output, station)]
    }

    /// Returns true if a design has a value of at least one of these outputs at a station.
    pub(super) fn has_value_of(
        &self,
        design: usize,
        mut outputs: impl Iterator<Item = usize>,
        station: usize,
    ) -> bool {
        outputs.any(|output| !self.value(design, output, station).is_nan())
    }

    /// Values of an output of a design, station by station.
    pub fn values(&self, design: usize, output: usize) -> impl Iterator<Item = f64> {
        (0..self.stations).map(move |station| self.value(design, output, station))
    }

    /// Values of an output of all designs at a station, in pieces, in the order of the designs.
    pub(crate) fn across(&self, output: usize, station: usize) -> impl Iterator<Item = &[f64]> {
        (0..self.designs).step_by(SIDE_BY_SIDE).map(move |first| {
            let count = (self.designs - first).min(SIDE_BY_SIDE);
            &self.values[self.place(first, output, station)..][..count]
        })
    }

    /// Derivative with respect to the drive coordinate in the design position. NaN for a quantity that contains velocities,
    /// unless the sweep requests this derivative. For an axle, `output` is the index of the requested derivative.
    #[inline]
    pub fn slope(&self, design: usize, output: usize) -> f64 {
        self.slopes[self.slope_place(design, output)]
    }

    /// Stores a value. Stores NaN if the value is not finite, for example the swing arm of a wheel that does not rotate.
    pub(super) fn put(&mut self, design: usize, output: usize, station: usize, value: f64) {
        let place = self.place(design, output, station);
        self.values[place] = value.finite();
    }

    /// Stores a slope. Stores NaN if it is not finite.
    pub(super) fn put_slope(&mut self, design: usize, output: usize, slope: f64) {
        let place = self.slope_place(design, output);
        self.slopes[place] = slope.finite();
    }

    /// Stores the reason why a design has no pose, or lacks values, at a station.
    pub(super) fn fail(&mut self, design: usize, station: usize, failure: NoPose) {
        self.failures.push(FailedStation {
            design,
            station,
            failure,
        });
    }

    /// Returns the memory for the values and the memory for the slopes of the designs from `design` on, which are solved
    /// together. The values of the next station begin [`SIDE_BY_SIDE`] numbers later. The values of the next output follow
    /// after all stations.
    #[inline(always)]
    pub(super) fn from(&mut self, design: usize) -> (&mut [f64], &mut [f64]) {
        let (value, slope) = (self.place(design, 0, 0), self.slope_place(design, 0));
        (&mut self.values[value..], &mut self.slopes[slope..])
    }

    /// Replaces all values of a design by NaN.
    pub(super) fn forget(&mut self, design: usize) {
        for output in 0..self.outputs {
            for station in 0..self.stations {
                self.put(design, output, station, f64::NAN);
            }
        }
        for gain in 0..self.gains {
            self.put_slope(design, gain, f64::NAN);
        }
    }

    /// Stores the reason why a design cannot be solved at all. Values and failures that were stored before are removed.
    pub(super) fn refuse(&mut self, design: usize, fault: DesignFault) {
        self.forget(design);
        self.failures.retain(|failure| failure.design != design);
        self.faults.push((design, fault));
    }

    #[inline(always)]
    fn place(&self, design: usize, output: usize, station: usize) -> usize {
        let row = (design / SIDE_BY_SIDE * self.outputs + output) * self.stations + station;
        row * SIDE_BY_SIDE + design % SIDE_BY_SIDE
    }

    #[inline(always)]
    fn slope_place(&self, design: usize, gain: usize) -> usize {
        let row = design / SIDE_BY_SIDE * self.gains + gain;
        row * SIDE_BY_SIDE + design % SIDE_BY_SIDE
    }

    /// Stations without a pose or without all values, in the order of the designs.
    pub fn failures(&self) -> &[FailedStation] {
        &self.failures
    }

    /// Designs that cannot be solved at all, in order.
    pub fn faults(&self) -> &[(usize, DesignFault)] {
        &self.faults
    }
}
