//! Values of attributes by the types of the schema (core specification, B.1.1).

/// Removes the white space of XML around a value, which these types collapse.
fn collapsed(text: &str) -> &str {
    text.trim_matches([' ', '\t', '\r', '\n'])
}

/// A finite number in any form that readers accept.
pub(super) fn number(text: &str) -> Option<f64> {
    collapsed(text).parse().ok().filter(|value: &f64| value.is_finite())
}

/// Whether a text has the form of `ST_Number`: digits with an optional sign, fraction and exponent.
/// A decimal point is followed by digits.
pub(super) fn is_number(text: &str) -> bool {
    let digits = |text: &str| !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_digit());
    let unsigned = |text: &'_ str| text.strip_prefix(['-', '+']).unwrap_or(text).to_owned();
    let text = collapsed(text);
    let (mantissa, exponent) = match text.split_once(['e', 'E']) {
        Some((mantissa, exponent)) => (mantissa, Some(exponent)),
        None => (text, None),
    };
    let mantissa = unsigned(mantissa);
    let is_mantissa = match mantissa.split_once('.') {
        Some((whole, fraction)) => (whole.is_empty() || digits(whole)) && digits(fraction),
        None => digits(&mantissa),
    };
    is_mantissa && exponent.is_none_or(|exponent| digits(&unsigned(exponent)))
}

/// An index (`ST_ResourceIndex`): a whole number from 0, below 2^31.
pub(super) fn index(text: &str) -> Option<u32> {
    let text = collapsed(text);
    let digits = match text.strip_prefix('-') {
        // The only negative number that is not below zero.
        Some(digits) => Some(digits).filter(|digits| digits.bytes().all(|byte| byte == b'0'))?,
        None => text.strip_prefix('+').unwrap_or(text),
    };
    let is_digits = digits.bytes().all(|byte| byte.is_ascii_digit());
    digits.parse().ok().filter(|number| is_digits && *number < 1 << 31)
}

/// Built-in simple types of XML Schema (part 2, chapter 3), of which the type of metadata is one.
const SIMPLE_TYPES: [&str; 46] = [
    "anySimpleType",
    "string",
    "boolean",
    "decimal",
    "float",
    "double",
    "duration",
    "dateTime",
    "time",
    "date",
    "gYearMonth",
    "gYear",
    "gMonthDay",
    "gDay",
    "gMonth",
    "hexBinary",
    "base64Binary",
    "anyURI",
    "QName",
    "NOTATION",
    "normalizedString",
    "token",
    "language",
    "NMTOKEN",
    "NMTOKENS",
    "Name",
    "NCName",
    "ID",
    "IDREF",
    "IDREFS",
    "ENTITY",
    "ENTITIES",
    "integer",
    "nonPositiveInteger",
    "negativeInteger",
    "long",
    "int",
    "short",
    "byte",
    "nonNegativeInteger",
    "unsignedLong",
    "unsignedInt",
    "unsignedShort",
    "unsignedByte",
    "positiveInteger",
    "anyAtomicType",
];

/// Returns what is wrong with the value of an attribute of a core element, as the end of a sentence.
pub(super) fn problem(element: &str, attribute: &str, value: &str) -> Option<&'static str> {
    match (element, attribute) {
        ("metadata", "preserve") => (!matches!(collapsed(value), "0" | "1" | "true" | "false"))
            .then_some("is not 0, 1, true or false"),
        ("metadata", "type") => {
            let name = collapsed(value).rsplit(':').next().unwrap_or_default();
            (!SIMPLE_TYPES.contains(&name)).then_some("is not a simple type of XML Schema")
        }
        ("object", "pindex") => index(value).is_none().then_some("is not an index"),
        ("object", "thumbnail") => (!value.starts_with('/')).then_some("does not begin with a slash"),
        _ => None,
    }
}

/// Returns the id of a resource in the form that is compared: `01` and `+1` are 1 (`xs:positiveInteger`).
pub(super) fn resource_id(text: &str) -> String {
    let text = text.trim();
    text.parse::<u32>().map_or_else(|_| text.to_owned(), |number| number.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_the_form_of_the_schema() {
        for text in ["0", "-1", "+1.5", ".5", "10e0", "1E-3", " 1 ", "-.5e+10", "\t2\n"] {
            assert!(is_number(text) && number(text).is_some(), "{text:?}");
        }
        for text in
            ["", "10.", ".", "1e", "e1", "1.e2", "--1", "+-1", "nan", "inf", "1 2", "1,5", "0x1", "\u{a0}1"]
        {
            assert!(!is_number(text), "{text:?}");
        }
        assert_eq!((number("10."), number("nan"), number("1e999")), (Some(10.0), None, None));
    }

    #[test]
    fn indices_are_whole_numbers() {
        for (text, expected) in [("0", Some(0)), (" 7 ", Some(7)), ("-0", Some(0)), ("+3", Some(3))] {
            assert_eq!(index(text), expected, "{text:?}");
        }
        for text in ["", "-", "+", "-1", "1.0", "x", "2147483648", "++1"] {
            assert_eq!(index(text), None, "{text:?}");
        }
    }
}
