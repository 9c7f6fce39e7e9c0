//! A kernel of unnamed structure, with its bases at the rows of the fitted session and of a new one.

use std::rc::Rc;

use nalgebra::DMatrix;
use pinswitch_inference::{Basis, Kernel, SERIES_PROBABILITY, SessionLevels};

use super::covariates::Covariates;
use super::forward::Channel;
use super::variant::Variant;
use super::{SPECIMEN, Session};
use crate::effects::Abscissa;

/// Covariate of noise.
pub(super) const NOISE: &str = "noise";
/// Covariate of gross errors of a series.
pub(super) const GROSS_ERROR: &str = "gross error";
/// Prior probability that offsets of series wander, for each channel: that of an effect.
const WANDERING_PROBABILITY: f64 = 0.05;

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
    /// Returns the kernel for the space of hypotheses, with the number of its bases.
    fn space(&self, bases: usize) -> Kernel {
        Kernel {
            name: self.name.clone(),
            covariate: self.covariate.to_owned(),
            bases,
            channel: self.channel.index(),
            scale: self.scale,
            variants: self.bases.iter().map(|variant| variant.probability).collect(),
            is_session_bound: self.is_session_bound,
            session_levels: self.session_levels.clone(),
            is_of_specimens: self.covariate == SPECIMEN,
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

/// Returns the kernels for the space of hypotheses.
pub(super) fn kernels(structures: &[Structure]) -> Vec<Kernel> {
    let groups = structures.chunk_by(|a, b| Rc::ptr_eq(&a.bases, &b.bases)).enumerate();
    groups.flat_map(|(bases, group)| group.iter().map(move |structure| structure.space(bases))).collect()
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
