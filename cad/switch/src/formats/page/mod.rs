//! `report.html`: one self-contained page of a set, offline: the assembly in 3D, the curve, the bill, the checks, downloads.

mod data;

use std::borrow::Cow;

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;

use super::{Format, Inclusion};
use crate::built::Built;
use crate::documents::Manifest;
use crate::output::{OutputFile, SetError};
use crate::prediction::Prediction;
use crate::scene::exploded_png;

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
const CSS: &str = include_str!("page.css");
const JS: &str = include_str!("page.js");
// Vendored builds, see vendor.md.
const THREE: &str = include_str!("three.min.js");
const UPLOT: &str = include_str!("uplot.min.js");
const UPLOT_CSS: &str = include_str!("uplot.min.css");

/// The page that shows `data`, with the data URL of a picture for browsers without WebGL. A live page needs none: it is
/// rebuilt while somebody waits, in a browser that has shown it already.
///
/// # Errors
/// [`SetError::Encoding`] for data that JSON cannot hold.
pub fn page_html(data: &PageData, still: &str) -> Result<String, SetError> {
    let json = data.json()?;
    let title = data.title().replace('&', "&amp;").replace('<', "&lt;");
    Ok(filled(HTML, |place| match place {
        "TITLE" => Some(title.as_str().into()),
        "UPLOT_CSS" => Some(UPLOT_CSS.into()),
        "CSS" => Some(CSS.into()),
        "THREE" => Some(THREE.into()),
        "UPLOT" => Some(UPLOT.into()),
        "JS" => Some(JS.into()),
        "STILL" => Some(still.into()),
        // In a script element only the end tag needs care.
        "DATA" => Some(json.replace("</", "<\\/").into()),
        _ => None,
    }))
}

/// `template` with every `{{PLACE}}` filled in, in one pass: what is filled in is not searched for places again.
fn filled<'a>(template: &'a str, content: impl Fn(&str) -> Option<Cow<'a, str>>) -> String {
    let mut page = String::new();
    let mut rest = template;
    while let Some((before, after)) = rest.split_once("{{") {
        page.push_str(before);
        match after.split_once("}}").and_then(|(place, after)| Some((content(place)?, after))) {
            Some((text, after)) => {
                page.push_str(&text);
                rest = after;
            }
            None => {
                page.push_str("{{");
                rest = after;
            }
        }
    }
    page + rest
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_filled_in_is_not_filled_again() {
        let content = |place: &str| match place {
            "A" => Some("{{B}}".into()),
            "B" => Some("b".into()),
            _ => None,
        };
        assert_eq!(filled("{{A}} {{B}} {{C}} {{", content), "{{B}} b {{C}} {{");
    }
}
