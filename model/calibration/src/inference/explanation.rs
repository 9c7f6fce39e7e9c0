//! An explanation of a table for a given noise: effects, then unattributed structure, then a new
//! estimate of the noise.

use super::baseline::{explainable, fit_baseline, takes_names_out};
use super::evidence::evidence;
use super::fit::{Fit, fit};
use super::isolation::isolated_series;
use super::levels::Levels;
use super::model::{Model, Term};
use super::noise::Noise;
use super::observations::Observations;
use super::scatter::Scatter;
use super::screening::Screen;
use super::search::{bendable_gain, search};
use super::sharper_noise::{noise_beside_a_name, sharper_noise};
use super::unnamed::{Context, FoundStructure};
use super::variance_components::estimate;
use super::weighed::Weighed;
use crate::effects::Shape;

/// Most series that may be excluded.
const MAX_EXCLUDED: usize = 3;

/// An explanation of a table for a given noise.
#[derive(Clone)]
pub(super) struct Explanation {
    pub(super) baseline: Fit,
    pub(super) augmented: Fit,
    /// The effects found before the search for structure.
    pub(super) named: Model,
    pub(super) structure: Option<FoundStructure>,
    pub(super) structure_gain: f64,
    pub(super) structures_tried: usize,
    pub(super) noise: Noise,
    /// A series with a gross error that must be excluded first.
    pub(super) isolated: Option<usize>,
}

impl Explanation {
    /// Returns the number of shapes; sine and cosine of a wave count as one.
    fn shapes(&self) -> usize {
        let is_one = |term: &&Term| match term {
            Term::Structure(s) => {
                !matches!(s.form, Shape::TimeWave { quarter: 1, .. } | Shape::PositionWave { quarter: 1, .. })
            }
            Term::Named(_) => false,
        };
        self.augmented.model.terms.iter().filter(is_one).count()
    }

    pub(super) fn names(&self) -> usize {
        self.augmented.model.named_effects().len()
    }

    /// Returns minus twice the log posterior probability, up to a constant: the evidence, and the
    /// number of choices for each term.
    pub(super) fn toll(&self, data: &Observations) -> f64 {
        let choices = 2.0 * libm::log(self.augmented.model.vocabulary.count() as f64) * self.names() as f64;
        let shapes = 2.0 * libm::log(self.structures_tried.max(1) as f64) * self.shapes() as f64;
        let scatter: f64 = Scatter::ALL.iter().map(|s| s.cost(self.noise, data)).sum();
        evidence(&self.augmented, &Weighed::new(data, self.noise)) + choices + shapes + scatter
    }
}

impl Explanation {
    /// Returns the effects that were found before the search for structure, without the structure.
    pub(super) fn names_alone(&self) -> Option<Explanation> {
        let has_shapes = self.structure.is_some() && !self.named.terms.is_empty();
        has_shapes.then(|| Explanation {
            augmented: Fit { model: self.named.clone(), ..self.augmented.clone() },
            structure: None,
            ..self.clone()
        })
    }

    /// Returns the explanations with one term less, or with none.
    pub(super) fn with_less(&self) -> impl Iterator<Item = Explanation> {
        let terms = &self.augmented.model.terms;
        let bare = self.augmented.model.without_terms(|_| true);
        let named = (0..terms.len())
            .filter(|i| matches!(terms[*i], Term::Named(_)))
            .map(|i| (self.augmented.model.without_term(i), self.structure));
        let shapeless = self.augmented.model.without_terms(|term| matches!(term, Term::Structure(_)));
        [(bare, None), (shapeless, None)].into_iter().chain(named).map(|(model, structure)| Explanation {
            augmented: Fit { model, ..self.augmented.clone() },
            structure,
            ..self.clone()
        })
    }

    /// Returns the same terms for another noise.
    pub(super) fn at(&self, data: &Observations, noise: Noise) -> Explanation {
        let augmented = fit(&self.augmented.model, &Weighed::new(data, noise));
        Explanation { augmented, noise, ..self.clone() }
    }
}

/// Returns effects and structure for a noise, which is estimated again once something is explained.
pub(super) fn explain(start: &Model, data: &Observations, noise: Noise, levels: Levels) -> Explanation {
    let mut noise = noise;
    let mut weighed = Weighed::new(data, noise);
    let mut baseline = fit_baseline(start, &weighed);
    let mut found = search(&baseline, &weighed, levels);
    if found.model.terms.is_empty()
        && !takes_names_out(data)
        && let Some(sharper) = noise_beside_a_name(&baseline, data, noise)
    {
        noise = sharper;
        weighed = Weighed::new(data, noise);
        baseline = fit(&baseline.model, &weighed);
        found = search(&baseline, &weighed, levels);
    }
    if !found.model.terms.is_empty() {
        let before = noise;
        noise = estimate(data, &found.residual_n, &explainable(&found, data), noise);
        noise = Scatter::ALL.iter().fold(noise, |n, scatter| scatter.taken_from(before, n));
        weighed = Weighed::new(data, noise);
        baseline = fit(&baseline.model, &weighed);
        found = search(&baseline, &weighed, levels);
    }
    // A shape in some series resembles scatter of the series until it is in the model.
    let (sharper, mut left) = sharper_noise(&found, data, noise);
    if let Some(sharper) = sharper {
        noise = sharper;
        weighed = Weighed::new(data, noise);
        baseline = fit(&baseline.model, &weighed);
        found = fit(&found.model, &weighed);
        left = Screen::new(&found, &weighed).structures();
    }
    let explained = bendable_gain(&baseline, &found, &weighed);
    let open = Screen::new(&found, &weighed);
    let guarded = Screen::guarded(&found, &weighed);
    let beyond = left.first().is_some_and(|s| s.gain > levels.beyond_form * explained);
    if !found.model.named_effects().is_empty() && !beyond {
        left = guarded.structures();
    }
    let isolated = (data.excluded_series() < MAX_EXCLUDED)
        .then(|| {
            let structure = left.first().map_or(0.0, |s| s.gain);
            let effect = open.effects().iter().map(|s| s.gain).fold(structure, f64::max);
            isolated_series(&open, data, effect)
        })
        .flatten();
    let (structure_gain, structures_tried) = (left.first().map_or(0.0, |s| s.gain), left.len());
    let named = found.model.clone();
    let (augmented, structure) = if isolated.is_some() {
        (found.clone(), None)
    } else {
        let bent = guarded.bent_gain();
        Context { weighed: &weighed, levels, explained }.with_unnamed(&baseline, found.clone(), &left, bent)
    };
    Explanation { baseline, augmented, named, structure, structure_gain, structures_tried, noise, isolated }
}
