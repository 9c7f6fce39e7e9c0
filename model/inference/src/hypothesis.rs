//! Hypotheses: sets of effects and kernels, and their prior odds.

use std::collections::BTreeMap;

use crate::problem::Space;

/// A named effect or a kernel, without regard to its discrete form.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Member {
    /// Index in [`Space::effects`].
    Effect(usize),
    /// Index in [`Space::kernels`].
    Kernel(usize),
}

/// A member with its discrete form: the shape of an effect, the variant of a kernel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Element {
    /// Effect or kernel.
    pub member: Member,
    /// Index of its form.
    pub form: usize,
}

/// A set of effects and kernels, each in one form.
#[derive(Clone, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct Hypothesis(BTreeMap<Member, usize>);

impl Hypothesis {
    /// Returns a hypothesis of some elements.
    pub fn from_elements(elements: impl IntoIterator<Item = Element>) -> Self {
        Self(elements.into_iter().map(|e| (e.member, e.form)).collect())
    }

    /// Adds an element, or replaces the form of its member.
    #[must_use]
    pub fn with(&self, element: Element) -> Self {
        let mut changed = self.clone();
        changed.0.insert(element.member, element.form);
        changed
    }

    /// Removes a member.
    #[must_use]
    pub fn without(&self, member: Member) -> Self {
        let mut changed = self.clone();
        changed.0.remove(&member);
        changed
    }

    /// Returns whether a member is in the hypothesis.
    pub fn contains(&self, member: Member) -> bool {
        self.0.contains_key(&member)
    }

    /// Returns its members, effects first.
    pub fn members(&self) -> impl Iterator<Item = Member> + '_ {
        self.0.keys().copied()
    }

    /// Returns its elements, effects first.
    pub fn elements(&self) -> impl Iterator<Item = Element> + '_ {
        self.0.iter().map(|(member, form)| Element { member: *member, form: *form })
    }

    /// Returns effect and shape of each effect.
    pub(crate) fn effects(&self) -> impl Iterator<Item = (usize, usize)> + '_ {
        self.0.iter().filter_map(|(member, form)| match member {
            Member::Effect(effect) => Some((*effect, *form)),
            Member::Kernel(_) => None,
        })
    }

    /// Returns kernel and variant of each kernel.
    pub(crate) fn kernels(&self) -> impl Iterator<Item = (usize, usize)> + '_ {
        self.0.iter().filter_map(|(member, form)| match member {
            Member::Kernel(kernel) => Some((*kernel, *form)),
            Member::Effect(_) => None,
        })
    }

    /// Returns the number of its members.
    pub fn len(&self) -> usize {
        self.0.len()
    }

    /// Returns whether it is the baseline alone.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Returns `ln p(H)` relative to the empty hypothesis: the prior odds of each member, spread
    /// over its forms.
    pub fn log_prior_odds(&self, space: &Space) -> f64 {
        self.elements().map(|element| log_prior_odds(space, element)).sum()
    }
}

/// Returns the logarithm of the prior odds of an element.
pub(crate) fn log_prior_odds(space: &Space, element: Element) -> f64 {
    match element.member {
        Member::Effect(index) => {
            let effect = &space.effects[index];
            let odds = effect.probability / (1.0 - effect.probability);
            let equal = 1.0 / effect.starts.len().max(1) as f64;
            libm::log(odds * effect.shape_probabilities.get(element.form).copied().unwrap_or(equal))
        }
        Member::Kernel(index) => {
            let kernel = &space.kernels[index];
            let variant = kernel.variants.get(element.form).copied().unwrap_or(0.0);
            let odds = kernel.noise_probability.map_or_else(
                || {
                    let structures = space.kernels.iter().filter(|k| k.noise_probability.is_none());
                    space.structure_probability / structures.count() as f64
                },
                |probability| probability / (1.0 - probability),
            );
            libm::log(odds * variant)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::problem::Effect;

    #[test]
    fn shapes_share_the_prior_odds() {
        let effect = |starts: &[f64]| Effect {
            name: String::new(),
            typical_size: Some(1.0),
            is_one_sided: false,
            probability: 0.2,
            starts: starts.to_vec(),
            shape_probabilities: Vec::new(),
            shape_constants: 0,
        };
        let space = Space { effects: vec![effect(&[1.0]), effect(&[1.0, 2.0])], ..Space::default() };
        let one = |index| Element { member: Member::Effect(index), form: 0 };
        let odds = |elements: &[Element]| {
            libm::exp(Hypothesis::from_elements(elements.iter().copied()).log_prior_odds(&space))
        };
        assert!((odds(&[one(0)]) - 0.25).abs() < 1e-12);
        assert!((odds(&[one(0), one(1)]) - 0.25 * 0.125).abs() < 1e-12);
    }
}
