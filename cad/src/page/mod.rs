//! `report.html`: one self-contained page of a set, offline: the assembly in 3D, the curve, the bill, the checks, downloads.

mod data;

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;

use crate::design::Design;
use crate::output::Manifest;
use crate::render::{View, render};
use crate::scene::{SceneError, assembled};
use pinswitch_model::FrictionCurve;

pub use data::{PageData, page_data};

const HTML: &str = include_str!("page.html");
const CSS: &str = include_str!("page.css");
const JS: &str = include_str!("page.js");
// Vendored builds, see vendor.md.
const THREE: &str = include_str!("three.min.js");
const UPLOT: &str = include_str!("uplot.min.js");
const UPLOT_CSS: &str = include_str!("uplot.min.css");

/// Width of the still picture that stands where there is no WebGL.
const STILL_WIDTH: u32 = 640;

/// A page cannot be made.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PageError {
    /// A body cannot be built.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// The data cannot be written as JSON, or the picture as PNG.
    #[error("cannot put the page together: {0}")]
    Encoding(String),
}

/// The page of a set. `live` is the version of a live preview that follows its configuration.
///
/// # Errors
/// [`PageError`] if a body cannot be built.
pub fn page_html(
    design: &Design,
    manifest: &Manifest,
    curve: &FrictionCurve,
    live: Option<u64>,
) -> Result<String, PageError> {
    // A live page is rebuilt while somebody waits, in a browser that has shown it already: no picture.
    let still = if live.is_some() { String::new() } else { still(design)? };
    let data = page_data(design, manifest, curve, live)?;
    let json = serde_json::to_string(&data).map_err(|e| PageError::Encoding(e.to_string()))?;
    let title = manifest.name.replace('&', "&amp;").replace('<', "&lt;");
    // The data last: nothing in it is taken for a place to fill in.
    let page = [
        ("{{TITLE}}", title.as_str()),
        ("{{UPLOT_CSS}}", UPLOT_CSS),
        ("{{CSS}}", CSS),
        ("{{THREE}}", THREE),
        ("{{UPLOT}}", UPLOT),
        ("{{JS}}", JS),
        ("{{STILL}}", &still),
        // In a script element only the end tag needs care.
        ("{{DATA}}", &json.replace("</", "<\\/")),
    ]
    .into_iter()
    .fold(HTML.to_owned(), |page, (place, content)| page.replacen(place, content, 1));
    Ok(page)
}

/// The parts pulled apart, as a data URL.
fn still(design: &Design) -> Result<String, PageError> {
    let view = View { turn_deg: 30.0, rise_deg: 40.0 };
    let picture = render(&assembled(design, 1.0)?, view, STILL_WIDTH, STILL_WIDTH * 3 / 4);
    let png = picture.png().map_err(|e| PageError::Encoding(e.to_string()))?;
    Ok(format!("data:image/png;base64,{}", STANDARD.encode(png)))
}
