//! The effects that a calibration tries: the built-in ones, and those of one's own.

use std::sync::Arc;

use pinswitch_friction::sort_by_number;

use super::own::{DefinitionError, LeakedEffect, OwnEffect, OwnEffectError, duplicate, read_own_effects};
use super::{CATALOGUE, Effect};

/// A list of effects, in the order of the catalogue and in that in which they act. A clone shares it.
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
/// # Ok::<(), pinswitch_calibration::effects::OwnEffectError>(())
/// ```
#[derive(Clone, Debug)]
pub struct Vocabulary {
    own: Arc<[&'static LeakedEffect]>,
    acting: Arc<[&'static dyn Effect]>,
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
    /// The effects of the catalogue.
    pub fn built_in() -> Self {
        Self::of(Vec::new())
    }

    fn of(own: Vec<&'static LeakedEffect>) -> Self {
        let mut acting: Vec<&'static dyn Effect> = CATALOGUE.to_vec();
        acting.extend(own.iter().map(|effect| *effect as &dyn Effect));
        sort_by_number(&mut acting, |effect| f64::from(effect.description().stage as u8));
        Self { own: own.into(), acting: acting.into() }
    }

    /// The same with those of a file added. `file` is the name used in errors.
    ///
    /// # Errors
    /// [`OwnEffectError`] with line and column.
    pub fn read(&self, text: &str, file: &str) -> Result<Self, OwnEffectError> {
        Ok(self.joined(read_own_effects(text, file, self)?))
    }

    /// The same with more effects of one's own. They stay in memory as long as the program runs.
    ///
    /// # Errors
    /// [`DefinitionError`] if an id is there twice.
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
        Self::of(self.own.iter().copied().chain(own.into_iter().map(OwnEffect::leaked)).collect())
    }

    /// The same with only those of one's own for which this holds.
    #[must_use]
    pub fn retaining(&self, keep: impl Fn(&OwnEffect) -> bool) -> Self {
        Self::of(self.own.iter().copied().filter(|effect| keep(&effect.own)).collect())
    }

    /// The effect of an id.
    pub fn named(&self, id: &str) -> Option<&'static dyn Effect> {
        self.acting.iter().copied().find(|effect| effect.id() == id)
    }

    /// Says that an id is unknown, with the nearest one that is known, or all.
    pub fn unknown(&self, id: &str) -> String {
        // Those of one's own first: an error shows the beginning and the end of a long list.
        let own = self.own().map(|own| own.definition().id.as_str());
        super::own::unknown("effect", id, own.chain(CATALOGUE.iter().map(|effect| effect.id())))
    }

    /// All of them in the order of the catalogue, those of one's own behind.
    pub fn effects(&self) -> impl Iterator<Item = &'static dyn Effect> {
        CATALOGUE.iter().copied().chain(self.own.iter().map(|effect| *effect as &dyn Effect))
    }

    /// All of them in the order in which they act: the load first, the end of the load cell's range last.
    pub fn acting_order(&self) -> &[&'static dyn Effect] {
        &self.acting
    }

    /// Those of one's own, in the order in which they were read.
    pub fn own(&self) -> impl Iterator<Item = &OwnEffect> {
        self.own.iter().map(|effect| &effect.own)
    }

    /// How many there are.
    pub fn count(&self) -> usize {
        self.acting.len()
    }

    /// How many candidates a search tries: one of one's own counts once for each place that its shapes are tried at, since
    /// the best of many places gains more by chance than one. The built-in ones count once; what chance makes of them and
    /// their shapes is held against rigs without effect (`model/doc/calibration.md`).
    pub fn tries(&self) -> usize {
        let places: usize = self.own().map(|own| own.starts().len()).sum();
        self.count() - self.own.len() + places
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An effect of one's own whose formula has this many shapes with bounds.
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
    fn one_of_one_s_own_counts_once_for_each_place_it_is_tried_at() {
        let built_in = Vocabulary::built_in();
        assert_eq!(built_in.tries(), built_in.count());
        let more =
            |shapes| built_in.read(&with_shapes(shapes), "own.toml").unwrap().tries() - built_in.tries();
        assert_eq!([more(0), more(1), more(2), more(3)], [1, 4, 16, 10]);
        let two = built_in.read(&with_shapes(0), "a.toml").unwrap().read(&with_shapes(1), "b.toml").unwrap();
        assert_eq!((two.count(), two.tries()), (built_in.count() + 2, built_in.tries() + 5));
    }
}
