//! Formulas and conditions: one small expression language for user-defined effects and for
//! constraints of sweeps.
//!
//! A [`Formula`] evaluates to a number, a [`Condition`] to a truth value. Both consist of these
//! elements. Operators are listed with the highest precedence first; brackets override it:
//!
//! | element | spelling | notes |
//! | --- | --- | --- |
//! | numbers | `12`, `0.5`, `.5`, `1e-3` | finite and not negative; `-` is an operator |
//! | names | `load_n`, `shell.width_mm` | letters, digits, `_`, and a dot before a letter; the caller resolves them |
//! | power | `a ^ b` | right-associative: `2^3^2` is `2^(3^2)`; before a sign: `-x^2` is `-(x^2)` |
//! | prefixes | `-a`, `!a` | `!` negates a truth value: `!(a < b)` |
//! | products | `a * b`, `a / b` | left-associative |
//! | sums | `a + b`, `a - b` | left-associative |
//! | comparisons | `<`, `<=`, `>`, `>=`, `==`, `!=` | of numbers, not chained; `==` and `!=` also of truth values |
//! | conjunction | `a && b`, `a and b` | of truth values |
//! | disjunction | <code>a \|\| b</code>, `a or b` | of truth values |
//! | functions of one value | `exp ln sqrt abs sin cos tanh round floor ceil` | `round` rounds halves away from zero |
//! | functions of two values | `min(a, b)`, `max(a, b)` | |
//!
//! **Types.** Comparisons and logical operators give truth values. Arithmetic and functions take a
//! truth value as 1 or 0, so that `k*(time > 0.5)` is a step. Logical operators do not take a number:
//! `a && 1` is an error at the `1`. A formula must evaluate to a number, and a condition to a truth
//! value.
//!
//! **Undefined values.** A value that does not exist is not a number (NaN). A comparison with it is
//! neither true nor false, and a [`Condition`] that depends on it is undecided: `threshold_n > 20
//! || 1 < 2` is true without a threshold, `threshold_n > 20` and `!(threshold_n > 20)` are
//! undecided. In arithmetic an undecided truth value counts as 0.
//!
//! **Bounds.** A formula has at most 1000 characters and at most 100 nested operations. This bounds
//! the stack and the time of parsing and evaluation, for any text.
//!
//! ```
//! use pinswitch_formula::{Formula, NameError};
//!
//! let names = ["k", "load_n"];
//! let resolve = |name: &str| {
//!     let place = names.iter().position(|known| *known == name);
//!     place.ok_or_else(|| NameError::unknown("variable", name, names))
//! };
//! let formula = Formula::parse("k * ln(load_n/50) + 2 * (load_n > 40)", resolve)?;
//! let values = [0.1, 50.0];
//! assert_eq!(formula.value(|place| values[*place]), 2.0);
//!
//! let error = Formula::parse("k * laod_n", resolve).unwrap_err();
//! assert_eq!(
//!     error.to_diagnostic("k * laod_n").render("error"),
//!     "error: unknown variable 'laod_n' [unknown-name]\n\
//!      \x20 1 | k * laod_n\n\
//!      \x20   |     ^^^^^^\n\
//!      \x20 help: did you mean load_n?"
//! );
//! # Ok::<(), pinswitch_formula::FormulaError>(())
//! ```
//!
//! The truth value of a condition is `None` if it is undecided:
//!
//! ```
//! use pinswitch_formula::{Condition, NameError};
//!
//! let condition = Condition::parse("width >= 12 and !(threshold > 30)", |name| Ok::<_, NameError>(name.to_owned()))?;
//! let read = |threshold: f64| move |name: &String| if name == "width" { 14.0 } else { threshold };
//! assert_eq!(condition.truth(read(24.0)), Some(true));
//! assert_eq!(condition.truth(read(40.0)), Some(false));
//! assert_eq!(condition.truth(read(f64::NAN)), None);
//!
//! let error = Condition::parse("width + 1", |name| Ok::<_, NameError>(name.to_owned())).unwrap_err();
//! assert_eq!(error.problem(), "expected a condition, found a number");
//! # Ok::<(), pinswitch_formula::FormulaError>(())
//! ```

mod error;
mod evaluate;
mod names;
mod nearest;
mod parser;
#[cfg(test)]
mod tests;
mod token;
mod tree;
mod writer;

pub use error::{FormulaError, NameError};
pub use names::is_reserved;
pub use nearest::nearest;
pub use tree::{Condition, Formula, Function, Kind, Node, Operator, Type};

/// Most characters of a formula.
pub const MAX_LENGTH: usize = 1000;
/// Most nested operations: evaluation recurses into them, and must not exhaust the stack.
pub const MAX_DEPTH: usize = 100;
