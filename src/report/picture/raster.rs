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
    pixels
        .encode_png()
        .expect("writing to memory does not fail")
}
