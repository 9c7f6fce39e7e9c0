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
    /// over its forms, given those before it.
    pub fn log_prior_odds(&self, space: &Space) -> f64 {
        let before = |element: &Element| {
            Self(self.0.range(..element.member).map(|(member, form)| (*member, *form)).collect())
        };
        self.elements().map(|element| before(&element).log_prior_odds_of(space, element)).sum()
    }

    /// Returns the logarithm of the prior odds of another element.
    ///
    /// A cause that acts over a covariate in one form, such as a tendon that was replaced, may act through several channels: next to
    /// a kernel of the same bases and form, structure is as probable as in all, but spread over the other channels only (weak
    /// heredity: Chipman 1996).
    pub(crate) fn log_prior_odds_of(&self, space: &Space, element: Element) -> f64 {
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
                if let Some(probability) = kernel.noise_probability {
                    return libm::log(probability / (1.0 - probability) * variant);
                }
                let is_companion = |(other, form): (usize, usize)| {
                    let other = &space.kernels[other];
                    form == element.form && other.bases == kernel.bases && other.noise_probability.is_none()
                };
                let structures = || space.kernels.iter().filter(|k| k.noise_probability.is_none());
                let share = if self.kernels().any(is_companion) {
                    1.0 / structures().filter(|k| k.bases == kernel.bases).count().saturating_sub(1).max(1)
                        as f64
                } else {
                    variant / structures().count() as f64
                };
                libm::log(space.structure_probability * share)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::problem::{Effect, Kernel};
    use crate::test_problem::problem;

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
    /// Of five kernels, two have one basis, and one is noise.
    #[test]
    fn another_channel_of_one_basis_and_form_does_not_pay_for_them_again() {
        let mut space = problem(12, 0.0).space().clone();
        let kernel = |bases, noise_probability| {
            let variants = vec![0.75, 0.25];
            Kernel { bases, variants, noise_probability, ..space.kernels[0].clone() }
        };
        space.kernels =
            vec![kernel(0, None), kernel(0, None), kernel(1, None), kernel(1, None), kernel(2, Some(0.05))];
        space.kernels[3].bases = 3;
        space.structure_probability = 0.2;
        let odds = |elements: &[(usize, usize)]| {
            let of =
                |(kernel, form): &(usize, usize)| Element { member: Member::Kernel(*kernel), form: *form };
            libm::exp(Hypothesis::from_elements(elements.iter().map(of)).log_prior_odds(&space))
        };
        let expect = |elements: &[(usize, usize)], expected: f64| {
            assert!((odds(elements) / expected - 1.0).abs() < 1e-12, "{elements:?}: {}", odds(elements));
        };
        let [first, second] = [0.2 / 4.0 * 0.75, 0.2 / 4.0 * 0.25];
        expect(&[(0, 0)], first);
        expect(&[(0, 0), (1, 0)], first * 0.2);
        expect(&[(1, 1), (0, 1)], second * 0.2);
        expect(&[(0, 0), (1, 1)], first * second);
        expect(&[(0, 0), (2, 0)], first * first);
        expect(&[(0, 0), (4, 0)], first * 0.05 / 0.95 * 0.75);
    }
}
