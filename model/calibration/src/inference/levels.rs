//! Levels at which effects and structures are believed.

/// Levels of the decisions, in whitened squares; tuned by `pinswitch simulate --study`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Levels {
    /// Probability by chance, over the vocabulary, at which the first named effect is believed.
    pub first_p: f64,
    /// Largest probability by sign flips at which a weak first effect is believed.
    pub flips: f64,
    /// Least gain of each further one.
    pub further: f64,
    /// Least gain of a further one as a share of the first one's gain: below it, it may stem from the form.
    pub further_share: f64,
    /// A gain above this share of the first one's is more than the form of an effect can bend, if it is also above
    /// `beyond_small`.
    pub beyond_form: f64,
    /// A gain below this may always stem from the form: a first effect of a few dozen squares is itself known so badly
    /// that its form may be off by half of it.
    pub beyond_small: f64,
    /// A rival fits worse by less than this.
    pub rival: f64,
    /// ... or by less than this share of what the effect explains.
    pub rival_share: f64,
    /// Least gain of a structure that no name explains.
    pub structure: f64,
    /// Probability by chance, over all structures tried, at which one is believed.
    pub structure_p: f64,
    /// Least gain of such a structure as a share of what the names explain.
    pub structure_share: f64,
    /// By how much a structure alone must fit better than a name with its form bent.
    pub outright: f64,
}

impl Levels {
    /// The gain above which a further name needs no comparison with bent forms, where those before it gained `gained`.
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
