//! Tests of files of user-defined effects: the formulas of built-in ones, and arbitrary content.

use proptest::prelude::*;

use super::*;
use crate::effects::{ActsOn, SharedEffect, Vocabulary, own_effects_text};
use crate::evidence::Fitted;
use crate::model::{Model, Noise, Term};
use crate::table::PlateauRow;
use crate::test_session::session_with;
use crate::{ModelFile, calibrate};

/// A valid file, which the tests modify.
const VALID: &str = include_str!("../../../../../templates/rig/effects.toml");

/// Returns the built-in effects with their formulas under other ids.
fn written_out() -> Vec<(SharedEffect, OwnEffect)> {
    let of = |effect: SharedEffect| {
        let mut definition = EffectDefinition::of(&*effect).ok()?;
        definition.id = format!("own_{}", definition.id);
        Some((effect, OwnEffect::new(definition).unwrap()))
    };
    Vocabulary::built_in().effects().filter_map(of).collect()
}

/// Returns a session with varying dwell and an effect.
fn varied(effect: &SharedEffect, values: &[f64]) -> Vec<PlateauRow> {
    let mut rows = session_with(7, &[]);
    for (i, row) in rows.iter_mut().enumerate() {
        let series: usize = row.series.parse().unwrap_or(i / 18);
        row.dwell_s = [1.0, 3.0, 10.0][series % 3];
    }
    let model = Model::baseline(Frame::new(&rows)).with_term(Term::Named(effect.clone()), values);
    let without = Model::baseline(Frame::new(&rows)).predict(&model.frame.points(&rows).unwrap());
    let with = model.predict(&model.frame.points(&rows).unwrap());
    rows.iter_mut().zip(with.iter().zip(&without)).for_each(|(row, (a, b))| row.force_n += a - b);
    rows
}

/// A built-in effect with a formula passes the checks of a user-defined one, units included.
#[test]
fn sixteen_effects_have_a_formula() {
    assert_eq!(written_out().len(), 16);
}

#[test]
fn written_effects_read_back() {
    let definitions: Vec<EffectDefinition> =
        written_out().into_iter().map(|(_, own)| own.definition().clone()).collect();
    let text = own_effects_text(&definitions);
    let vocabulary = Vocabulary::built_in().read(&text, "mine.toml").unwrap();
    assert!(vocabulary.own().map(OwnEffect::definition).eq(&definitions));
    let error = vocabulary.read(&text, "again.toml").unwrap_err().to_string();
    assert!(error.starts_with("again.toml:4:6: duplicate id 'own_"), "{error}");
}

/// A model file contains the formula, so that it predicts without the file of effects.
#[test]
fn a_model_contains_its_effects() {
    let vocabulary = Vocabulary::built_in().read(VALID, "mine.toml").unwrap();
    let dip = vocabulary.named("lubricant_dip").unwrap();
    let rows = varied(&dip, &[0.25, 50.0, 6.0]);
    let calibration = calibrate(&rows, &vocabulary, 1).unwrap();
    assert_eq!(calibration.report.candidates.len(), 22);
    let model =
        Model::baseline(Frame::new(&rows)).among(&vocabulary).with_term(Term::Named(dip), &[0.25, 50.0, 6.0]);
    let n = model.values().len();
    let covariance = nalgebra::DMatrix::identity(n, n) * 1e-4;
    let fitted = Fitted { model, noise: Noise::constant(0.05, 0.05), covariance, predicted_n: Vec::new() };
    let text = ModelFile::new(&fitted).to_text().unwrap();
    let read = ModelFile::parse(&text, "model.toml").unwrap();
    assert_eq!(read.to_text().unwrap(), text);
    let (predicted, _) = read.predict(&rows, crate::evidence::Session::Fitted, "model.toml").unwrap();
    let expected = fitted.model.predict(&fitted.model.frame.points(&rows).unwrap());
    assert!(predicted.iter().zip(&expected).all(|(a, b)| (a - b).abs() < 1e-9));
    let invalid = text.replace("speed_pct - c", "sped_pct - c");
    let error = ModelFile::parse(&invalid, "model.toml").unwrap_err().to_string();
    assert!(error.contains("did you mean speed_pct?") && error.starts_with("model.toml:"), "{error}");
}

#[test]
fn formulas_may_depend_on_previous_loads() {
    let text = VALID.replace("# [[effect]]", "[[effect]]").replace("\n# ", "\n").replace("\n#", "\n");
    let from = text.find("id = \"load_memory\"").unwrap();
    let memory = format!("schema = \"pinswitch.effects/1\"\n[[effect]]\n{}", &text[from..]);
    let vocabulary = Vocabulary::built_in().read(&memory, "mine.toml").unwrap();
    let effect = vocabulary.named("load_memory").unwrap();
    let rows = session_with(1, &[]);
    let model = Model::baseline(Frame::new(&rows));
    let points = model.frame.points(&rows).unwrap();
    let with = model.with_term(Term::Named(effect), &[0.3, 10.0]).predict(&points);
    let without = model.predict(&points);
    let changed = |i: usize| libm::log(with[i] / without[i]).abs();
    let second = (0..rows.len()).find(|i| rows[*i].series != rows[0].series).unwrap();
    assert!(points[second].previous_load_n == rows[0].load_n && !points[second].begins_session);
    assert!(changed(second) > changed(second + 5) && changed(second + 5) > 0.0);
}

#[test]
fn problems_are_located() {
    for (from, to, expected) in [
        ("effects/1", "effects/9", "4:10: unknown schema 'pinswitch.effects/9'"),
        ("schema =", "shema =", "4:1: unknown key 'shema'; did you mean schema?"),
        (
            "\"lubricant_dip\" ",
            "\"rate_dependence\" ",
            "7:6: id 'rate_dependence' is that of a built-in effect",
        ),
        ("\"lubricant_dip\" ", "\"Dip\" ", "7:6: invalid id 'Dip'; start with a-z"),
        ("side = \"switch\" ", "side = \"left\" ", "8:8: unknown side 'left'; use one of switch, rig"),
        ("acts_on = \"mu\" ", "acts_on = \"moo\" ", "10:11: unknown acts_on 'moo'; use one of mu, "),
        ("speed_pct - c", "speedpct - c", "12:24: unknown variable 'speedpct'; did you mean speed_pct?"),
        ("exp(-((speed_pct - c)/w)^2)", "exq(1)*c*w", "12:17: unknown function 'exq'; did you mean exp?"),
        ("speed_pct - c", "load_n - c", "12:31: the operands have different units, N and %"),
        ("-a * exp", "1 + a * exp", "12:12: the formula is 1.0000 instead of zero with all sizes at zero"),
        ("-a * exp", "-a^2 * exp", "12:11: the effect is not linear in its sizes near zero"),
        ("-a * exp", "-abs(a) * exp", "12:11: the effect is not linear in its sizes near zero"),
        ("-a * exp", "-sqrt(abs(a)) * exp", "12:11: the effect is not linear in its sizes near zero"),
        ("\"-a * exp", "\"-a*ln(0*direction)*exp", "12:12: the formula is not finite at its start values"),
        ("combine = \"factor\" ", "combine = \"sum\" ", ""),
        (
            "acts_on = \"mu\"      ",
            "acts_on = \"mu\"\ncombined = 1 ",
            "11:1: unknown key 'combined'; did you mean combine?",
        ),
        (
            "[\"rate_dependence\"]",
            "[\"rate_dependance\"]",
            "14:18: unknown effect 'rate_dependance'; did you mean rate_dependence?",
        ),
        ("[\"rate_dependence\"]", "[1]", "14:18: confused_with: expected a list of ids"),
        ("start = 52", "start = 20", "23:12: start = 20 of 'c' must be between low = 35 and high = 75"),
        ("start = 52", "start = nan", "23:12: start, low and high of 'c' must be numbers"),
        ("start = 0.1", "start = -0.1", "22:12: start = -0.1 of the size 'a' must be above 0"),
        ("size = true, ", "", "parameter 'a' lacks low and high"),
        ("size = true, ", "size = true, low = 0, ", "a size cannot have bounds"),
        ("unit = \"%\" }\nparameters.w", "unit = \"kg\" }\nparameters.w", "23:12: unknown unit 'kg'"),
        ("parameters.w =", "parameters.load_n =", "24:12: parameter 'load_n' has the name of a variable"),
        ("parameters.w =", "parameters.exp =", "24:12: parameter 'exp' has the name of a function"),
        (
            "parameters.w =",
            "parameters.v = { start = 1, low = 0, high = 2, unit = \"1\" }\nparameters.w =",
            "24:12: the formula does not use 'v'",
        ),
        ("one_sided = true ", "one_sided = 1 ", "13:13: one_sided: expected true or false"),
        ("[[effect]]\nid = \"lub", "[[effect\nid = \"lub", "6:"),
        ("[[effect]]\nid = \"lub", "[effect]\nid = \"lub", "effect is not a list of tables"),
    ] {
        assert!(VALID.contains(from), "{from}");
        let invalid = VALID.replacen(from, to, 1);
        let read = Vocabulary::built_in().read(&invalid, "mine.toml").map(|v| v.count());
        if expected.is_empty() {
            assert_eq!(read, Ok(22), "{to}");
            continue;
        }
        let error = read.unwrap_err().to_string();
        assert!(error.starts_with("mine.toml:") && error.contains(expected), "{to}:\n{error}\n{expected}");
        assert!(error.chars().count() < 600, "{error}");
    }
}

/// Words of formulas, and some invalid ones.
fn word() -> impl Strategy<Value = String> {
    let words = [
        "load_n",
        "direction",
        "time_s",
        "stroke",
        "a",
        "b",
        "1",
        "0.5",
        "50",
        "1e3",
        "+",
        "-",
        "*",
        "/",
        "^",
        "(",
        ")",
        ",",
        "exp",
        "ln(",
        "sqrt(",
        "abs(",
        "sin(",
        "tanh(",
        "min(",
        "max(",
        "<",
        ">=",
        "==",
        "previous_load_n",
        "x",
        "\u{b5}",
    ];
    prop::sample::select(words.to_vec()).prop_map(str::to_owned)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, ..ProptestConfig::default() })]

    /// Any formula is refused, or finite on the probe rows.
    #[test]
    fn any_formula_is_finite_or_refused(words in prop::collection::vec(word(), 1..14), acts in 0usize..8) {
        let parameter = |name: &str, bounds| OwnParameter { name: name.to_owned(), unit: "1".to_owned(), start: 0.5, bounds };
        let definition = EffectDefinition {
            id: "any".to_owned(),
            side: crate::effects::Side::Rig,
            covariate: Covariate::Load,
            acts_on: ActsOn::ALL[acts],
            combine: crate::effects::Combine::Factor,
            formula: format!("a*b*({})", words.join(" ")),
            one_sided: false,
            confused_with: Vec::new(),
            experiment: String::new(),
            drawn_from: None,
            parameters: vec![parameter("a", None), parameter("b", Some((0.0, 1.0)))],
        };
        match OwnEffect::new(definition) {
            Err(error) => prop_assert!(error.to_string().chars().count() < 600),
            Ok(own) => for probe in probe::probes() {
                let value = own.applied.formula().value(&[0.5, 0.5], &probe.moment());
                prop_assert!(value.is_finite());
            },
        }
    }

    /// No text makes the reader panic, or report a long error or one without a location.
    #[test]
    fn any_text_is_read_or_refused(text in "\\PC{0,60}", at in 0usize..2000) {
        let at = (0..=at.min(VALID.len())).rev().find(|i| VALID.is_char_boundary(*i)).unwrap_or(0);
        for invalid in [text.clone(), format!("{}{text}{}", &VALID[..at], &VALID[at..])] {
            if let Err(error) = read_own_effects(&invalid, "mine.toml", &Vocabulary::built_in()) {
                prop_assert!(error.to_string().chars().count() < 600, "{}", error);
                let location = error.location();
                prop_assert!(location.is_some_and(|l| l.line.is_some() && l.column.is_some()), "{}", error);
            }
        }
    }
}
