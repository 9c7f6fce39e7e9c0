//! The documents of a rig state the same figures, and the programs read its files.

use super::*;
use pinswitch_calibration::segmentation::RunPlan;

/// Facts of a rig with the paper's weights.
pub(crate) fn facts(drive: Drive) -> RigFacts {
    RigFacts {
        name: "three-double".to_owned(),
        pins: vec![5, 8, 11],
        has_silicone: true,
        has_proxy: true,
        wrap_angle_deg: 70.5,
        hook_mass_g: 41.25,
        weights_g: published::WEIGHTS_G.to_vec(),
        cell: "S-beam load cell, M8".to_owned(),
        cell_limit_n: 98.0,
        sample_rate_hz: 160.0,
        drive,
        stroke_mm: 143.5,
        items: vec![BoughtItem::new(2, "Bearing 608", "guide pulleys")],
    }
}

const DRIVES: [Drive; 2] = [Drive::Actuator { full_speed_mm_s: 37.5 }, Drive::Crank { step_mm: 5.46 }];

/// Numbers in `text` directly before `unit`.
fn before(text: &str, unit: &str) -> Vec<f64> {
    let ends = text.match_indices(unit).filter(|(at, _)| {
        let next = text[at + unit.len()..].chars().next();
        next.is_none_or(|c| !c.is_alphanumeric() && c != '/')
    });
    ends.filter_map(|(at, _)| {
        let number = text[..at].rsplit(|c: char| !c.is_ascii_digit() && c != '.').next()?;
        number.parse().ok()
    })
    .collect()
}

#[test]
fn programs_read_the_facts() {
    for drive in DRIVES {
        let facts = facts(drive);
        let limits = RigLimits::parse(&rig_toml(&facts), "rig.toml").unwrap();
        assert_eq!(limits, facts.limits());
        let run = RunPlan::parse(&run_toml(&facts), "run.toml").unwrap();
        assert_eq!(run.rig.hook_mass_g, facts.hook_mass_g);
        assert_eq!(run.rig.sample_rate_hz, Some(facts.sample_rate_hz));
        assert_eq!(run.rig.stroke_mm, Some(facts.stroke_mm));
        assert_eq!(run.rig.wrap_angle_deg, facts.wrap_angle_deg);
        assert_eq!(run.rig.full_speed_mm_s, facts.full_speed_mm_s());
        let runs = facts.runs();
        assert_eq!(run.series.len(), runs.len());
        assert_eq!(runs.len(), 3 * facts.weights_g.len());
        for (series, planned) in run.series.iter().zip(&runs) {
            assert_eq!((series.substrate, &series.pins), (planned.substrate, &planned.pins));
            assert_eq!(series.load_mass_g, Some(planned.load_mass_g));
            assert_eq!(series.load_n(&run.rig), Some(limits.load_n(planned.substrate, planned.load_mass_g)));
            let speed = matches!(drive, Drive::Actuator { .. }).then_some(planned.speed_pct);
            assert_eq!(series.speed_pct, speed);
        }
    }
}

/// Every weight, load and speed of a document is that of the other documents.
#[test]
fn documents_state_the_same_figures() {
    for drive in DRIVES {
        let facts = facts(drive);
        let (bill, run, sheet, wiring) =
            (bill_csv(&facts), run_toml(&facts), rig_sheet(&facts), wiring_svg(&facts));
        let plan = RunPlan::parse(&run, "run.toml").unwrap();
        // Loads of the run are on the sheet, next to weight and hook, and in the bill.
        for series in &plan.series {
            let weight = series.load_mass_g.unwrap();
            let load = series.load_n(&plan.rig).unwrap();
            let row = format!("<td>{weight} g</td><td>{} g</td><td>{load:.2} N</td>", plan.rig.hook_mass_g);
            assert!(sheet.contains(&row), "{row} is not in {sheet}");
            assert!(sheet.contains(&format!("<td>{}</td>", series.file)), "{}", series.file);
            assert!(bill.contains(&format!("Weight of {weight} g")), "{bill}");
            assert!(bill.contains(&format!("{load:.3} N with the hook")), "{bill}");
            if let (Some(pct), Some(full)) = (series.speed_pct, plan.rig.full_speed_mm_s) {
                let speed = format!("<td>{pct} % = {:.1} mm/s</td>", full * pct / 100.0);
                assert!(sheet.contains(&speed), "{speed} is not in {sheet}");
            }
        }
        // Rates, speeds, hook, stroke, range and voltage, wherever they are.
        let all = [&bill, &sheet, &wiring];
        for text in all {
            assert!(before(text, " Hz").iter().all(|hz| *hz == facts.sample_rate_hz), "{text}");
            assert!(!before(text, " Hz").is_empty(), "{text}");
            assert!(text.contains(&format!("range {} N", facts.cell_limit_n)), "{text}");
            assert!(facts.cell.split(", ").all(|words| text.contains(words)), "{text}");
            assert!(text.contains(&format!("{} g", facts.hook_mass_g)), "{text}");
            let volts = before(text, " V");
            assert!(volts.iter().all(|v| *v == f64::from(wiring::SUPPLY_V)), "{text}");
            let speeds = before(text, " mm/s");
            match facts.full_speed_mm_s() {
                None => assert!(speeds.is_empty() && volts.is_empty(), "{text}"),
                Some(full) => {
                    let known = |mm_s: &f64| {
                        let runs = facts.runs();
                        let mut known = runs.iter().map(|run| run.speed_pct * full / 100.0).chain([full]);
                        known.any(|k| (k - mm_s).abs() < 0.051)
                    };
                    assert!(speeds.contains(&full) && speeds.iter().all(known), "{text}");
                }
            }
        }
        for text in [&sheet, &wiring] {
            assert!(text.contains(&format!("{:.2} N", facts.heaviest_n())), "{text}");
            assert!(text.contains(&format!("{} mm", facts.stroke_mm)), "{text}");
        }
        let has_stroke = bill.contains(&format!("stroke {} mm", facts.stroke_mm));
        assert_eq!(has_stroke, matches!(drive, Drive::Actuator { .. }), "{bill}");
        assert!(sheet.contains(&format!("{} deg", facts.wrap_angle_deg)), "{sheet}");
        // The columns of the logger are those that `segment` reads.
        for column in ["time_s", "force_N", "position_mm", "power_W"] {
            assert!(run.contains(column) && wiring.contains(column), "{column}");
        }
    }
}

/// Layouts that the paper's segment cannot have, and a proxy alone, give valid files.
#[test]
fn other_layouts_have_valid_files() {
    for (pins, has_silicone, has_proxy) in
        [(vec![], true, false), (vec![3, 20], true, true), (vec![20], false, true), (vec![8], false, true)]
    {
        let facts = RigFacts { pins, has_silicone, has_proxy, ..facts(DRIVES[0]) };
        assert_eq!(RigLimits::parse(&rig_toml(&facts), "rig.toml").unwrap(), facts.limits());
        let run = RunPlan::parse(&run_toml(&facts), "run.toml").unwrap();
        assert_eq!(run.series.len(), facts.runs().len());
        assert!(!run.series.is_empty());
    }
}
