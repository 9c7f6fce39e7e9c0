//! The syntax tree: typed, of bounded depth, with resolved names.

use std::ops::Range;

use pinswitch_diagnostic::codes;

use crate::{FormulaError, MAX_DEPTH};

/// Type of a value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Type {
    /// A number.
    Number,
    /// True or false.
    Truth,
}

/// An operator of two values.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Operator {
    /// `a + b`
    Add,
    /// `a - b`
    Subtract,
    /// `a * b`
    Multiply,
    /// `a / b`
    Divide,
    /// `a ^ b`
    Power,
    /// `min(a, b)`
    Min,
    /// `max(a, b)`
    Max,
    /// `a < b`
    Less,
    /// `a <= b`
    LessOrEqual,
    /// `a > b`
    Greater,
    /// `a >= b`
    GreaterOrEqual,
    /// `a == b`
    Equal,
    /// `a != b`
    NotEqual,
    /// `a && b`
    And,
    /// `a || b`
    Or,
}

impl Operator {
    /// Returns whether it compares two values.
    pub fn is_comparison(self) -> bool {
        use Operator::{Equal, Greater, GreaterOrEqual, Less, LessOrEqual, NotEqual};
        matches!(self, Less | LessOrEqual | Greater | GreaterOrEqual | Equal | NotEqual)
    }

    /// Returns whether it joins two truth values.
    pub fn is_logical(self) -> bool {
        matches!(self, Self::And | Self::Or)
    }

    /// Returns the type of its result.
    pub fn result(self) -> Type {
        if self.is_comparison() || self.is_logical() { Type::Truth } else { Type::Number }
    }
}

/// A function of one number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Function {
    /// Exponential function.
    Exp,
    /// Natural logarithm.
    Ln,
    /// Square root.
    Sqrt,
    /// Absolute value.
    Abs,
    /// Sine of an angle in radians.
    Sin,
    /// Cosine of an angle in radians.
    Cos,
    /// Hyperbolic tangent.
    Tanh,
    /// Nearest whole number, halves away from zero.
    Round,
    /// Largest whole number that is not above.
    Floor,
    /// Smallest whole number that is not below.
    Ceil,
}

/// Functions of one value by their names.
pub(crate) const FUNCTIONS: [(&str, Function); 10] = [
    ("exp", Function::Exp),
    ("ln", Function::Ln),
    ("sqrt", Function::Sqrt),
    ("abs", Function::Abs),
    ("sin", Function::Sin),
    ("cos", Function::Cos),
    ("tanh", Function::Tanh),
    ("round", Function::Round),
    ("floor", Function::Floor),
    ("ceil", Function::Ceil),
];
/// Functions of two values by their names.
pub(crate) const PAIRS: [(&str, Operator); 2] = [("min", Operator::Min), ("max", Operator::Max)];

impl Function {
    /// Returns its name in formulas.
    pub fn name(self) -> &'static str {
        FUNCTIONS.iter().find(|(_, function)| *function == self).map_or("", |(name, _)| name)
    }
}

/// A part of a formula. `N` is what the caller makes of a name.
///
/// Two nodes are equal if they compute the same in the same way; where they are in their formulas
/// does not matter.
#[derive(Clone, Debug)]
pub struct Node<N> {
    kind: Kind<N>,
    span: Range<usize>,
    extent: Range<usize>,
    depth: usize,
}

/// What a part of a formula is.
#[derive(Clone, Debug, PartialEq)]
pub enum Kind<N> {
    /// A number as written: finite and not negative.
    Number(f64),
    /// A name.
    Name(N),
    /// `-a`
    Negated(Box<Node<N>>),
    /// `!a`
    Not(Box<Node<N>>),
    /// A function of one value.
    Call(Function, Box<Node<N>>),
    /// An operator, or a function of two values.
    Binary(Operator, Box<Node<N>>, Box<Node<N>>),
}

impl<N: PartialEq> PartialEq for Node<N> {
    fn eq(&self, other: &Self) -> bool {
        self.kind == other.kind
    }
}

impl<N> Node<N> {
    /// A part whose own parts exist already; `span` are the bytes of its token.
    ///
    /// # Errors
    /// Operands of the wrong type, and more than [`MAX_DEPTH`] nested operations.
    pub(crate) fn new(span: Range<usize>, kind: Kind<N>) -> Result<Self, FormulaError> {
        check_types(&span, &kind)?;
        let depth = 1 + kind.parts().map(|part| part.depth).max().unwrap_or(0);
        if depth > MAX_DEPTH {
            return Err(too_deep(span));
        }
        let extent = kind
            .parts()
            .fold(span.clone(), |all, part| all.start.min(part.extent.start)..all.end.max(part.extent.end));
        Ok(Self { kind, span, extent, depth })
    }

    /// The same part with the brackets that end here.
    pub(crate) fn in_brackets(self, start: usize, end: usize) -> Self {
        Self { extent: start..end, ..self }
    }

    /// Returns what it is.
    pub fn kind(&self) -> &Kind<N> {
        &self.kind
    }

    /// Returns the bytes of its token in the formula: of an operator, only those of its sign.
    pub fn span(&self) -> Range<usize> {
        self.span.clone()
    }

    /// Returns the bytes from its first to its last token, with brackets around it.
    pub fn extent(&self) -> Range<usize> {
        self.extent.clone()
    }

    /// Returns the type of its value.
    pub fn ty(&self) -> Type {
        match &self.kind {
            Kind::Number(_) | Kind::Name(_) | Kind::Negated(_) | Kind::Call(..) => Type::Number,
            Kind::Not(_) => Type::Truth,
            Kind::Binary(operator, ..) => operator.result(),
        }
    }

    /// Returns whether it or one of its parts meets a condition.
    pub fn any(&self, condition: &dyn Fn(&Node<N>) -> bool) -> bool {
        condition(self) || self.kind.parts().any(|part| part.any(condition))
    }

    /// Returns the names, as often as they occur, in the order of the formula.
    pub fn names(&self) -> Vec<&N> {
        match &self.kind {
            Kind::Name(name) => vec![name],
            kind => kind.parts().flat_map(Node::names).collect(),
        }
    }

    /// Returns whether it distinguishes cases: by a truth value, by rounding, by `min` or by `max`.
    pub fn has_cases(&self) -> bool {
        self.any(&|node| match node.kind {
            Kind::Not(_) => true,
            Kind::Call(function, _) => {
                matches!(function, Function::Round | Function::Floor | Function::Ceil)
            }
            Kind::Binary(operator, ..) => {
                operator.result() == Type::Truth || matches!(operator, Operator::Min | Operator::Max)
            }
            Kind::Number(_) | Kind::Name(_) | Kind::Negated(_) => false,
        })
    }
}

impl<N> Kind<N> {
    /// Returns its parts from left to right.
    fn parts(&self) -> impl Iterator<Item = &Node<N>> {
        let [first, second] = match self {
            Kind::Number(_) | Kind::Name(_) => [None, None],
            Kind::Negated(a) | Kind::Not(a) | Kind::Call(_, a) => [Some(a), None],
            Kind::Binary(_, a, b) => [Some(a), Some(b)],
        };
        first.into_iter().chain(second).map(AsRef::as_ref)
    }
}

/// Refuses operands of the wrong type; `span` are the bytes of the operator.
fn check_types<N>(span: &Range<usize>, kind: &Kind<N>) -> Result<(), FormulaError> {
    const HELP: &str = "join comparisons with && or ||";
    match kind {
        Kind::Not(a) => expect_truth(a, "!"),
        Kind::Binary(operator, a, b) if operator.is_logical() => {
            let sign = if *operator == Operator::And { "&&" } else { "||" };
            expect_truth(a, sign).and_then(|()| expect_truth(b, sign))
        }
        Kind::Binary(operator, a, b) if operator.is_comparison() => match (a.ty(), b.ty()) {
            (Type::Number, Type::Number) => Ok(()),
            (Type::Truth, Type::Truth) if matches!(operator, Operator::Equal | Operator::NotEqual) => Ok(()),
            (Type::Truth, Type::Truth) => {
                Err(FormulaError::new(codes::FORMULA_SYNTAX, span.clone(), "truth values have no order")
                    .with_help(HELP))
            }
            (Type::Number, Type::Truth) => Err(FormulaError::new(
                codes::FORMULA_SYNTAX,
                b.extent(),
                "cannot compare a number with a truth value",
            )
            .with_help(HELP)),
            (Type::Truth, Type::Number) => Err(FormulaError::new(
                codes::FORMULA_SYNTAX,
                b.extent(),
                "cannot compare a truth value with a number",
            )
            .with_help(HELP)),
        },
        Kind::Number(_) | Kind::Name(_) | Kind::Negated(_) | Kind::Call(..) | Kind::Binary(..) => Ok(()),
    }
}

/// Refuses a number as an operand of the logical operator with this sign.
fn expect_truth<N>(operand: &Node<N>, sign: &str) -> Result<(), FormulaError> {
    if operand.ty() == Type::Truth {
        return Ok(());
    }
    let problem = format!("'{sign}' needs a condition, found a number");
    Err(FormulaError::new(codes::FORMULA_SYNTAX, operand.extent(), problem)
        .with_help("write a comparison, such as (a < b)"))
}

pub(crate) fn too_deep(span: Range<usize>) -> FormulaError {
    FormulaError::new(codes::FORMULA_SYNTAX, span, format!("more than {MAX_DEPTH} nested operations"))
        .with_help("shorten the formula")
}

/// A formula that evaluates to a number.
#[derive(Clone, Debug, PartialEq)]
pub struct Formula<N> {
    pub(crate) root: Node<N>,
}

/// A formula that evaluates to a truth value.
#[derive(Clone, Debug, PartialEq)]
pub struct Condition<N> {
    pub(crate) root: Node<N>,
}

impl<N> Formula<N> {
    /// Returns the tree.
    pub fn root(&self) -> &Node<N> {
        &self.root
    }
}

impl<N> Condition<N> {
    /// Returns the tree.
    pub fn root(&self) -> &Node<N> {
        &self.root
    }
}
