//! Every proposal for an infeasible configuration is feasible.

use super::*;
use crate::config::parameter::Parameter;
use crate::config::{Change, assign};
use crate::design::{Dimensions, is_accepted};

fn with_all(assignments: &[&str]) -> Configuration {
    let mut c = Configuration::default();
    assignments.iter().for_each(|a| assign(&mut c, a).unwrap());
    c
}

fn error_of(c: &Configuration) -> Option<Diagnostic> {
    design(c.clone()).map_err(BuildError::from).and_then(build).err().map(Diagnostic::from)
}

fn field_of(error: &Diagnostic) -> String {
    error.location().and_then(|location| location.field.clone()).unwrap_or_default()
}

/// The alternatives of a help, each as the assignments that it names.
fn alternatives_of(error: &Diagnostic) -> Vec<Vec<String>> {
    let subject = field_of(error);
    let field = |name: &str| if name == "it" { subject.clone() } else { name.to_owned() };
    let assignment = |words: &str| match words.splitn(4, ' ').collect::<Vec<_>>()[..] {
        ["lower" | "raise" | "set", name, "to", value] => format!("{}={value}", field(name)),
        ["set", name, "=", value] => format!("{}={value}", field(name)),
        _ => panic!("{words:?} is not an instruction"),
    };
    let help = error.help().unwrap_or_else(|| panic!("no help: {error}"));
    if help.contains(" more values, ") {
        return Vec::new();
    }
    let mut alternatives = vec![Vec::new()];
    // A list contains commas, but none before a verb.
    let marked = help.replace(", or ", "|").replace(", and ", "&");
    let marked = ["lower ", "raise ", "set "]
        .into_iter()
        .fold(marked, |text, verb| text.replace(&format!(", {verb}"), &format!("|{verb}")));
    for (i, alternative) in marked.split('|').enumerate() {
        if i > 0 {
            alternatives.push(Vec::new());
        }
        alternatives[i].extend(alternative.split('&').map(assignment));
    }
    alternatives
}

fn changed(c: &Configuration, assignments: &[String]) -> Configuration {
    let mut changed = c.clone();
    assignments.iter().for_each(|a| assign(&mut changed, a).unwrap());
    changed
}

/// The configuration with the changes of a diagnostic.
fn with_changes(c: &Configuration, error: &Diagnostic) -> Configuration {
    let set = error.changes().iter().map(|Change { field, value }| format!("{field}={value}"));
    changed(c, &set.collect::<Vec<_>>())
}

/// Returns a description of wrong proposals for a configuration that breaks rules. Tests in
/// tests/slow build them.
fn fault_of(c: &Configuration) -> Option<String> {
    let error = design(c.clone()).err()?;
    let text = error.to_string();
    if text.len() > 600 || error.changes().is_empty() || !is_accepted(with_changes(c, &error)) {
        return Some(text);
    }
    let refused = alternatives_of(&error).into_iter().find(|way| !is_accepted(changed(c, way)));
    refused.map(|way| format!("{text}\n   {way:?} is refused"))
}

#[test]
fn proposals_for_extreme_values_are_feasible() {
    let fields: Vec<_> = Configuration::PARAMETERS.iter().filter_map(|p| Some((p, (p.ends)()?))).collect();
    let (mut faults, mut errors, mut pair) = (Vec::new(), 0, 0);
    for (i, (a, ends_a)) in fields.iter().enumerate() {
        for (b, ends_b) in &fields[i..] {
            for ends in [(0, 0), (0, 1), (1, 0), (1, 1)] {
                // Every ninth pair: all of them take minutes.
                pair += 1;
                if pair % 9 != 0 {
                    continue;
                }
                let value = |p: &Parameter<Configuration>, x: f64| format!("{}={x}", p.path());
                let (first, second) = (value(a, ends_a[ends.0]), value(b, ends_b[ends.1]));
                let c = with_all(&["layout.pins=[5, 8, 11]", &first, &second]);
                errors += usize::from(Design::new(c.clone()).is_err());
                faults.extend(fault_of(&c));
            }
        }
    }
    assert!(errors > 300, "{errors}");
    assert!(
        faults.is_empty(),
        "{} of {errors}:\n{}",
        faults.len(),
        faults[..faults.len().min(25)].join("\n")
    );
}

#[test]
fn proposals_for_random_configurations_are_feasible() {
    let fields: Vec<_> = Configuration::PARAMETERS.iter().filter_map(|p| Some((p, (p.ends)()?))).collect();
    let mut state = 1u64;
    let mut next = move || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 40) as f64 / (1u64 << 24) as f64
    };
    let mut faults = Vec::new();
    for case in 0..200 {
        let mut c = Configuration::default();
        for choice in [
            "mould.kind=one-piece",
            "mould.kind=none",
            "support.slot_kind=through",
            "fasteners.kind=insert",
            "mount.kind=joint",
            "mount.kind=rig",
        ] {
            if next() < 0.25 {
                assign(&mut c, choice).unwrap();
            }
        }
        // From one odd value to all values odd. The finest meshes take seconds.
        let share = [0.03, 0.1, 0.3, 1.0][case % 4];
        for (parameter, [low, high]) in fields.iter().filter(|(p, _)| p.section != "mesh") {
            if next() < share {
                let value = low + (high - low) * next();
                let value = if (parameter.get)(&c).is_integer() { value.round() } else { value };
                assign(&mut c, &format!("{}={value}", parameter.path())).unwrap();
            }
        }
        faults.extend(fault_of(&c));
    }
    assert!(faults.is_empty(), "{}:\n{}", faults.len(), faults[..faults.len().min(25)].join("\n"));
}

#[test]
fn help_starts_with_the_field_to_blame() {
    for (assignments, field, words) in [
        (&["tendon.rope_diameter_mm=4.4"][..], "tendon.rope_diameter_mm", "lower it to 3.9"),
        (&["tendon.coating_mm=2"], "tendon.coating_mm", "lower it to 1.6"),
        (&["print.elephant_foot_mm=1"], "print.elephant_foot_mm", "lower it to 0."),
        (&["segment.span_deg=340", "layout.wrap_angle_deg=340"], "segment.span_deg", "kind = \"none\""),
        (&["segment.end_margin_mm=10"], "segment.end_margin_mm", "lower it to "),
        (&["layout.pins=[5, 16]"], "layout.pins", "set it to [5, 15], or raise segment.grooves to 16"),
        (&["layout.pins=[5, 5]"], "layout.pins", "set it to [5]"),
        (&["layout.substrate=abs"], "layout.pins", "set layout.substrate = \"silicone\""),
    ] {
        let error = error_of(&with_all(assignments)).unwrap();
        assert_eq!(field_of(&error), field, "{error}");
        assert!(error.help().unwrap().contains(words), "{error}");
    }
}

/// A set can be made with every proposed value, without other errors or notes of omitted features.
#[test]
fn proposals_about_hardware_build() {
    for assignments in [
        &["fasteners.kind=insert", "fasteners.hole_diameter_mm=4"][..],
        &["fasteners.kind=insert", "fasteners.hole_diameter_mm=4.1"],
        &["fasteners.kind=insert", "fasteners.hole_diameter_mm=5.5"],
        &["fasteners.hole_diameter_mm=1.5"],
        &["fasteners.dowel_diameter_mm=3.95"],
        &["fasteners.dowel_diameter_mm=2.2"],
        &["shell.width_mm=60"],
        &["shell.width_mm=100"],
        &["mount.kind=rig", "mount.plate_mm=5"],
        &["mount.kind=flange", "mount.plate_mm=3"],
        &["mount.kind=flange", "tendon.sheath_diameter_mm=3", "mount.plate_mm=2.5"],
        &["segment.grooves=40"],
        &["segment.grooves=60"],
        &["print.elephant_foot_mm=0.3"],
        &["print.elephant_foot_mm=0.5"],
        &["print.elephant_foot_mm=1"],
        &["shell.wall_mm=60"],
        &["segment.span_deg=322", "layout.wrap_angle_deg=322"],
    ] {
        let c = with_all(assignments);
        let error = error_of(&c).unwrap_or_else(|| panic!("{assignments:?} is feasible"));
        let alternatives = alternatives_of(&error);
        assert!(!alternatives.is_empty(), "{error}");
        for way in alternatives {
            let next = error_of(&changed(&c, &way));
            assert!(next.is_none(), "{error}\n{way:?} leads to {}", next.unwrap());
        }
        assert_eq!(error_of(&with_changes(&c, &error)), None, "{error}");
    }
}

/// No single value satisfies both rules.
#[test]
fn several_broken_rules_are_solved_together() {
    let c = with_all(&["layout.pins=[5, 8, 11]", "segment.end_margin_mm=10", "friction.load_min_n=1000"]);
    let error = error_of(&c).unwrap();
    let [way] = &alternatives_of(&error)[..] else { panic!("{error}") };
    assert_eq!(way.len(), 2, "{error}");
    assert_eq!(error_of(&changed(&c, way)), None, "{error}");
    assert!(error.help().unwrap().contains(", and lower friction.load_min_n to 49.67"), "{error}");
}

#[test]
fn parts_that_do_not_build_have_proposals() {
    // No rule covers crossing contours, or offsets that remove an edge.
    let mut followed = 0;
    for path in std::fs::read_dir("../../tests/corpus").unwrap().map(|entry| entry.unwrap().path()) {
        if path.extension().is_none_or(|extension| extension != "toml") {
            continue;
        }
        let text = std::fs::read_to_string(&path).unwrap();
        let (c, _) = crate::config::read(&text, "corpus").unwrap();
        if Design::new(c.clone()).is_err() {
            continue;
        }
        let Some(error) = error_of(&c) else { continue };
        for way in alternatives_of(&error) {
            assert_eq!(error_of(&changed(&c, &way)), None, "{}: {error}", path.display());
            followed += 1;
        }
    }
    assert!(followed >= 3, "{followed}");
}

#[test]
fn a_repair_names_the_reason_of_each_change() {
    let c = with_all(&["segment.end_margin_mm=10", "friction.load_min_n=1000", "shell.width_mm=15"]);
    let proposal = repair(&c).unwrap().unwrap();
    let fields: Vec<_> = proposal.changes.iter().map(|change| change.field.as_str()).collect();
    assert_eq!(fields, ["segment.end_margin_mm", "friction.load_min_n"]);
    assert!(proposal.changes[0].reason.contains("too far beyond the span"), "{proposal:?}");
    assert!(proposal.changes[1].reason.contains("empty range of loads"), "{proposal:?}");
    assert_eq!(repair(&proposal.configuration).unwrap(), None);
}

/// A larger bed for the largest part, a smaller part, or none.
#[test]
fn proposals_make_room_on_the_bed() {
    for (set, part, ways) in [
        (&["print.bed_mm=55"][..], "coupon", 2),
        (&["shell.outer_radius_mm=60", "print.bed_mm=80"], "mould-core", 2),
        (&["shell.outer_radius_mm=120", "print.bed_mm=180"], "mould-core", 3),
        (&["mould.kind=none", "shell.outer_radius_mm=100", "print.bed_mm=140"], "support-right", 2),
        (&["mould.kind=one-piece", "shell.outer_radius_mm=60", "print.bed_mm=80"], "mould-tray", 2),
        (&["mount.kind=rig", "print.bed_mm=100"], "rig-plate", 2),
        (&["parts.guide_pulley=true", "parts.coupon=false", "print.bed_mm=50"], "guide-pulley", 1),
    ] {
        let c = with_all(set);
        let error = error_of(&c).unwrap();
        assert!(error.problem().starts_with(&format!("bed too small for {part} (")), "{set:?}: {error}");
        let alternatives = alternatives_of(&error);
        assert!(alternatives.len() >= ways, "{set:?}: {error}");
        for way in alternatives {
            assert_eq!(error_of(&changed(&c, &way)), None, "{set:?}: {error}");
            if let Some(bed) = way[0].strip_prefix("print.bed_mm=") {
                let smaller = format!("print.bed_mm={}", bed.parse::<f64>().unwrap() - 0.002);
                assert!(error_of(&changed(&c, &[smaller])).is_some(), "{set:?}: {error}");
            }
        }
    }
}

#[test]
fn recesses_are_kept_where_they_fit() {
    let c = with_all(&["shell.wall_mm=4"]);
    let error = error_of(&c).unwrap();
    let repaired = with_changes(&c, &error);
    assert!(!Dimensions::new(repaired).lacks_recesses(), "{error}");
}

/// Two changed numbers are nearer to what the user wants than another kind of mount.
#[test]
fn a_choice_is_kept_where_two_numbers_are_enough() {
    for assignments in [
        &["layout.pins=[5, 8, 11]", "mount.kind=joint", "mount.proximal_mm=10", "mount.distal_mm=10"][..],
        &[
            "layout.pins=[5, 8, 11]",
            "mount.kind=joint",
            "mount.flexion_min_deg=150",
            "mount.flexion_max_deg=10",
        ],
    ] {
        let c = with_all(assignments);
        let proposal = repair(&c).unwrap().unwrap();
        assert_eq!(proposal.configuration.mount.kind, c.mount.kind, "{assignments:?} {:?}", proposal.changes);
        assert!(build(Design::new(proposal.configuration).unwrap()).is_ok(), "{assignments:?}");
    }
}
