//! Contrast of two colours by WCAG 2.2, for tests of pages and charts.

/// Relative luminance (WCAG 2.2, from 0 for black to 1 for white) of a colour such as `#0b63c5`.
pub(crate) fn luminance(colour: &str) -> f64 {
    let part = |k: usize| {
        let value = u8::from_str_radix(&colour[k..k + 2], 16).unwrap();
        let share = f64::from(value) / 255.0;
        if share <= 0.040_45 {
            share / 12.92
        } else {
            ((share + 0.055) / 1.055).powf(2.4)
        }
    };
    0.2126 * part(1) + 0.7152 * part(3) + 0.0722 * part(5)
}

/// Contrast of two colours, from 1 to 21.
pub(crate) fn contrast(a: &str, b: &str) -> f64 {
    let [a, b] = [a, b].map(luminance);
    (a.max(b) + 0.05) / (a.min(b) + 0.05)
}

/// Resulting colour of a transparent colour on a background.
pub(crate) fn mixed(colour: &str, background: &str, opacity: f64) -> String {
    let part = |text: &str, k: usize| f64::from(u8::from_str_radix(&text[k..k + 2], 16).unwrap());
    let mix = |k| (opacity * part(colour, k) + (1.0 - opacity) * part(background, k)).round() as u8;
    format!("#{:02x}{:02x}{:02x}", mix(1), mix(3), mix(5))
}

/// Custom properties of a style with their colours: one map for each block that sets `--paper`, in the order of the
/// blocks.
pub(crate) fn palettes(style: &str) -> Vec<std::collections::BTreeMap<&str, &str>> {
    let blocks = style.split('}').filter_map(|rule| rule.rsplit_once('{'));
    blocks
        .map(|(_, block)| {
            let entries = block.split(';').filter_map(|entry| entry.split_once(':'));
            entries
                .map(|(name, value)| (name.trim(), value.trim()))
                .filter_map(|(name, value)| Some((name.strip_prefix("--")?, value)))
                .filter(|(_, value)| value.starts_with('#'))
                .collect::<std::collections::BTreeMap<_, _>>()
        })
        .filter(|palette| palette.contains_key("paper"))
        .collect()
}
