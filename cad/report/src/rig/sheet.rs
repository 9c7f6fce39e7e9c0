//! `run-sheet.html` of a rig: the runs of the paper's protocol.

use std::fmt::Write;

use super::{Drive, RigFacts};
use crate::calibration_page::head;
use crate::html::escape;
use crate::run_sheet::{RECORD, STYLE, Speeds, runs_table};

/// Returns the sheet.
pub fn rig_sheet(facts: &RigFacts) -> String {
    let runs = facts.runs();
    let mut html = head("Run sheet");
    html.push_str(STYLE);
    let minutes: f64 = runs.iter().map(|run| run.minutes).sum();
    let speeds = match facts.drive {
        Drive::Actuator { .. } => Speeds::Actuator,
        Drive::Crank { step_mm } => Speeds::Crank(step_mm),
    };
    let _ = write!(
        html,
        "<h1>Runs of {}</h1>\n<p>The paper's protocol: {} runs, about {minutes:.0} minutes. Save the log of each run under the \
         name in its last column, which <code>run.toml</code> lists.</p>\n<h2>Rig</h2>\n<ul>\n<li>Wrap angle of the tendon: {} deg.</li>\n<li>Hook: {} g. It is \
         part of every load.</li>\n<li>Load cell: {}, range {} N. The heaviest load is {:.2} N.</li>\n<li>Logger: {} Hz.</li>\n\
         <li>Stroke of the drive: {} mm.</li>\n</ul>\n",
        escape(&facts.name),
        runs.len(),
        facts.wrap_angle_deg,
        facts.hook_mass_g,
        escape(&facts.cell),
        facts.cell_limit_n,
        facts.heaviest_n(),
        facts.sample_rate_hz,
        facts.stroke_mm
    );
    html.push_str(&runs_table(&runs, &facts.limits(), speeds, "log"));
    html.push_str(RECORD);
    html.push_str(
        "<p>Then run <code>pinswitch segment run.toml --out plateaus.csv</code>.</p>\n</body></html>\n",
    );
    html
}
