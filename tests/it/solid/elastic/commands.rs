//! The commands with five links of a solid axle.
