//! Checks of a model file: finite numbers within bounds, and a covariance that is positive
//! semidefinite.

use nalgebra::DMatrix;
use pinswitch_diagnostic::{Diagnostic, Location, codes, short_number};

use crate::model::{Model, Noise};
use crate::table::Frame;

/// Largest constant in its own unit: far above any real one, and far below overflow.
const MAX_CONSTANT: f64 = 1e9;
/// Largest wrap angle: two revolutions.
const MAX_WRAP_RAD: f64 = 4.0 * std::f64::consts::PI;
/// Rounding of a covariance, relative to its largest variance.
const ROUNDING: f64 = 1e-6;
/// Advice for every invalid model file.
pub(crate) const HELP: &str = "use the file as `calibrate` wrote it, or calibrate again";

/// Returns the diagnostic of a field's value.
pub(crate) fn invalid(
    field: impl Into<String>,
    value: impl ToString,
    problem: impl Into<String>,
) -> Diagnostic {
    Diagnostic::new(codes::INVALID_MODEL, problem)
        .with_location(Location::field(field, value.to_string()))
        .with_help(HELP)
}

/// Checks that `value` is within `low..=high`, which NaN is not.
fn within(field: &str, value: f64, low: f64, high: f64) -> Result<(), Diagnostic> {
    if (low..=high).contains(&value) && value.is_finite() {
        return Ok(());
    }
    // The smallest positive number has over three hundred digits.
    let bound = if low == f64::MIN_POSITIVE {
        "above 0".to_owned()
    } else {
        format!("at least {}", short_number(low))
    };
    Err(invalid(field, short_number(value), format!("must be {bound} and at most {}", short_number(high))))
}

/// Checks that all numbers of `value` are finite.
pub(crate) fn check_finite(field: &str, value: &toml::Value) -> Result<(), Diagnostic> {
    let below = |key: &str| if field.is_empty() { key.to_owned() } else { format!("{field}.{key}") };
    match value {
        toml::Value::Float(number) if !number.is_finite() => Err(invalid(field, number, "not finite")),
        toml::Value::Array(all) => {
            all.iter().enumerate().try_for_each(|(i, v)| check_finite(&format!("{field}[{i}]"), v))
        }
        toml::Value::Table(all) => all.iter().try_for_each(|(key, v)| check_finite(&below(key), v)),
        _ => Ok(()),
    }
}

/// Checks that the constants have the names and units of the model's, and are within their bounds.
pub(crate) fn check_constants<'a>(
    model: &Model,
    constants: impl Iterator<Item = (&'a str, &'a str, f64)>,
) -> Result<(), Diagnostic> {
    let names = model.names();
    for (i, ((name, unit, value), (model_name, model_unit))) in constants.zip(&names).enumerate() {
        let field = format!("constants[{i}]");
        if (name, unit) != (model_name.as_str(), *model_unit) {
            let problem =
                format!("expected {model_name:?} in {model_unit:?}, from the listed terms and conditions");
            return Err(invalid(field, format!("{name:?} in {unit:?}"), problem));
        }
        let (low, high) = model.bounds_of(i);
        within(&format!("{field} ({name})"), value, low.max(-MAX_CONSTANT), high.min(MAX_CONSTANT))?;
    }
    Ok(())
}

/// Largest friction in newtons per newton of load, above that of any tendon over any wrap.
const MAX_FRICTION: f64 = 1000.0;

/// Checks that friction and half width of its band in newtons are possible at these loads.
pub(crate) fn check_friction(loads_n: &[f64], friction_n: &[f64], half_n: &[f64]) -> Result<(), Diagnostic> {
    for ((load, friction), half) in loads_n.iter().zip(friction_n).zip(half_n) {
        let most = MAX_FRICTION * load.max(1.0);
        if !(friction.abs() <= most && half.abs() <= most) {
            let problem = format!(
                "the predicted friction is {friction:.3e} N (half band {half:.3e} N) at a load of {load:.2} N, more than {MAX_FRICTION} times the load"
            );
            return Err(Diagnostic::new(codes::MODEL_NOT_FINITE, problem).with_help(HELP));
        }
    }
    Ok(())
}

/// Checks the growth of the error beyond the loads fitted.
pub(crate) fn check_beyond_range(beyond_range: f64) -> Result<(), Diagnostic> {
    within("beyond_range", beyond_range, 0.0, MAX_CONSTANT)
}

/// Converts the random walk of earlier files, one size in newtons, to an offset of the series,
/// which predicts the same. Returns whether there was one.
pub(crate) fn walk_to_offset(file: &mut toml::Table) -> Result<bool, Diagnostic> {
    let noise = file.get_mut("noise").and_then(toml::Value::as_table_mut);
    let Some((walk, noise)) = noise.and_then(|noise| Some((noise.remove("walk_N")?, noise))) else {
        return Ok(false);
    };
    let size_n = walk
        .as_float()
        .ok_or_else(|| invalid("noise.walk_N", &walk, "expected a size in newtons, such as 0.1"))?;
    within("noise.walk_N", size_n, 0.0, MAX_CONSTANT)?;
    let none = || {
        toml::Table::from_iter(
            [("constant_n", 0.0.into()), ("per_load", 0.0.into())].map(|(k, v)| (k.to_owned(), v)),
        )
    };
    let offset = noise.entry("series_common").or_insert_with(|| none().into());
    if let Some(toml::Value::Float(constant_n)) = offset.get_mut("constant_n") {
        *constant_n = libm::hypot(*constant_n, size_n);
    }
    Ok(true)
}

/// Checks that spreads are not negative and correlations not beyond 1.
pub(crate) fn check_noise(noise: &Noise) -> Result<(), Diagnostic> {
    for (name, size) in [
        ("series_scale", noise.series_scale),
        ("mount_scale", noise.mount_scale),
        ("walk.white", noise.walk.white),
        ("walk.common", noise.walk.common),
        ("walk.direction", noise.walk.direction),
        ("group_offset_N", noise.group_offset_n),
        ("specimen_scale", noise.specimen_scale),
    ] {
        within(&format!("noise.{name}"), size, 0.0, MAX_CONSTANT)?;
    }
    for (name, spread) in
        [("repetition", noise.repetition), ("series", noise.series), ("series_common", noise.series_common)]
    {
        within(&format!("noise.{name}.constant_n"), spread.constant_n, 0.0, MAX_CONSTANT)?;
        within(&format!("noise.{name}.per_load"), spread.per_load, 0.0, MAX_CONSTANT)?;
    }
    within("noise.walk.correlation", noise.walk.correlation, 0.0, 1.0)?;
    within("noise.correlation", noise.correlation, -1.0, 1.0)
}

/// Checks that divisors are above zero, shares within 0..1, and grooves and times in ascending
/// order.
pub(crate) fn check_frame(frame: &Frame) -> Result<(), Diagnostic> {
    let positive = f64::MIN_POSITIVE;
    within("frame.stroke_mm", frame.stroke_mm, positive, MAX_CONSTANT)?;
    within("frame.session_s", frame.session_s, positive, MAX_CONSTANT)?;
    within("frame.reference_speed_pct", frame.reference_speed_pct, positive, MAX_CONSTANT)?;
    within("frame.load_range_n[0]", frame.load_range_n.0, 0.0, MAX_CONSTANT)?;
    within("frame.load_range_n[1]", frame.load_range_n.1, frame.load_range_n.0, MAX_CONSTANT)?;
    let (times, shares) = (&frame.travel_time_s, &frame.travel_share);
    if times.len() != shares.len() {
        let problem = format!("expected {} shares, as many as travel_time_s", times.len());
        return Err(invalid("frame.travel_share", format!("{} shares", shares.len()), problem));
    }
    for (i, (time, share)) in times.iter().zip(shares).enumerate() {
        let before = i.checked_sub(1).and_then(|i| times.get(i)).copied().unwrap_or(-MAX_CONSTANT);
        within(&format!("frame.travel_time_s[{i}]"), *time, before, MAX_CONSTANT)?;
        within(&format!("frame.travel_share[{i}]"), *share, 0.0, 1.0)?;
    }
    for (i, change) in frame.changes.iter().enumerate() {
        let count = frame.groups_by(change.by).len();
        if change.groups.is_empty() || change.groups.iter().any(|group| group + 1 >= count) {
            let field = format!("frame.changes[{i}].groups");
            let problem = format!(
                "expected indices from 0 into the {count} {}s, without the last one",
                change.by.as_str()
            );
            return Err(invalid(field, format!("{:?}", change.groups), problem));
        }
    }
    let mut devices = 0;
    for (i, condition) in frame.conditions.iter().enumerate() {
        let field = |name: &str| format!("frame.conditions[{i}].{name}");
        if !condition.pins.is_sorted_by(|a, b| a < b) {
            let pins = format!("{:?}", condition.pins);
            return Err(invalid(field("pins"), pins, "grooves are not in ascending order"));
        }
        within(&field("wrap_rad"), condition.wrap_rad, positive, MAX_WRAP_RAD)?;
        within(&field("weight"), condition.weight, 0.0, 1.0)?;
        within(&field("turn_rad"), condition.turn_rad, 0.0, MAX_WRAP_RAD)?;
        within(&field("ploughing"), condition.ploughing, 0.0, 1e3)?;
        if let Some(device) = condition.device {
            if device != devices {
                return Err(invalid(field("device"), device, format!("expected {devices}, counted from 0")));
            }
            devices += 1;
        }
    }
    Ok(())
}

/// Checks that a table of structure has ascending nodes, and a value for each.
pub(crate) fn check_nodes(field: &str, at: &[f64], value: &[f64]) -> Result<(), Diagnostic> {
    if at.is_empty() || at.len() != value.len() {
        let problem = format!("expected {} values, one for each node of at, at least 1", at.len());
        return Err(invalid(format!("{field}.value"), format!("{} values", value.len()), problem));
    }
    if let Some(i) = at.windows(2).position(|pair| pair[0] >= pair[1]) {
        return Err(invalid(format!("{field}.at[{}]", i + 1), at[i + 1], "not above the node before"));
    }
    Ok(())
}

/// Checks that the covariance is square, symmetric and positive semidefinite up to rounding.
pub(crate) fn check_covariance(rows: &[Vec<f64>], needed: usize) -> Result<(), Diagnostic> {
    if let Some(length) = std::iter::once(rows.len()).chain(rows.iter().map(Vec::len)).find(|n| *n != needed)
    {
        let problem = format!("expected {needed} rows of {needed} numbers");
        return Err(invalid("covariance", format!("{length} numbers"), problem));
    }
    let matrix = DMatrix::from_fn(needed, needed, |i, j| rows[i][j]);
    let largest = matrix.diagonal().iter().copied().fold(0.0, f64::max);
    for i in 0..needed {
        within(&format!("covariance[{i}][{i}]"), matrix[(i, i)], 0.0, f64::MAX)?;
        for j in 0..i {
            let (a, b) = (matrix[(i, j)], matrix[(j, i)]);
            let apart = (a - b).abs();
            if apart.is_nan() || apart > ROUNDING * largest {
                let problem = format!("not symmetric: covariance[{j}][{i}] is {}", short_number(b));
                return Err(invalid(format!("covariance[{i}][{j}]"), short_number(a), problem));
            }
        }
    }
    let least = matrix.symmetric_eigenvalues().iter().copied().fold(f64::INFINITY, f64::min);
    if needed > 0 && (least.is_nan() || least < -ROUNDING * largest) {
        let problem =
            format!("not positive semidefinite: its smallest eigenvalue is {}", short_number(least));
        return Err(Diagnostic::new(codes::INVALID_MODEL, problem)
            .with_location(Location { field: Some("covariance".to_owned()), ..Location::default() })
            .with_help(HELP));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn covariances_must_be_positive_semidefinite() {
        let refused = |rows: &[Vec<f64>]| check_covariance(rows, 2).is_err();
        assert!(!refused(&[vec![1.0, 0.5], vec![0.5, 1.0]]));
        assert!(!refused(&[vec![0.0, 0.0], vec![0.0, 0.0]]));
        assert!(refused(&[vec![1.0, 0.5]]));
        assert!(refused(&[vec![1.0, 0.5], vec![0.4, 1.0]]));
        assert!(refused(&[vec![1.0, 2.0], vec![2.0, 1.0]]));
        assert!(refused(&[vec![-1.0, 0.0], vec![0.0, 1.0]]));
        assert!(refused(&[vec![f64::NAN, 0.0], vec![0.0, 1.0]]));
    }

    #[test]
    fn nodes_ascend_and_have_a_value_each() {
        assert!(check_nodes("s", &[0.0, 1.0], &[2.0, -1.0]).is_ok());
        for (at, value, field) in [
            (&[] as &[f64], &[] as &[f64], "s.value"),
            (&[0.0, 1.0], &[2.0], "s.value"),
            (&[0.0], &[2.0, 3.0], "s.value"),
            (&[1.0, 0.0], &[2.0, 3.0], "s.at[1]"),
            (&[0.0, 1.0, 1.0], &[2.0, 3.0, 4.0], "s.at[2]"),
        ] {
            let error = check_nodes("s", at, value).unwrap_err();
            assert_eq!(error.location().and_then(|l| l.field.as_deref()), Some(field));
        }
    }

    #[test]
    fn impossible_friction_is_refused() {
        assert!(check_friction(&[10.0], &[3.0], &[0.1]).is_ok());
        for (friction, half) in [(f64::NAN, 0.1), (-1e12, 0.1), (3.0, f64::INFINITY), (f64::INFINITY, 0.1)] {
            assert!(check_friction(&[10.0], &[friction], &[half]).is_err(), "{friction} {half}");
        }
    }

    #[test]
    fn infinite_numbers_are_located() {
        let value: toml::Value = toml::from_str("[a]\nb = [1.0, { c = inf }]").unwrap();
        let error = check_finite("", &value).unwrap_err();
        assert_eq!(error.location(), Some(&Location::field("a.b[1].c", "inf")));
    }
}
