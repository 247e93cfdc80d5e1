//! A picture as pixels.

use resvg::tiny_skia::{Pixmap, Transform};
use resvg::usvg::{Options, Tree};

/// Pixels per unit of length of the SVG.
const SCALE: f32 = 2.0;

/// Draws a picture without text as PNG.
///
/// # Panics
///
/// If the text is not an SVG, or the SVG has no size. The pictures of this program are SVGs with a size.
pub(super) fn png(svg: &str) -> Vec<u8> {
    let tree = Tree::from_str(svg, &Options::default()).expect("SVG of this program is valid");
    let size = tree.size().to_int_size().scale_by(SCALE);
    let size = size.expect("the picture has a size");
    let mut pixels =
        Pixmap::new(size.width(), size.height()).expect("the picture fits into memory");
    let scale = Transform::from_scale(SCALE, SCALE);
    resvg::render(&tree, scale, &mut pixels.as_mut());
    encoded(pixels).expect("writing to memory does not fail")
}

/// Encodes pixels as PNG. Drawings consist of areas with one colour, which compress well without filters. The search for the
/// best filter of each line would take most of the time of a picture.
fn encoded(pixels: Pixmap) -> Result<Vec<u8>, png::EncodingError> {
    let mut file = Vec::new();
    let mut encoder = png::Encoder::new(&mut file, pixels.width(), pixels.height());
    encoder.set_color(png::ColorType::Rgba);
    encoder.set_filter(png::Filter::NoFilter);
    let mut writer = encoder.write_header()?;
    writer.write_image_data(&pixels.take_demultiplied())?;
    writer.finish()?;
    Ok(file)
}
