//! The plotting library in the page: plotly.js, as the crate `plotly` carries it.

/// The script of plotly.js.
pub(super) fn script() -> String {
    // The crate gives script elements: plotly.js first, then one for mathematical text, which no
    // label here needs.
    let elements = plotly::Plot::offline_js_sources();
    let start = elements.find('>').map_or(0, |i| i + 1);
    let end = elements.find("</script>").unwrap_or(elements.len());
    elements[start..end].to_owned()
}

/// The notice its licence asks for. Those of what it is made of are in the script's own comments.
pub(super) const NOTICE: &str = "plotly.js, Copyright 2012-2025 Plotly, Inc.

Permission is hereby granted, free of charge, to any person obtaining a copy of this software and \
associated documentation files (the \"Software\"), to deal in the Software without restriction, including \
without limitation the rights to use, copy, modify, merge, publish, distribute, sublicense, and/or sell \
copies of the Software, and to permit persons to whom the Software is furnished to do so, subject to the \
following conditions:

The above copyright notice and this permission notice shall be included in all copies or substantial \
portions of the Software.

THE SOFTWARE IS PROVIDED \"AS IS\", WITHOUT WARRANTY OF ANY KIND, EXPRESS OR IMPLIED, INCLUDING BUT NOT \
LIMITED TO THE WARRANTIES OF MERCHANTABILITY, FITNESS FOR A PARTICULAR PURPOSE AND NONINFRINGEMENT. IN NO \
EVENT SHALL THE AUTHORS OR COPYRIGHT HOLDERS BE LIABLE FOR ANY CLAIM, DAMAGES OR OTHER LIABILITY, WHETHER \
IN AN ACTION OF CONTRACT, TORT OR OTHERWISE, ARISING FROM, OUT OF OR IN CONNECTION WITH THE SOFTWARE OR \
THE USE OR OTHER DEALINGS IN THE SOFTWARE.";

#[cfg(test)]
mod tests {
    use super::*;

    /// A newer version of the crate must not slip in something else, or another licence.
    #[test]
    fn the_script_is_plotly_under_the_mit_licence() {
        let script = script();
        let head: String = script.chars().take(300).collect();
        assert!(head.contains("plotly.js v3."), "{head}");
        assert!(head.contains("Licensed under the MIT license"), "{head}");
        assert!(head.contains("Copyright 2012-2025, Plotly, Inc."), "{head}");
        assert!(script.len() < 5_000_000);
    }
}
