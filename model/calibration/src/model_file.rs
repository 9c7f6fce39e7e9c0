//! `baseline.toml` and `model.toml`: a fitted model that predicts rows later.

use pinswitch_diagnostic::excerpt;
use pinswitch_friction::published;
use serde::{Deserialize, Serialize};

use crate::beyond_range::error_beyond_range;
use crate::effects::{Shape, Side, Structure, Vocabulary, effects_of_model, own_effect_blocks};
use crate::inference::{
    Fit, Model, Noise, Observations, Term, Weighed, coordinate_covariance, prediction_sd_n,
};
use crate::model_check::{
    Flaw, check_beyond_range, check_constants, check_covariance, check_finite, check_frame, check_noise,
    walk_to_offset,
};
use crate::table::{Frame, PlateauRow};
use crate::toml_text::{place_of, toml_error};

/// Name and version of the format.
const SCHEMA: &str = "pinswitch.model/1";

/// Why a model file cannot be used.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ModelFileError {
    /// The text is no such TOML.
    #[error("{file}: {}; use the file as `calibrate` wrote it, or calibrate again", excerpt(problem, 240))]
    Malformed {
        /// File name as given, with the line.
        file: String,
        /// What is wrong.
        problem: String,
    },
    /// Another format or version.
    #[error("{file}: schema '{}' is unknown; this version reads '{SCHEMA}'", excerpt(found, 80))]
    Schema {
        /// File name as given.
        file: String,
        /// The schema found.
        found: String,
    },
    /// An effect that the library does not have.
    #[error("{file}: effect '{}' is unknown; use the ids of the effect vocabulary", excerpt(id, 80))]
    Effect {
        /// File name as given.
        file: String,
        /// The id found.
        id: String,
    },
    /// A value that no calibration writes.
    #[error(
        "{file}: {} = {} is out of bounds ({}); use the file as `calibrate` wrote it, or calibrate again",
        excerpt(field, 100),
        excerpt(value, 100),
        excerpt(bound, 160)
    )]
    Value {
        /// File name as given, with the line.
        file: String,
        /// Where it stands.
        field: String,
        /// What stands there.
        value: String,
        /// What may stand there.
        bound: String,
    },
    /// The constants do not belong to the terms.
    #[error("{file}: {found} constants, the terms listed need {needed} finite ones; calibrate again")]
    Constants {
        /// File name as given.
        file: String,
        /// How many there are.
        found: usize,
        /// How many are needed.
        needed: usize,
    },
}

impl ModelFileError {
    /// The flaw of a file.
    pub(crate) fn of(file: &str) -> impl Fn(Flaw) -> Self + '_ {
        |Flaw { field, value, bound }| Self::Value { file: file.to_owned(), field, value, bound }
    }

    /// The error with the line of its field.
    fn placed(mut self, name: &str, text: &str) -> Self {
        match &mut self {
            Self::Value { file, field, .. } => *file = place_of(name, text, field),
            Self::Constants { file, .. } => *file = place_of(name, text, "constants"),
            Self::Effect { file, .. } => *file = place_of(name, text, "terms"),
            Self::Malformed { .. } | Self::Schema { .. } => {}
        }
        self
    }
}

/// One term as it is written.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct TermEntry {
    id: String,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    side: Option<String>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    formula: Option<String>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    structure: Option<Structure>,
}

/// One constant as it is written.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Constant {
    name: String,
    value: f64,
    unit: String,
}

/// A model on file.
///
/// ```
/// use pinswitch_calibration::inference::Levels;
/// use pinswitch_calibration::table::PlateauTable;
/// use pinswitch_calibration::{ModelFile, calibrate};
///
/// // `csv` is the text of a plateau table, as for `calibrate`.
/// # let mut csv = "series,substrate,pins,sweep,load_mass_g,load_N,speed_pct,dwell_s,direction,repetition,position_mm,time_s,force_N\n".to_owned();
/// # let mut time_s = 0.0;
/// # for (series, load_n) in (0..12).map(|i| (i, 3.0 + 4.0 * f64::from(i))) {
/// #     for (direction, sign) in [("eccentric", -1.0), ("concentric", 1.0)] {
/// #         for repetition in 1..=6 {
/// #             time_s += 3.5;
/// #             let noise = 0.05 * (43758.5453 * (12.9898f64 * time_s).sin()).fract();
/// #             let force_n = load_n * (sign * 0.24 * 1.115_f64).exp() + noise;
/// #             csv += &format!("{series},silicone,,up,0,{load_n},50,3,{direction},{repetition},{},{time_s},{force_n}\n", 10 * repetition);
/// #         }
/// #     }
/// # }
/// let table = PlateauTable::read(csv.as_bytes(), "plateaus.csv")?;
/// let found = calibrate(&table.rows, Levels::default())?;
/// let text = ModelFile::new(&found.selection.augmented, &found.data, found.selection.noise).to_text()?;
///
/// let model = ModelFile::parse(&text, "model.toml")?;
/// let (predicted_n, sd_n) = model.predict(&table.rows[..1], "model.toml")?;
/// assert!((predicted_n[0] - table.rows[0].force_n).abs() < 5.0 * sd_n[0]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ModelFile {
    schema: String,
    constants: Vec<Constant>,
    #[serde(default)]
    terms: Vec<TermEntry>,
    noise: Noise,
    /// Growth of the error with the distance from the loads fitted, in newtons per newton.
    #[serde(default)]
    beyond_range: f64,
    frame: Frame,
    /// Covariance of the constants' coordinates, row by row.
    covariance: Vec<Vec<f64>>,
    /// The effects that the terms name; those of one's own stand in the file as in a file of theirs.
    #[serde(skip)]
    vocabulary: Vocabulary,
}

/// Whether a term says something of operators.
fn knows_operators(term: &Term, vocabulary: &Vocabulary) -> bool {
    match term {
        Term::Structure(structure) => matches!(structure.form, Shape::OperatorIs { .. }),
        Term::Named(effect) => vocabulary
            .own()
            .any(|own| own.definition().id == effect.id() && own.definition().formula.contains("operator")),
    }
}

impl ModelFile {
    /// The file of a fit.
    pub fn new(fitted: &Fit, data: &Observations, noise: Noise) -> Self {
        let model = &fitted.model;
        let data = &data.compacted();
        let weighed = Weighed::new(data, noise);
        let covariance = coordinate_covariance(fitted, &weighed);
        let beyond_range = error_beyond_range(model, &weighed);
        let mut frame = model.frame.clone();
        if frame.changes.is_empty() {
            // Nothing of the model depends on who they were.
            (frame.sessions, frame.specimens) = (Vec::new(), Vec::new());
        }
        if !model.terms.iter().any(|term| knows_operators(term, &model.vocabulary)) {
            frame.operators = Vec::new();
        }
        let used = |id: &str| model.terms.iter().any(|term| term.id() == id);
        Self {
            schema: SCHEMA.to_owned(),
            constants: model
                .names()
                .into_iter()
                .zip(model.values())
                .map(|((name, unit), value)| Constant { name, value, unit: unit.to_owned() })
                .collect(),
            terms: model
                .terms
                .iter()
                .map(|term| match term {
                    Term::Named(effect) => TermEntry {
                        id: effect.id().to_owned(),
                        side: Some(effect.description().side.as_str().to_owned()),
                        formula: Some(effect.cited_formula()),
                        structure: None,
                    },
                    Term::Structure(structure) => TermEntry {
                        id: term.id().to_owned(),
                        side: None,
                        formula: Some(structure.describe(&model.frame)),
                        structure: Some(structure.clone()),
                    },
                })
                .collect(),
            noise,
            beyond_range,
            frame,
            covariance: (0..covariance.nrows())
                .map(|i| covariance.row(i).iter().copied().collect())
                .collect(),
            vocabulary: model.vocabulary.retaining(|own| used(&own.definition().id)),
        }
    }

    /// Reads a file's text. `file` is the name used in errors.
    ///
    /// # Errors
    /// [`ModelFileError`] if the text is no model of this version.
    pub fn parse(text: &str, file: &str) -> Result<Self, ModelFileError> {
        let malformed = |e: toml::de::Error| {
            let (file, problem) = toml_error(file, text, &e);
            ModelFileError::Malformed { file, problem }
        };
        let placed = |flaw: Flaw| ModelFileError::of(&place_of(file, text, &flaw.field))(flaw);
        let mut table: toml::Table = toml::from_str(text).map_err(malformed)?;
        check_finite("", &toml::Value::Table(table.clone())).map_err(placed)?;
        let is_earlier = walk_to_offset(&mut table).map_err(placed)?;
        // Text has the lines of what is wrong in it.
        let mut parsed: Self =
            if is_earlier { table.try_into() } else { toml::from_str(text) }.map_err(malformed)?;
        if parsed.schema != SCHEMA {
            return Err(ModelFileError::Schema {
                file: place_of(file, text, "schema"),
                found: parsed.schema,
            });
        }
        let unusable = |problem: String| ModelFileError::Malformed { file: file.to_owned(), problem };
        let own = effects_of_model(text, file).map_err(|e| ModelFileError::Malformed {
            file: format!("{file}:{}:{}", e.line, e.column),
            problem: e.problem,
        })?;
        parsed.vocabulary = Vocabulary::built_in().with(own).map_err(|e| unusable(e.to_string()))?;
        let constants = parsed.model(file).map_err(|e| e.placed(file, text))?.values().len();
        check_covariance(&parsed.covariance, constants).map_err(placed)?;
        Ok(parsed)
    }

    /// The file's text.
    ///
    /// # Errors
    /// [`ModelFileError::Malformed`] if a value cannot be written as TOML.
    pub fn to_text(&self) -> Result<String, ModelFileError> {
        let own = own_effect_blocks(self.vocabulary.own().map(|own| own.definition()));
        toml::to_string(self)
            .map(|text| text + &own)
            .map_err(|e| ModelFileError::Malformed { file: "model.toml".to_owned(), problem: e.to_string() })
    }

    /// The model. `file` is the name used in errors.
    ///
    /// # Errors
    /// [`ModelFileError`] if an effect is unknown or constants are missing.
    pub fn model(&self, file: &str) -> Result<Model, ModelFileError> {
        let flawed = ModelFileError::of(file);
        check_frame(&self.frame)
            .and_then(|()| check_noise(&self.noise))
            .and_then(|()| check_beyond_range(self.beyond_range))
            .map_err(&flawed)?;
        let mut model = Model::baseline(self.frame.clone()).among(&self.vocabulary);
        for entry in &self.terms {
            let term =
                match &entry.structure {
                    Some(structure) => Term::Structure(structure.clone()),
                    None => Term::Named(self.vocabulary.named(&entry.id).ok_or_else(|| {
                        ModelFileError::Effect { file: file.to_owned(), id: entry.id.clone() }
                    })?),
                };
            let zeros = vec![0.0; term.constants()];
            model = model.with_term(term, &zeros);
        }
        let values: Vec<f64> = self.constants.iter().map(|c| c.value).collect();
        let needed = model.values().len();
        if values.len() != needed {
            return Err(ModelFileError::Constants { file: file.to_owned(), found: values.len(), needed });
        }
        let constants = self.constants.iter().map(|c| (c.name.as_str(), c.unit.as_str(), c.value));
        check_constants(&model, constants).map_err(&flawed)?;
        if !model.set_values(&values) {
            return Err(ModelFileError::Constants { file: file.to_owned(), found: values.len(), needed });
        }
        Ok(model)
    }

    /// Predicted readings and their standard deviations in newtons; a condition that the calibration has not
    /// seen is predicted with the layout law and said to be wide.
    ///
    /// # Errors
    /// [`ModelFileError`] as in [`ModelFile::model`].
    pub fn predict(&self, rows: &[PlateauRow], file: &str) -> Result<(Vec<f64>, Vec<f64>), ModelFileError> {
        let (mut frame, known) = (self.frame.clone(), self.model(file)?);
        rows.iter().for_each(|row| frame.extend(row));
        let model = known.in_frame(frame);
        let points = model.frame.points(rows).unwrap_or_default();
        let predicted = model.predict(&points);
        let mut sd = prediction_sd_n(&model, &points, &self.covariance, self.noise);
        let (low, high) = self.frame.load_range_n;
        for (sd, point) in sd.iter_mut().zip(&points) {
            let beyond = (point.load_n - high).max(low - point.load_n).max(0.0);
            *sd = libm::hypot(*sd, self.beyond_range * beyond);
        }
        if let Some(row) = predicted.iter().zip(&sd).position(|(n, sd)| !n.is_finite() || !sd.is_finite()) {
            return Err(ModelFileError::of(file)(Flaw {
                field: "constants".to_owned(),
                value: format!("a prediction of {} N (sd {} N) at row {}", predicted[row], sd[row], row + 1),
                bound: "finite predictions".to_owned(),
            }));
        }
        Ok((predicted, sd))
    }

    /// Wrap in degrees of the first contact that was fitted and has one.
    pub fn usual_wrap_deg(&self) -> f64 {
        let wrapped = self.frame.conditions.iter().find(|c| c.substrate.is_some());
        // Degrees are written in tables, and come back as they were.
        wrapped.map_or(published::WRAP_ANGLE_DEG, |c| (1e9 * c.wrap_rad.to_degrees()).round() / 1e9)
    }

    /// The effects that its terms may name: the built-in ones, and those of one's own that are in it.
    pub fn vocabulary(&self) -> &Vocabulary {
        &self.vocabulary
    }

    /// The noise of the table that was fitted.
    pub fn noise(&self) -> Noise {
        self.noise
    }

    pub(super) fn covariance(&self) -> &[Vec<f64>] {
        &self.covariance
    }

    pub(super) fn reference_speed_pct(&self) -> f64 {
        self.frame.reference_speed_pct
    }

    /// Ids of the terms that stay out of the curve of a printed part, and of those that stay in. The side is that of the
    /// effect; what stands in the file is for a reader. Structure without a name has none, and stays out.
    pub fn sides(&self) -> (Vec<&str>, Vec<&str>) {
        let stays =
            |id: &str| self.vocabulary.named(id).is_some_and(|e| e.description().side == Side::Switch);
        let (inside, outside) = self.terms.iter().map(|t| t.id.as_str()).partition(|id| stays(id));
        (outside, inside)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::inference::Levels;
    use crate::test_session::session;

    fn text() -> String {
        let found = crate::calibrate(&session(3), Levels::default()).unwrap();
        ModelFile::new(&found.selection.augmented, &found.data, found.selection.noise).to_text().unwrap()
    }

    fn sd_n(text: &str) -> f64 {
        ModelFile::parse(text, "model.toml").unwrap().predict(&session(3)[..1], "model.toml").unwrap().1[0]
    }

    #[test]
    fn a_walk_of_an_earlier_file_is_an_offset_of_the_series() {
        let text = text();
        let (before, walk) = text.split_once("[noise.walk]\n").unwrap();
        let after = walk.split_once("\n\n").map_or("", |(_, after)| after);
        let earlier =
            |walk: &str| format!("{before}\n{after}").replace("[noise]\n", &format!("[noise]\n{walk}\n"));
        assert_eq!(sd_n(&earlier("walk_N = 0.0")), sd_n(&text));
        assert!((sd_n(&earlier("walk_N = 0.2")) / libm::hypot(sd_n(&text), 0.2) - 1.0).abs() < 1e-9);
        for walk in ["walk_N = -0.2", "walk_N = \"much\""] {
            let error = ModelFile::parse(&earlier(walk), "model.toml").unwrap_err().to_string();
            assert!(error.contains("noise.walk_N = ") && error.contains("out of bounds"), "{error}");
        }
    }

    #[test]
    fn noise_that_is_unknown_is_refused_by_its_name() {
        let text = text();
        for table in ["[noise]\n", "[noise.walk]\n", "[noise.series]\n"] {
            let wrong = text.replace(table, &format!("{table}mount_scael = 0.01\n"));
            let error = ModelFile::parse(&wrong, "model.toml").unwrap_err().to_string();
            assert!(
                error.starts_with("model.toml:") && error.contains("unknown field `mount_scael`"),
                "{error}"
            );
        }
    }
}
