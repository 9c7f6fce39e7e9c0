//! Explicit derivatives of the equations with respect to a parameter: of the forces, the wrap and the constants, with gap
//! and tension fixed.

use crate::physics::pair::Pair;

/// Explicit derivatives with respect to one parameter. An empty list is zero.
#[derive(Clone, Debug, Default)]
pub(in crate::physics) struct Explicit {
    /// Of the force on each node that gap and tension balance, without the pins, N.
    pub(in crate::physics) node_n: Vec<Pair>,
    /// Of the force of the silicone on each node, N.
    pub(in crate::physics) silicone_n: Vec<Pair>,
    /// Of the force of each pin, N.
    pub(in crate::physics) pin_n: Vec<Pair>,
    /// Of the logarithm of `kappa`.
    pub(in crate::physics) log_kappa: f64,
    /// Of the logarithm of `mu_s`.
    pub(in crate::physics) log_mu: f64,
    /// Of the logarithm of the wrap angle.
    pub(in crate::physics) log_wrap: f64,
    /// Of the logarithm of the load.
    pub(in crate::physics) log_load: f64,
}
