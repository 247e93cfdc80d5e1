//! Keys of a target with a measured sheet.

use super::super::error::Problems;
use super::super::file::Target;
use super::super::value::Text;
use toml::Spanned;

/// Refuses keys of a target that a sheet replaces.
pub(super) fn refuse_other_keys(written: &Target, problems: &mut Problems) -> Option<()> {
    let others = [
        ("points", written.points.as_ref().map(Spanned::span)),
        ("column", written.column.as_ref().map(Spanned::span)),
        ("at", written.at.as_ref().map(|n| n.span.clone())),
        ("value", written.value.as_ref().map(|n| n.span.clone())),
        ("rack", written.rack.as_ref().map(Spanned::span)),
        ("motion", written.motion.as_ref().map(Spanned::span)),
        ("point", written.point.as_ref().map(Spanned::span)),
        ("length", written.length.as_ref().map(Spanned::span)),
        ("load", written.load.as_ref().map(Spanned::span)),
        ("over", written.over.as_ref().map(Text::span)),
        ("heave", written.heave.as_ref().map(Spanned::span)),
        (
            "travel_left",
            written.travel_left.as_ref().map(Spanned::span),
        ),
        (
            "travel_right",
            written.travel_right.as_ref().map(Spanned::span),
        ),
        ("side", written.side.as_ref().map(Text::span)),
        ("roll", written.roll.as_ref().map(Spanned::span)),
        (
            "steering_wheel_angle",
            written.steering_wheel_angle.as_ref().map(Spanned::span),
        ),
        ("axis", written.axis.as_ref().map(Spanned::span)),
        ("between", written.between.as_ref().map(Spanned::span)),
        ("at_least", written.at_least.as_ref().map(Spanned::span)),
        ("at_most", written.at_most.as_ref().map(Spanned::span)),
        (
            "interpolation",
            written.interpolation.as_ref().map(Spanned::span),
        ),
    ];
    for (key, span) in others {
        if let Some(span) = span {
            let message =
                format!("the sheet already gives travel, rack and values: remove the key {key}");
            return problems.refuse(span, &message);
        }
    }
    if let (Some(_), Some(name)) = (&written.figure, &written.characteristic) {
        let message = "expected either \"figure\" or \"characteristic\", found both";
        return problems.refuse(name.span(), message);
    }
    Some(())
}
