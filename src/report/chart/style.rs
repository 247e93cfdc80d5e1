//! Styles of charts. Pictures, light pages and dark pages use the same table of colours.

/// Strokes and sizes, without colours.
const SHAPES: &str = ".axis-text,.note,.end,.name{font:12px system-ui,-apple-system,Segoe UI,Roboto,Helvetica,Arial,sans-serif}\
.name{font-size:14px;font-weight:650}\
.line,.grid,.frame,.limit,.bar,.failed,.missed,.target,.spot,.dot,.leader,.zero{fill:none;stroke:currentColor;stroke-linejoin:round;stroke-linecap:round}\
.line{stroke-width:1.5}.line.strong{stroke-width:2.4}.line.faint{opacity:.75}.line.former{stroke-dasharray:6 4}\
.line.inner{stroke-dasharray:1 4}.line.fine{stroke-width:1;stroke-dasharray:none;opacity:.75}\
.target{stroke-width:1.3;stroke-dasharray:1 3}.limit,.bar{stroke-width:1.6}.spot{stroke-width:7}.dot{stroke-width:6}\
.failed,.zero{stroke-width:1}.missed{stroke-width:9;opacity:.7}.leader{stroke-width:.8}\
.line.dot{stroke-width:6;stroke-dasharray:none}.band{stroke:currentColor;stroke-width:.75;fill:currentColor;fill-opacity:.22}.fan{stroke:none;fill:currentColor;fill-opacity:.16}\
.axis-text,.note,.end,.name{stroke:none;fill:currentColor}";

/// CSS classes with their colours on light and on dark background. Text has a contrast of at least 4.5 on both backgrounds.
const COLOURS: [(&str, &str, &str); 29] = [
    (".name", "#1b1f24", "#e6e9ed"),
    (".axis-text,.note", "#4a535d", "#aab4bf"),
    (".grid", "#e3e7eb", "#2c333b"),
    (".frame,.leader", "#8a929b", "#6b7580"),
    (".zero", "#8a929b", "#6b7580"),
    (".main,.left", "#0b63c5", "#6cb2ff"),
    (".former", "#66707a", "#9aa4af"),
    (".right", "#a3245f", "#ff8cc6"),
    (
        ".target,.band,.limit,.bar,.spot,.wanted",
        "#b45f06",
        "#f0a35e",
    ),
    (".hue0", "#0b63c5", "#6cb2ff"),
    (".hue1", "#b3500d", "#f0a35e"),
    (".hue2", "#0a7a7a", "#4fd1c5"),
    (".hue3", "#b3267a", "#ff8cc6"),
    (".hue4", "#5f6e00", "#c3d64a"),
    (".hue5", "#7a4fc9", "#b79bff"),
    (".hue6", "#8a5a2b", "#d1a679"),
    (".fan", "#0b63c5", "#6cb2ff"),
    (".given", "#66707a", "#9aa4af"),
    (".chosen", "#0b63c5", "#6cb2ff"),
    (".shade0", "#96600f", "#f2c14e"),
    (".shade1", "#a04c26", "#f2ae59"),
    (".shade2", "#a03c3a", "#f29a64"),
    (".shade3", "#9e3152", "#ed8b78"),
    (".shade4", "#822e68", "#dc85a0"),
    (".shade5", "#652b7e", "#cc7fc9"),
    (".shade6", "#4b2a83", "#b582dc"),
    (".shade7", "#332a7e", "#9a88e5"),
    (".shade8", "#1b2a7a", "#7f8fee"),
    // The colour of a missed value replaces the colour of the curve.
    (".failed,.missed,.bad", "#b3261e", "#ff8a80"),
];

/// Number of distinct colours for lines.
pub(super) const HUES: usize = 7;
/// Number of shades of a sequential scale.
pub(super) const SHADES: usize = 9;

/// Style of a picture on a white background.
pub(in crate::report) fn picture_style() -> String {
    let colours = COLOURS.map(|(classes, light, _)| format!("{classes}{{color:{light}}}"));
    SHAPES.to_owned() + &colours.concat()
}

/// Styles of the charts of a page: light, dark, and light for printing.
pub(in crate::report) fn page_style() -> String {
    let rules = |root: &str, dark: bool| {
        let rule = |(classes, light, on_dark): &(&str, &str, &str)| {
            let within = classes
                .split(',')
                .map(|class| format!("{root}.chart {class}"));
            let within: Vec<String> = within.collect();
            let colour = if dark { on_dark } else { light };
            format!("{}{{color:{colour}}}", within.join(","))
        };
        COLOURS.iter().map(rule).collect::<String>()
    };
    let shapes = SHAPES.replace("}.", "}\n.");
    let shapes: String = shapes
        .lines()
        .map(|line| {
            let (selectors, looks) = line.split_once('{').unwrap_or((line, ""));
            let within: Vec<String> = selectors
                .split(',')
                .map(|s| format!(".chart {s}"))
                .collect();
            format!("{}{{{looks}", within.join(","))
        })
        .collect();
    format!(
        "{shapes}{}@media screen and (prefers-color-scheme:dark){{{}}}@media screen{{{}}}",
        rules("", false),
        rules(":root:not([data-theme=\"light\"]) ", true),
        rules(":root[data-theme=\"dark\"] ", true)
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::contrast::{contrast, luminance, mixed};

    /// Colours of curve labels are readable on paper and on the dark page.
    #[test]
    fn colours_can_be_read() {
        for (classes, light, dark) in COLOURS {
            let least = match classes {
                ".grid" => continue,
                ".frame,.leader" | ".zero" => 3.0,
                _ => 4.5,
            };
            assert!(contrast(light, "#ffffff") >= least, "{classes} {light}");
            assert!(contrast(dark, "#14171b") >= least, "{classes} {dark}");
        }
    }

    /// Lines that are pale can still be seen.
    #[test]
    fn pale_lines_can_be_seen() {
        for class in [".line.faint", ".line.fine"] {
            let looks = SHAPES.split('}').find(|rule| rule.contains(class));
            let opacity = looks.unwrap().split("opacity:").nth(1).unwrap();
            let opacity: f64 = opacity.split(';').next().unwrap().parse().unwrap();
            for (classes, light, dark) in COLOURS {
                if [".grid", ".frame,.leader", ".zero"].contains(&classes) {
                    continue;
                }
                for (colour, paper) in [(light, "#ffffff"), (dark, "#14171b")] {
                    let seen = contrast(&mixed(colour, paper, opacity), paper);
                    assert!(seen >= 3.0, "{class} {classes} on {paper}: {seen}");
                }
            }
        }
    }

    /// Along the colour scale of rack positions, each shade is darker than the previous one.
    #[test]
    fn shades_are_a_sequence() {
        let shades: Vec<f64> = (COLOURS.iter())
            .filter(|(class, ..)| class.starts_with(".shade"))
            .map(|(_, light, _)| luminance(light))
            .collect();
        assert_eq!(shades.len(), SHADES);
        assert!(shades.is_sorted_by(|a, b| a > b), "{shades:?}");
    }
}
