//! A design as the page shows it.

use pinswitch_diagnostic::Diagnostic;
use pinswitch_switch::built::Built;
use pinswitch_switch::config::{Configuration, to_toml};
use pinswitch_switch::documents::plate_entries;
use pinswitch_switch::feasibility;
use pinswitch_switch::formats::page::PageData;
use pinswitch_switch::output::{BuildError, SetError};
use pinswitch_switch::prediction::Prediction;
use pinswitch_switch::set::Set;
use serde::Serialize;

use crate::cache::Cache;
use crate::refusal::Refusal;
use crate::request::{DesignRequest, Quality};
use crate::values::configuration;

/// Least chord tolerance of a coarse design, in millimetres.
const COARSE_MM: f64 = 0.1;
/// Most points on the curve of a coarse design.
const COARSE_POINTS: usize = 26;

/// The data of a design with its configuration as TOML, or why it is refused.
#[derive(Debug, Serialize)]
pub(crate) struct ShownDesign {
    data: Option<PageData>,
    toml: Option<String>,
    trouble: Option<Refusal>,
}

/// Builds what the page shows of a design.
pub(crate) fn answer(cache: &mut Cache, request: &DesignRequest, quality: Quality) -> ShownDesign {
    match page_data(cache, request, quality) {
        Ok((data, toml)) => ShownDesign { data: Some(data), toml: Some(toml), trouble: None },
        Err(refusal) => ShownDesign { data: None, toml: None, trouble: Some(refusal) },
    }
}

fn page_data(
    cache: &mut Cache,
    request: &DesignRequest,
    quality: Quality,
) -> Result<(PageData, String), Refusal> {
    let exact = configuration(&request.values)?;
    let toml = to_toml(&exact);
    let mut shown = exact;
    if quality == Quality::Coarse {
        shown.mesh.chord_tolerance_mm = shown.mesh.chord_tolerance_mm.max(COARSE_MM);
        shown.friction.points = shown.friction.points.min(COARSE_POINTS);
    }
    let (built, prediction) = build(cache, shown, request.model.as_deref())?;
    // Files take longer than the parts, and the page does not show them.
    let mut set = Set::new(&built, &prediction, &[]).map_err(set_refusal)?;
    // The plates of the files, so that the page shows the same arrangement.
    set.manifest.plates = plate_entries(&built);
    let data = PageData::new(&built, &prediction, &set.manifest);
    if quality == Quality::Coarse {
        cache.built = Some(built);
    }
    Ok((data, toml))
}

/// Builds the parts of a configuration and predicts its curve, by the published constants or by the
/// text of a calibrated model. Results in the cache are reused.
pub(crate) fn build(
    cache: &mut Cache,
    configuration: Configuration,
    model: Option<&str>,
) -> Result<(Built, Prediction), Refusal> {
    let design = feasibility::design(configuration)?;
    let prediction = cache.predictions.predict(&design, model)?;
    let built = feasibility::build_following(design, cache.built.as_ref(), &cache.caps)
        .map_err(|e| set_refusal(e.into()))?;
    Ok((built, prediction))
}

/// Returns why a set is refused, at its field if it has one.
pub(crate) fn set_refusal(error: SetError) -> Refusal {
    match error {
        SetError::Build(BuildError::Configuration(error)) => error.into(),
        other => Diagnostic::from(other).into(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::{Value, json};

    /// Each number of the configuration is changed a little: a design after another equals the same
    /// design alone.
    #[test]
    fn cached_parts_equal_new_parts() {
        let with = |path: &str, value: Value| {
            let base = [("layout.pins", json!([5, 8, 11])), ("friction.points", json!(3)), (path, value)];
            let values = base.into_iter().map(|(path, value)| (path.to_owned(), value)).collect();
            DesignRequest { values, model: None }
        };
        let shown = |cache: &mut Cache, request: &DesignRequest| {
            let shown = answer(cache, request, Quality::Coarse);
            (shown.trouble.is_none(), serde_json::to_string(&shown).unwrap())
        };
        let mut cache = Cache::default();
        let mut compared = 0;
        for parameter in Configuration::PARAMETERS {
            let value = (parameter.get)(&Configuration::default()).to_string();
            let Ok(number) = value.parse::<f64>() else { continue };
            let new = [json!(number * 0.98), json!(number as i64 + 1)];
            for changed in new.map(|new| with(&parameter.path(), new)) {
                let (is_design, after) = shown(&mut cache, &changed);
                assert_eq!(after, shown(&mut Cache::default(), &changed).1, "{}", parameter.path());
                compared += usize::from(is_design);
            }
        }
        assert!(compared > 60, "{compared}");
    }
}
