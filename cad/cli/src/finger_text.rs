//! The gains of fingers as text: the tables for the terminal and finger.csv.

use std::fmt::Write;

use pinswitch_friction::finger::{FingerPoint, Gain, extra_holding_of};
use pinswitch_friction::published::{HUMAN_FORCE_DIFFERENCE, HUMAN_PEAK_DIFFERENCE, HUMAN_PEAK_JOINT_DEG};

use super::finger::{Layout, Report};

/// Loads of the table, as shares of the heaviest load.
const ROWS: [f64; 3] = [0.1, 0.5, 1.0];
/// Flexions of the table in degrees; those outside the requested range are left out. At the third, the human finger has
/// its largest force difference, and the last is the end of the range.
const FLEXIONS_DEG: [f64; 4] = [30.0, 60.0, HUMAN_PEAK_JOINT_DEG, 180.0];

fn percent(share: f64) -> f64 {
    100.0 * share
}

/// Formats a gain with its band: `40.3 % (37.4 to 43.4)`.
fn with_band(gain: Gain) -> String {
    format!("{:.1} % ({:.1} to {:.1})", percent(gain.value), percent(gain.low), percent(gain.high))
}

/// Formats the three tables, the human finger for comparison, the joints, the assumptions and the notes.
pub(super) fn table(report: &Report) -> String {
    let mut text = String::new();
    over_load(&mut text, &report.layouts);
    text.push('\n');
    over_joint(&mut text, &report.layouts);
    text.push('\n');
    motors(&mut text, &report.layouts);
    let (low, high) = HUMAN_FORCE_DIFFERENCE;
    // Writing to a string cannot fail, here and below.
    let _ = writeln!(
        text,
        "\nhuman finger: {:.0} to {:.0} % force difference at high load (largest mean {:.0} %, near {:.0} deg of \
         flexion),\n  which equals {:.1} to {:.1} % extra holding",
        percent(low),
        percent(high),
        percent(HUMAN_PEAK_DIFFERENCE),
        HUMAN_PEAK_JOINT_DEG,
        percent(extra_holding_of(low)),
        percent(extra_holding_of(high))
    );
    for (name, joint) in report.layouts.iter().filter_map(|l| Some((&l.name, l.joint.as_ref()?))) {
        let [[low, high], [least, most], [near, far]] =
            [joint.flexion_deg, joint.wrap_deg, joint.moment_arm_mm];
        let _ = writeln!(
            text,
            "joint of {name}: at {low} to {high} deg of flexion the wrap is {least:.1} to {most:.1} deg, on one side;\n  \
             the moment arm of the tendon is {near:.2} to {far:.2} mm"
        );
    }
    for assumption in &report.assumptions {
        let _ = writeln!(text, "assumed: {assumption}");
    }
    for note in notes(&report.layouts) {
        let _ = writeln!(text, "note: {note}");
    }
    text
}

/// Lists why curves over the joint are not published ones; layouts with the same reason share a note.
fn notes(layouts: &[Layout]) -> Vec<String> {
    let mut reasons: Vec<(&str, Vec<&str>)> = Vec::new();
    for layout in layouts {
        for reason in layout.over_joint.last().into_iter().flat_map(|joint| &joint.reasons) {
            match reasons.iter_mut().find(|(known, _)| known == reason) {
                Some((_, names)) => names.push(&layout.name),
                None => reasons.push((reason, vec![&layout.name])),
            }
        }
    }
    let named = |(reason, names): (&str, Vec<&str>)| {
        if names.len() == layouts.len() {
            reason.to_owned()
        } else {
            format!("{}: {reason}", names.join(", "))
        }
    };
    reasons.into_iter().map(named).collect()
}

fn over_load(text: &mut String, layouts: &[Layout]) {
    let _ = writeln!(
        text,
        "{:<16} {:>8}  {:>24} {:>10}  {:>24} {:>10}",
        "over load", "load", "force difference", "measured", "extra holding", "extra pull"
    );
    for layout in layouts {
        let heaviest = layout.points.last().map_or(0.0, |p| p.load_n);
        for share in ROWS {
            let far = |p: &FingerPoint| (p.load_n - share * heaviest).abs();
            let Some(p) = layout.points.iter().min_by(|a, b| far(a).total_cmp(&far(b))) else { continue };
            let measured = layout.measured.iter().find(|m| (m.load_n - p.load_n).abs() < 0.01 * p.load_n);
            let measured =
                measured.map_or(String::new(), |m| format!("{:.1} %", percent(m.force_difference)));
            let _ = writeln!(
                text,
                "{:<16} {:>6.1} N  {:>24} {measured:>10}  {:>24} {:>8.1} %",
                layout.name,
                p.load_n,
                with_band(p.force_difference),
                with_band(p.extra_holding),
                percent(p.concentric_penalty.value)
            );
        }
    }
}

fn over_joint(text: &mut String, layouts: &[Layout]) {
    let _ = writeln!(
        text,
        "{:<16} {:>8} {:>8} {:>5} {:>24}  {:>24}",
        "over the joint", "flexion", "load", "pins", "force difference", "extra holding"
    );
    for layout in layouts {
        let Some(joint) = layout.over_joint.last() else { continue };
        let mut last = None;
        for flexion_deg in FLEXIONS_DEG {
            let far = |deg: f64| (deg - flexion_deg).abs();
            let nearest = joint.points.iter().min_by(|a, b| far(a.joint_deg).total_cmp(&far(b.joint_deg)));
            let Some(p) = nearest.filter(|p| last != Some(p.joint_deg)) else { continue };
            last = Some(p.joint_deg);
            let _ = writeln!(
                text,
                "{:<16} {:>4.0} deg {:>6.1} N {:>5} {:>24}  {:>24}",
                layout.name,
                p.joint_deg,
                p.gains.load_n,
                p.pins,
                with_band(p.gains.force_difference),
                with_band(p.gains.extra_holding)
            );
        }
    }
}

fn motors(text: &mut String, layouts: &[Layout]) {
    let _ = writeln!(
        text,
        "{:<16} {:>8} {:>8}  {:>24} {:>16}",
        "motor", "holds", "tension", "mass saved", "pulls at most"
    );
    for layout in layouts {
        let Some(motor) = layout.motor else { continue };
        let _ = writeln!(
            text,
            "{:<16} {:>6.1} N {:>6.1} N  {:>24} {:>14.1} N",
            layout.name,
            motor.holds_n,
            motor.tension_n,
            with_band(motor.mass_saved),
            motor.pulls_n
        );
    }
}

/// Formats every load and every flexion of each layout as CSV; gains are fractions.
pub(super) fn csv(report: &Report) -> String {
    let mut text = "layout,over,joint_deg,wrap_deg,load_N,holding_N,pulling_N".to_owned();
    for share in ["force_difference", "extra_holding", "motor_mass_saved", "concentric_penalty"] {
        let _ = write!(text, ",{share},{share}_low,{share}_high");
    }
    text.push_str(",trust\n");
    for layout in &report.layouts {
        let trust = word(&layout.trust);
        for point in &layout.points {
            row(&mut text, [&layout.name, "load", "", &format!("{:.4}", layout.wrap_deg)], point, &trust);
        }
        for point in layout.over_joint.iter().flat_map(|joint| &joint.points) {
            let (joint, wrap) = (format!("{:.4}", point.joint_deg), format!("{:.4}", point.wrap_deg));
            row(&mut text, [&layout.name, "joint", &joint, &wrap], &point.gains, &word(&point.status));
        }
    }
    text
}

/// Returns the word that stands for a value in JSON.
fn word(value: &impl serde::Serialize) -> String {
    serde_json::to_value(value).ok().and_then(|v| v.as_str().map(str::to_owned)).unwrap_or_default()
}

fn row(text: &mut String, place: [&str; 4], point: &FingerPoint, trust: &str) {
    let gains =
        [point.force_difference, point.extra_holding, point.motor_mass_saved, point.concentric_penalty];
    let numbers: Vec<String> = [point.load_n, point.holding_n, point.pulling_n]
        .into_iter()
        .map(|force| format!("{force:.4}"))
        .chain(gains.iter().flat_map(|g| [g.value, g.low, g.high]).map(|share| format!("{share:.6}")))
        .collect();
    // A name may contain the characters that separate cells.
    let name = if place[0].contains([',', '"', '\n']) {
        format!("\"{}\"", place[0].replace('"', "\"\""))
    } else {
        place[0].to_owned()
    };
    let _ = writeln!(text, "{name},{},{},{},{},{trust}", place[1], place[2], place[3], numbers.join(","));
}
