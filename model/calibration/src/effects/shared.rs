//! An effect that terms, priors and vocabularies share.

use std::ops::Deref;
use std::sync::Arc;

use super::Effect;

/// A shared effect: of the program, or one that exists as long as something refers to it.
///
/// ```
/// use pinswitch_calibration::effects::{SharedEffect, Vocabulary, effect_named};
///
/// let offset = effect_named("load_cell_offset").map(SharedEffect::from);
/// assert_eq!(offset, Vocabulary::built_in().named("load_cell_offset"));
/// ```
#[derive(Clone, Debug)]
pub enum SharedEffect {
    /// An effect of the program.
    Static(&'static dyn Effect),
    /// Another effect, such as a user-defined one.
    Counted(Arc<dyn Effect>),
}

impl Deref for SharedEffect {
    type Target = dyn Effect;

    fn deref(&self) -> &Self::Target {
        match self {
            Self::Static(effect) => *effect,
            Self::Counted(effect) => effect.as_ref(),
        }
    }
}

impl From<&'static dyn Effect> for SharedEffect {
    fn from(effect: &'static dyn Effect) -> Self {
        Self::Static(effect)
    }
}

/// Effects are equal if their ids are: a [`Vocabulary`](super::Vocabulary) has each id once.
impl PartialEq for SharedEffect {
    fn eq(&self, other: &Self) -> bool {
        self.id() == other.id()
    }
}
