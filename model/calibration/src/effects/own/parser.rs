//! Parses a formula by precedence climbing, and resolves its names.
//!
//! Crates that evaluate formulas keep no places of their operands, which the check of units and its errors need.

use super::expression::{Fault, Function, Kind, MAX_DEPTH, Node, Operator, too_deep};
use super::token::{Token, tokens};
use super::variable::{TENSION, VARIABLES, variable};

/// Most characters of a formula.
const MAX_LENGTH: usize = 1000;

/// Operators by their sign, how strongly they bind, and whether the right one of two binds first.
const OPERATORS: [(&str, Operator, u8, bool); 11] = [
    ("<", Operator::Less, 1, false),
    ("<=", Operator::AtMost, 1, false),
    (">", Operator::More, 1, false),
    (">=", Operator::AtLeast, 1, false),
    ("==", Operator::Equal, 1, false),
    ("!=", Operator::Unequal, 1, false),
    ("+", Operator::Add, 2, false),
    ("-", Operator::Subtract, 2, false),
    ("*", Operator::Multiply, 3, false),
    ("/", Operator::Divide, 3, false),
    ("^", Operator::Power, 5, true),
];
/// How strongly a comparison binds.
const COMPARISON: u8 = 1;
/// How strongly a minus before a value binds: `-x^2` is `-(x^2)`.
const NEGATION: u8 = 4;

/// Functions of one value by their names.
const FUNCTIONS: [(&str, Function); 7] = [
    ("exp", Function::Exp),
    ("ln", Function::Ln),
    ("sqrt", Function::Sqrt),
    ("abs", Function::Abs),
    ("sin", Function::Sin),
    ("cos", Function::Cos),
    ("tanh", Function::Tanh),
];
/// Functions of two values by their names.
const PAIRS: [(&str, Operator); 2] = [("min", Operator::Least), ("max", Operator::Greatest)];

impl Node {
    /// Parses a formula whose constants have these names. `tension` tells whether the tension is known.
    ///
    /// # Errors
    /// The first [`Fault`].
    pub(super) fn parse(text: &str, constants: &[&str], tension: bool) -> Result<Node, Fault> {
        if text.len() > MAX_LENGTH {
            let problem = format!("a formula of {} characters; {MAX_LENGTH} are possible", text.len());
            return Err(Fault::new(0, problem));
        }
        let words = tokens(text)?;
        let mut parser = Parser { words: &words, at: 0, constants, tension };
        let node = parser.expression(0, 0)?;
        match parser.peek() {
            (Token::End, _) => Ok(node),
            (_, at) => Err(Fault::new(at, format!("{} stands where an operator should", parser.found()))),
        }
    }
}

struct Parser<'a> {
    words: &'a [(Token<'a>, std::ops::Range<usize>)],
    at: usize,
    constants: &'a [&'a str],
    tension: bool,
}

impl<'a> Parser<'a> {
    fn peek(&self) -> (&'a Token<'a>, usize) {
        // The end is never passed.
        let (token, place) = &self.words[self.at.min(self.words.len() - 1)];
        (token, place.start)
    }

    fn next(&mut self) -> (&'a Token<'a>, usize) {
        let word = self.peek();
        self.at += 1;
        word
    }

    /// The word that stands here, for errors.
    fn found(&self) -> String {
        match self.peek().0 {
            Token::Number(value) => format!("the number {value}"),
            Token::Name(name) => format!("'{name}'"),
            Token::Sign(sign) => format!("'{sign}'"),
            Token::End => "the end".to_owned(),
        }
    }

    fn require(&mut self, sign: &str, why: &str) -> Result<(), Fault> {
        if self.peek().0 == &Token::Sign(sign_of(sign)) {
            self.at += 1;
            return Ok(());
        }
        Err(Fault::new(self.peek().1, format!("{} stands where '{sign}' {why}", self.found())))
    }

    /// Values joined by operators that bind at least as strongly as `least`.
    fn expression(&mut self, least: u8, depth: usize) -> Result<Node, Fault> {
        if depth > MAX_DEPTH {
            return Err(too_deep(self.peek().1));
        }
        let mut left = self.operand(depth)?;
        while let (Token::Sign(sign), at) = self.peek() {
            let Some((_, operator, binds, from_right)) = OPERATORS.iter().find(|o| o.0 == *sign) else {
                break;
            };
            if *binds < least {
                break;
            }
            if *binds == COMPARISON && left.is_comparison() {
                let problem = "a comparison of a comparison, which is 0 or 1; write (5 < x)*(x < 9) for what lies between";
                return Err(Fault::new(at, problem.to_owned()));
            }
            self.at += 1;
            let right = self.expression(binds + u8::from(!from_right), depth + 1)?;
            left = Node::new(at, Kind::Binary(*operator, Box::new(left), Box::new(right)))?;
        }
        Ok(left)
    }

    fn operand(&mut self, depth: usize) -> Result<Node, Fault> {
        let found = self.found();
        match self.next() {
            (Token::Number(value), at) => Node::new(at, Kind::Number(*value)),
            (Token::Sign("-"), at) => {
                let operand = self.expression(NEGATION, depth + 1)?;
                Node::new(at, Kind::Negated(Box::new(operand)))
            }
            (Token::Sign("("), _) => {
                let inner = self.expression(0, depth + 1)?;
                self.require(")", "should close a bracket")?;
                Ok(inner)
            }
            (Token::Name(name), at) if self.peek().0 == &Token::Sign("(") => self.call(name, at, depth),
            (Token::Name(name), at) => self.name(name, at),
            (Token::Sign(_) | Token::End, at) => {
                Err(Fault::new(at, format!("{found} stands where a number, a name or '(' should")))
            }
        }
    }

    fn call(&mut self, name: &str, at: usize, depth: usize) -> Result<Node, Fault> {
        let one = FUNCTIONS.iter().find(|f| f.0 == name);
        let two = PAIRS.iter().find(|f| f.0 == name);
        if one.is_none() && two.is_none() {
            let known = FUNCTIONS.iter().map(|f| f.0).chain(PAIRS.iter().map(|f| f.0));
            return Err(Fault::new(at, unknown("function", name, known)));
        }
        self.at += 1;
        let first = self.expression(0, depth + 1)?;
        let node = match (one, two) {
            (Some((_, function)), _) => Node::new(at, Kind::Call(*function, Box::new(first)))?,
            (None, Some((_, operator))) => {
                self.require(",", &format!("should follow: {name} takes two values"))?;
                let second = self.expression(0, depth + 1)?;
                Node::new(at, Kind::Binary(*operator, Box::new(first), Box::new(second)))?
            }
            (None, None) => first,
        };
        self.require(")", &format!("should close the brackets of {name}"))?;
        Ok(node)
    }

    fn name(&self, name: &str, at: usize) -> Result<Node, Fault> {
        if let Some(place) = self.constants.iter().position(|c| *c == name) {
            return Node::new(at, Kind::Constant(place));
        }
        if name == TENSION && !self.tension {
            let problem = "tension_n is known only where acts_on is \"tension\" or \"reading\"; use load_n";
            return Err(Fault::new(at, problem));
        }
        if is_function(name) {
            let values = if PAIRS.iter().any(|pair| pair.0 == name) { "a, b" } else { "x" };
            return Err(Fault::new(at, format!("the function {name} needs brackets: {name}({values})")));
        }
        match variable(name) {
            Some(variable) => Node::new(at, Kind::Variable(variable)),
            None => {
                let known = self.constants.iter().copied().chain(VARIABLES.iter().map(|v| v.name));
                Err(Fault::new(at, unknown("variable", name, known)))
            }
        }
    }
}

/// Whether a name is that of a function.
pub(super) fn is_function(name: &str) -> bool {
    FUNCTIONS.iter().any(|f| f.0 == name) || PAIRS.iter().any(|f| f.0 == name)
}

/// The sign of [`Token::Sign`] that reads so.
fn sign_of(sign: &str) -> &'static str {
    if sign == "," { "," } else { ")" }
}

/// Says that a name is unknown, with the nearest one that is known, or all.
pub(crate) fn unknown<'a>(what: &str, name: &str, known: impl Iterator<Item = &'a str>) -> String {
    let known: Vec<&str> = known.collect();
    let shown = pinswitch_diagnostic::excerpt(name, 40);
    let near = known
        .iter()
        .map(|k| (strsim::damerau_levenshtein(k, name), k))
        .min()
        .filter(|(distance, k)| *distance <= (k.len().max(name.len()) / 3).max(2));
    match near {
        Some((_, near)) => format!("unknown {what} '{shown}'; did you mean {near}?"),
        None => format!("unknown {what} '{shown}'; known are {}", known.join(", ")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::own::variable::Moment;
    use crate::table::{Condition, Point};

    fn value(text: &str) -> f64 {
        let point = Point { load_n: 10.0, sign: -1.0, repetition: 3.0, ..Point::default() };
        let condition = Condition::default();
        let moment = Moment { point: &point, condition: &condition, load_n: 10.0, tension_n: 8.0 };
        Node::parse(text, &["a", "b"], true).unwrap().value(&[2.0, 0.5], &moment)
    }

    #[test]
    fn precedence_is_that_of_mathematics() {
        for (text, expected) in [
            ("1 + 2*3^2", 19.0),
            ("-2^2", -4.0),
            ("2^3^2", 512.0),
            ("2^-1", 0.5),
            ("8/4/2", 1.0),
            ("7 - 2 - 1", 4.0),
            ("(1 + 2) * 3", 9.0),
            ("1 + 1 < 3", 1.0),
            ("2 * (load_n >= 10) - (direction == 1)", 2.0),
            ("a*load_n - b", 19.5),
            ("min(1, 2) + max(3, -4) + abs(-1.5e0)", 5.5),
            ("exp(0) + ln(1) + sqrt(4) + sin(0) + cos(0) + tanh(0)", 4.0),
            ("tension_n != 8", 0.0),
            ("repetition <= 3", 1.0),
            ("--1", 1.0),
            ("2--1", 3.0),
        ] {
            assert_eq!(value(text), expected, "{text}");
        }
    }

    #[test]
    fn faults_are_placed_and_name_what_is_near() {
        for (text, at, part) in [
            ("", 0, "the end stands where"),
            ("1 +", 3, "the end stands where"),
            ("1 + * 2", 4, "'*' stands where"),
            ("a * laod_n", 4, "did you mean load_n?"),
            ("1 + sine(a)", 4, "did you mean sin?"),
            ("gibberish_of_mine", 0, "known are a, b, load_n"),
            ("exp(1", 5, "should close the brackets of exp"),
            ("(1", 2, "should close a bracket"),
            ("min(1)", 5, "takes two values"),
            ("min(1, 2, 3)", 8, "should close"),
            ("1 2", 2, "the number 2 stands where an operator"),
            ("a = 1", 2, "compare by =="),
            ("1e999", 0, "is no number"),
            ("1.2.3", 0, "is no number"),
            ("\u{3bc} * 2", 0, "'\u{3bc}' begins nothing"),
            ("2 \u{d7} a", 2, "'\u{d7}' begins nothing"),
            ("a*exp load_n/50", 2, "the function exp needs brackets: exp(x)"),
            ("a + max", 4, "the function max needs brackets: max(a, b)"),
        ] {
            let fault = Node::parse(text, &["a", "b"], true).unwrap_err();
            assert!(fault.at == at && fault.problem.contains(part), "{text}: {fault:?}");
        }
        let fault = Node::parse("tension_n", &[], false).unwrap_err();
        assert!(fault.problem.contains("use load_n"), "{fault:?}");
    }

    #[test]
    fn what_could_exhaust_the_stack_is_refused() {
        for text in
            ["(".repeat(900), "-".repeat(900), "2^".repeat(450), "exp(".repeat(240), "1+".repeat(450) + "1"]
        {
            let fault = Node::parse(&text, &[], false).unwrap_err();
            assert!(fault.problem.contains("inside each other"), "{fault:?}");
        }
        assert!(Node::parse(&"1".repeat(2000), &[], false).is_err());
    }
}
