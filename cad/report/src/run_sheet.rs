//! `run-sheet.html`: the runs of a proposed experiment, to print for use at the rig.

use std::fmt::Write;

use pinswitch_calibration::experiment::{PlannedRun, Proposal, RigLimits, contact_words};
use pinswitch_calibration::table::Sweep;
use pinswitch_friction::published;

use super::calibration_page::head;
use super::html::escape;

/// Returns the sheet of runs on `rig`; `source` is the name of the calibration that it continues.
pub fn run_sheet(source: &str, proposal: &Proposal, rig: &RigLimits) -> String {
    let mut html = head("Run sheet");
    html.push_str(STYLE);
    let _ = write!(
        html,
        "<h1>Next runs after {}</h1>\n<p>{} runs, about {:.0} minutes. Keep this order: it is part of the \
         experiment. Save each log, or its plateaus, under the number of its run.</p>\n",
        escape(source),
        proposal.runs.len(),
        proposal.minutes
    );
    html.push_str(&questions(proposal));
    if proposal.runs.is_empty() {
        html.push_str("<p>No runs are proposed.</p>\n");
    } else {
        html.push_str(&runs_table(&proposal.runs, rig, Speeds::Actuator, "question"));
        html.push_str(RECORD);
        html.push_str(NOTES);
    }
    html.push_str("</body></html>\n");
    html
}

/// Style of the tables.
pub(crate) const STYLE: &str = "<style>
td.done { width: 2.2em } td.done::before { content: '\\2610' } .mount td { background: #8881; font-weight: 600 }
.runs td:not(:last-child) { white-space: nowrap }
@media print { table { font-size: 9pt } tr { break-inside: avoid } h1 { margin-top: 0 } }
</style>\n";

/// What to record next to the readings.
pub(crate) const RECORD: &str = "<h2>To record</h2>
<ul>
<li>Date, room temperature, operator, printed part, tendon: _______________________________</li>
<li>Zero of the load cell before the first run and after the last: ____________ N, ____________ N</li>
<li>Each removal and refitting of the switch, each repeated run, each deviation from the plan.</li>
</ul>\n";

const NOTES: &str = "<p>Then run <code>pinswitch calibrate FIRST.csv SECOND.csv --plan PLAN --out DIR</code> with the earlier plateau table, the
table of these runs, and the folder of this sheet as PLAN.</p>\n";

fn questions(proposal: &Proposal) -> String {
    // Probabilities are estimates: 0 and 100 % are not shown.
    let percent = |p: f64| match p {
        p if p > 0.99 => "&gt; 99 %".to_owned(),
        p if p < 0.01 => "&lt; 1 %".to_owned(),
        p => format!("{:.0} %", 100.0 * p),
    };
    let mut html = String::new();
    if !proposal.questions.is_empty() {
        html.push_str(
            "<h2>Questions</h2><table><tr><th>question</th><th>probability of an answer</th><th>with the same time for the \
             paper's protocol</th></tr>\n",
        );
        for q in &proposal.questions {
            let [of, or] = q.between.each_ref().map(|id| escape(id));
            let _ = writeln!(
                html,
                "<tr><td>{of} or {or}</td><td>{}</td><td>{}</td></tr>",
                percent(q.resolved_probability),
                percent(q.by_repeating)
            );
        }
        html.push_str("</table>\n");
    }
    if !proposal.unanswerable.is_empty() {
        html.push_str("<h2>Questions that no run on this rig answers</h2><ul>\n");
        for u in &proposal.unanswerable {
            let [of, or] = u.between.each_ref().map(|id| escape(id));
            let _ = writeln!(html, "<li>{of} or {or}: {}</li>", escape(&u.why));
        }
        html.push_str("</ul>\n");
    }
    html
}

/// The speeds of a sheet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Speeds {
    /// Speeds of an actuator, in percent of its full speed, and in mm/s if that is known.
    Actuator,
    /// A hand crank: advance per hole of its drum, mm.
    Crank(f64),
}

/// Returns the heading and the table of `runs`; `last` is the title of the last column, with the
/// purpose of each run.
pub(crate) fn runs_table(runs: &[PlannedRun], rig: &RigLimits, speeds: Speeds, last: &str) -> String {
    let mut html = format!(
        "<h2>Runs</h2>\n<p>{}</p>\n<div class=\"wide\"><table class=\"runs\"><tr><th></th><th>run</th><th>weight on the \
         hook</th><th>hook</th><th>load: weight + hook</th><th>speed</th><th>dwell</th><th>repetitions ecc. + conc.</th>\
         <th>load order</th><th>ends at</th><th>{last}</th></tr>\n",
        words(rig, speeds)
    );
    let (mut mount, mut minutes) = (0, 0.0);
    for (i, run) in runs.iter().enumerate() {
        if run.mount != mount {
            mount = run.mount;
            let _ = writeln!(
                html,
                "<tr class=\"mount\"><td class=\"done\"></td><td colspan=\"10\">mount {mount}: {}</td></tr>",
                escape(&contact_words(run))
            );
        }
        minutes += run.minutes;
        let _ = writeln!(
            html,
            "<tr><td class=\"done\"></td><td>{}</td><td>{} g</td><td>{} g</td><td>{:.2} N</td><td>{}</td><td>{} s</td><td>{} + \
             {}</td><td>{}</td><td>{}</td><td>{}</td></tr>",
            i + 1,
            run.load_mass_g,
            rig.hook_g(run.substrate),
            rig.load_n(run.substrate, run.load_mass_g),
            speed(run, rig, speeds),
            run.dwell_s,
            run.repetitions[0],
            run.repetitions[1],
            if run.sweep == Sweep::Up { "up" } else { "down" },
            clock(minutes),
            escape(&run.asks)
        );
    }
    html.push_str("</table></div>\n");
    html
}

/// The definitions of load and speed.
fn words(rig: &RigLimits, speeds: Speeds) -> String {
    let speed = match (speeds, rig.full_speed_mm_s) {
        (Speeds::Actuator, Some(full)) => {
            format!("Speeds are percentages of the actuator's full speed of {full} mm/s.")
        }
        (Speeds::Actuator, None) => {
            "Speeds are percentages of the actuator's full speed; set <code>full_speed_mm_s</code> in the file of the \
             rig to see them in mm/s."
                .to_owned()
        }
        (Speeds::Crank(step_mm), _) => {
            format!("One hole of the crank's drum is {step_mm:.2} mm of tendon.")
        }
    };
    format!(
        "The load is the weight of the mass on the hook and of the hook itself, at {} m/s<sup>2</sup>. {speed}",
        published::GRAVITY_M_S2
    )
}

fn speed(run: &PlannedRun, rig: &RigLimits, speeds: Speeds) -> String {
    if let Speeds::Crank(_) = speeds {
        return "by hand".to_owned();
    }
    match rig.speed_mm_s(run.speed_pct) {
        Some(mm_s) => format!("{} % = {mm_s:.1} mm/s", run.speed_pct),
        None => format!("{} %", run.speed_pct),
    }
}

/// Formats minutes as hours and minutes.
#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
fn clock(minutes: f64) -> String {
    let whole = minutes.round().clamp(0.0, 1e6) as u64;
    format!("{}:{:02}", whole / 60, whole % 60)
}

#[cfg(test)]
mod tests {
    use super::*;
    use pinswitch_calibration::experiment::paper_runs;

    /// Weight, hook and load of a row agree, and so do the speed in percent and in mm/s.
    #[test]
    fn loads_include_the_hook() {
        let rig = RigLimits { full_speed_mm_s: Some(50.0), ..RigLimits::default() };
        let runs = paper_runs(&rig, 30.0);
        let html = runs_table(&runs, &rig, Speeds::Actuator, "question");
        // (503.6 g + 62.53 g) 9.80665 m/s2
        assert!(
            html.contains("<td>503.6 g</td><td>62.53 g</td><td>5.55 N</td><td>48 % = 24.0 mm/s</td>"),
            "{html}"
        );
        let light = RigLimits { hook_mass_g: Some(10.0), ..RigLimits::default() };
        let html = runs_table(&runs, &light, Speeds::Actuator, "question");
        assert!(html.contains("<td>503.6 g</td><td>10 g</td><td>5.04 N</td><td>48 %</td>"), "{html}");
        assert!(html.contains("set <code>full_speed_mm_s</code>"), "{html}");
    }
}
