//! The documented range of a parameter is the actual one. At both ends, alone and with each other
//! parameter of its table, a configuration gives parts, or one error with field, value and remedy.
//! Values beyond the ends are refused.

use std::sync::Mutex;

use pinswitch_switch::config::parameter::Parameter;
use pinswitch_switch::config::{Configuration, assign};
use pinswitch_switch::feasibility;
use pinswitch_switch::output::BuildError;

/// Assignments to which the value of a field is added; each enables rules that constrain other
/// fields.
const BASES: [&[&str]; 6] = [
    &[],
    &["mould.kind=one-piece", "label.engrave=false"],
    &["support.slot_kind=through", "parts.guide_pulley=true"],
    &["fasteners.kind=insert", "mount.kind=flange", "tendon.sheath_diameter_mm=3"],
    &["fasteners.kind=screw", "mount.kind=joint"],
    &["fasteners.dowel_diameter_mm=1.5", "mount.kind=rig", "mould.kind=one-piece"],
];

/// Returns the ends of a numeric field's range, as its description gives them.
fn ends(field: &Parameter<Configuration>) -> Option<[String; 2]> {
    let range = (field.range)();
    let (low, high) = range.split_once(" to ")?;
    let is_number = |text: &str| text.parse::<f64>().is_ok();
    (is_number(low) && is_number(high)).then(|| [low.to_owned(), high.to_owned()])
}

/// Returns a description of the fault, or `None` if the configuration gives parts or an error with
/// a remedy.
fn fault(assignments: &[String]) -> Option<String> {
    let mut c = Configuration::default();
    // Coarse curves and meshes, for speed: this test does not examine them.
    for assignment in ["friction.points=2", "mesh.chord_tolerance_mm=0.05"] {
        assign(&mut c, assignment).unwrap();
    }
    for assignment in assignments {
        assign(&mut c, assignment).unwrap();
    }
    let error = match feasibility::design(c).map_err(BuildError::Configuration).and_then(feasibility::build) {
        Ok(_) => return None,
        Err(BuildError::Configuration(error)) => error,
        Err(other) => return Some(format!("{assignments:?}: {other}")),
    };
    let text = error.to_string();
    let location = error.location().cloned().unwrap_or_default();
    let known = Configuration::PARAMETERS.iter().any(|p| Some(p.path()) == location.field);
    let is_clear = known && location.value.is_some() && error.help().is_some() && text.len() < 600;
    (!is_clear).then(|| format!("{assignments:?}: {text}"))
}

#[test]
fn numeric_fields_work_at_both_ends() {
    let fields: Vec<_> = Configuration::PARAMETERS.iter().filter_map(|f| Some((f, ends(f)?))).collect();
    assert!(fields.len() >= 55, "{}", fields.len());
    let mut cases: Vec<Vec<String>> = Vec::new();
    for (i, (field, own)) in fields.iter().enumerate() {
        for (end, beyond) in own.iter().zip([-1.0, 1.0]) {
            let case = format!("{}={end}", field.path());
            for base in BASES {
                cases.push(base.iter().map(|b| (*b).to_owned()).chain([case.clone()]).collect());
            }
            for (other, of_other) in
                fields[i + 1..].iter().filter(|(other, _)| other.section == field.section)
            {
                cases
                    .extend(of_other.iter().map(|end| vec![case.clone(), format!("{}={end}", other.path())]));
            }
            let outside = end.parse::<f64>().unwrap() + beyond;
            let refused = assign(&mut Configuration::default(), &format!("{}={outside}", field.path()));
            assert!(refused.is_err(), "{} = {outside}", field.path());
        }
    }
    let (faults, next) = (Mutex::new(Vec::new()), std::sync::atomic::AtomicUsize::new(0));
    std::thread::scope(|scope| {
        for _ in 0..2 {
            scope.spawn(|| {
                while let Some(case) = cases.get(next.fetch_add(1, std::sync::atomic::Ordering::Relaxed)) {
                    faults.lock().unwrap().extend(fault(case));
                }
            });
        }
    });
    let faults = faults.into_inner().unwrap();
    println!("{} configurations of {} fields", cases.len(), fields.len());
    assert!(faults.is_empty(), "{} of {}:\n{}", faults.len(), cases.len(), faults.join("\n"));
}
