//! Significance levels for effects and structure.

/// Levels of the decisions, as reductions of the deviance; tuned by `pinswitch simulate --study`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Levels {
    /// Probability by chance over the vocabulary below which the first effect is accepted.
    pub first_p: f64,
    /// Largest probability by sign flips of a weak first effect.
    pub flips: f64,
    /// Smallest gain of each further effect.
    pub further: f64,
    /// Smallest gain of a further effect as a share of the first one's; a smaller gain may result
    /// from the approximate formula.
    pub further_share: f64,
    /// Share of the first one's gain above which a gain cannot result from its approximate formula,
    /// if it is also above `beyond_small`.
    pub beyond_form: f64,
    /// Gain below which it may always result from the approximate formula: the shape of a weak
    /// first effect is uncertain by up to half of it.
    pub beyond_small: f64,
    /// Largest increase of the deviance for a rival.
    pub rival: f64,
    /// The same as a share of the effect's gain.
    pub rival_share: f64,
    /// Smallest gain of unattributed structure.
    pub structure: f64,
    /// Probability by chance over all structures below which one is accepted.
    pub structure_p: f64,
    /// Smallest gain of structure as a share of the effects' gain.
    pub structure_share: f64,
    /// Gain by which a structure alone must exceed that of effects with bent formulas.
    pub outright: f64,
}

impl Levels {
    /// Returns the gain above which a further effect needs no comparison with bent formulas, given
    /// the gain of the previous ones.
    pub(super) fn beyond_bending(&self, gained: f64) -> f64 {
        self.beyond_small.max(self.beyond_form * gained)
    }
}

impl Default for Levels {
    fn default() -> Self {
        Self {
            first_p: 0.006,
            flips: 0.1,
            further: 18.0,
            further_share: 0.001,
            beyond_form: 0.08,
            beyond_small: 200.0,
            rival: 9.0,
            rival_share: 0.002,
            structure: 26.0,
            structure_p: 0.01,
            structure_share: 0.02,
            outright: 7.0,
        }
    }
}
