//! What the page shows of a design.

use pinswitch_switch::built::Built;
use pinswitch_switch::config::{Configuration, to_toml};
use pinswitch_switch::documents::plate_entries;
use pinswitch_switch::feasibility;
use pinswitch_switch::formats::page::PageData;
use pinswitch_switch::output::{BuildError, SetError};
use pinswitch_switch::prediction::Prediction;
use pinswitch_switch::set::Set;
use serde::Serialize;

use crate::kept::Kept;
use crate::request::{Asked, Quality};
use crate::trouble::Trouble;
use crate::values::configuration;

/// Chord tolerance of what is only looked at, in millimetres.
const COARSE_MM: f64 = 0.1;
/// Points of a curve that is only looked at.
const COARSE_POINTS: usize = 26;

/// A design as the page shows it, or what is wrong with it.
#[derive(Debug, Serialize)]
pub(crate) struct Shown {
    data: Option<PageData>,
    toml: Option<String>,
    trouble: Option<Trouble>,
}

/// The data of a design, its configuration as text, or its trouble.
pub(crate) fn answer(kept: &mut Kept, asked: &Asked, quality: Quality) -> Shown {
    match shown(kept, asked, quality) {
        Ok((data, toml)) => Shown { data: Some(data), toml: Some(toml), trouble: None },
        Err(trouble) => Shown { data: None, toml: None, trouble: Some(trouble) },
    }
}

fn shown(kept: &mut Kept, asked: &Asked, quality: Quality) -> Result<(PageData, String), Trouble> {
    let exact = configuration(&asked.values)?;
    let toml = to_toml(&exact);
    let mut seen = exact;
    if quality == Quality::Coarse {
        seen.mesh.chord_tolerance_mm = seen.mesh.chord_tolerance_mm.max(COARSE_MM);
        seen.friction.points = seen.friction.points.min(COARSE_POINTS);
    }
    let (built, prediction) = built(kept, seen, asked.model.as_deref())?;
    // What is looked at needs no files, which take longer than the parts.
    let mut set = Set::new(&built, &prediction, &[]).map_err(trouble)?;
    // As they lie in those that would be made.
    set.manifest.plates = plate_entries(&built);
    let data = PageData::new(&built, &prediction, &set.manifest, Some(1));
    if quality == Quality::Coarse {
        kept.built = Some(built);
    }
    Ok((data, toml))
}

/// The parts of a configuration and the curve, by the published constants or by a calibrated model, with what is `kept` where
/// it is the same.
pub(crate) fn built(
    kept: &mut Kept,
    configuration: Configuration,
    model: Option<&str>,
) -> Result<(Built, Prediction), Trouble> {
    let design = feasibility::design(configuration)?;
    let prediction = kept.predictions.of(&design, model)?;
    let built = feasibility::build_following(design, kept.built.as_ref(), &kept.caps)
        .map_err(|e| trouble(e.into()))?;
    Ok((built, prediction))
}

/// What is wrong with a set, at its field where it has one.
pub(crate) fn trouble(error: SetError) -> Trouble {
    match error {
        SetError::Build(BuildError::Configuration(error)) => error.into(),
        other => Trouble::general(other),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::{Value, json};

    /// Of every number of the configuration, changed a little, a design that follows another is told as one made anew.
    #[test]
    fn a_design_that_follows_another_is_told_as_one_made_anew() {
        let with = |path: &str, value: Value| {
            let base = [("layout.pins", json!([5, 8, 11])), ("friction.points", json!(3)), (path, value)];
            let values = base.into_iter().map(|(path, value)| (path.to_owned(), value)).collect();
            Asked { values, model: None }
        };
        let told = |kept: &mut Kept, asked: &Asked| {
            let shown = answer(kept, asked, Quality::Coarse);
            (shown.trouble.is_none(), serde_json::to_string(&shown).unwrap())
        };
        let mut kept = Kept::default();
        let mut compared = 0;
        for parameter in Configuration::PARAMETERS {
            let value = (parameter.get)(&Configuration::default()).to_string();
            let Ok(number) = value.parse::<f64>() else { continue };
            let new = [json!(number * 0.98), json!(number as i64 + 1)];
            for changed in new.map(|new| with(&parameter.path(), new)) {
                let (is_design, after) = told(&mut kept, &changed);
                assert_eq!(after, told(&mut Kept::default(), &changed).1, "{}", parameter.path());
                compared += usize::from(is_design);
            }
        }
        assert!(compared > 60, "{compared}");
    }
}
