//! `report.html`: a self-contained offline page of a set, with the assembly in 3D, curve, bill of materials, checks and
//! downloads.

mod data;
mod joint;

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;

use super::{Format, Inclusion};
use crate::built::Built;
use crate::documents::Manifest;
use crate::output::{OutputFile, SetError};
use crate::prediction::Prediction;
use crate::scene::exploded_png;
use pinswitch_report::html::{escape, filled, json_in_script, policy};

pub use data::PageData;

pub(super) const FORMAT: Format = Format {
    name: "page",
    about: "report.html: the assembly in 3D, the curve, tables, downloads",
    inclusion: Inclusion::Default,
    make,
};

fn make(built: &Built, prediction: &Prediction, manifest: &Manifest) -> Result<Vec<OutputFile>, SetError> {
    let data = PageData::new(built, prediction, manifest, None);
    let still = format!("data:image/png;base64,{}", STANDARD.encode(exploded_png(built)?));
    Ok(vec![OutputFile::new("report.html", page_html(&data, &still)?)])
}

const HTML: &str = include_str!("page.html");
const CONFIGURATOR: &str = "\n  <p><a href=\"/configure\">Edit in the configurator</a></p>";
const CSS: &str = include_str!("page.css");
const JS: &str = concat!("'use strict';\n", include_str!("assembly.js"), include_str!("page.js"));
/// The script of the 3D view, which the configurator also uses.
pub const ASSEMBLY: &str = include_str!("assembly.js");
// Vendored builds, see vendor.md.
/// Vendored three.js.
pub const THREE: &str = include_str!("three.min.js");
/// Vendored uPlot.
pub const UPLOT: &str = include_str!("uplot.min.js");
/// The style of uPlot.
pub const UPLOT_CSS: &str = include_str!("uplot.min.css");

/// Returns the page of `data`. `still` is the data URL of a picture for browsers without WebGL; a live preview does without
/// it.
///
/// # Errors
/// As [`PageData::json`].
pub fn page_html(data: &PageData, still: &str) -> Result<String, SetError> {
    let json = data.json()?;
    let (title, policy) = (escape(data.title()), page_policy());
    Ok(filled(HTML, |place| match place {
        "TITLE" => Some(title.as_str().into()),
        "UPLOT_CSS" => Some(UPLOT_CSS.into()),
        "CSS" => Some(CSS.into()),
        "THREE" => Some(THREE.into()),
        "UPLOT" => Some(UPLOT.into()),
        "JS" => Some(JS.into()),
        "STILL" => Some(still.into()),
        // Only a server has the configurator.
        "CONFIGURATOR" => Some(if data.is_live() { CONFIGURATOR } else { "" }.into()),
        "DATA" => Some(json_in_script(&json).into()),
        "POLICY" => Some(policy.as_str().into()),
        _ => None,
    }))
}

/// Returns the Content-Security-Policy of the page, saved or served: only its three scripts run.
#[must_use]
pub fn page_policy() -> String {
    policy(&[THREE, UPLOT, JS])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::read;
    use crate::design::Design;
    use crate::formats::named;
    use crate::set::Set;
    use crate::warnings::Warning;
    use pinswitch_diagnostic::codes;

    /// The text between `start` and the next `end`, and the rest.
    fn between<'a>(text: &'a str, start: &str, end: &str) -> (&'a str, &'a str) {
        text.split_once(start).and_then(|(_, rest)| rest.split_once(end)).unwrap()
    }

    #[test]
    fn text_of_a_configuration_is_escaped() {
        let text = "[label]\ntext = \"<!--<script>\"\n[switch]\nname = \"x_y\"";
        let (configuration, _) = read(text, "x.toml").unwrap();
        let built = Built::new(Design::new(configuration).unwrap()).unwrap();
        let prediction = Prediction::of(built.design());
        let mut manifest = Set::new(&built, &prediction, &named(&["stl"]).unwrap()).unwrap().manifest;
        let text = "<!--<script>{{JS}}{{DATA}}</script>";
        manifest.warnings.push(Warning::new(codes::THIN_PLACE, text));
        let data = PageData::new(&built, &prediction, &manifest, None);
        let page = page_html(&data, "").unwrap();
        let (json, rest) = between(&page, "id=\"data\">", "</script>");
        assert!(!json.contains('<') && json.contains("{{JS}}{{DATA}}"));
        let read: serde_json::Value = serde_json::from_str(json).unwrap();
        let warning = read["manifest"]["warnings"].as_array().unwrap().last().unwrap();
        assert_eq!(warning, "<!--<script>{{JS}}{{DATA}}</script>");
        // The scripts of the page are those of the policy.
        assert!(page.contains(&page_policy()));
        for script in [THREE, UPLOT, JS] {
            assert!(rest.contains(&format!("<script>{script}</script>")));
        }
    }
}
