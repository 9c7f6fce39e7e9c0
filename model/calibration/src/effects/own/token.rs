//! The words of a formula, with their places.

use std::ops::Range;

use super::expression::Fault;

/// A word of a formula.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Token<'a> {
    Number(f64),
    Name(&'a str),
    /// An operator, a bracket or a comma.
    Sign(&'static str),
    End,
}

/// Signs, the longer ones first.
const SIGNS: [&str; 14] = ["<=", ">=", "==", "!=", "<", ">", "+", "-", "*", "/", "^", "(", ")", ","];

/// The words of a formula with their places in bytes; the last is [`Token::End`].
///
/// # Errors
/// A character that begins no word, or a number that is none.
pub(super) fn tokens(text: &str) -> Result<Vec<(Token<'_>, Range<usize>)>, Fault> {
    let mut found = Vec::new();
    let mut at = 0;
    while let Some(first) = text[at..].chars().next() {
        let rest = &text[at..];
        if first.is_whitespace() {
            at += first.len_utf8();
            continue;
        }
        let (token, length) = if first.is_ascii_digit() || first == '.' {
            let length = number_length(rest.as_bytes());
            let value = rest[..length].parse().ok().filter(|v: &f64| v.is_finite());
            let Some(value) = value else {
                return Err(Fault::new(at, format!("'{}' is no number", &rest[..length])));
            };
            (Token::Number(value), length)
        } else if first.is_ascii_alphabetic() || first == '_' {
            let length = rest.find(|c: char| !c.is_ascii_alphanumeric() && c != '_').unwrap_or(rest.len());
            (Token::Name(&rest[..length]), length)
        } else if let Some(sign) = SIGNS.iter().find(|sign| rest.starts_with(**sign)) {
            (Token::Sign(sign), sign.len())
        } else {
            let remedy = match first {
                '=' => "; compare by ==",
                '&' | '|' | '!' => "; multiply comparisons for 'and', take their max for 'or'",
                _ => "; a formula has numbers, names, + - * / ^ < > ( ) and commas",
            };
            return Err(Fault::new(at, format!("'{}' begins nothing{remedy}", first.escape_debug())));
        };
        found.push((token, at..at + length));
        at += length;
    }
    found.push((Token::End, text.len()..text.len()));
    Ok(found)
}

/// Bytes of the number at the beginning: digits, a point, an exponent.
fn number_length(bytes: &[u8]) -> usize {
    let digits = |from: usize| bytes[from..].iter().take_while(|b| b.is_ascii_digit() || **b == b'.').count();
    let mantissa = digits(0);
    if !matches!(bytes.get(mantissa), Some(b'e' | b'E')) {
        return mantissa;
    }
    let signed = mantissa + 1 + usize::from(matches!(bytes.get(mantissa + 1), Some(b'+' | b'-')));
    match digits(signed.min(bytes.len())) {
        0 => mantissa,
        power => signed + power,
    }
}
