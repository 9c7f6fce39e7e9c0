//! Numbers of both directions of motion, computed side by side.

use std::ops::{Add, Div, Mul, Sub};

/// A number of the eccentric and of the concentric direction.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Pair(pub(super) [f64; 2]);

impl Pair {
    pub(super) const ZERO: Self = Self([0.0; 2]);

    /// Returns the same number for both directions.
    #[inline(always)]
    pub(super) fn both(x: f64) -> Self {
        Self([x; 2])
    }

    /// Applies `f` to each number.
    #[inline(always)]
    pub(super) fn map(self, f: impl Fn(f64) -> f64) -> Self {
        Self([f(self.0[0]), f(self.0[1])])
    }

    /// Applies `f` to the numbers of each direction.
    #[inline(always)]
    pub(super) fn zip(self, other: Self, f: impl Fn(f64, f64) -> f64) -> Self {
        Self([f(self.0[0], other.0[0]), f(self.0[1], other.0[1])])
    }

    /// Returns the larger number of each direction.
    #[inline(always)]
    pub(super) fn max(self, other: Self) -> Self {
        self.zip(other, |a, b| if b > a { b } else { a })
    }

    /// Returns the smaller number of each direction.
    #[inline(always)]
    pub(super) fn min(self, other: Self) -> Self {
        self.zip(other, |a, b| if b < a { b } else { a })
    }

    /// Whether both numbers satisfy `condition`.
    #[inline(always)]
    pub(super) fn all(self, condition: impl Fn(f64) -> bool) -> bool {
        condition(self.0[0]) && condition(self.0[1])
    }
}

/// Implements an operator element by element, with a pair on the right.
macro_rules! elementwise {
    ($($operator:ident $method:ident $symbol:tt;)*) => {
        $(impl $operator for Pair {
            type Output = Self;

            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Self([self.0[0] $symbol other.0[0], self.0[1] $symbol other.0[1]])
            }
        })*
    };
}

elementwise! {
    Add add +;
    Sub sub -;
    Mul mul *;
    Div div /;
}

impl Mul<f64> for Pair {
    type Output = Self;

    #[inline(always)]
    fn mul(self, by: f64) -> Self {
        Self([self.0[0] * by, self.0[1] * by])
    }
}
