//! The page: what a person sees of a switch in a browser, in three states.
//!
//! - A *published file* contains the engine as a WebAssembly module.
//! - *Served* by `pinswitch view`, it asks the server.
//! - As a *report*, `report.html` of a set, it is read only, and contains the answers.
//!
//! The files of the page are in `cad/switch/page`, the engine is in `cad/app`.

mod data;
mod fields;
mod html;
mod joint;

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use pinswitch_friction::Law;
use serde::Serialize;

use super::{Format, Inclusion};
use crate::built::Built;
use crate::config::to_toml;
use crate::documents::Manifest;
use crate::output::{OutputFile, SetError};
use crate::prediction::Prediction;
use crate::scene::exploded_png;

pub use data::PageData;
pub use fields::{Field, Values, changed_values, fields};
pub use html::{PackedModule, PageState, RecordedSet, SHARED_TEXTS, worker_script};

pub(super) const FORMAT: Format = Format {
    name: "page",
    about: "report.html: the assembly in 3D, the curve, tables, downloads",
    inclusion: Inclusion::Default,
    make,
};

/// Answers to the requests of a report.
#[derive(Serialize)]
struct RecordedAnswers<'a> {
    facts: RecordedFacts<'a>,
    design: RecordedDesign<'a>,
}

/// What the page needs once. A report starts no other design, so that it needs neither templates nor formats.
#[derive(Serialize)]
struct RecordedFacts<'a> {
    generator: &'a str,
    fields: Vec<Field>,
    templates: [(); 0],
    formats: [(); 0],
    largest_table_mb: usize,
    state: RecordedState,
}

/// The state that a report shows.
#[derive(Serialize)]
struct RecordedState {
    values: Values,
    /// The model of a calibration that made the curve.
    model: Option<RecordedModel>,
}

#[derive(Serialize)]
struct RecordedModel {
    name: &'static str,
}

/// The design of the set, as the engine answers it.
#[derive(Serialize)]
struct RecordedDesign<'a> {
    data: &'a PageData,
    toml: String,
    /// Why it is refused: a set that was written is not.
    trouble: Option<()>,
}

fn make(built: &Built, prediction: &Prediction, manifest: &Manifest) -> Result<Vec<OutputFile>, SetError> {
    let data = PageData::new(built, prediction, manifest);
    let configuration = built.design().configuration();
    let is_calibrated = prediction.curve.law == Law::Calibrated;
    let answers = RecordedAnswers {
        facts: RecordedFacts {
            generator: &manifest.generator,
            fields: fields(),
            templates: [],
            formats: [],
            largest_table_mb: 0,
            state: RecordedState {
                values: changed_values(configuration),
                model: is_calibrated.then_some(RecordedModel { name: "model.toml" }),
            },
        },
        design: RecordedDesign { data: &data, toml: to_toml(configuration), trouble: None },
    };
    let recorded = RecordedSet {
        title: manifest.name.clone(),
        answers: serde_json::to_string(&answers).map_err(SetError::encoding)?,
        still: format!("data:image/png;base64,{}", STANDARD.encode(exploded_png(built)?)),
    };
    Ok(vec![OutputFile::new("report.html", PageState::Report(&recorded).html())])
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

    /// The text between `start` and the next `end`.
    fn between<'a>(text: &'a str, start: &str, end: &str) -> &'a str {
        text.split_once(start).and_then(|(_, rest)| rest.split_once(end)).unwrap().0
    }

    #[test]
    fn text_of_a_configuration_is_escaped() {
        let text = "[label]\ntext = \"<!--<script>\"\n[switch]\nname = \"x_y\"";
        let (configuration, _) = read(text, "x.toml").unwrap();
        let built = Built::new(Design::new(configuration).unwrap()).unwrap();
        let prediction = Prediction::of(built.design());
        let mut manifest = Set::new(&built, &prediction, &named(&["stl"]).unwrap()).unwrap().manifest;
        let text = "<!--<script>{{JS}}{{REPORT}}</script>";
        manifest.warnings.push(Warning::new(codes::THIN_PLACE, text));
        let files = make(&built, &prediction, &manifest).unwrap();
        let page = std::str::from_utf8(&files[0].bytes).unwrap();
        let json = between(page, "id=\"report\">", "</script>");
        assert!(!json.contains('<') && json.contains("{{JS}}{{REPORT}}"));
        let read: serde_json::Value = serde_json::from_str(json).unwrap();
        let warning = read["design"]["data"]["manifest"]["warnings"].as_array().unwrap().last().unwrap();
        assert_eq!(warning, text);
        assert_eq!(read["facts"]["state"]["values"]["label.text"], "<!--<script>");
        assert!(read["design"]["toml"].as_str().unwrap().contains("<!--<script>"));
    }
}
