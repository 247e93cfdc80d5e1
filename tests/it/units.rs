//! Conversion factors from pounds-force, pounds and inches to newtons, kilograms and millimetres.

/// Newtons per pound-force.
pub const POUND_FORCE: f64 = 4.448_221_615_260_5;
/// Kilograms per pound.
pub const POUND: f64 = 0.453_592_37;
/// Millimetres per inch.
pub const INCH: f64 = 25.4;

/// Returns the name in inches and pounds of a column in millimetres and newtons, and the factor for the values.
pub fn in_inches_and_pounds(column: &str) -> (String, f64) {
    let endings = [
        ("_N_per_mm", "_lbf_per_in", INCH / POUND_FORCE),
        (
            "_N_m_per_deg",
            "_lbf_ft_per_deg",
            1.0 / (0.3048 * POUND_FORCE),
        ),
        ("_N_m", "_lbf_ft", 1.0 / (0.3048 * POUND_FORCE)),
        ("_N", "_lbf", 1.0 / POUND_FORCE),
        ("_mm", "_in", 1.0 / INCH),
        ("", "", 1.0),
    ];
    let found = endings.iter().find_map(|(from, to, factor)| {
        let stem = column.strip_suffix(from)?;
        Some((format!("{stem}{to}"), *factor))
    });
    found.expect("every name ends in nothing")
}
