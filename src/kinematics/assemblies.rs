//! All assemblies of a strut: every pose its lengths allow at a given travel, on whatever branch.
//!
//! At an arm angle th there are at most four (module `closed_form`): strut upright or inverted, the
//! outer end of the tie rod on either side of its plane. On each of the four the travel is an explicit
//! function f(th), so the assemblies are the roots of f(th) = travel over one turn of the arm. (The four
//! together are one trigonometric polynomial of degree ten, so there are at most twenty.)
//!
//! They are isolated on intervals, f and f' enclosed by their mean-value forms about the middle m of a
//! piece X, f(X) in f(m) + f'(X) (X - m), which shrink with the square of its width. A piece of the turn is dropped if f encloses no root there, or if
//! strut length or tie-rod distance have no real value anywhere on it; if f' does not vanish on it there
//! is at most one root, decided by the signs at its ends; else it is halved. So none is missed, whatever
//! the distance between two of them. What is narrower than [`NARROWEST`] and still undecided (a double
//! root, or one at a toggle) goes to Newton's method on the closure equations, which has no trouble with
//! toggles.

use super::certificate::{Certificate, Certifier};
use super::closed_form::{ClosedForm, State};
use super::motion::MotionPoint;
use super::path::Solver;
use super::pose::Pose;
use crate::model::Drive;
use crate::number::{Interval, Jet, Real, Scalar, Vector3};
use std::f64::consts::PI;

/// One way to assemble a design.
#[derive(Clone, Debug, PartialEq)]
pub struct Assembly {
    /// Pose of the knuckle.
    pub pose: Pose<f64>,
    /// Arm angle from the design position (radians, about the axis taken pointing forward).
    pub arm_angle: f64,
    /// Whether the strut's mount is below the foot of the ball joint on its axis.
    pub strut_inverted: bool,
    /// Whether the tie rod's outer end is on the other side of its plane than in the design.
    pub tie_rod_across: bool,
    /// Position of the wheel centre.
    pub wheel_centre: Vector3<f64>,
    /// Proof of the pose; `None` where it is as good as singular.
    pub certificate: Option<Certificate>,
}

/// What was found at one travel.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Assemblies {
    /// By arm angle.
    pub found: Vec<Assembly>,
    /// Arm angles (ranges, radians) on which it could not be decided whether there is an assembly; none
    /// for all but degenerate designs.
    pub undecided: Vec<(f64, f64)>,
}

/// Pieces this narrow (rad) are not halved any further.
const NARROWEST: f64 = 1e-10;
/// Pieces looked at before giving up, for each of the four.
const MOST_PIECES: usize = 200_000;
/// Undecided ranges kept apart in the answer.
const MOST_UNDECIDED: usize = 64;

type Value = Jet<Interval, 3>;

impl Solver<'_> {
    /// Every assembly of the design's lengths at a wheel travel, the rack displaced by `rack` (towards the
    /// kernel's +y). `None` for a mechanism that is no strut.
    pub fn assemblies(&self, travel: f64, rack: f64) -> Option<Assemblies> {
        let points = self.strut()?;
        let design = self.design();
        let certifier = Certifier::new(self.mechanism(), design);
        let exact: Vec<_> = design.iter().map(|p| p.map(Interval::point)).collect();
        let (form, plain) = (
            ClosedForm::new(&points, &exact),
            ClosedForm::new(&points, design),
        );
        let point = MotionPoint {
            drive: Drive::Travel,
            value: travel,
            rack,
        };
        let mut all = Assemblies::default();
        for (inverted, across) in [(false, false), (false, true), (true, false), (true, true)] {
            let branch = Branch {
                form: form.assembled(inverted, across),
                travel: Interval::point(travel),
                rack: Interval::point(rack),
            };
            let plain = plain.assembled(inverted, across);
            let (candidates, undecided) = branch.isolate();
            for (low, high) in candidates {
                let angle = branch.refined(low, high);
                let (sine, cosine) = angle.sin_cos();
                let start = plain.pose(&plain.at(cosine, sine, rack));
                let Some(assembly) = self.assembly(&certifier, &start, &point, angle) else {
                    all.undecided.push((low, high));
                    continue;
                };
                all.add(
                    Assembly {
                        strut_inverted: inverted,
                        tie_rod_across: across,
                        ..assembly
                    },
                    self.size(),
                );
            }
            for (low, high) in undecided {
                // A root of even order, or one at a toggle: as seen from the middle, or there is none.
                let (sine, cosine) = (0.5 * (low + high)).sin_cos();
                let mut state = plain.at(cosine, sine, rack);
                state.at_toggle_if_beyond();
                let near = plain.pose(&state);
                let found = self
                    .assembly(&certifier, &near, &point, 0.5 * (low + high))
                    .filter(|a| (a.arm_angle - 0.5 * (low + high)).abs() < 1e-4);
                match found {
                    Some(assembly) => all.add(
                        Assembly {
                            strut_inverted: inverted,
                            tie_rod_across: across,
                            ..assembly
                        },
                        self.size(),
                    ),
                    None => all.undecided.push((low, high)),
                }
            }
        }
        all.undecided.truncate(MOST_UNDECIDED);
        all.found
            .sort_by(|a, b| a.arm_angle.total_cmp(&b.arm_angle));
        Some(all)
    }

    fn assembly(
        &self,
        certifier: &Certifier,
        near: &Pose<f64>,
        point: &MotionPoint<f64>,
        angle: f64,
    ) -> Option<Assembly> {
        let pose = self.polished(near, point)?;
        let centre = self.mechanism().wheel_centre;
        let lever = self.design()[centre.0] - self.design()[self.mechanism().origin.0];
        let turned = self.arm_angle(&pose);
        // The branch cut is at half a turn.
        let arm_angle = turned + 2.0 * PI * ((angle - turned) / (2.0 * PI)).round();
        Some(Assembly {
            pose,
            arm_angle,
            strut_inverted: false,
            tie_rod_across: false,
            wheel_centre: pose.origin + pose.rotation.apply(lever),
            certificate: certifier.pose(&pose, point).ok(),
        })
    }

    fn arm_angle(&self, pose: &Pose<f64>) -> f64 {
        let points = self.strut().expect("asked of a strut only");
        2.0 * ClosedForm::new(&points, self.design())
            .half_tangent(pose)
            .atan()
    }
}

impl Assemblies {
    /// Adds an assembly, unless it was found from the other side of a toggle already.
    fn add(&mut self, assembly: Assembly, size: f64) {
        if !self.found.iter().any(|a| same(a, &assembly, size)) {
            self.found.push(assembly);
        }
    }
}

/// Whether two assemblies are one within what their proofs tell apart.
fn same(a: &Assembly, b: &Assembly, size: f64) -> bool {
    let apart = (a.pose.origin - b.pose.origin).norm()
        + a.pose
            .rotation
            .columns
            .iter()
            .zip(b.pose.rotation.columns)
            .map(|(p, q)| (*p - q).norm())
            .fold(0.0, f64::max)
            * size;
    let radius = |a: &Assembly| a.certificate.map_or(1e-7 * size, |c| c.uniqueness);
    apart < radius(a).max(radius(b))
}

/// One of the four.
struct Branch {
    form: ClosedForm<Interval>,
    travel: Interval,
    rack: Interval,
}

/// Ranges of arm angle.
type Ranges = Vec<(f64, f64)>;

impl Branch {
    /// Pieces with exactly one simple root each, and pieces that remain undecided.
    fn isolate(&self) -> (Ranges, Ranges) {
        let (mut single, mut undecided) = (Vec::new(), Vec::new());
        // Not halved at zero, where the design lies.
        let cut = -PI + 0.1234;
        let mut pieces = vec![(cut, cut + PI), (cut + PI, cut + 2.0 * PI)];
        let mut looked_at = 0;
        while let Some((low, high)) = pieces.pop() {
            looked_at += 1;
            let piece = Interval::bounds(low, high);
            let (state, miss) = self.miss(piece);
            let squares = self.form.map(Jet::constant).squares(&state).map(|s| s[0]);
            let excludes_zero = |i: Interval| i.low > 0.0 || i.high < 0.0;
            if squares.iter().any(|s| s.high < 0.0) || excludes_zero(miss[0]) {
                continue;
            }
            let centre = piece.middle();
            let (_, there) = self.miss(Interval::point(centre));
            let around = piece - Interval::point(centre);
            let slope = miss[1].meet(there[1] + (miss[2] + miss[2]) * around);
            if squares.iter().all(|s| s.low > 0.0) && excludes_zero(there[0] + slope * around) {
                continue;
            }
            if squares.iter().all(|s| s.low > 0.0) && excludes_zero(slope) {
                let at = |angle: f64| self.miss(Interval::point(angle)).1[0];
                let (first, last) = (at(low), at(high));
                let rising = slope.low > 0.0;
                let none = match rising {
                    true => first.low > 0.0 || last.high < 0.0,
                    false => first.high < 0.0 || last.low > 0.0,
                };
                let one = match rising {
                    true => first.high < 0.0 && last.low > 0.0,
                    false => first.low > 0.0 && last.high < 0.0,
                };
                if none {
                    continue;
                }
                if one {
                    single.push((low, high));
                    continue;
                }
            }
            if high - low < NARROWEST || looked_at > MOST_PIECES {
                join(&mut undecided, (low, high));
                continue;
            }
            let middle = low + 0.4871 * (high - low);
            pieces.push((low, middle));
            pieces.push((middle, high));
        }
        (single, undecided)
    }

    /// State and f - travel, as series in the angle.
    fn miss(&self, angle: Interval) -> (State<Value>, Value) {
        let (sine, cosine) = angle.sin_cos();
        let form = self.form.map(Jet::constant);
        let state = form.at(
            Jet([cosine, -sine, cosine.scaled(-0.5)]),
            Jet([sine, cosine, sine.scaled(-0.5)]),
            Jet::constant(self.rack),
        );
        let miss = form.travel(&state) - Jet::constant(self.travel);
        (state, miss)
    }

    /// The root on a piece with one, by bisection until Newton's method has nothing to fear.
    fn refined(&self, mut low: f64, mut high: f64) -> f64 {
        let at = |angle: f64| self.miss(Interval::point(angle)).1[0].value();
        let rising = at(high) > at(low);
        while high - low > 1e-12 {
            let middle = 0.5 * (low + high);
            if (at(middle) > 0.0) == rising {
                high = middle;
            } else {
                low = middle;
            }
        }
        0.5 * (low + high)
    }
}

/// Adds a range, joined with the last one if they touch.
fn join(ranges: &mut Ranges, (low, high): (f64, f64)) {
    match ranges.last_mut() {
        // Pieces come from the top of the stack, that is downward.
        Some(last) if high >= last.0 && low <= last.0 => last.0 = low,
        _ => ranges.push((low, high)),
    }
}
