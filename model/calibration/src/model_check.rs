//! What a model on file must be to predict anything: finite, within bounds, with the covariance of something.

use nalgebra::DMatrix;

use crate::inference::{Model, Noise};
use crate::table::Frame;

/// Largest constant in its own unit: far above any, and far below what overflows.
const MAX_CONSTANT: f64 = 1e9;
/// Largest wrap angle: two turns.
const MAX_WRAP_RAD: f64 = 4.0 * std::f64::consts::PI;
/// Rounding of a covariance, relative to its largest variance.
const ROUNDING: f64 = 1e-6;

/// A value that no model has: where it stands, what it is, and what it may be.
#[derive(Debug)]
pub(crate) struct Flaw {
    pub(crate) field: String,
    pub(crate) value: String,
    pub(crate) bound: String,
}

impl Flaw {
    fn new(field: impl Into<String>, value: impl ToString, bound: impl Into<String>) -> Self {
        Self { field: field.into(), value: value.to_string(), bound: bound.into() }
    }
}

/// `value` must lie within `low..=high`; NaN lies nowhere.
fn within(field: &str, value: f64, low: f64, high: f64) -> Result<(), Flaw> {
    if (low..=high).contains(&value) && value.is_finite() {
        Ok(())
    } else {
        // The least positive number has over three hundred digits.
        let low = if low == f64::MIN_POSITIVE { "above 0".to_owned() } else { low.to_string() };
        Err(Flaw::new(field, value, format!("{low} to {high}")))
    }
}

/// The first number of `value` that is not finite.
pub(crate) fn check_finite(field: &str, value: &toml::Value) -> Result<(), Flaw> {
    let below = |key: &str| if field.is_empty() { key.to_owned() } else { format!("{field}.{key}") };
    match value {
        toml::Value::Float(number) if !number.is_finite() => Err(Flaw::new(field, number, "a finite number")),
        toml::Value::Array(all) => {
            all.iter().enumerate().try_for_each(|(i, v)| check_finite(&format!("{field}[{i}]"), v))
        }
        toml::Value::Table(all) => all.iter().try_for_each(|(key, v)| check_finite(&below(key), v)),
        _ => Ok(()),
    }
}

/// Constants are those of the model, by name and unit, each within its bounds.
pub(crate) fn check_constants<'a>(
    model: &Model,
    constants: impl Iterator<Item = (&'a str, &'a str, f64)>,
) -> Result<(), Flaw> {
    let names = model.names();
    for (i, ((name, unit, value), (own_name, own_unit))) in constants.zip(&names).enumerate() {
        let field = format!("constants[{i}]");
        if (name, unit) != (own_name.as_str(), *own_unit) {
            let bound = format!("{own_name:?} in {own_unit:?}, by the terms and conditions listed");
            return Err(Flaw::new(field, format!("{name:?} in {unit:?}"), bound));
        }
        let (low, high) = model.bounds_of(i);
        within(&format!("{field} ({name})"), value, low.max(-MAX_CONSTANT), high.min(MAX_CONSTANT))?;
    }
    Ok(())
}

/// Friction in newtons of friction per newton of load beyond which no tendon over any wrap gets.
const MAX_FRICTION: f64 = 1000.0;

/// Friction and its half band in newtons are such as a tendon can have at these loads.
pub(crate) fn check_friction(loads_n: &[f64], friction_n: &[f64], half_n: &[f64]) -> Result<(), Flaw> {
    for ((load, friction), half) in loads_n.iter().zip(friction_n).zip(half_n) {
        let most = MAX_FRICTION * load.max(1.0);
        if !(friction.abs() <= most && half.abs() <= most) {
            let value =
                format!("a friction of {friction:.3e} N (half band {half:.3e} N) at a load of {load:.2} N");
            return Err(Flaw::new("constants or covariance", value, "a thousand times the load"));
        }
    }
    Ok(())
}

/// A growth of errors is one.
pub(crate) fn check_beyond_range(beyond_range: f64) -> Result<(), Flaw> {
    within("beyond_range", beyond_range, 0.0, MAX_CONSTANT)
}

/// Earlier files have a walk of one size in newtons. For a prediction it is an offset of the series like any other, and
/// becomes one. Whether there was one.
pub(crate) fn walk_to_offset(file: &mut toml::Table) -> Result<bool, Flaw> {
    let noise = file.get_mut("noise").and_then(toml::Value::as_table_mut);
    let Some((walk, noise)) = noise.and_then(|noise| Some((noise.remove("walk_N")?, noise))) else {
        return Ok(false);
    };
    let size_n = walk.as_float().ok_or_else(|| Flaw::new("noise.walk_N", &walk, "newtons, as 0.1"))?;
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

/// The noise is one: no negative spread, no correlation beyond one.
pub(crate) fn check_noise(noise: &Noise) -> Result<(), Flaw> {
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

/// Reference values that others are divided by are above zero, shares within one, grooves and times in order.
pub(crate) fn check_frame(frame: &Frame) -> Result<(), Flaw> {
    let positive = f64::MIN_POSITIVE;
    within("frame.stroke_mm", frame.stroke_mm, positive, MAX_CONSTANT)?;
    within("frame.session_s", frame.session_s, positive, MAX_CONSTANT)?;
    within("frame.reference_speed_pct", frame.reference_speed_pct, positive, MAX_CONSTANT)?;
    within("frame.load_range_n[0]", frame.load_range_n.0, 0.0, MAX_CONSTANT)?;
    within("frame.load_range_n[1]", frame.load_range_n.1, frame.load_range_n.0, MAX_CONSTANT)?;
    let (times, shares) = (&frame.travel_time_s, &frame.travel_share);
    if times.len() != shares.len() {
        return Err(Flaw::new(
            "frame.travel_share",
            format!("{} shares", shares.len()),
            format!("{}, as many as travel_time_s", times.len()),
        ));
    }
    for (i, (time, share)) in times.iter().zip(shares).enumerate() {
        let before = i.checked_sub(1).and_then(|i| times.get(i)).copied().unwrap_or(-MAX_CONSTANT);
        within(&format!("frame.travel_time_s[{i}]"), *time, before, MAX_CONSTANT)?;
        within(&format!("frame.travel_share[{i}]"), *share, 0.0, 1.0)?;
    }
    for (i, change) in frame.changes.iter().enumerate() {
        let count = frame.groups_by(change.by).len();
        if change.groups.is_empty() || change.groups.iter().any(|group| group + 1 >= count) {
            return Err(Flaw::new(
                format!("frame.changes[{i}].groups"),
                format!("{:?}", change.groups),
                format!("some of the {count} {}s but the last, counted from 0", change.by.as_str()),
            ));
        }
    }
    let mut devices = 0;
    for (i, condition) in frame.conditions.iter().enumerate() {
        let field = |name: &str| format!("frame.conditions[{i}].{name}");
        if !condition.pins.is_sorted_by(|a, b| a < b) {
            return Err(Flaw::new(field("pins"), format!("{:?}", condition.pins), "grooves in rising order"));
        }
        within(&field("wrap_rad"), condition.wrap_rad, positive, MAX_WRAP_RAD)?;
        within(&field("weight"), condition.weight, 0.0, 1.0)?;
        within(&field("turn_rad"), condition.turn_rad, 0.0, MAX_WRAP_RAD)?;
        within(&field("ploughing"), condition.ploughing, 0.0, 1e3)?;
        if let Some(device) = condition.device {
            if device != devices {
                return Err(Flaw::new(field("device"), device, format!("{devices}, counted from 0")));
            }
            devices += 1;
        }
    }
    Ok(())
}

/// The covariance is square, symmetric and positive semidefinite, but for rounding.
pub(crate) fn check_covariance(rows: &[Vec<f64>], needed: usize) -> Result<(), Flaw> {
    if let Some(length) = std::iter::once(rows.len()).chain(rows.iter().map(Vec::len)).find(|n| *n != needed)
    {
        return Err(Flaw::new(
            "covariance",
            format!("{length} numbers"),
            format!("{needed} rows of {needed}"),
        ));
    }
    let matrix = DMatrix::from_fn(needed, needed, |i, j| rows[i][j]);
    let largest = matrix.diagonal().iter().copied().fold(0.0, f64::max);
    for i in 0..needed {
        within(&format!("covariance[{i}][{i}]"), matrix[(i, i)], 0.0, f64::MAX)?;
        for j in 0..i {
            let (a, b) = (matrix[(i, j)], matrix[(j, i)]);
            let apart = (a - b).abs();
            if apart.is_nan() || apart > ROUNDING * largest {
                return Err(Flaw::new(format!("covariance[{i}][{j}]"), a, format!("{b}, as at [{j}][{i}]")));
            }
        }
    }
    let least = matrix.symmetric_eigenvalues().iter().copied().fold(f64::INFINITY, f64::min);
    if needed > 0 && (least.is_nan() || least < -ROUNDING * largest) {
        return Err(Flaw::new("covariance", format!("eigenvalue {least}"), "none below zero"));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_covariance_is_one_of_something() {
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
    fn friction_that_no_tendon_has_is_refused() {
        assert!(check_friction(&[10.0], &[3.0], &[0.1]).is_ok());
        for (friction, half) in [(f64::NAN, 0.1), (-1e12, 0.1), (3.0, f64::INFINITY), (f64::INFINITY, 0.1)] {
            assert!(check_friction(&[10.0], &[friction], &[half]).is_err(), "{friction} {half}");
        }
    }

    #[test]
    fn a_number_that_is_not_finite_is_found_at_any_depth() {
        let value: toml::Value = toml::from_str("[a]\nb = [1.0, { c = inf }]").unwrap();
        let flaw = check_finite("", &value).unwrap_err();
        assert_eq!((flaw.field.as_str(), flaw.value.as_str()), ("a.b[1].c", "inf"));
    }
}
