//! `index.html`: one self-contained page to look through a sweep, without a network or a server.

use serde_json::json;

use super::gallery::Gallery;
use super::tally::Tally;

/// The page without its data.
const TEMPLATE: &str = include_str!("page.html");

/// The page of a sweep, with its plots inside.
pub(super) fn page(name: &str, gallery: &Gallery, tally: &Tally, plots: [&str; 2]) -> String {
    let data = json!({
        "name": name,
        "fields": gallery.fields,
        "of": gallery.of,
        "every": gallery.every,
        "tally": tally,
        "variants": gallery.shown,
    });
    // Inside a script only "</" could end it.
    let data = data.to_string().replace("</", "<\\/");
    let figures: String = plots.iter().map(|svg| format!("<figure>{svg}</figure>\n")).collect();
    TEMPLATE
        .replace("<!--NAME-->", &escape(name))
        .replace("<!--PLOTS-->", &figures)
        .replace("/*DATA*/null", &data)
}

/// Text that cannot be taken for markup.
fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}
