//! The effects that a calibration tries: the built-in and the user-defined ones.

use std::sync::Arc;

use pinswitch_diagnostic::{Diagnostic, codes};
use pinswitch_friction::sort_by_number;

use super::own::{DefinitionError, OwnEffect, duplicate, read_own_effects, unknown_name};
use super::{CATALOGUE, SharedEffect};

/// Effects in the order of the catalogue and in the order in which they act. A clone shares them.
///
/// ```
/// use pinswitch_calibration::effects::Vocabulary;
///
/// let text = r#"
/// schema = "pinswitch.effects/1"
/// [[effect]]
/// id = "lubricant_dip"
/// side = "switch"
/// covariate = "speed"
/// acts_on = "mu"
/// combine = "factor"
/// formula = "-a * exp(-((speed_pct - c)/w)^2)"
/// one_sided = true
/// parameters.a = { size = true, start = 0.1, unit = "1" }
/// parameters.c = { start = 52, low = 35, high = 75, unit = "%" }
/// parameters.w = { start = 8, low = 3, high = 30, unit = "%" }
/// "#;
/// let vocabulary = Vocabulary::built_in().read(text, "mine.toml")?;
/// assert_eq!(vocabulary.count(), 22);
/// let error = vocabulary.read(&text.replace("speed_pct", "sped_pct"), "mine.toml").unwrap_err();
/// assert_eq!(error.to_string(), "mine.toml:9:24: unknown variable 'sped_pct'; did you mean speed_pct?");
/// # Ok::<(), pinswitch_diagnostic::Diagnostic>(())
/// ```
#[derive(Clone, Debug)]
pub struct Vocabulary {
    own: Arc<[Arc<OwnEffect>]>,
    acting: Arc<[SharedEffect]>,
}

impl Default for Vocabulary {
    fn default() -> Self {
        Self::built_in()
    }
}

impl PartialEq for Vocabulary {
    fn eq(&self, other: &Self) -> bool {
        self.own().eq(other.own())
    }
}

impl Vocabulary {
    /// Returns the effects of the catalogue.
    pub fn built_in() -> Self {
        Self::of(Vec::new())
    }

    fn of(own: Vec<Arc<OwnEffect>>) -> Self {
        let mut acting: Vec<SharedEffect> = all(&own).collect();
        sort_by_number(&mut acting, |effect| f64::from(effect.description().stage as u8));
        Self { own: own.into(), acting: acting.into() }
    }

    /// Adds the user-defined effects of a file. `file` is its name in errors.
    ///
    /// # Errors
    /// As [`read_own_effects`].
    pub fn read(&self, text: &str, file: &str) -> Result<Self, Diagnostic> {
        Ok(self.joined(read_own_effects(text, file, self)?))
    }

    /// Adds user-defined effects.
    ///
    /// # Errors
    /// [`DefinitionError`] if an id is not unique.
    pub fn with(&self, own: Vec<OwnEffect>) -> Result<Self, DefinitionError> {
        for (i, effect) in own.iter().enumerate() {
            let id = &effect.definition().id;
            if self.named(id).is_some() || own[..i].iter().any(|other| other.definition().id == *id) {
                return Err(duplicate(id));
            }
        }
        Ok(self.joined(own))
    }

    fn joined(&self, own: Vec<OwnEffect>) -> Self {
        Self::of(self.own.iter().cloned().chain(own.into_iter().map(Arc::new)).collect())
    }

    /// Removes the user-defined effects for which `keep` returns false.
    #[must_use]
    pub fn retaining(&self, keep: impl Fn(&OwnEffect) -> bool) -> Self {
        Self::of(self.own.iter().filter(|effect| keep(effect)).cloned().collect())
    }

    /// Returns the effect of an id.
    pub fn named(&self, id: &str) -> Option<SharedEffect> {
        self.acting.iter().find(|effect| effect.id() == id).cloned()
    }

    /// Returns the diagnostic of an unknown id, which suggests the closest known id or lists all.
    pub fn unknown(&self, id: &str) -> Diagnostic {
        // User-defined effects come first, since a long list is abridged in the middle.
        let own = self.own().map(|own| own.definition().id.as_str());
        unknown_name(codes::UNKNOWN_NAME, "effect", id, own.chain(CATALOGUE.iter().map(|effect| effect.id())))
    }

    /// Returns all effects in the order of the catalogue, followed by the user-defined ones.
    pub fn effects(&self) -> impl Iterator<Item = SharedEffect> {
        all(&self.own)
    }

    /// Returns all effects in the order in which they act, from the load to the end of the load
    /// cell's range.
    pub fn acting_order(&self) -> &[SharedEffect] {
        &self.acting
    }

    /// Returns the user-defined effects in the order in which they were read.
    pub fn own(&self) -> impl Iterator<Item = &OwnEffect> {
        self.own.iter().map(Arc::as_ref)
    }

    /// Returns the number of effects.
    pub fn count(&self) -> usize {
        self.acting.len()
    }

    /// Returns the number of candidates for the correction of multiple tests.
    ///
    /// A user-defined effect counts once for each start of its shapes, since the best of several
    /// starts gains more by chance. A built-in one counts once; false positives of the built-in
    /// effects and their shapes are calibrated on rigs without effect (`model/doc/calibration.md`).
    pub fn tries(&self) -> usize {
        let places: usize = self.own().map(|own| own.shape_starts().len()).sum();
        self.count() - self.own.len() + places
    }
}

/// Returns the effects of the catalogue, followed by the user-defined ones.
fn all(own: &[Arc<OwnEffect>]) -> impl Iterator<Item = SharedEffect> {
    let built_in = CATALOGUE.iter().map(|effect| SharedEffect::Static(*effect));
    built_in.chain(own.iter().map(|effect| SharedEffect::Counted(effect.clone())))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns a file with an effect that has this number of shapes.
    fn with_shapes(shapes: usize) -> String {
        let names = ["c", "d", "e"];
        let sum: String = names[..shapes].iter().map(|name| format!(" * (1 + {name} * stroke)")).collect();
        let mut text = format!(
            "schema = \"pinswitch.effects/1\"\n[[effect]]\nid = \"own_{shapes}\"\nside = \"switch\"\ncovariate = \"position\"\nacts_on = \"mu\"\n\
             combine = \"factor\"\nformula = \"k{sum}\"\nparameters.k = {{ size = true, start = 0.1, unit = \"1\" }}\n"
        );
        for name in &names[..shapes] {
            text += &format!("parameters.{name} = {{ start = 0.5, low = 0, high = 1, unit = \"1\" }}\n");
        }
        text
    }

    #[test]
    fn user_defined_effects_count_per_start() {
        let built_in = Vocabulary::built_in();
        assert_eq!(built_in.tries(), built_in.count());
        let more =
            |shapes| built_in.read(&with_shapes(shapes), "own.toml").unwrap().tries() - built_in.tries();
        assert_eq!([more(0), more(1), more(2), more(3)], [1, 4, 16, 10]);
        let two = built_in.read(&with_shapes(0), "a.toml").unwrap().read(&with_shapes(1), "b.toml").unwrap();
        assert_eq!((two.count(), two.tries()), (built_in.count() + 2, built_in.tries() + 5));
    }

    /// Programs that read many files would otherwise grow without limit.
    #[test]
    fn user_defined_effects_end_with_their_last_user() {
        let vocabulary = Vocabulary::built_in().read(&with_shapes(1), "own.toml").unwrap();
        let Some(SharedEffect::Counted(effect)) = vocabulary.named("own_1") else {
            panic!("not user-defined")
        };
        let weak = Arc::downgrade(&effect);
        drop(effect);
        assert!(weak.upgrade().is_some());
        drop(vocabulary);
        assert!(weak.upgrade().is_none());
    }
}
