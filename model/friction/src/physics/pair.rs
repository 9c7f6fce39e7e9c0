//! Numbers of both directions of motion, computed side by side, which hides latencies and lets the
//! compiler use vector registers.

use std::ops::{Add, Div, Mul, Sub};

/// A number of the eccentric and of the concentric direction.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Pair([f64; 2]);

impl Pair {
    /// Creates the pair of these numbers.
    #[inline(always)]
    pub(super) fn new(numbers: [f64; 2]) -> Self {
        Self(numbers)
    }

    /// Returns the same number for both directions.
    #[inline(always)]
    pub(super) fn both(x: f64) -> Self {
        Self([x; 2])
    }

    /// Returns both numbers.
    #[inline(always)]
    pub(super) fn numbers(self) -> [f64; 2] {
        self.0
    }

    /// Returns the number of one direction, 0 or 1.
    #[inline(always)]
    pub(super) fn lane(self, direction: usize) -> f64 {
        self.0[direction]
    }

    /// Applies `f` to each number.
    #[inline(always)]
    pub(super) fn map(self, f: impl Fn(f64) -> f64) -> Self {
        Self([f(self.0[0]), f(self.0[1])])
    }

    /// Applies `f` to the numbers of each direction.
    #[inline(always)]
    fn zip(self, other: Self, f: impl Fn(f64, f64) -> f64) -> Self {
        Self([f(self.0[0], other.0[0]), f(self.0[1], other.0[1])])
    }

    /// Returns the larger number of each direction; this one if the other is not a number.
    #[inline(always)]
    pub(super) fn max(self, other: Self) -> Self {
        self.zip(other, |a, b| if b > a { b } else { a })
    }

    /// Returns the smaller number of each direction; this one if the other is not a number.
    #[inline(always)]
    pub(super) fn min(self, other: Self) -> Self {
        self.zip(other, |a, b| if b < a { b } else { a })
    }

    /// Returns the magnitudes.
    #[inline(always)]
    pub(super) fn abs(self) -> Self {
        self.map(f64::abs)
    }

    /// Returns the square roots.
    #[inline(always)]
    pub(super) fn sqrt(self) -> Self {
        self.map(f64::sqrt)
    }

    /// Returns `x` in the directions where this number is negative, else zero.
    #[inline(always)]
    pub(super) fn where_negative(self, x: Self) -> Self {
        self.zip(x, |u, x| if u < 0.0 { x } else { 0.0 })
    }

    /// Whether both numbers satisfy `condition`.
    #[inline(always)]
    pub(super) fn all(self, condition: impl Fn(f64) -> bool) -> bool {
        condition(self.0[0]) && condition(self.0[1])
    }
}

/// Implements an operator element by element.
macro_rules! elementwise {
    ($($operator:ident $method:ident $symbol:tt;)*) => {
        $(impl $operator for Pair {
            type Output = Self;

            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                self.zip(other, |a, b| a $symbol b)
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
        self.map(|a| a * by)
    }
}
