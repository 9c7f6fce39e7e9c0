//! The language as a whole: precedence, types, bounds, errors, and random texts and trees.

use proptest::prelude::*;

use super::*;

/// Names of these tests with their values.
const NAMES: [(&str, f64); 6] =
    [("a", 2.0), ("b", 0.5), ("load_n", 10.0), ("shell.width_mm", 14.0), ("none", f64::NAN), ("floor", 3.0)];

fn resolve(name: &str) -> Result<&'static str, NameError> {
    let known = NAMES.map(|(known, _)| known);
    known.into_iter().find(|k| *k == name).ok_or_else(|| NameError::unknown("variable", name, known))
}

fn read(name: &&str) -> f64 {
    NAMES.iter().find(|(known, _)| known == name).map_or(f64::NAN, |(_, value)| *value)
}

fn value(text: &str) -> f64 {
    Formula::parse(text, resolve).unwrap().value(read)
}

fn truth(text: &str) -> Option<bool> {
    Condition::parse(text, resolve).unwrap().truth(read)
}

#[test]
fn precedence_is_that_of_mathematics() {
    for (text, expected) in [
        ("1 + 2*3^2", 19.0),
        ("-2^2", -4.0),
        ("2^3^2", 512.0),
        ("2^-1", 0.5),
        ("2^-1^2", 0.5),
        ("8/4/2", 1.0),
        ("7 - 2 - 1", 4.0),
        ("(1 + 2) * 3", 9.0),
        ("0 + (1 + 1 < 3)", 1.0),
        ("2 * (load_n >= 10) - (a == 1)", 2.0),
        ("a*load_n - b", 19.5),
        ("min(1, 2) + max(3, -4) + abs(-1.5e0)", 5.5),
        ("exp(0) + ln(1) + sqrt(4) + sin(0) + cos(0) + tanh(0)", 4.0),
        ("round(2.5) + floor(-0.5) + ceil(0.2)", 3.0),
        ("floor + floor(floor + 0.5)", 6.0),
        ("--1", 1.0),
        ("2--1", 3.0),
        (".5 + 1. + shell.width_mm", 15.5),
        ("1e3 + 1E-1 + 2e+1", 1020.1),
    ] {
        assert_eq!(value(text), expected, "{text}");
    }
}

#[test]
fn logical_operators_bind_less_than_comparisons() {
    for (text, expected) in [
        ("1 > 2 && 1 > 2 || 1 < 2", true),
        ("1 < 2 || 1 > 2 && 1 > 2", true),
        ("(1 < 2 || 1 > 2) && 1 > 2", false),
        ("1 < 2 and 2 < 3 or 3 < 2", true),
        ("!(1 < 2) || 1 > 2", false),
        ("!(1 > 2) && 1 < 2", true),
        ("(1 < 2) == (3 < 4)", true),
        ("(1 < 2) != (3 < 4)", false),
        ("shell.width_mm - a >= 12 && load_n == 10", true),
        ("2*(1 < 2) > 1", true),
    ] {
        assert_eq!(truth(text), Some(expected), "{text}");
    }
}

#[test]
fn undefined_values_leave_conditions_undecided() {
    for (text, expected) in [
        ("none > 20", None),
        ("none != 3", None),
        ("!(none > 20)", None),
        ("none > 20 || a == 2", Some(true)),
        ("none > 20 || a == 3", None),
        ("none > 20 && a == 3", Some(false)),
        ("a == 3 && none > 20", Some(false)),
        ("none > 20 && a == 2", None),
        ("(none > 1) == (none > 1)", None),
        ("0/0 < 1", None),
        ("0 + (none > 20) == 0", Some(true)),
    ] {
        assert_eq!(truth(text), expected, "{text}");
    }
}

#[test]
fn errors_have_a_position_and_a_remedy() {
    for (text, marked, part) in [
        ("", "", "expected a number, a name or '(', found the end"),
        ("1 +", "", "found the end; add the operand after '+', or remove '+'"),
        ("1 + * 2", "*", "found '*'; add the operand after '+'"),
        ("a * laod_n", "laod_n", "did you mean load_n?"),
        ("a + shell.with_mm", "shell.with_mm", "did you mean shell.width_mm?"),
        ("1 + sine(a)", "sine", "did you mean sin?"),
        ("gibberish_of_mine", "gibberish_of_mine", "use one of a, b, load_n"),
        ("exp(1", "", "expected ')' to close exp(, found the end; add ')'"),
        ("(1", "", "expected ')' to close a bracket"),
        ("min(1)", ")", "min takes two values"),
        ("min(1, 2, 3)", ",", "expected ')' to close min("),
        ("1 2", "2", "expected an operator, found '2'; join the two with an operator"),
        ("a = 1", "=", "compare with =="),
        ("a & b", "&", "write &&"),
        ("1e999", "1e999", "'1e999' is not a finite number"),
        ("1.2.3", "1.2.3", "is not a finite number"),
        ("\u{3bc} * 2", "\u{3bc}", "unexpected character '\u{3bc}'"),
        ("2 \u{d7} a", "\u{d7}", "unexpected character '\u{d7}'"),
        ("a*exp load_n/50", "exp", "write exp(x)"),
        ("a + max", "max", "write max(a, b)"),
        ("a < b < 3", "<", "comparisons cannot be chained"),
        ("a < b == 3", "==", "comparisons cannot be chained"),
    ] {
        for error in [
            Formula::parse(text, resolve).map(drop).unwrap_err(),
            Condition::parse(text, resolve).map(drop).unwrap_err(),
        ] {
            assert_eq!(&text[error.span()], marked, "{text}: {error:?}");
            assert!(error.to_string().contains(part), "{text}: {error}");
        }
    }
}

#[test]
fn mixed_types_are_refused_where_they_meet() {
    for (text, marked, part) in [
        ("a && b < 1", "a", "'&&' needs a condition, found a number"),
        ("b < 1 && a*2 + b", "a*2 + b", "'&&' needs a condition"),
        ("b < 1 or a", "a", "'||' needs a condition"),
        ("!a", "a", "'!' needs a condition"),
        ("!a < b", "a", "'!' needs a condition"),
        ("(a < b) < 3", "3", "cannot compare a truth value with a number"),
        ("3 == (a < b)", "(a < b)", "cannot compare a number with a truth value"),
        ("(a < b) < (b < a)", "<", "truth values have no order"),
        ("2*(a < b)", "2*(a < b)", "expected a condition, found a number"),
        ("a", "a", "compare it with a bound"),
    ] {
        let error = Condition::parse(text, resolve).unwrap_err();
        assert!(&text[error.span()] == marked && error.to_string().contains(part), "{text}: {error:?}");
    }
    for (text, marked) in [("a < b", "a < b"), ("!(a < b)", "!(a < b)"), ("a<b or b<a", "a<b or b<a")] {
        let error = Formula::parse(text, resolve).unwrap_err();
        assert_eq!(&text[error.span()], marked, "{error:?}");
        assert_eq!(error.problem(), "expected a number, found a condition");
    }
}

#[test]
fn deep_nesting_is_refused() {
    for text in [
        "(".repeat(900),
        "-".repeat(900),
        "!".repeat(900),
        "2^".repeat(450),
        "exp(".repeat(240),
        "1+".repeat(450) + "1",
        "max(1,".repeat(160),
        "1<2&&".repeat(180) + "1<2",
    ] {
        for error in [
            Formula::parse(&text, resolve).map(drop).unwrap_err(),
            Condition::parse(&text, resolve).map(drop).unwrap_err(),
        ] {
            assert_eq!(error.problem(), "more than 100 nested operations", "{text}");
        }
    }
    let brackets = format!("{}1{}", "(".repeat(99), ")".repeat(99));
    assert_eq!(value(&brackets), 1.0);
}

#[test]
fn long_formulas_are_refused() {
    let error = Formula::parse(&"1".repeat(1001), resolve).unwrap_err();
    assert_eq!(error.problem(), "formula of 1001 characters, at most 1000 are allowed");
    let million = "a+".repeat(500_000);
    assert!(Condition::parse(&million, resolve).is_err());
}

#[test]
fn names_are_listed_in_their_order() {
    let formula = Formula::parse("b*exp(a) - b", resolve).unwrap();
    assert_eq!(formula.root().names(), [&"b", &"a", &"b"]);
    assert_eq!(formula.root().constant(), None);
    assert_eq!(Formula::parse("2^3", resolve).unwrap().root().constant(), Some(8.0));
}

#[test]
fn keywords_and_functions_are_reserved() {
    assert!(["and", "or", "exp", "max", "tanh"].into_iter().all(is_reserved));
    assert!(!["load_n", "android", "floor", "round", "ceil"].into_iter().any(is_reserved));
}

/// A random tree of a type, with every operator, and numbers of any size.
fn tree(ty: Type) -> BoxedStrategy<Node<&'static str>> {
    let made = |kind| Node::new(0..0, kind).unwrap();
    let number = any::<f64>()
        .prop_filter_map("not finite", move |x| x.is_finite().then(|| made(Kind::Number(x.abs()))));
    let name = prop::sample::select(NAMES.to_vec()).prop_map(move |(name, _)| made(Kind::Name(name)));
    let leaf = prop_oneof![number, name];
    let leaf_truth = (leaf.clone(), leaf.clone())
        .prop_map(move |(a, b)| made(Kind::Binary(Operator::Less, Box::new(a), Box::new(b))));
    // Pairs of a number and a truth value grow together.
    let both = (leaf, leaf_truth).prop_recursive(6, 60, 4, move |inner| {
        let arithmetic = [
            Operator::Add,
            Operator::Subtract,
            Operator::Multiply,
            Operator::Divide,
            Operator::Power,
            Operator::Min,
            Operator::Max,
        ];
        let comparisons = [
            Operator::Less,
            Operator::LessOrEqual,
            Operator::Greater,
            Operator::GreaterOrEqual,
            Operator::Equal,
            Operator::NotEqual,
        ];
        let choice = (0usize..9, 0usize..4, 0usize..6, 0usize..10);
        (inner.clone(), inner, choice).prop_map(move |((a, p), (b, q), (which, logical, c, f))| {
            let number = match which {
                0..=6 => Kind::Binary(arithmetic[which], Box::new(a.clone()), Box::new(b.clone())),
                7 => Kind::Negated(Box::new(if f < 2 { p.clone() } else { a.clone() })),
                _ => Kind::Call(tree::FUNCTIONS[f].1, Box::new(if f < 2 { q.clone() } else { b.clone() })),
            };
            let truth = match logical {
                0 => Kind::Binary(Operator::And, Box::new(p), Box::new(q)),
                1 => Kind::Binary(Operator::Or, Box::new(p), Box::new(q)),
                2 => Kind::Not(Box::new(p)),
                _ if c < 4 => Kind::Binary(comparisons[c], Box::new(a), Box::new(b)),
                _ => Kind::Binary(comparisons[c], Box::new(p), Box::new(q)),
            };
            (made(number), made(truth))
        })
    });
    both.prop_map(move |(number, truth)| if ty == Type::Number { number } else { truth }).boxed()
}

/// Pieces of formulas, and some that belong to none.
fn piece() -> impl Strategy<Value = String> {
    let known = [
        "a",
        "b",
        "load_n",
        "shell.width_mm",
        "none",
        "1",
        "0.5",
        "1e3",
        "+",
        "-",
        "*",
        "/",
        "^",
        "(",
        ")",
        ",",
        "exp(",
        "min(",
        "floor(",
        "<",
        ">=",
        "==",
        "!=",
        "&&",
        "||",
        "!",
        "and",
        "or",
        "x",
        ".",
        "\u{b5}",
        "=",
    ];
    prop_oneof![8 => prop::sample::select(known.to_vec()).prop_map(str::to_owned), 1 => "\\PC{0,4}"]
}

proptest! {
    #[test]
    fn written_formulas_parse_to_the_same_tree(root in tree(Type::Number)) {
        let text = Formula { root: root.clone() }.to_string();
        prop_assume!(text.chars().count() <= MAX_LENGTH);
        prop_assert_eq!(Formula::parse(&text, resolve).map(|f| f.root), Ok(root), "{}", text);
    }

    #[test]
    fn written_conditions_parse_to_the_same_tree(root in tree(Type::Truth)) {
        let text = Condition { root: root.clone() }.to_string();
        prop_assume!(text.chars().count() <= MAX_LENGTH);
        prop_assert_eq!(Condition::parse(&text, resolve).map(|f| f.root), Ok(root), "{}", text);
    }

    #[test]
    fn any_text_is_parsed_or_located(pieces in prop::collection::vec(piece(), 0..20)) {
        any_text(&pieces.join(" "));
    }

    #[test]
    fn any_bytes_are_parsed_or_located(bytes in prop::collection::vec(any::<u8>(), 0..200)) {
        any_text(&String::from_utf8_lossy(&bytes));
    }
}

/// Parses a text both ways, evaluates what is valid, and shows what is not.
fn any_text(text: &str) {
    let formula = Formula::parse(text, resolve).map(|formula| formula.value(read));
    let condition = Condition::parse(text, resolve).map(|condition| condition.truth(read));
    // No text is both a number and a condition.
    assert!(formula.is_err() || condition.is_err(), "{text}");
    for error in formula.err().into_iter().chain(condition.err()) {
        assert!(text.get(error.span()).is_some(), "{text}: {error:?}");
        assert!(error.to_string().chars().count() < 400, "{error}");
        assert!(!error.to_diagnostic(text).render("error").is_empty());
    }
}
