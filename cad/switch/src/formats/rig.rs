//! Documents of the test rig: bill, files of the programs, run sheet and wiring (cad/doc/rig.md). Sets without a rig have none.

use super::{Format, Inclusion};
use crate::built::Built;
use crate::documents::Manifest;
use crate::output::{OutputFile, SetError};
use crate::prediction::Prediction;
use crate::rig::rig_facts;
use pinswitch_report::rig::{bill_csv, plan_toml, rig_sheet, rig_toml, run_toml, wiring_svg};

pub(super) const FORMAT: Format = Format {
    name: "rig",
    about: "Bill, run.toml, rig.toml, plan.toml, run sheet and wiring of a rig (mount.kind = \"rig\")",
    inclusion: Inclusion::Default,
    make,
};

fn make(built: &Built, _: &Prediction, _: &Manifest) -> Result<Vec<OutputFile>, SetError> {
    let Some(facts) = rig_facts(built.design()) else { return Ok(Vec::new()) };
    Ok(vec![
        OutputFile::new("rig-bill.csv", bill_csv(&facts)),
        OutputFile::new("rig.toml", rig_toml(&facts)),
        OutputFile::new("run.toml", run_toml(&facts)),
        OutputFile::new("plan.toml", plan_toml(&facts)),
        OutputFile::new("run-sheet.html", rig_sheet(&facts)),
        OutputFile::new("wiring.svg", wiring_svg(&facts)),
    ])
}
