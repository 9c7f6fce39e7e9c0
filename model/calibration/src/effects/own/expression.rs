//! A formula as a tree, with its names resolved: made once, evaluated for each row.

use super::variable::{Moment, Variable};

/// Most operations inside each other: what is evaluated by recursion must not exhaust the stack.
pub(super) const MAX_DEPTH: usize = 100;

/// What is wrong with a formula, and at which byte of it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Fault {
    pub(super) at: usize,
    pub(super) problem: String,
}

impl Fault {
    pub(super) fn new(at: usize, problem: impl Into<String>) -> Self {
        Self { at, problem: problem.into() }
    }
}

/// An operator between two values.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Operator {
    Add,
    Subtract,
    Multiply,
    Divide,
    Power,
    Less,
    AtMost,
    More,
    AtLeast,
    Equal,
    Unequal,
    Least,
    Greatest,
}

impl Operator {
    /// Whether its value is 0 or 1.
    fn compares(self) -> bool {
        use Operator::{AtLeast, AtMost, Equal, Less, More, Unequal};
        matches!(self, Less | AtMost | More | AtLeast | Equal | Unequal)
    }
}

/// A function of one value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Function {
    Exp,
    Ln,
    Sqrt,
    Abs,
    Sin,
    Cos,
    Tanh,
}

/// A part of a formula with the byte at which it, or its operator, stands.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Node {
    pub(super) at: usize,
    pub(super) kind: Kind,
    depth: usize,
}

/// What a part of a formula is.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Kind {
    Number(f64),
    Variable(&'static Variable),
    /// A constant of the effect, by its place.
    Constant(usize),
    Negated(Box<Node>),
    Binary(Operator, Box<Node>, Box<Node>),
    Call(Function, Box<Node>),
}

impl Node {
    /// Whether it is 0 or 1 by a comparison.
    pub(super) fn is_comparison(&self) -> bool {
        matches!(&self.kind, Kind::Binary(operator, ..) if operator.compares())
    }

    /// Whether a part of it depends on where a row lies: a comparison, or the greater or lesser of two.
    pub(super) fn has_condition(&self) -> bool {
        match &self.kind {
            Kind::Number(_) | Kind::Variable(_) | Kind::Constant(_) => false,
            Kind::Negated(a) | Kind::Call(_, a) => a.has_condition(),
            Kind::Binary(operator, a, b) => {
                operator.compares()
                    || matches!(operator, Operator::Least | Operator::Greatest)
                    || a.has_condition()
                    || b.has_condition()
            }
        }
    }

    /// A part; its parts are there already.
    ///
    /// # Errors
    /// If it is nested too deeply.
    pub(super) fn new(at: usize, kind: Kind) -> Result<Node, Fault> {
        let depth = 1 + match &kind {
            Kind::Number(_) | Kind::Variable(_) | Kind::Constant(_) => 0,
            Kind::Negated(a) | Kind::Call(_, a) => a.depth,
            Kind::Binary(_, a, b) => a.depth.max(b.depth),
        };
        if depth > MAX_DEPTH {
            return Err(too_deep(at));
        }
        Ok(Node { at, kind, depth })
    }

    /// Its value in a row with these constants.
    pub(super) fn value(&self, k: &[f64], moment: &Moment<'_>) -> f64 {
        let one_if = |holds: bool| f64::from(u8::from(holds));
        match &self.kind {
            Kind::Number(value) => *value,
            Kind::Variable(variable) => (variable.of)(moment),
            Kind::Constant(place) => k.get(*place).copied().unwrap_or(f64::NAN),
            Kind::Negated(a) => -a.value(k, moment),
            Kind::Call(function, a) => {
                let a = a.value(k, moment);
                match function {
                    Function::Exp => libm::exp(a),
                    Function::Ln => libm::log(a),
                    Function::Sqrt => a.sqrt(),
                    Function::Abs => a.abs(),
                    Function::Sin => libm::sin(a),
                    Function::Cos => libm::cos(a),
                    Function::Tanh => libm::tanh(a),
                }
            }
            Kind::Binary(operator, a, b) => {
                let (a, b) = (a.value(k, moment), b.value(k, moment));
                match operator {
                    Operator::Add => a + b,
                    Operator::Subtract => a - b,
                    Operator::Multiply => a * b,
                    Operator::Divide => a / b,
                    Operator::Power => libm::pow(a, b),
                    Operator::Less => one_if(a < b),
                    Operator::AtMost => one_if(a <= b),
                    Operator::More => one_if(a > b),
                    Operator::AtLeast => one_if(a >= b),
                    Operator::Equal => one_if(a == b),
                    Operator::Unequal => one_if(a != b),
                    Operator::Least => a.min(b),
                    Operator::Greatest => a.max(b),
                }
            }
        }
    }

    /// Its value if it holds nothing but numbers.
    pub(super) fn number(&self) -> Option<f64> {
        let holds_numbers_only =
            self.all(&|node| !matches!(node.kind, Kind::Variable(_) | Kind::Constant(_)));
        let point = crate::table::Point::default();
        let condition = crate::table::Condition::default();
        let moment = Moment { point: &point, condition: &condition, load_n: 0.0, tension_n: 0.0 };
        holds_numbers_only.then(|| self.value(&[], &moment))
    }

    /// Whether something holds of all parts.
    pub(super) fn all(&self, holds: &dyn Fn(&Node) -> bool) -> bool {
        holds(self)
            && match &self.kind {
                Kind::Number(_) | Kind::Variable(_) | Kind::Constant(_) => true,
                Kind::Negated(a) | Kind::Call(_, a) => a.all(holds),
                Kind::Binary(_, a, b) => a.all(holds) && b.all(holds),
            }
    }

    /// Whether it has the constant of this place.
    pub(super) fn has_constant(&self, place: usize) -> bool {
        !self.all(&|node| node.kind != Kind::Constant(place))
    }

    /// Whether it reads a variable for which this holds.
    pub(super) fn reads(&self, which: impl Fn(&Variable) -> bool) -> bool {
        !self.all(&|node| !matches!(node.kind, Kind::Variable(v) if which(v)))
    }
}

pub(super) fn too_deep(at: usize) -> Fault {
    Fault::new(at, format!("more than {MAX_DEPTH} operations inside each other; write it shorter"))
}
