//! Evaluation. Transcendental functions are those of `libm`: the same digits on every platform.

use crate::{Condition, Formula, Function, Kind, Node, Operator, Type};

impl<N> Formula<N> {
    /// Returns its value; `read` gives the value of a name, NaN where it has none.
    pub fn value(&self, read: impl Fn(&N) -> f64) -> f64 {
        self.root.value(&read)
    }
}

impl<N> Condition<N> {
    /// Returns its truth value; `None` where it depends on a value that is not a number. `read`
    /// gives the value of a name, NaN where it has none.
    pub fn truth(&self, read: impl Fn(&N) -> f64) -> Option<bool> {
        self.root.truth(&read)
    }
}

impl<N> Node<N> {
    /// Returns its value if it contains no names.
    pub fn constant(&self) -> Option<f64> {
        let has_names = self.any(&|node| matches!(node.kind(), Kind::Name(_)));
        (!has_names).then(|| self.value(&|_| f64::NAN))
    }

    /// Returns its value as a number; a truth value counts as 1, its negation and an undecided one
    /// as 0.
    fn value<F: Fn(&N) -> f64>(&self, read: &F) -> f64 {
        match self.kind() {
            Kind::Number(value) => *value,
            Kind::Name(name) => read(name),
            Kind::Negated(a) => -a.value(read),
            Kind::Call(function, a) => function.value(a.value(read)),
            Kind::Binary(operator, a, b) if operator.result() == Type::Number => {
                operator.value(a.value(read), b.value(read))
            }
            Kind::Not(_) | Kind::Binary(..) => f64::from(u8::from(self.truth(read) == Some(true))),
        }
    }

    /// Returns its truth value; `None` if it is undecided.
    fn truth<F: Fn(&N) -> f64>(&self, read: &F) -> Option<bool> {
        match self.kind() {
            Kind::Not(a) => a.truth(read).map(|truth| !truth),
            Kind::Binary(Operator::And, a, b) => match (a.truth(read), b.truth(read)) {
                (Some(false), _) | (_, Some(false)) => Some(false),
                (a, b) => a.and(b),
            },
            Kind::Binary(Operator::Or, a, b) => match (a.truth(read), b.truth(read)) {
                (Some(true), _) | (_, Some(true)) => Some(true),
                (a, b) => a.and(b),
            },
            Kind::Binary(operator, a, b) if a.ty() == Type::Truth => {
                let are_equal = a.truth(read)? == b.truth(read)?;
                Some(are_equal == (*operator == Operator::Equal))
            }
            Kind::Binary(operator, a, b) => operator.truth(a.value(read), b.value(read)),
            // Numbers: the types of a tree keep them out of here.
            Kind::Number(_) | Kind::Name(_) | Kind::Negated(_) | Kind::Call(..) => None,
        }
    }
}

impl Function {
    fn value(self, a: f64) -> f64 {
        match self {
            Self::Exp => libm::exp(a),
            Self::Ln => libm::log(a),
            Self::Sqrt => a.sqrt(),
            Self::Abs => a.abs(),
            Self::Sin => libm::sin(a),
            Self::Cos => libm::cos(a),
            Self::Tanh => libm::tanh(a),
            Self::Round => a.round(),
            Self::Floor => a.floor(),
            Self::Ceil => a.ceil(),
        }
    }
}

impl Operator {
    /// Returns the value of an operator that gives a number; NaN of any other.
    fn value(self, a: f64, b: f64) -> f64 {
        match self {
            Self::Add => a + b,
            Self::Subtract => a - b,
            Self::Multiply => a * b,
            Self::Divide => a / b,
            Self::Power => libm::pow(a, b),
            Self::Min => a.min(b),
            Self::Max => a.max(b),
            _ => f64::NAN,
        }
    }

    /// Returns the result of a comparison; `None` of a value that is not a number, and of any other
    /// operator.
    fn truth(self, a: f64, b: f64) -> Option<bool> {
        let order = a.partial_cmp(&b)?;
        match self {
            Self::Less => Some(order.is_lt()),
            Self::LessOrEqual => Some(order.is_le()),
            Self::Greater => Some(order.is_gt()),
            Self::GreaterOrEqual => Some(order.is_ge()),
            Self::Equal => Some(order.is_eq()),
            Self::NotEqual => Some(order.is_ne()),
            _ => None,
        }
    }
}
