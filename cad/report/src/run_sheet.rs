//! `run-sheet.html`: the runs of a proposed experiment, to print for use at the rig.

use std::fmt::Write;

use pinswitch_calibration::experiment::{PlannedRun, Proposal, contact_words};
use pinswitch_calibration::table::Sweep;
use pinswitch_friction::published;

use super::calibration_page::head;
use super::html::escape;

/// Returns the sheet; `source` is the name of the calibration that it continues.
pub fn run_sheet(source: &str, proposal: &Proposal) -> String {
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
        html.push_str(&runs(&proposal.runs));
        html.push_str(NOTES);
    }
    html.push_str("</body></html>\n");
    html
}

const STYLE: &str = "<style>
td.done { width: 2.2em } td.done::before { content: '\\2610' } .mount td { background: #8881; font-weight: 600 }
.runs td:not(:last-child) { white-space: nowrap }
@media print { table { font-size: 9pt } tr { break-inside: avoid } h1 { margin-top: 0 } }
</style>\n";

const NOTES: &str = "<h2>To record</h2>
<ul>
<li>Date, room temperature, operator, printed part, tendon: _______________________________</li>
<li>Zero of the load cell before the first run and after the last: ____________ N, ____________ N</li>
<li>Each removal and refitting of the switch, each repeated run, each deviation from the plan.</li>
</ul>
<p>Then run <code>pinswitch calibrate FIRST.csv SECOND.csv --plan PLAN --out DIR</code> with the earlier plateau table, the
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

fn runs(runs: &[PlannedRun]) -> String {
    let mut html = "<h2>Runs</h2><div class=\"wide\"><table class=\"runs\"><tr><th></th><th>run</th><th>weight</th><th>load</th><th>speed</th><th>dwell</th>\
                    <th>repetitions ecc. + conc.</th><th>load order</th><th>ends at</th><th>question</th></tr>\n"
        .to_owned();
    let (mut mount, mut minutes) = (0, 0.0);
    for (i, run) in runs.iter().enumerate() {
        if run.mount != mount {
            mount = run.mount;
            let _ = writeln!(
                html,
                "<tr class=\"mount\"><td class=\"done\"></td><td colspan=\"9\">mount {mount}: {}</td></tr>",
                escape(&contact_words(run))
            );
        }
        minutes += run.minutes;
        let _ = writeln!(
            html,
            "<tr><td class=\"done\"></td><td>{}</td><td>{} g</td><td>{:.2} N</td><td>{} %</td><td>{} s</td><td>{} + {}\
             </td><td>{}</td><td>{}</td><td>{}</td></tr>",
            i + 1,
            run.load_mass_g,
            published::load_n(run.load_mass_g),
            run.speed_pct,
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

/// Formats minutes as hours and minutes.
#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
fn clock(minutes: f64) -> String {
    let whole = minutes.round().clamp(0.0, 1e6) as u64;
    format!("{}:{:02}", whole / 60, whole % 60)
}
