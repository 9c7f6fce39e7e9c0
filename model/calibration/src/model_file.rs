//! Model files (`baseline.toml` and `model.toml`): a fitted model that predicts rows later.

use nalgebra::DMatrix;
use pinswitch_diagnostic::{Diagnostic, Location, codes};
use pinswitch_friction::published;
use serde::{Deserialize, Serialize};

use crate::content_hash::{check_content_hash, with_content_hash};
use crate::effects::{
    Abscissa, Covariate, Shape, Side, Structure, Vocabulary, effects_of_model, own_effect_blocks,
};
use crate::evidence::{Fitted, Session};
use crate::model::{Discrepancy, DiscrepancyFactor, Model, Noise, Term, prediction_sd_n};
use crate::model_check::{
    HELP, check_beyond_range, check_constants, check_covariance, check_finite, check_frame, check_nodes,
    check_noise, invalid, walk_to_offset,
};
use crate::session_spread::{drift_n, levels_of_sessions_n};
use crate::table::{Condition, Frame, Optional, PlateauRow};
use pinswitch_measurements::{locate_field, toml_error};

/// Name and version of the format.
const SCHEMA: &str = "pinswitch.model/1";

/// A term in the file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct TermEntry {
    id: String,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    side: Option<String>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    formula: Option<String>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    structure: Option<Structure>,
    /// Factors of the size where the form may be wrong.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    discrepancies: Vec<DiscrepancyEntry>,
}

/// A discrepancy in the file.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
struct DiscrepancyEntry {
    value: f64,
    #[serde(default)]
    sd: f64,
    #[serde(flatten)]
    factor: DiscrepancyFactor,
}

/// A constant in the file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Constant {
    name: String,
    value: f64,
    unit: String,
}

/// A model file.
///
/// ```
/// use pinswitch_calibration::effects::Vocabulary;
/// use pinswitch_calibration::evidence::Session;
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
/// let found = calibrate(&table.rows, &Vocabulary::built_in(), 1)?;
/// let text = ModelFile::new(&found.augmented).to_text()?;
///
/// let model = ModelFile::parse(&text, "model.toml")?;
/// let (predicted_n, sd_n) = model.predict(&table.rows[..1], Session::Fitted, "model.toml")?;
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
    /// Growth of the error with the distance from the loads fitted, in newtons per newton, in files of
    /// earlier versions; the discrepancies of this version grow with the load.
    #[serde(default)]
    beyond_range: f64,
    frame: Frame,
    /// Covariance of the constants' coordinates, row by row.
    covariance: Vec<Vec<f64>>,
    /// The effects of the terms; user-defined ones are written in the file as in a file of effects.
    #[serde(skip)]
    vocabulary: Vocabulary,
}

/// Returns whether a term depends on the operator.
fn depends_on_operator(term: &Term, vocabulary: &Vocabulary) -> bool {
    match term {
        Term::Structure(structure) => {
            matches!(structure.form, Shape::OperatorIs { .. } | Shape::Table { over: Abscissa::Operator, .. })
        }
        Term::Named(effect) => vocabulary
            .own()
            .any(|own| own.definition().id == effect.id() && own.definition().formula.contains("operator")),
    }
}

impl ModelFile {
    /// Returns what the tendon touched in the fitted table.
    pub(crate) fn conditions(&self) -> &[Condition] {
        &self.frame.conditions
    }

    /// Returns the file of a fitted hypothesis.
    pub fn new(fitted: &Fitted) -> Self {
        let Fitted { model, noise, covariance, .. } = fitted;
        let mut frame = model.frame.clone();
        let is_over = |over: Abscissa| {
            model.terms.iter().any(|term| {
                matches!(term, Term::Structure(Structure { form: Shape::Table { over: of, .. }, .. }) if *of == over)
            })
        };
        if frame.changes.is_empty() {
            // The model does not depend on them.
            if !is_over(Abscissa::Session) {
                frame.sessions = Vec::new();
            }
            if !is_over(Abscissa::Specimen) {
                frame.specimens = Vec::new();
            }
        }
        if !model.terms.iter().any(|term| depends_on_operator(term, &model.vocabulary)) {
            frame.operators = Vec::new();
        }
        let discrepancies = |index: usize| {
            let of = model.discrepancies.iter().filter(|d| d.term == index);
            of.map(|d| DiscrepancyEntry { value: d.value, sd: d.sd, factor: d.factor }).collect()
        };
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
                .enumerate()
                .map(|(index, term)| match term {
                    Term::Named(effect) => TermEntry {
                        id: effect.id().to_owned(),
                        side: Some(effect.description().side.as_str().to_owned()),
                        formula: Some(effect.cited_formula()),
                        structure: None,
                        discrepancies: discrepancies(index),
                    },
                    Term::Structure(structure) => TermEntry {
                        id: term.id().to_owned(),
                        side: None,
                        formula: Some(structure.describe(&model.frame)),
                        structure: Some(structure.clone()),
                        discrepancies: Vec::new(),
                    },
                })
                .collect(),
            noise: *noise,
            beyond_range: 0.0,
            frame,
            covariance: (0..covariance.nrows())
                .map(|i| covariance.row(i).iter().copied().collect())
                .collect(),
            vocabulary: model.vocabulary.retaining(|own| used(&own.definition().id)),
        }
    }

    /// Parses a model file. `file` is its name in errors.
    ///
    /// # Errors
    /// A [`Diagnostic`] of the first field that is not that of a model of this version, or of a text whose last line
    /// contains another SHA-256 than that of the lines above.
    pub fn parse(text: &str, file: &str) -> Result<Self, Diagnostic> {
        let malformed = |e: toml::de::Error| toml_error(file, text, &e).with_help(HELP);
        let located = |e: Diagnostic| locate_field(e, file, text);
        let mut table: toml::Table = toml::from_str(text).map_err(malformed)?;
        check_finite("", &toml::Value::Table(table.clone())).map_err(located)?;
        let is_earlier = walk_to_offset(&mut table).map_err(located)?;
        // Errors of the text have line numbers, those of the table do not.
        let mut parsed: Self =
            if is_earlier { table.try_into() } else { toml::from_str(text) }.map_err(malformed)?;
        if parsed.schema != SCHEMA {
            let error = invalid("schema", &parsed.schema, "unknown schema")
                .with_help(format!("use a file with schema = \"{SCHEMA}\""));
            return Err(located(error));
        }
        let own = effects_of_model(text, file)?;
        parsed.vocabulary =
            Vocabulary::built_in().with(own).map_err(|e| Diagnostic::from(e).or_in_file(file))?;
        parsed.add_later_constants().map_err(located)?;
        let constants = parsed.checked_model().map_err(located)?.values().len();
        check_covariance(&parsed.covariance, constants).map_err(located)?;
        check_content_hash(text).map_err(|e| e.or_in_file(file))?;
        Ok(parsed)
    }

    /// Returns the text of the file. Its last line is a comment with the SHA-256 of the lines above.
    ///
    /// # Errors
    /// If a value cannot be written as TOML.
    pub fn to_text(&self) -> Result<String, Diagnostic> {
        let own = own_effect_blocks(self.vocabulary.own().map(|own| own.definition()));
        toml::to_string(self).map(|text| with_content_hash(text + &own)).map_err(|e| {
            Diagnostic::from_error(codes::INTERNAL_ERROR, e).with_location(Location::file("model.toml"))
        })
    }

    /// Returns the model. `file` is the name of the file in errors.
    ///
    /// # Errors
    /// If a value is out of bounds, an effect is unknown, or the constants do not match the terms.
    pub fn model(&self, file: &str) -> Result<Model, Diagnostic> {
        self.checked_model().map_err(|e| e.or_in_file(file))
    }

    /// Adds the constants that effects did not have in earlier versions, with the values that stand for them.
    fn add_later_constants(&mut self) -> Result<(), Diagnostic> {
        let model = self.with_zeros()?;
        for (i, (name, unit)) in model.names().into_iter().enumerate() {
            let is_given = self.constants.get(i).is_some_and(|given| given.name == name);
            let (Some(value), false) = (model.otherwise(i), is_given || i > self.constants.len()) else {
                continue;
            };
            self.constants.insert(i, Constant { name, value, unit: unit.to_owned() });
            for row in self.covariance.iter_mut().filter(|row| row.len() >= i) {
                row.insert(i, 0.0);
            }
            if self.covariance.len() >= i {
                self.covariance.insert(i, vec![0.0; self.constants.len()]);
            }
        }
        Ok(())
    }

    /// Returns the model of the listed terms, whose constants are zero.
    fn with_zeros(&self) -> Result<Model, Diagnostic> {
        check_frame(&self.frame)
            .and_then(|()| check_noise(&self.noise))
            .and_then(|()| check_beyond_range(self.beyond_range))?;
        let mut model = Model::baseline(self.frame.clone()).among(&self.vocabulary);
        for (i, entry) in self.terms.iter().enumerate() {
            let unknown = || {
                invalid(format!("terms[{i}].id"), &entry.id, "unknown effect")
                    .with_help("use the ids of `pinswitch effects`")
            };
            let term = match &entry.structure {
                Some(structure) => {
                    if let Shape::Table { at, value, .. } = &structure.form {
                        check_nodes(&format!("terms[{i}].structure"), at, value)?;
                    }
                    let count = self.frame.conditions.len();
                    if let Some(place) = structure.only_in.filter(|place| *place >= count) {
                        let problem = format!("expected a place among the {count} conditions, from 0");
                        return Err(invalid(format!("terms[{i}].structure.only_in"), place, problem));
                    }
                    Term::Structure(structure.clone())
                }
                None => Term::Named(self.vocabulary.named(&entry.id).ok_or_else(unknown)?),
            };
            let zeros = vec![0.0; term.constants()];
            model = model.with_term(term, &zeros);
            for DiscrepancyEntry { value, sd, factor } in entry.discrepancies.iter().copied() {
                model = model.with_discrepancy(Discrepancy { term: i, value, sd, factor });
            }
        }
        Ok(model)
    }

    fn checked_model(&self) -> Result<Model, Diagnostic> {
        let mut model = self.with_zeros()?;
        let values: Vec<f64> = self.constants.iter().map(|c| c.value).collect();
        let needed = model.values().len();
        let mismatch = || {
            let problem = format!("the listed terms need {needed} finite constants");
            invalid("constants", format!("{} constants", values.len()), problem)
        };
        if values.len() != needed {
            return Err(mismatch());
        }
        let constants = self.constants.iter().map(|c| (c.name.as_str(), c.unit.as_str(), c.value));
        check_constants(&model, constants)?;
        if !model.set_values(&values) {
            return Err(mismatch());
        }
        Ok(model)
    }

    /// Checks that the rows have the covariate of each effect. The time of a new session is not
    /// used: its drifts are averages.
    fn check_covariates(&self, rows: &[PlateauRow], session: Session) -> Result<(), Diagnostic> {
        for term in &self.terms {
            let named = self.vocabulary.named(&term.id).map(|effect| effect.description().covariate);
            let covariate = named.or(term.structure.as_ref().map(|structure| structure.covariate));
            let Some(quantity) = covariate.and_then(Covariate::column) else { continue };
            if quantity == Optional::Time && session == Session::New {
                continue;
            }
            if let Some(row) = rows.iter().position(|row| row.unknown.contains(quantity)) {
                let (column, id) = (quantity.column(), &term.id);
                let problem = format!("row {} lacks {column}, which `{id}` of the model needs", row + 1);
                let help = format!("give {column} in every row, or predict with baseline.toml");
                return Err(Diagnostic::new(codes::COVARIATE_MISSING, problem).with_help(help));
            }
        }
        Ok(())
    }

    /// Predicts readings and their standard deviations in newtons. A condition that was not
    /// calibrated is predicted by the layout law, with a larger standard deviation. Drifts have their
    /// mean over the fitted session in a new one, which may drift differently.
    ///
    /// # Errors
    /// As [`ModelFile::model`], if the rows lack the covariate of an effect, and if a prediction is
    /// not finite.
    pub fn predict(
        &self,
        rows: &[PlateauRow],
        session: Session,
        file: &str,
    ) -> Result<(Vec<f64>, Vec<f64>), Diagnostic> {
        self.check_covariates(rows, session)?;
        let (mut frame, model) = (self.frame.clone(), self.model(file)?);
        rows.iter().for_each(|row| frame.extend(row));
        let model = model.in_frame(frame);
        let points = match session {
            Session::New => model.frame.points_of_new_session(rows),
            Session::Fitted => model.frame.points(rows),
        };
        let points = points.unwrap_or_default();
        let predicted = model.predict(&points);
        // The mounts of the fitted session are known up to the uncertainty of its constants.
        let noise = match session {
            Session::New => self.noise,
            Session::Fitted => Noise { mount_scale: 0.0, ..self.noise },
        };
        let mut sd = prediction_sd_n(&model, &points, &self.covariance(), noise);
        if session == Session::New {
            // What the fitted session drew for itself, another one draws again.
            let add = |sd: &mut [f64], spread_n: Vec<f64>| {
                sd.iter_mut().zip(spread_n).for_each(|(sd, spread_n)| *sd = libm::hypot(*sd, spread_n));
            };
            if self.drifts() {
                add(&mut sd, drift_n(&model, &points, &predicted));
            }
            add(&mut sd, levels_of_sessions_n(&model, &points, &predicted));
        }
        let (low, high) = self.frame.load_range_n;
        for (sd, point) in sd.iter_mut().zip(&points) {
            let beyond = (point.load_n - high).max(low - point.load_n).max(0.0);
            *sd = libm::hypot(*sd, self.beyond_range * beyond);
        }
        if let Some(row) = predicted.iter().zip(&sd).position(|(n, sd)| !n.is_finite() || !sd.is_finite()) {
            let problem = format!(
                "the prediction of row {} is not finite: {} N (standard deviation {} N)",
                row + 1,
                predicted[row],
                sd[row]
            );
            return Err(Diagnostic::new(codes::MODEL_NOT_FINITE, problem)
                .with_location(Location::file(file))
                .with_help(HELP));
        }
        Ok((predicted, sd))
    }

    /// Returns whether a term drifts with the time of the session, so that a new session is predicted with
    /// its mean.
    pub fn drifts(&self) -> bool {
        self.frame.mean_time.is_some()
            && self.terms.iter().any(|term| match &term.structure {
                Some(Structure { form, .. }) => matches!(form, Shape::Table { over: Abscissa::Time, .. }),
                None => self
                    .vocabulary
                    .named(&term.id)
                    .is_some_and(|effect| effect.description().covariate == Covariate::Time),
            })
    }

    /// Returns the wrap angle in degrees of the first fitted condition that has one.
    pub fn usual_wrap_deg(&self) -> f64 {
        let wrapped = self.frame.conditions.iter().find(|c| c.substrate.is_some());
        // Rounded to the degrees that the table had before the conversion to radians.
        wrapped.map_or(published::WRAP_ANGLE_DEG, |c| (1e9 * c.wrap_rad.to_degrees()).round() / 1e9)
    }

    /// Returns the effects that terms may name: the built-in ones, and the user-defined ones in the
    /// file.
    pub fn vocabulary(&self) -> &Vocabulary {
        &self.vocabulary
    }

    /// Returns the noise of the fitted table.
    pub fn noise(&self) -> Noise {
        self.noise
    }

    pub(super) fn covariance(&self) -> DMatrix<f64> {
        let n = self.covariance.len();
        DMatrix::from_fn(n, n, |i, j| self.covariance[i][j])
    }

    pub(super) fn reference_speed_pct(&self) -> f64 {
        self.frame.reference_speed_pct
    }

    /// Returns the ids of the terms that are excluded from the curve of a printed part, and of
    /// those that are included.
    ///
    /// The side is that of the effect; the side in the file is for readers. Unattributed structure
    /// is excluded.
    pub fn sides(&self) -> (Vec<&str>, Vec<&str>) {
        let stays =
            |id: &str| self.vocabulary.named(id).is_some_and(|e| e.description().side == Side::Switch);
        // The curve is that of the latest session: a change between sessions is not an effect.
        let is_change = |term: &&TermEntry| term.structure.as_ref().is_some_and(Structure::is_change);
        let terms = self.terms.iter().filter(|term| !is_change(term));
        let (inside, outside) = terms.map(|t| t.id.as_str()).partition(|id| stays(id));
        (outside, inside)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_session::session;

    fn text() -> String {
        let calibration = crate::calibrate(&session(3), &Vocabulary::built_in(), 1).unwrap();
        ModelFile::new(&calibration.augmented).to_text().unwrap()
    }

    fn sd_n(text: &str) -> f64 {
        ModelFile::parse(text, "model.toml")
            .unwrap()
            .predict(&session(3)[..1], Session::New, "model.toml")
            .unwrap()
            .1[0]
    }

    #[test]
    fn walks_of_earlier_files_become_offsets() {
        let text = text();
        // Earlier files have no hash.
        let (text, _) = text.trim_end().rsplit_once('\n').unwrap();
        let (before, walk) = text.split_once("[noise.walk]\n").unwrap();
        let after = walk.split_once("\n\n").map_or("", |(_, after)| after);
        let earlier =
            |walk: &str| format!("{before}\n{after}").replace("[noise]\n", &format!("[noise]\n{walk}\n"));
        assert_eq!(sd_n(&earlier("walk_N = 0.0")), sd_n(text));
        assert!((sd_n(&earlier("walk_N = 0.2")) / libm::hypot(sd_n(text), 0.2) - 1.0).abs() < 1e-9);
        for walk in ["walk_N = -0.2", "walk_N = \"much\""] {
            let error = ModelFile::parse(&earlier(walk), "model.toml").unwrap_err().to_string();
            assert!(error.starts_with("model.toml:") && error.contains(": noise.walk_N = "), "{error}");
        }
    }

    /// Models of earlier versions lack a constant that an effect has now, and the rows of their covariance have no number
    /// for it.
    #[test]
    fn models_without_a_later_constant_are_read() {
        let effect = crate::effects::effect_named("run_in").unwrap();
        let rows = crate::test_session::session_with(3, &[(Term::named(effect), &[0.3, 2.5, 1.0])]);
        let calibration = crate::calibrate(&rows, &Vocabulary::built_in(), 1).unwrap();
        let mut file = ModelFile::new(&calibration.augmented);
        let at = file.constants.iter().position(|constant| constant.name == "run_in.q").unwrap();
        file.constants[at].value = 0.0;
        file.covariance.iter_mut().for_each(|row| row[at] = 0.0);
        file.covariance[at].fill(0.0);
        let now = ModelFile::parse(&file.to_text().unwrap(), "model.toml").unwrap();
        assert_eq!(now, file);
        file.constants.remove(at);
        for row in &mut file.covariance {
            row.remove(at);
        }
        file.covariance.remove(at);
        let earlier = ModelFile::parse(&file.to_text().unwrap(), "model.toml").unwrap();
        assert_eq!(earlier, now);
        let predicted = |file: &ModelFile| file.predict(&rows[..12], Session::New, "model.toml").unwrap();
        assert_eq!(predicted(&earlier), predicted(&now));
        file.constants.remove(at - 1);
        let error = ModelFile::parse(&file.to_text().unwrap(), "model.toml").unwrap_err();
        assert!(error.problem().contains("finite constants"), "{error}");
    }

    /// An effect over a covariate that a row lacks would be predicted at an invented value.
    #[test]
    fn rows_without_the_covariate_are_refused() {
        let effect = crate::effects::effect_named("stroke_position").unwrap();
        let rows = crate::test_session::session_with(3, &[(Term::named(effect), &[0.1])]);
        let calibration = crate::calibrate(&rows, &Vocabulary::built_in(), 1).unwrap();
        let file = ModelFile::new(&calibration.augmented);
        let mut row = rows[0].clone();
        assert!(file.predict(std::slice::from_ref(&row), Session::New, "model.toml").is_ok());
        row.unknown = row.unknown.with(Optional::Position);
        let error = file.predict(&[row.clone()], Session::New, "model.toml").unwrap_err();
        assert!(error.problem().contains("row 1 lacks position_mm"), "{error}");
        let baseline = ModelFile::new(&calibration.baseline);
        assert!(baseline.predict(&[row], Session::New, "baseline.toml").is_ok());
    }

    #[test]
    fn changed_digits_are_refused() {
        let text = text();
        let at = text.find("value = 0.").unwrap() + "value = 0.".len();
        let digit = if &text[at..=at] == "1" { "2" } else { "1" };
        let mut changed = text.clone();
        changed.replace_range(at..=at, digit);
        let error = ModelFile::parse(&changed, "model.toml").unwrap_err();
        assert!(error.to_string().starts_with("model.toml: was changed since pinswitch wrote it"), "{error}");
        let (accepted, _) = changed.trim_end().rsplit_once('\n').unwrap();
        assert!(ModelFile::parse(accepted, "model.toml").is_ok());
    }

    #[test]
    fn unknown_noise_is_refused() {
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
