//! `index.html`: one self-contained page to browse a sweep without a network or a server.

use pinswitch_report::html::{escape, filled, json_in_script, policy};
use serde_json::json;

use super::gallery::Gallery;
use super::tally::Tally;

/// The page's HTML with placeholders.
const TEMPLATE: &str = include_str!("page.html");
/// The page's script.
const JS: &str = include_str!("page.js");

/// Returns the page of a sweep with its plots.
pub(super) fn page(name: &str, gallery: &Gallery, tally: &Tally, plots: [&str; 2]) -> String {
    let data = json!({
        "name": name,
        "fields": gallery.fields,
        "of": gallery.of,
        "every": gallery.every,
        "tally": tally,
        "variants": gallery.shown,
    });
    let data = json_in_script(&data.to_string());
    let figures: String = plots.iter().map(|svg| format!("<figure>{svg}</figure>\n")).collect();
    let (name, policy) = (escape(name), policy(&[JS]));
    filled(TEMPLATE, |place| match place {
        "NAME" => Some(name.as_str().into()),
        "POLICY" => Some(policy.as_str().into()),
        "PLOTS" => Some(figures.as_str().into()),
        "DATA" => Some(data.as_str().into()),
        "JS" => Some(JS.into()),
        _ => None,
    })
}
