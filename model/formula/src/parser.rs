//! A parser by precedence climbing.
//!
//! Crates that evaluate formulas do not keep the positions of operands, which checks of units and
//! their errors need.

use std::ops::Range;

use pinswitch_diagnostic::codes;

use crate::names::is_function;
use crate::token::{Token, tokens};
use crate::tree::{FUNCTIONS, PAIRS, too_deep};
use crate::{Condition, Formula, FormulaError, Kind, MAX_DEPTH, MAX_LENGTH, NameError, Node, Operator, Type};

/// How strongly operators bind, the weakest first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Precedence {
    Or,
    And,
    Comparison,
    Sum,
    Product,
    Prefix,
    Power,
    Atom,
}

impl Precedence {
    /// Returns the next stronger one.
    pub(crate) fn stronger(self) -> Self {
        match self {
            Self::Or => Self::And,
            Self::And => Self::Comparison,
            Self::Comparison => Self::Sum,
            Self::Sum => Self::Product,
            Self::Product => Self::Prefix,
            Self::Prefix => Self::Power,
            Self::Power | Self::Atom => Self::Atom,
        }
    }
}

/// Operators between two operands with their signs.
pub(crate) const OPERATORS: [(&str, Operator, Precedence); 13] = [
    ("||", Operator::Or, Precedence::Or),
    ("&&", Operator::And, Precedence::And),
    ("<", Operator::Less, Precedence::Comparison),
    ("<=", Operator::LessOrEqual, Precedence::Comparison),
    (">", Operator::Greater, Precedence::Comparison),
    (">=", Operator::GreaterOrEqual, Precedence::Comparison),
    ("==", Operator::Equal, Precedence::Comparison),
    ("!=", Operator::NotEqual, Precedence::Comparison),
    ("+", Operator::Add, Precedence::Sum),
    ("-", Operator::Subtract, Precedence::Sum),
    ("*", Operator::Multiply, Precedence::Product),
    ("/", Operator::Divide, Precedence::Product),
    ("^", Operator::Power, Precedence::Power),
];

impl<N> Formula<N> {
    /// Parses a formula; `resolve` gives each name its meaning.
    ///
    /// # Errors
    /// The first error in the text, and a text that is a condition.
    pub fn parse(
        text: &str,
        mut resolve: impl FnMut(&str) -> Result<N, NameError>,
    ) -> Result<Self, FormulaError> {
        let root = parsed(text, &mut resolve)?;
        if root.ty() == Type::Truth {
            return Err(FormulaError::new(
                codes::FORMULA_SYNTAX,
                root.extent(),
                "expected a number, found a condition",
            )
            .with_help("multiply it by a number, such as k*(a < b)"));
        }
        Ok(Self { root })
    }
}

impl<N> Condition<N> {
    /// Parses a condition; `resolve` gives each name its meaning.
    ///
    /// # Errors
    /// The first error in the text, and a text that is a number.
    pub fn parse(
        text: &str,
        mut resolve: impl FnMut(&str) -> Result<N, NameError>,
    ) -> Result<Self, FormulaError> {
        let root = parsed(text, &mut resolve)?;
        if root.ty() == Type::Number {
            return Err(FormulaError::new(
                codes::FORMULA_SYNTAX,
                root.extent(),
                "expected a condition, found a number",
            )
            .with_help("compare it with a bound, such as a >= 12"));
        }
        Ok(Self { root })
    }
}

type Resolve<'a, N> = dyn FnMut(&str) -> Result<N, NameError> + 'a;

fn parsed<N>(text: &str, resolve: &mut Resolve<'_, N>) -> Result<Node<N>, FormulaError> {
    let length = text.chars().count();
    if length > MAX_LENGTH {
        let problem = format!("formula of {length} characters, at most {MAX_LENGTH} are allowed");
        return Err(FormulaError::new(codes::TOO_MANY_ENTRIES, 0..0, problem).with_help("shorten it"));
    }
    let tokens = tokens(text)?;
    let mut parser = Parser { text, tokens: &tokens, next: 0, resolve };
    let root = parser.expression(Precedence::Or, 0)?;
    match parser.peek() {
        (Token::End, _) => Ok(root),
        _ => Err(parser.unexpected("an operator").with_help("join the two with an operator, or remove one")),
    }
}

struct Parser<'a, 'r, N> {
    text: &'a str,
    tokens: &'a [(Token<'a>, Range<usize>)],
    next: usize,
    resolve: &'r mut Resolve<'r, N>,
}

impl<'a, N> Parser<'a, '_, N> {
    /// Returns the next token without consuming it; after the last one, the end again.
    fn peek(&self) -> (&'a Token<'a>, Range<usize>) {
        let (token, span) = &self.tokens[self.next.min(self.tokens.len() - 1)];
        (token, span.clone())
    }

    fn advance(&mut self) -> (&'a Token<'a>, Range<usize>) {
        let token = self.peek();
        self.next += 1;
        token
    }

    /// The error at the next token, where `expected` should be.
    fn unexpected(&self, expected: &str) -> FormulaError {
        let (token, span) = self.peek();
        let found = match token {
            Token::End => "the end".to_owned(),
            _ => {
                let text = self.text.get(span.clone()).unwrap_or_default();
                format!("'{}'", pinswitch_diagnostic::excerpt(text, 40))
            }
        };
        FormulaError::new(codes::FORMULA_SYNTAX, span, format!("expected {expected}, found {found}"))
    }

    /// Returns the remedy for an operand that is missing before the next token.
    fn operand_help(&self) -> String {
        let previous = self.next.checked_sub(1).and_then(|index| self.tokens.get(index));
        match (previous, self.peek().0) {
            (Some((Token::Sign(sign), _)), _) if !["(", ","].contains(sign) => {
                format!("add the operand after '{sign}', or remove '{sign}'")
            }
            (Some((Token::Sign(sign), _)), _) => format!("add the operand after '{sign}'"),
            (_, Token::End) => "write a formula".to_owned(),
            _ => "add the operand before it, or remove it".to_owned(),
        }
    }

    /// Consumes a sign, and returns where it ends.
    fn require(&mut self, sign: &'static str, purpose: &str) -> Result<usize, FormulaError> {
        if self.peek().0 == &Token::Sign(sign) {
            return Ok(self.advance().1.end);
        }
        Err(self.unexpected(&format!("'{sign}' {purpose}")).with_help(format!("add '{sign}'")))
    }

    /// Parses operands joined by operators that bind at least as strongly as `least`.
    fn expression(&mut self, least: Precedence, depth: usize) -> Result<Node<N>, FormulaError> {
        if depth > MAX_DEPTH {
            return Err(too_deep(self.peek().1));
        }
        let mut left = self.operand(depth)?;
        let mut is_compared = false;
        while let (Token::Sign(sign), span) = self.peek() {
            let Some((_, operator, precedence)) = OPERATORS.iter().find(|(known, ..)| known == sign) else {
                break;
            };
            if *precedence < least {
                break;
            }
            if operator.is_comparison() && is_compared {
                return Err(FormulaError::new(codes::FORMULA_SYNTAX, span, "comparisons cannot be chained")
                    .with_help("join them with &&: 5 < x && x < 9"));
            }
            self.next += 1;
            // Powers are taken from the right, everything else from the left.
            let right_least = if *operator == Operator::Power { *precedence } else { precedence.stronger() };
            let right = self.expression(right_least, depth + 1)?;
            left = Node::new(span, Kind::Binary(*operator, Box::new(left), Box::new(right)))?;
            is_compared = operator.is_comparison();
        }
        Ok(left)
    }

    fn operand(&mut self, depth: usize) -> Result<Node<N>, FormulaError> {
        let expected = self.unexpected("a number, a name or '('").with_help(self.operand_help());
        match self.advance() {
            (Token::Number(value), span) => Node::new(span, Kind::Number(*value)),
            (Token::Sign("-"), span) => {
                let operand = self.expression(Precedence::Prefix, depth + 1)?;
                Node::new(span, Kind::Negated(Box::new(operand)))
            }
            (Token::Sign("!"), span) => {
                let operand = self.expression(Precedence::Prefix, depth + 1)?;
                Node::new(span, Kind::Not(Box::new(operand)))
            }
            (Token::Sign("("), span) => {
                let inner = self.expression(Precedence::Or, depth + 1)?;
                let end = self.require(")", "to close a bracket")?;
                Ok(inner.in_brackets(span.start, end))
            }
            (Token::Name(name), span) if self.peek().0 == &Token::Sign("(") => self.call(name, span, depth),
            (Token::Name(name), span) => self.name(name, span),
            (Token::Sign(_) | Token::End, _) => Err(expected),
        }
    }

    fn call(&mut self, name: &str, span: Range<usize>, depth: usize) -> Result<Node<N>, FormulaError> {
        let function = FUNCTIONS.iter().find(|(known, _)| *known == name);
        let pair = PAIRS.iter().find(|(known, _)| *known == name);
        // The bracket.
        self.next += 1;
        let kind = if let Some((_, function)) = function {
            Kind::Call(*function, Box::new(self.expression(Precedence::Or, depth + 1)?))
        } else if let Some((_, operator)) = pair {
            let first = self.expression(Precedence::Or, depth + 1)?;
            self.require(",", &format!("({name} takes two values)"))?;
            let second = self.expression(Precedence::Or, depth + 1)?;
            Kind::Binary(*operator, Box::new(first), Box::new(second))
        } else {
            let known = FUNCTIONS.iter().map(|f| f.0).chain(PAIRS.iter().map(|f| f.0));
            return Err(NameError::unknown("function", name, known).at(span));
        };
        let (start, end) = (span.start, self.require(")", &format!("to close {name}("))?);
        Ok(Node::new(span, kind)?.in_brackets(start, end))
    }

    fn name(&mut self, name: &str, span: Range<usize>) -> Result<Node<N>, FormulaError> {
        match (self.resolve)(name) {
            Ok(meaning) => Node::new(span, Kind::Name(meaning)),
            Err(_) if is_function(name) => {
                let values = if PAIRS.iter().any(|(pair, _)| *pair == name) { "a, b" } else { "x" };
                let problem = format!("the function {name} needs brackets");
                Err(FormulaError::new(codes::FORMULA_SYNTAX, span, problem)
                    .with_help(format!("write {name}({values})")))
            }
            Err(error) => Err(error.at(span)),
        }
    }
}
