//! Plans as TOML.

use pinswitch_calibration::effects::Vocabulary;
use pinswitch_calibration::toml_error;

use super::error::PlanError;
use super::rig_plan::Plan;

impl Plan {
    /// Reads a plan. `file` is the name used in errors.
    ///
    /// # Errors
    /// [`PlanError`] at the first field that cannot be used.
    pub fn parse(text: &str, file: &str) -> Result<Self, PlanError> {
        Self::parse_among(text, file, &Vocabulary::built_in())
    }

    /// Reads a plan whose effects are those of a vocabulary. `file` is the name used in errors.
    ///
    /// # Errors
    /// [`PlanError`] at the first field that cannot be used.
    pub fn parse_among(text: &str, file: &str, vocabulary: &Vocabulary) -> Result<Self, PlanError> {
        let plan: Self = toml::from_str(text).map_err(|e| {
            let (file, mut problem) = toml_error(file, text, &e);
            if problem.contains("unit variant") {
                problem += "; a kind has its numbers beside it, as kind.resonance = { speed_pct = 52, width_pct = 2 }";
            }
            PlanError::Malformed { file, problem }
        })?;
        let plan = Self { vocabulary: vocabulary.clone(), ..plan };
        plan.check(file)?;
        Ok(plan)
    }

    /// The plan's text.
    ///
    /// # Errors
    /// [`PlanError::Malformed`] if a value cannot be written as TOML.
    pub fn to_text(&self) -> Result<String, PlanError> {
        toml::to_string(self)
            .map_err(|e| PlanError::Malformed { file: "plan.toml".to_owned(), problem: e.to_string() })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_plan_names_what_it_cannot_use() {
        let cases = [
            ("weights_g = []", "weights_g"),
            ("layouts = [[16]]", "layouts"),
            ("layouts = [[5, 5]]", "each occupied groove once"),
            ("weights_g = [1e300]", "up to 1000000"),
            ("repetitions_spread = 4000000000", "repetitions_spread"),
            (
                "repetitions = [1000, 1000]\nrepetitions_spread = 1000\nlayouts = [[1], [2], [3], [4], [5], [6]]",
                "rows is outside",
            ),
            ("[constants]\nmu_p = inf", "mu_p inf"),
            ("[constants]\nsteepness = [nan]", "steepness [NaN]"),
            ("[[effects]]\nid = \"coating_ploughing\"\nvalues = [nan]", "effects = [[NaN]]"),
            ("[noise]\nmislabelled_series = 4000000000", "mislabelled_series"),
            ("[noise]\noutlier_share = 2", "noise shares"),
            ("[noise]\nseries_scale = 0.6", "noise.series_scale = 0.6 is outside 0..0.5"),
            ("[noise]\nmount_scale = -0.01", "noise.mount_scale"),
            ("[noise]\nseries_common_N = -1", "noise.series_common_N"),
            ("[noise]\nseries_walk = 1.0", "noise.series_walk"),
            ("[noise]\nresolution_N = nan", "noise.resolution_N"),
            ("shuffled = true", "shuffled"),
            ("[[disturbances]]\nsize = inf\nkind.step.at = 0.5", "disturbances"),
            ("[[disturbances]]\nsize = 0.4\nkind.memory.repetitions = 0", "disturbances: memory.repetitions"),
            ("[[disturbances]]\nsize = 0.4\nkind.operators.turns = \"series\"", "disturbances: target"),
            ("[columns]\nspecimen = true", "unknown field"),
            ("[[effects]]\nid = \"gravity\"", "known are"),
            ("[[effects]]\nid = \"run_in\"\nvalues = [1]", "3 value(s): k, r0, c"),
            ("colour = 1", "unknown field"),
        ];
        for (text, expected) in cases {
            let error = Plan::parse(text, "plan.toml").unwrap_err().to_string();
            assert!(error.contains(expected) && error.starts_with("plan.toml"), "{error}");
        }
        assert_eq!(Plan::parse("", "plan.toml").unwrap(), Plan::default());
    }

    /// The text of a plan without scatter is what it was before there were keys for it.
    #[test]
    fn keys_of_scatter_are_written_only_where_they_say_something() {
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
