//! A kernel of unnamed structure, with its bases at the rows of the fitted session and of a new one.

use std::rc::Rc;

use nalgebra::DMatrix;
use pinswitch_inference::{Basis, Kernel, SERIES_PROBABILITY, SessionLevels, kernel};

use super::Session;
use super::covariates::Covariates;
use super::forward::Channel;
use crate::effects::Abscissa;

/// Covariate of noise.
pub(super) const NOISE: &str = "noise";
/// Covariate of gross errors of a series.
pub(super) const GROSS_ERROR: &str = "gross error";
/// Prior probability that offsets of series wander, for each channel: that of an effect.
const WANDERING_PROBABILITY: f64 = 0.05;

/// A function of the rows that returns a basis.
pub(super) type BasisOfRows = Rc<dyn Fn(&Covariates) -> DMatrix<f64>>;

/// How a model file keeps the function of a kernel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Record {
    /// As a table over the session, of which a later session has the mean.
    Time,
    /// As a table over a covariate; with true, over the levels of a factor.
    Table(Abscissa, bool),
    /// As a table over the sessions, with the expected level of a new one at its end.
    Sessions,
    /// As the memory of the previous load.
    Memory,
    /// Not at all: a new session draws it again, about zero.
    Nothing,
}

/// Root mean square of the rows of a basis below which it changes nothing.
const LEAST_NORM: f64 = 1e-9;

/// A discrete form of a kernel. Clones share their numbers.
#[derive(Clone)]
pub(super) struct Variant {
    basis: BasisOfRows,
    /// Factor of the basis.
    factor: f64,
    probability: f64,
    /// The basis at the rows of the fitted table, where it was evaluated once.
    fitted: Basis,
    /// Its mean row.
    mean: Vec<f64>,
}

impl Variant {
    /// Returns a variant with unit variance at the rows of the fitted table; `None` if it is zero there.
    pub(super) fn of_unit_variance(basis: BasisOfRows, rows: &Covariates, probability: f64) -> Option<Self> {
        let columns = basis(rows);
        let norm = kernel::rms_norm(&columns);
        (norm > LEAST_NORM).then(|| Self::scaled(basis, columns, 1.0 / norm, probability))
    }

    /// Returns a variant with the height of its basis.
    pub(super) fn as_is(basis: BasisOfRows, rows: &Covariates, probability: f64) -> Self {
        let columns = basis(rows);
        Self::scaled(basis, columns, 1.0, probability)
    }

    fn scaled(basis: BasisOfRows, columns: DMatrix<f64>, factor: f64, probability: f64) -> Self {
        let columns = columns * factor;
        let mean = columns.row_mean().iter().copied().collect();
        Self { basis, factor, probability, fitted: columns.into(), mean }
    }

    /// Returns the variant with another probability.
    pub(super) fn with_probability(&self, probability: f64) -> Self {
        Self { probability, ..self.clone() }
    }

    fn columns(&self, rows: &Covariates) -> DMatrix<f64> {
        (self.basis)(rows) * self.factor
    }
}

/// A kernel that a table supports, for one channel.
pub(super) struct Structure {
    pub(super) covariate: &'static str,
    pub(super) name: String,
    pub(super) channel: Channel,
    pub(super) record: Record,
    pub(super) is_session_bound: bool,
    pub(super) scale: f64,
    pub(super) bases: Rc<Vec<Variant>>,
    /// Process of the levels of sessions of each variant; empty for a kernel over another covariate.
    pub(super) session_levels: Vec<SessionLevels>,
}

impl Structure {
    /// Returns the kernel for the space of hypotheses.
    pub(super) fn space(&self) -> Kernel {
        Kernel {
            name: self.name.clone(),
            covariate: self.covariate.to_owned(),
            channel: self.channel.index(),
            scale: self.scale,
            variants: self.bases.iter().map(|variant| variant.probability).collect(),
            is_session_bound: self.is_session_bound,
            session_levels: self.session_levels.clone(),
            noise_probability: match self.covariate {
                NOISE => Some(WANDERING_PROBABILITY),
                GROSS_ERROR => Some(SERIES_PROBABILITY),
                _ => None,
            },
            is_gross_error: self.covariate == GROSS_ERROR,
        }
    }

    /// Returns the bases at other rows of the fitted session.
    fn bases(&self, rows: &Covariates) -> Vec<Basis> {
        self.bases.iter().map(|variant| variant.columns(rows).into()).collect()
    }

    /// Returns the bases at the rows of a new session: what a session draws again has its mean, except a gross error, which no
    /// other session has.
    fn bases_of_new_session(&self, rows: &Covariates) -> Vec<Basis> {
        if !self.is_session_bound {
            return self.bases(rows);
        }
        let share = if self.covariate == GROSS_ERROR { 0.0 } else { 1.0 };
        let repeated = |variant: &Variant| {
            DMatrix::from_fn(rows.len(), variant.mean.len(), |_, column| share * variant.mean[column]).into()
        };
        self.bases.iter().map(repeated).collect()
    }
}

/// Returns the bases of structures at the rows of the fitted table.
pub(super) fn fitted_bases(structures: &[Structure]) -> Vec<Vec<Basis>> {
    let of = |structure: &Structure| structure.bases.iter().map(|variant| variant.fitted.clone()).collect();
    structures.iter().map(of).collect()
}

/// Returns the bases of structures at other rows of the fitted session or at those of a new one. Those of one covariate share them.
pub(super) fn bases(structures: &[Structure], rows: &Covariates, session: Session) -> Vec<Vec<Basis>> {
    let mut all: Vec<Vec<Basis>> = Vec::new();
    for (i, structure) in structures.iter().enumerate() {
        let is_shared = |other: &Structure| Rc::ptr_eq(&other.bases, &structure.bases);
        let shared = structures[..i].iter().rposition(is_shared).map(|other| all[other].clone());
        all.push(shared.unwrap_or_else(|| match session {
            Session::New => structure.bases_of_new_session(rows),
            Session::Fitted => structure.bases(rows),
        }));
    }
    all
}
