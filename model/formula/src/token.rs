//! Tokens of a formula with their bytes.

use std::ops::Range;

use pinswitch_diagnostic::codes;

use crate::FormulaError;

/// One token.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Token<'a> {
    Number(f64),
    Name(&'a str),
    /// An operator, a bracket or a comma; keywords are the operators that they stand for.
    Sign(&'static str),
    End,
}

/// Signs; each comes before those that it starts with.
const SIGNS: [&str; 17] =
    ["<=", ">=", "==", "!=", "&&", "||", "<", ">", "+", "-", "*", "/", "^", "!", "(", ")", ","];
/// Words for signs.
pub(crate) const KEYWORDS: [(&str, &str); 2] = [("and", "&&"), ("or", "||")];

/// Splits a formula into tokens; the last one is [`Token::End`].
///
/// # Errors
/// A character that starts no token, and a number that is malformed or not finite.
pub(crate) fn tokens(text: &str) -> Result<Vec<(Token<'_>, Range<usize>)>, FormulaError> {
    let mut all = Vec::new();
    let mut at = 0;
    while let Some(first) = text[at..].chars().next() {
        let rest = &text[at..];
        if first.is_whitespace() {
            at += first.len_utf8();
            continue;
        }
        let (token, length) = if first.is_ascii_digit() || first == '.' {
            let length = number_length(rest.as_bytes());
            (number(&rest[..length], at)?, length)
        } else if is_name_start(first) {
            let name = &rest[..name_length(rest.as_bytes())];
            let keyword = KEYWORDS.iter().find(|(keyword, _)| *keyword == name);
            (keyword.map_or(Token::Name(name), |(_, sign)| Token::Sign(sign)), name.len())
        } else if let Some(sign) = SIGNS.iter().find(|sign| rest.starts_with(**sign)) {
            (Token::Sign(sign), sign.len())
        } else {
            return Err(unexpected(first, at));
        };
        all.push((token, at..at + length));
        at += length;
    }
    all.push((Token::End, text.len()..text.len()));
    Ok(all)
}

fn number(text: &str, at: usize) -> Result<Token<'static>, FormulaError> {
    let value = text.parse().ok().filter(|v: &f64| v.is_finite());
    value.map(Token::Number).ok_or_else(|| {
        let shown = pinswitch_diagnostic::excerpt(text, 40);
        FormulaError::new(
            codes::FORMULA_NOT_FINITE,
            at..at + text.len(),
            format!("'{shown}' is not a finite number"),
        )
    })
}

fn unexpected(character: char, at: usize) -> FormulaError {
    let problem = format!("unexpected character '{}'", character.escape_debug());
    FormulaError::new(codes::FORMULA_SYNTAX, at..at + character.len_utf8(), problem).with_help(
        match character {
            '=' => "compare with ==",
            '&' => "write && or 'and'",
            '|' => "write || or 'or'",
            _ => "use numbers, names, + - * / ^ < > = ! & | ( ) and commas",
        },
    )
}

fn is_name_start(c: char) -> bool {
    c.is_ascii_alphabetic() || c == '_'
}

/// Returns the bytes of the name at the start: words joined by dots.
fn name_length(bytes: &[u8]) -> usize {
    let is_start = |b: u8| is_name_start(char::from(b));
    let mut length = 0;
    loop {
        let is_inner = |b: &&u8| b.is_ascii_alphanumeric() || **b == b'_';
        length += bytes[length..].iter().take_while(is_inner).count();
        match bytes[length..] {
            [b'.', next, ..] if is_start(next) => length += 1,
            _ => return length,
        }
    }
}

/// Returns the bytes of the number at the start: digits and points, and an exponent.
fn number_length(bytes: &[u8]) -> usize {
    let digits = |from: usize| bytes[from..].iter().take_while(|b| b.is_ascii_digit() || **b == b'.').count();
    let mantissa = digits(0);
    if !matches!(bytes.get(mantissa), Some(b'e' | b'E')) {
        return mantissa;
    }
    let signed = mantissa + 1 + usize::from(matches!(bytes.get(mantissa + 1), Some(b'+' | b'-')));
    match digits(signed.min(bytes.len())) {
        0 => mantissa,
        exponent => signed + exponent,
    }
}
