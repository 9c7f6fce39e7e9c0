//! Plans as TOML.

use std::ops::Range;

use pinswitch_calibration::effects::Vocabulary;
use pinswitch_calibration::toml_error;
use pinswitch_diagnostic::{Diagnostic, Location, codes};
use toml::de::{DeTable, DeValue};

use super::rig_plan::Plan;

impl Plan {
    /// Reads a plan whose effects are built in; `file` is the file's name in errors.
    ///
    /// # Errors
    /// A [`Diagnostic`] at the first invalid field, with its line.
    pub fn parse(text: &str, file: &str) -> Result<Self, Diagnostic> {
        Self::parse_among(text, file, &Vocabulary::built_in())
    }

    /// Reads a plan whose effects are those of a vocabulary; `file` is the file's name in errors.
    ///
    /// # Errors
    /// A [`Diagnostic`] at the first invalid field, with its line.
    pub fn parse_among(text: &str, file: &str, vocabulary: &Vocabulary) -> Result<Self, Diagnostic> {
        let plan: Self = toml::from_str(text).map_err(|error| syntax_error(text, file, &error))?;
        let plan = Self { vocabulary: vocabulary.clone(), ..plan };
        plan.check_fields().map_err(|error| located(error, text, file))?;
        Ok(plan)
    }

    /// Returns the plan as TOML.
    ///
    /// # Errors
    /// A [`Diagnostic`] if TOML cannot represent a value.
    pub fn to_text(&self) -> Result<String, Diagnostic> {
        toml::to_string(self).map_err(|error| {
            Diagnostic::new(codes::INTERNAL_ERROR, "the plan has no form in TOML").with_source(error)
        })
    }
}

/// An error of the TOML reader: not TOML, an unknown key, or a value of a wrong type.
fn syntax_error(text: &str, file: &str, error: &toml::de::Error) -> Diagnostic {
    let diagnostic = toml_error(file, text, error);
    let help = if diagnostic.problem().contains("unit variant") {
        "give a kind its values in a table: kind.resonance = { speed_pct = 52, width_pct = 2 }"
    } else {
        "see model/doc/file-formats.md for the keys of a plan"
    };
    diagnostic.with_help(help)
}

/// The same error with the line of its field, if the text has that field.
fn located(error: Diagnostic, text: &str, file: &str) -> Diagnostic {
    let Some(Location { field: Some(field), value: Some(value), .. }) = error.location().cloned() else {
        return error.or_in_file(file);
    };
    match value_span(text, &field) {
        Some(span) => error.with_location(Location::in_text(file, text, span).with_field(field, value)),
        None => error.or_in_file(file),
    }
}

/// Bytes of the value of a field such as `noise.series_N` or `effects[0].values[1]`; those of the
/// innermost table or list that the text has, if it does not have the whole path.
fn value_span(text: &str, field: &str) -> Option<Range<usize>> {
    let root = DeTable::parse(text).ok()?;
    let mut steps = field.split(['.', '[', ']']).filter(|step| !step.is_empty());
    let mut value = root.get_ref().get(steps.next()?)?;
    for step in steps {
        let inner = match value.get_ref() {
            DeValue::Table(table) => table.get(step),
            DeValue::Array(items) => step.parse().ok().and_then(|index: usize| items.get(index)),
            _ => None,
        };
        match inner {
            Some(inner) => value = inner,
            None => break,
        }
    }
    Some(value.span())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn invalid_plans_are_located() {
        let cases = [
            ("weights_g = []", "plan.toml:1:13: weights_g = []: must be 1 to 1000 numbers"),
            ("layouts = [[3], [16]]", "plan.toml:1:17: layouts[1] = [16]"),
            ("layouts = [[5, 5]]", "each occupied groove once"),
            ("weights_g = [1e300]", "up to 1000000"),
            ("repetitions_spread = 4000000000", "repetitions_spread = 4000000000: must be at most 1000"),
            (
                "repetitions = [1000, 1000]\nrepetitions_spread = 1000\nlayouts = [[1], [2], [3], [4], [5], [6]]",
                "the plan makes up to 1144000 rows",
            ),
            ("[constants]\nmu_p = inf", "plan.toml:2:8: constants.mu_p = inf: must be from 0 to 10"),
            ("[constants]\nsteepness = [nan]", "plan.toml:2:14: constants.steepness[0] = NaN"),
            (
                "[[effects]]\nid = \"coating_ploughing\"\nvalues = [nan]",
                "plan.toml:3:11: effects[0].values[0] = NaN",
            ),
            ("[noise]\nmislabelled_series = 4000000000", "noise.mislabelled_series"),
            ("[noise]\noutlier_share = 2", "noise.outlier_share = 2: must be from 0 to 0.9"),
            ("[noise]\nseries_scale = 0.6", "noise.series_scale = 0.6: must be from 0 to 0.5"),
            ("[noise]\nmount_scale = -0.01", "noise.mount_scale"),
            ("[noise]\nseries_common_N = -1", "noise.series_common_N"),
            ("[noise]\nseries_walk = 1.0", "noise.series_walk"),
            ("[noise]\nresolution_N = nan", "noise.resolution_N"),
            ("shuffled = true", "shuffled"),
            (
                "[[disturbances]]\nsize = inf\nkind.step.at = 0.5",
                "plan.toml:2:8: disturbances[0].size = inf: must be from -1000 to 1000",
            ),
            (
                "[[disturbances]]\nsize = 0.1\nkind.spot = { at = 0.5, width = 0 }",
                "disturbances[0].kind.spot.width = 0: must be above 0",
            ),
            (
                "[[disturbances]]\nsize = 0.4\nkind.memory.repetitions = 0",
                "plan.toml:3:27: disturbances[0].kind.memory.repetitions = 0",
            ),
            (
                "[[disturbances]]\nsize = 0.4\nkind.operators.turns = \"series\"",
                "disturbances[0].target = \"friction\"",
            ),
            ("[columns]\nspecimen = true", "unknown field"),
            ("[[effects]]\nid = \"gravity\"", "use one of"),
            ("[[effects]]\nid = \"run_in\"\nvalues = [1]", "run_in needs 3 values (k, r0, c), found 1"),
            (
                "[[effects]]\nid = \"run_in\"\nvalues = [0.2, 2.0, 1.0, 0.0, 1.0]",
                "run_in needs 3 values (k, r0, c), found 5",
            ),
            ("colour = 1", "plan.toml:1:1: unknown field"),
        ];
        for (text, expected) in cases {
            let error = Plan::parse(text, "plan.toml").unwrap_err();
            let shown = error.to_string();
            assert!(shown.contains(expected) && shown.starts_with("plan.toml:"), "{shown}");
            assert!(error.help().is_some() || shown.contains("use one of"), "{shown}");
        }
        assert_eq!(Plan::parse("", "plan.toml").unwrap(), Plan::default());
    }

    /// The text of a plan has the optional keys only if they differ from their defaults.
    #[test]
    fn default_values_are_not_written() {
        let text = Plan::default().to_text().unwrap();
        for key in ["scale", "common", "walk", "resolution", "shuffled", "columns"] {
            assert!(!text.contains(key), "{key}");
        }
        let mut plan = Plan { shuffled: true, ..Plan::randomised() };
        (plan.noise.mount_scale, plan.columns.operator) = (0.02, true);
        let text = plan.to_text().unwrap();
        assert_eq!(Plan::parse(&text, "plan.toml").unwrap(), plan, "{text}");
    }
}
