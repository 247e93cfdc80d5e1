//! Files of the page.

use super::http::Response;

/// Returns a file of the page by its name in the address.
pub(super) fn file(name: &str) -> Option<Response> {
    const SCRIPT: &str = "text/javascript; charset=utf-8";
    let (content_type, text) = match name {
        "" => ("text/html; charset=utf-8", include_str!("page/index.html")),
        "start.html" => ("text/html; charset=utf-8", include_str!("page/start.html")),
        "start.js" => (SCRIPT, include_str!("page/start.js")),
        "style.css" => ("text/css; charset=utf-8", include_str!("page/style.css")),
        "icon.svg" => ("image/svg+xml", include_str!("page/icon.svg")),
        "main.js" => (SCRIPT, include_str!("page/main.js")),
        "server.js" => (SCRIPT, include_str!("page/server.js")),
        "design.js" => (SCRIPT, include_str!("page/design.js")),
        "cases.js" => (SCRIPT, include_str!("page/cases.js")),
        "draw.js" => (SCRIPT, include_str!("page/draw.js")),
        "speech.js" => (SCRIPT, include_str!("page/speech.js")),
        "views.js" => (SCRIPT, include_str!("page/views.js")),
        "curves.js" => (SCRIPT, include_str!("page/curves.js")),
        "frame.js" => (SCRIPT, include_str!("page/frame.js")),
        "table.js" => (SCRIPT, include_str!("page/table.js")),
        "notes.js" => (SCRIPT, include_str!("page/notes.js")),
        "tuning.js" => (SCRIPT, include_str!("page/tuning.js")),
        "files.js" => (SCRIPT, include_str!("page/files.js")),
        "changes.js" => (SCRIPT, include_str!("page/changes.js")),
        "deviation.js" => (SCRIPT, include_str!("page/deviation.js")),
        "dialog.js" => (SCRIPT, include_str!("page/dialog.js")),
        "handles.js" => (SCRIPT, include_str!("page/handles.js")),
        "history.js" => (SCRIPT, include_str!("page/history.js")),
        "layout.js" => (SCRIPT, include_str!("page/layout.js")),
        "targets.js" => (SCRIPT, include_str!("page/targets.js")),
        "mechanism_view.js" => (SCRIPT, include_str!("page/mechanism_view.js")),
        "space.js" => (SCRIPT, include_str!("page/space.js")),
        _ => return None,
    };
    Some(Response::new(200, content_type, text.as_bytes()))
}
