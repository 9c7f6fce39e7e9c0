//! Formulas as text: with few brackets, and parsed back to the same tree.

use std::fmt::{self, Display, Formatter};

use crate::parser::{OPERATORS, Precedence};
use crate::tree::PAIRS;
use crate::{Condition, Formula, Kind, Node, Operator};

impl<N> Node<N> {
    fn precedence(&self) -> Precedence {
        match self.kind() {
            Kind::Number(_) | Kind::Name(_) | Kind::Call(..) => Precedence::Atom,
            Kind::Negated(_) | Kind::Not(_) => Precedence::Prefix,
            Kind::Binary(operator, ..) => {
                operator.sign().map_or(Precedence::Atom, |(_, precedence)| precedence)
            }
        }
    }
}

impl Operator {
    /// Returns the sign between two operands; `None` of a function.
    fn sign(self) -> Option<(&'static str, Precedence)> {
        let entry = OPERATORS.iter().find(|(_, operator, _)| *operator == self);
        entry.map(|(sign, _, precedence)| (*sign, *precedence))
    }
}

/// Writes a part, in brackets if it binds less than `least`.
fn write<N: Display>(f: &mut Formatter<'_>, node: &Node<N>, least: Precedence) -> fmt::Result {
    if node.precedence() < least {
        f.write_str("(")?;
        write_bare(f, node)?;
        f.write_str(")")
    } else {
        write_bare(f, node)
    }
}

fn write_bare<N: Display>(f: &mut Formatter<'_>, node: &Node<N>) -> fmt::Result {
    match node.kind() {
        // The shortest digits that read back to the same number.
        Kind::Number(value) => write!(f, "{value:?}"),
        Kind::Name(name) => write!(f, "{name}"),
        Kind::Negated(a) => {
            f.write_str("-")?;
            write(f, a, Precedence::Prefix)
        }
        Kind::Not(a) => {
            f.write_str("!")?;
            write(f, a, Precedence::Prefix)
        }
        Kind::Call(function, a) => write!(f, "{}({a})", function.name()),
        Kind::Binary(operator, a, b) => match operator.sign() {
            Some((sign, precedence)) => {
                let (left, right) = match operator {
                    Operator::Power => (precedence.stronger(), precedence),
                    // Comparisons cannot be chained.
                    _ if operator.is_comparison() => (precedence.stronger(), precedence.stronger()),
                    _ => (precedence, precedence.stronger()),
                };
                write(f, a, left)?;
                write!(f, " {sign} ")?;
                write(f, b, right)
            }
            None => {
                let name = PAIRS.iter().find(|(_, pair)| pair == operator).map_or("", |(name, _)| name);
                write!(f, "{name}({a}, {b})")
            }
        },
    }
}

impl<N: Display> Display for Node<N> {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        write(f, self, Precedence::Or)
    }
}

impl<N: Display> Display for Formula<N> {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        self.root.fmt(f)
    }
}

impl<N: Display> Display for Condition<N> {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        self.root.fmt(f)
    }
}
